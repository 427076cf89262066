"""How much each varied key has to do with a measure, by SALib.

With Saltelli's design Sobol' indices: the share of the measure's variance that a key brings alone (first order) and
with all others (total). Otherwise PAWN from the runs as they are: how far the measure's distribution moves when the key
is held in a tenth of its range (0: not at all, 1: to where it never was), with first-order indices by RBD-FAST.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from laconic.tools.sweep.plan import Plan
from laconic.tools.sweep.points import problem_of

MOST_RUNS = 20000  # from which PAWN and RBD-FAST estimate, drawn evenly
SLICES = 10
FEWEST_RUNS = 100


@dataclass(frozen=True)
class Indices:
    """Of one measure: by key, each with its half interval of 95 %."""

    method: str
    name: str                                     # of the index: "total", "PAWN"
    index: Mapping[str, tuple[float, float]]
    first_order: Mapping[str, tuple[float, float]]


def indices_of(plan: Plan, columns: Mapping[str, np.ndarray], measure: np.ndarray) -> Indices | None:
    """Indices of the keys that are numbers; None where the runs do not tell: too few, or nothing varies."""
    if plan.is_saltelli and np.isfinite(measure).all() and np.ptp(measure) > 0:
        return _sobol(plan, measure)
    keys = [each.key.text for each in plan.varied if columns[each.key.text].dtype.kind == "f"
            and np.ptp(columns[each.key.text]) > 0]
    good = np.flatnonzero(np.isfinite(measure))
    if not keys or len(good) < FEWEST_RUNS or np.ptp(measure[good]) <= 0:
        return None
    few = np.random.default_rng(1).permutation(good)[:MOST_RUNS]  # a grid's order would correlate its keys
    return _as_given(keys, np.column_stack([columns[key][few] for key in keys]), measure[few])


def _sobol(plan: Plan, measure: np.ndarray) -> Indices:
    from SALib.analyze import sobol
    keys = [each.key.text for each in plan.varied]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = sobol.analyze(problem_of(keys), measure, calc_second_order=False, seed=1, num_resamples=100)
    return Indices("Sobol' indices from Saltelli's design", "total", _pairs(keys, found, "ST", "ST_conf"),
                   _pairs(keys, found, "S1", "S1_conf"))


def _as_given(keys: list[str], values: np.ndarray, measure: np.ndarray) -> Indices:
    from SALib.analyze import pawn, rbd_fast
    problem = {"num_vars": len(keys), "names": keys,
               "bounds": [[float(column.min()), float(column.max())] for column in values.T]}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        moved = pawn.analyze(problem, values, measure, S=SLICES, seed=1)
        alone = rbd_fast.analyze(problem, values, measure, num_resamples=50, seed=1)
    return Indices(f"PAWN (median of {SLICES} slices, ± their standard deviation) and first-order indices by RBD-FAST, "
                   f"from {len(measure)} runs as they are", "PAWN", _pairs(keys, moved, "median", "stdev"),
                   _pairs(keys, alone, "S1", "S1_conf"))


def _pairs(keys: list[str], found: Mapping[str, np.ndarray], index: str, half: str) -> dict[str, tuple[float, float]]:
    return {key: (float(value), float(width)) for key, value, width in
            zip(keys, found[index], found[half], strict=True)}
