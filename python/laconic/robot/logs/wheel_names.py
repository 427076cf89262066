"""Which wheel of a scene a name is of: front and rear, left and right say where it is."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

SIDES = {"left": 1.0, "right": -1.0}
ENDS = {"front": 1.0, "rear": -1.0, "back": -1.0}
SHORT = {"fl": ("front", "left"), "fr": ("front", "right"), "rl": ("rear", "left"), "rr": ("rear", "right"),
         "bl": ("rear", "left"), "br": ("rear", "right"), "lf": ("front", "left"), "rf": ("front", "right"),
         "lr": ("rear", "left"), "lb": ("rear", "left"), "rb": ("rear", "right"), "l": ("", "left"), "r": ("", "right"),
         "lhs": ("", "left"), "rhs": ("", "right")}
NEAR_M = 1e-6


def words_of(name: str) -> list[str]:
    """The words of a name: of left_wheelJoint left, wheel, joint."""
    return [word.lower() for word in re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+", name)]


def corner_of(name: str) -> tuple[str, str]:
    """(front, rear or nothing, left, right or nothing) of a wheel's name."""
    words = words_of(name)
    end = next(("rear" if word in ("rear", "back") else "front" for word in words if word in ENDS), "")
    side = next((word for word in words if word in SIDES), "")
    if not (end and side):
        short = next((SHORT[word] for word in words if word in SHORT), ("", ""))
        end, side = end or short[0], side or short[1]
    return end, side


def places_by_name(names: Sequence[str], wheels: Sequence[Mapping[str, Any]]) -> list[int] | None:
    """For each name the index of its wheel; None where names and places do not say it without doubt."""
    numbers = [re.findall(r"\d+", name) for name in names]
    if all(len(each) == 1 for each in numbers) and sorted(int(each[0]) for each in numbers) == list(
            range(1, len(wheels) + 1)):
        return [int(each[0]) - 1 for each in numbers]
    found: list[int] = []
    for name in names:
        end, side = corner_of(name)
        fitting = [index for index, wheel in enumerate(wheels)
                   if (not side or SIDES[side] * wheel.get("y_m", 0.0) > NEAR_M)
                   and (not end or ENDS[end] * wheel.get("x_m", 0.0) > NEAR_M)]
        if not (end or side) or len(fitting) != 1:
            return None
        found.append(fitting[0])
    return found if len(set(found)) == len(found) else None
