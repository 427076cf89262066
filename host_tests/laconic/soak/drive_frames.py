"""Any frames to the drives of each protocol, with time and faults by order between, under libFuzzer with sanitizers.

Sequences are free: frames of any identifier, length and payload, steps of the core, drives that fail, leave the bus and
come back. No sanitizer may stop them, every frame sent must be one, and every torque a number.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from laconic.errors import BadInput, nearest_of
from laconic.soak._fuzzing import fuzz_in_turn

OPTIONS = ("protocol",)
TARGETS = ("canopen", "odrive", "robomaster", "moteus")


def soak(minutes: float, seed: int, advance: Callable[[float], None], protocol: str | None = None) -> dict[str, Any]:
    """Runs each protocol so many minutes, or one of them alone."""
    if protocol is not None and protocol not in TARGETS:
        raise BadInput(f"--protocol {protocol}: there are no drives of it to fuzz; {nearest_of(protocol, TARGETS)}")
    return fuzz_in_turn(TARGETS if protocol is None else (protocol,), minutes, seed, advance)
