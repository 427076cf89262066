"""Some runs of a plan, one after the other in the order of their index: what a worker does."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np

from laconic.errors import BadInput
from laconic.scene.key_path import key_path
from laconic.scene.scene_tables import SceneTables, Value
from laconic.tools.measures import Course
from laconic.tools.sweep.alone import Refusal, course_alone, run_alone
from laconic.tools.sweep.lanes import Template, measures_in_lanes
from laconic.tools.sweep.numbers import is_number_of_struct, usual
from laconic.tools.sweep.plan import Plan, plan_from

FEWEST_LANES = 4  # of one template; fewer go alone


@dataclass
class Rows:
    """What is known of some runs: measures as (measures, runs), NaN where there is none; why a run has none."""

    measures: np.ndarray
    reasons: dict[int, Refusal] = field(default_factory=dict)  # by the run's place


@lru_cache(2)
def plan_of(digest: str, told: str) -> tuple[Plan, Course | None]:
    """A worker's plan with its nominal run, kept from one chunk to the next."""
    import json
    plan = plan_from(json.loads(told))
    assert plan.digest == digest
    return plan, nominal_course(plan)


def nominal_course(plan: Plan) -> Course | None:
    """The run of the scene as its file is, where a measure looks at it; raises as `simulate`."""
    if not any(measure.is_beside_nominal for measure in plan.measures):
        return None
    return course_alone(plan.tables.scene(), plan.measures)


def run_chunk(plan: Plan, nominal: Course | None, values: Mapping[str, np.ndarray]) -> Rows:
    """Runs with these values of the varied keys."""
    count = len(next(iter(values.values())))
    rows = Rows(np.full((len(plan.measures), count), np.nan))
    left = np.ones(count, bool)
    keys = [each.key for each in plan.varied]
    plain = {key.text: values[key.text].astype(float) for key in keys if is_number_of_struct(key, keys)}
    if plain:
        good = np.logical_and.reduce([usual(key_path(text), column) for text, column in plain.items()])
        others = {text: column for text, column in values.items() if text not in plain}
        for places in _alike(others, np.flatnonzero(good), count):
            if len(places) >= FEWEST_LANES:
                left[places] = ~_side_by_side(plan, nominal, values, plain, places, rows)
    for place in np.flatnonzero(left):
        found = run_alone(plan.tables, of_place(values, place), plan.measures, nominal)
        if isinstance(found, Refusal):
            rows.reasons[int(place)] = found
        else:
            rows.measures[:, place] = found
    return rows


def of_place(values: Mapping[str, np.ndarray], place: Any) -> dict[str, Value]:
    """The values of one run, as Python has them."""
    return {text: column[place].item() if isinstance(column[place], np.generic) else column[place]
            for text, column in values.items()}


def _alike(others: Mapping[str, np.ndarray], places: np.ndarray, count: int) -> Iterator[np.ndarray]:
    """Places of runs whose other keys have the same values."""
    if not others:
        yield places
        return
    group_of = np.zeros(count, np.int64)
    for column in others.values():
        _, number = np.unique(column.astype(str) if column.dtype == object else column, return_inverse=True)
        group_of = np.unique(group_of * (number.max() + 1) + number, return_inverse=True)[1]
    for group in np.unique(group_of[places]):
        yield places[group_of[places] == group]


def _side_by_side(plan: Plan, nominal: Course | None, values: Mapping[str, np.ndarray], plain: Mapping[str, np.ndarray],
                  places: np.ndarray, rows: Rows) -> np.ndarray:
    """Which of the runs at these places were done in a batch; their measures are then in `rows`."""
    try:
        template = template_of(plan.tables, of_place(values, places[0]))
        if not template.fits(plan.measures):
            return np.zeros(len(places), bool)
        found, taken = measures_in_lanes(template, {text: column[places] for text, column in plain.items()},
                                         plan.measures, nominal)
    except BadInput:  # whose words each run gets when it goes alone
        return np.zeros(len(places), bool)
    rows.measures[:, places[taken]] = found[:, taken]
    return taken


def template_of(tables: SceneTables, values: Mapping[str, Value]) -> Template:
    """The scene of the first run of several."""
    changed = tables.with_values(values)
    return Template(changed, changed.scene())
