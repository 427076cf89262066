"""SLCAN reader, frames, loader, vehicles with their steps, drives, FMI calls and saved states under libFuzzer."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from laconic.soak._fuzzing import fuzz_in_turn
from laconic.soak.drive_frames import TARGETS as OF_DRIVES

TARGETS = ("slcan", "frames", "loader", "vehicle", *OF_DRIVES, "fmi", "fmu_state")


def soak(minutes: float, seed: int, advance: Callable[[float], None]) -> dict[str, Any]:
    """Runs each target so many minutes."""
    return fuzz_in_turn(TARGETS, minutes, seed, advance)
