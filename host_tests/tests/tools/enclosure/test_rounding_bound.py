"""The bound of one step's rounding in single precision: its text has the core's bits, and no step is beyond it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from mpmath import mp, mpf

from laconic.core import load
from laconic.scene import read_scene, rigid_scene_names
from laconic.scene.methods import EXPLICIT
from laconic.tools.enclosure.rounding_bound import (
    Constants,
    constants_of,
    forcing_of,
    rk4_step,
    rounding_bounds,
    rounding_row,
)

SCENES = ("s1", "robotino2", "paper_three_wheel_free", "robomaster_mecanum", "paper_differential_drive")
TURNING = ("s1", "paper_three_wheel_free")  # within these steps; the others go straight ahead at first
STEPS = 300
FLUSHED = 1e-17  # components below it are flushed on their way to 0


def steps_of(name: str) -> Any:
    """A scene's plant in single, and what it is before and after each step."""
    scene = read_scene(name).with_run(method=EXPLICIT, real="single")
    plant, values = scene.plant(load("single")), scene.inputs_on_grid().held_at(0)
    held, b = plant.core.input(values), forcing_of(plant, values)

    def steps() -> Any:
        for _ in range(STEPS):
            before = plant.save()
            plant.run(held)
            yield before, plant.save()

    return plant, b, steps()


@pytest.mark.parametrize("name", SCENES)
def test_the_text_of_the_step_has_the_cores_bits(name):
    plant, b, steps = steps_of(name)
    k = constants_of(plant, np.float32)
    for before, after in steps:
        step = rk4_step(k, [np.float32(part.value) for part in before.zeta], [np.float32(x) for x in b])
        for sums, old, addends in ((after.zeta, before.zeta, step.delta), (after.travel, before.travel, step.path)):
            for new, part, addend in zip(sums, old, addends, strict=True):
                wanted = addend + np.float32(part.rest)
                value = np.float32(part.value) + wanted
                assert value == np.float32(new.value) or abs(value) < FLUSHED
                assert wanted - (value - np.float32(part.value)) == np.float32(new.rest) or abs(value) < FLUSHED


def total(part: Any) -> Any:
    return mpf(float(part.value)) + mpf(float(part.rest))


def turned(state: Any) -> Any:
    heading = state.heading
    return 2 * mp.pi * (int(heading.turns) + (mpf(int(heading.fraction)) + 2 * mpf(float(heading.rest))) / 2**32)


@pytest.mark.parametrize("name", SCENES)
def test_no_step_is_further_from_exact_arithmetic_than_the_bound(name):
    found = rounding_bounds(read_scene(name))
    plant, b, steps = steps_of(name)
    worst = np.zeros(3)
    with mp.workdps(40):
        k: Constants = constants_of(plant, mpf)
        to_nu = [[mpf(float(x)) for x in row] for row in plant.c.model.nu_of_zeta]
        for before, after in steps:
            step = rk4_step(k, [total(part) for part in before.zeta], [mpf(float(x)) for x in b])
            off = [total(new) - total(old) - d for new, old, d in zip(after.zeta, before.zeta, step.delta, strict=True)]
            of_nu = max(abs(sum(x * e for x, e in zip(row, off, strict=True))) for row in to_nu)
            of_heading = abs(turned(after) - turned(before) - step.yaw)
            moved = mp.mpc(step.forth, step.left) * mp.expj(turned(before) + step.yaw / 2)
            of_place = max(abs(total(after.x_m) - total(before.x_m) - moved.real),
                           abs(total(after.y_m) - total(before.y_m) - moved.imag))
            worst = np.maximum(worst, [float(of_nu), float(of_heading), float(of_place)])
    bounds = np.array([found.nu_rad_per_s, found.heading_rad, found.place_m])
    assert np.all(worst <= bounds), (worst, bounds)
    felt = worst > 1e-3 * bounds  # it is a bound of this, and not of anything
    assert felt[0], (worst, bounds)
    assert felt.all() or name not in TURNING, (worst, bounds)


@pytest.mark.nightly
def test_what_has_no_bound_says_why_and_all_else_has_one():
    rows = {name: rounding_row(read_scene(name)) for name in rigid_scene_names()}
    without = {name: row["status"] for name, row in rows.items() if row["status"] != "ok"}
    assert set(without) == {"paper_caster", "robotino_green", "robotino_grey", "skid_steer"}
    assert "fixed in the world" in without["paper_caster"]
    assert "stick and slip" in without["skid_steer"]
    assert all(row["place_m_per_hour"] < 0.05 for row in rows.values() if row["status"] == "ok")


def test_a_step_that_yaws_too_far_has_no_bound():
    fast = rounding_row(read_scene("paper_three_wheel_free").with_run(step_s=0.5, duration_s=600.0))
    assert "yaws by a quarter of a radian" in fast["status"]
