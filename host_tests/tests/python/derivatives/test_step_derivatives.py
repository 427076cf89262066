"""Derivatives of a step against differences of every method's map in 50 digits; and what a user sees of them."""

from __future__ import annotations

from dataclasses import replace
from itertools import islice

import numpy as np
import pytest

from laconic import BadInput, Refused
from laconic.base.paths import SOURCE_DIR, built
from laconic.core import load
from laconic.core.derivatives import StepDerivatives
from laconic.scene.methods import EXACT, EXACT_4, EXPLICIT, EXPLICIT_8, STIFF, STIFF_4, STIFF_8
from laconic.tools.report.counting import cachegrind_present, instructions_of
from laconic.tools.verify.exact import exact_gauss
from laconic.tools.verify.exact.trials import (
    KINDS,
    METHODS,
    Trial,
    difference,
    directions,
    error,
    made_up,
    plant_of,
    tangent,
    trials,
)
from references.derivatives.c_table import adjoint_error, cases, found_numbers, given_numbers

TRIALS = len(KINDS) * len(METHODS)
TOLERANCE = 1e-11
CARRIAGE = {"mass_kg": 10.0, "yaw_inertia_kgm2": 0.2, "wheel_radius_m": 0.05, "wheel_inertia_kgm2": 0.002,
            "motor_gain_Nm_per_V": 0.5, "motor_damping_Nms": 0.02,
            "wheel": [{"kind": "omni", "x_m": 0.1, "y_m": 0.0, "axle_rad": 0.0},
                      {"kind": "omni", "x_m": -0.1, "y_m": 0.0, "axle_rad": 3.0},
                      {"kind": "omni", "x_m": 0.0, "y_m": 0.12, "axle_rad": 1.5}]}
HELD = {"voltage_V": [2.0, -1.0, 0.5]}


def carriage(real="double", method="auto", **more):
    core = load(real)
    return core.plant(core.vehicle({**CARRIAGE, **more}), method, 0.01, nu_rad_per_s=(1.0, -0.5, 2.0), heading_rad=0.4)


@pytest.mark.nightly
def test_tangents_of_every_method_and_kind_of_vehicle_agree_with_differences_in_50_digits():
    random, worst = np.random.default_rng(5), {}
    for trial, plant in islice(trials(load()), TRIALS):
        for name, along in directions(random, trial, plant).items():
            off = error(tangent(trial, plant, along), difference(trial, plant, along), along)
            worst[trial.method, trial.kind, name] = off
    assert len({method for method, _, _ in worst}) == len(METHODS)
    assert max(worst.values()) <= TOLERANCE, max(worst, key=worst.get)


def test_the_jacobian_has_the_tangents_as_columns_and_the_adjoint_is_its_transpose():
    random = np.random.default_rng(2)
    for trial, plant in islice(trials(load(), seed=3), TRIALS):
        step = StepDerivatives(plant, trial.held)
        state = random.normal(size=6 + plant.wheel_count)
        jacobian = step.jacobian(world_force=True)
        assert step.tangent(state) == pytest.approx(jacobian.by_state @ state, rel=1e-12, abs=1e-12)
        assert adjoint_error(random, trial, plant) <= 1e-14


@pytest.mark.parametrize(("seed", "kind", "method"), [(901, "bare", EXACT), (1529, "mecanum", EXACT_4),
                                                      (1853, "bare", STIFF_4)])
def test_a_displacement_that_changes_less_than_the_yaw_keeps_its_digits(seed, kind, method):
    trial = made_up(np.random.default_rng(seed), kind, method)
    plant = plant_of(load(), trial)
    along = directions(np.random.default_rng(seed), trial, plant)["input"]
    assert error(tangent(trial, plant, along), difference(trial, plant, along), along) <= 1e-13


@pytest.mark.parametrize(("seed", "kind"), [(1063, "mixed"), (2432, "omni"), (3879, "mixed")])
def test_a_fast_damping_leaves_the_digits_of_a_change_by_the_inertia_that_it_nearly_cancels(seed, kind):
    trial = made_up(np.random.default_rng(seed), kind, STIFF)
    plant = plant_of(load(), trial)
    still = directions(np.random.default_rng(seed), trial, plant)["vehicle"]
    along = replace(still, vehicle={"wheel_inertia_kgm2": 1.0})
    assert error(tangent(trial, plant, along), difference(trial, plant, along), along) <= TOLERANCE


@pytest.mark.parametrize(("seed", "kind", "method"), [(303, "mixed", EXPLICIT_8), (961, "mecanum", EXPLICIT)])
def test_the_adjoint_is_the_transpose_also_of_a_column_whose_terms_cancel(seed, kind, method):
    trial = made_up(np.random.default_rng(seed), kind, method)
    assert adjoint_error(np.random.default_rng(seed), trial, plant_of(load(), trial)) <= 1e-14


def test_gradients_by_the_vehicle_are_the_tangents_along_its_numbers():
    names = ["mass_kg", "com_x_m", "wheel_radius_m", "motor_damping_Nms", "wheel[2].x_m", "wheel[3].axle_rad",
             "payload.mass_kg", "ground.slope_rad"]
    slope = {"slope_rad": 0.1, "slope_heading_rad": 0.3}
    step = StepDerivatives(carriage(payload={"mass_kg": 1.0, "x_m": 0.1, "y_m": 0.0, "yaw_inertia_kgm2": 0.0},
                                    ground=slope), HELD)
    gradient = np.arange(1.0, 10.0)
    expected = [gradient @ step.tangent(vehicle={name: 1.0}) for name in names]
    assert step.vehicle_gradient(gradient, names) == pytest.approx(expected, rel=1e-11)


def test_the_plant_stays_as_it_is_and_names_fit_the_matrices():
    plant = carriage()
    before = plant.row()
    jacobian = StepDerivatives(plant, HELD).jacobian()
    assert np.array_equal(plant.row(), before)
    assert jacobian.by_state.shape == (len(jacobian.state_names),) * 2
    assert jacobian.by_input.shape == (len(jacobian.state_names), len(jacobian.input_names))
    assert jacobian.by_input[jacobian.state_names.index("heading_rad"), jacobian.input_names.index("voltage_V[1]")] != 0


def test_single_precision_has_the_same_jacobian_to_its_digits():
    double, single = (StepDerivatives(carriage(real), HELD).jacobian() for real in ("double", "single"))
    assert single.by_state.dtype == np.float32
    assert single.by_state == pytest.approx(double.by_state, rel=2e-5, abs=1e-6)


def test_what_has_no_derivative_is_refused_by_its_name():
    step = StepDerivatives(carriage(), HELD)
    with pytest.raises(BadInput, match="not smooth"):
        StepDerivatives(carriage(ground={"friction_coefficient": 0.5}), HELD)
    with pytest.raises(BadInput, match=r"wheel\[4\]\.x_m: there is no such wheel"):
        step.tangent(vehicle={"wheel[4].x_m": 1.0})
    with pytest.raises(BadInput, match="no such number"):
        step.tangent(vehicle={"mass": 1.0})
    with pytest.raises(BadInput, match="no table"):
        step.tangent(vehicle={"load.mass_kg": 1.0})
    with pytest.raises(BadInput, match="change of the state"):
        step.tangent([1.0, 2.0])
    with pytest.raises(Refused, match="voltage_V"):
        StepDerivatives(carriage(), {"voltage_V": [float("nan"), 0.0, 0.0]}).jacobian()


WRONG = {
    "vehicle: [] is no mapping": lambda step: step.tangent(vehicle=[]),
    "vehicle: {1: 2.0} is no mapping": lambda step: step.tangent(vehicle={1: 2.0}),
    "mass_kg: nan is not finite": lambda step: step.tangent(vehicle={"mass_kg": np.nan}),
    "names: None is no list of names": lambda step: step.vehicle_gradient(np.ones(9), None),
    "names: 'mass_kg' is no list of names": lambda step: step.vehicle_gradient(np.ones(9), "mass_kg"),
    "names: [1] is no list of names": lambda step: step.vehicle_gradient(np.ones(9), [1]),
    "change of the state[9]: nan is not finite": lambda step: step.tangent([*[0.0] * 8, np.nan]),
    "change of the state: [[1.0], [1.0, 2.0]] is no list": lambda step: step.tangent([[1.0], [1.0, 2.0]]),
    "change of the state[1]: -inf is not finite": lambda step: step.adjoint(np.full(9, -np.inf)),
    "change of the state[2]: nan is not finite": lambda step: step.vehicle_gradient([0, np.nan, *[0] * 7], ["mass_kg"]),
    "change of the input: voltage_V: nan is not finite": lambda step: step.tangent(held={"voltage_V[2]": np.nan}),
    "1: there is no such input": lambda step: step.tangent(held={1: 2.0}),
}


@pytest.mark.parametrize("message", WRONG)
def test_what_is_no_direction_is_refused_in_one_line(message):
    with pytest.raises(BadInput) as caught:
        WRONG[message](StepDerivatives(carriage(), HELD))
    assert str(caught.value).startswith(message)


@pytest.mark.nightly
@pytest.mark.parametrize("damping, force_N, moment_Nm, least", [
    (0.0, 10.0, -8.0, 1e-4), (0.02, 10.0, 8.0, 1e-7), (0.02, 16.0, 8.0, 1e-9)])
def test_rounds_that_converge_late_are_derived_at_the_solution(monkeypatch, damping, force_N, moment_Nm, least):
    table = {**CARRIAGE, "yaw_inertia_kgm2": 0.225, "com_x_m": 0.0, "com_y_m": 0.02, "wheel_inertia_kgm2": 0.009,
             "motor_damping_Nms": damping, "wheel": [
                 {"kind": "roller", "x_m": x, "y_m": y, "axle_rad": axle, "roller_rad": np.pi / 2}
                 for x, y, axle in ((0.05, 0.0, 0.0), (-0.05, 0.0, np.pi), (0.0, 0.06, np.pi / 2))]}
    held = {"voltage_V": [1.5, 0.8, 0.1], "axle_torque_Nm": [-0.03, -0.01, 0.01], "body_force_N": [0.8, -0.5],
            "body_moment_Nm": [moment_Nm], "world_force_N": [force_N, 0.6], "world_force_point_m": [0.5, -0.07]}
    trial = Trial("omni", STIFF_8, table, 0.8, [0.8, -0.5, 2.4], 0.0, held)
    random, plant = np.random.default_rng(1), plant_of(load(), trial)
    for along in directions(random, trial, plant).values():
        found = difference(trial, plant, along)
        assert error(tangent(trial, plant, along), found, along) <= TOLERANCE
        with monkeypatch.context() as more:
            more.setattr(exact_gauss, "MOST_ROUNDS", 32)
            assert error(difference(trial, plant, along), found, along) > least
    assert adjoint_error(random, trial, plant) <= 1e-13


# ---- What all Jacobians of a step cost beside the step, in instructions: the same on every run.

FEW, MANY = 100, 300  # calls: what a count of one run has in common with another's cancels
LIMIT = 6.0           # steps
LIMITS = {STIFF_8: 6.6}  # rounds at four nodes, in which a direction costs as much as the step


def cost(method: str, what: str) -> float:
    """Instructions of one step, or of one answer about it."""
    program = str(built("bin/count_derivatives"))
    few, many = (instructions_of([program, method, what, str(calls)]) for calls in (FEW, MANY))
    return (many - few) / (MANY - FEW)


@pytest.mark.nightly
@pytest.mark.skipif(not cachegrind_present(), reason="valgrind is not installed")
@pytest.mark.parametrize("method", METHODS)
def test_all_jacobians_by_state_and_input_cost_no_more_steps_than_the_limit(capsys, method):
    step, jacobian = cost(method, "step"), cost(method, "jacobian")
    with capsys.disabled():
        print(f"\n{method}: {step:.0f} instructions a step, its Jacobians {jacobian:.0f}, {jacobian / step:.2f} steps")
    assert jacobian / step <= LIMITS.get(method, LIMIT)


# ---- The table of exact steps for the core's C tests is the one that its maker gives.

TABLE = SOURCE_DIR / "core_c/tests/support/exact_steps.h"
RECKONED = (0, 5, 13)  # cases whose results are computed once more


def words(text: str) -> str:
    return " ".join(text.split())


def test_the_committed_table_is_that_of_its_maker():
    table, core = words(TABLE.read_text(encoding="utf-8")), load("double")
    every = list(cases())
    for number, trial in enumerate(every):
        assert words(f"{{{', '.join(given_numbers(trial))}}}, /* {trial.kind} */") in table
        if number in RECKONED:
            rows = [f"{{{', '.join(found_numbers(core, trial, method))}}}" for method in METHODS]
            assert words(", ".join(rows)) in table
    assert f"#define EXACT_CASES {len(every)}" in table
