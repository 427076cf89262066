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

import numpy as np
import osqp
from scipy import sparse

from laconic.control.course import STATES, Course, step_from
from laconic.core.given import shown
from laconic.errors import BadInput

PRECISION = 1e-5       # of the programme's constraints: V, rad/s, m, rad
MOST_ITERATIONS = 20000
WEIGHTS = (0.02, 0.02, 0.02, 400.0, 400.0, 100.0)  # of squares of rad/s, rad/s, rad/s, m, m, rad
VOLTAGE_WEIGHT = 0.02  # of the square of a V beside the course's own


class PredictiveController:
    """Voltages (N,) for a robot on a `course`, never beyond ± limit_V.

    `horizon`: steps of the course that a plan reaches ahead. `weights` (6,) of squares of what is off in ν1, ν2, ν3
    [rad/s], x, y [m], θ [rad], ten times that at a plan's end; `voltage_weight` of squares of voltages beside the
    course's own. Beyond the end of the course its last state is held to. A plan costs one Jacobian and one programme.
    """

    def __init__(self, course: Course, limit_V: float, *, horizon: int = 20, weights: Sequence[float] = WEIGHTS,
                 voltage_weight: float = VOLTAGE_WEIGHT):
        if not (limit_V > 0 and math.isfinite(limit_V)):
            raise BadInput(f"limit_V: {limit_V:g} is no limit; give a value above 0")
        if horizon < 1:
            raise BadInput(f"horizon: {horizon} steps are no plan; give 1 or more")
        if np.shape(weights) != (STATES,) or not np.all(np.isfinite(weights)) or np.min(weights) < 0:
            raise BadInput(f"weights: {shown(weights)}: give six numbers that are 0 or more")
        if not (voltage_weight > 0 and math.isfinite(voltage_weight)):
            raise BadInput(f"voltage_weight: {voltage_weight:g}: give a number above 0")
        self.course, self.limit_V, self.horizon = course, float(limit_V), horizon
        self.wheels = course.plant.wheel_count
        self._linear = lru_cache(maxsize=2 * horizon + 2)(self._linearised)
        self._solver: osqp.OSQP | None = None
        self._weights = self._cost(np.array(weights, float), voltage_weight)

    def voltages(self, step: int, state: np.ndarray) -> np.ndarray:
        """The voltages for this step of the course, in this state: ν1, ν2, ν3, x, y, θ, and more that is not read."""
        given = np.asarray(state, float)
        if given.ndim != 1 or len(given) < STATES or not np.all(np.isfinite(given[:STATES])):
            raise BadInput(f"state: {shown(given.tolist())} is no state; give the numbers nu (3), x, y and heading")
        models = [self._linear(min(step + ahead, len(self.course))) for ahead in range(self.horizon)]
        off = given[:STATES] - models[0][3]
        off[5] = math.remainder(off[5], 2 * math.pi)
        plan = self._solve(models, off)
        first = plan[STATES * self.horizon :][: self.wheels]
        return np.clip(models[0][4] + first, -self.limit_V, self.limit_V)  # beyond by PRECISION at most

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

    def _constraints(self, models: list[tuple[np.ndarray, ...]]) -> sparse.csc_matrix:
        """δ(k+1) − A δk − B δuk = c, and the voltages themselves. Every entry of a block is kept, so that the pattern
        is that of every other plan."""
        width = STATES * self.horizon
        matrix = np.zeros((width, width + self.wheels * self.horizon))
        kept = np.zeros(matrix.shape, bool)
        for k, (by_state, by_voltage, *_) in enumerate(models):
            rows = slice(STATES * k, STATES * (k + 1))
            own = slice(width + self.wheels * k, width + self.wheels * (k + 1))
            matrix[rows, rows] = np.eye(STATES)
            matrix[rows, own] = -by_voltage
            kept[rows, own] = True
            kept[range(rows.start, rows.stop), range(rows.start, rows.stop)] = True
            if k:
                before = slice(STATES * (k - 1), STATES * k)
                matrix[rows, before] = -by_state
                kept[rows, before] = True
        column, row = np.nonzero(kept.T)
        upper = sparse.csc_matrix((matrix[row, column], (row, column)), matrix.shape)
        limits = sparse.hstack([sparse.csc_matrix((self.wheels * self.horizon, width)),
                                sparse.identity(self.wheels * self.horizon)], format="csc")
        return sparse.vstack([upper, limits], format="csc")

    def _solve(self, models: list[tuple[np.ndarray, ...]], off: np.ndarray) -> np.ndarray:
        drift = [c for _, _, c, _, _ in models]
        drift[0] = drift[0] + models[0][0] @ off
        own = np.concatenate([volts for *_, volts in models])
        lower = np.concatenate([*drift, -self.limit_V - own])
        upper = np.concatenate([*drift, self.limit_V - own])
        matrix = self._constraints(models)
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
