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
from laconic.mutation import Campaign, Compiled, Listed, Mutant, SameCode, Tally, read_equivalents, read_faults
from laconic.paths import SOURCE_DIR, build_dir, sources_missing
from laconic.soak import StoppedEarly

OPTIONS = ("sample", "survivors", "only", "faults")


def length(sample: int | None = None, only: str | None = None, faults: Path | None = None, **_: Any) -> float | None:
    """Of `--faults`, how many there are."""
    if faults is None:
        return None
    if sample is not None or only is not None:
        raise BadInput(f"--faults {faults}: asks about each of its lines; leave out --sample and --only")
    return float(len(read_faults(faults)))


def soak(minutes: float, seed: int, advance: Callable[[float], None], sample: int | None = None,
         survivors: int | None = None, only: str | None = None, faults: Path | None = None) -> dict[str, Any]:
    """Until the time is over or all were tried; passed when no more than `survivors` are outside of the list of
    equivalents."""
    most = survivors or 0
    if faults is not None:
        return asked(faults, most, advance)
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


def asked(path: Path, most: int, advance: Callable[[float], None]) -> dict[str, Any]:
    """What the list says of each fault of a file, by its text or by what it is compiled to; no test is run."""
    if missing := sources_missing():
        raise BadInput(f"soak mutants: needs {missing}")
    faults, listed = read_faults(path), Listed(read_equivalents(), SOURCE_DIR)
    compiled = Compiled.of((fault.file for fault in faults), build_dir().resolve() / "mutation" / "asked")
    by_code = SameCode(listed, compiled)
    outside, within = [], []
    for fault in faults:
        reason = listed.reason(fault.file, fault.change) or by_code.reason(fault.file, fault.change)
        if reason is None:
            outside.append(str(fault))
        else:
            within.append(f"{fault}: {reason}")
        advance(1.0)
    return {"passed": len(outside) <= most, "faults": len(faults), "outside the list": outside, "in the list": within}


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
