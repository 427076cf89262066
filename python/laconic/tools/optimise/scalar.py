"""One number to make small from several goals: the weighted Chebyshev form, whose minima are the Pareto front's points.

Each goal's loss is measured from its ideal (the best value alone) over its span (from there to the worst that the other
goals' own optima have). The least possible maximum of these, each over its weight, is a point of the front for every
choice of weights, on a front of any shape; a small sum of them all keeps weakly dominated points out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

SUM = 1e-6       # of the scaled losses, beside their maximum
SECOND = 1e-4    # of the scaled losses of the other goals, beside the one that comes first
LEAST_WEIGHT = 1e-3


@dataclass(frozen=True)
class Scalar:
    """parts(losses) = (losses − ideal)/(span · weight), and a little of their sum; the largest part counts."""

    ideal: np.ndarray
    span: np.ndarray
    weight: np.ndarray

    @property
    def gradient(self) -> np.ndarray:
        """∂parts/∂losses, (parts, goals)."""
        scale = 1.0 / (self.span * np.maximum(self.weight, LEAST_WEIGHT))
        return np.diag(scale) + SUM * scale

    def parts(self, losses: np.ndarray) -> np.ndarray:
        """(…, parts) from (…, goals)."""
        with np.errstate(invalid="ignore"):
            found = np.where(np.isfinite(losses), losses - self.ideal, 0.0) @ self.gradient.T
        return np.where(np.isfinite(losses).all(axis=-1, keepdims=True), found, np.inf)

    def __call__(self, losses: np.ndarray) -> np.ndarray:
        """The largest part, (…,)."""
        return self.parts(losses).max(axis=-1)


@dataclass(frozen=True)
class OneGoal:
    """The loss of one goal, and so little of the others that it decides between choices alike: row · losses."""

    row: np.ndarray  # (goals,)

    @property
    def gradient(self) -> np.ndarray:
        """∂parts/∂losses, (1, goals)."""
        return self.row[None]

    def parts(self, losses: np.ndarray) -> np.ndarray:
        """(…, 1) from (…, goals)."""
        return self(losses)[..., None]

    def __call__(self, losses: np.ndarray) -> np.ndarray:
        """(…,)"""
        counts = np.where(np.isfinite(losses), losses, 0.0) @ self.row
        return np.where(np.isfinite(losses).all(axis=-1), counts, np.inf)


def alone(goal: int, goals: int) -> OneGoal:
    """One goal, whatever the others."""
    return OneGoal(np.eye(goals)[goal])


def first_of(goal: int, span: np.ndarray) -> OneGoal:
    """One goal, then the others: the end of the front."""
    row = SECOND * span[goal] / span
    row[goal] = 1.0
    return OneGoal(row)


def weights(goals: int, points: int) -> np.ndarray:
    """Weights that sum to 1, evenly spread and none 0, about `points` of them: (points, goals)."""
    divisions = points + 1 if goals == 2 else _divisions(goals, points)
    found = [row for row in _compositions(divisions, goals) if min(row) > 0]
    return np.array(found, float) / divisions


def _divisions(goals: int, points: int) -> int:
    divisions = goals
    while sum(min(row) > 0 for row in _compositions(divisions + 1, goals)) <= points:
        divisions += 1
    return divisions


def _compositions(total: int, parts: int) -> list[tuple[int, ...]]:
    """All ways to write a whole number as an ordered sum."""
    if parts == 1:
        return [(total,)]
    return [(first, *rest) for first in range(total + 1) for rest in _compositions(total - first, parts - 1)]
