"""From the best that the search found to the optimum itself: SciPy's SLSQP with the measures' gradients.

Several goals are the least t that no part exceeds, so that the corner of a maximum is smooth for the solver. Where a
measure has a corner of its own (a condition number of 1), SLSQP may gain nothing: then the search's choice stays.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.optimize import minimize

from laconic.tools.optimise.archive import Archive
from laconic.tools.optimise.scalar import OneGoal, Scalar

STEP = 1e-6  # of a range, for differences
ROUNDS = 50
AGAIN = 4      # descents: one that a corner has stopped goes on from the best it met,
GAIN = 1e-11   # as long as that is better by this share


class Polish:
    """One descent; every choice on the way goes into the archive."""

    def __init__(self, archive: Archive, scalar: Scalar | OneGoal):
        self.archive, self.problem, self.scalar = archive, archive.problem, scalar
        self._slopes: dict[bytes, tuple[np.ndarray, np.ndarray]] = {}  # by parts (K, p) and excesses (C, p), at shares

    def descend(self) -> None:
        """From the archive's best to a local optimum, again from there as long as it helps."""
        before = np.inf
        for _ in range(AGAIN):
            at = self.archive.best(self.scalar)
            if at is None:
                return
            now = float(self.scalar(self.problem.losses(self.archive.values[at])))
            if not now < before - GAIN * abs(now):
                return
            before = now
            self._once(self.problem.shares(self.archive.choices[at]))

    def _once(self, start: np.ndarray) -> None:
        first = self._parts(start)
        count, several = len(start), len(first) > 1
        if not np.isfinite(first).all():
            return
        scale = max(float(np.abs(first).max()), 1e-12)
        top = [float(first.max()) / scale] if several else []
        limits: list[dict[str, object]] = []
        if self.problem.constraints:
            limits.append(_limit(lambda z: -self._excesses(z[:count]),
                                 lambda z: -_widened(self._slope(z[:count])[1], several, 0.0)))
        if several:
            limits.append(_limit(lambda z: z[-1] - self._parts(z[:count]) / scale,
                                 lambda z: -_widened(self._slope(z[:count])[0] / scale, True, -1.0)))

        def loss(z: np.ndarray) -> float:
            return float(z[-1]) if several else float(self._parts(z[:count])[0]) / scale

        def gradient(z: np.ndarray) -> np.ndarray:
            return np.eye(len(z))[-1] if several else self._slope(z[:count])[0][0] / scale

        bounds = [(0.0, 1.0)] * count + [(None, None)] * several
        minimize(loss, np.concatenate([start, top]), jac=gradient, method="SLSQP", bounds=bounds, constraints=limits,
                 options={"maxiter": ROUNDS, "ftol": 1e-13})

    def _parts(self, shares: np.ndarray) -> np.ndarray:
        return self.scalar.parts(self.problem.losses(self._values(shares)))

    def _excesses(self, shares: np.ndarray) -> np.ndarray:
        return self.problem.excesses(self._values(shares))

    def _values(self, shares: np.ndarray) -> np.ndarray:
        return self.archive.measured(shares[None])[0]

    def _slope(self, shares: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """∂parts/∂shares (K, p) and ∂excesses/∂shares (C, p)."""
        name = shares.tobytes()
        if name not in self._slopes:
            by_share = self._by_share(np.clip(shares, 0.0, 1.0))
            signs = [-1.0 if goal.is_largest else 1.0 for goal in self.problem.goals]
            by_losses = np.array([sign * by_share[self.problem.column(goal.measure)]
                                  for sign, goal in zip(signs, self.problem.goals, strict=True)])
            self._slopes = {name: (self.scalar.gradient @ by_losses, self._by_excesses(by_share))}
        return self._slopes[name]

    def _by_share(self, shares: np.ndarray) -> np.ndarray:
        """(M, p) by second-order differences, one-sided at the ends of ranges, but where the derivative is known."""
        count = len(shares)
        one = np.where(shares < STEP, STEP, -STEP)
        other = np.where(shares < STEP, 2.0 * STEP, np.where(shares > 1.0 - STEP, -2.0 * STEP, STEP))
        around = np.repeat(shares[None], 2 * count + 1, axis=0)
        around[range(1, count + 1), range(count)] += one
        around[range(count + 1, 2 * count + 1), range(count)] += other
        values = self.archive.measured(around)
        with np.errstate(invalid="ignore"):
            first, second = (values[1:] - values[0]).reshape(2, count, -1)
            found = ((first * (other / one)[:, None] - second * (one / other)[:, None]) / (other - one)[:, None]).T
        return np.nan_to_num(self._with_exact(shares, found), nan=0.0, posinf=0.0, neginf=0.0)

    def _with_exact(self, shares: np.ndarray, by_share: np.ndarray) -> np.ndarray:
        """The rows that the problem knows exactly in place of differences."""
        exact = self.problem.jacobian(self.problem.choices(shares))
        if exact is None:
            return by_share
        spans = self.problem.choices(np.ones(len(shares))) - self.problem.choices(np.zeros(len(shares)))
        return np.where(np.isnan(exact), by_share, exact * spans)

    def _by_excesses(self, by_share: np.ndarray) -> np.ndarray:
        signs = [(1.0 if each.is_upper else -1.0) / (abs(each.bound) or 1.0) for each in self.problem.constraints]
        rows = [sign * by_share[self.problem.column(each.measure)]
                for sign, each in zip(signs, self.problem.constraints, strict=True)]
        return np.array(rows).reshape(-1, by_share.shape[1])


def _limit(function: Callable[[np.ndarray], np.ndarray], jacobian: Callable[[np.ndarray], np.ndarray]
           ) -> dict[str, object]:
    return {"type": "ineq", "fun": function, "jac": jacobian}


def _widened(rows: np.ndarray, several: bool, last: float) -> np.ndarray:
    """With the column of t, where there is one."""
    return np.column_stack([rows, np.full(len(rows), last)]) if several else rows
