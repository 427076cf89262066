"""Each bit of the node's memory flipped in the midst of a session: what is noticed, by what, how fast."""

from __future__ import annotations

import hashlib
import json
import subprocess
import time
from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from laconic.errors import BadInput, reason_of
from laconic.paths import built

REALS = ("double", "single")
CHECKS = {"none": "nothing", "sum": "sum and range", "all": "all"}  # of the program → in words
PIECE = 5_000  # bits between two states that are kept
NODE = ("model", "range", "motion", "loaded", "configuration")
RESTART = ("crash", "hang")
Found = dict[str, dict[str, list[int]]]  # area → outcome → bits, sum of µs, worst µs


def program(real: str) -> Path:
    """The campaign of one scalar type."""
    return built(f"campaign/fault_campaign_{real}")


def told(real: str, *words: str) -> tuple[list[list[str]], int]:
    """What the program prints, in cells, and its exit status."""
    done = subprocess.run([str(program(real)), *words], capture_output=True, text=True, stdin=subprocess.DEVNULL)
    if done.stderr:
        raise BadInput(f"{program(real)}: {done.stderr.strip()}")
    return [line.split("|") for line in done.stdout.splitlines()], done.returncode


def bits_of(real: str) -> int:
    """How many bits a node has."""
    rows, _ = told(real, "bits")
    return int(rows[0][0].split()[1])


def tried(real: str, checks: str, seed: int, first: int, behind: int) -> Found:
    """These bits, in the order of the seed."""
    found: Found = defaultdict(dict)
    rows, status = told(real, "memory", str(first), str(behind), str(seed), checks)
    if status:
        raise BadInput(f"{program(real)}: ends with {status}; build it anew")
    for area, outcome, *numbers in rows:
        add(found[area], outcome, [int(number) for number in numbers])
    return found


def add(to: dict[str, list[int]], outcome: str, numbers: list[int]) -> None:
    before = to.get(outcome, [0, 0, 0])
    to[outcome] = [before[0] + numbers[0], before[1] + numbers[1], max(before[2], numbers[2])]


@dataclass
class Campaign:
    """One scalar type and what is switched on; `done` bits so far."""

    real: str
    checks: str
    seed: int
    path: Path
    done: int
    bits: int
    found: Found

    def run(self, until: float, most: int, advance: Callable[[float], None]) -> None:
        """Further bits until that time, or until so many are done."""
        while self.done < most and time.monotonic() < until:
            began = time.monotonic()
            behind = min(self.done + PIECE, most)
            for area, outcomes in tried(self.real, self.checks, self.seed, self.done, behind).items():
                for outcome, numbers in outcomes.items():
                    add(self.found.setdefault(area, {}), outcome, numbers)
            self.done = behind
            self.keep()
            advance(time.monotonic() - began)

    def keep(self) -> None:
        """What is done, for the next run."""
        fresh = self.path.with_suffix(".fresh")
        try:
            fresh.write_text(json.dumps({"about": about(self.real, self.seed), "done": self.done, "found": self.found}),
                             encoding="utf-8")
            fresh.replace(self.path)
        except OSError as error:
            raise BadInput(f"{self.path}: cannot be written ({reason_of(error)}); make room") from None


def about(real: str, seed: int) -> list[Any]:
    return [hashlib.sha256(program(real).read_bytes()).hexdigest(), seed]


def campaign_of(real: str, checks: str, seed: int, folder: Path) -> Campaign:
    """As far as it was done with the same program and seed."""
    path = folder / f"memory-{real}-{checks}.json"
    fresh = Campaign(real, checks, seed, path, 0, bits_of(real), {})
    try:
        kept = json.loads(path.read_bytes())
        if kept["about"] == about(real, seed):
            fresh.done, fresh.found = int(kept["done"]), dict(kept["found"])
    except (OSError, ValueError, KeyError, TypeError):
        pass  # another program's, or none: from the beginning
    return fresh


# -------------------------------------------------------------------------------------------------- in figures

def count(outcomes: dict[str, list[int]], names: tuple[str, ...]) -> int:
    """Bits with one of these outcomes."""
    return sum(outcomes.get(name, [0])[0] for name in names)


def worst_ms(outcomes: dict[str, list[int]], names: tuple[str, ...]) -> float:
    """The longest until one of these outcomes."""
    return max((outcomes[name][2] for name in names if name in outcomes), default=0) / 1000.0


def total(found: Found) -> dict[str, list[int]]:
    """Of all areas."""
    whole: dict[str, list[int]] = {}
    for outcomes in found.values():
        for outcome, numbers in outcomes.items():
            add(whole, outcome, numbers)
    return whole


def row(outcomes: dict[str, list[int]]) -> str:
    """One area in words."""
    all_bits = count(outcomes, tuple(outcomes))
    return (f"{all_bits} bits: harmless {count(outcomes, ('harmless',))}, silent {count(outcomes, ('silent',))}, "
            f"noticed by the node {count(outcomes, NODE)} within {worst_ms(outcomes, NODE):.0f} ms, "
            f"by the core {count(outcomes, ('core',))}, by the rig {count(outcomes, ('rig',))}, "
            f"restarts {count(outcomes, RESTART)}")


def table(campaigns: list[Campaign]) -> str:
    """Markdown: of each area, for each choice of checks, how many bits are noticed, silent, or restart the board."""
    reals = sorted({each.real for each in campaigns})
    lines = ["| scalar type | memory | bits | harmless | " + " | ".join(
        f"{what}: noticed, silent, restarts" for what in CHECKS.values()) + " |", "| --- " * (4 + len(CHECKS)) + "|"]
    for real in reals:
        chosen = {each.checks: {**each.found, "all": total(each.found)} for each in campaigns if each.real == real}
        for area in next(iter(chosen.values())):
            base = chosen["none"].get(area, {})
            cells = [real, area, str(count(base, tuple(base))), str(count(base, ("harmless",)))]
            for checks in CHECKS:
                outcomes = chosen[checks].get(area, {})
                seen = count(outcomes, (*NODE, "core", "rig"))
                cells.append(f"{seen}, {count(outcomes, ('silent',))}, {count(outcomes, RESTART)}")
            lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)
