"""The friction solver: cold random and hard steps against the oracle, and driven motions with warm starts.

Passed, for cold and driven steps: accepted ones agree with the oracle in each speed and have the residual promised, no
step brings energy or numbers that are not finite, and few are refused. Hard steps have inertias over twelve decades: an
accepted one has the same residual, and agrees in the norm that a residual bounds, the energy's; how many are refused is
only told, as no vehicle is like that. What fails is written to build/friction, one small file each.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from itertools import count as numbers
from typing import Any

import numpy as np

from laconic.paths import build_dir
from laconic.soak import StoppedEarly
from laconic.verification.friction.agreement import ENERGY_LIMIT, Count, compare, energy_difference
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
    parts = {"cold": _cold(seed, counts["cold"]), "hard": _hard(seed, counts["hard"]),
             "warm": _warm(seed, counts["warm"])}
    try:
        _run(parts, {"cold": 0.4, "hard": 0.2, "warm": 0.4}, 60.0 * minutes, advance)
    except KeyboardInterrupt as stopped:
        raise StoppedEarly(_result(counts)) from stopped
    return _result(counts)


def _run(parts: dict[str, Iterator[None]], share: dict[str, float], time_s: float,
         advance: Callable[[float], None]) -> None:
    """Takes the part that is furthest behind its share of the time, one item after the other."""
    spent = dict.fromkeys(parts, 0.0)
    while sum(spent.values()) < time_s:
        name = min(parts, key=lambda part: spent[part] / share[part])
        began = time.monotonic()
        next(parts[name])
        took = time.monotonic() - began
        spent[name] += took
        advance(took)


def _result(counts: dict[str, Count]) -> dict[str, Any]:
    wrong = [text for count in counts.values() for text, _ in count.bad if "refused" not in text]
    passed = not wrong and counts["cold"].may_refuse(MOST_COLD_REFUSED) and counts["warm"].may_refuse(MOST_WARM_REFUSED)
    texts = {name: text for label, count in counts.items() for name, text in count.texts(label).items()}
    return {"passed": passed, **texts, "wrong": wrong[:MOST_FILES], "files": _save(counts)}


def _save(counts: dict[str, Count]) -> str:
    folder = build_dir() / "friction"
    bad = [(label, text, problem) for label, count in counts.items() for text, problem in count.bad][:MOST_FILES]
    if not bad:
        return "none"
    folder.mkdir(exist_ok=True)
    for number, (label, text, problem) in enumerate(bad):
        problem.save(folder / f"{label}-{number}.json", what=text)
    return f"{len(bad)} in {folder}"


def _cold(seed: int, count: Count) -> Iterator[None]:
    for number in numbers():
        random = np.random.default_rng([seed, number])
        compare(random_problem(random, random_vehicle(random)), count)
        yield


def _hard(seed: int, count: Count) -> Iterator[None]:
    for number in numbers():
        kind = KINDS[number % len(KINDS)]
        problem = hard_problem(kind, np.random.default_rng([seed, number]))
        compare(problem, count, kind, energy_difference, ENERGY_LIMIT)
        yield


def _warm(seed: int, count: Count) -> Iterator[None]:
    for number in numbers():
        drive([seed, number], STEPS, count)
        yield
