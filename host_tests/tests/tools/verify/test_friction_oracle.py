"""The oracle of the friction step holds by itself, before it judges the core."""

from __future__ import annotations

import math

import numpy as np
import pytest

from references.friction.held import rolled_over_travelled
from references.friction.polish import polish
from references.friction.problem import StepProblem
from references.friction.residual import residual
from references.friction.vehicles import random_problem, random_vehicle

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
