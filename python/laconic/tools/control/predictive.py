"""A linear predictive controller: each step it plans the voltages of the next moments, within their limits, that bring
a robot to its course, and gives the first of them.

    controller = PredictiveController(course, limit_V=6.0)
    volts = controller.voltages(step, filter.state)

Along the course the step's own derivatives are the plan's linear model, δ⁺ = A δ + B δu + c, with c what the course
itself asks beyond the step; OSQP solves the quadratic programme of all steps of the plan at once.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import Any, ClassVar

import numpy as np
import osqp
from scipy import sparse

from laconic.core.copies import OwnMemory
from laconic.core.given import number, shown, whole_number
from laconic.core.given_array import AtLeast, check_finite, real_array
from laconic.errors import BadInput
from laconic.tools.control.course import STATES, Course, place, step_from

PRECISION = 1e-5       # of the programme's constraints: V, rad/s, m, rad
MOST_ITERATIONS = 20000
MOST_STEPS = 10**4     # of a plan: a second's work
FARTHEST = 1e6         # off the course, in a state's units: the model along the course says nothing of such places
LARGEST = 1e20         # of a programme's numbers; OSQP takes 1e30 for no limit at all
BESIDE = 0.05          # of 1 rad/s and the largest ν: as far a measured ν may be off what the wheels allow
UNITS = "rad/s, rad/s, rad/s, m, m, rad"  # of a state
WEIGHTS = (0.02, 0.02, 0.02, 400.0, 400.0, 100.0)  # of squares of rad/s, rad/s, rad/s, m, m, rad
VOLTAGE_WEIGHT = 0.02  # of the square of a V beside the course's own


class PredictiveController(OwnMemory):
    """Voltages (N,) for a robot on a `course`, never beyond ± limit_V.

    `horizon`: steps of the course that a plan reaches ahead. `weights` (6,) of squares of what is off in ν1, ν2, ν3
    [rad/s], x, y [m], θ [rad], ten times that at a plan's end; `voltage_weight` of squares of voltages beside the
    course's own. Beyond the end of the course its last pose is held to, at rest, for as long as steps are asked for. A
    plan costs one Jacobian and one programme. BadInput names the argument that does not fit. A copy's first plan is
    solved from nothing, and agrees with the original's within the programme's precision.
    """

    RENEWED: ClassVar[dict[str, Any]] = {"_linear": None, "_solver": None}

    def __init__(self, course: Course, limit_V: float, *, horizon: int = 20, weights: Sequence[float] = WEIGHTS,
                 voltage_weight: float = VOLTAGE_WEIGHT):
        if not isinstance(course, Course):
            raise BadInput(f"course: {shown(course)} is no course; give a laconic.tools.control.Course")
        self.course, self.limit_V = course, _above_0("limit_V", limit_V)
        self.horizon = whole_number("horizon", horizon)
        if not 1 <= self.horizon <= MOST_STEPS:
            raise BadInput(f"horizon: {self.horizon} steps are no plan; give 1 to {MOST_STEPS}")
        squares = real_array("weights", weights, (STATES,), "1/(rad/s)² (3 of them), 1/m² (2), 1/rad²")
        if squares.min() < 0:
            raise BadInput(f"weights: {shown(weights)}: give six numbers that are 0 or more")
        self.wheels = course.plant.wheel_count
        self._keep_linearised()
        self._solver: osqp.OSQP | None = None
        self._weights = self._cost(squares, _above_0("voltage_weight", voltage_weight))
        self._pattern = Pattern(self.horizon, self.wheels)

    def _keep_linearised(self) -> None:
        self._linear = lru_cache(maxsize=2 * self.horizon + 2)(self._linearised)

    def __setstate__(self, state: dict[str, Any]) -> None:
        super().__setstate__(state)
        self._keep_linearised()

    def voltages(self, step: int, state: np.ndarray) -> np.ndarray:
        """The voltages for this step of the course, from 0 on, in this state: ν1, ν2, ν3, x, y, θ, and more that is
        not read, as a filter's bias. Six numbers do not tell whose they are: BadInput for a motion alone that the
        robot's wheels do not allow."""
        first = whole_number("step", step)
        if first < 0:
            raise BadInput(f"step: {first} is before the course; give 0 for its first step, or more")
        given = real_array("state", state, (AtLeast(STATES),), UNITS, is_finite=False)[:STATES].copy()
        check_finite("state", given, UNITS)
        models = [self._linear(min(first + ahead, len(self.course))) for ahead in range(self.horizon)]
        off = given - models[0][3]
        if np.abs(off).max() > FARTHEST:
            raise BadInput(f"state: {shown(given)} is {np.abs(off).max():.3g} off the course, too far for a plan; "
                           f"give a state within {FARTHEST:g} ({UNITS})")
        self._check_allowed(given)
        off[5] = math.remainder(off[5], 2 * math.pi)
        plan = self._solve(models, off)
        change = plan[STATES * self.horizon :][: self.wheels]
        return np.clip(models[0][4] + change, -self.limit_V, self.limit_V)  # beyond by PRECISION at most

    def _check_allowed(self, state: np.ndarray) -> None:
        """BadInput for a motion that the robot's wheels do not allow, as that of another robot is."""
        place(self.course.plant, state)
        allowed = self.course.plant.nu
        if np.abs(state[:3] - allowed).max() > BESIDE * (1.0 + np.abs(state[:3]).max()):
            raise BadInput(f"state: the wheels of this robot do not allow nu = {shown(state[:3].tolist())} rad/s, at "
                           f"most {shown(allowed.tolist())}; give the state of this robot")

    def _linearised(self, step: int) -> tuple[np.ndarray, ...]:
        """A, B and c of a step of the course, its state and its voltages. Where it is over, the robot rests."""
        course = self.course
        if step < len(course):
            state, volts, target = course.states[step], course.voltage_V[step], course.states[step + 1]
        else:
            state = target = np.concatenate([np.zeros(3), course.states[-1][3:]])
            volts = np.zeros(self.wheels)
        after, by_state, by_voltage = step_from(course.plant, state, volts)
        return by_state, by_voltage, after - target, state, volts

    # ---- the programme: δ1 … δH, then δu0 … δu(H−1)

    def _cost(self, weights: np.ndarray, voltage_weight: float) -> sparse.csc_matrix:
        states = np.tile(weights, self.horizon)
        states[-STATES:] *= 10.0
        return sparse.diags(np.concatenate([states, np.full(self.horizon * self.wheels, voltage_weight)]), format="csc")

    def _solve(self, models: list[tuple[np.ndarray, ...]], off: np.ndarray) -> np.ndarray:
        drift = [c for _, _, c, _, _ in models]
        drift[0] = drift[0] + models[0][0] @ off
        own = np.concatenate([volts for *_, volts in models])
        lower = np.concatenate([*drift, -self.limit_V - own])
        upper = np.concatenate([*drift, self.limit_V - own])
        matrix = self._pattern.filled(models)
        if not max(np.abs(numbers).max() for numbers in (lower, upper, matrix.data)) <= LARGEST:  # NaN, too
            raise BadInput(f"the plan's numbers go beyond {LARGEST:g}; check the vehicle and the course")
        if self._solver is None:
            self._solver = osqp.OSQP()
            self._solver.setup(self._weights, np.zeros(matrix.shape[1]), matrix, lower, upper, verbose=False,
                               eps_abs=PRECISION, eps_rel=PRECISION, max_iter=MOST_ITERATIONS,
                               adaptive_rho_interval=50)  # not by the clock: the same run gives the same plan
        else:
            self._solver.update(Ax=matrix.data, l=lower, u=upper)
        found = self._solver.solve(raise_error=False)
        if found.info.status not in ("solved", "solved inaccurate"):
            raise BadInput(f"the plan has no solution ({found.info.status}); check the weights and the course")
        return np.asarray(found.x)


class Pattern:
    """Where the numbers of a programme's constraints stand: δ(k+1) − A δk − B δuk = c, and the voltages themselves.

    Every entry of a block is kept, zeros too, so that the pattern is that of every plan.
    """

    def __init__(self, horizon: int, wheels: int):
        width, blocks = STATES * horizon, []
        for k in range(horizon):
            rows = np.arange(STATES * k, STATES * (k + 1))
            blocks += [(rows, rows), _block(rows, np.arange(width + wheels * k, width + wheels * (k + 1)))]
            if k:
                blocks.append(_block(rows, rows - STATES))
        limits = np.arange(wheels * horizon)
        row, column = (np.concatenate(each) for each in zip(*blocks, (width + limits, width + limits), strict=True))
        self._order = np.lexsort((row, column))
        self.rows = width + wheels * horizon  # and columns
        self._matrix = sparse.csc_matrix((np.ones(len(row)), (row, column)), (self.rows, self.rows))
        self._matrix.sort_indices()
        self._limits = np.ones(wheels * horizon)

    def filled(self, models: list[tuple[np.ndarray, ...]]) -> sparse.csc_matrix:
        """The constraints of a plan; the same matrix each time, with other numbers."""
        parts: list[np.ndarray] = []
        for k, (by_state, by_voltage, *_) in enumerate(models):
            parts += [np.ones(STATES), -by_voltage.ravel()]
            if k:
                parts.append(-by_state.ravel())
        self._matrix.data[:] = np.concatenate([*parts, self._limits])[self._order]
        return self._matrix


def _block(rows: np.ndarray, columns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Row and column of each entry of a dense block."""
    return np.repeat(rows, len(columns)), np.tile(columns, len(rows))


def _above_0(name: str, given: object) -> float:
    value = number(name, given)
    if not (value > 0 and math.isfinite(value)):
        raise BadInput(f"{name}: {value:g} is not above 0; give a finite number that is")
    return value
