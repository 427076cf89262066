"""The ways to spell a vehicle's numbers, for scene files and for tables of a program alike.

Angles may be in degrees, a wheel's place given by distance and bearing, a motor's circuit by its name. The core has
radians, x and y, and numbers.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from typing import TYPE_CHECKING, Any, NoReturn, Protocol, TypeVar

import numpy as np

from laconic.core.given import number, one_of, shown
from laconic.errors import BadInput

if TYPE_CHECKING:
    from laconic.core import Core

Angles = TypeVar("Angles", float, np.ndarray)
RAD, DEG = "_rad", "_deg"
PLAIN, POLAR = ("x_m", "y_m"), ("distance_m", "bearing_rad", "bearing_deg")


class Keys(Protocol):
    """A table that is read key by key; it says itself what is missing."""

    def has(self, key: str, /) -> bool:
        """Whether the key is there."""

    def number(self, key: str, /) -> float:
        """Its number."""

    def angle(self, stem: str, /) -> float:
        """The angle in rad, from stem_rad or stem_deg."""

    def fail(self, key: str, message: str, /) -> NoReturn:
        """Raises BadInput for a key."""


def is_in_degrees(table: Keys, stem: str) -> bool:
    """Whether an angle is given in degrees; fails where it is given twice."""
    if not table.has(f"{stem}{DEG}"):
        return False
    if table.has(f"{stem}{RAD}"):
        table.fail(f"{stem}{DEG}", f"is given besides {stem}{RAD}; keep one of them")
    return True


def place_by_bearing(table: Keys) -> tuple[float, float] | None:
    """x and y of a wheel that is placed by its distance and bearing from the ξ axis; None for one that is not."""
    polar, plain = ([key for key in keys if table.has(key)] for keys in (POLAR, PLAIN))
    if not polar:
        return None
    if plain:
        table.fail(polar[0], f"is given besides {plain[0]}; give x_m and y_m, or distance_m and bearing_rad")
    distance, bearing = table.number("distance_m"), table.angle("bearing")
    if distance < 0:
        table.fail("distance_m", f"is {distance:g}; give 0 or more, and the direction by the bearing")
    return x_and_y(distance, bearing)


def x_and_y(distance_m: float, bearing_rad: float) -> tuple[float, float]:
    """Of a place by its distance and bearing, with the same bits for every reader."""
    return distance_m * math.cos(bearing_rad), distance_m * math.sin(bearing_rad)


def wrapped(angle_rad: Angles) -> Angles:
    """The same directions in (−π, π], with the same bits for every reader."""
    return -((math.pi - angle_rad) % (2.0 * math.pi) - math.pi)


class _Given:
    """A table of a program as Keys."""

    def __init__(self, name: str, given: Mapping[str, Any]):
        self.name, self.given = name, given

    def has(self, key: str, /) -> bool:
        return key in self.given

    def number(self, key: str, /) -> float:
        if key not in self.given:
            self.fail(key, "is missing; give a number")
        return number(f"{self.name}.{key}", self.given[key])

    def angle(self, stem: str, /) -> float:
        in_degrees = is_in_degrees(self, stem)
        return math.radians(self.number(f"{stem}{DEG}")) if in_degrees else self.number(f"{stem}{RAD}")

    def fail(self, key: str, message: str, /) -> NoReturn:
        raise BadInput(f"{self.name}.{key}: {message}")


def with_radians(name: str, given: Mapping[Any, Any], known: Collection[str]) -> Mapping[Any, Any]:
    """The table with its angles in rad where it has one of `known` in degrees; itself where it has none."""
    stems = [key.removesuffix(DEG) for key in given
             if isinstance(key, str) and key.endswith(DEG) and key.removesuffix(DEG) + RAD in known]
    if not stems:
        return given
    table, found = _Given(name, given), dict(given)
    for stem in stems:
        found[f"{stem}{RAD}"] = table.angle(stem)
        del found[f"{stem}{DEG}"]
    return found


def with_place(name: str, given: Mapping[Any, Any]) -> Mapping[Any, Any]:
    """A wheel's table with x_m and y_m where it has a distance and a bearing; itself where it has none."""
    place = place_by_bearing(_Given(name, given))
    if place is None:
        return given
    return {key: value for key, value in given.items() if key not in POLAR} | dict(zip(PLAIN, place, strict=True))


def with_circuit(core: Core, name: str, given: Mapping[Any, Any]) -> Mapping[Any, Any]:
    """A wheel's table with the number of its motor's circuit where it has the name."""
    if not isinstance(given.get("motor_circuit"), str):
        return given
    prefix = "LACONIC_MOTOR_"
    circuits = {label.removeprefix(prefix).lower(): found
                for label, found in core.ffi.typeof("laconic_motor_circuit").relements.items()}
    return {**given, "motor_circuit": circuits[one_of(f"{name}.motor_circuit", given["motor_circuit"], circuits)]}


def wheel_in_core_terms(core: Core, name: str, given: Any) -> Mapping[Any, Any]:
    """A wheel's table as the core has it, but for its angles, which `table` of laconic.core.given reads."""
    if not isinstance(given, Mapping):
        raise BadInput(f"{name}: {shown(given)} is no table; give a mapping from keys to numbers")
    return with_circuit(core, name, with_place(name, given))
