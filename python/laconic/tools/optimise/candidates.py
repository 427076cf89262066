"""Vehicles of many choices at once, as the scene's reader would make each.

Numbers that stand in the core's vehicle as they are in the file are written there for all choices together, by what a
sweep has for it. Whether that gives the reader's own bytes is tried at some choices first; where it does not, or for
other keys, each choice is read as a scene of its own, which takes some milliseconds.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from laconic.batch.population import items_of
from laconic.core import Core
from laconic.errors import BadInput
from laconic.scene import Scene
from laconic.scene.ground import on_ideal_ground
from laconic.scene.key_path import key_path
from laconic.scene.scene_tables import SceneTables
from laconic.tools.measures.prepared import Prepared
from laconic.tools.optimise.problem import Free
from laconic.tools.sweep.numbers import has_own_zero, is_number_of_struct, numbers_of

TRIED = 5  # choices at which the fast way is compared with the reader
OF_VEHICLE = ("vehicle", "vehicle.motor", "vehicle.payload", "vehicle.support[#]", "vehicle.wheel[#]")


class Candidates:
    """Scenes and vehicles of a file with some of its numbers chosen; `core` is that of the file's scalar type."""

    def __init__(self, tables: SceneTables, free: Sequence[Free]):
        self.tables, self.free = tables, free
        self.base = tables.scene()
        self.core: Core = self.base.core()
        keys = [key_path(key) for each in free for key in each.keys]
        plain = all(key.table in OF_VEHICLE and is_number_of_struct(key, keys) for key in keys)
        self.is_fast = plain and not has_own_zero(self.base, self.core) and self._agrees()

    def scene(self, choice: np.ndarray) -> Scene:
        """The scene of one choice; BadInput as `read_scene`."""
        return self.tables.with_values(values_of(self.free, choice)).scene()

    def prepared(self, choices: np.ndarray) -> Prepared:
        """The models of choices (L, p) on ideal ground; what cannot be read as a scene counts as refused."""
        if self.is_fast:
            return _with(Prepared(self.core, self._written(choices), [self._inputs]), self._unfit)
        vehicles, inputs, refused = [], [], {}
        for lane, choice in enumerate(choices):
            try:
                scene = on_ideal_ground(self.scene(choice))
            except BadInput as unreadable:
                scene, refused[lane] = self._rolling, unreadable
            vehicles.append(self.core.vehicle(scene.vehicle))
            inputs.append(scene.inputs_on_grid().held_at(0))
        return _with(Prepared(self.core, vehicles, inputs), refused)

    @cached_property
    def _rolling(self) -> Scene:
        """The scene as it is, on ideal ground."""
        return on_ideal_ground(self.base)

    @cached_property
    def _inputs(self) -> dict[str, float]:
        """Those that the scene as it is begins with."""
        return self.base.inputs_on_grid().held_at(0)

    def _read(self, choice: np.ndarray) -> Any:
        return self.core.vehicle(on_ideal_ground(self.scene(choice)).vehicle)

    def _written(self, choices: np.ndarray) -> Any:
        """laconic_vehicle[L], with the columns written and the motors fitted; `_unfit` has the motors that are none."""
        self._unfit: dict[int, BadInput] = {}
        values = values_of(self.free, choices.T)
        made = numbers_of(self.core, self.tables, self._rolling, values, len(choices))
        vehicles = items_of(self.core, "laconic_vehicle", made.vehicles)
        if made.motors is not None:
            motors, why = items_of(self.core, "laconic_motor", made.motors), self.core.why()
            for lane in range(len(choices)):
                if self.core.lib.laconic_motor_fit(vehicles + lane, motors + lane, why) != self.core.lib.LACONIC_OK:
                    self._unfit[lane] = self.core.refusal(why)
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


def _with(prepared: Prepared, refused: Mapping[int, BadInput]) -> Prepared:
    """The models with more refusals."""
    for lane, why in refused.items():
        prepared.refuse(lane, why)
    return prepared


def values_of(free: Sequence[Free], choice: np.ndarray) -> dict[str, Any]:
    """The value of each key from a choice (p,), or a column of values from many (p, L)."""
    return {key: value for each, value in zip(free, choice if choice.ndim > 1 else choice.tolist(), strict=True)
            for key in each.keys}
