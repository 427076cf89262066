"""An audit gives each cause of an odometry error its share, and exports what it found."""

from __future__ import annotations

import json
import math
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from bag_support import HALF_TRACK_M, RADIUS_M, scene_of
from laconic.base.paths import scene_path
from laconic.cli.main import run
from laconic.robot.identify.report import interval
from laconic.robot.replay.rolling import path_of
from laconic.scene.scene_text import rewritten
from laconic.scene.table import entries_of
from recorded_data import recorded

MOCAP = recorded("mecanum_mocap")


def log_of(folder: Path, left: float = 1.0, right: float = 1.0, track: float = 1.0,
           lag_s: float = 0.0) -> tuple[Path, Path]:
    """A run with turns both ways of a robot whose numbers are off by these factors, and its map."""
    time = 0.02 * np.arange(1500)
    ahead, turn = 8.0 + 4.0 * np.sin(0.7 * time), 6.0 * np.sin(0.31 * time) + 3.0 * np.sin(1.3 * time)
    speeds = np.column_stack([ahead - turn, ahead + turn])
    angles = np.vstack([np.zeros(2), np.cumsum(speeds[:-1] * 0.02, axis=0)])
    way = np.diff(angles, axis=0) * RADIUS_M * np.array([left, right])
    moved = np.column_stack([way.mean(axis=1), 0.0 * way[:, 0], (way[:, 1] - way[:, 0]) / (2.0 * HALF_TRACK_M * track)])
    pose = path_of(moved, np.zeros(3))
    pose = np.column_stack([np.interp(time - lag_s, time, column) for column in pose.T])
    lines = ["t,left,right,x,y,yaw", *(",".join(f"{value:.9g}" for value in row)
                                       for row in np.column_stack([time, angles, pose]).tolist())]
    (folder / "run.csv").write_text("\n".join(lines) + "\n")
    (folder / "map.toml").write_text('[time]\ncolumn = "t"\n[wheel_angle]\ncolumns = ["left", "right"]\n[pose]\n'
                                     'columns = ["x", "y", "yaw"]\n')
    return folder / "run.csv", folder / "map.toml"


def audited(capsys, log: Path, mapping: Path, scene: Path, *more: str) -> dict:
    assert run(["audit", str(log), str(scene), "--map", str(mapping), "--json", *more]) == 0, capsys.readouterr().err
    return json.loads(capsys.readouterr().out)


@pytest.mark.parametrize("off,cause", [
    ({"left": 1.03, "right": 1.03}, "radius of the wheels"), ({"left": 1.02, "right": 0.98}, "radius of the wheels"),
    ({"track": 1.05}, "distance of the wheels")])
def test_the_cause_gets_the_error(off, cause, tmp_path, capsys):
    found = audited(capsys, *log_of(tmp_path, **off), scene_of(tmp_path))
    shares = {each["name"]: each["share"] for each in found["causes"]}
    assert max(shares, key=shares.get) == cause and shares[cause] > 0.6
    assert found["found"] < 0.02 * found["nominal"]
    assert sum(shares.values()) + found["left"] == pytest.approx(1.0)


def test_a_late_pose_is_found_with_its_lag(tmp_path, capsys):
    found = audited(capsys, *log_of(tmp_path, lag_s=0.1, track=1.05), scene_of(tmp_path))
    assert found["lag_s"] == pytest.approx(0.1, abs=0.003)
    assert found["found"] < 0.05 * found["nominal"]


AHEAD_M, LEFT_M, TURNED_RAD = 0.02, -0.01, 0.03


def tracked(folder: Path, log: Path, has_heading: bool) -> None:
    """Makes the pose of a log that of a tracker elsewhere on the robot."""
    head, *rows = log.read_text().splitlines()
    table = np.loadtxt(rows, delimiter=",")
    cos, sin = np.cos(table[:, -1]), np.sin(table[:, -1])
    table[:, -3] += cos * AHEAD_M - sin * LEFT_M
    table[:, -2] += sin * AHEAD_M + cos * LEFT_M
    table[:, -1] += TURNED_RAD
    log.write_text("\n".join([head, *(",".join(f"{value:.9g}" for value in row) for row in table)]) + "\n")
    mapping = folder / "map.toml"
    mapping.write_text(mapping.read_text() if has_heading else mapping.read_text().replace(', "yaw"]', "]"))


@pytest.mark.parametrize("point", [pytest.param("origin", marks=pytest.mark.nightly), "centre_of_mass", "positions"])
def test_the_tracker_has_its_row_and_its_place_whatever_point_the_log_has(point, tmp_path, capsys):
    log, mapping = log_of(tmp_path, track=1.02)
    tracked(tmp_path, log, point != "positions")
    if point == "centre_of_mass":
        mapping.write_text(mapping.read_text() + 'point = "centre_of_mass"\n')
    out = tmp_path / "out"
    found = audited(capsys, log, mapping, scene_of(tmp_path), "-o", str(out), "--export", str(tmp_path / "new.toml"))
    assert "place of the tracker" in [each["name"] for each in found["causes"]]
    assert found["found"] < 0.05 * found["nominal"]
    values = {each["name"]: each["value"] for each in found["fit"]["parameters"]}
    assert values["place of the tracker, x"] == pytest.approx(AHEAD_M, abs=1e-3)
    assert values["place of the tracker, y"] == pytest.approx(LEFT_M, abs=1e-3)
    if point != "positions":
        assert values["heading of the tracker"] == pytest.approx(TURNED_RAD, abs=1e-3)
    page = (out / "audit.md").read_text()
    assert "| place of the tracker |" in page and "of the robot, " not in page and "heading of the robot" not in page
    assert run(["replay", str(log), str(tmp_path / "new.toml"), "--map", str(mapping), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["runs"][0]["path_error"] < 0.1 * found["nominal"]


def test_a_robot_without_faults_is_said_to_have_none(tmp_path, capsys):
    found = audited(capsys, *log_of(tmp_path), scene_of(tmp_path))
    assert found["nominal"] < 1e-6 and found["lag_s"] is None
    assert found["gains"]["ahead"] == pytest.approx(1.0, abs=1e-4)


def test_a_page_and_every_export_hold_the_numbers(tmp_path, capsys):
    log, mapping = log_of(tmp_path, left=1.02, right=0.99, track=1.05)
    out, files = tmp_path / "out", [tmp_path / name for name in ("control.yaml", "robot.h", "fitted.toml")]
    options = [word for path in files for word in ("--export", str(path))]
    audited(capsys, log, mapping, scene_of(tmp_path), "-o", str(out), *options)
    page = (out / "audit.md").read_text()
    assert "![audit.png](audit.png)" in page and "distance of the wheels" in page
    assert (out / "audit.png").read_bytes().startswith(b"\x89PNG")
    given = {key: float(value) for key, value in re.findall(r"(\w+): ([\d.]+)$", files[0].read_text(), re.MULTILINE)}
    assert given["wheel_radius"] == RADIUS_M and given["wheel_separation"] == pytest.approx(2.0 * HALF_TRACK_M)
    assert given["left_wheel_radius_multiplier"] == pytest.approx(1.02, abs=2e-3)
    assert given["right_wheel_radius_multiplier"] == pytest.approx(0.99, abs=2e-3)
    assert given["wheel_separation_multiplier"] == pytest.approx(1.05, abs=2e-3)
    header = files[1].read_text()
    radius = float(re.search(r"ROBOT_WHEEL_1_RADIUS_M \(([\d.]+)\)", header)[1])
    assert radius == pytest.approx(1.02 * RADIUS_M, rel=2e-3)
    capsys.readouterr()
    assert run(["replay", str(log), str(files[2]), "--map", str(mapping), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["runs"][0]["path_error"] < 1e-3
    if compiler := shutil.which("cc"):
        subprocess.run([compiler, "-std=c99", "-Werror", "-fsyntax-only", "-x", "c", str(files[1])], check=True)


def test_the_joints_of_a_table_without_names_are_those_of_the_scene(tmp_path, capsys):
    """And a robot whose wheels only roll ahead is not said to roll to the left."""
    scene, out = scene_of(tmp_path), tmp_path / "control.yaml"
    scene.write_text(scene.read_text() + '[base]\njoint_names = ["wheel_left_joint", "wheel_right_joint"]\n')
    log, mapping = log_of(tmp_path, left=1.02)
    assert run(["audit", str(log), str(scene), "--map", str(mapping), "--export", str(out)]) == 0
    text = out.read_text()
    assert 'left_wheel_names: ["wheel_left_joint"]' in text and 'right_wheel_names: ["wheel_right_joint"]' in text
    page = capsys.readouterr().out
    assert "wheels roll ahead, the robot moves" in page and "wheels roll to the left" not in page


def test_a_robot_that_rolls_to_the_left_is_told_how_far(tmp_path, capsys):
    log = tmp_path / "run.csv"
    assert run(["simulate", "robotino2", "--out", str(log), "--inputs"]) == 0
    assert run(["audit", str(log), "robotino2"]) == 0
    assert "wheels roll to the left, the robot moves 1.0000 m" in capsys.readouterr().out


@pytest.mark.parametrize("value,half", [(0.0333301, 2.1e-8), (0.033, 1e-4), (-1.5, 3e-9), (0.0, 0.1), (2.0, 0.0)])
def test_both_ends_of_an_interval_show_its_width(value, half):
    low, high = map(float, interval(value, half).split(" … "))
    assert high - low == pytest.approx(2.0 * half, rel=0.1)


def test_what_cannot_be_exported_or_audited_is_one_line(tmp_path, capsys):
    log, mapping = log_of(tmp_path)
    text = scene_of(tmp_path).read_text()
    (tmp_path / "slips.toml").write_text(f"{text}[ground]\nfriction_coefficient = 0.5\n")
    (tmp_path / "none.toml").write_text(mapping.read_text().partition("[pose]")[0])
    for scene, chosen, words in (("slips.toml", mapping, "has a [ground] with friction"),
                                 ("robot.toml", tmp_path / "none.toml", "has no pose, which an audit needs")):
        assert run(["audit", str(log), str(tmp_path / scene), "--map", str(chosen)]) == 2
        error = capsys.readouterr().err
        assert error.count("\n") == 1 and words in error


@pytest.mark.skipif(not MOCAP.is_dir(), reason="recorded runs are not here")
def test_a_recorded_mecanum_base_is_calibrated_by_its_map_alone(tmp_path, capsys):
    scene, mapping = tmp_path / "mecanum.toml", tmp_path / "map.toml"
    wheels = "".join(f'[[vehicle.wheel]]\nkind = "mecanum"\nx_m = {x}\ny_m = {y}\naxle_deg = -90\n'
                     f"roller_deg = {45 if x * y > 0 else -45}\n" for x in (0.2, -0.2) for y in (0.169, -0.169))
    body = scene_of(tmp_path).read_text().replace("= 0.033", "= 0.07")
    scene.write_text(f"{body[:body.index('[[vehicle.wheel]]')]}{wheels}{body[body.index('[run]'):]}")
    assert run(["logs", str(MOCAP / "run1.csv"), "--scene", str(scene), "-o", str(mapping)]) == 0
    text = mapping.read_text()
    mapping.write_text(re.sub("# ticks_per_turn.*", "ticks_per_turn = 42\ngear_ratio = 5", text))
    capsys.readouterr()
    found = audited(capsys, MOCAP / "run1.csv", mapping, scene)
    assert found["nominal"] == pytest.approx(0.0217, abs=5e-4) and found["found"] < 0.003
    heading = next(each for each in found["fit"]["parameters"] if each["name"] == "heading of the tracker")
    assert -math.radians(5.0) < heading["value"] < 0.0


WHEEL = '[[vehicle.wheel]]\nkind = "fixed"\nx_m = {}\ny_m = {}\naxle_deg = -90.0\n{}\n'
FRONT = 'steered = "{}"\nname = "{}"\n'
MOTOR = "mass_kg = 1.0\nyaw_inertia_kgm2 = 0.1\nsteering_gain_Nm_per_V = 1.0\n"
BASE_M, HALF_M, WHEEL_M = 1.2, 0.3, 0.1


def steered_scene(folder: Path, kind: str) -> Path:
    """A tricycle that its front wheel drives and steers, or a car with two coordinated front wheels."""
    text = scene_of(folder).read_text().replace("= 0.033", f"= {WHEEL_M}")
    rear = "".join(WHEEL.format(0.0, side * HALF_M, "driven = false" if kind == "tricycle" else "")
                   for side in (1.0, -1.0))
    front = WHEEL.format(BASE_M, 0.0, FRONT.format("motor", "front") + MOTOR) if kind == "tricycle" else "".join(
        WHEEL.format(BASE_M, side * HALF_M, FRONT.format("coordinated", f"front_{name}") + "driven = false\n")
        for name, side in (("left", 1.0), ("right", -1.0)))
    path = folder / f"{kind}.toml"
    order = front + rear if kind == "tricycle" else rear + front
    path.write_text(f"{text[:text.index('[[vehicle.wheel]]')]}{order}{text[text.index('[run]'):]}")
    return path


def steered_log(folder: Path, kind: str, *, radius: float = 1.0, base: float = 1.0, gain: float = 1.0,
                offset: float = 0.0, ahead_m: float = 0.0, lag_s: float = 0.0) -> tuple[Path, Path]:
    """A run of a vehicle whose numbers are off by these factors, and its map."""
    time = 0.002 * np.arange(30_001)
    told = 0.5 * np.sin(0.5 * time) + 0.25 * np.sin(0.23 * time) + 0.1
    angle = gain * told + offset
    middle = 0.5 * (angle[1:] + angle[:-1])
    way = 0.002 * (0.6 + 0.2 * np.sin(0.3 * time[1:]))  # of the wheel that steers, or of the rear axle's middle
    ahead, turn = (way * np.cos(middle), way * np.sin(middle) / (base * BASE_M)) if kind == "tricycle" else (
        way, way * np.tan(middle) / (base * BASE_M))
    pose = path_of(np.column_stack([ahead, 0.0 * ahead, turn]), np.zeros(3))
    pose[:, :2] += ahead_m * np.column_stack([np.cos(pose[:, 2]), np.sin(pose[:, 2])])
    pose = np.column_stack([np.interp(time - lag_s, time, column) for column in pose.T])
    rolled = [way] if kind == "tricycle" else [ahead - side * HALF_M * base * turn for side in (1.0, -1.0)]
    wheels = [np.concatenate([[0.0], np.cumsum(each)]) / (radius * WHEEL_M) for each in rolled]
    names = [f"wheel{number}" for number in range(len(wheels))]
    rows = np.column_stack([time, *wheels, told, pose])[::20]
    lines = [",".join(["t", *names, "steering_rad", "x", "y", "yaw"]),
             *(",".join(f"{value:.9g}" for value in row) for row in rows.tolist())]
    (folder / "run.csv").write_text("\n".join(lines) + "\n")
    (folder / "map.toml").write_text(
        f'[time]\ncolumn = "t"\n[wheel_angle]\ncolumns = {json.dumps(names)}\n[steering_angle]\ncolumns = '
        '["steering_rad"]\n[pose]\ncolumns = ["x", "y", "yaw"]\n')
    return folder / "run.csv", folder / "map.toml"


STEERED_CAUSES = [
    ({"radius": 1.04}, "radius of the wheels", "radius of the wheels, factor", 1.04),
    ({"base": 1.08}, "distance of the wheels", "distance of the wheels, factor", 1.08),
    ({"gain": 0.8}, "gain of the steering", "gain of the steering, factor", 0.8),
    ({"offset": 0.03}, "offset of the steering", "offset of the steering", 0.03),
    ({"ahead_m": 0.4}, "place of the tracker", "place of the tracker, x", 0.4)]


@pytest.mark.parametrize(("kind", "off", "cause", "name", "value"), [
    pytest.param(kind, *each, marks=[] if (kind == "car") == (number % 2 > 0) else [pytest.mark.nightly])
    for number, each in enumerate(STEERED_CAUSES) for kind in ("tricycle", "car")])
def test_the_cause_gets_the_error_of_a_steered_vehicle(kind, off, cause, name, value, tmp_path, capsys):
    found = audited(capsys, *steered_log(tmp_path, kind, **off), steered_scene(tmp_path, kind))
    shares = {each["name"]: each["share"] for each in found["causes"]}
    assert max(shares, key=shares.get) == cause and shares[cause] > 0.6
    assert found["found"] < 0.05 * found["nominal"]
    assert sum(shares.values()) + found["left"] == pytest.approx(1.0)
    fitted = {each["name"]: each["value"] for each in found["fit"]["parameters"]}
    assert fitted[name] == pytest.approx(value, rel=0.03)


def test_a_late_tracker_of_a_steered_vehicle_is_found_with_its_lag(tmp_path, capsys):
    found = audited(capsys, *steered_log(tmp_path, "car", lag_s=0.15, gain=0.9), steered_scene(tmp_path, "car"))
    assert found["lag_s"] == pytest.approx(0.15, abs=0.02) and found["found"] < 0.1 * found["nominal"]


@pytest.mark.parametrize(("kind", "controller", "base"), [
    ("tricycle", "tricycle_controller", "wheel_radius"), pytest.param(
        "car", "ackermann_steering_controller", "traction_wheels_radius", marks=pytest.mark.nightly)])
def test_steered_vehicles_are_exported_for_their_controllers(kind, controller, base, tmp_path, capsys):
    files = [tmp_path / name for name in ("control.yaml", "robot.h")]
    options = [word for path in files for word in ("--export", str(path))]
    scene = steered_scene(tmp_path, kind)
    audited(capsys, *steered_log(tmp_path, kind, radius=1.03, base=1.05, offset=0.02), scene, "-o",
            str(tmp_path / "out"), *options)
    text = files[0].read_text()
    given = {key: float(value) for key, value in re.findall(r"(\w+): ([\d.]+)$", text, re.MULTILINE)}
    assert f"\n{controller}:\n" in text and "add 0.0" in text
    assert given["wheelbase"] == pytest.approx(1.05 * BASE_M, rel=0.01)
    assert given[base] == pytest.approx(1.03 * WHEEL_M, rel=0.01)
    assert "ROBOT_STEERING_OFFSET_RAD (0.0" in files[1].read_text()
    assert (tmp_path / "out" / "audit.png").read_bytes().startswith(b"\x89PNG")
    page = (tmp_path / "out" / "audit.md").read_text()
    assert "offset of the steering" in page and "mm/m ahead" in page and "rollers" not in page


@pytest.mark.parametrize("kind", [pytest.param("tricycle", marks=pytest.mark.nightly), "car"])
def test_the_scene_and_the_map_that_an_audit_of_a_steered_vehicle_writes_replay_its_log(kind, tmp_path, capsys):
    scene, fitted, mapped = steered_scene(tmp_path, kind), tmp_path / "fitted.toml", tmp_path / "fitted_map.toml"
    scene.write_text(scene.read_text().replace("[[vehicle.wheel]]", "# counted from the front\n[[vehicle.wheel]]", 1)
                     .replace("[run]", "[run]  # a short one"))
    log, mapping = steered_log(tmp_path, kind, radius=1.03, base=1.05, gain=0.9, offset=0.02, ahead_m=0.3, lag_s=0.1)
    mapping.write_bytes(f"# Räder\n{mapping.read_text()}".encode("cp1252"))  # as --map reads it
    audited(capsys, log, mapping, scene, "--export", str(fitted), "--map-out", str(mapped))
    text = fitted.read_text()
    assert "# Räder\n" in mapped.read_text(encoding="utf-8")
    assert "# counted from the front\n" in text and "[run]  # a short one\n" in text
    assert "wheel_radius_m = 0.103" in text and "radius of the wheels, factor: 1.03" in text
    assert re.search(r"#   gain of the steering, factor: 0\.(9|89)", text) and "mass_kg" in text
    errors = []
    for robot, columns in ((scene, mapping), (fitted, mapped)):
        assert run(["replay", str(log), str(robot), "--map", str(columns), "--json"]) == 0, capsys.readouterr().err
        errors.append(json.loads(capsys.readouterr().out)["runs"][0]["path_error"])
    assert errors[0] > 0.02 and errors[1] < 0.1 * errors[0]


@pytest.mark.parametrize("name", ["f1tenth", "tugger_train", "turtlebot3_burger", "robotino2"])
def test_a_scene_with_other_values_keeps_its_comments_and_all_else(name):
    text = scene_path(name).read_text()
    table = entries_of(text)
    assert rewritten(text, table, {}) == text
    table["vehicle"]["mass_kg"], table["vehicle"]["new"] = 123.5, 1.0
    table["vehicle"]["wheel"][1]["x_m"] = 7.0
    table["ground"] = {**table.get("ground", {}), "slope_deg": 1.0}
    del table["vehicle"]["wheel"][0]["kind"]
    found = rewritten(text, table, {("vehicle", "mass_kg"): "weighed"})
    assert entries_of(found) == table
    assert re.search(r"mass_kg = 123\.5  # weighed", found)
    assert [line for line in found.splitlines() if line.startswith("#")] == [
        line for line in text.splitlines() if line.startswith("#")]
    assert found.count("#") == text.count("#") + (1 if "# weighed;" not in found else 0)


@pytest.mark.parametrize("text", [
    "a.b = 1\nc = 2\n", "# \u2028 and\x85\r\n[x]\r\ny = 2 # told\r\n",
    "[x]\ny = {z = 1, w = 2}\n", "c = \"\"\"\n[a]\n\"\"\" # é\n[x]\n\"q r\" = 1\n"])
def test_a_table_in_any_form_has_the_new_values(text):
    table = entries_of(text)
    table["c"] = [1.5, 2.5]
    table.get("x", {})["y"] = 3
    assert entries_of(rewritten(text, table, {("c",): "found"})) == table


@pytest.mark.parametrize(("mapped", "words"), [
    (False, "--map-out: needs --map"), (True, "has no steered wheels; --export FITTED.toml holds all")])
def test_a_map_is_written_only_where_the_audit_corrects_one(mapped, words, tmp_path, capsys):
    log, mapping = log_of(tmp_path)
    more = ["--map", str(mapping)] if mapped else []
    assert run(["audit", str(log), str(scene_of(tmp_path)), *more, "--map-out", str(tmp_path / "new_map.toml")]) == 2
    error = capsys.readouterr().err
    assert words in error and error.count("\n") == 1


TRICYCLE = recorded("tricycle")


@pytest.mark.skipif(not TRICYCLE.is_dir(), reason="recorded runs are not here")
def test_a_recorded_tricycle_is_audited_by_its_map_alone(tmp_path, capsys):
    log, mapping = TRICYCLE / "run1.csv", tmp_path / "map.toml"
    assert run(["logs", str(log), "--scene", "tricycle_agv", "-o", str(mapping)]) == 0
    text = mapping.read_text().replace('[pose]', '[pose]\nmount = { x_m = 1.5 }')
    steering, wheel = "ticks_per_turn = 8192\nscale = 0.545\noffset = -0.06", "ticks_per_turn = 5000\nscale = 0.0152"
    text = re.sub("# ticks_per_turn.*", steering, text, count=1)
    mapping.write_text(re.sub("# ticks_per_turn.*", wheel, text))
    assert "wrap = 8192" in text and "wrap = 4294967296" in text
    capsys.readouterr()
    found = audited(capsys, log, mapping, Path("tricycle_agv"))
    assert found["nominal"] > 0.05 and found["found"] < 0.003
    fitted = {each["name"]: each["value"] for each in found["fit"]["parameters"]}
    assert 1.4 * fitted["distance of the wheels, factor"] == pytest.approx(1.51, abs=0.03)
    assert 1.5 + fitted["place of the tracker, x"] == pytest.approx(1.78, abs=0.03)


CAR = recorded("f1tenth")


@pytest.mark.skipif(not CAR.is_dir(), reason="recorded runs are not here")
@pytest.mark.parametrize(("name", "nominal", "left"), [
    ("skidpad_ccw_clean_v_0_5_d_0_416", 0.1, 0.003), *(pytest.param(*each, marks=pytest.mark.nightly) for each in (
        ("slalom_clean_v_1_5_d_0_416", 0.1, 0.003), ("teleop_teleop_02", 0.04, 0.01)))])
def test_a_recorded_car_is_audited_by_the_map_that_is_guessed(name, nominal, left, tmp_path, capsys):
    """Each run leaves little once it is fitted by the same means as identify has: the stretches lead to the path."""
    log, mapping = CAR / f"{name}.csv", tmp_path / "map.toml"
    assert run(["logs", str(log), "--scene", "f1tenth", "-o", str(mapping)]) == 0
    assert 'kind = "command"' in mapping.read_text() and 'column = "command_speed_m_per_s"' in mapping.read_text()
    capsys.readouterr()
    found = audited(capsys, log, mapping, Path("f1tenth"))
    assert found["nominal"] > nominal and found["found"] < left


HUNG = {
    "casters": ('[[vehicle.caster]]\nname = "rear_left"\nx_m = -0.4\ny_m = 0.3\ntrail_m = 0.035\nradius_m = 0.0375\n'
                '[[vehicle.caster]]\nname = "rear_right"\nx_m = -0.4\ny_m = -0.3\ntrail_m = 0.035\nradius_m = 0.03\n'),
    "a trailer": ('[[vehicle.trailer]]\nname = "cart"\nhitch_x_m = -0.3\nlength_m = 0.6\ntrack_m = 0.4\n'
                  'mass_kg = 10.0\nyaw_inertia_kgm2 = 0.5\nradius_m = 0.05\n')}
TRUE_RADIUS, TRUE_TRACK = 1.01, 1.02
BY_WHEELS = """[time]
column = "time_s"
[wheel_angle]
columns = ["wheel_angle_rad[1]", "wheel_angle_rad[2]"]
[pose]
columns = ["x_m", "y_m", "heading_rad"]
"""
WITH_HINGES = """format = "bag"
joints = "/joint_states"
wheels = ["wheel_1_joint", "wheel_2_joint"]
pose = "/ground_truth/odom"
[steering_angle]
columns = ["/joint_states.position[rear_left_hinge_joint]", "/joint_states.position[rear_right_hinge_joint]"]
hinges = ["rear_left", "rear_right"]
"""


def hung_scene(folder: Path, name: str, hung: str, radius: float = 1.0, track: float = 1.0) -> Path:
    """Two driven wheels, and what hangs behind them on free hinges."""
    wheels = "".join(f'[[vehicle.wheel]]\nkind = "fixed"\nx_m = 0.0\ny_m = {side * 0.25 * track}\naxle_deg = -90\n'
                     f"radius_m = {0.0625 * radius}\n" for side in (1, -1))
    inputs = "".join(f'[[input]]\nsignal = "voltage_V[{wheel}]"\nkind = "table"\nt_s = [0, 1, 3, 5, 7, 9]\n'
                     f"value = {values}\n" for wheel, values in
                     ((1, [0, 12, 6, 12, 6, 12]), (2, [0, 12, 12, 6, 6, 12])))
    path = folder / f"{name}.toml"
    path.write_text('name = "hung"\nsource = "made up"\n[vehicle]\nmass_kg = 45.0\nyaw_inertia_kgm2 = 3.75\n'
                    "wheel_radius_m = 0.0625\nwheel_inertia_kgm2 = 1.6e-3\nmotor_gain_Nm_per_V = 2.0\n"
                    f"motor_damping_Nms = 3.0\n{wheels}{HUNG[hung]}{inputs}[run]\nduration_s = 9.0\nstep_s = 0.01\n")
    return path


@pytest.fixture(scope="module")
def hung_runs(tmp_path_factory) -> dict[str, tuple[Path, Path]]:
    """(bag, table) of true robots whose wheels and track differ from the scene's."""
    found = {}
    for number, hung in enumerate(HUNG):
        folder = tmp_path_factory.mktemp(f"hung{number}")
        truth = hung_scene(folder, "truth", hung, TRUE_RADIUS, TRUE_TRACK)
        assert run(["simulate", str(truth), "--bag", str(folder / "d.mcap"), "--out", str(folder / "d.csv")]) == 0
        found[hung] = folder / "d.mcap", folder / "d.csv"
    return found


def assert_holds_the_truth(parameters: list[dict]) -> None:
    """Radii and distance within what the intervals of a log without noise leave to its sampling."""
    truths = {"radius of wheel 1": 0.0625 * TRUE_RADIUS, "radius of wheel 2": 0.0625 * TRUE_RADIUS,
              "distance of the wheels": TRUE_TRACK}
    found = {each["name"]: each["value"] for each in parameters}
    assert {name: found[name] for name in truths} == pytest.approx(truths, rel=2e-5)


@pytest.mark.parametrize(("hung", "kind"), [
    pytest.param(hung, kind, marks=[] if (kind == "bag") == (number == 0) else [pytest.mark.nightly])
    for number, hung in enumerate(HUNG) for kind in ("bag", "table")])
def test_what_hangs_on_free_hinges_does_not_distort_a_differential_robot(kind, hung, hung_runs, tmp_path, capsys):
    scene, log = hung_scene(tmp_path, "scene", hung), hung_runs[hung][kind == "table"]
    (tmp_path / "map.toml").write_text(BY_WHEELS)
    mapping = ["--map", str(tmp_path / "map.toml")] if kind == "table" else []
    assert run(["identify", str(log), "--scene", str(scene), *mapping, "--json"]) == 0, capsys.readouterr().err
    assert_holds_the_truth(json.loads(capsys.readouterr().out)["parameters"])
    files = [tmp_path / "control.yaml", tmp_path / "fitted.toml"]
    assert run(["audit", str(log), str(scene), *mapping, "--json", "--export", str(files[0]), "--export",
                str(files[1])]) == 0, capsys.readouterr().err
    found = json.loads(capsys.readouterr().out)
    assert_holds_the_truth(found["fit"]["parameters"])
    assert found["nominal"] > 0.005 and found["found"] < 1e-5
    multiplier = re.search(r"wheel_separation_multiplier: (\S+)", files[0].read_text())
    assert multiplier and float(multiplier[1]) == pytest.approx(TRUE_TRACK, rel=2e-5)
    assert run(["replay", str(log), str(files[1]), "--inputs", "wheel-speeds", *mapping, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["runs"][0]["path_error"] < 1e-5


def test_a_remark_says_that_free_hinges_were_left_out_and_a_map_takes_them(hung_runs, tmp_path, capsys):
    scene, log = hung_scene(tmp_path, "scene", "casters"), hung_runs["casters"][0]
    said = "d: wheel 3, wheel 4, hinge rear_left, hinge rear_right: left out"
    (tmp_path / "map.toml").write_text(WITH_HINGES)
    errors = []
    for mapping, count in (([], 1), (["--map", str(tmp_path / "map.toml")], 0)):
        assert run(["replay", str(log), str(scene), "--inputs", "wheel-speeds", *mapping, "--json"]) == 0
        found = json.loads(capsys.readouterr().out)
        assert sum(each.startswith(said) for each in found["remarks"]) == count
        errors.append(found["runs"][0]["path_error"])
    assert errors[0] > 1.1 * errors[1] > 0.0


def test_the_track_of_a_robot_with_casters_is_found_without_angles_of_them(hung_runs, tmp_path, capsys):
    scene = hung_scene(tmp_path, "scene", "casters")
    assert run(["identify", str(hung_runs["casters"][0]), "--scene", str(scene), "--free", "radius,track",
                "--json"]) == 0, capsys.readouterr().err
    found = {each["name"]: each["value"] for each in json.loads(capsys.readouterr().out)["parameters"]}
    assert found["track"] == pytest.approx(0.5 * TRUE_TRACK, rel=1e-4)
    assert found["radius of wheel 1"] == pytest.approx(0.0625 * TRUE_RADIUS, rel=1e-4)


def test_a_measuring_wheel_of_a_tugger_with_trailers_counts_with_a_radius_of_its_own(tmp_path, capsys):
    scene = scene_path("tugger_train").read_text()
    worn = scene.replace("wheel_radius_m = 0.2\n", f"wheel_radius_m = {0.2 * TRUE_RADIUS}\n").replace(
        "driven = false\nmass_kg", "driven = false\nradius_m = 0.206\nmass_kg", 1)
    assert worn.count("0.206") == 1
    (tmp_path / "truth.toml").write_text(worn)
    assert run(["simulate", str(tmp_path / "truth.toml"), "--bag", str(tmp_path / "d.mcap")]) == 0
    capsys.readouterr()
    assert run(["identify", str(tmp_path / "d.mcap"), "--scene", "tugger_train", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    radii = [each["value"] for each in found["parameters"] if each["name"].startswith("radius")]
    assert radii == pytest.approx([0.2 * TRUE_RADIUS] * 2 + [0.206], rel=1.5e-3)
    assert any("hinge first, hinge second, hinge third: left out" in each for each in found["words"])


SWERVE_WHEEL = ('[[vehicle.wheel]]\nkind = "fixed"\nsteered = "coordinated"\nname = "module_{}"\nx_m = {}\ny_m = {}\n'
                "mass_kg = 1.0\nyaw_inertia_kgm2 = 0.002\nrate_limit_rad_per_s = 12.0\n")
TAIL = '[[vehicle.caster]]\nname = "tail"\nx_m = -0.4\ny_m = 0.0\ntrail_m = 0.05\nradius_m = 0.05\n'
TWIST = ([1.0, 1.0, 0.3, 0.3, 1.0, 1.0, 0.7], [0.0, 0.0, 0.9, 0.9, 0.4, 0.4, -0.7],
         [0.0, 0.8, 0.8, -0.9, -0.9, 0.3, 0.6])


def swerve(folder: Path, name: str, radius: float = 1.0, distance: float = 1.0) -> Path:
    """Four modules and a caster, which nobody measures as well."""
    wheels = "".join(SWERVE_WHEEL.format(number, 0.2 * distance * x, 0.2 * distance * y)
                     for number, (x, y) in enumerate(((1, 1), (1, -1), (-1, 1), (-1, -1)), start=1))
    inputs = "".join(f'[[input]]\nsignal = "steering_twist[{number}]"\nkind = "table"\n'
                     f"t_s = [0.0, 2.0, 2.5, 4.0, 4.5, 6.0, 6.5]\nvalue = {values}\n"
                     for number, values in enumerate(TWIST, start=1))
    inputs += "".join(f'[[input]]\nsignal = "voltage_V[{wheel}]"\nkind = "table"\nt_s = [0.0, 0.5, 7.5, 8.0]\n'
                      "value = [0.0, 11.4, 11.4, 0.0]\n" for wheel in range(1, 5))
    path = folder / f"{name}.toml"
    path.write_text('name = "swerve"\nsource = "made up"\n[vehicle]\nmass_kg = 20.0\nyaw_inertia_kgm2 = 1.0\n'
                    f"com_z_m = 0.12\nwheel_radius_m = {0.05 * radius}\nwheel_inertia_kgm2 = 6e-4\n"
                    f"motor_gain_Nm_per_V = 0.35\nmotor_damping_Nms = 0.2\n{wheels}{TAIL}{inputs}[run]\n"
                    "duration_s = 8.0\nstep_s = 0.005\n[outputs]\nevery_s = 0.02\n")
    return path


def test_a_swerve_robot_with_a_caster_is_audited_and_identified_by_its_modules(tmp_path, capsys):
    scene, log, fitted = swerve(tmp_path, "scene"), tmp_path / "d.mcap", tmp_path / "fitted.toml"
    assert run(["simulate", str(swerve(tmp_path, "truth", TRUE_RADIUS, TRUE_TRACK)), "--bag", str(log)]) == 0
    capsys.readouterr()
    assert run(["audit", str(log), str(scene), "--json", "--export", str(fitted)]) == 0, capsys.readouterr().err
    found = json.loads(capsys.readouterr().out)
    values = {each["name"]: each["value"] for each in found["fit"]["parameters"]}
    assert values["radius of the wheels, factor"] == pytest.approx(TRUE_RADIUS, rel=1e-3)
    assert values["distance of the wheels, factor"] == pytest.approx(TRUE_TRACK, rel=2e-3)
    assert found["found"] < 0.01 * found["nominal"]
    assert run(["identify", str(log), "--scene", str(scene), "--json"]) == 0, capsys.readouterr().err
    said = json.loads(capsys.readouterr().out)
    assert_swerve(said["parameters"])
    assert any("wheel 5, hinge tail: left out" in each for each in said["words"])
    assert run(["replay", str(log), str(fitted), "--inputs", "wheel-speeds", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["runs"][0]["path_error"] < 1e-3


def assert_swerve(parameters: list[dict]) -> None:
    """Radii differ by what no run of four modules tells; their mean is told, and the distance."""
    radii = [each["value"] for each in parameters if each["name"].startswith("radius")]
    found = {each["name"]: each["value"] for each in parameters}
    assert len(radii) == 4 and np.mean(radii) == pytest.approx(0.05 * TRUE_RADIUS, rel=1e-3)
    assert found["distance of the wheels, factor"] == pytest.approx(TRUE_TRACK, rel=2e-3)


def test_wheels_that_only_roll_along_tell_what_the_steering_does_not(tmp_path, capsys):
    """The angle of the front wheel is read 0.03 rad wrongly; two undriven rear wheels know how the robot turns."""
    log, mapping = steered_log(tmp_path, "tricycle", offset=0.03)
    scene, errors = steered_scene(tmp_path, "tricycle"), []
    assert run(["replay", str(log), str(scene), "--map", str(mapping), "--json"]) == 0
    errors.append(json.loads(capsys.readouterr().out)["runs"][0]["path_error"])
    rows = np.loadtxt(log, delimiter=",", skiprows=1)
    moved = np.diff(rows[:, 3:], axis=0)
    ahead = moved[:, 0] * np.cos(rows[:-1, 5] + 0.5 * moved[:, 2]) + moved[:, 1] * np.sin(
        rows[:-1, 5] + 0.5 * moved[:, 2])
    rear = [np.append(0.0, np.cumsum(ahead - side * HALF_M * moved[:, 2])) / WHEEL_M for side in (1.0, -1.0)]
    wide = np.column_stack([rows[:, :2], *rear, rows[:, 2:]])
    lines = ["t,wheel0,left,right,steering_rad,x,y,yaw", *(",".join(f"{value:.9g}" for value in row) for row in wide)]
    log.write_text("\n".join(lines) + "\n")
    mapping.write_text(mapping.read_text().replace('["wheel0"]', '["wheel0", "left", "right"]\nwheels = [1, 2, 3]'))
    assert run(["replay", str(log), str(scene), "--map", str(mapping), "--json"]) == 0, capsys.readouterr().err
    errors.append(json.loads(capsys.readouterr().out)["runs"][0]["path_error"])
    assert errors[1] < 0.9 * errors[0]  # the least squares between them and the steering
