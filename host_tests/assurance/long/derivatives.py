"""Tangents of steps of each method against differences of the method's map in 50 digits, adjoints against Jacobians and
tangents: made-up vehicles of eight kinds, slow and stiff, with world forces and slopes."""

from __future__ import annotations

from collections import defaultdict

import numpy as np

from assurance.common import Clock
from laconic.core.binding import load
from laconic.tools.verify.exact.trials import by_each, difference, directions, error, tangent, trials
from references.derivatives.c_table import adjoint_error

LARGEST, TRANSPOSED = 1e-11, 1e-14  # error of a tangent, of an adjoint


def run(clock: Clock, seed: int) -> list[str]:
    """Steps of all methods in turn."""
    random, worst, wrong, done = np.random.default_rng(seed), defaultdict[str, float](float), list[str](), 0
    for trial, plant in trials(load(), seed=seed):
        found = {f"by {kind}": error(tangent(trial, plant, along), difference(trial, plant, along), along,
                                     by_each(trial, plant, along) if along.vehicle else None)
                 for kind, along in directions(random, trial, plant).items()}
        found["adjoint"] = adjoint_error(random, trial, plant)
        for kind, off in found.items():
            worst[f"{trial.method}: {kind}"] = max(worst[f"{trial.method}: {kind}"], off)
            if not off <= (TRANSPOSED if kind == "adjoint" else LARGEST):
                wrong.append(f"{kind} of step {done}: {off:.1e}, {trial}")
        done += 1
        if not clock:
            break
    print(f"  {done} steps", *(f"  {name} {off:.1e}" for name, off in sorted(worst.items())), sep="\n")
    return wrong
