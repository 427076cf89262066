"""Everything that was measured on the way, so that nothing is measured twice and an interrupt loses nothing."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from laconic.tools.optimise.problem import Problem

FEASIBLE = 1e-9  # by how much of its size a bound may be passed: what rounding and the solver leave


class Archive:
    """Choices with their measures. `note` hears of every choice that was measured anew, by their number."""

    def __init__(self, problem: Problem, note: Callable[[int], None] = lambda count: None):
        self.problem, self._note = problem, note
        self._rows: dict[bytes, int] = {}
        self._choices: list[np.ndarray] = []
        self._values: list[np.ndarray] = []

    def __len__(self) -> int:
        return len(self._values)

    @property
    def choices(self) -> np.ndarray:
        """(L, p)"""
        return np.array(self._choices).reshape(-1, len(self.problem.free))

    @property
    def values(self) -> np.ndarray:
        """(L, M)"""
        return np.array(self._values).reshape(-1, len(self.problem.measures))

    def measured(self, shares: np.ndarray) -> np.ndarray:
        """Measures (L, M) at shares (L, p) of the ranges."""
        choices = self.problem.choices(np.clip(shares, 0.0, 1.0))
        names = [row.tobytes() for row in choices]
        fresh = [at for at, name in enumerate(names) if name not in self._rows]
        fresh = list({names[at]: at for at in fresh}.values())
        if fresh:
            self._keep([names[at] for at in fresh], choices[fresh])
        found = [self._values[self._rows[name]] for name in names]
        return np.array(found).reshape(len(names), len(self.problem.measures))

    def _keep(self, names: list[bytes], choices: np.ndarray) -> None:
        values = self.problem.measured(choices)
        for name, choice, value in zip(names, choices, values, strict=True):
            self._rows[name] = len(self._values)
            self._choices.append(choice)
            self._values.append(value)
        self._note(len(names))

    def feasible(self) -> np.ndarray:
        """Which choices keep all constraints and have all goals measured, (L,)."""
        values = self.values
        keeps = (self.problem.excesses(values) <= FEASIBLE).all(axis=1)
        return np.asarray(keeps & (self.problem.losses(values) < np.inf).all(axis=1))

    def best(self, loss: Callable[[np.ndarray], np.ndarray]) -> int | None:
        """The feasible choice of the least loss, a function of goals' losses (L, goals); None where there is none."""
        usable = np.flatnonzero(self.feasible())
        if not len(usable):
            return None
        return int(usable[np.argmin(loss(self.problem.losses(self.values[usable])))])

    def nearest(self) -> int:
        """The choice that is least beyond the constraints."""
        beyond = np.maximum(self.problem.excesses(self.values), 0.0).sum(axis=1)
        unmeasured = ~np.isfinite(self.problem.losses(self.values)).all(axis=1)
        return int(np.argmin(beyond + np.where(unmeasured, 1e60, 0.0)))
