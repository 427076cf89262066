"""The reference of scene keys has every key that is read, and says of each what the reader does.

Signals: the page lists all of them and says what they are; what a scene lacks is refused with what it needs.
"""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

from friction_scenes import DRIVE, GROUND, slipping, with_tables
from laconic.base.paths import SCENE_DIR, SOURCE_DIR, scene_names
from laconic.core import Vehicle
from laconic.core.recording import MEMBERS
from laconic.errors import BadInput
from laconic.scene import Scene, build_scene, read_scene
from laconic.scene.keys import KEYS, TABLES, Key, read_number
from laconic.scene.methods import METHODS
from laconic.scene.reference import inputs, outputs, rows, unit_of
from laconic.scene.signals import NEEDED
from laconic.scene.table import REQUIRED, Table
from laconic.simulation import simulate
from laconic_build.site.scene_reference import descriptions, scene_page
from laconic_build.site.signals_page import page

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


PAGE = (SOURCE_DIR / "docs" / "signals.md").read_text(encoding="utf-8")
WITHOUT_SUPPLY = "[vehicle.drive]\ncurrent_limit_A = 0.9\n"


def test_the_page_is_made_of_what_the_program_knows_and_has_every_output() -> None:
    assert page() == PAGE, "run build/venv/bin/python -m laconic_build.site.signals_page"
    outputs = PAGE.split("## Outputs")[1]
    assert all(f"| `{name}` |" in outputs for name in (*MEMBERS, *NEEDED))
    assert "0 without" not in outputs


@pytest.mark.parametrize("signal, needs", [
    ("supply_current_A", "vehicle.drive.supply_V"), ("supply_voltage_V", "vehicle.drive.supply_V")])
def test_what_a_supply_shows_is_refused_without_its_voltage(signal: str, needs: str, tmp_path: Path) -> None:
    without = with_tables("robotino2", WITHOUT_SUPPLY, tmp_path)
    with pytest.raises(BadInput, match=f"signals: {signal} is the supply's, .* give {re.escape(needs)}"):
        simulate(without, [signal])
    given = simulate(with_tables("robotino2", DRIVE, tmp_path).with_run(duration_s=0.1), [signal])
    assert given.columns[signal].any()


def test_a_motors_current_is_refused_where_its_winding_is_not_known(tmp_path: Path) -> None:
    geared = with_tables("s1", GROUND, tmp_path)
    with pytest.raises(BadInput, match=r"motor_current_A is a motor's, .* give \[vehicle.motor\]"):
        simulate(geared, ["motor_current_A"])


@pytest.mark.parametrize("signal", ["slip_along_m_per_s", "slip_across_m_per_s[2]", "contact_state", "slip_loss_J"])
def test_slip_on_ideal_ground_is_refused_with_what_it_needs(signal: str) -> None:
    with pytest.raises(BadInput, match=f"{re.escape(signal)} is of slip .* give ground.friction_coefficient or"):
        simulate(read_scene("robotino2"), [signal])


def forces(scene: Scene, along: np.ndarray, lateral: np.ndarray) -> np.ndarray:
    """The sum of the ground's reactions on the wheels, in body axes, by the directions that the page gives."""
    total = np.zeros(2)
    for wheel, one, other in zip(scene.vehicle["wheel"], along, lateral, strict=True):
        angle = wheel["axle_rad"] + wheel.get("roller_rad", math.pi / 2)
        total += one * np.array([math.cos(angle), math.sin(angle)])
        total += other * np.array([math.sin(angle), -math.cos(angle)])
    return total


@pytest.mark.parametrize("name", ["robotino2", "kuka_youbot", "turtlebot3_burger", "example_two_wheel_sizes"])
def test_reactions_have_the_directions_of_the_page_on_ideal_ground(name: str) -> None:
    scene = read_scene(name)
    robot = Vehicle.of(scene)
    held = {f"voltage_V[{i + 1}]": 2.0 + i for i, wheel in enumerate(scene.vehicle["wheel"]) if wheel["driven"]}
    nu_rates = robot.derivative(inputs=held).nu_rad_per_s2
    seen = robot.plant().reactions(held)
    along, lateral = (robot.core.numbers(each)[: robot.wheel_count] for each in (seen.along_N, seen.lateral_N))
    expected = scene.vehicle["mass_kg"] * scene.vehicle["wheel_radius_m"] * nu_rates[:2]
    assert np.abs(forces(scene, along, lateral) - expected).max() < 1e-9 * np.abs(along).max()
    assert np.abs(expected).max() > 1e-3


def test_reactions_have_the_directions_of_the_page_on_ground_with_friction(tmp_path: Path) -> None:
    scene = slipping(tmp_path)
    plant = Vehicle.of(scene).plant(step_s=1e-3)
    held = {"voltage_V": [9.0, -2.0, 4.0], "body_force_N": [3.0, -1.0]}
    before = plant.body_velocity()[0]
    plant.run(held)
    seen = plant.reactions(held)
    along, lateral = (plant.core.numbers(each)[:3] for each in (seen.along_N, seen.lateral_N))
    vehicle, ground = scene.vehicle, scene.vehicle["ground"]
    downhill = -vehicle["mass_kg"] * 9.80665 * math.sin(ground["slope_rad"])
    slope = downhill * np.array([math.cos(ground["slope_heading_rad"]), math.sin(ground["slope_heading_rad"])])
    velocity, yaw_rate = plant.body_velocity()
    change = vehicle["mass_kg"] * (velocity - before) / 1e-3
    assert forces(scene, along, lateral) + slope + np.array([3.0, -1.0]) == pytest.approx(change, rel=2e-2)
    assert np.abs(lateral).max() > 0.1 and yaw_rate
