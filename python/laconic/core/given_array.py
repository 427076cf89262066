"""Arrays that a Python program gives: one that does not fit is refused in one line, before NumPy speaks of its types.

    real_array("voltage_V", given, (3, 1000), "V")                  # exactly this shape
    real_array("samples", given, ("samples", 3, 1000), "V")         # a word: any length
    real_array("state", given, (AtLeast(6),), "rad/s, m, rad")
    fill("voltage_V", room, given, "V")                             # one that NumPy spreads over `room`
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from laconic.core.given import REAL, is_bytes, is_masked, shown
from laconic.errors import BadInput


class AtLeast(int):
    """A length of so much or more."""


Length = int | str
"""Of one axis: a number, AtLeast(number), or a word that names it, for any length."""


def real_array(name: str, given: Any, shape: Sequence[Length], unit: str = "", *, dtype: Any = float,
               is_finite: bool = True) -> np.ndarray:
    """`given` as a C-contiguous array of `dtype` (None: its own), itself where it is one; BadInput says what fits.

    A column or row of a list that is too short, None, words, flags and complex numbers are no real numbers.
    """
    found = any_array(given)
    if found.dtype.kind not in REAL or not _fits(found.shape, shape):
        _fail(name, given, shape, unit, found)
    if is_finite:
        check_finite(name, found, unit)
    with np.errstate(over="ignore"):  # the core names a number that is too large for its scalar type
        return np.ascontiguousarray(found, dtype).reshape(found.shape)


def any_array(given: Any) -> np.ndarray:
    """As NumPy takes it; an array of objects for rows of unlike lengths, where numbers are masked, and what else is no
    array."""
    if is_bytes(given) or is_masked(given) or (
            isinstance(given, list | tuple) and any(map(is_masked, given))):
        return np.empty((), object)
    try:
        return np.asarray(given)
    except (TypeError, ValueError, OverflowError):
        return np.empty((), object)


def fill(name: str, room: np.ndarray, given: Any, unit: str = "") -> None:
    """Writes real numbers, one for all or as NumPy spreads them, into `room`; BadInput says what fits."""
    found = any_array(given)
    if found.dtype.kind not in REAL:
        _fail(name, given, room.shape, unit, found)
    try:
        with np.errstate(over="ignore"):
            room[...] = found
    except ValueError:
        _fail(name, given, room.shape, unit, found)


def check_finite(name: str, values: np.ndarray, unit: str = "") -> None:
    """BadInput names the first place, from 1, that is infinite or NaN."""
    if np.isfinite(values).all():
        return
    place = tuple(np.argwhere(~np.isfinite(values))[0])
    item = f"[{', '.join(str(index + 1) for index in place)}]" if place else ""
    raise BadInput(f"{name}{item}: {values[place]} is not finite; give finite numbers{_of(unit)}")


def _fits(shape: tuple[int, ...], wanted: Sequence[Length]) -> bool:
    return len(shape) == len(wanted) and all(
        isinstance(length, str) or (there >= length if isinstance(length, AtLeast) else there == length)
        for there, length in zip(shape, wanted, strict=True))


def _fail(name: str, given: Any, wanted: Sequence[Length], unit: str, found: np.ndarray | None = None) -> None:
    is_array = isinstance(given, np.ndarray) and found is not None
    text = f"an array of shape {given.shape} and type {given.dtype}" if is_array else shown(given)
    lengths = [f"{length} or more" if isinstance(length, AtLeast) else str(length) for length in wanted]
    shape = f"({lengths[0]},)" if len(lengths) == 1 else f"({', '.join(lengths)})"
    raise BadInput(f"{name}: {text} does not fit; give real numbers of shape {shape}{_of(unit)}")


def _of(unit: str) -> str:
    return f" in {unit}" if unit else ""
