"""Tables of numbers as CSV text, each number with the digits that repr gives it, in a tenth of repr's time."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import Any

import numpy as np
from cffi import FFI

from laconic.paths import built

DECLARATION = "size_t laconic_csv_rows(char *, const double *, size_t, size_t, const uint64_t *);"
POWERS = range(-292, 325)
LONGEST = 25        # characters of a number and what separates it from the next
ROWS_AT_ONCE = 4096


@cache
def _writer() -> tuple[FFI, Any, Any]:
    ffi = FFI()
    ffi.cdef(DECLARATION)
    powers = ffi.new("uint64_t[]", [half for k in POWERS for half in divmod(power_of_ten(k), 2**64)])
    return ffi, ffi.dlopen(str(built("lib/liblaconic_csv.so"))), powers


def power_of_ten(k: int) -> int:
    """The 128 highest bits of 10^k, rounded up."""
    if k >= 0:
        shift = 128 - (10**k).bit_length()
        return 10**k << shift if shift >= 0 else -(-(10**k) >> -shift)
    return -(-(1 << (127 + (10**-k).bit_length())) // 10**-k)


def csv_text(table: np.ndarray) -> Iterator[str]:
    """Lines of a table (row, column), many at a time."""
    ffi, library, powers = _writer()
    room = ffi.new("char[]", LONGEST * ROWS_AT_ONCE * max(1, table.shape[1]))
    for first in range(0, len(table), ROWS_AT_ONCE):
        part = np.ascontiguousarray(table[first : first + ROWS_AT_ONCE], np.float64)
        length = library.laconic_csv_rows(room, ffi.from_buffer("double[]", part), *part.shape, powers)
        yield ffi.buffer(room, length)[:].decode("ascii")
