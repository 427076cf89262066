"""`laconic identify`: known parameters are found, intervals hold them, what runs cannot tell stays nominal."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from made_up_runs import exact_run, found_from, simulated

from laconic.base.paths import scene_path
from laconic.cli.main import run
from laconic.errors import BadInput
from laconic.robot.identify.geometry import geometry_of
from laconic.robot.identify.study import identify
from laconic.robot.identify.words import in_words
from laconic.robot.logs import gather_logs
from laconic.robot.replay.measures import grand_mean
from laconic.robot.replay.rolling import rolling_of, rotations_of
from laconic.scene import read_scene
from recorded_data import recorded
from synthetic import made_up, trials

RECORDED = recorded("optiodom")
needs_records = pytest.mark.skipif(not RECORDED.exists(),
                                   reason=f"no recorded runs at {RECORDED}: they are not part of the project")


@pytest.mark.parametrize("name", ["optiodom_diff", "optiodom_omni3", "optiodom_omni4", "kuka_youbot", "s1"])
def test_rolling_undoes_what_the_wheels_did_with_unequal_radii_and_the_centre_of_mass_elsewhere(name):
    scene = read_scene(name)
    vehicle = {**scene.vehicle, "com_x_m": 0.0 if name == "optiodom_diff" else 0.013, "com_y_m": -0.007}
    vehicle["wheel"] = [{**wheel, "radius_m": 0.04 + 0.003 * i} for i, wheel in enumerate(vehicle["wheel"])]
    moved = np.array([[0.02, 0.0, 0.01], [0.01, 0.0, -0.03], [-0.02, 0.0 if name == "optiodom_diff" else 0.03, 0.0]])
    rotation = rotations_of(scene.core(), vehicle, moved)
    assert rolling_of(scene.core(), vehicle, scene.path).moved(rotation) == pytest.approx(moved, abs=1e-14)


def test_a_payload_does_not_change_how_the_robots_origin_rolls():
    scene = read_scene("kuka_youbot")
    payload = {"mass_kg": 20.0, "x_m": 0.1, "y_m": -0.05, "yaw_inertia_kgm2": 0.2}
    moved = np.array([[0.02, 0.01, 0.03]])
    alone, laden = (rolling_of(scene.core(), vehicle, scene.path)
                    for vehicle in (scene.vehicle, {**scene.vehicle, "payload": payload}))
    assert laden.per_rotation == pytest.approx(alone.per_rotation, abs=1e-14)
    assert rotations_of(scene.core(), {**scene.vehicle, "payload": payload}, moved) == pytest.approx(
        rotations_of(scene.core(), scene.vehicle, moved), abs=1e-13)


@pytest.mark.nightly
def test_95_percent_intervals_hold_the_truth_in_about_95_percent_of_50_made_up_robots():
    held = [each for trial in trials(50, seed=1, runs=3) for each in trial.held()]
    three_sigma = 3.0 * np.sqrt(0.95 * 0.05 / len(held))
    assert len(held) > 190
    assert abs(np.mean(held) - 0.95) < three_sigma


def test_intervals_are_as_wide_as_noise_of_single_poses_scatters_the_values():
    """A tracker with 2 mm and 0.3° in each pose, and none with a drift: the noise does not add up along the path."""
    scene, free = read_scene("turtlebot3_burger"), ("radius", "distance")
    parameters = geometry_of(scene, free)
    vehicle = parameters.vehicle(scene.vehicle, truth := parameters.nominal * np.array([1.02, 0.99, 1.01]))
    logs = [exact_run(scene, vehicle, (0.2, 0.0, yaw), str(yaw), samples=400) for yaw in (0.0, 0.5, -0.5)]
    size, random = np.array([2e-3, 2e-3, np.deg2rad(0.3)]), np.random.default_rng(3)
    found = [found_from(scene, [replace(log, pose=log.pose + size * random.standard_normal(log.pose.shape))
                                for log in logs], free) for _ in range(20)]
    values, half = (np.array([getattr(each, name) for each in found]) for name in ("values", "half_widths"))
    assert (half.mean(axis=0) < 3.0 * values.std(axis=0, ddof=1)).all()
    assert (half.mean(axis=0) > 1.3 * values.std(axis=0, ddof=1)).all()
    assert (np.abs(values - truth) < half).mean() > 0.85


def test_runs_without_noise_give_radii_distance_and_place():
    scene = read_scene("optiodom_omni3")
    parameters = geometry_of(scene, ("radius", "distance", "place"))
    truth = parameters.nominal * np.array([1.01, 0.98, 1.02, 1.03, 1.0, 1.0]) + np.array([0, 0, 0, 0, 0.01, -0.005])
    vehicle = parameters.vehicle(scene.vehicle, truth)
    velocities = [(0.3, 0.0, 0.4), (0.0, 0.3, -0.5), (0.2, 0.1, 0.0), (-0.1, 0.3, 0.8)]
    found = found_from(scene, [exact_run(scene, vehicle, v, str(i)) for i, v in enumerate(velocities)],
                       ("radius", "distance", "place"))
    assert found.untold == ()
    assert found.values == pytest.approx(truth, rel=1e-6, abs=1e-8)


def test_a_straight_run_does_not_tell_the_distance_which_stays_nominal_and_a_turn_is_advised():
    scene = read_scene("optiodom_diff")
    parameters = geometry_of(scene, ("radius", "distance"))
    vehicle = parameters.vehicle(scene.vehicle, np.array([0.041, 0.041, 1.05]))
    logs = [exact_run(scene, vehicle, (0.3, 0.0, 0.0), str(i)) for i in range(2)]
    study = identify(scene, logs, parameters)
    assert study.found.untold == ("distance of the wheels",)
    assert any(word.startswith("distance of the wheels: the runs do not tell it") for word in study.words)
    assert study.found.values == pytest.approx([0.041, 0.041], rel=1e-4)


@pytest.mark.parametrize(("robot", "named", "advice"), [
    ("optiodom_omni3", "radius of wheel 3 larger and distance of the wheels larger together", "sideways"),
    ("optiodom_diff", "distance of the wheels", "circle to the right")])
def test_what_only_a_combination_tells_is_named_with_the_run_that_would_tell_it(robot, named, advice):
    scene, random = read_scene(robot), np.random.default_rng(4)
    circles = [exact_run(scene, scene.vehicle, (0.3, 0.0, 0.4), str(i)) for i in range(3)]
    noisy = [replace(log, pose=log.pose + np.cumsum(1e-3 * random.standard_normal(log.pose.shape), axis=0))
             for log in circles]
    (word,) = in_words(scene, found_from(scene, noisy, ("radius", "distance")), noisy)
    assert named in word and "the runs hardly tell" in word
    assert advice in word.partition(";")[2] and "would tell most about it" in word


def test_one_run_that_went_wrong_hardly_moves_the_result():
    scene, random = read_scene("optiodom_diff"), np.random.default_rng(3)
    logs = [made_up(scene.core(), scene.vehicle, Path(f"/made-up/{i}/run.csv"), random) for i in range(7)]
    wrong = replace(logs[0], pose=logs[0].pose * np.array([1.5, 1.5, 1.0]))
    clean, spoilt = (found_from(scene, runs, ("radius", "distance")) for runs in (logs, [wrong, *logs[1:]]))
    assert spoilt.weights[0] < 0.2 and (spoilt.weights[1:] == 1.0).all()
    assert np.abs(spoilt.values / clean.values - 1.0).max() < 0.03


def test_the_command_finds_a_radius_writes_a_scene_and_judges_other_runs_with_it(tmp_path, capsys):
    one, other = (simulated(tmp_path, name, 0.0345) for name in ("one", "other"))
    fitted = tmp_path / "fitted.toml"
    capsys.readouterr()
    assert run(["identify", str(one), "--scene", "turtlebot3_burger", "-o", str(fitted), "--judge", str(other),
                "--json"]) == 0
    numbers = json.loads(capsys.readouterr().out)
    by_path = {each["path"]: each for each in numbers["parameters"]}
    assert by_path["vehicle.wheel[1].radius_m"]["value"] == pytest.approx(0.0345, rel=1e-4)
    assert numbers["runs"][0]["path_error"] < 1e-4 < numbers["means"]["judged_nominal"]["path_error"]
    before, after = read_scene("turtlebot3_burger"), read_scene(fitted)
    assert after.vehicle["wheel"][0]["radius_m"] == pytest.approx(0.0345, rel=1e-4)
    assert {k: v for k, v in after.vehicle.items() if k != "wheel"} == {k: v for k, v in before.vehicle.items()
                                                                        if k != "wheel"}
    assert (after.inputs, after.run, after.initial) == (before.inputs, before.run, before.initial)
    assert "radius of wheel 1: 0.0345" in fitted.read_text() and "run.csv of one" in fitted.read_text()


def test_judge_takes_all_logs_up_to_the_next_option(tmp_path, capsys):
    one, two, three = (str(simulated(tmp_path, name, 0.034)) for name in ("one", "two", "three"))
    capsys.readouterr()
    assert run(["identify", one, "--judge", two, three, "--scene", "turtlebot3_burger", "--json"]) == 0
    numbers = json.loads(capsys.readouterr().out)
    assert [each["run"] for each in numbers["runs"]] == ["two/run", "three/run"]
    assert run(["identify", one, "--scene", "turtlebot3_burger", "--judge"]) == 2
    assert "--judge" in capsys.readouterr().err


def test_what_was_not_asked_for_keeps_every_bit(tmp_path, capsys):
    log, fitted = simulated(tmp_path, "one", 0.034), tmp_path / "fitted.toml"
    assert run(["identify", str(log), "--scene", "turtlebot3_burger", "--free", "radius", "-o", str(fitted)]) == 0
    before, after = (read_scene(name).vehicle["wheel"] for name in ("turtlebot3_burger", fitted))
    assert [{k: v for k, v in wheel.items() if k != "radius_m"} for wheel in after] == before


MOTOR = """[vehicle.motor]
resistance_ohm = 1.9
torque_constant_Nm_per_A = 0.031
back_emf_Vs_per_rad = 0.031
gear_ratio = 19.0

"""


@pytest.mark.parametrize(("has_motor", "free", "words"), [
    (True, "motor-damping", "has [vehicle.motor], which makes the motors' gain and damping; take --free resistance"),
    (True, "motor-gain", "has [vehicle.motor], which makes the motors' gain and damping; take --free resistance"),
    (False, "resistance", "has no [vehicle.motor]; give it, or take --free motor-gain,motor-damping")])
def test_a_parameter_of_the_other_motor_model_is_refused_with_the_one_to_take(has_motor, free, words, tmp_path):
    lines = scene_path("turtlebot3_burger").read_text().splitlines(keepends=True)
    text = "".join(line for line in lines if not (has_motor and line.startswith(("motor_gain", "motor_damping"))))
    path = tmp_path / "motor.toml"
    path.write_text(text.replace("[[vehicle.wheel]]", MOTOR * has_motor + "[[vehicle.wheel]]", 1))
    with pytest.raises(BadInput, match=re.escape(words)):
        geometry_of(read_scene(path), [free])


WRONG = {
    "a name that is none": (("--free", "radius,colour"), "--free: there is no 'colour'"),
    "no name": (("--free", ""), "--free"),
    "a name twice": (("--free", "radius,radius"), "each once"),
    "axles of fixed wheels": (("--free", "axle"), "has no wheel with one that could move"),
    "a prior of nothing": (("--prior", "0"), "--prior: 0 % is not usable"),
    "one session": (("--leave-out", "session"), "there is one session only"),
    "no log": (("--judge", "nothing.csv"), "cannot be read"),
    "the log as output": (("-o", "LOG"), "choose a name that ends in .toml"),
    "the scene as output": (("-o", "SCENE"), "is a file that this command reads"),
    "another robot": (("--scene", "robotino2"), "has 2 wheels, the scene 3"),
    "a caster": (("--scene", "paper_caster"), "wheel"),
}


@pytest.mark.parametrize(("options", "words"), WRONG.values(), ids=WRONG)
def test_a_wrong_command_is_one_line_and_exit_status_2(options, words, tmp_path, capsys):
    log, scene = simulated(tmp_path, "one", 0.034), tmp_path / "true.toml"
    capsys.readouterr()
    given = [{"LOG": str(log), "SCENE": str(scene)}.get(each, each) for each in options]
    named = [] if "--scene" in options else ["--scene", str(scene)]
    assert run(["identify", str(log), *named, *given]) == 2
    err = capsys.readouterr().err
    assert words in err and err.count("\n") == 1


def test_a_run_without_a_true_pose_or_without_motion_cannot_be_identified_from(tmp_path, capsys):
    log = simulated(tmp_path, "one", 0.034)
    rows = log.read_text().splitlines()
    log.write_text("\n".join([rows[0], *(f"{0.01 * i:.2f},{rows[1].partition(',')[2]}" for i in range(30))]))
    capsys.readouterr()
    assert run(["identify", str(log), "--scene", "turtlebot3_burger"]) == 2
    assert "its true path has no length" in capsys.readouterr().err


@needs_records
@pytest.mark.parametrize(("robot", "free", "fitted", "left_out"), [
    ("diff", "radius,distance", 0.21, 0.31), ("omni3", "radius,distance", 0.70, 1.45),
    *(pytest.param(*each, marks=pytest.mark.nightly) for each in (
        ("omni4", "radius,distance", 0.63, 1.25), ("omni3", "radius,distance,place", 0.32, 0.75)))])
def test_path_errors_of_the_recorded_robots_are_as_small_as_promised(robot, free, fitted, left_out):
    scene = read_scene(f"optiodom_{robot}")
    logs, _ = gather_logs(sorted(RECORDED.glob(f"{robot}_*")))
    study = identify(scene, logs, geometry_of(scene, free.split(",")), leave_out="session")
    nominal = {"diff": 0.405, "omni3": 1.693, "omni4": 2.407}[robot]
    assert 100.0 * grand_mean(study.nominal).path_error == pytest.approx(nominal, abs=1e-3)
    assert round(100.0 * grand_mean(study.fitted).path_error, 2) <= fitted
    assert round(100.0 * grand_mean(study.left_out).path_error, 2) <= left_out
