"""Numbers of a robot's file, checked: finite, with a mass and an inertia that a body can have."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from laconic.errors import BadInput
from laconic.robot_import.placement import Array

WORDS_AT_MOST = 160


def finite(where: str, values: Sequence[Any], count: int) -> list[float]:
    """`count` finite numbers."""
    try:
        numbers = [float(value) for value in values]
    except (TypeError, ValueError):
        raise BadInput(f"{where}: {values} are no numbers") from None
    if len(numbers) != count:
        raise BadInput(f"{where}: has {len(numbers)} numbers; give {count}")
    if not np.isfinite(numbers).all():
        raise BadInput(f"{where}: must be finite")
    return numbers


def mass(where: str, value: Any) -> float:
    """0 or above."""
    number = finite(f"{where}: mass", [value], 1)[0]
    if number < 0.0:
        raise BadInput(f"{where}: mass is {number:g} kg; it cannot be below 0")
    return number


def inertia_matrix(where: str, inertia: Any) -> Array:
    """3 × 3 from ixx, ixy …"""
    ixx, ixy, ixz, iyy, iyz, izz = finite(f"{where}: inertia", [
        getattr(inertia, name) for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")], 6)
    return np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])


def unit_vector(where: str, axis: Sequence[Any]) -> Array:
    """The direction of an axis."""
    vector = np.array(finite(f"{where}: axis", axis, 3))
    largest = np.abs(vector).max()
    if largest < 1e-9:
        raise BadInput(f"{where}: axis is 0; give a direction")
    vector /= largest  # so that no square leaves the range
    return np.asarray(vector / np.linalg.norm(vector))


def words_of(error: Exception) -> str:
    """What a library says of its failure, in one short line."""
    words = " ".join(str(error).split()) or type(error).__name__
    return words if len(words) <= WORDS_AT_MOST else words[:WORDS_AT_MOST] + "…"
