"""Estimates that are saved and given back: of their own plant alone."""

from __future__ import annotations

import math

import pytest

import laconic
from laconic.errors import BadInput
from laconic.scene.methods import EXACT, EXPLICIT, STIFF_8


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
