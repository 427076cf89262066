"""Logs as people have them: other decimals, encodings, missing encoders; messages that help where one is refused."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from laconic.cli.main import run
from laconic.errors import BadInput
from laconic.robot.logs import gather_logs
from laconic.robot.logs.for_vehicle import for_wheels
from laconic.robot.replay.held_wheels import hold
from laconic.robot.replay.measures import path_errors
from laconic.robot.replay.rolling import rolling_of, rotations_of
from laconic.scene import read_scene

HEAD = ["Zeit", "Rad 1", "Rad 2", "Rad 3", "x", "y", "Winkel"]
MAP = """name = "own"
separator = ";"
[time]
column = "Zeit"
unit = "ms"
[wheel_angle]
columns = ["Rad 1", "Rad 2", "Rad 3"]
[pose]
columns = ["x", "y", "Winkel"]
[yaw_rate]
column = "Winkel"
optional = true
"""


def rows(count: int = 20) -> list[list[float]]:
    return [[50.0 * k, 0.1 * k, -0.2 * k, 0.1 * k, 0.01 * k, 0.002 * k, 0.001 * k] for k in range(count)]


def written(folder: Path, *, comma: bool = False, encoding: str = "utf-8", head: list[str] = HEAD, change=(),
            wheels: str = "") -> tuple[Path, Path]:
    """A log and its map."""
    lines = [";".join(head), *(";".join(f"{value:.4f}" for value in row) for row in rows())]
    text = "\n".join(lines).replace(".", ",") if comma else "\n".join(lines)
    log, mapped = folder / "fahrt.csv", folder / "map.toml"
    log.write_bytes(text.encode(encoding))
    words = MAP.replace('separator = ";"', 'separator = ";"' + ('\ndecimal = ","' if comma else ""))
    for old, new in change:
        words = words.replace(old, new)
    mapped.write_text(words.replace("[pose]", f"{wheels}\n[pose]"))
    return log, mapped


def read(folder: Path, **how):
    (log,), _ = gather_logs([(pair := written(folder, **how))[0]], pair[1])
    return log


@pytest.mark.parametrize("how", [{"comma": True}, {"encoding": "utf-16"}, {"encoding": "utf-8-sig"},
                                 {"encoding": "cp1252", "head": [*HEAD[:-1], "Höhe °"],
                                  "change": [('"Winkel"', '"Höhe °"')]}], ids=str)
def test_decimal_commas_and_the_encodings_of_other_systems_are_the_same_log(how, tmp_path):
    plain, other = read(tmp_path), read(tmp_path, **how)
    assert np.array_equal(plain.wheel_angle_rad, other.wheel_angle_rad) and np.array_equal(plain.pose, other.pose)
    assert np.array_equal(other.yaw_rate_rad_per_s, plain.pose[:, 2])


REFUSED = {
    "decimal commas": ({"comma": True, "change": [('\ndecimal = ","', "")]}, "'0,0000'; decimal = \",\" in the map"),
    "decimal points": ({"change": [('separator = ";"', 'separator = ";"\ndecimal = ","')]}, 'decimal = "." in the map'),
    "a column that is none": ({"change": [('"Rad 2"', '"Encoder"')]}, "it has 'Zeit', 'Rad 1', 'Rad 2', 'Rad 3', 'x'"),
    "a column almost right": ({"change": [('"Winkel"', '"Winkl"')]}, "did you mean Winkel?"),
    "a scale of 0 for a gyro": ({"change": [("optional", "scale = 0\noptional")]}, "yaw_rate.scale"),
}


@pytest.mark.parametrize(("how", "words"), REFUSED.values(), ids=REFUSED)
def test_what_a_map_has_wrong_is_said_with_the_remedy(how, words, tmp_path):
    log, mapped = written(tmp_path, **how)
    with pytest.raises(BadInput) as refused:
        gather_logs([log], mapped)
    assert words in str(refused.value)


def test_a_line_with_a_cell_too_many_is_refused_by_its_number(tmp_path):
    log, mapped = written(tmp_path)
    lines = log.read_text().splitlines()
    log.write_text("\n".join([*lines[:5], lines[5] + ";7", *lines[6:]]))
    with pytest.raises(BadInput, match="line 6: has 8 columns, the line of names 7"):
        gather_logs([log], mapped)
    log.write_text("\n".join([*lines[:5], lines[5] + ";", *lines[6:]]))
    gather_logs([log], mapped)


def test_the_name_of_a_map_that_is_almost_one_is_answered_with_the_one(tmp_path, capsys):
    log, _ = written(tmp_path)
    assert run(["replay", str(log), "robotino2", "--map", "robotin"]) == 2
    assert "did you mean robotino?" in capsys.readouterr().err


def four_wheels():
    """Mecanum wheels, of which the second has no motor."""
    vehicle = read_scene("optiodom_omni4").vehicle
    wheels = [{**wheel, "driven": index != 1} for index, wheel in enumerate(vehicle["wheel"])]
    return {**vehicle, "wheel": wheels}


@pytest.mark.parametrize(("named", "angles"), [("", [0.3, -0.6, 0.3]), ("wheels = [3, 1, 4]", [-0.6, 0.3, 0.3])])
def test_a_wheel_without_motor_and_encoder_is_left_out_of_rolling(named, angles, tmp_path):
    scene, vehicle = read_scene("optiodom_omni4"), four_wheels()
    log = for_wheels(read(tmp_path, wheels=named), vehicle["wheel"])
    assert np.isnan(log.wheel_angle_rad[:, 1]).all()
    assert log.wheel_angle_rad[3, [0, 2, 3]] == pytest.approx(angles)
    moved = np.array([[0.02, 0.01, 0.03]])
    rotation = rotations_of(scene.core(), vehicle, moved)
    rotation[:, 1] = np.nan
    assert rolling_of(scene.core(), vehicle, scene.path).moved(rotation) == pytest.approx(moved, abs=1e-14)


def test_a_missing_wheel_that_has_a_motor_is_refused(tmp_path):
    with pytest.raises(BadInput, match="has 3 wheels, the scene 4; .* or driven = false"):
        for_wheels(read(tmp_path), read_scene("optiodom_omni4").vehicle["wheel"])


def test_a_wheel_without_encoder_rolls_along_on_ground_with_friction(tmp_path):
    scene, vehicle = read_scene("optiodom_omni4"), four_wheels()
    vehicle.pop("friction_coefficient")
    vehicle["ground"] = {"friction_coefficient": 0.5, "roller_drag": 0.1}
    log = for_wheels(read(tmp_path), vehicle["wheel"])
    moved = np.tile([0.005, 0.002, 0.0], (len(log.time_s) - 1, 1))
    rotation = rotations_of(scene.core(), vehicle, moved)
    rotation[:, 1] = np.nan
    held = hold(scene.core(), vehicle, _with_angles(log, rotation))
    assert held.pose[-1] == pytest.approx([0.005 * len(moved), 0.002 * len(moved), 0.0], abs=0.01)


def _with_angles(log, rotation):
    """The log with these rotations of its wheels from sample to sample."""
    angle = np.vstack([np.zeros(rotation.shape[1]), np.cumsum(rotation, axis=0)])
    return replace(log, wheel_angle_rad=angle, pose=None)


def test_a_path_that_ends_where_it_began_has_no_displacement_error(tmp_path):
    log = read(tmp_path)
    around = np.linspace(0.0, 2.0 * np.pi, len(log.time_s))
    closed = replace(log, time_s=np.arange(len(around)) * 1.0,
                     pose=np.column_stack([np.cos(around), np.sin(around) + 1e-3 * around, around]))
    errors = path_errors("run", closed, closed.pose + 0.01)
    assert errors.displacement_error is None and errors.path_error > 0.0
    assert json.loads(json.dumps(errors.as_json()))["displacement_error"] is None


def test_a_log_without_a_pose_is_pointed_to_the_inputs_that_it_has(tmp_path, capsys):
    log, mapped = written(tmp_path, change=[("[pose]", "[voltage]"), ("optional = true", "")])
    assert run(["replay", str(log), "robotino2", "--map", str(mapped)]) == 2
    assert "has no true pose to compare with" in (err := capsys.readouterr().err) and "--inputs voltages" in err
