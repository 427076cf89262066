"""Estimates where damping is fast on some axes and slow on others, and of steps that yaw far, beside enclosures."""

from __future__ import annotations

import math
from dataclasses import astuple

import pytest
from flint import arb

from laconic.core.estimate import NAMES
from laconic.scene import read_scene
from laconic.scene.methods import EXACT, EXACT_4
from laconic.simulation import simulate
from laconic.tools.enclosure.balls import precision
from laconic.tools.enclosure.readings import reading_of_file
from laconic.tools.enclosure.study import enclose, state_signals

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
