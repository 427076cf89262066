"""Logs of steered vehicles, rolled by the recorded angles of hinges and wheels."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from laconic.cli.main import run

WHEEL = """[[vehicle.wheel]]
kind = "fixed"
x_m = {}
y_m = {}
{}
"""
HEAD = """[vehicle]
mass_kg = 10.0
yaw_inertia_kgm2 = 0.5
wheel_radius_m = 0.1
wheel_inertia_kgm2 = 1e-3
motor_gain_Nm_per_V = 0.1
motor_damping_Nms = 0.1
"""
END = "[run]\nduration_s = 1.0\nstep_s = 0.01\n"
BASE_M, OFF_M = 1.2, 0.05
STEERED = 'steered = "motor"\nname = "front"\nscrub_m = {}\nsteering_gain_Nm_per_V = 1.0\nmass_kg = 1.0\n' \
    'yaw_inertia_kgm2 = 0.1'
REAR = "axle_deg = -90.0\ndriven = false"
MAP = """[time]
column = "t"
[wheel_angle]
columns = ["wheel"]
[steering_angle]
columns = ["steering"]
{}
[pose]
columns = ["x", "y", "heading"]
units = ["m", "m", "rad"]
"""
TICKS = 8192


def tricycle(folder: Path) -> Path:
    path = folder / "robot.toml"
    path.write_text(HEAD + WHEEL.format(BASE_M, 0.0, STEERED.format(0.0)) + WHEEL.format(0.0, 0.3, REAR) +
                    WHEEL.format(0.0, -0.3, REAR) + END)
    return path


def motion() -> np.ndarray:
    """t, wheel, steering, x, y, heading of a tricycle whose front wheel rolls 0.2 m/s, by small steps of its own."""
    steps, h = 40_000, 5e-4
    time = h * np.arange(steps + 1)
    steering = 0.7 * np.sin(0.8 * time)
    speed = 0.2
    heading = np.concatenate([[0.0], np.cumsum(h * speed * np.sin(0.5 * (steering[1:] + steering[:-1])) / BASE_M)])
    ahead = speed * np.cos(0.5 * (steering[1:] + steering[:-1]))
    middle = 0.5 * (heading[1:] + heading[:-1])
    x, y = (np.concatenate([[0.0], np.cumsum(h * ahead * f(middle))]) for f in (np.cos, np.sin))
    return np.column_stack([time, speed * time / 0.1, steering, x, y, heading])[::40]


def replayed(folder: Path, table: np.ndarray, keys: str, capsys: pytest.CaptureFixture[str]) -> float:
    (folder / "map.toml").write_text(MAP.format(keys))
    lines = ["t,wheel,steering,x,y,heading", *(",".join(f"{value:.12g}" for value in row) for row in table)]
    (folder / "run.csv").write_text("\n".join(lines) + "\n")
    assert run(["replay", str(folder / "run.csv"), str(tricycle(folder)), "--map", str(folder / "map.toml"),
                "--json"]) == 0
    found: float = json.loads(capsys.readouterr().out)["runs"][0]["path_error"]
    return found


def test_a_steered_wheel_rolls_along_its_direction(tmp_path, capsys):
    assert replayed(tmp_path, motion(), "", capsys) < 1e-5


def test_an_absolute_encoder_that_begins_again_at_zero_steers_to_both_sides(tmp_path, capsys):
    table = motion()
    table[:, 2] = np.mod(np.round(TICKS * (table[:, 2] - 0.1) / math.tau), TICKS)
    keys = f'unit = "tick"\nticks_per_turn = {TICKS}\nwrap = {TICKS}\noffset = 0.1'
    assert replayed(tmp_path, table, keys, capsys) < 1e-3


def test_degrees_signs_and_scales_of_steering_are_taken(tmp_path, capsys):
    table = motion()
    table[:, 2] *= -2.0 * 180.0 / math.pi
    assert replayed(tmp_path, table, 'unit = "deg"\nsign = -1\nscale = 0.5', capsys) < 1e-5


def test_steering_of_the_other_sense_is_called_a_poor_fit(tmp_path, capsys):
    table = motion()
    table[:, 2] *= -1.0
    assert replayed(tmp_path, table, "", capsys) > 0.1
    assert run(["replay", str(tmp_path / "run.csv"), str(tmp_path / "robot.toml"), "--map",
                str(tmp_path / "map.toml")]) == 0
    assert "the fit is poor" in (text := capsys.readouterr().out) and "with the sign of the steering reversed" in text


def test_one_angle_steers_both_wheels_of_a_car_about_one_centre(tmp_path, capsys):
    """Both rear wheels roll as the middle of their axle and the turn about it say."""
    table = motion()
    speed = np.gradient(table[:, 5], table[:, 0])
    way = 0.2 * np.concatenate([[0.0], np.cumsum(np.diff(table[:, 0]) * np.cos(
        0.5 * (table[1:, 2] + table[:-1, 2])))])
    assert np.isfinite(speed).all()
    front = 'steered = "coordinated"\nname = "{}"\ndriven = false'
    (tmp_path / "car.toml").write_text(
        HEAD + WHEEL.format(0.0, 0.3, "axle_deg = -90.0") + WHEEL.format(0.0, -0.3, "axle_deg = -90.0") +
        WHEEL.format(BASE_M, 0.3, front.format("left")) + WHEEL.format(BASE_M, -0.3, front.format("right")) +
        '[[input]]\nsignal = "steering_curvature_per_m"\nkind = "steps"\nt_s = [0.0]\nvalue = [0.1]\n' + END)
    (tmp_path / "map.toml").write_text(MAP.format("").replace('["wheel"]', '["left", "right"]'))
    wheels = [(way - side * 0.3 * table[:, 5]) / 0.1 for side in (1.0, -1.0)]
    rows = np.column_stack([table[:, 0], *wheels, table[:, 2:]])
    text = ["t,left,right,steering,x,y,heading", *(",".join(f"{value:.12g}" for value in row) for row in rows)]
    (tmp_path / "run.csv").write_text("\n".join(text) + "\n")
    assert run(["replay", str(tmp_path / "run.csv"), str(tmp_path / "car.toml"), "--map", str(tmp_path / "map.toml"),
                "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["runs"][0]["path_error"] < 1e-4


@pytest.mark.parametrize(("old", "new", "words"), [
    ('[steering_angle]\ncolumns = ["steering"]', "", "has no steering_angle_rad"),
    ('columns = ["steering"]', 'columns = ["steering"]\nhinges = ["rear"]', "has no hinge rear"),
    ('columns = ["steering"]', 'columns = ["steering", "heading"]', "name those of the columns in the map"),
    ('columns = ["steering"]', 'columns = ["steering"]\nhinges = ["front", "rear"]', "for each column"),
    ('columns = ["steering"]', 'columns = ["steering"]\nunit = "m"', "steering_angle")])
def test_maps_that_do_not_fit_the_hinges_are_refused_in_one_line(old, new, words, tmp_path, capsys):
    replayed(tmp_path, motion()[:50], "", capsys)
    (tmp_path / "map.toml").write_text((tmp_path / "map.toml").read_text().replace(old, new))
    assert run(["replay", str(tmp_path / "run.csv"), str(tmp_path / "robot.toml"), "--map",
                str(tmp_path / "map.toml")]) == 2
    why = capsys.readouterr().err
    assert words in why and why.count("\n") == 1


@pytest.mark.parametrize(("more", "words"), [
    (["--inputs", "voltages"], "--inputs voltages"), (["--fit", "run.csv"], "leave --fit out")])
def test_other_inputs_of_vehicles_with_hinges_are_refused(more, words, tmp_path, monkeypatch, capsys):
    replayed(tmp_path, motion()[:50], "", capsys)
    monkeypatch.chdir(tmp_path)
    assert run(["replay", "run.csv", "robot.toml", "--map", "map.toml", *more]) == 2
    why = capsys.readouterr().err
    assert words in why and why.count("\n") == 1


@pytest.mark.parametrize("columns", ['["x", "y", "heading"]\nunits = ["m", "m", "rad"]',
                                     '["x", "y"]\nunits = ["m", "m"]'])
def test_wheels_of_hinged_scenes_may_be_counters_that_begin_again(columns, tmp_path, capsys):
    table = motion()
    table[:, 1] = np.mod(np.round(TICKS * table[:, 1] / math.tau), TICKS)
    replayed(tmp_path, motion()[:50], "", capsys)
    (tmp_path / "map.toml").write_text((tmp_path / "map.toml").read_text().replace(
        'columns = ["wheel"]', f'columns = ["wheel"]\nunit = "tick"\nticks_per_turn = {TICKS}\nwrap = {TICKS}').replace(
        '["x", "y", "heading"]\nunits = ["m", "m", "rad"]', columns))
    lines = ["t,wheel,steering,x,y,heading", *(",".join(f"{value:.12g}" for value in row) for row in table)]
    (tmp_path / "run.csv").write_text("\n".join(lines) + "\n")
    assert run(["replay", str(tmp_path / "run.csv"), str(tmp_path / "robot.toml"), "--map", str(tmp_path / "map.toml"),
                "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["runs"][0]["path_error"] < 1e-3


def test_a_file_of_signals_of_a_robot_with_casters_is_rolled_by_its_wheels(tmp_path, capsys):
    log = tmp_path / "drive.csv"
    assert run(["simulate", "mir_like", "--out", str(log), "--inputs"]) == 0
    capsys.readouterr()
    assert run(["replay", str(log), "mir_like", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["runs"][0]["path_error"] < 1e-3
    assert run(["replay", str(log), "mir_like", "--inputs", "voltages"]) == 2
    assert "give --inputs wheel-speeds" in capsys.readouterr().err
