"""The memory of a batch, and its rows as numpy arrays that are views of it."""

from __future__ import annotations

from typing import Any

import numpy as np

from laconic.core import Core
from laconic.errors import BadInput

ALIGNMENT = 64  # bytes


def aligned_memory(size: int) -> np.ndarray:
    """Bytes that begin at a multiple of ALIGNMENT."""
    try:
        whole = np.empty(size + ALIGNMENT, np.uint8)
    except MemoryError:
        raise BadInput(f"lanes: so many need {size / 2**30:.1f} GiB of memory, which are not there; give fewer"
                       ) from None
    first = -whole.ctypes.data % ALIGNMENT
    return whole[first:first + size]


class Rows:
    """Rows of numbers, one number for each lane; rows that belong together stand at equal distances."""

    def __init__(self, core: Core, batch: Any, memory: np.ndarray, lanes: int):
        self._core, self._c, self._memory, self._lanes = core, batch, memory, lanes

    def _offset(self, row: str, wheel: int = 0) -> int:
        number = getattr(self._core.lib, f"LACONIC_BATCH_{row}")
        pointer = self._core.lib.laconic_batch_row_of(self._c, number, wheel)
        return self._place_of(pointer)

    def _place_of(self, pointer: Any) -> int:
        return int(self._core.ffi.cast("uintptr_t", pointer)) - self._memory.ctypes.data

    def _view(self, first: int, count: int, stride: int) -> np.ndarray:
        dtype = self._core.dtype
        return np.ndarray((count, self._lanes), dtype, self._memory.data, first, (stride, dtype.itemsize))

    def one(self, row: str) -> np.ndarray:
        """(lanes,)"""
        return self._view(self._offset(row), 1, 0)[0]

    def many(self, first: str, count: int) -> np.ndarray:
        """(count, lanes), from rows that follow each other."""
        return self._view(self._offset(first), count, int(self._c.row_bytes))

    def of_wheels(self, row: str) -> np.ndarray:
        """(wheels, lanes)"""
        wheels = int(self._c.shape.wheel_count)
        if wheels == 0:
            return np.empty((0, self._lanes), self._core.dtype)
        stride = self._offset(row, 1) - self._offset(row) if wheels > 1 else 0
        return self._view(self._offset(row), wheels, stride)

    def of_lanes(self, pointer: Any, dtype: Any) -> np.ndarray:
        """(lanes,) of an array beside the rows; read only."""
        return self.read_only(np.ndarray((self._lanes,), dtype, self._memory.data, self._place_of(pointer)))

    @staticmethod
    def read_only(array: np.ndarray) -> np.ndarray:
        """The same view, for reading."""
        array.flags.writeable = False
        return array
