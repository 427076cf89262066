"""One hash on every target that can be reached here: every trajectory of core_c/tests/trajectory_hash.c in both scalar
types, and check_double.c. A target is some seconds to a minute."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from laconic.errors import LaconicError
from laconic.soak import StoppedEarly
from laconic.targets import TARGETS, Bits, HashTarget

REALS = ("double", "single")
LEAST = 12  # targets that must have run


def length() -> float:
    """One for each target and scalar type."""
    return float(len(TARGETS) * len(REALS))


def soak(minutes: float, seed: int, advance: Callable[[float], None]) -> dict[str, Any]:
    """Each target once, whatever `minutes` and `seed`: passed when all that are here have the hashes of the first. A
    library whose faults touch no trajectory is told."""
    found: dict[str, list[Bits]] = {}
    try:
        for target in TARGETS:
            found[target.name] = [] if target.lacks() else [_bits(target, real) for real in REALS]
            advance(len(REALS))
    except KeyboardInterrupt as stop:
        raise StoppedEarly(_result_of(found)) from stop
    return _result_of(found)


def _result_of(found: dict[str, list[Bits]]) -> dict[str, Any]:
    """Of all targets, those that were reached and those that were not."""
    ran = [bits for bits in found.values() if bits]
    same = all([each.hashes for each in bits] == [each.hashes for each in ran[0]] for bits in ran)
    enough = len(ran) >= LEAST or len(found) < len(TARGETS)
    told = {target.name: _told(found[target.name]) or f"not here: no {target.lacks()}" if target.name in found
            else "not reached" for target in TARGETS}
    return {"passed": same and enough, "targets": len(ran), **told}


def _bits(target: HashTarget, real: str) -> Bits:
    with TemporaryDirectory() as folder:
        try:
            return target.bits(Path(folder), real)
        except LaconicError as error:
            return Bits((str(error),))


def _told(found: list[Bits]) -> str:
    faults = sorted({fault for bits in found for fault in bits.faults})
    return "; ".join([", ".join(" ".join(bits.hashes) for bits in found), *faults])
