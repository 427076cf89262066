"""`laconic identify` of masses, inertias and motors from voltages or currents, and of rolling from a gyro."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from made_up_runs import exact_run

from laconic.base.paths import scene_path
from laconic.cli.main import run
from laconic.errors import BadInput
from laconic.robot.identify.evidence import evidence_of
from laconic.robot.identify.fitted_toml import fitted_text
from laconic.robot.identify.geometry import geometry_of
from laconic.robot.identify.motion import stepping
from laconic.robot.identify.solve import fit
from laconic.robot.identify.study import identify
from laconic.robot.logs import Log
from laconic.robot.replay.motor_driven import speed_at
from laconic.scene import read_scene

STRAIGHT_AND_TURNING = ((1.0, 0.0, 0.0), (0.0, 0.0, 6.0), (0.5, 0.0, 3.0))


def driven(scene, free, truth, inputs, size, velocities=STRAIGHT_AND_TURNING, seed=1):
    """Runs of a robot with these values: steps of voltage or current to and fro, angles as encoders have them."""
    parameters, random = geometry_of(scene, free), np.random.default_rng(seed)
    vehicle = parameters.vehicle(scene.vehicle, np.array(truth))
    without = {"current_A": None} if inputs == "voltages" else {"voltage_V": None}
    logs = []
    for number, velocity in enumerate(velocities):
        log = stepping(scene.core(), vehicle, size * np.array(velocity), 6.0, inputs)
        angle = log.wheel_angle_rad + 0.005 * random.standard_normal(log.wheel_angle_rad.shape)
        logs.append(replace(log, path=Path(f"/made-up/{number}/run.csv"), wheel_angle_rad=angle, **without))
    return parameters, logs


def test_voltages_tell_inertia_gain_and_damping_of_a_robot_whose_mass_is_known():
    scene, truth = read_scene("turtlebot3_burger"), np.array([0.0031, 0.14, 0.19])
    parameters, logs = driven(scene, ("yaw-inertia", "motor-gain", "motor-damping"), truth, "voltages", 20.0)
    study = identify(scene, logs, parameters)
    assert (np.abs(study.found.values - truth) < study.found.half_widths).all()
    assert (study.found.half_widths < np.array([0.2, 0.02, 0.03]) * truth).all()
    assert study.measure == "wheel_speed_error"
    assert np.mean([each.wheel_speed_error for each in study.fitted]) < 0.05
    assert np.mean([each.wheel_speed_error for each in study.nominal]) > 0.2


def test_voltages_alone_tell_forces_only_in_units_of_each_other_and_it_is_said():
    scene, free = read_scene("turtlebot3_burger"), ("mass", "yaw-inertia", "motor-gain", "motor-damping")
    nominal = geometry_of(scene, free).nominal
    parameters, logs = driven(scene, free, 1.1 * nominal, "voltages", 20.0)
    (word,) = [each for each in identify(scene, logs, parameters).words if "together" in each]
    assert word.startswith("mass larger, yaw inertia larger, gain of the motors larger and damping")
    assert "voltages tell forces in units of each other alone" in word


def test_currents_tell_mass_and_yaw_inertia_in_kilograms():
    scene, truth = read_scene("robotino2"), np.array([9.5, 0.05])
    parameters, logs = driven(scene, ("mass", "yaw-inertia"), truth, "currents", 0.01,
                              ((1.0, 0.0, 0.0), (0.0, 0.0, 6.0), (0.0, 1.0, 0.0)))
    found = fit(scene.vehicle, parameters, evidence_of(scene, logs, parameters))
    assert found.values == pytest.approx(truth, rel=0.01)
    assert (np.abs(found.values - truth) < found.half_widths).all()


def test_speeds_at_a_sample_are_the_slope_of_the_angles_also_beside_a_wheel_that_was_not_measured():
    time = np.linspace(0.0, 2.0, 67)
    angle = np.column_stack([time**3 - time, np.full(67, np.nan), 2.0 * time])
    log = Log(Path("run.csv"), "made up", time, wheel_angle_rad=angle)
    for index in (1, 33, 65):
        assert speed_at(log, index) == pytest.approx([3.0 * time[index]**2 - 1.0, np.nan, 2.0], nan_ok=True)


def test_resistance_and_torque_constant_are_written_with_the_back_emf(tmp_path):
    scene, truth = read_scene("robotino2"), np.array([7.0, 0.055])
    parameters, logs = driven(scene, ("resistance", "torque-constant"), truth, "voltages", 0.2)
    study = identify(scene, logs, parameters)
    (tmp_path / "fitted.toml").write_text(fitted_text(study))
    motor = read_scene(tmp_path / "fitted.toml").vehicle["motor"]
    assert (motor["resistance_ohm"], motor["torque_constant_Nm_per_A"]) == pytest.approx(truth, rel=0.02)
    assert motor["back_emf_Vs_per_rad"] == pytest.approx(motor["torque_constant_Nm_per_A"])
    assert "resistance of the motors: " in (tmp_path / "fitted.toml").read_text()


@pytest.mark.nightly
def test_simulated_voltages_on_ideal_ground_are_replayed_and_identified_from_by_the_command(tmp_path, capsys):
    text = scene_path("turtlebot3_burger").read_text()
    heavy = next(line for line in text.splitlines() if line.startswith("yaw_inertia_kgm2"))
    (tmp_path / "heavy.toml").write_text(text.replace(heavy, "yaw_inertia_kgm2 = 0.004"))
    log = tmp_path / "day" / "run.csv"
    assert run(["simulate", str(tmp_path / "heavy.toml"), "--out", str(log), "--inputs"]) == 0
    fitted = tmp_path / "fitted.toml"
    assert run(["identify", str(log), "--scene", "turtlebot3_burger", "--free", "yaw-inertia", "-o", str(fitted)]) == 0
    assert read_scene(fitted).vehicle["yaw_inertia_kgm2"] == pytest.approx(0.004, rel=1e-3)
    capsys.readouterr()
    assert run(["replay", str(log), str(fitted), "--map", "laconic", "--inputs", "voltages", "--json"]) == 0
    (errors,) = json.loads(capsys.readouterr().out)["runs"]
    assert errors["wheel_speed_error"] < 1e-3 and errors["path_error"] < 1e-3


def by_gyro(log, offset=0.0):
    """The log with a gyro instead of the camera; the robot stands for a second before it moves."""
    rate = np.full(len(log.time_s) + 20, offset)
    rate[20:] += np.gradient(log.pose[:, 2], log.time_s)
    angle = np.vstack([np.zeros((20, log.wheel_angle_rad.shape[1])), log.wheel_angle_rad])
    return replace(log, pose=None, wheel_angle_rad=angle, yaw_rate_rad_per_s=rate, time_s=0.05 * np.arange(len(angle)))


def test_a_gyro_alone_tells_how_the_wheels_distance_fits_their_radii():
    scene = read_scene("optiodom_diff")
    vehicle = geometry_of(scene, ("distance",)).vehicle(scene.vehicle, np.array([1.04]))
    logs = [by_gyro(exact_run(scene, vehicle, velocity, str(number)), 0.02) for number, velocity in
            enumerate([(0.3, 0.0, 0.6), (0.2, 0.0, -0.5), (0.1, 0.0, 0.8)])]
    study = identify(scene, logs, geometry_of(scene, ("distance",)))
    assert study.found.values == pytest.approx([1.04], rel=5e-3)
    assert study.measure == "heading_error_rad"
    assert study.fitted[0].heading_error_rad < 0.1 * study.nominal[0].heading_error_rad
    both = identify(scene, logs, geometry_of(scene, ("radius", "distance"))).words
    assert any("together: the runs hardly tell this from nothing" in word and "a gyro tells no lengths" in word
               for word in both)


WRONG = {
    "kinds that differ": (("mass", "radius"), {}, "--free mass with radius: voltages determine the first"),
    "no voltages": (("mass",), {"voltage_V": None}, "has no voltages"),
    "wheels that stand": (("mass",), {"wheel_angle_rad": np.zeros((61, 2))}, "its wheels stand"),
}


@pytest.mark.parametrize(("free", "change", "words"), WRONG.values(), ids=WRONG)
def test_motion_that_cannot_be_identified_is_one_line(free, change, words):
    scene = read_scene("turtlebot3_burger")
    log = stepping(scene.core(), scene.vehicle, np.array([0.3, 0.0, 0.0]), 6.0, "voltages")
    with pytest.raises(BadInput, match=words):
        identify(scene, [replace(log, **change)], geometry_of(scene, free))


def test_a_gyro_that_feels_no_turn_is_refused():
    scene = read_scene("optiodom_diff")
    with pytest.raises(BadInput, match="its gyro tells nothing; give runs with turns"):
        identify(scene, [by_gyro(exact_run(scene, scene.vehicle, (0.3, 0.0, 0.0)))], geometry_of(scene, ("distance",)))
