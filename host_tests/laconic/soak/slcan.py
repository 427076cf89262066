"""All scenes over SLCAN to a node in a process of its own."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from laconic.soak import rig


def soak(minutes: float, seed: int, advance: Callable[[float], None]) -> dict[str, Any]:
    """As soak rig, over the socket."""
    return rig.soak(minutes, seed, advance, kind="process")
