"""The core's friction solver against the oracle, one step at a time, and along driven motions with warm starts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from references.friction.core_solver import CoreSolution, solve_in_core
from references.friction.polish import polish
from references.friction.problem import StepProblem, residual, size_of

LIMIT = 1e-9
FEW = 4   # wheels: for refusals, vehicles with more are counted apart


@dataclass
class Count:
    """What was found in many steps; `bad` are the worst, each with its problem."""

    solved: int = 0
    refused: int = 0
    many_solved: int = 0        # vehicles of more than FEW wheels
    many_refused: int = 0
    unsure: int = 0             # the oracle did not finish
    residual: float = 0.0
    difference: float = 0.0
    bad: list[tuple[str, StepProblem]] = field(default_factory=list)

    def refuse_or_take(self, problem: StepProblem, core: CoreSolution) -> bool:
        """Counts the step; whether the core took it."""
        taken, few = core.passes > 0, problem.wheels <= FEW
        name = ("" if few else "many_") + ("solved" if taken else "refused")
        setattr(self, name, getattr(self, name) + 1)
        return taken

    def may_refuse(self, share: float) -> bool:
        """Whether steps with few wheels were refused no more often than this; one of a small sample always may be."""
        return self.refused <= max(1.0, share * (self.solved + self.refused))

    def share_refused(self) -> str:
        """Of vehicles with few wheels, and how many with more."""
        return f"{self.refused} ({self.refused / max(1, self.solved + self.refused):.1e}) and {self.many_refused}"

    def texts(self, label: str) -> dict[str, str]:
        """For a report."""
        few, many = self.solved + self.refused, self.many_solved + self.many_refused
        return {f"{label}: steps": f"{few} with up to {FEW} wheels, {many} with more",
                f"{label}: refused": self.share_refused(),
                f"{label}: worst": f"residual {self.residual:.1e}, difference {self.difference:.1e}, "
                                   f"oracle not sure of {self.unsure}"}


def difference(core: np.ndarray, exact: np.ndarray) -> float:
    """The largest difference of a speed, relative to the larger of 1 rad/s and the largest speed."""
    return float(np.max(np.abs(core - exact)) / max(1.0, float(np.max(np.abs(exact)))))


def speed_difference(problem: StepProblem, core: np.ndarray, exact: np.ndarray) -> float:
    """For wheels as vehicles have them: each speed by itself."""
    return difference(core, exact)


def energy_difference(problem: StepProblem, core: np.ndarray, exact: np.ndarray) -> float:
    """For wheels of any inertia: |z − z_exact|_M over the size of the step's free motion.

    The step minimises an energy whose curvature is at least M, so a residual bounds the energy's excess and its root
    this norm, and no other: a wheel with 1e-6 of the body's inertia hardly moves it.
    """
    size = size_of(problem, exact)
    away = float(np.linalg.norm(np.sqrt(problem.masses()) * (core - exact)))
    return away / size if size > 0.0 else away


def compare(problem: StepProblem, count: Count, name: str = "",
            differ: Callable[[StepProblem, np.ndarray, np.ndarray], float] = speed_difference) -> None:
    """One cold step: refused, or its residual and its difference from the oracle are counted."""
    core = solve_in_core(problem)
    if not count.refuse_or_take(problem, core):
        count.bad.append((f"{name} refused", problem))
        return
    rest = residual(problem, core.z, core.slip_impulse)
    exact = polish(problem)
    count.unsure += not exact.certain
    away = differ(problem, core.z, exact.z) if exact.certain else 0.0
    if not (rest <= LIMIT and away <= LIMIT):
        count.bad.append((f"{name} residual {rest:.1e} difference {away:.1e}", problem))
    count.residual, count.difference = max(count.residual, rest), max(count.difference, away)
