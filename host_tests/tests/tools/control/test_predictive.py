"""The predictive controller: its plan against bounded least squares, and the loop with a node over the wire."""

from __future__ import annotations

import math
import sys

import numpy as np
import pytest
from scipy.optimize import lsq_linear

import laconic
from laconic import BadInput
from laconic.base.paths import SOURCE_DIR
from laconic.can.rig.buses import virtual_node
from laconic.tools.control import Camera, Course, Filter, PredictiveController, drive, plot_drive
from laconic.tools.control.predictive import VOLTAGE_WEIGHT, WEIGHTS

LIMIT_V = 10.0
ENCODER = {"counts_per_turn": 2000}
PAYLOAD = """
[vehicle.payload]
mass_kg = 1.5
x_m = 0.03
y_m = 0.02
yaw_inertia_kgm2 = 0.0
[initial]
x_m = 0.05
y_m = -0.06
heading_rad = 0.1
"""
SENSORS = """
[sensors.imu]
yaw_rate_bias_rad_per_s = 0.02
yaw_rate_noise_rad_per_s_per_sqrt_Hz = 1e-3
seed = 7
[sensors.encoder]
counts_per_turn = 2000
"""
KNOWN = {"voltage_noise_V_per_sqrt_Hz": 0.1, "slip_noise_m_per_s_per_sqrt_Hz": 1e-3, "encoder_std_rad": 1.3e-3,
         "yaw_rate_std_rad_per_s": 8e-3, "position_std_m": 0.05, "heading_std_rad": 0.1, "bias_std_rad_per_s": 0.03}
EVERY = 5  # steps of the node for one of the controller


def eight(t_s):
    turn = 2 * math.pi * t_s / 8
    return 0.5 * math.sin(turn), 0.25 * math.sin(2 * turn), 0.8 * math.sin(turn)


def robot():
    return laconic.Vehicle.of(laconic.read_scene("robotino2"))


def course_of_eight(duration_s=8.0):
    return Course(robot().plant("auto", step_s=0.05), eight, duration_s)


def true_scene(folder, sensors=SENSORS):
    """The robot as it is: heavier than the controller knows, and elsewhere."""
    path = folder / "true.toml"
    text = (SOURCE_DIR / "scenes/robotino2.toml").read_text(encoding="utf-8")
    path.write_text(text + PAYLOAD + sensors, encoding="utf-8")
    return laconic.read_scene(path).with_run(step_s=0.01)


def driven(folder, choose, steps=400):
    known = Filter(robot().plant("auto", step_s=0.01), KNOWN, encoder=ENCODER)
    with virtual_node("double") as node:
        return drive(node, true_scene(folder), known, choose, steps, every=EVERY, camera=Camera(50, 0.01, 0.02, seed=3))


@pytest.fixture(scope="module")
def course():
    return course_of_eight()


@pytest.fixture(scope="module")
def closed(course, tmp_path_factory):
    return driven(tmp_path_factory.mktemp("closed"), PredictiveController(course, LIMIT_V).voltages)


@pytest.fixture(scope="module")
def alone(course, tmp_path_factory):
    return driven(tmp_path_factory.mktemp("alone"),
                  lambda step, state: np.clip(course.voltage_V[step], -LIMIT_V, LIMIT_V))


def test_the_voltages_of_a_course_keep_a_robot_on_it():
    course = course_of_eight(2.0)
    plant = course.plant
    for k, volts in enumerate(course.voltage_V):
        assert [*plant.nu, *plant.pose[:3]] == pytest.approx(course.states[k], abs=3e-3)
        plant.run({"voltage_V": list(volts)})


def test_a_course_has_only_motions_that_wheels_allow():
    cart = laconic.Vehicle.of(laconic.read_scene("turtlebot3_burger")).plant("auto", step_s=0.05)
    sideways = Course(cart, lambda t: (0.1 * t, 0.3 * t, 0.0), 0.5)
    along = Course(cart, lambda t: (0.1 * t, 0.0, 0.0), 0.5)
    assert sideways.states[:, :3] == pytest.approx(along.states[:, :3], abs=1e-9)


def plan_by_least_squares(controller, step, state):
    """The same programme without its states: min Σ w δ² + Σ r δu² over voltages in their limits."""
    course, horizon, wheels = controller.course, controller.horizon, controller.wheels
    models = [controller._linearised(min(step + k, len(course))) for k in range(horizon)]
    effect, drift = np.zeros((6, horizon * wheels)), state[:6] - models[0][3]
    rows, targets = [], []
    for k, (by_state, by_voltage, c, _, _) in enumerate(models):
        effect = by_state @ effect
        effect[:, wheels * k : wheels * (k + 1)] += by_voltage
        drift = by_state @ drift + c
        weight = np.sqrt(np.array(WEIGHTS) * (10 if k == horizon - 1 else 1))
        rows.append(weight[:, None] * effect)
        targets.append(-weight * drift)
    rows.append(math.sqrt(VOLTAGE_WEIGHT) * np.eye(horizon * wheels))
    targets.append(np.zeros(horizon * wheels))
    own = np.concatenate([volts for *_, volts in models])
    found = lsq_linear(np.vstack(rows), np.concatenate(targets), (-controller.limit_V - own, controller.limit_V - own),
                       tol=1e-12)
    return (found.x + own)[:wheels]


@pytest.mark.parametrize("limit_V", [LIMIT_V, 40.0])
def test_a_plan_is_the_best_within_the_limits(course, limit_V):
    random, held = np.random.default_rng(8), 0
    controller = PredictiveController(course, limit_V, horizon=12)
    for step in (0, 7, 60, 158):
        off = random.normal(size=6) * [2, 2, 0.5, 0.05, 0.05, 0.1]
        state = course.states[step] + off
        volts = controller.voltages(step, state)
        held += np.any(np.abs(volts) > limit_V - 1e-3)
        assert volts == pytest.approx(plan_by_least_squares(controller, step, state), abs=0.01)
    assert held > 0 if limit_V == LIMIT_V else held == 0


def test_a_heading_in_another_turn_is_the_same_heading(course):
    controller = PredictiveController(course, LIMIT_V)
    state = course.states[3] + [0, 0, 0, 0, 0, 4 * math.pi]
    assert controller.voltages(3, state) == pytest.approx(controller.voltages(3, course.states[3]), abs=1e-3)


def test_in_the_loop_with_a_node_it_tracks_ten_times_better_than_the_course_s_voltages(course, closed, alone):
    after = 30  # steps of the course in which it comes from where it stood, and the camera tells where that was
    off = [run.distance_to(course.states, EVERY)[after:] for run in (closed, alone)]
    tracked, open_loop = (np.sqrt(np.mean(each**2)) for each in off)
    assert tracked < 0.015
    assert open_loop > 0.1


def test_in_the_loop_voltages_reach_their_limits_and_never_pass_them(closed):
    highest = np.abs(closed.voltage_V).max(axis=1)
    assert highest.max() <= LIMIT_V + 1e-9
    assert np.mean(highest > LIMIT_V - 0.01) > 0.1


def test_in_the_loop_the_estimate_is_as_good_as_the_filter_says(closed):
    ratio = closed.pose_error / closed.pose_std
    assert np.mean(np.abs(ratio) < 3) >= 0.99
    assert np.all(closed.pose_std[-1] < [0.01, 0.01, 0.02])
    bias, std = closed.estimate[-1][6], closed.covariance[-1][6, 6] ** 0.5
    assert bias == pytest.approx(0.02, abs=4 * std)
    assert std < 1e-3


def test_the_same_loop_gives_the_same_run(tmp_path, course, closed):
    again = driven(tmp_path, PredictiveController(course, LIMIT_V).voltages, steps=60)
    assert np.array_equal(np.array(again.voltage_V), np.array(closed.voltage_V)[:60])
    assert np.array_equal(np.array(again.estimate), np.array(closed.estimate)[:60])


def test_its_picture_is_drawn(tmp_path, course, closed, alone):
    plot_drive(closed, course, tmp_path / "drive.svg", limit_V=LIMIT_V, open_loop=alone)
    text = (tmp_path / "drive.svg").read_text(encoding="utf-8")
    assert text.count("<path") > 40


def test_what_makes_no_sense_is_refused_by_name(course):
    plant = robot().plant("auto", step_s=0.05)
    for call, text in ((lambda: Course(plant, eight, 0.01), "duration_s: 0.01"),
                       (lambda: PredictiveController(course, 0.0), "limit_V: 0"),
                       (lambda: PredictiveController(course, 1.0, horizon=0), "horizon: 0"),
                       (lambda: PredictiveController(course, 1.0, weights=(1, 1)), r"weights: .* of shape \(6,\)"),
                       (lambda: PredictiveController(course, 1.0, weights=[1] * 5 + [math.nan]), r"weights\[6\]: nan"),
                       (lambda: PredictiveController(course, 1.0, voltage_weight=0), "voltage_weight: 0"),
                       (lambda: PredictiveController(course, 1.0).voltages(0, [0.0] * 5), "state: .*6 or more"),
                       (lambda: PredictiveController(course, 1.0).voltages(0, [math.nan] * 6), r"state\[1\]: nan")):
        with pytest.raises(BadInput, match=text):
            call()


def test_a_node_without_instruments_or_with_another_step_is_refused(tmp_path):
    known = Filter(robot().plant("auto", step_s=0.02), KNOWN, encoder=ENCODER)
    for sensors, text in ((SENSORS.partition("[sensors.encoder]")[0], r"\[sensors.encoder\]"),
                          (SENSORS, "step of 0.02 s")):
        scene = true_scene(tmp_path, sensors)
        with virtual_node("double") as node, pytest.raises(BadInput, match=text):
            drive(node, scene, known, lambda step, state: np.zeros(3), 1)


@pytest.mark.parametrize(("library", "module", "name"), [("osqp", "predictive", "PredictiveController"),
                                                        ("casadi", "casadi_step", "casadi_step")])
def test_without_its_library_one_line_says_what_to_install(monkeypatch, library, module, name):
    import laconic.tools.control as room
    monkeypatch.setitem(sys.modules, library, None)
    monkeypatch.delitem(sys.modules, f"laconic.tools.control.{module}", raising=False)
    monkeypatch.delitem(vars(room), name, raising=False)
    with pytest.raises(BadInput, match=rf'needs {library}, .* pip install "laconic\[control\]"'):
        getattr(room, name)


@pytest.mark.parametrize("volts", [[1.0, 2.0], [1.0, 2.0, math.nan]])
def test_voltages_that_are_none_are_refused_before_they_are_sent(tmp_path, volts):
    with pytest.raises(BadInput, match="choose: gave .*; give a finite voltage for each of 3 wheels"):
        driven(tmp_path, lambda step, state: np.array(volts), steps=1)
