"""Which measures an optimisation needs, and how all of them are had for many choices at once."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from laconic.errors import BadInput
from laconic.scene.key_path import check_apart, key_path
from laconic.scene.scene_tables import SceneTables
from laconic.tools.measures import measure_given
from laconic.tools.measures import measures_of as measures_of_kind
from laconic.tools.measures.arguments import ArguedMeasure
from laconic.tools.measures.measure import OF_RUN, Measure, lacks
from laconic.tools.optimise.candidates import Candidates
from laconic.tools.optimise.gradient import RunGradient
from laconic.tools.optimise.problem import Constraint, Free, Goal, Problem, measures_of
from laconic.tools.optimise.search import Runs

OF_TIME = ("run.duration_s", "run.step_s")


def problem_of(tables: SceneTables, free: Sequence[Free], goals: Sequence[Goal],
               constraints: Sequence[Constraint]) -> tuple[Problem, np.ndarray, Measuring]:
    """The problem, the scene's own choice and what measures; BadInput names the option that does not fit."""
    if not free:
        raise BadInput("--free: is missing; give what may be chosen, KEY=a:b, such as vehicle.com_y_m=0:0.05")
    if not goals:
        raise BadInput("--goal: is missing; give min:MEASURE or max:MEASURE; --goals lists the measures")
    names = measures_of(goals, constraints)
    measures = [measure_given(name, None, "--goal" if any(goal.measure == name for goal in goals) else "--subject-to")
                for name in names]
    own = np.array([_own(tables, each) for each in free])
    _check_free(free, measures)
    measuring = Measuring(tables, free, measures)
    _check_start(measuring, own)
    problem = Problem(tuple(free), tuple(goals), tuple(constraints), measuring.measured, measuring.jacobian)
    return problem, own, measuring


def listing() -> str:
    """The measures that goals and constraints may name, a line each."""
    lines = []
    for measure in sorted(measures_of_kind().values(), key=lambda each: each.kind):
        usage = measure.usage if isinstance(measure, ArguedMeasure) else measure.name
        lines += [f"{usage} [{measure.unit or '–'}]", f"    {measure.words}."]
    return "\n".join(lines)


def _own(tables: SceneTables, free: Free) -> float:
    """What the scene has."""
    try:
        values = [tables.value(key) for key in free.keys]
        kinds = [key_path(key).known.kind for key in free.keys]
    except BadInput as why:
        raise BadInput(f"--free {why}") from None
    for key, kind, value in zip(free.keys, kinds, values, strict=True):
        if kind != "number":
            raise BadInput(f"--free {key}: is {kind}, which has no range; free a number")
        if value is None or isinstance(value, str) or value != values[0]:
            raise BadInput(f"--free {free.key}: the scene has no single value of it to begin with; give it one there")
    return float(values[0] or 0.0)


def _check_free(free: Sequence[Free], measures: Sequence[Measure]) -> None:
    """No number twice, no time where a measure compares runs instant by instant."""
    keys = [key for each in free for key in each.keys]
    check_apart("--free", [key_path(key) for key in keys])
    for key in keys:
        beside = [each.name for each in measures if each.is_beside_nominal and not each.is_of_end]
        if beside and key in OF_TIME:
            raise BadInput(f"--free {key}: {beside[0]} compares the same instants of two runs; leave one of them out")


def _check_start(measuring: Measuring, own: np.ndarray) -> None:
    """BadInput where a measure has no value for the scene as it is, in the core's words if it refuses the vehicle."""
    values = measuring.measured(own[None])[0]
    for measure, value in zip(measuring.measures, values, strict=True):
        if math.isnan(value):
            raise measuring.refusal(own) or BadInput(
                f"{measure.name}: has no value for {measuring.candidates.base.path} as it is; give another measure, or "
                "a direction in which its wheels can move it")


class Measuring:
    """All measures of many choices, of models and of runs; `measured` and `jacobian` are what a Problem asks."""

    def __init__(self, tables: SceneTables, free: Sequence[Free], measures: Sequence[Measure]):
        self.candidates, self.measures = Candidates(tables, free), measures
        self._of_run = np.array([measure.kind == OF_RUN for measure in measures])
        for measure in measures:
            if missing := lacks(measure, self.candidates.base):
                raise BadInput(f"{measure.name}: needs {missing}, which {tables.path} does not give")
        of_runs = [measure for measure in measures if measure.kind == OF_RUN]
        self.runs = Runs(tables, free, of_runs) if of_runs else None
        self.gradient = RunGradient(self.candidates, measures) if of_runs else None

    def measured(self, choices: np.ndarray) -> np.ndarray:
        """(L, M) of choices (L, p); NaN where there is none."""
        found = np.full((len(choices), len(self.measures)), np.nan)
        if not self._of_run.all():
            prepared = self.candidates.prepared(choices)
            for column in np.flatnonzero(~self._of_run).tolist():
                found[:, column] = prepared.measured(self.measures[column].of)
        if self.runs is not None:
            found[:, self._of_run] = self.runs.measured(choices)
        return found

    def jacobian(self, choice: np.ndarray) -> np.ndarray | None:
        """(M, p) at a choice (p,), NaN where only differences tell; None where no measure has an exact one."""
        return None if self.gradient is None else self.gradient.jacobian(choice)

    @property
    def exact(self) -> list[str]:
        """Measures whose gradient is exact: through every step of the run."""
        known = [] if self.gradient is None else self.gradient.known
        return [measure.name for measure, is_known in zip(self.measures, known, strict=False) if is_known]

    def refusal(self, choice: np.ndarray) -> BadInput | None:
        """Why a choice makes no vehicle, or none that runs; None where it does."""
        refused = self.candidates.prepared(choice[None]).refused[0]
        return refused if refused or self.runs is None else self.runs.refusal(choice)
