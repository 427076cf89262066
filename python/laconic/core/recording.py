"""Rows of outputs that the core takes while it steps, and its watch on the ground (laconic_recorder); structs that it
fills one by one."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from laconic.core.copies import NotCopied
from laconic.core.encoders import unsigned
from laconic.core.grip import Grip

if TYPE_CHECKING:
    from laconic.core import Core
    from laconic.core.plant import Plant
    from laconic.core.sensors import Sensors

MEMBERS = {  # of laconic_outputs, where they are not called as the signal is
    **{name: ("pose", name) for name in
       ("x_m", "y_m", "heading_rad", "heading_wrapped_rad", "origin_x_m", "origin_y_m")},
    "wheel_reaction_N": ("reactions", "along_N"), "wheel_lateral_N": ("reactions", "lateral_N"),
    "no_slip_margin_N": ("reactions", "no_slip_margin_N"),
}
FRICTION = "friction"  # the member of laconic_outputs with what only a vehicle with friction shows
LOADS = ("wheel_load_N", "support_load_N")  # normal_N of the reactions: first those of the wheels
SENSED = "sensors"  # the member with what sensors show
OUTPUTS_OF = {FRICTION: "laconic_friction_outputs", SENSED: "laconic_sensor_outputs"}
WHOLE = ("encoder_count",)
GROUND = ("wheel_reaction_N", "wheel_lateral_N", "no_slip_margin_N", *LOADS)  # what needs the reactions


class Recorder(NotCopied):
    """`rows` rows of some signals, outputs or inputs, one at the start of every `every`-th step and one at the end."""

    REMEDY = "take its columns()"

    def __init__(self, plant: Plant, signals: tuple[str, ...], every: int, rows: int, watched: bool = False,
                 sensors: Sensors | None = None):
        """`sensors`: of this plant; they are needed for what sensors show, and see every step."""
        core, ffi = plant.core, plant.core.ffi
        self._plant, self.signals = plant, signals
        self._table = np.zeros((rows, len(signals)), core.dtype)
        self._offsets = np.array([offset_of(core, signal, plant.wheel_count) for signal in signals], np.uint32)
        ground = watched or any(signal.partition("[")[0] in GROUND for signal in signals)
        self._sensors = sensors  # keeps them alive
        self._grip = ffi.new("laconic_grip *") if watched else ffi.NULL
        self.c: Any = ffi.new("laconic_recorder *", {
            "contact": plant.contact if ground else ffi.NULL, "grip": self._grip, "every": every,
            "column_count": len(signals), "column": ffi.from_buffer("uint32_t[]", self._offsets),
            "row": ffi.from_buffer("laconic_real[]", self._table, require_writable=True), "row_room": rows,
            "sensors": sensors.c if sensors else ffi.NULL})

    def take_last(self, held: Any) -> None:
        """The row of the present state: the end of a run, with the input of that instant."""
        if self.c.row_count >= len(self._table):
            raise IndexError("the recorder has no room for another row")
        self._plant.core.lib.laconic_record_row(self.c, self._plant.c, held)

    def take_refused(self, held: Any) -> None:
        """The row of the state that a refused step has left, unless it was taken before that step."""
        steps, every = self._plant.steps, int(self.c.every)
        if not self.c.row_count or (int(self.c.row_count) - 1) * every < steps:
            self.c.grip = self._plant.core.ffi.NULL  # this instant was watched before the step
            self.take_last(held)

    def drop_unfinite(self) -> bool:
        """Takes the last row back where a number of it is infinite or NaN, and says whether it did."""
        if np.isfinite(self._table[self.row_count - 1]).all():
            return False
        self.c.row_count -= 1
        return True

    @property
    def row_count(self) -> int:
        """How many rows were taken."""
        return int(self.c.row_count)

    def columns(self) -> dict[str, np.ndarray]:
        """What was taken, by signal name; counts as whole numbers."""
        table = self._table[: self.c.row_count].astype(float, copy=False)
        return {signal: self._counts(column.astype(np.int64)) if is_whole(signal) else column
                for signal, column in zip(self.signals, table.T, strict=True)}

    def _counts(self, column: np.ndarray) -> np.ndarray:
        return unsigned(column) if self._sensors is not None and self._sensors.is_unsigned else column

    def grip(self, step_s: float) -> Grip | None:
        """What the watch has found in steps of `step_s`; None where there was no watch."""
        return Grip.of(self._grip, self._plant, step_s) if self._grip else None


class Structs:
    """So many of one C struct, zero at first: the core fills `c`, and `table` has their members by name."""

    def __init__(self, core: Core, struct: str, count: int):
        self.table = np.zeros(count, struct_dtype(core, struct))
        self.c: Any = core.ffi.from_buffer(f"{struct}[]", self.table, require_writable=True)


@cache
def struct_dtype(core: Core, struct: str) -> np.dtype[Any]:
    """A C struct as numpy reads it."""
    return _dtype_of(core.ffi, core.ffi.typeof(struct))


def _dtype_of(ffi: Any, kind: Any) -> np.dtype[Any]:
    if kind.kind == "array":
        return np.dtype((_dtype_of(ffi, kind.item), (kind.length,)))
    if kind.kind == "struct":
        fields = dict(kind.fields)
        return np.dtype({"names": list(fields), "formats": [_dtype_of(ffi, field.type) for field in fields.values()],
                         "offsets": [field.offset for field in fields.values()], "itemsize": ffi.sizeof(kind)})
    return np.dtype(f"{'f' if kind.cname in ('double', 'float') else 'i'}{ffi.sizeof(kind)}")


def is_whole(signal: str) -> bool:
    """Whether a signal is a whole number: a count."""
    return signal.partition("[")[0] in WHOLE


def needs_sensors(core: Core, signal: str) -> bool:
    """Whether a signal is one that sensors must see the steps for."""
    return signal.partition("[")[0] in _members(core, "laconic_sensor_outputs")


def offset_of(core: Core, signal: str, wheel_count: int = 0) -> int:
    """Where a signal stands in laconic_outputs, in bytes; the index counts from 1. The loads of supports follow those
    of so many wheels."""
    name, _, index = signal.partition("[")
    if name in LOADS:
        first = wheel_count if name == LOADS[1] else 0
        return core.ffi.offsetof("laconic_outputs", "reactions", "normal_N", first + int(index.rstrip("]")) - 1)
    member = ("input", name) if name in core.input_fields else MEMBERS.get(name, (name,))
    for part in (FRICTION, SENSED):
        if name in _members(core, OUTPUTS_OF[part]):
            member = (part, name)
    element = (int(index.rstrip("]")) - 1,) if index else ()
    return core.ffi.offsetof("laconic_outputs", *member, *element)


def _members(core: Core, struct: str) -> dict[str, Any]:
    return dict(core.ffi.typeof(struct).fields)
