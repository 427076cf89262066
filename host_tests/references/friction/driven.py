"""A random vehicle driven through many friction steps of the core with warm starts, and what each step must keep.

Between the steps stands the simplest motion that keeps energy: (ν1, ν2) turn by h ν3/Λ, then the forces act. A step
must take energy away from what its free motion and its motors bring: ½|z⁺|² <= ½|z*|² + motors·s⁺.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from references.friction.agreement import LIMIT, Count, difference
from references.friction.core_solver import CoreSolution, solve_in_core
from references.friction.polish import polish
from references.friction.problem import StepProblem, residual, size_of
from references.friction.vehicles import GRAVITY, random_vehicle, step_problem

HOLD_STEPS = 25             # a voltage is held so long
ROUNDING = 1e-8             # of the step's energy: the solver's accuracy of 1e-9 in a speed, and some
SMALLEST = 1e-140           # speeds whose squares underflow are rest
COMPARED = 50               # one step of so many is compared with the oracle, the first of them in the middle


@dataclass
class Motion:
    """The state between steps: ν, s and the contacts' last impulses."""

    z: np.ndarray
    impulse: np.ndarray


class Driven:
    """One vehicle with a step size, random voltages now and then, coasting in between; one in four on a slope."""

    def __init__(self, random: np.random.Generator):
        self.random, self.vehicle = random, random_vehicle(random)
        count = len(self.vehicle["wheel"])
        self.step_s = 10.0 ** random.uniform(-3.5, -2)
        self.turn = self.step_s / math.sqrt(self.vehicle["yaw_inertia_kgm2"]
                                            / (self.vehicle["mass_kg"] * self.vehicle["wheel_radius_m"]**2))
        self.slope = float(random.choice([0.0, 0.0, 0.0, random.uniform(0, 0.5)]))
        self.heading = random.uniform(-math.pi, math.pi)
        self.load_N = self.vehicle["mass_kg"] * GRAVITY * math.cos(self.slope) / count * np.ones(count)
        self.motion = Motion(np.zeros(3 + count), np.zeros((count, 2)))
        self.steps = 0

    def problem(self) -> StepProblem:
        """The next step's."""
        count = len(self.vehicle["wheel"])
        if self.steps % HOLD_STEPS == 0:
            coasts = self.random.random() < 0.3
            self.voltage_V = (not coasts) * self.random.standard_normal(count) * 10.0 ** self.random.uniform(-1, 1.5)
        angle = self.turn * self.motion.z[2]
        cos, sin = math.cos(angle), math.sin(angle)
        first, second, third = self.motion.z[:3]
        pull = self.step_s * GRAVITY * math.sin(self.slope) / self.vehicle["wheel_radius_m"]
        free = np.array([cos * first + sin * second, cos * second - sin * first, third])
        free[:2] -= pull * np.array([math.cos(self.heading), math.sin(self.heading)])
        return step_problem(self.vehicle, free, self.motion.z[3:], self.step_s, voltage_V=self.voltage_V,
                            torque_Nm=np.zeros(count), load_N=self.load_N)

    def advance(self, count: Count) -> None:
        """One step, warm; where the core refuses, the oracle's solution goes on."""
        problem, last = self.problem(), self.motion
        core = solve_in_core(problem, nu=last.z[:3], speed=last.z[3:], impulse=last.impulse)
        self.steps += 1
        if count.refuse_or_take(problem, core):
            judge(problem, core, count)
            if self.steps % COMPARED == COMPARED // 2:
                agree(problem, core, count)
            self.motion = Motion(core.z, core.slip_impulse)
        else:
            count.bad.append(("warm refused", problem))
            exact = polish(problem)
            self.motion = Motion(exact.z, exact.slip_impulse)


def judge(problem: StepProblem, core: CoreSolution, count: Count) -> None:
    """Counts the residual, and as bad a step that is not finite, off, or brings energy."""
    if size_of(problem, core.z) < SMALLEST:
        return
    if not (np.isfinite(core.z).all() and np.isfinite(core.slip_impulse).all()):
        count.bad.append(("not finite", problem))
        return
    rest, gain = residual(problem, core.z, core.slip_impulse), energy_gain(problem, core.z)
    count.residual = max(count.residual, rest)
    if not rest <= LIMIT:
        count.bad.append((f"residual {rest:.1e}", problem))
    if not gain <= ROUNDING:
        count.bad.append((f"energy grows by {gain:.1e}", problem))


def agree(problem: StepProblem, core: CoreSolution, count: Count) -> None:
    """Counts the difference from the oracle's speeds, and as bad a large one."""
    exact = polish(problem)
    count.unsure += not exact.certain
    away = difference(core.z, exact.z) if exact.certain else 0.0
    count.difference = max(count.difference, away)
    if not away <= LIMIT:
        count.bad.append((f"difference {away:.1e}", problem))


def energy_gain(problem: StepProblem, z: np.ndarray) -> float:
    """How far the energy after the step exceeds what it may be, relative to the step's size; 0 or less is right."""
    mass, free = problem.masses(), np.concatenate([problem.free_nu, problem.free_speed])
    before, after = 0.5 * free @ (mass * free), 0.5 * z @ (mass * z)
    work = float(problem.drive_impulse(z[3:]) @ z[3:])
    return float(after - before - work) / size_of(problem, z)**2


def drive(seed: int | list[int], steps: int, count: Count) -> None:
    """Drives one random vehicle."""
    driven = Driven(np.random.default_rng(seed))
    for _ in range(steps):
        driven.advance(count)
