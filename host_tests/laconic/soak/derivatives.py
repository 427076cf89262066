"""Tangents of a thousand steps of each method against differences of the method's map in 50 digits, adjoints against
Jacobians and tangents: made-up vehicles of eight kinds, slow and stiff, with world forces and slopes."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Callable
from typing import Any

import numpy as np

from laconic.core.binding import load
from laconic.core.plant import Plant
from laconic.verification.derivatives.adjoints import adjoint_error
from laconic.verification.derivatives.trials import (
    METHODS,
    Trial,
    by_each,
    difference,
    directions,
    error,
    tangent,
    trials,
)

STEPS = 1000          # of each method
LARGEST = 1e-11       # error of a tangent
TRANSPOSED = 1e-14    # of an adjoint
MOST_WRONG = 20       # told


def soak(minutes: float, seed: int, advance: Callable[[float], None]) -> dict[str, Any]:
    """So many steps, fewer where the time is over before; passed when no error is above its limit."""
    random = np.random.default_rng(seed)
    worst: defaultdict[str, float] = defaultdict(float)
    wrong: list[str] = []
    begin, done = time.monotonic(), 0
    for trial, plant in trials(load(), seed=seed):
        found = _errors(random, trial, plant)
        for kind, off in found.items():
            worst[f"{trial.method}: {kind}"] = max(worst[f"{trial.method}: {kind}"], off)
            if not off <= (TRANSPOSED if kind == "adjoint" else LARGEST):
                wrong.append(f"{kind} of step {done}: {off:.1e}, {trial}")
        done += 1
        advance(60.0 * minutes / (STEPS * len(METHODS)))
        if done == STEPS * len(METHODS) or time.monotonic() - begin > 60.0 * minutes:
            break
    return {"passed": not wrong, "steps": done, **{name: f"{off:.1e}" for name, off in sorted(worst.items())},
            "wrong": wrong[:MOST_WRONG]}


def _errors(random: np.random.Generator, trial: Trial, plant: Plant) -> dict[str, float]:
    found = {f"by {kind}": error(tangent(trial, plant, along), difference(trial, plant, along), along,
                                 by_each(trial, plant, along) if along.vehicle else None)
             for kind, along in directions(random, trial, plant).items()}
    return {**found, "adjoint": adjoint_error(random, trial, plant)}
