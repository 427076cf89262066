"""Inputs over many steps in the form that the core follows by itself (laconic_schedule)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from laconic.core.copies import NotCopied

if TYPE_CHECKING:
    from laconic.core import Core

FOR_EVER = 2**64 - 1  # steps: the last values of a held schedule stay


class Schedule(NotCopied):
    """Values of some signals over steps from `first_step` on; every other input is zero.

    Held: `values` (stretch, signal), and `until_step`, where each stretch ends. Sampled: `values` (step,
    start|middle|end, signal). `signals` are offsets in a row of input numbers, see Core.input_offset.
    """

    REMEDY = "make another one of the same values"

    @np.errstate(over="ignore")  # the core names a number that is too large for its scalar type
    def __init__(self, core: Core, signals: Sequence[int], values: np.ndarray,
                 until_step: Sequence[int] | np.ndarray | None = None, first_step: int = 0):
        ffi, self._first_step = core.ffi, first_step
        self._signals = np.asarray(signals, np.uint32) * np.uint32(core.dtype.itemsize)
        self._values = np.ascontiguousarray(values, core.dtype)
        self._until = None if until_step is None else np.asarray(until_step, np.uint64)
        self.c: Any = ffi.new("laconic_schedule *", {
            "signal_count": len(self._signals), "signal": ffi.from_buffer("uint32_t[]", self._signals),
            "value": ffi.from_buffer("laconic_real[]", self._values),
            "until_step": ffi.NULL if self._until is None else ffi.from_buffer("uint64_t[]", self._until),
            "count": len(self._values), "first_step": first_step})

    def from_origin(self, step: int) -> Schedule:
        """The same, for a plant that had taken so many steps when the run began."""
        self.c.first_step = (self._first_step + step) % 2**64
        return self
