"""The reference of scene keys has every key that is read, and says of each what the reader does."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from laconic.base.paths import SCENE_DIR, SOURCE_DIR, scene_names
from laconic.errors import BadInput
from laconic.scene import build_scene, read_scene
from laconic.scene.keys import KEYS, TABLES, Key, read_number
from laconic.scene.methods import METHODS
from laconic.scene.reference import inputs, outputs, rows, unit_of
from laconic.scene.table import REQUIRED, Table
from laconic_build.site.scene_reference import descriptions, scene_page

WORDS, OF_METHODS = descriptions(SOURCE_DIR)
ROWS = list(rows(WORDS, OF_METHODS))
PATHS = {f"{row.table}.{row.key}" if row.table else row.key for row in ROWS}
RULED = [key for key in KEYS.values() if key.rule is not None]
MOTOR_OF_A_HINGE = """
[vehicle]
mass_kg = 1.0
yaw_inertia_kgm2 = 0.1
wheel_radius_m = 0.05
[[vehicle.body]]
name = "arm"
hinge = "motor"
hinge_x_m = 0.1
mass_kg = 0.2
yaw_inertia_kgm2 = 0.01
[vehicle.body.motor]
resistance_ohm = 1.0
torque_constant_Nm_per_A = 0.1
back_emf_Vs_per_rad = 0.1
gear_ratio = 10.0
[run]
duration_s = 1.0
step_s = 0.1
"""
OUTSIDE = """
[frc]
drive = ["PWM[0]", "PWM[1]"]
[ardupilot]
[[ardupilot.channel]]
number = 1
signals = ["voltage_V[1]"]
full = 12.0
"""
VEHICLE = {"mass_kg": 1.0, "yaw_inertia_kgm2": 0.1, "wheel_radius_m": 0.05}


def whole_example() -> str:
    """The scene with most keys, from its page."""
    return re.search(r"```toml\n(.*?)```", (SOURCE_DIR / "docs/scenes.md").read_text(encoding="utf-8"), re.DOTALL)[1]


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> set[str]:
    """Every key that a table is asked for, angles by their name in rad: others are refused as unknown."""
    found: set[str] = set()
    has = Table.has

    def noted(table: Table, key: str) -> bool:
        found.add(re.sub(r"\[\d+\]", "[#]", table.name(key.removesuffix("_deg") + "_rad" * key.endswith("_deg"))))
        return has(table, key)

    monkeypatch.setattr(Table, "has", noted)
    return found


def test_every_key_that_the_reader_knows_is_in_the_reference_and_no_other(asked: set[str], tmp_path: Path) -> None:
    page = tmp_path / "page.toml"
    page.write_text(whole_example() + OUTSIDE, encoding="utf-8")
    hinge = tmp_path / "hinge.toml"
    hinge.write_text(MOTOR_OF_A_HINGE, encoding="utf-8")
    for name in (*scene_names(), page, hinge):
        read_scene(name)
    tables = {table.removesuffix("[#]") for table in TABLES} - {""}
    assert asked - tables == PATHS
    assert tables <= asked


def keys_in(entries: dict[str, Any], table: str = "") -> set[str]:
    """The keys of a file with their tables."""
    found: set[str] = set()
    for key, value in entries.items():
        path = f"{table}.{key}" if table else key
        several = isinstance(value, list) and value and isinstance(value[0], dict)
        inner = value if several else [value] if isinstance(value, dict) else []
        for each in inner:
            found |= keys_in(each, path + "[#]" * several)
        found |= set() if inner else {path}
    return found


@pytest.mark.parametrize("name", scene_names())
def test_every_key_of_every_scene_that_comes_with_the_project_is_on_the_page(name: str) -> None:
    from laconic.scene.table import read_toml

    page = scene_page(SOURCE_DIR)
    for path in keys_in(read_toml(SCENE_DIR / f"{name}.toml").plain()):
        head, _, key = path.rpartition(".")
        part = page.split(f"## {_head(head)}\n")[1].split("\n## ")[0]
        assert f"`{key}`" in part, path


def _head(table: str) -> str:
    plain = table.replace("[#]", "")
    return "Top" if not table else f"`[[{plain}]]`" if table.endswith("[#]") else f"`[{plain}]`"


def test_every_row_says_what_its_key_is() -> None:
    for row in ROWS:
        assert row.kind and row.default and len(row.meaning.split()) > 1, row
    assert tuple(OF_METHODS) == METHODS
    assert len(PATHS) == len(ROWS) > 90
    assert all(signal.meaning for signal in (*inputs(WORDS), *outputs(WORDS)))


def test_the_unit_at_the_end_of_a_name_is_the_variables_in_the_fmus() -> None:
    root = ElementTree.parse(SOURCE_DIR / "modelDescription.xml").getroot()
    units = {each.get("name"): each.get("unit", "") for each in root.iterfind(".//TypeDefinitions/*")}
    plain = {"·": ".", "²": "2", "√Hz": "sqrt(Hz)", "Ω": "Ohm"}
    compared = 0
    for variable in root.iterfind(".//ModelVariables/Float64"):
        name, unit = variable.get("name", ""), units.get(variable.get("declaredType"), "")
        shown = unit_of(name)
        for sign, letters in plain.items():
            shown = shown.replace(sign, letters)
        if not name.startswith("der(") and name != "time":
            assert shown == unit, name
            compared += 1
    assert compared > 70


@pytest.mark.parametrize("key", RULED, ids=lambda key: key.path)
def test_a_number_outside_the_range_of_the_reference_is_refused_in_its_words(key: Key) -> None:
    table, name = key.path.rpartition(".")[0].replace("[#]", "[1]"), key.path.rpartition(".")[2]
    assert key.rule is not None
    outside = {"above 0": (0.0, -1.0), "0 or more": (-1.0,), "not 0": (0.0,)}[key.rule.range]
    for value in outside:
        with pytest.raises(BadInput, match=re.escape(f"{name}: is {value:g}; give {key.rule.words}")):
            read_number(Table(Path("my.toml"), table, {name: value}), name)
    inside = 1.0
    assert read_number(Table(Path("my.toml"), table, {name: inside}), name) == inside


def test_what_is_not_given_has_the_references_value() -> None:
    scene = build_scene({"name": "puck", "vehicle": VEHICLE, "run": {"duration_s": 1.0, "step_s": 0.1}})
    read: dict[str, Any] = {"source": scene.source, "run": scene.run, "initial": scene.initial, "rig": scene.rig}
    compared = 0
    for path, key in KEYS.items():
        table, _, name = path.rpartition(".")
        if (table or name) in read and key.default not in (REQUIRED, None):
            value = getattr(read[table], name) if table else read[name]
            assert value == key.default, path
            compared += 1
    assert compared == 6
