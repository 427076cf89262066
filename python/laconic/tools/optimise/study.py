"""An optimisation from the search to the choice: one goal to its optimum, several to their Pareto front."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from laconic.errors import BadInput
from laconic.tools.optimise.archive import Archive
from laconic.tools.optimise.polish import Polish
from laconic.tools.optimise.problem import LARGEST, Problem
from laconic.tools.optimise.scalar import OneGoal, Scalar, alone, first_of, weights
from laconic.tools.optimise.search import Effort, Loss, search

ACTIVE = 1e-6      # of a bound or range: so near, it is what stops the goal
ALIKE = 1e-9       # of the goals' spans: points of the front that differ by less are one


@dataclass(frozen=True)
class Found:
    """One choice, (p,), with its measures, (M,)."""

    choice: np.ndarray
    values: np.ndarray


@dataclass
class Result:
    """What was found. `before` is the scene as it is, `best` the choice that is written."""

    problem: Problem
    before: Found
    best: Found
    front: list[Found] = field(default_factory=list)   # along the first goal; empty for one goal
    keeps: bool = True                                 # whether `best` keeps all constraints
    measured: int = 0                                  # vehicles
    stopped: BaseException | None = None               # Ctrl-C, before the end
    cloud: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))  # measures of every feasible choice, (L, M)

    @property
    def active_constraints(self) -> list[str]:
        """Constraints that the best choice just keeps."""
        excesses = self.problem.excesses(self.best.values)
        return [each.text for each, over in zip(self.problem.constraints, excesses, strict=True) if over > -ACTIVE]

    @property
    def at_ends(self) -> list[str]:
        """Free numbers whose best value is an end of their range."""
        shares = self.problem.shares(self.best.choice)
        return [f"{each.key} is at its {'lower' if share < 0.5 else 'upper'} end"
                for each, share in zip(self.problem.free, shares, strict=True) if min(share, 1.0 - share) < ACTIVE]


def generations(problem: Problem, effort: Effort, points: int) -> int:
    """How many generations there are at most."""
    goals = len(problem.goals)
    if goals == 1:
        return effort.generations
    return effort.generations * 2 * goals + effort.between().generations * len(weights(goals, points))


def optimise(problem: Problem, before: np.ndarray, effort: Effort, seed: int, points: int = 15, pick: int | None = None,
             advance: Callable[[float], None] = lambda amount: None) -> Result:
    """The best choice; `before`: the scene's own (p,), in its ranges or not. `pick`: the point of the front, from 1.

    The same seed gives the same result on one machine. Ctrl-C ends the search; what was found until then is the result.
    """
    archive, random = Archive(problem), np.random.default_rng(seed)
    start = Found(before, problem.measured(before[None])[0])
    run = _Run(archive, effort, random, advance)
    stopped: BaseException | None = None
    scalars: list[OneGoal | Scalar] = []
    try:
        inside = problem.shares(before)[None]
        run.first = inside[((inside >= 0.0) & (inside <= 1.0)).all(axis=1)]
        scalars = run.all_scalars(points)
    except KeyboardInterrupt as why:
        stopped, scalars = why, run.begun
    if not len(archive):
        raise stopped or RuntimeError("nothing was measured")
    return _result(archive, start, scalars, pick, stopped)


class _Run:
    """The searches one after another; each begins with the best that the others have found for it."""

    def __init__(self, archive: Archive, effort: Effort, random: np.random.Generator, advance: Callable[[float], None]):
        self.archive, self.effort, self.random, self.advance = archive, effort, random, advance
        self.first = np.zeros((0, len(archive.problem.free)))
        self.begun: list[OneGoal | Scalar] = []

    def all_scalars(self, points: int) -> list[OneGoal | Scalar]:
        """Each goal alone, then what lies between."""
        goals = len(self.archive.problem.goals)
        for goal in range(goals):
            self._one(alone(goal, goals), self.effort)
        if goals > 1 and (ends := self._ends()) is not None:
            ideal, span = ends
            self.begun = []
            for goal in range(goals):
                self._one(first_of(goal, span), self.effort)
            for weight in weights(goals, points):
                self._one(Scalar(ideal, span, weight), self.effort.between())
        return self.begun

    def _ends(self) -> tuple[np.ndarray, np.ndarray] | None:
        """Ideal and span of the losses over the goals' own optima; None where nothing keeps the constraints."""
        best = [self.archive.best(each) for each in self.begun]
        if None in best:
            return None
        losses = self.archive.problem.losses(self.archive.values[np.array(best, int)])
        for goal, loss in zip(self.archive.problem.goals, losses.min(axis=0), strict=True):
            if loss <= -LARGEST:
                raise BadInput(f"--goal {goal.text}: is infinite for some choices, which no other goal outweighs; take "
                               f"it as a bound, --subject-to '{goal.measure}>=…'")
        span = losses.max(axis=0) - losses.min(axis=0)
        return losses.min(axis=0), np.where(span > 0.0, span, 1.0)

    def _one(self, scalar: OneGoal | Scalar, effort: Effort) -> None:
        self.begun.append(scalar)
        done = 0

        def generation() -> None:
            nonlocal done
            done += 1
            self.advance(1)

        search(self.archive, scalar, effort, self.random, self._known(scalar), generation)
        self._polish(scalar)
        self.advance(effort.generations - done)

    def _known(self, scalar: Loss) -> np.ndarray:
        """Shares of the best so far, and the scene's own."""
        usable = np.flatnonzero(self.archive.feasible()) if len(self.archive) else np.zeros(0, int)
        losses = scalar(self.archive.problem.losses(self.archive.values[usable])) if len(usable) else np.zeros(0)
        order = usable[np.argsort(losses, kind="stable")[:5]]
        return np.vstack([self.first, self.archive.problem.shares(self.archive.choices[order])])

    def _polish(self, scalar: OneGoal | Scalar) -> None:
        Polish(self.archive, scalar).descend()


def _result(archive: Archive, before: Found, scalars: list[OneGoal | Scalar], pick: int | None,
            stopped: BaseException | None) -> Result:
    def found(at: int) -> Found:
        return Found(archive.choices[at], archive.values[at])

    best = [at for each in scalars if (at := archive.best(each)) is not None]
    if not best:
        return Result(archive.problem, before, found(archive.nearest()), keeps=False, measured=len(archive),
                      stopped=stopped)
    front = [found(at) for at in _undominated(archive, best)] if len(archive.problem.goals) > 1 else []
    chosen = front[_picked(archive.problem, front, pick)] if front else found(best[0])
    return Result(archive.problem, before, chosen, front, measured=len(archive), stopped=stopped,
                  cloud=archive.values[archive.feasible()])


def _undominated(archive: Archive, places: list[int]) -> list[int]:
    """Those that no other is as good as in all goals and better in one, without repetitions, along the first goal."""
    places = sorted(set(places), key=lambda at: tuple(archive.problem.losses(archive.values[at])))
    losses = archive.problem.losses(archive.values[places])
    span = np.maximum(losses.max(axis=0) - losses.min(axis=0), 1e-300)
    kept: list[int] = []
    for row in range(len(places)):
        scaled = (losses - losses[row]) / span
        dominated = ((scaled <= ALIKE).all(axis=1) & (scaled < -ALIKE).any(axis=1)).any()
        repeated = any(np.abs((losses[other] - losses[row]) / span).max() <= ALIKE for other in kept)
        if not dominated and not repeated:
            kept.append(row)
    return [places[row] for row in kept]


def _picked(problem: Problem, front: list[Found], pick: int | None) -> int:
    """The point asked for, or the one whose worst goal loses least of its span."""
    if pick is not None:
        if pick > len(front):
            raise BadInput(f"--pick {pick}: the front has {len(front)} points; give one of them")
        return pick - 1
    losses = problem.losses(np.array([each.values for each in front]))
    span = np.maximum(losses.max(axis=0) - losses.min(axis=0), 1e-300)
    return int(np.argmin(((losses - losses.min(axis=0)) / span).max(axis=1)))
