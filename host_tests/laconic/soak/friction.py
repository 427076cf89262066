"""The friction solver: cold random and hard steps against the oracle, and driven motions with warm starts.

Passed, for cold and driven steps: accepted ones agree with the oracle in each speed and have the residual promised, no
step brings energy or numbers that are not finite, and few are refused, cold ones in single, too. Hard steps have
inertias over twelve decades: an accepted one has the same residual, and agrees in the norm that a residual bounds, the
energy's; how many are refused is only told, as no vehicle is like that. What fails is written to build/friction, one
small file each.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import count as numbers
from typing import Any

import numpy as np

from laconic.paths import results_dir
from laconic.soak import StoppedEarly
from laconic.soak._turns import in_turns
from laconic.verification.friction.agreement import Count, compare, energy_difference
from laconic.verification.friction.core_solver import solve_in_core
from laconic.verification.friction.driven import drive
from laconic.verification.friction.hard import KINDS, hard_problem
from laconic.verification.friction.vehicles import random_problem, random_vehicle

STEPS = 200                 # of one driven vehicle
MOST_COLD_REFUSED = 1e-2
MOST_WARM_REFUSED = 1e-3
MOST_FILES = 50


def soak(minutes: float, seed: int, advance: Callable[[float], None]) -> dict[str, Any]:
    """Two fifths of the time for each of cold and driven steps, one for hard ones."""
    counts = {"cold": Count(), "hard": Count(), "warm": Count()}
    single = Count()
    parts = {"cold": _cold(seed, counts["cold"], single), "hard": _hard(seed, counts["hard"]),
             "warm": _warm(seed, counts["warm"])}
    try:
        in_turns(parts, {"cold": 0.4, "hard": 0.2, "warm": 0.4}, 60.0 * minutes, advance)
    except KeyboardInterrupt as stopped:
        raise StoppedEarly(_result(counts, single)) from stopped
    return _result(counts, single)


def _result(counts: dict[str, Count], single: Count) -> dict[str, Any]:
    wrong = [text for count in counts.values() for text, _ in count.bad if "refused" not in text]
    few = all(each.may_refuse(MOST_COLD_REFUSED) for each in (counts["cold"], single))
    passed = not wrong and few and counts["warm"].may_refuse(MOST_WARM_REFUSED)
    texts = {name: text for label, count in counts.items() for name, text in count.texts(label).items()}
    texts["cold, single: refused"] = single.share_refused()
    return {"passed": passed, **texts, "wrong": wrong[:MOST_FILES], "files": _save(counts)}


def _save(counts: dict[str, Count]) -> str:
    folder = results_dir("friction")
    bad = [(label, text, problem) for label, count in counts.items() for text, problem in count.bad][:MOST_FILES]
    if not bad:
        return "none"
    folder.mkdir(exist_ok=True)
    for number, (label, text, problem) in enumerate(bad):
        problem.save(folder / f"{label}-{number}.json", what=text)
    return f"{len(bad)} in {folder}"


def _cold(seed: int, count: Count, single: Count) -> Iterator[None]:
    for number in numbers():
        random = np.random.default_rng([seed, number])
        problem = random_problem(random, random_vehicle(random))
        compare(problem, count)
        single.refuse_or_take(problem, solve_in_core(problem, "single"))
        yield


def _hard(seed: int, count: Count) -> Iterator[None]:
    for number in numbers():
        kind = KINDS[number % len(KINDS)]
        problem = hard_problem(kind, np.random.default_rng([seed, number]))
        compare(problem, count, kind, energy_difference)
        yield


def _warm(seed: int, count: Count) -> Iterator[None]:
    for number in numbers():
        drive([seed, number], STEPS, count)
        yield
