"""Fuzz targets, one after the other: how long, how fast, what they found, and what is kept when a signal ends them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from laconic.soak import StoppedEarly
from laconic.soak._fuzzing.file_readers import FILE_TARGETS
from laconic.soak._fuzzing.files import fuzz_files
from laconic.soak._fuzzing.kept import keep_result
from laconic.soak._fuzzing.libfuzzer import Found, Run
from laconic.soak._fuzzing.targets import Target, targets_by_name

LONG_BYTES = 2000
LONG_SHARE = 0.125
"""Of a target's time, for inputs so long; the rest has those of targets.txt, of which many more fit into a second."""


def fuzz_in_turn(names: Sequence[str], minutes: float, seed: int, advance: Callable[[float], None]) -> dict[str, Any]:
    """Each target for so many minutes. New inputs are kept in build/fuzz, apart from the corpus of the sources, and
    tried first by the next run. StoppedEarly, with what was found, when a signal ends it."""
    known = targets_by_name()
    result: dict[str, Any] = {"passed": True}

    def share(seconds: float) -> None:
        advance(seconds / len(names))

    for number, name in enumerate(names):
        if name in FILE_TARGETS:
            found, stopped = fuzz_files(name, 60.0 * minutes, seed + number, share)
        else:
            found, stopped = fuzz_target(known[name], 60.0 * minutes, seed + number, share)
        keep_result(name, found)
        result |= {name: str(found), "passed": result["passed"] and not found.crash}
        if stopped is not None:
            raise StoppedEarly(result) from stopped
    return result


def fuzz_target(target: Target, seconds: float, seed: int, advance: Callable[[float], None]
                ) -> tuple[Found, KeyboardInterrupt | None]:
    """What one found, and the signal that ended it: usual inputs, then long ones."""
    found = Found()
    for part in parts_of(target, seconds, seed):
        try:
            part.wait(advance)
        except KeyboardInterrupt as stopped:
            part.stop()
            return found.and_then(part.found()), stopped
        found = found.and_then(part.found())
    return found, None


def parts_of(target: Target, seconds: float, seed: int) -> Iterator[Run]:
    """Its runs, each begun when the one before has ended."""
    yield Run(target, target.name, target.most_bytes, seconds * (1.0 - LONG_SHARE), seed)
    yield Run(target, f"{target.name}-long", LONG_BYTES, seconds * LONG_SHARE, seed + 1)
