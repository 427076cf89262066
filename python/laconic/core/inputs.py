"""What acts on a vehicle, by the names that a scene has: the numbers of a laconic_input seen as one row.

A wheel that the vehicle lacks is refused as the command line refuses it. A list is known to be whole only
with the number of wheels; without it, single items alone are taken.

Inputs over many steps in the form that the core follows by itself (laconic_schedule).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from laconic.core.copies import NotCopied
from laconic.core.given import REAL, finite_number, shown
from laconic.core.given_array import any_array, real_array
from laconic.errors import BadInput, nearest_of

if TYPE_CHECKING:
    from laconic.core import Core

PER_WHEEL = ("voltage_V", "axle_torque_Nm")
"""Inputs with one number for each wheel."""


def no_such_wheel(given: str, name: str, wheel_count: int) -> str:
    """Why what was given of a signal does not fit a vehicle's wheels, with the remedy."""
    last = f" to {name}[{wheel_count}]" if wheel_count > 1 else ""
    there = f"use {name}[1]{last}" if wheel_count else "it has no such signals"
    return f"{given} does not match the vehicle's {wheel_count} wheel{'s' * (wheel_count != 1)}; {there}"


def input_fields(core: Core) -> dict[str, tuple[int, int]]:
    """Name → (offset, length) in laconic_input seen as one row of numbers: it holds nothing else."""
    found = {}
    for name, field in core.ffi.typeof("laconic_input").fields:
        length = field.type.length if field.type.kind == "array" else 1
        found[name] = (field.offset // core.dtype.itemsize, length)
    return found


def slots_of(core: Core, signal: str, wheel_count: int | None = None) -> range:
    """The numbers that a signal may set; BadInput where there is no such signal or item, with the items that a vehicle
    with so many wheels has."""
    name, _, index = str(signal).partition("[")
    if name not in core.input_fields:
        raise BadInput(f"{signal}: there is no such input; {nearest_of(name, core.input_fields)}")
    start, length = core.input_fields[name]
    if not index:
        return range(start, start + length)
    item = index.removesuffix("]")
    is_number = len(item) <= len(str(length)) and item.isdecimal()
    if not is_number or not 1 <= int(item) <= length or signal != f"{name}[{int(item)}]":  # one spelling each
        items = wheel_count if wheel_count and name in PER_WHEEL else length
        raise BadInput(f"{signal}: there is no such item; give {f'1 to {items}' if items > 1 else name}")
    return range(start + int(item) - 1, start + int(item))


@np.errstate(over="ignore")  # the core names a number that is too large for its scalar type
def row_of(core: Core, values: Mapping[str, float | Sequence[float]], wheel_count: int | None) -> np.ndarray:
    """A row of input numbers by names; wheel_count None: no vehicle is known."""
    if not isinstance(values, Mapping):
        raise BadInput(f"input: {shown(values)} is no mapping from signals to numbers; "
                       "give one such as {\"voltage_V\": [1, 2]}")
    row = np.zeros(core.input_length, core.dtype)
    for signal, value in values.items():
        slots = slots_of(core, signal, wheel_count)
        _check_alone(signal, values)
        found = any_array(value)
        if found.dtype.kind not in REAL:
            raise BadInput(f"{signal}: {shown(value)} is no number and no list of numbers; give real numbers")
        many = np.atleast_1d(found).astype(core.dtype)
        count = len(many) if signal in PER_WHEEL else len(slots)
        if many.ndim != 1 or len(many) != count or count > len(slots):
            there = wheel_count if signal in PER_WHEEL and many.ndim != 1 and wheel_count else len(slots)
            raise BadInput(f"{signal}: {_with_shape(value)} are not its numbers, of which there are {there}; give them "
                           "in one row")
        _check_wheels_of(core, signal, value, slots[:count], wheel_count)
        row[slots.start : slots.start + count] = many
    return row


def _check_alone(signal: str, values: Mapping[str, Any]) -> None:
    """BadInput for one item of a signal whose whole row is given, too."""
    name = str(signal).partition("[")[0]
    if name != signal and name in values:
        raise BadInput(f"{signal}: is given besides {name}; keep one of them")


def _with_shape(value: Any) -> str:
    """A value that does not fit, an array by its shape."""
    return f"numbers of shape {value.shape}" if isinstance(value, np.ndarray) else shown(value)


def check_finite_input(core: Core, held: Any, what: str = "") -> Any:
    """The laconic_input as it is; BadInput names the first number that is infinite or NaN."""
    row = np.frombuffer(core.ffi.buffer(held), core.dtype)
    for offset in np.flatnonzero(~np.isfinite(row)):
        name = next(name for name, (first, length) in core.input_fields.items() if first <= offset < first + length)
        finite_number(f"{what}{name}", float(row[offset]))
    return held


def _check_wheels_of(core: Core, signal: str, value: object, slots: range, wheel_count: int | None) -> None:
    """BadInput for an item of a wheel that is not there, and for a list that has not one number for each wheel."""
    name = signal.partition("[")[0]
    if name not in PER_WHEEL:
        return
    if signal == name and wheel_count is None:
        raise BadInput(f"{name}: has one number for each wheel, and without wheel_count they cannot be counted; give "
                       f"it, or single ones such as {name}[1]")
    if signal == name and len(slots) != wheel_count:
        raise BadInput(no_such_wheel(f"{name}: {shown(value)}", name, wheel_count or 0)
                       + (f", or a list of {wheel_count}" if wheel_count else ""))
    if wheel_count is not None and slots and slots[-1] >= core.input_fields[name][0] + wheel_count:
        raise BadInput(no_such_wheel(signal, name, wheel_count))


def check_wheels(core: Core, rows: np.ndarray, wheel_count: int) -> None:
    """BadInput for a number other than 0, in the last axis of `rows`, that is for a wheel beyond the vehicle's."""
    for name in PER_WHEEL:
        start, length = core.input_fields[name]
        beyond = rows[..., start + wheel_count : start + length]
        if beyond.any():
            wheel = wheel_count + 1 + int(np.argwhere(beyond)[0][-1])
            raise BadInput(f"input: {no_such_wheel(f'{name}[{wheel}]', name, wheel_count)}")


def sampled_rows(core: Core, given: Any, wheel_count: int) -> np.ndarray:
    """Inputs at the start, middle and end of steps, (steps, 3, numbers of an input); the core checks their numbers."""
    rows = real_array("samples", given, ("steps", 3, core.input_length), dtype=core.dtype, is_finite=False)
    check_wheels(core, rows, wheel_count)
    return rows


def check_held(core: Core, held: Any, wheel_count: int) -> None:
    """The same for a laconic_input."""
    size, numbers = core.dtype.itemsize, core.ffi.buffer(held)
    for name in PER_WHEEL:  # a controller gives it at each step, so the usual case takes no more than a look
        start, length = core.input_fields[name]
        if numbers[(start + wheel_count) * size : (start + length) * size].strip(b"\0"):
            check_wheels(core, np.frombuffer(numbers, core.dtype), wheel_count)


if TYPE_CHECKING:
    from laconic.core import Core

FOR_EVER = 2**64 - 1  # steps: the last values of a held schedule stay


class Schedule(NotCopied):
    """Values of some signals over steps from `first_step` on; every other input is zero.

    Held: `values` (stretch, signal), and `until_step`, where each stretch ends. Sampled: `values` (step,
    start|middle|end, signal). `signals` are offsets in a row of input numbers, see Core.input_offset.
    """

    REMEDY = "make another one of the same values"

    @np.errstate(over="ignore")  # the core names a number that is too large for its scalar type
    def __init__(self, core: Core, signals: Sequence[int], values: np.ndarray,
                 until_step: Sequence[int] | np.ndarray | None = None, first_step: int = 0):
        ffi, self._first_step = core.ffi, first_step
        self._signals = np.asarray(signals, np.uint32) * np.uint32(core.dtype.itemsize)
        self._values = np.ascontiguousarray(values, core.dtype)
        self._until = None if until_step is None else np.asarray(until_step, np.uint64)
        self.c: Any = ffi.new("laconic_schedule *", {
            "signal_count": len(self._signals), "signal": ffi.from_buffer("uint32_t[]", self._signals),
            "value": ffi.from_buffer("laconic_real[]", self._values),
            "until_step": ffi.NULL if self._until is None else ffi.from_buffer("uint64_t[]", self._until),
            "count": len(self._values), "first_step": first_step})

    def from_origin(self, step: int) -> Schedule:
        """The same, for a plant that had taken so many steps when the run began."""
        self.c.first_step = (self._first_step + step) % 2**64
        return self
