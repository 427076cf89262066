"""Saved states that a program gives back: their numbers are finite, as all are that the core saved.

    check_saved(core, "state", plant.save())      # BadInput: "state.x_m.value: nan is not finite; …"

The members are public and may be written; a number that the core would carry on with without a word is refused here.
A bare laconic_state does not say of which robot it is, as those of a batch and of a program in C do not. What is nought
in each state of this robot is known, though, and with friction the number of wheels:

    check_motion_of("state", saved, plant)  # BadInput: "state.zeta[3].value: 0.2 is a motion that …"
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from laconic.errors import BadInput

if TYPE_CHECKING:
    from laconic.core import Core
    from laconic.core.plant import Plant

REMEDY = "give what save() of this robot gave"


def check_saved(core: Core, name: str, saved: Any) -> None:
    """BadInput names the first real number of a struct of the core that is infinite or NaN."""
    names, places = _reals_of(core, core.ffi.typeof(saved))
    numbers = np.frombuffer(core.ffi.buffer(core.ffi.addressof(saved)), core.dtype)[places]
    if not np.isfinite(numbers).all():
        first = int(np.flatnonzero(~np.isfinite(numbers))[0])
        raise BadInput(f"{name}.{names[first]}: {numbers[first]} is not finite; give what save() gave, unchanged")


def check_motion_of(name: str, state: Any, plant: Plant) -> None:
    """BadInput for a laconic_state with a motion that the wheels of this plant forbid, or with more wheels."""
    for axis in range(int(plant.c.model.dof), 3):
        for member in ("zeta", "travel"):
            if value := getattr(state, member)[axis].value:
                raise BadInput(f"{name}.{member}[{axis + 1}].value: {value:g} is a motion that the wheels of this "
                               f"robot forbid; {REMEDY}")
    for wheel in range(plant.wheel_count, plant.core.max_wheels):
        if value := state.wheel_angle_set_rad[wheel]:
            raise BadInput(f"{name}.wheel_angle_set_rad[{wheel + 1}]: is {value:g}, and this robot has "
                           f"{plant.wheel_count} wheels; {REMEDY}")


def check_wheels_of(name: str, saved: Any, plant: Plant) -> None:
    """BadInput for a laconic_plant that is saved of a robot with another number of wheels, or without friction."""
    if not saved.friction.acts:
        raise BadInput(f"{name}: is of a robot without friction; {REMEDY}")
    if saved.vehicle.wheel_count != plant.wheel_count:
        raise BadInput(f"{name}: is of a robot with {saved.vehicle.wheel_count} wheels, and this has "
                       f"{plant.wheel_count}; {REMEDY}")


@lru_cache(maxsize=32)
def _reals_of(core: Core, kind: Any) -> tuple[tuple[str, ...], np.ndarray]:
    """Names and places, counted in real numbers, of all in a struct."""
    names, offsets = zip(*_reals(core, kind, "", 0), strict=True)
    return names, np.array(offsets) // core.dtype.itemsize


def _reals(core: Core, kind: Any, name: str, offset: int) -> Iterator[tuple[str, int]]:
    if kind.kind == "struct":
        for member, field in kind.fields:
            yield from _reals(core, field.type, f"{name}.{member}" if name else member, offset + field.offset)
    elif kind.kind == "array":
        size = core.ffi.sizeof(kind.item)
        for item in range(kind.length):
            yield from _reals(core, kind.item, f"{name}[{item + 1}]", offset + item * size)
    elif kind.cname in ("float", "double"):
        yield name, offset
