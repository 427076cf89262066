"""Long runs of the core's optional parts: derivatives of steps, and the soft addition."""

from __future__ import annotations

import subprocess
from collections import defaultdict
from pathlib import Path

import numpy as np

from assurance.common import ROOT, Clock, called, work
from laconic.core.binding import load
from laconic.tools.verify.exact.trials import by_each, difference, directions, error, tangent, trials
from references.derivatives.c_table import adjoint_error

# ---- Tangents of steps of each method against differences of the method's map in 50 digits, adjoints against
# Jacobians and tangents: made-up vehicles of eight kinds, slow and stiff, with world forces and slopes.

LARGEST, TRANSPOSED = 1e-11, 1e-14  # error of a tangent, of an adjoint


def run_derivatives(clock: Clock, seed: int) -> list[str]:
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


# ---- The core's soft addition beside the addition of this machine's processor, on pairs of which half are any bits,
# the others those that rounding is sensitive to.

SOFT_DOUBLE = ROOT / "core_c/optional/soft_double"
PAIRS = 5_000_000  # between two looks at the clock


def run_soft_double(clock: Clock, seed: int) -> list[str]:
    """Pairs with new seeds."""
    program, done = work("long") / "soft_double", 0
    called(["gcc", "-std=c99", "-O2", "-ffp-contract=off", f"-I{SOFT_DOUBLE}",
            Path(__file__).with_name("soft_double.c"), SOFT_DOUBLE / "soft_double.c", "-o", program])
    while done == 0 or clock:
        ran = subprocess.run([program, str(seed), str(PAIRS)], capture_output=True, text=True, check=False)
        if ran.returncode != 0:
            return [ran.stdout.strip() or f"stopped with status {ran.returncode}"]
        done, seed = done + PAIRS, seed + 1
    print(f"  {done} pairs")
    return []
