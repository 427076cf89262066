"""Recorded robots whose trackers are late or turned: a tricycle with a steered, driven wheel, and a mecanum base."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from laconic.base.paths import scene_path
from laconic.cli.main import run
from recorded_data import recorded

TRICYCLE, MECANUM = recorded("tricycle") / "run1.csv", recorded("mecanum_mocap")
HALF = 730
TRICYCLE_MAP = """[time]
column = "t_s"
[wheel_angle]
columns = ["traction_ticks_uint32"]
unit = "tick"
ticks_per_turn = 5000
gear_ratio = 65.7
wrap = 4294967296
[steering_angle]
columns = ["steering_ticks"]
unit = "tick"
ticks_per_turn = 8192
wrap = 8192
scale = 0.5
[pose]
columns = ["tracker_x_m", "tracker_y_m", "tracker_yaw_rad"]
"""
MECANUM_MAP = """[time]
column = "t_s"
[wheel_angle]
columns = ["ticks_front_left", "ticks_front_right", "ticks_rear_left", "ticks_rear_right"]
unit = "tick"
ticks_per_turn = 42
gear_ratio = 5
wrap = false
[pose]
columns = ["x_m", "y_m", "yaw_rad"]
"""
BASE = """[vehicle]
mass_kg = 15.0
yaw_inertia_kgm2 = 0.6
wheel_radius_m = 0.07
wheel_inertia_kgm2 = 2e-3
motor_gain_Nm_per_V = 0.1
motor_damping_Nms = 0.1
"""
WHEEL = """[[vehicle.wheel]]
kind = "mecanum"
x_m = {}
y_m = {}
axle_deg = -90.0
roller_deg = {}
"""
END = "[run]\nduration_s = 1.0\nstep_s = 0.01\n"


@pytest.mark.skipif(not TRICYCLE.exists(), reason="no recorded tricycle: it is not part of the project")
def test_half_a_tricycles_run_tells_steering_and_tracker_well_enough_for_the_other_half(tmp_path, capsys):
    head, *lines = TRICYCLE.read_text().splitlines()
    for name, part in (("first.csv", lines[:HALF]), ("second.csv", lines[HALF:])):
        (tmp_path / name).write_text("\n".join([head, *part]) + "\n")
    (tmp_path / "map.toml").write_text(TRICYCLE_MAP)
    assert run(["identify", str(tmp_path / "first.csv"), "--scene", str(scene_path("tricycle_agv")), "--map",
                str(tmp_path / "map.toml"), "--judge", str(tmp_path / "second.csv"), "--json", "--free",
                "radius,wheelbase,steering-gain,steering-offset,place,heading,clock-lag"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["means"]["judged"]["path_error"] <= 0.008
    values = {each["name"]: each for each in found["parameters"]}
    place = values["place of the tracker, x"]
    assert 1.6 < place["value"] < 1.9 and place["high"] - place["low"] < 0.2


def mecanum(folder: Path) -> list[str]:
    wheels = [(x, y, 45.0 if x * y > 0.0 else -45.0) for x in (0.2, -0.2) for y in (0.169, -0.169)]
    (folder / "base.toml").write_text(BASE + "".join(WHEEL.format(*wheel) for wheel in wheels) + END)
    (folder / "map.toml").write_text(MECANUM_MAP)
    return ["--scene", str(folder / "base.toml"), "--map", str(folder / "map.toml"), "--free",
            "radius,distance,heading", "--json"]


@pytest.mark.nightly
@pytest.mark.skipif(not MECANUM.exists(), reason="no recorded mecanum base: it is not part of the project")
@pytest.mark.parametrize(("fitted_on", "limit"), [((1, 2), 0.002), ((2,), 0.0013)])
def test_a_mecanum_base_is_found_with_the_turn_of_its_tracker(fitted_on, limit, tmp_path, capsys):
    logs = [str(MECANUM / f"run{number}.csv") for number in fitted_on]
    assert run(["identify", *logs, *mecanum(tmp_path)]) == 0
    assert json.loads(capsys.readouterr().out)["means"]["fitted"]["path_error"] <= limit + 1e-4


@pytest.mark.skipif(not MECANUM.exists(), reason="no recorded mecanum base: it is not part of the project")
def test_a_run_that_hardly_turns_does_not_tell_the_distance_of_the_wheels(tmp_path, capsys):
    assert run(["identify", str(MECANUM / "run1.csv"), *mecanum(tmp_path)]) == 0
    words = json.loads(capsys.readouterr().out)["words"]
    assert any(word.startswith("distance of the wheels: the runs do not tell it") and "circle" in word
               for word in words)
