"""What acts on a vehicle with hinges, by names: the numbers of a laconic_articulated_input seen as one row."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from laconic.core.given import finite_number, finite_numbers, shown
from laconic.core.inputs import no_such_wheel, slots_of
from laconic.errors import BadInput, Refused, nearest_of

if TYPE_CHECKING:
    from laconic.core import Core

PER_HINGE = {"hinge_voltage_V": "hinge_voltage_V", "hinge_torque_Nm": "hinge_torque_Nm",
             "steering_rate_rad_per_s": "hinge_rate_rad_per_s"}
"""Inputs with one number for each hinge, and the core's names for them."""
TWIST = "steering_twist"
LONGEST_NAME = 200  # letters of a signal


@cache
def member_of(core: Core, name: str) -> tuple[int, int]:
    """Offset and length of a member of laconic_articulated_input, in numbers."""
    field = dict(core.ffi.typeof("laconic_articulated_input").fields)[name]
    size = core.ffi.sizeof(field.type) // core.dtype.itemsize
    return int(field.offset) // int(core.dtype.itemsize), int(size)


def row_length(core: Core) -> int:
    """How many numbers a row has."""
    return int(core.ffi.sizeof("laconic_articulated_input")) // int(core.dtype.itemsize)


def input_slots(core: Core, names: Sequence[str], signal: str) -> range:
    """The numbers that a signal may set; BadInput where there is no such signal or hinge."""
    if not isinstance(signal, str) or len(signal) > LONGEST_NAME:
        raise BadInput(f"signal: {shown(signal)} is not the name of an input; give one such as \"voltage_V[1]\"")
    name, _, inside = signal.partition("[")
    item = inside.removesuffix("]")
    if name in PER_HINGE:
        start, _ = member_of(core, PER_HINGE[name])
        if not inside:
            return range(start, start + len(names))
        if item not in names:
            raise BadInput(f"{signal}: there is no such hinge; {nearest_of(item, names, _known(names))}")
        return range(start + names.index(item), start + names.index(item) + 1)
    if name == TWIST:
        start, length = member_of(core, "twist")
        if inside and item not in ("1", "2", "3"):
            raise BadInput(f"{signal}: there is no such item; give 1 to 3")
        return range(start + int(item) - 1, start + int(item)) if inside else range(start, start + length)
    if name not in core.input_fields:
        raise BadInput(f"{signal}: there is no such input; "
                       f"{nearest_of(name, (*core.input_fields, *PER_HINGE, TWIST))}")
    first, _ = member_of(core, "base")
    slots = slots_of(core, signal)
    return range(first + slots.start, first + slots.stop)


def _known(names: Sequence[str]) -> str:
    return f"hinges are {', '.join(names)}" if names else "this vehicle has none"


def row_of_hinges(core: Core, names: Sequence[str], wheel_count: int, values: Any) -> np.ndarray:
    """A row of input numbers by names; what is left out is 0."""
    if not isinstance(values, Mapping):
        raise BadInput(f"inputs: {shown(values)} is no mapping from signals to numbers; give one such as "
                       "{\"voltage_V\": [1, 2]}")
    row = np.zeros(row_length(core), core.dtype)
    for signal, value in values.items():
        name, _, inside = str(signal).partition("[")
        if inside and name in values:
            raise BadInput(f"{signal}: is given besides {name}; keep one of them")
        slots = input_slots(core, names, signal)
        if name in ("voltage_V", "axle_torque_Nm"):
            if inside and int(inside.rstrip("]")) > wheel_count:
                raise BadInput(no_such_wheel(signal, name, wheel_count))
            slots = slots if inside else range(slots.start, slots.start + wheel_count)
        with np.errstate(over="ignore"):
            if isinstance(value, int | float | np.number):
                value = [finite_number(str(signal), value)]
            row[slots.start : slots.stop] = finite_numbers(str(signal), value, len(slots))
    return row


OF_CORE = {of_core: name for name, of_core in PER_HINGE.items()} | {
    "hinge_acceleration_rad_per_s2": "steering_acceleration_rad_per_s2", "twist": TWIST,
    "twist_rate": "steering_twist_rate"}
"""Inputs by their members in the core, which its refusals name."""


def by_signal(refused: Refused, names: Sequence[str]) -> Refused:
    """A refusal of an input's number by its signal: hinges by their names."""
    found = re.match(r"(\w+)\[(\d+)\]: ", refused.message)
    if not found or found[1] not in OF_CORE:
        return refused
    item = found[2] if found[1].startswith("twist") else names[int(found[2]) - 1]
    text = f"{OF_CORE[found[1]]}[{item}]: {refused.message[found.end():]}"
    return Refused(refused.status, refused.field, refused.item, text, value=refused.value, limit=refused.limit)
