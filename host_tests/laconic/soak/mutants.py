"""Mutants of the C sources, each a small fault that some C test must notice: in an order that the seed gives, all of
them or a sample, in both scalar types. What a run found is kept in build/mutation/results.jsonl; the next goes on from
there."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Any

from laconic.mutation import Campaign, Mutant, Tally
from laconic.soak import StoppedEarly

OPTIONS = ("sample", "survivors", "only")


def soak(minutes: float, seed: int, advance: Callable[[float], None], sample: int | None = None,
         survivors: int | None = None, only: str | None = None) -> dict[str, Any]:
    """Until the time is over or all were tried; passed when no more than `survivors` are outside of the list of
    equivalents."""
    most = survivors or 0
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
