"""The keys whose values a population of one template may differ in: each sets numbers of a C struct of each vehicle.

All other keys (a wheel's kind, the method, instants of inputs …) make another template. What is set here has the bits
that the scene's reader would give the core.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from laconic.batch.population import copies_of, struct_dtype, zeros
from laconic.core import Core
from laconic.core.fields import WHEEL
from laconic.scene import Scene
from laconic.scene.key_path import EVERY, KeyPath, key_path
from laconic.scene.keys import KEYS
from laconic.scene.scene_tables import SceneTables

RADIANS = math.pi / 180.0  # as math.radians has it
POLAR = ("distance_m", "bearing_rad", "bearing_deg")
ABSENT_AT_0 = ("motor_gain_Nm_per_V", "motor_damping_Nms", "resistance_ohm", "gear_ratio")
OF_GROUND = ("slope_rad", "slope_deg", "slope_heading_rad", "slope_heading_deg")
OF_START = ("x_m", "y_m", "heading_rad", "heading_deg", "nu_rad_per_s", "velocity_body_m_per_s", "yaw_rate_rad_per_s")


def is_number_of_struct(key: KeyPath, others: Sequence[KeyPath]) -> bool:
    """Whether runs of one template may differ in this key, when they differ in the others, too."""
    if key.known.kind != "number":
        return False
    if key.table == WHEEL and key.name in (*POLAR, "x_m", "y_m"):  # one way to say where a wheel is
        return len({each.name in POLAR for each in others if each.table == WHEEL and
                    each.name in (*POLAR, "x_m", "y_m")}) == 1
    if key.table == "ground":
        return key.name in OF_GROUND
    if key.table == "initial":
        return key.name in OF_START
    if key.table == "input[#]":
        return key.name == "value"
    return key.table in ("vehicle", "vehicle.motor", "vehicle.payload", "vehicle.support[#]", WHEEL)


def has_own_zero(scene: Scene, core: Core) -> bool:
    """Whether a wheel has an own value of 0, which moves numbers between the vehicle and its wheels."""
    own = [each.key for each in core.own_fields()]
    return any(wheel.get(key) == 0.0 for wheel in scene.vehicle["wheel"] for key in own)


def usual(key: KeyPath, values: np.ndarray) -> np.ndarray:
    """Which values the reader takes as plain numbers; of others it has its own words."""
    found = np.isfinite(values)
    rule = KEYS[key.known.path].rule if key.known.path in KEYS else None
    if rule is not None:
        found &= np.asarray(rule.holds(values))  # type: ignore[arg-type]
    is_own = key.table == WHEEL and key.name not in ("x_m", "y_m", "axle_rad", "axle_deg", "roller_rad", "roller_deg",
                                                    *POLAR)
    if is_own or key.name in ABSENT_AT_0:
        found &= values != 0.0
    return found


@dataclass
class Numbers:
    """The structs of a population: vehicles without rotor and motor gain where there are motors to be fitted."""

    vehicles: np.ndarray
    motors: np.ndarray | None
    starts: dict[str, np.ndarray] = field(default_factory=dict)   # keys of `initial`, as columns
    inputs: dict[tuple[str, int], np.ndarray] = field(default_factory=dict)

    def part(self, lanes: slice | np.ndarray) -> Numbers:
        """Those of some lanes."""
        return Numbers(self.vehicles[lanes], None if self.motors is None else self.motors[lanes],
                       {key: values[lanes] for key, values in self.starts.items()},
                       {key: values[lanes] for key, values in self.inputs.items()})


def numbers_of(core: Core, tables: SceneTables, scene: Scene, values: Mapping[str, np.ndarray], count: int) -> Numbers:
    """The structs of so many runs of a template scene, whose tables are `tables`; values by key, (count,) each."""
    bare = {key: value for key, value in scene.vehicle.items() if key != "motor"}
    made = Numbers(copies_of(core, "laconic_vehicle", core.vehicle(bare), count), None)
    if motor := scene.vehicle.get("motor"):
        made.motors = zeros(core, "laconic_motor", count)
        for name, value in motor.items():
            made.motors[name] = value
    polar: dict[int, dict[str, np.ndarray]] = {}
    for text, column in values.items():
        _set(core, made, key_path(text), column, len(scene.vehicle["wheel"]), polar)
    for wheel, given in polar.items():
        _set_place(made, tables, wheel, given)
    return made


def _set(core: Core, made: Numbers, key: KeyPath, column: np.ndarray, wheels: int,
         polar: dict[int, dict[str, np.ndarray]]) -> None:
    name, value = (f"{key.name[:-4]}_rad", column * RADIANS) if key.name.endswith("_deg") else (key.name, column)
    if key.table == "vehicle":
        made.vehicles[name] = value
    elif key.table == "vehicle.motor" and made.motors is not None:
        made.motors[name] = value
    elif key.table in ("vehicle.payload", "ground"):
        made.vehicles[key.table.removeprefix("vehicle.")][name] = value
    elif key.table == "initial":
        _set_start(made, key, name, value)
    elif key.table == "input[#]":
        _set_input(made, key, value)
    else:
        rows = made.vehicles[key.tables[1][0]]
        for item in _items(key.tables[1][1], wheels if key.table == WHEEL else rows.shape[1]):
            if name in POLAR:
                polar.setdefault(item, {})[name] = value
            else:
                rows[_member(core, key.table, name)][:, item] = value


def _items(item: int | None, count: int) -> list[int]:
    return list(range(count)) if item == EVERY else [(item or 1) - 1]


def _member(core: Core, table: str, name: str) -> str:
    return next(each.member for each in core.fields_of(table) if each.key == name)


def _set_start(made: Numbers, key: KeyPath, name: str, value: np.ndarray) -> None:
    if key.item is None:
        made.starts[name] = value
        return
    for item in _items(key.item, key.known.items):
        made.starts[f"{name}[{item + 1}]"] = value


def _set_input(made: Numbers, key: KeyPath, value: np.ndarray) -> None:
    """`[*]` of inputs and of values is taken apart where they are counted (laconic.tools.sweep.lanes)."""
    made.inputs[(f"input[{key.tables[0][1]}]", (key.item or 1) - 1)] = value


def _set_place(made: Numbers, tables: SceneTables, wheel: int, given: Mapping[str, np.ndarray]) -> None:
    """A wheel's place by distance and bearing; sines are Python's, as the reader's."""
    def column(name: str) -> Any:
        return given.get(name, np.full(len(made.vehicles), tables.value(f"vehicle.wheel[{wheel + 1}].{name}")))
    distances, bearings = column("distance_m").tolist(), column("bearing_rad").tolist()
    places = made.vehicles["wheel"]
    for name, turn in (("x_m", math.cos), ("y_m", math.sin)):
        places[name][:, wheel] = [distance * turn(bearing) for distance, bearing in
                                  zip(distances, bearings, strict=True)]


def starts_of(core: Core, scene: Scene, starts: Mapping[str, np.ndarray], models: np.ndarray) -> np.ndarray:
    """(lanes,) of laconic_start, as `Scene.c_start` makes one; models: of the lanes' kinds."""
    given, count = scene.initial, len(models)
    found = np.zeros(count, struct_dtype(core, "laconic_start"))

    def of(key: str, usual_value: float) -> np.ndarray:
        return np.asarray(starts.get(key, np.full(count, usual_value)))

    for name in ("x_m", "y_m", "heading_rad"):
        found[name] = of(name, getattr(given, name))
    if given.nu_rad_per_s is not None:
        for item, value in enumerate(given.nu_rad_per_s):
            found["nu_rad_per_s"][:, item] = of(f"nu_rad_per_s[{item + 1}]", value)
        return found
    for item, speed in enumerate(given.velocity_body_m_per_s):
        along = of(f"velocity_body_m_per_s[{item + 1}]", speed)
        found["nu_rad_per_s"][:, item] = along / models["wheel_radius_m"].astype(float)
    found["nu_rad_per_s"][:, 2] = models["yaw_scale"].astype(float) * of("yaw_rate_rad_per_s",
                                                                          given.yaw_rate_rad_per_s)
    return found
