"""The tables of a scene file as they are, with single keys read and set by their paths.

    tables = scene_tables("robotino2")
    tables.value("vehicle.wheel[2].axle_deg")                               # 180.0
    tables.with_values({"vehicle.wheel[2].x_m": -0.12, "run.step_s": 1e-3}).scene()
"""

from __future__ import annotations

import copy
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

from laconic.base.paths import scene_path
from laconic.core.given import shown
from laconic.core.spelling import PLAIN, x_and_y
from laconic.errors import BadInput
from laconic.scene.key_path import EVERY, KeyPath, default_of, key_path
from laconic.scene.scene import Scene, scene_of
from laconic.scene.scene_text import lines_of
from laconic.scene.step_choice import AUTO
from laconic.scene.table import Table, plain, read_toml

Value = float | bool | str
POLAR = ("distance_m", "bearing_rad")


@dataclass(frozen=True)
class SceneTables:
    """What a scene file holds, before it is checked; `scene()` checks it."""

    path: Path
    entries: dict[str, Any]

    def scene(self) -> Scene:
        """The scene of these tables; BadInput as `read_scene`."""
        return scene_of(Table(self.path, "", copy.deepcopy(self.entries)))

    def toml(self) -> str:
        """The file's text, without the comments that the first one had."""
        return "\n".join(lines_of(self.entries, {})) + "\n"

    def value(self, key: str | KeyPath) -> Value | None:
        """A key's value, in its own unit whatever the file writes; where the file leaves it out, what holds then.

        None: nothing is known without the key, or `[*]` stands for different values.
        """
        found = key_path(key)
        values = [self._value_in(table, found) for table in self._tables_of(found)]
        return values[0] if values and all(value == values[0] for value in values) else None

    def with_values(self, values: Mapping[str | KeyPath, Value] | Mapping[str, Value]) -> SceneTables:
        """The tables with some keys set, in this order; BadInput for a wheel that is not there or no such value.

        A wheel's place that the file gives otherwise (by x_m and y_m, or by distance and bearing) is converted.
        """
        changed = SceneTables(self.path, copy.deepcopy(self.entries))
        for key, value in values.items():
            found, plain_value = key_path(key), plain(value)
            changed._check_kind(found, plain_value)
            for table in changed._tables_of(found, make=True):
                changed._set(table, found, plain_value)
        return changed

    def _fail(self, key: KeyPath, message: str) -> NoReturn:
        raise BadInput(f"{self.path}: {key.text}: {message}")

    def _tables_of(self, key: KeyPath, make: bool = False) -> list[dict[str, Any]]:
        """The tables that hold the key, made where they are to be set; an empty one where the file leaves it out."""
        found, before = [self.entries], ""
        for name, item in key.tables:
            before = f"{before}.{name}" if before else name
            if item is None:
                found = [table.setdefault(name, {}) if make else table.get(name, {}) for table in found]
                if not all(isinstance(table, dict) for table in found):
                    self._fail(key, f"{before} is no table in this file")
                continue
            every = [each for table in found for each in table.get(name, [])]
            if not 0 <= item <= len(every) or not every:
                there = f"this scene has {before}[1] to {before}[{len(every)}]" if every else "this scene has none"
                self._fail(key, f"there is no {before}[{'*' if item == EVERY else item}]; {there}")
            found = every if item == EVERY else [every[item - 1]]
        return found

    # ---- reading

    def _value_in(self, table: dict[str, Any], key: KeyPath) -> Any:
        given = self._given(table, key.name)
        if given is None:
            given = default_of(self.entries, table, key)
        if key.item is None or not isinstance(given, list):
            return given
        if key.item == EVERY:
            return given[0] if len(set(given)) == 1 else None
        return given[self._place(key, given)]

    def _given(self, table: dict[str, Any], name: str) -> Any:
        """What a table has, by this name or by another that says the same."""
        if name in table:
            return table[name]
        other = spelled_otherwise(name)
        if other in table:
            return math.radians(table[other]) if name.endswith("_rad") else math.degrees(table[other])
        if name in PLAIN and "distance_m" in table:
            return place_of(table)[PLAIN.index(name)]
        if name in (*POLAR, "bearing_deg") and "x_m" in table and "y_m" in table:
            x, y = table["x_m"], table["y_m"]
            bearing = math.atan2(y, x)
            return math.hypot(x, y) if name == "distance_m" else \
                bearing if name == "bearing_rad" else math.degrees(bearing)
        return None

    def _place(self, key: KeyPath, values: list[Any]) -> int:
        item = key.item or 0
        if item > len(values):
            self._fail(key, f"there is no number {item}; {key.name} has {len(values)} in this scene")
        return item - 1

    # ---- setting

    def _check_kind(self, key: KeyPath, value: Any) -> None:
        kinds: dict[str, tuple[type, ...]] = {"number": (int, float), "text": (str,), "true or false": (bool,),
                                              "whole number": (int,)}
        is_bool = isinstance(value, bool)
        if not isinstance(value, kinds[key.known.kind]) or (is_bool and key.known.kind != "true or false"):
            self._fail(key, f"{shown(value)} is not {'a ' if 'number' in key.known.kind else ''}{key.known.kind}")

    def _set(self, table: dict[str, Any], key: KeyPath, value: Any) -> None:
        if key.table == "vehicle.wheel[#]":
            convert_place(table, key.name)
        table.pop(spelled_otherwise(key.name), None)
        if key.item is None:
            table[key.name] = value
            return
        if key.name not in table:
            table[key.name] = self._fresh_list(key)
        values = table[key.name]
        if not isinstance(values, list):
            self._fail(key, f"{key.name} is no list in this file")
        places = range(len(values)) if key.item == EVERY else [self._place(key, values)]
        for place in places:
            values[place] = value

    def _fresh_list(self, key: KeyPath) -> list[float]:
        """Numbers for a list that the file leaves out; only a start's zeros mean what leaving them out means."""
        if key.table != "initial":
            self._fail(key, f"this scene has no {key.name} here; give the list in the file first")
        wheels = len(self.entries.get("vehicle", {}).get("wheel", []))
        return [0.0] * (key.known.items if key.known.items > 0 else wheels)


def scene_tables(given: str | Path | SceneTables) -> SceneTables:
    """The tables of a scene by its path, or by the name of one that comes with the project."""
    if isinstance(given, SceneTables):
        return given
    top = read_toml(scene_path(given))
    entries, run = top.plain(), top.plain().get("run")
    if isinstance(run, dict) and run.get("step_s") == AUTO:  # one step for all that is made of it
        entries["run"]["step_s"] = scene_of(top).run.step_s
        entries["run"].pop("tolerance")
    return SceneTables(top.path, entries)


def spelled_otherwise(name: str) -> str:
    """The name of an angle in its other unit; empty for what is no angle."""
    for one, other in (("_rad", "_deg"), ("_deg", "_rad")):
        if name.endswith(one):
            return name.removesuffix(one) + other
    return ""


def place_of(wheel: Mapping[str, Any]) -> tuple[float, float]:
    """x and y of a wheel that the file gives by distance and bearing, with the bits of the scene's reader."""
    bearing = math.radians(wheel["bearing_deg"]) if "bearing_deg" in wheel else wheel.get("bearing_rad", 0.0)
    return x_and_y(wheel["distance_m"], bearing)


def convert_place(wheel: dict[str, Any], name: str) -> None:
    """Lets a wheel have its place in the coordinates of the key that will be set."""
    if name in PLAIN and "distance_m" in wheel:
        wheel.update(zip(PLAIN, place_of(wheel), strict=True))
        for key in (*POLAR, "bearing_deg"):
            wheel.pop(key, None)
    elif name in (*POLAR, "bearing_deg") and "x_m" in wheel and "y_m" in wheel:
        x, y = wheel.pop("x_m"), wheel.pop("y_m")
        wheel.update(distance_m=math.hypot(x, y), bearing_rad=math.atan2(y, x))
