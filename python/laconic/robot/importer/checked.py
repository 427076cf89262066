"""Numbers of a robot's file, checked: finite, with a mass and an inertia that a body can have."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from laconic.errors import BadInput, shown
from laconic.robot.importer.placement import Array

WORDS_AT_MOST = 160
LARGEST = 1e30  # in SI units, far beyond any robot; products of a few such numbers stay finite
DECIMAL = re.compile(r"[+-]?((\d+\.?\d*|\.\d+)(e[+-]?\d+)?|inf|infinity|nan)", re.ASCII | re.IGNORECASE)
DISSIPATION = {"damping": "N·m·s/rad", "friction": "N·m"}  # of a joint


def finite(where: str, values: Sequence[Any], count: int, largest: float = LARGEST) -> list[float]:
    """`count` finite numbers."""
    numbers = [number(where, value) for value in values]
    if len(numbers) != count:
        raise BadInput(f"{where}: has {len(numbers)} numbers; give {count}")
    if not np.isfinite(numbers).all():
        raise BadInput(f"{where}: must be finite")
    if (most := max(numbers, key=abs, default=0.0)) and abs(most) > largest:
        raise BadInput(f"{where}: {most:g} is beyond {largest:g}; give SI units")
    return numbers


def number(where: str, value: Any) -> float:
    """One number, of a text only as files write it: Python's float() takes 1_0 for 10."""
    if value is None:
        raise BadInput(f"{where}: is missing; give a number")
    if isinstance(value, str) and not DECIMAL.fullmatch(value.strip()):
        raise BadInput(f"{where}: {shown(value[:WORDS_AT_MOST])} is no number; give one such as 0.5")
    try:
        return float(value)
    except (TypeError, ValueError):
        raise BadInput(f"{where}: {shown(value)} is no number; give one such as 0.5") from None


def read_number(text: Any) -> float | None:
    """A finite number of a part that a robot does not need; None where it has none."""
    try:
        return finite("", [text], 1)[0]
    except BadInput:
        return None


def read_numbers(text: str | None, count: int) -> list[float] | None:
    """The same of several in one text."""
    try:
        return finite("", (text or "").split(), count)
    except BadInput:
        return None


def mass(where: str, value: Any) -> float:
    """0 or above."""
    return not_negative(where, "mass", value, "kg")


def not_negative(where: str, what: str, value: Any, unit: str) -> float:
    """0 or above."""
    number = finite(f"{where}: {what}", [value], 1)[0]
    if number < 0.0:
        raise BadInput(f"{where}: {what} is {number:g} {unit}; it cannot be below 0")
    return number


def size(where: str, what: str, value: Any) -> float:
    """A length of a shape in m, 0 or above."""
    return not_negative(where, what, value, "m")


def sizes(where: str, values: Sequence[Any]) -> Array:
    """The three edges of a box."""
    return np.array([size(where, "size", value) for value in finite(f"{where}: size", values, 3)])


def inertia_matrix(where: str, inertia: Mapping[str, Any]) -> Array:
    """3 × 3 from ixx, ixy …, of which those off the diagonal may be left out."""
    ixx, iyy, izz = (finite(f"{where}: inertia {name}", [inertia.get(name)], 1)[0] for name in ("ixx", "iyy", "izz"))
    ixy, ixz, iyz = (finite(f"{where}: inertia {name}", [inertia.get(name, 0.0)], 1)[0]
                     for name in ("ixy", "ixz", "iyz"))
    return np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])


def unit_vector(where: str, axis: Sequence[Any]) -> Array:
    """The direction of an axis."""
    vector = np.array(finite(f"{where}: axis", axis, 3, largest=np.inf))
    largest = np.abs(vector).max()
    if largest == 0.0:
        raise BadInput(f"{where}: axis is 0; give a direction")
    vector /= largest  # so that no square leaves the range
    return np.asarray(vector / np.linalg.norm(vector))


def words_of(error: Exception) -> str:
    """What a library says of its failure, in one short line."""
    words = " ".join(str(error).split()) or "it gives no reason"
    return words if len(words) <= WORDS_AT_MOST else words[:WORDS_AT_MOST] + "…"
