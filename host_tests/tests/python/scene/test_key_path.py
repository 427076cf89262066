"""A key of a scene is read and set by its path.

laconic.build_scene: a scene from a program's tables is the one that a file with them has.
"""

from __future__ import annotations

import math
import sys

import numpy as np
import pytest

import laconic
from laconic.base.paths import SCENE_DIR
from laconic.errors import BadInput
from laconic.scene import read_scene
from laconic.scene.key_path import key_path, known_keys
from laconic.scene.methods import EXPLICIT
from laconic.scene.scene_tables import scene_tables

ROBOT = "robotino2"


@pytest.mark.parametrize(("key", "value"), [
    ("vehicle.wheel[2].axle_deg", 180.0), ("vehicle.wheel[2].axle_rad", math.pi), ("vehicle.wheel[2].x_m", -0.125),
    ("vehicle.wheel[*].radius_m", 0.04), ("vehicle.wheel[*].x_m", None), ("vehicle.wheel[*].roller_deg", 90.0),
    ("vehicle.payload.mass_kg", 0.0), ("vehicle.motor.gear_ratio", 16.0),
    ("vehicle.wheel[1].motor_gain_Nm_per_V", None), ("initial.nu_rad_per_s[2]", 0.0), ("input[1].value[2]", -2.12),
    ("run.method", "auto"), ("ground.slope_deg", 0.0), ("vehicle.wheel[3].driven", True)])
def test_a_value_is_read_as_it_holds_in_the_scene(key, value):
    assert scene_tables(ROBOT).value(key) == value


def test_a_value_that_is_set_is_the_scenes():
    tables = scene_tables(ROBOT).with_values({
        "vehicle.wheel[2].x_m": -0.12, "vehicle.wheel[*].radius_m": 0.041, "vehicle.wheel[1].axle_rad": 1.0,
        "initial.nu_rad_per_s[3]": 0.5, "input[1].value[2]": 2.5, "run.step_s": 0.002, "run.method": EXPLICIT})
    scene, before = tables.scene(), read_scene(ROBOT)
    wheels = scene.vehicle["wheel"]
    assert wheels[1]["x_m"] == -0.12
    assert wheels[1]["y_m"] == before.vehicle["wheel"][1]["y_m"], "the other coordinate keeps its bits"
    assert [wheel["radius_m"] for wheel in wheels] == [0.041] * 3
    assert wheels[0]["axle_rad"] == 1.0
    assert scene.initial.nu_rad_per_s == (0.0, 0.0, 0.5)
    assert scene.inputs[0].value[1] == 2.5
    assert (scene.run.step_s, scene.run.method) == (0.002, EXPLICIT)


def test_the_tables_of_a_file_stay_as_they_are_when_a_copy_is_changed():
    tables = scene_tables(ROBOT)
    tables.with_values({"vehicle.mass_kg": 9.0, "input[1].value[1]": 0.0})
    assert tables.entries == scene_tables(ROBOT).entries


def test_a_place_is_converted_to_the_coordinates_that_are_set():
    polar = scene_tables(ROBOT).with_values({"vehicle.wheel[1].x_m": 0.1, "vehicle.wheel[1].y_m": 0.1})
    assert polar.value("vehicle.wheel[1].bearing_deg") == pytest.approx(45.0, rel=1e-15)
    again = polar.with_values({"vehicle.wheel[1].distance_m": 0.2}).scene().vehicle["wheel"][0]
    assert (again["x_m"], again["y_m"]) == pytest.approx((0.2 * math.sqrt(0.5), 0.2 * math.sqrt(0.5)), rel=1e-15)


def test_the_text_of_changed_tables_is_the_same_scene(tmp_path):
    tables = scene_tables("paper_caster").with_values({"vehicle.mass_kg": 12.5})
    file = tmp_path / "again.toml"
    file.write_text(tables.toml(), encoding="utf-8")
    again = scene_tables(file)
    assert again.entries == tables.entries
    again.scene()


@pytest.mark.parametrize(("key", "words"), [
    ("vehicle.mas_kg", "did you mean mass_kg?"), ("mass_kg", "did you mean vehicle.mass_kg?"),
    ("vehicle.wheel.x_m", "vehicle.wheel[1], or [*]"), ("vehicle[1].mass_kg", "there is one vehicle"),
    ("vehicle.wheel[0].x_m", "count from 1"), ("vehicle.wheel[4].x_m", "vehicle.wheel[1] to vehicle.wheel[3]"),
    ("vehicle.support[1].x_m", "this scene has none"), ("vehicle.mass_kg[1]", "take [1] out"),
    ("vehicle.mass_kg[*]", "take [*] out"), ("initial.nu_rad_per_s", "initial.nu_rad_per_s[1]"),
    ("input[1].value[99]", "there is no number 99"), ("colour.x", "known tables are"), ("", "counted from 1"),
    ("vehicle..mass_kg", "counted from 1"), ("vehicle.wheel[-1].x_m", "counted from 1")])
def test_a_key_that_is_none_is_refused_with_the_remedy(key, words):
    with pytest.raises(BadInput) as refused:
        scene_tables(ROBOT).with_values({key: 1.0})
    assert words in str(refused.value)


@pytest.mark.parametrize(("key", "value"), [
    ("vehicle.mass_kg", "heavy"), ("vehicle.mass_kg", True), ("run.method", 4.0), ("vehicle.wheel[1].locked", 1.0)])
def test_a_value_of_another_kind_is_refused(key, value):
    with pytest.raises(BadInput, match="is not"):
        scene_tables(ROBOT).with_values({key: value})


def test_every_known_key_is_one_that_a_path_reaches():
    for path in known_keys():
        assert key_path(path.replace("[#]", "[1]") + ("[1]" if known_keys()[path].items else "")).known.path == path


if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib


def tables_of(name):
    return tomllib.loads((SCENE_DIR / f"{name}.toml").read_text(encoding="utf-8"))


@pytest.mark.parametrize("name", ["s1", "kuka_youbot", "skid_steer"])
def test_the_tables_of_a_file_make_the_run_of_the_file(name):
    built = laconic.build_scene(tables_of(name)).with_run(duration_s=0.5)
    read = laconic.read_scene(name).with_run(duration_s=0.5)
    ours, theirs = laconic.simulate(built), laconic.simulate(read)
    assert list(ours.columns) == list(theirs.columns)
    assert all(ours.columns[key].tobytes() == theirs.columns[key].tobytes() for key in theirs.columns)


def test_arrays_stand_for_lists_and_numpys_numbers_for_numbers():
    tables = tables_of("s1")
    tables["run"]["duration_s"] = np.float64(0.25)
    tables["input"] = [{"signal": "voltage_V[1]", "kind": "steps", "t_s": np.array([0.0]), "value": np.array([3.0])}]
    scene = laconic.build_scene(tables)
    assert scene.run.duration_s == 0.25
    assert laconic.simulate(scene, ("voltage_V[1]",)).columns["voltage_V[1]"][0] == 3.0


@pytest.mark.parametrize("change, message", [
    ({"vehicle": {}}, "^Robot: vehicle.mass_kg: is missing"),
    ({"run": {"duration_s": -1.0, "step_s": 0.01}}, "^Robot: run.duration_s: "),
    ({"vehicles": {}}, "^Robot: vehicles: is no known key here; did you mean vehicle"),
    ({"vehicle": 3}, "^Robot: vehicle: is 3, not ")])
def test_what_makes_no_scene_is_refused_by_its_key(change, message):
    with pytest.raises(laconic.BadInput, match=message):
        laconic.build_scene({**tables_of("s1"), "name": "Robot", **change})


def test_what_is_no_mapping_is_refused():
    with pytest.raises(laconic.BadInput, match="scene: 's1' is no mapping"):
        laconic.build_scene("s1")


def test_a_name_that_fills_a_page_is_refused_by_its_length() -> None:
    tables = {"name": "n" * 10**6, "vehicle": {"mass_kg": 1.0}, "run": {"duration_s": 1.0, "step_s": 0.1}}
    with pytest.raises(laconic.BadInput) as refused:
        laconic.build_scene(tables)
    assert str(refused.value).endswith("name: has 1000000 letters; give at most 255, and what else there is to say as "
                                       "source")
