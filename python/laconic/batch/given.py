"""What a program gives a batch: vehicles, a kind for each lane, how many lanes and threads; refused by its name."""

from __future__ import annotations

from typing import Any

import numpy as np

from laconic.core import Core, Vehicle
from laconic.core.articulated import ArticulatedVehicle
from laconic.core.given import shown, whole_number
from laconic.core.given_array import any_array
from laconic.errors import BadInput

MOST_LANES = 2**28


def kinds_of(vehicles: Any) -> list[Any]:
    """One vehicle or several, as a list."""
    if isinstance(vehicles, Vehicle | ArticulatedVehicle):
        return [vehicles]
    try:
        return list(vehicles)
    except TypeError:
        raise BadInput(f"vehicles: {shown(vehicles)} is no laconic.Vehicle and no list of them; give one") from None


def core_of(vehicles: list[Any], kind: Any = Vehicle, other: str = "ArticulatedBatch") -> Core:
    """That of all vehicles, which are of one kind; `other` is the batch for those of the other kind."""
    if not vehicles:
        raise BadInput("vehicles: none is given; give at least one")
    for item, vehicle in enumerate(vehicles, start=1):
        if not isinstance(vehicle, kind) and isinstance(vehicle, Vehicle | ArticulatedVehicle):
            raise BadInput(f"vehicles[{item}]: is a laconic.{type(vehicle).__name__}; step it in a laconic.{other}")
        if not isinstance(vehicle, kind):
            raise BadInput(f"vehicles[{item}]: {shown(vehicle)} is no laconic.{kind.__name__}; give one")
        if vehicle.core is not vehicles[0].core:
            raise BadInput(f"vehicles[{item}]: is of {vehicle.core.real} precision, the first of "
                           f"{vehicles[0].core.real}; give vehicles of one")
    core: Core = vehicles[0].core
    return core


def check_steppable(vehicle: Vehicle, name: str) -> None:
    """BadInput for a vehicle that a batch does not step."""
    if vehicle.has_friction:
        raise BadInput(f"{name}: has ground friction or a drive with limits, which a batch does not step; take them "
                       "out, or step it with plant()")


def kinds_of_lanes(kinds: int, lanes: int | None, kind_of: Any) -> np.ndarray:
    """The kind of each lane."""
    if kind_of is None:
        if lanes is not None and kinds > 1 and lanes != kinds:
            raise BadInput(f"lanes: {lanes} lanes for {kinds} vehicles; leave it out for one each, or give kind_of")
        found = np.arange(kinds)
        if kinds == 1:
            found = np.zeros(lane_count("lanes", 1 if lanes is None else lanes), np.int32)
    else:
        found = any_array(kind_of)
        if found.dtype == object:
            raise BadInput(f"kind_of: {shown(kind_of)} is no row of numbers; give one whole number for each lane")
        if found.ndim != 1 or found.dtype.kind not in "iu" or (lanes is not None and len(found) != lanes):
            raise BadInput(f"kind_of: has the shape {found.shape} and numbers of {found.dtype}; give one whole number "
                           "for each lane")
        lane_count("lanes", len(found))
        if found.min() < 0 or found.max() >= kinds:
            raise BadInput(f"kind_of: {found.min()} to {found.max()} are not all kinds; give numbers from 0 to "
                           f"{kinds - 1}")
        if len(found) < kinds:
            raise BadInput(f"kind_of: {len(found)} lanes for {kinds} vehicles; give no more vehicles than lanes")
    return np.ascontiguousarray(found, np.int32)


def lane_count(name: str, given: Any) -> int:
    """How many lanes are asked for."""
    count = whole_number(name, given)
    if not 1 <= count <= MOST_LANES:
        raise BadInput(f"{name}: {count} is not from 1 to {MOST_LANES}; give a number of vehicles")
    return count


def thread_count(given: Any) -> int:
    """How many threads are asked for."""
    count = whole_number("threads", given)
    if count < 1:
        raise BadInput(f"threads: {count} cannot take a step; give 1 or more")
    return count
