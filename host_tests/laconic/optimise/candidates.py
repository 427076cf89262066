"""Vehicles of many choices at once, as the scene's reader would make each.

Numbers that stand in the core's vehicle as they are in the file (masses, places and angles of wheels …) are written
there for all choices together. Whether that gives the reader's own bytes is tried at some choices first; where it does
not, or for other keys, each choice is read as a scene of its own, which takes some milliseconds.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from laconic.core import Core
from laconic.core.fields import WHEEL
from laconic.errors import BadInput
from laconic.measures.prepared import Prepared, records
from laconic.optimise.problem import Free
from laconic.scene import Scene
from laconic.scene.ground import on_ideal_ground
from laconic.scene.key_path import EVERY, KeyPath, key_path
from laconic.scene.scene_tables import SceneTables

Turn = Callable[[float], float]
Setter = Callable[[np.ndarray, list[float]], None]
"""Writes a column of values, L of them, into records (L,) of laconic_vehicle."""

PLACE, POLAR = ("x_m", "y_m"), ("distance_m", "bearing_rad")

TRIED = 5  # choices at which the fast way is compared with the reader


class Candidates:
    """Scenes and vehicles of a file with some of its numbers chosen; `core` is that of the file's scalar type."""

    def __init__(self, tables: SceneTables, free: Sequence[Free]):
        self.tables, self.free = tables, free
        self.keys = [key_path(key) for each in free for key in each.keys]
        self._columns = [column for column, each in enumerate(free) for _ in each.keys]  # of a choice, for each key
        self.base = tables.scene()
        self.core: Core = self.base.core()
        self._polar: dict[int, dict[str, tuple[int, Turn]]] = {}  # wheel: of distance and bearing, its column and unit
        setters = [self._setter(key, column) for key, column in zip(self.keys, self._columns, strict=True)]
        self._setters = [each for each in setters if each is not None]
        self.is_fast = len(self._setters) == len(self.keys) and self._agrees()

    def scene(self, choice: np.ndarray) -> Scene:
        """The scene of one choice; BadInput as `read_scene`."""
        return self.tables.with_values(values_of(self.free, choice)).scene()

    def prepared(self, choices: np.ndarray) -> Prepared:
        """The models of choices (L, p) on ideal ground; what cannot be read as a scene counts as refused."""
        if self.is_fast:
            return Prepared(self.core, self._written(choices))
        vehicles, refused = [], {}
        for lane, choice in enumerate(choices):
            try:
                vehicles.append(self._read(choice))
            except BadInput as unreadable:
                vehicles.append(self._base_vehicle)
                refused[lane] = unreadable
        found = Prepared(self.core, vehicles)
        for lane, why in refused.items():
            found.refuse(lane, why)
        return found

    # ---- by the reader

    def _read(self, choice: np.ndarray) -> Any:
        return self.core.vehicle(on_ideal_ground(self.scene(choice)).vehicle)

    @cached_property
    def _base_vehicle(self) -> Any:
        return self.core.vehicle(on_ideal_ground(self.base).vehicle)

    # ---- all at once

    def _written(self, choices: np.ndarray) -> Any:
        """laconic_vehicle[L], the base's with the columns written."""
        ffi = self.core.ffi
        vehicles = ffi.new("laconic_vehicle[]", len(choices))
        rows = records(self.core, "laconic_vehicle", vehicles, writeable=True)
        rows[:] = records(self.core, "laconic_vehicle", self._base_vehicle)
        for setter, column in zip(self._setters, self._columns, strict=True):
            setter(rows, choices[:, column].tolist())
        for wheel, chosen in self._polar.items():
            self._write_places(rows, wheel, {name: [turn(value) for value in choices[:, column].tolist()]
                                             for name, (column, turn) in chosen.items()})
        return vehicles

    def _agrees(self) -> bool:
        """Whether the fast way gives what the reader gives, at both ends of all ranges and in between."""
        ranges = np.array([[each.low, each.high] for each in self.free])
        shares = np.vstack([np.zeros(len(ranges)), np.ones(len(ranges)),
                            np.random.default_rng(1).random((TRIED - 2, len(ranges)))])
        choices = ranges[:, 0] + shares * (ranges[:, 1] - ranges[:, 0])
        written, size = self._written(choices), self.core.ffi.sizeof("laconic_vehicle")
        try:
            return all(bytes(self.core.ffi.buffer(written + lane, size)) == bytes(self.core.ffi.buffer(self._read(one)))
                       for lane, one in enumerate(choices))
        except BadInput:
            return False

    def _setter(self, key: KeyPath, column: int) -> Setter | None:
        """How a key's values are written; None for one that the reader has to read."""
        items = [item for _, item in key.tables if item is not None]
        if key.table not in ("vehicle", WHEEL) or key.item is not None:
            return None
        turn: Turn = math.radians if key.name.endswith("_deg") else float
        name = f"{key.name.removesuffix('_deg')}_rad" if key.name.endswith("_deg") else key.name
        wheels = self.tables.entries["vehicle"]["wheel"]
        meant = range(len(wheels)) if items == [EVERY] else [item - 1 for item in items]
        if name in POLAR and all("distance_m" in wheels[wheel] for wheel in meant):
            for wheel in meant:
                self._polar.setdefault(wheel, {})[name] = (column, turn)
            return lambda rows, values: None  # distance and bearing are written together
        if name in PLACE and any("distance_m" in wheels[wheel] for wheel in meant):
            return None
        fields = {field.key: field for field in self.core.fields_of(key.table) if field.kind == "REAL"}
        return _writer(fields[name].member, items, turn) if name in fields else None

    def _write_places(self, rows: np.ndarray, wheel: int, chosen: dict[str, list[float]]) -> None:
        """x and y of a wheel that the file gives by distance and bearing."""
        given = self.tables.entries["vehicle"]["wheel"][wheel]
        fixed = math.radians(given["bearing_deg"]) if "bearing_deg" in given else given.get("bearing_rad", 0.0)
        distances = chosen.get("distance_m", [given["distance_m"]] * len(rows))
        pairs = list(zip(distances, chosen.get("bearing_rad", [fixed] * len(rows)), strict=True))
        rows["wheel"]["x_m"][:, wheel] = [distance * math.cos(bearing) for distance, bearing in pairs]
        rows["wheel"]["y_m"][:, wheel] = [distance * math.sin(bearing) for distance, bearing in pairs]


def values_of(free: Sequence[Free], choice: np.ndarray) -> dict[str, float]:
    """The value of each key."""
    return {key: float(value) for each, value in zip(free, choice, strict=True) for key in each.keys}


def _writer(member: str, items: list[int], turn: Turn) -> Setter:
    """Writes a member of the vehicle, or of its wheel: items[0] from 1, EVERY for all of them."""
    def write(rows: np.ndarray, values: list[float]) -> None:
        turned = np.array([turn(value) for value in values])
        if not items:
            rows[member] = turned
        elif items[0] == EVERY:
            rows["wheel"][member][:, : rows["wheel_count"][0]] = turned[:, None]
        else:
            rows["wheel"][member][:, items[0] - 1] = turned

    return write
