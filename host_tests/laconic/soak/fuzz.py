"""SLCAN reader, frame handler, parameter loader and drives under libFuzzer with sanitizers, the time shared evenly."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from laconic.soak._fuzzing import fuzz_in_turn
from laconic.soak.drive_frames import TARGETS as OF_DRIVES

TARGETS = ("slcan", "frames", "loader", *OF_DRIVES)


def soak(minutes: float, seed: int, advance: Callable[[float], None]) -> dict[str, Any]:
    """Runs each target so many minutes."""
    return fuzz_in_turn(TARGETS, minutes, seed, advance)
