"""The friction solver: cold, random and hard steps against the oracle, driven motions with warm starts; and whole
vehicles that nothing drives, whose energy must not grow and whose rest must hold.

Accepted cold and driven steps agree with the oracle in each speed and have the residual promised; few are refused. Hard
steps have inertias over twelve decades: an accepted one agrees in the energy's norm, and any may be refused."""

from __future__ import annotations

from collections.abc import Callable
from itertools import count

import numpy as np

from assurance.common import Clock, work
from references.friction.agreement import Count, compare, energy_difference
from references.friction.coasting import Coasted, coast, rest
from references.friction.core_solver import solve_in_core
from references.friction.driven import drive
from references.friction.hard import KINDS, hard_problem
from references.friction.vehicles import random_problem, random_vehicle

STEPS = 200                                              # of one driven vehicle
MOST_COLD_REFUSED, MOST_WARM_REFUSED = 1e-2, 1e-3
PARTS = ("cold", "hard", "warm", "coasting", "at rest")


def run_friction(clock: Clock, seed: int) -> list[str]:
    """A piece of each part in turn until the time is over, one at least."""
    solved, single = {"cold": Count(), "hard": Count(), "warm": Count()}, Count()
    moved = {f"{part}, {real}": Coasted() for part in PARTS[3:] for real in ("double", "single")}
    for number in count():
        cold(seed, number, solved["cold"], single)
        kind = KINDS[number % len(KINDS)]
        compare(hard_problem(kind, np.random.default_rng([seed, number])), solved["hard"], kind, energy_difference)
        drive([seed, number], STEPS, solved["warm"])
        for name, counted in moved.items():
            of: Callable[..., None] = coast if name.startswith("coasting") else rest
            of([seed, number], counted, name.rpartition(" ")[2])
        if not clock:
            break
    for name, counts in solved.items():
        print(*(f"  {label}: {text}" for label, text in counts.texts(name).items()), sep="\n")
    print(*(f"  {name}: {counted.text()}" for name, counted in moved.items()), sep="\n")
    return wrong_of(solved, single) + [line for counted in moved.values() for line in counted.wrong] + [
        f"{name}: {counted.refused} of {counted.steps} steps refused" for name, counted in moved.items()
        if counted.refused > max(1.0, MOST_WARM_REFUSED * counted.steps)]


def cold(seed: int, number: int, counts: Count, single: Count) -> None:
    random = np.random.default_rng([seed, number])
    problem = random_problem(random, random_vehicle(random))
    compare(problem, counts)
    single.refuse_or_take(problem, solve_in_core(problem, "single"))


def wrong_of(solved: dict[str, Count], single: Count) -> list[str]:
    """What the oracle denies, each kept as a file; and too many refusals."""
    found = []
    for name, counts in solved.items():
        for number, (text, problem) in enumerate(counts.bad[:50]):
            if "refused" not in text:
                problem.save(work("friction") / f"{name}-{number}.json", what=text)
                found.append(f"{name}: {text}; kept as {work('friction') / f'{name}-{number}.json'}")
    for name, counts, most in (("cold", solved["cold"], MOST_COLD_REFUSED), ("single", single, MOST_COLD_REFUSED),
                               ("warm", solved["warm"], MOST_WARM_REFUSED)):
        found += [] if counts.may_refuse(most) else [f"{name}: refused {counts.share_refused()}"]
    return found
