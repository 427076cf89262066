"""The core's friction solver agrees with the oracle; host_tests/assurance/long/friction.py does the same for longer.

Vehicles on ground with friction that nothing drives; assurance/long/friction.py does the same for longer.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from laconic.errors import Refused
from references.friction import coasting
from references.friction.agreement import LIMIT, Count, compare, energy_difference
from references.friction.coasting import ROUNDING, Coasted, coast, rest
from references.friction.core_solver import CoreSolution, solve_in_core
from references.friction.driven import drive, energy_gain
from references.friction.hard import KINDS, hard_problem
from references.friction.held import rolled_over_travelled
from references.friction.polish import polish
from references.friction.problem import StepProblem, residual, size_of
from references.friction.vehicles import random_problem, random_vehicle

HARD, STEPS = 12, 40
MOST_COLD_REFUSED, MOST_WARM_REFUSED = 1e-2, 1e-3


def problems(count):
    """Random cold steps."""
    for seed in range(count):
        random = np.random.default_rng(seed)
        yield random_problem(random, random_vehicle(random))


@pytest.mark.parametrize("cold", [60, pytest.param(120, marks=pytest.mark.nightly)])
def test_cold_random_steps_agree_with_the_oracle_to_1e9_and_have_that_residual_and_few_are_refused(cold):
    count = Count()
    for problem in problems(cold):
        compare(problem, count)
    assert [text for text, _ in count.bad if "refused" not in text] == []
    assert count.unsure == 0
    assert max(count.residual, count.difference) <= LIMIT
    assert count.may_refuse(MOST_COLD_REFUSED)


@pytest.mark.parametrize("vehicles", [15, pytest.param(30, marks=pytest.mark.nightly)])
def test_driven_vehicles_never_gain_energy_from_a_warm_step_nor_leave_the_residual_or_the_oracle(vehicles):
    count = Count()
    for seed in range(vehicles):
        drive(seed, STEPS, count)
    assert [text for text, _ in count.bad if "refused" not in text] == []
    assert count.may_refuse(MOST_WARM_REFUSED)
    assert 0.0 < count.difference <= LIMIT
    assert count.solved > 0.5 * vehicles * STEPS


def test_a_vehicle_whose_wheels_hold_each_other_with_a_hundred_times_the_free_motion_is_hardly_ever_refused():
    count = Count()
    drive([1, 12], 200, count)
    assert count.solved + count.refused == 200
    assert count.refused <= 1
    assert count.residual <= LIMIT


def test_accepted_hard_steps_agree_with_the_oracle_to_1e9_in_the_norm_of_the_energy_and_have_that_residual():
    count = Count()
    for number in range(HARD):
        kind = KINDS[number % len(KINDS)]
        compare(hard_problem(kind, np.random.default_rng(number)), count, kind, energy_difference)
    assert [text for text, _ in count.bad if "refused" not in text] == []
    assert count.solved > 0.8 * HARD


def test_in_single_precision_cold_steps_agree_with_the_oracle_to_its_digits():
    worst, refused, tried = 0.0, 0, 0
    for problem in problems(60):
        if problem.wheels > 4:
            continue
        core, tried = solve_in_core(problem, "single"), tried + 1
        refused += core.passes == 0
        if core.passes:
            exact, mass = polish(problem).z, np.sqrt(problem.masses())
            size = np.linalg.norm(mass * np.concatenate([problem.free_nu, problem.free_speed + problem.drive_impulse(
                np.zeros(problem.wheels)) / problem.inertia]))
            worst = max(worst, np.linalg.norm(mass * (core.z - exact)) / size if size > 0.0 else 0.0)
    assert worst <= 1e-3
    assert refused <= 0.1 * tried


def test_an_error_in_the_norm_of_the_energy_counts_by_what_the_speed_carries():
    problem = next(problems(1))
    exact = polish(problem).z
    for place, mass in enumerate(problem.masses()):
        off = exact.copy()
        off[place] += 1e-3
        assert energy_difference(problem, off, exact) == pytest.approx(
            1e-3 * mass**0.5 / size_of(problem, exact), rel=1e-6)


def test_a_wrong_solution_of_the_core_is_found(monkeypatch):
    problem = next(problems(1))

    def spoilt(problem):
        core = solve_in_core(problem)
        return CoreSolution(core.z * (1 + 1e-8), core.slip_impulse, core.passes)

    monkeypatch.setattr("references.friction.agreement.solve_in_core", spoilt)
    count = Count()
    compare(problem, count)
    assert len(count.bad) == 1 and "difference" in count.bad[0][0]


def test_energy_that_grows_is_found():
    problem = next(problems(1))
    exact = polish(problem).z
    assert energy_gain(problem, exact) <= 1e-12 < energy_gain(problem, 30.0 * exact)


def test_a_case_read_from_its_file_is_the_same_to_the_last_bit(tmp_path):
    problem = next(problems(1))
    problem.save(tmp_path / "case.json", what="test")
    again = StepProblem.load(tmp_path / "case.json")
    assert all(np.array_equal(getattr(problem, name), value) for name, value in vars(again).items())


# ---- The oracle of the friction step holds by itself, before it judges the core.

PROBLEMS = 40
ROBOTINO = {
    "mass_kg": 8.0, "yaw_inertia_kgm2": 0.0625, "wheel_radius_m": 0.04,
    "wheel": [{"kind": "omni", "x_m": 0.125 * math.cos(a), "y_m": 0.125 * math.sin(a), "axle_rad": a}
              for a in (math.pi / 3, math.pi, 5 * math.pi / 3)]}


@pytest.fixture(scope="module")
def solved():
    """Random problems with their polished solutions."""
    problems = []
    for seed in range(PROBLEMS):
        random = np.random.default_rng(seed)
        problem = random_problem(random, random_vehicle(random))
        problems.append((problem, polish(problem)))
    return problems


def test_the_oracle_solves_random_steps_to_30_digits_but_for_redundant_contacts_and_these_to_rounding(solved):
    assert all(answer.certain for _, answer in solved)
    assert sum(answer.done for _, answer in solved) >= 0.95 * PROBLEMS


def test_the_polished_solution_is_the_minimum_with_the_curvature_of_the_masses_around_it(solved):
    random = np.random.default_rng(7)
    for problem, answer in solved:
        least, mass = problem.energy(answer.z), problem.masses()
        unit = np.linalg.norm(np.sqrt(mass) * answer.z) or 1.0
        for size in (1e-3, 0.1, 1.0):
            away = size * unit * random.standard_normal(len(mass)) / np.sqrt(mass)
            climbed = problem.energy(answer.z + away) - least
            assert climbed >= 0.5 * away @ (mass * away) * (1 - 1e-6) - 1e-12 * max(abs(least), unit**2)


def test_the_residual_is_rounding_at_the_solution_and_grows_with_the_distance_from_it(solved):
    random = np.random.default_rng(8)
    for problem, answer in solved:
        assert residual(problem, answer.z, answer.slip_impulse) <= 1e-12
        size = np.linalg.norm(np.sqrt(problem.masses()) * np.concatenate([problem.free_nu, problem.free_speed]))
        if size > 0.0:
            away = 1e-4 * size * random.standard_normal(len(answer.z)) / np.sqrt(problem.masses())
            assert residual(problem, answer.z + away, answer.slip_impulse) > 1e-9


@pytest.mark.parametrize("grip", [0.01, 0.3, 10.0, np.inf])
def test_one_wheel_with_free_rollers_takes_the_impulse_that_its_grip_allows_and_its_slip_needs(grip):
    along, inertia, free_nu, free_speed = np.array([0.6, 0.8, 0.5]), 0.2, np.array([1.0, -0.3, 0.4]), 2.0
    none = np.zeros(1)
    problem = StepProblem(
        along=along[None], across=np.array([[-0.8, 0.6, 0.1]]), rim_along=np.ones(1), rim_across=none,
        inertia=np.array([inertia]), drag=none, grip=np.array([grip]), axle=none, drive=none, drive_slope=none,
        drive_limit=np.array([np.inf]), viscous=none, free_speed=np.array([free_speed]), free_nu=free_nu)
    slip, weight = along @ free_nu - free_speed, along @ along + 1.0 / inertia
    impulse = np.clip(slip / weight, -grip, grip)
    expected = np.array([*(free_nu - along * impulse), free_speed + impulse / inertia])
    np.testing.assert_allclose(polish(problem).z, expected, rtol=1e-14)


@pytest.mark.parametrize("drag, ahead, sideways", [(0.0, 1.0, 1.0), (0.5, 1.19, 1.09), (0.87, 1.68, 1.26)])
def test_a_robotino_on_held_wheels_covers_less_than_they_roll_by_the_rollers_drag(drag, ahead, sideways):
    found = [rolled_over_travelled(ROBOTINO, direction, drag) for direction in ((1.0, 0.0), (0.0, 1.0))]
    assert found == pytest.approx([ahead, sideways], abs=0.01)   # the prototype's, with its start from rest
    closed = [(3 + drag**2) / (3 - drag**2), (3 + drag**2) / 3]  # where the derivative of Φ by ν vanishes
    assert found == pytest.approx(closed, rel=1e-5)


@pytest.mark.parametrize("real", ["double", "single"])
def test_coasting_vehicles_never_gain_energy_and_no_step_is_refused(real):
    count = Coasted()
    for number in range(60):
        coast([5, number], count, real, 200)
    assert count.wrong == []
    assert count.refused == 0
    assert count.steps == 60 * 200
    assert count.stopped > 0
    assert count.growth <= ROUNDING[real]


@pytest.mark.parametrize("real", ["double", "single"])
def test_what_is_pulled_by_less_than_breakaway_keeps_every_bit(real):
    count = Coasted()
    for number in range(150):
        rest([5, number], count, real, 100)
    assert count.wrong == []
    assert count.resting == 150 * 100


def test_the_same_seed_finds_the_same(monkeypatch):
    found = []
    for _ in range(2):
        count = Coasted()
        coast([1, 2], count, steps=50)
        found.append(count)
    assert found[0] == found[1]


def test_energy_of_a_free_vehicle_that_grows_is_found(monkeypatch):
    monkeypatch.setattr(coasting.Slope, "potential_J", lambda slope, plant: 1e6 * plant.steps)
    count = Coasted()
    coast([1, 2], count)
    assert count.steps == 0 and "energy grows" in count.wrong[0] and "[1, 2]" in count.wrong[0]


def test_rest_that_moves_is_found(monkeypatch):
    monkeypatch.setattr(coasting, "SHARE", 30.0)
    count = Coasted()
    for number in range(10):
        rest([1, number], count)
    assert any("has moved" in line for line in count.wrong)


@pytest.mark.parametrize(("status", "refused", "wrong"), [("step unsolved", 1, 0), ("overflow", 0, 1)])
def test_a_step_that_is_not_solved_is_counted_and_any_other_refusal_is_wrong(status, refused, wrong, monkeypatch):
    def refuse(plant, held, steps=1):
        raise Refused(status, "", 0, "as told")

    monkeypatch.setattr(coasting.Plant, "run", refuse)
    count = Coasted()
    coast([1, 2], count)
    assert (count.refused, len(count.wrong)) == (refused, wrong)
