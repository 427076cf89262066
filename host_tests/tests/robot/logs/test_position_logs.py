"""GPS, UWB and total stations record positions without a heading: paths are placed where they fit, and parameters are
found from the positions."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from laconic.base.paths import scene_path
from laconic.cli.main import run
from laconic.robot.identify.geometry import geometry_of
from laconic.robot.identify.rolling_evidence import RollingEvidence, run_of, with_headings
from laconic.robot.identify.solve import fit
from laconic.robot.logs import gather_logs
from laconic.robot.replay.placing import fitted
from laconic.robot.replay.rolling import rolling_of
from laconic.scene import read_scene
from log_support import CAN_MAP, SCENE, TEXT_MAP, asc, asc_lines, csv, frames, mapped, motion, refused_log, replayed
from synthetic import made_up

POSITIONS = TEXT_MAP.replace('["x", "y", "yaw"]', '["x", "y"]')
HEAD = ("t", "left", "right", "x", "y")


def turned(rows: np.ndarray, angle: float, x: float, y: float) -> np.ndarray:
    """The run without headings, in axes that are turned and moved, as a total station's are."""
    cos, sin = np.cos(angle), np.sin(angle)
    own_x, own_y = rows[:, 3], rows[:, 4]
    return np.column_stack([rows[:, :3], x + cos * own_x - sin * own_y, y + sin * own_x + cos * own_y])


@pytest.mark.parametrize("angle", [0.0, 0.7, -3.1])
def test_a_path_is_placed_where_it_fits_the_positions(angle, tmp_path, capsys):
    log = csv(tmp_path / "run.csv", turned(motion(), angle, 1e3, -2e3), HEAD)
    found = replayed(capsys, log, mapped(tmp_path, POSITIONS))["runs"][0]
    assert found["path_error"] < 1e-6 and found["displacement_error"] < 1e-5 and found["heading_error_rad"] is None


def test_positions_of_a_bus_and_in_millimetres_are_taken_alike(tmp_path, capsys):
    log = asc(tmp_path / "run.asc", asc_lines(frames()))
    text = CAN_MAP.replace('"POSE.X", "POSE.Y", "POSE.A"', '"POSE.X", "POSE.Y"')
    assert replayed(capsys, log, mapped(tmp_path, text))["runs"][0]["path_error"] < 1e-5
    rows = turned(motion(), 0.4, 0.0, 0.0)
    rows[:, 3:] *= 1e3
    units = mapped(tmp_path, POSITIONS + 'units = ["mm", "mm"]\n')
    assert replayed(capsys, csv(tmp_path / "run.csv", rows, HEAD), units)["runs"][0]["path_error"] < 1e-6


WRONG = {"three units": ('units = ["m", "m", "rad"]', "pose.units: has 3 entries; give 2"),
         "an angle": ('units = ["m", "rad"]', "pose.units: there is no unit 'rad' of pose"),
         "the frame before": ('kind = "body-increments"', "pose.columns: has 2 entries; give 3")}


@pytest.mark.parametrize(("line", "words"), WRONG.values(), ids=WRONG)
def test_what_positions_cannot_have_is_named(line, words, tmp_path, capsys):
    log = csv(tmp_path / "run.csv", turned(motion(), 0.0, 0.0, 0.0), HEAD)
    assert words in refused_log(capsys, log, mapped(tmp_path, f"{POSITIONS}{line}\n"))


def test_a_wrong_radius_and_distance_are_found_from_positions_alone(tmp_path, capsys):
    scene, text = tmp_path / "wrong.toml", scene_path(SCENE).read_text()
    assert "wheel_radius_m = 0.033" in text
    scene.write_text(text.replace("wheel_radius_m = 0.033", "wheel_radius_m = 0.035"))
    left, right = motion(400), motion(400)
    right[:, [1, 2]], right[:, 4] = right[:, [2, 1]], -right[:, 4]
    for name, rows in (("a", left), ("b", right)):
        (tmp_path / name).mkdir()
        csv(tmp_path / name / "run.csv", turned(rows, 1.0, 5.0, 6.0), HEAD)
    mapping = mapped(tmp_path, POSITIONS)
    assert run(["identify", str(tmp_path / "a" / "run.csv"), str(tmp_path / "b" / "run.csv"), "--scene", str(scene),
                "--map", str(mapping), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    values = {each["name"]: each["value"] for each in found["parameters"]}
    assert values["radius of wheel 1"] == pytest.approx(0.033, rel=1e-3)
    assert values["distance of the wheels"] == pytest.approx(1.0, rel=2e-3)
    assert found["means"]["fitted"]["path_error"] < 1e-4 and found["means"]["fitted"]["heading_error_rad"] is None


def test_the_heading_of_the_robot_is_not_told_by_positions(tmp_path, capsys):
    log = csv(tmp_path / "run.csv", turned(motion(200), 0.0, 0.0, 0.0), HEAD)
    assert run(["identify", str(log), "--scene", SCENE, "--map", str(mapped(tmp_path, POSITIONS)), "--free",
                "radius,heading", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["nominal_kept"] == ["heading of the robot"]


@pytest.mark.nightly
def test_intervals_from_positions_hold_the_truth_of_made_up_robots():
    scene, held, wide = read_scene(SCENE), [], []
    parameters = geometry_of(scene, ("radius", "distance"))
    for number in range(8):
        random = np.random.default_rng([7, number])
        truth = parameters.values(random.standard_normal(len(parameters)))
        vehicle = parameters.vehicle(scene.vehicle, truth)
        logs = [made_up(scene.core(), vehicle, scene.path.with_name(f"{number}-{k}.csv"), random) for k in range(4)]
        whole = fit(scene.vehicle, parameters, RollingEvidence(scene.core(), scene.path, logs))
        bare = [replace(log, pose=log.pose * np.array([1.0, 1.0, np.nan])) for log in logs]
        found = fit(scene.vehicle, parameters, RollingEvidence(scene.core(), scene.path, bare))
        held += (np.abs(found.values - truth) <= found.half_widths).tolist()
        wide.append(found.half_widths / whole.half_widths)
    assert np.mean(held) >= 0.85
    assert 0.3 < np.median(wide) < 3.0  # a heading tells little beside the whole path


def test_headings_for_the_errors_of_stretches_are_those_of_the_positions_own_way():
    rows = motion(200)
    pose = np.column_stack([rows[:, 3:5], np.full(len(rows), np.nan)])
    path = rows[:, 3:].copy()
    cuts = np.arange(0, 200, 20)
    assert with_headings(pose, path, cuts)[cuts, 2] == pytest.approx(rows[cuts, 5])
    bent = path.copy()
    bent[:, 2] += 0.3
    cos, sin = np.cos(0.3), np.sin(0.3)
    bent[:, :2] = np.column_stack([cos * path[:, 0] - sin * path[:, 1], sin * path[:, 0] + cos * path[:, 1]])
    assert with_headings(pose, bent, cuts)[cuts, 2] == pytest.approx(rows[cuts, 5])


def test_a_rigid_placement_leaves_a_paths_shape():
    path = np.column_stack([np.cos(np.arange(9.0)), np.sin(2.0 * np.arange(9.0)), np.arange(9.0)])
    placed = fitted(path, np.arange(2, 9), np.array([[3.0, 4.0]]) + path[2:, [1, 0]] * np.array([-1.0, 1.0]))
    assert placed[:, :2] == pytest.approx(np.array([[3.0, 4.0]]) + path[:, [1, 0]] * np.array([-1.0, 1.0]))
    assert placed[:, 2] - path[:, 2] == pytest.approx(np.full(9, np.pi / 2))


def test_a_log_without_headings_is_read_with_none(tmp_path):
    log = csv(tmp_path / "run.csv", turned(motion(), 0.0, 0.0, 0.0), HEAD)
    (found,), _ = gather_logs([log], mapped(tmp_path, POSITIONS))
    assert not found.has_heading and np.isnan(found.pose[:, 2]).all()
    scene = read_scene(SCENE)
    own = run_of(found).path(rolling_of(scene.core(), scene.vehicle, scene.path).moved(found.rotation_rad()))
    assert own[:, :2] == pytest.approx(found.pose[:, :2], abs=1e-6)
