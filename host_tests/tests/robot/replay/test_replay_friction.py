"""Recorded runs on ground with friction: held wheels, motors and the robot's controller, by the friction step."""

from __future__ import annotations

import copy
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from laconic.base.paths import scene_path
from laconic.cli.main import run
from laconic.robot.identify.controller import controller_of
from laconic.robot.identify.evidence import evidence_of
from laconic.robot.identify.geometry import geometry_of
from laconic.robot.identify.solve import fit
from laconic.robot.identify.study import identify
from laconic.robot.logs import Log
from laconic.robot.replay.closed_loop import follow, wheel_speed_error
from laconic.robot.replay.held_wheels import hold
from laconic.robot.replay.motor_driven import by_currents
from laconic.robot.replay.steady_currents import axles_of, current_error_A
from laconic.scene import read_scene
from laconic.scene.drives import SpeedController
from recorded_data import recorded

needs_records = pytest.mark.skipif(not recorded("robotino").exists(), reason="no recorded runs beside the project")
GROUND = {"friction_coefficient": 0.65, "roller_drag": 0.5, "axle_friction_Nm": 0.15}
CONTROLLER = SpeedController(1.8, 0.0, 0.1)


@pytest.fixture(scope="module")
def robot():
    """A Robotino on ground with friction, with a speed controller."""
    scene = read_scene("robotino2")
    vehicle = copy.deepcopy(scene.vehicle)
    vehicle.pop("friction_coefficient")
    return replace(scene, vehicle={**vehicle, "ground": dict(GROUND)}, speed_controller=CONTROLLER)


def commanded(direction_deg: float, speed: float = 0.2, seconds: float = 5.0, name: str = "run") -> Log:
    """A log with set speeds for a straight way, and nothing measured yet."""
    bearings, way = np.radians([60.0, 180.0, 300.0]), np.radians(direction_deg)
    time = np.arange(0.0, seconds, 0.03)
    wheels = speed / 0.04 * np.sin(way - bearings)
    wanted = np.tile(wheels, (len(time), 1))
    return Log(Path(f"/made-up/{name}.csv"), "made up", time, set_speed_rad_per_s=wanted,
               wheel_angle_rad=np.zeros_like(wanted), current_A=np.zeros_like(wanted), pose=np.zeros((len(time), 3)))


def made_up(robot, direction_deg: float, name: str = "run", speed: float = 0.2) -> Log:
    """What the robot does: set speeds → controller → core."""
    log = commanded(direction_deg, speed, name=name)
    done = follow(robot.core(), robot.vehicle, robot.speed_controller, log)
    angle = np.column_stack([np.interp(log.time_s, done.time_s, np.concatenate([[0.0], np.cumsum(
        done.speed_rad_per_s[1:, i] * np.diff(done.time_s))])) for i in range(3)])
    current = np.column_stack([np.interp(log.time_s, done.time_s, done.current_A[:, i]) for i in range(3)])
    return replace(log, wheel_angle_rad=angle, current_A=current, pose=done.pose)


def test_held_wheels_move_the_robot_as_far_as_the_motors_that_turned_them(robot):
    for direction in (0.0, 30.0):
        log = made_up(robot, direction)
        held = hold(robot.core(), robot.vehicle, log)
        path = held.at(log.time_s, log.pose[0])
        assert np.hypot(*(path - log.pose)[-1, :2]) < 0.02 * np.hypot(*log.pose[-1, :2])


def test_held_wheels_need_the_currents_that_the_motors_took(robot):
    log = made_up(robot, 0.0)
    axles = axles_of(robot.core(), robot.vehicle)
    assert current_error_A(axles, log, hold(robot.core(), robot.vehicle, log)) < 0.03


def test_rolled_over_travelled_distance_is_that_of_the_law_for_the_robotino(robot):
    for direction, k, ratio in ((0.0, 0.87, 1.68), (0.0, 0.5, 1.19), (90.0, 0.5, 1.09)):
        vehicle = {**robot.vehicle, "ground": {**GROUND, "roller_drag": k}}
        log = commanded(direction, seconds=0.8)
        log = replace(log, wheel_angle_rad=log.set_speed_rad_per_s * log.time_s[:, None])
        held = hold(robot.core(), vehicle, log)
        steady = held.time_s > 0.2
        time, pose = held.time_s[steady], held.pose[steady]
        travelled = np.hypot(*np.diff(pose[:, :2], axis=0).T).sum()
        assert 0.2 * (time[-1] - time[0]) / travelled == pytest.approx(ratio, rel=0.02)


def test_controller_is_found_again_with_its_dead_time(robot):
    logs = [made_up(robot, d, f"run{d}", v) for d, v in ((0.0, 0.1), (40.0, 0.2), (90.0, 0.3), (200.0, 0.2))]
    found = controller_of(logs)
    assert found.gain_As_per_rad[0] == pytest.approx(1.8, rel=0.03)
    assert found.values()["integral_gain_A_per_rad"] < 0.05
    assert found.dead_time_s[0] == pytest.approx(0.1, abs=0.03)


def test_drag_radius_and_sizes_of_the_forces_are_found_again(robot):
    logs = [made_up(robot, d, f"run{d}") for d in (0.0, 40.0, 80.0)]
    start = replace(robot, vehicle={**robot.vehicle, "ground": {"friction_coefficient": 0.4, "roller_drag": 0.3}})
    parameters = geometry_of(start, ("drag", "friction", "axle-friction"))
    found = fit(start.vehicle, parameters, evidence_of(start, logs, parameters))
    values = dict(zip((p.group for p in found.parameters.each), found.values, strict=True))
    assert values["drag"] == pytest.approx(0.5, abs=0.03)
    assert values["friction"] == pytest.approx(0.65, abs=0.08)
    assert values["axle-friction"] == pytest.approx(0.15, abs=0.04)


def test_currents_below_breakaway_leave_the_robot_at_rest_and_larger_ones_move_it_the_way_they_push(robot):
    log = commanded(0.0, seconds=2.0)
    torque_per_A = axles_of(robot.core(), robot.vehicle).torque_per_A_Nm[0]
    below = 0.9 * GROUND["axle_friction_Nm"] / torque_per_A * np.tile([-1.0, 0.0, 1.0], (len(log.time_s), 1))
    still = by_currents(robot.core(), robot.vehicle, replace(log, current_A=below))
    assert not still.pose.any() and not still.speed_rad_per_s.any()
    moved = by_currents(robot.core(), robot.vehicle, replace(log, current_A=15.0 * below))
    assert moved.pose[-1, 0] > 0.05 and abs(moved.pose[-1, 1]) < 1e-6


def test_set_speeds_through_the_controller_give_the_wheel_speeds_of_the_run_that_they_made(robot):
    log = made_up(robot, 0.0)
    assert wheel_speed_error(log, follow(robot.core(), robot.vehicle, CONTROLLER, log)) < 0.01


def test_controller_without_motor_or_with_a_negative_part_is_one_line(tmp_path, capsys):
    text = scene_path("robotino2").read_text()
    for added, words in (("gain_As_per_rad = 0", "gain_As_per_rad: is 0; give a value above 0"),
                         ("gain_As_per_rad = 1\ndead_time_s = -1", "dead_time_s: is -1; give a value of 0 or more"),
                         ("gain_As_per_rad = 1\ncolour = 1", "colour")):
        path = tmp_path / "scene.toml"
        path.write_text(f"{text}\n[speed_controller]\n{added}\n")
        assert run(["simulate", str(path)]) == 2
        assert words in capsys.readouterr().err


@needs_records
@pytest.mark.parametrize(("floor", "displacement", "current"), [("grey", 0.19, 0.10), ("green", 0.26, 0.15)])
def test_identified_robotino_goes_where_the_recorded_one_went(floor, displacement, current, capsys):
    runs = recorded("robotino" if floor == "grey" else "robotino_green")
    scene = scene_path(f"robotino_{floor}")
    means = {}
    for inputs in ("wheel-speeds", "set-speeds"):
        assert run(["replay", str(runs), str(scene), "--inputs", inputs, "--json"]) == 0
        found = json.loads(capsys.readouterr().out)["runs"]
        means[inputs] = {key: np.mean([each[key] for each in found if each[key] is not None] or np.nan)
                         for key in ("displacement_error", "wheel_speed_error", "current_error_A")}
    assert means["wheel-speeds"]["displacement_error"] < displacement
    assert means["wheel-speeds"]["current_error_A"] < current
    assert means["set-speeds"]["wheel_speed_error"] < 0.15


@needs_records
@pytest.mark.parametrize("floor", ["grey", "green"])
def test_the_currents_of_every_recorded_run_are_replayed_without_a_refused_step(floor, capsys):
    runs = recorded("robotino" if floor == "grey" else "robotino_green")
    assert run(["replay", str(runs), f"robotino_{floor}", "--inputs", "currents", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["runs"]
    assert len(found) == (12 if floor == "grey" else 3)
    assert all(np.isfinite(each["wheel_speed_error"]) for each in found)


@needs_records
def test_friction_that_is_left_free_without_currents_is_refused_by_its_name(robot, capsys):
    log = replace(made_up(robot, 0.0), current_A=None)
    with pytest.raises(Exception, match="--free friction: only currents tell it"):
        identify(robot, [log], geometry_of(robot, ("friction",)))


def test_runs_left_out_are_judged_in_closed_loop_by_the_controller_of_the_others(robot):
    logs = [made_up(robot, d, f"run{d}", v) for d, v in ((0.0, 0.1), (40.0, 0.2), (90.0, 0.3))]
    study = identify(robot, logs, geometry_of(robot, ("common-radius",)), leave_out="run", with_controller=True)
    assert [each.wheel_speed_error for each in study.left_out] == pytest.approx([0.0] * 3, abs=0.08)
    assert all(each.wheel_speed_error > 0.0 for each in study.left_out)


def test_friction_of_each_wheel_is_a_share_of_the_grounds(robot):
    parameters = geometry_of(robot, ("friction", "wheel-friction"))
    vehicle = parameters.vehicle(robot.vehicle, np.array([0.8, 0.5, 1.0, 1.5]))
    assert vehicle["ground"]["friction_coefficient"] == 0.8
    assert [wheel["friction_coefficient"] for wheel in vehicle["wheel"]] == pytest.approx([0.4, 0.8, 1.2])
    assert len(geometry_of(replace(robot, vehicle=vehicle), ("friction",))) == 1
    with pytest.raises(Exception, match="--free wheel-friction"):
        geometry_of(replace(robot, vehicle=vehicle), ("wheel-friction",))


@needs_records
def test_axle_friction_from_driven_runs_is_that_of_the_log_whose_wheels_turn_free():
    text = (recorded("robotino") / "motor_identification.csv").read_text().splitlines()[3:]
    rows = np.array([[float(cell) for cell in line.split(";")[:13]] for line in text])
    starts = np.flatnonzero(np.abs(np.diff(rows[:, 1])) > 1.0) + 1
    steps = [part[len(part) // 2:] for part in np.split(rows, starts) if len(part) > 20 and abs(part[0, 1]) > 1.0]
    speed = np.concatenate([np.abs(part[:, 7:10].mean(axis=0)) for part in steps])
    current = np.concatenate([part[:, 10:13].mean(axis=0) for part in steps])
    slope, at_rest = np.polyfit(speed, current, 1)
    scene = read_scene("robotino_grey").vehicle
    constant, ratio = scene["motor"]["torque_constant_Nm_per_A"], scene["motor"]["gear_ratio"]
    assert len(steps) == 14
    assert ratio * constant * at_rest == pytest.approx(scene["ground"]["axle_friction_Nm"], rel=0.05)
    assert constant * slope == pytest.approx(1.86e-5, rel=0.01)
