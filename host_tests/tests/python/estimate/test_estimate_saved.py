"""Estimates that are saved and given back: of their own plant alone."""

from __future__ import annotations

import math
from dataclasses import astuple

import numpy as np
import pytest
from flint import arb

import laconic
from laconic.core import load
from laconic.core.estimate import NAMES
from laconic.errors import BadInput
from laconic.scene import read_scene
from laconic.scene.methods import EXACT, EXACT_4, EXPLICIT, EXPLICIT_8, STIFF_8
from laconic.scene.scene_tables import scene_tables
from laconic.scene.step_choice import candidates, run_pilot
from laconic.simulation import advance_plant, simulate
from laconic.tools.enclosure.balls import precision
from laconic.tools.enclosure.readings import reading_of_file
from laconic.tools.enclosure.study import enclose, state_signals
from laconic.tools.report.accuracy import state_row
from laconic.tools.verify.reference import reference_states
from scene_text import MOVING_CARRIAGE


def estimate_of(robot: str = "robotino2", method: str = "auto", step_s: float = 0.01, window: int = 16):
    vehicle = laconic.Vehicle.of(laconic.read_scene(robot))
    return vehicle.plant(method, step_s).estimate(window)


@pytest.mark.parametrize("given", [None, {}, 5, b"x"])
def test_what_is_no_estimate_is_refused_with_its_maker(given):
    with pytest.raises(BadInput, match=r"^estimate: .* is no laconic_estimate of this core; make it with estimate\."):
        estimate_of().restore(given)


@pytest.mark.parametrize("other", [{"robot": "kuka_youbot"}, {"method": EXPLICIT, "step_s": 0.001}, {"step_s": 0.02},
                                   {"window": 8}, {"method": EXACT}])
def test_an_estimate_of_another_run_is_refused(other):
    with pytest.raises(BadInput, match="^estimate: was saved for another robot, method, step or window"):
        estimate_of().restore(estimate_of(**other).save())


def test_its_own_comes_back_and_one_with_a_number_that_is_none_does_not():
    estimate = estimate_of()
    estimate.run({"voltage_V": [3.0, -2.0, 1.0]}, 40)
    saved, known = estimate.save(), estimate.read()
    estimate.restore(saved)
    assert estimate.read() == known
    saved.zeta[0] = math.nan
    with pytest.raises(BadInput, match=r"^estimate.zeta\[1\]: nan is not finite"):
        estimate.restore(saved)


@pytest.mark.parametrize("step_s", [0.03, 0.05, 0.1])
def test_half_steps_of_auto_show_its_error_whatever_panels_a_step_has(step_s):
    vehicle, held = laconic.Vehicle.of(laconic.read_scene("robotino2")), {"voltage_V": [6.0, -6.0, 9.0]}
    start = (40.0, -30.0, 60.0)
    truth = vehicle.plant(STIFF_8, 0.0005, nu_rad_per_s=start)
    truth.run(held, 1200)
    plant = vehicle.plant("auto", step_s, nu_rad_per_s=start)
    estimate = plant.estimate(1)
    estimate.run(held, round(0.6 / step_s))
    error = max(abs(a - b) for a, b in zip(plant.nu, truth.nu, strict=True))
    assert error > 1e-13
    assert 0.5 < estimate.read().now.nu_rad_per_s / error < 2.0


# ---- Estimates where damping is fast on some axes and slow on others, and of steps that yaw far, beside
# enclosures.

SCENE = """
name = "fast and slow axes"
source = "made up"
[vehicle]
mass_kg = 20.0
yaw_inertia_kgm2 = 0.9
com_x_m = -0.05
com_y_m = 0.03
wheel_radius_m = 0.05
wheel_inertia_kgm2 = 0.004
motor_gain_Nm_per_V = 0.1
motor_damping_Nms = 0.0
{wheels}
[initial]
nu_rad_per_s = [{nu[0]}, {nu[1]}, {nu[2]}]
[run]
duration_s = {duration_s}
step_s = {step_s}
method = "{method}"
"""
WHEEL = """[[vehicle.wheel]]
kind = "omni"
x_m = {x_m}
y_m = {y_m}
axle_deg = {axle_deg}
motor_damping_Nms = {damping}
"""


def scene_of(folder, dampings_nms, nu, step_s, duration_s, method):
    wheels = "".join(WHEEL.format(x_m=0.25 * math.cos(math.radians(axle)), y_m=0.25 * math.sin(math.radians(axle)),
                                  axle_deg=axle + 9.0, damping=damping)
                     for axle, damping in zip((0.0, 117.0, 244.0), dampings_nms, strict=True))
    path = folder / "scene.toml"
    path.write_text(SCENE.format(wheels=wheels, nu=nu, step_s=step_s, duration_s=duration_s, method=method),
                    encoding="utf-8")
    return read_scene(path)


def check_estimate(scene, least_compared):
    """At the run's end each error above rounding is told within a quarter, and no other is told large."""
    states = state_signals(scene.wheel_count)
    run = simulate(scene, states, estimated=True)
    reading = reading_of_file(scene)
    truth = enclose(reading, reading.instants([scene.steps()]), None, "", shown=False).end.row()
    with precision(200):
        off = [float((arb(float(run.columns[name][-1])) - true).abs_upper())
               for name, true in zip(states, truth, strict=True)]
    errors = max(off[:3]), math.hypot(off[3], off[4]), off[5], max(off[6:])
    compared = 0
    for name, error, told, rounding in zip(NAMES, errors, astuple(run.errors.now), astuple(run.errors.rounding),
                                           strict=True):
        if error > 3 * rounding:
            compared += 1
            assert 0.8 * error < told < 1.25 * error, name
        else:
            assert told < 10 * rounding, name
    assert compared >= least_compared


@pytest.mark.parametrize(("dampings_nms", "yaw", "step_s"), [
    pytest.param((10.0, 10.0, 10.0), 60.0, 0.02, id="everything dies out"),
    pytest.param((9000.0, 0.0, 0.0), 30.0, 0.01, id="one axis dies out at once, two are free"),
    pytest.param((300.0, 0.05, 3000.0), 30.0, 0.01, id="a slow axis beside two fast ones"),
    pytest.param((2000.0, 0.5, 0.0), 30.0, 0.01, id="a fast axis that the others drive"),
])
def test_auto_tells_errors_that_are_made_while_damping_dies_out_or_stay_on_a_fast_axis(tmp_path, dampings_nms, yaw,
                                                                                       step_s):
    check_estimate(scene_of(tmp_path, dampings_nms, (90.0, 200.0, yaw), step_s, 0.06, "auto"), 2)


@pytest.mark.parametrize("method", [EXACT, EXACT_4])
def test_steps_that_yaw_too_far_for_eighth_order_are_compared_with_shorter_ones(tmp_path, method):
    """Two half steps by the method itself err as much as one step where damping is fast."""
    check_estimate(scene_of(tmp_path, (10.0, 10.0, 10.0), (20.0, 0.0, 100.0), 0.2, 0.2, method), 2)


@pytest.mark.parametrize("duration_s", [0.04, 0.06, 0.08])
def test_errors_that_fade_at_first_and_then_stay_are_told_in_each_step(tmp_path, duration_s):
    check_estimate(scene_of(tmp_path, (10.0, 10.0, 0.0), (20.0, 0.0, 60.0), 0.02, duration_s, EXACT_4), 2)


# ---- `step_s = "auto"`: the step that is found keeps the tolerance, and is a number from there on.

STEPPED = """
[[input]]
signal = "voltage_V[1]"
kind = "steps"
t_s = [0.0, 0.5]
value = [5.0, -5.0]
"""
WAVE = """
[[input]]
signal = "voltage_V[2]"
kind = "sine"
amplitude = 5.0
frequency_Hz = 2.0
"""
AUTO = """
[run]
duration_s = 1.0
step_s = "auto"
tolerance = {}
"""


def text_of(tolerance="1e-7", inputs=STEPPED, run=AUTO):
    return MOVING_CARRIAGE + inputs + run.format(tolerance)


def scene_in(folder, text):
    path = folder / "auto.toml"
    path.write_text(text, encoding="utf-8")
    return read_scene(path)


def true_error(scene):
    plant, inputs = scene.plant(load("double")), scene.inputs_on_grid()
    advance_plant(plant, inputs, 0, scene.steps())
    end = reference_states(scene, np.array([scene.run.duration_s]))[0]
    return float(np.max(np.abs(state_row(plant) - end)))


@pytest.mark.parametrize("inputs", [STEPPED, WAVE], ids=["steps", "sine"])
@pytest.mark.parametrize("tolerance", ["1e-4", "1e-8"])
def test_the_step_that_is_found_keeps_the_tolerance_and_the_next_larger_one_does_not(tmp_path, inputs, tolerance):
    scene = scene_in(tmp_path, text_of(tolerance, inputs))
    assert scene.run.tolerance == float(tolerance)
    assert true_error(scene) <= float(tolerance)
    larger = [step for step in candidates(1.0) if step > scene.run.step_s]
    fitting = [step for step in larger if is_fitting(scene, step)]
    assert fitting and true_error(scene.with_step(fitting[-1])) > 0.1 * float(tolerance)


def is_fitting(scene, step_s):
    try:
        run_pilot(scene, step_s)
    except BadInput:
        return False
    return True


def test_it_is_a_number_from_there_on(tmp_path):
    scene = scene_in(tmp_path, text_of())
    given = scene_in(tmp_path, text_of().replace('step_s = "auto"\ntolerance = 1e-7', f"step_s = {scene.run.step_s!r}"))
    assert given.run.tolerance is None
    for name, column in simulate(given).columns.items():
        assert column.tobytes() == simulate(scene).columns[name].tobytes()
    assert scene.with_run(step_s=0.1).run.tolerance is None
    tables = scene_tables(scene_in(tmp_path, text_of()).path)
    assert tables.value("run.step_s") == scene.run.step_s
    assert tables.with_values({"vehicle.mass_kg": 11.0}).scene().run.step_s == scene.run.step_s


def test_another_method_finds_another_step(tmp_path):
    scene = scene_in(tmp_path, text_of("1e-8"))
    assert scene.with_run(method=EXACT).run.step_s < scene.run.step_s
    assert scene.with_run(method=EXPLICIT_8).run.tolerance == 1e-8


@pytest.mark.parametrize(("step", "tolerance", "words"), [
    ('"auto"', None, "run.tolerance: is missing"), ("0.01", "1e-6", "run.tolerance: has a meaning"),
    ('"automatic"', "1e-6", "run.tolerance: has a meaning"), ('"automatic"', None, "run.step_s: is the text"),
    ('"auto"', "0", "run.tolerance: is 0"), ('"auto"', "-1e-6", "run.tolerance: is -1e-06"),
    ('"auto"', "nan", "run.tolerance: is nan"), ('"auto"', '"fine"', "run.tolerance: is the text"),
    ('"auto"', "5", "run.tolerance: is 5; give 1 "), ('"auto"', "1e-17", "run.tolerance: 1e-17 is kept by no step"),
    ('"auto"', "1e-300", "the least error found is"),
])
def test_nonsense_is_one_line(tmp_path, step, tolerance, words):
    run = f"duration_s = 1.0\nstep_s = {step}\n" + (f"tolerance = {tolerance}\n" if tolerance else "")
    with pytest.raises(BadInput) as refused:
        scene_in(tmp_path, f"{MOVING_CARRIAGE}{STEPPED}[run]\n{run}")
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_run_that_no_step_of_the_grid_fits_is_told(tmp_path):
    with pytest.raises(BadInput, match=r"run.step_s: no step of 1, 2 or 5 times a power of ten fits"):
        scene_in(tmp_path, text_of().replace("t_s = [0.0, 0.5]", "t_s = [0.0, 0.3333333333333]"))
