"""Which measures an optimisation needs, and how all of them are had for many choices at once."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from laconic.errors import BadInput
from laconic.measures.arguments import ModelMeasure, split, with_arguments
from laconic.measures.measure import Measure
from laconic.measures.registry import measure_named
from laconic.measures.registry import measures_of as measures_of_kind
from laconic.optimise.candidates import Candidates
from laconic.optimise.problem import Constraint, Free, Goal, Problem, measures_of
from laconic.scene.key_path import key_path
from laconic.scene.scene_tables import SceneTables

KIND = "model"


def problem_of(tables: SceneTables, free: Sequence[Free], goals: Sequence[Goal],
               constraints: Sequence[Constraint]) -> tuple[Problem, np.ndarray, list[Measure]]:
    """The problem, the scene's own choice and the measures; BadInput names the option that does not fit."""
    if not free:
        raise BadInput("--free: is missing; give what may be chosen, KEY=a:b, such as vehicle.com_y_m=0:0.05")
    if not goals:
        raise BadInput("--goal: is missing; give min:MEASURE or max:MEASURE; --goals lists the measures")
    names = measures_of(goals, constraints)
    measures = [_measure(name, "--goal" if any(goal.measure == name for goal in goals) else "--subject-to")
                for name in names]
    own = np.array([_own(tables, each) for each in free])
    _check_free(free)
    candidates = Candidates(tables, free)
    for measure in measures:
        _check_needs(measure, candidates)
    measuring = Measuring(candidates, measures)
    problem = Problem(tuple(free), tuple(goals), tuple(constraints), measuring.measured)
    _check_start(measuring, own)
    return problem, own, measures


def listing() -> str:
    """The measures that goals and constraints may name, a line each."""
    lines = []
    for measure in measures_of_kind(KIND).values():
        usage = measure.usage if isinstance(measure, ModelMeasure) else measure.name
        lines += [f"{usage} [{measure.unit or '–'}]", f"    {measure.words}."]
    return "\n".join(lines)


def _measure(text: str, option: str) -> Measure:
    try:
        name, given = split(text)
        return with_arguments(measure_named(name, KIND, option), given)
    except BadInput as why:
        raise BadInput(str(why) if str(why).startswith(option) else f"{option} {why}") from None


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


def _check_free(free: Sequence[Free]) -> None:
    """No number twice, and no angle in both units."""
    seen: dict[str, str] = {}
    for key in (key for each in free for key in each.keys):
        name = key.replace("_deg", "_rad")
        if name in seen:
            raise BadInput(f"--free {key}: is given twice; give it one range")
        seen[name] = key


def _check_needs(measure: Measure, candidates: Candidates) -> None:
    """BadInput where the scene lacks what the measure is about."""
    vehicle = candidates.base.vehicle
    if measure.needs == "friction coefficient" and not (
            vehicle.get("friction_coefficient") or vehicle.get("ground", {}).get("friction_coefficient")):
        raise BadInput(f"{measure.name}: {candidates.base.path} gives no vehicle.friction_coefficient; give one")


def _check_start(measuring: Measuring, own: np.ndarray) -> None:
    """BadInput where a measure has no value for the scene as it is, in the core's words if it refuses the vehicle."""
    values = measuring.measured(own[None])[0]
    for measure, value in zip(measuring.measures, values, strict=True):
        if math.isnan(value):
            raise measuring.refusal(own) or BadInput(
                f"{measure.name}: has no value for {measuring.candidates.base.path} as it is: its wheels cannot "
                "move it that way; give another direction or measure")


class Measuring:
    """All measures of many choices; `measured` is what a Problem asks."""

    def __init__(self, candidates: Candidates, measures: Sequence[Measure]):
        self.candidates, self.measures = candidates, measures

    def measured(self, choices: np.ndarray) -> np.ndarray:
        """(L, M) of choices (L, p); NaN where there is none."""
        prepared = self.candidates.prepared(choices)
        columns: list[Any] = [prepared.measured(measure.of) for measure in self.measures]
        return np.stack(columns, axis=1)

    def refusal(self, choice: np.ndarray) -> BadInput | None:
        """Why a choice makes no vehicle; None where it does."""
        return self.candidates.prepared(choice[None]).refused[0]
