"""Mutants of the C sources, each a small fault that some C test must notice: in an order that the seed gives, all of
them or a sample, in both scalar types. What a run found is kept in build/mutation/results.jsonl; the next goes on from
there. Or the list of equivalents is asked alone, about faults that another sampler has made and no test noticed."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from laconic.errors import BadInput
from laconic.mutation import Campaign, Listed, Mutant, Tally, read_equivalents, read_faults
from laconic.paths import SOURCE_DIR, sources_missing
from laconic.soak import StoppedEarly

OPTIONS = ("sample", "survivors", "only", "faults")


def soak(minutes: float, seed: int, advance: Callable[[float], None], sample: int | None = None,
         survivors: int | None = None, only: str | None = None, faults: Path | None = None) -> dict[str, Any]:
    """Until the time is over or all were tried; passed when no more than `survivors` are outside of the list of
    equivalents."""
    most = survivors or 0
    if faults is not None:
        if sample is not None or only is not None:
            raise BadInput(f"--faults {faults}: asks about each of its lines; leave out --sample and --only")
        return asked(faults, most)
    campaign = Campaign(only, seed)
    began = last = time.monotonic()

    def moved(tried: float) -> None:
        nonlocal last
        now = time.monotonic()
        advance(now - last if sample is None else 60.0 * minutes * tried / sample)
        last = now

    try:
        until = began + 60.0 * minutes if sample is None else math.inf
        return told(campaign.run(sample, until, moved), len(campaign.mutants), most)
    except KeyboardInterrupt as stopped:
        raise StoppedEarly(told(campaign.tally, len(campaign.mutants), most)) from stopped


def asked(faults: Path, most: int) -> dict[str, Any]:
    """What the list says of each fault of a file; no test is run."""
    if missing := sources_missing():
        raise BadInput(f"soak mutants: needs {missing}")
    listed = Listed(read_equivalents(), SOURCE_DIR)
    reasons = [(fault, listed.reason(fault.file, fault.change)) for fault in read_faults(faults)]
    outside = [str(fault) for fault, reason in reasons if reason is None]
    return {"passed": len(outside) <= most, "faults": len(reasons), "outside the list": outside,
            "in the list": [f"{fault}: {reason}" for fault, reason in reasons if reason is not None]}


def told(tally: Tally, all_of_them: int, most: int) -> dict[str, Any]:
    """The figures, by file, and the survivors."""
    def line(mutant: Mutant) -> str:
        return f"{mutant.file}:{mutant.line} {mutant.function}: {mutant.before}  →  {mutant.after}"

    total = tally.total
    return {"passed": len(tally.survivors) <= most and not tally.listed_yet_killed, "mutants": all_of_them,
            "tried": sum(total.values()), **dict(sorted(total.items())),
            "files": {file: dict(sorted(counts.items())) for file, counts in sorted(tally.of_file.items())},
            "survivors": sorted(map(line, tally.survivors)),
            "listed as equivalent, yet killed": sorted(map(line, tally.listed_yet_killed))}
