"""Faults of bus, memory, power and clocks; `--only` one of them."""

from __future__ import annotations

import random
import time
from collections.abc import Callable
from typing import Any

from laconic.benchmark.fault_matrix import run_matrix
from laconic.benchmark.watched_ends import Row
from laconic.errors import BadInput, nearest_of
from laconic.outputs import make_folder
from laconic.paths import results_dir
from laconic.soak import StoppedEarly
from laconic.soak._campaigns.memory import CHECKS, REALS, Campaign, campaign_of, row, table, total
from laconic.soak._campaigns.session import figures

OPTIONS = ("only", "sample")
PARTS = ("clocks", "power", "memory", "frames")
Advance = Callable[[float], None]


def soak(minutes: float, seed: int, advance: Advance, only: str | None = None, sample: int | None = None
         ) -> dict[str, Any]:
    """Clocks and power whole, half of the time for memory, the rest for the matrix of frames; or one of them alone."""
    if only is not None and only not in PARTS:
        raise BadInput(f"--only {only}: is no kind of fault; {nearest_of(only, PARTS)}")
    if sample is not None and only != "memory":
        raise BadInput(f"--sample {sample}: is of memory alone; add --only memory, or leave it out")
    end = time.monotonic() + 60.0 * minutes
    result: dict[str, Any] = {"passed": True}
    for part in (only,) if only else PARTS:
        if part == "memory":
            left = end - time.monotonic()
            found = memory(time.monotonic() + (left if only else left / 2), seed, sample, advance)
        elif part == "frames":
            found = frames(end, seed, advance)
        else:
            told, good = figures(part)
            found = {"passed": good, **told}
        result = {**result, **found, "passed": result["passed"] and found["passed"]}
    return result


def memory(end: float, seed: int, sample: int | None, advance: Advance) -> dict[str, Any]:
    """Bits one after the other, in turns of all choices of checks and both scalar types; goes on where it ended."""
    folder = results_dir("faults")
    make_folder(folder)
    campaigns = [campaign_of(real, checks, seed, folder) for real in REALS for checks in CHECKS]
    try:
        while time.monotonic() < end:
            each = min(campaigns, key=lambda campaign: campaign.done / min(sample or campaign.bits, campaign.bits))
            most = min(sample or each.bits, each.bits)
            if each.done >= most:
                break
            each.run(end, min(most, each.done + 25_000), advance)
    except KeyboardInterrupt as stop:
        raise StoppedEarly(of_memory(campaigns)) from stop
    return of_memory(campaigns)


def of_memory(campaigns: list[Campaign]) -> dict[str, Any]:
    """Passed where nothing is silent once all is switched on, and nothing restarts the board."""
    rows = {f"memory, {each.real}, checked: {CHECKS[each.checks]}": row(total(each.found)) for each in campaigns
            if each.found}
    silent = [name for each in campaigns if each.checks == "all" for name, outcomes in each.found.items()
              if "silent" in outcomes]
    done = min(each.done / each.bits for each in campaigns)
    return {"passed": not silent, **rows, "silent, all checked": silent, "of all bits": f"{100.0 * done:.1f} %",
            "table": "\n" + table(campaigns) if any(each.found for each in campaigns) else "none yet"}


def frames(end: float, seed: int, advance: Advance) -> dict[str, Any]:
    """Runs the matrix, with a new seed each time, until the time is up."""
    source, cases, injected, bad = random.Random(seed), 0, 0, []
    last = time.monotonic()
    while last < end:
        for each in run_matrix(source.randrange(2**31)):
            cases, injected = cases + 1, injected + each.injected
            bad += [describe(each)] if not each.good or each.undetected else []
            now = time.monotonic()
            advance(now - last)
            last = now
            if now >= end:
                break
    return {"passed": not bad, "cases": cases, "faults": injected, "bad": bad}


def describe(row: Row) -> str:
    """One case in one line."""
    return f"{row.fault} on {row.frame}: {row.undetected} undetected, {'; '.join(row.problems) or 'no other problem'}"
