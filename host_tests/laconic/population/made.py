"""A made-up vehicle with its start and inputs: six kinds of wheels, damping from usual to a million times that."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from laconic.core import Core
from laconic.core.plant import Plant
from laconic.verification.derivatives.trials import Trial, held_inputs, made_up, plant_of

Held = dict[str, list[float]]

KINDS = ("omni", "mecanum", "drive", "own", "locked", "mixed")
DECADES = 6                       # of damping
TICK_S = Fraction(0.01)           # ten steps of 0.001 to the last bit, as doubles are
INSTANTS = ((1, 5), (6, 10))      # in ticks, when states are compared; the inputs change after the fifth
END_S = float(INSTANTS[-1][-1] * TICK_S)


@dataclass(frozen=True)
class Made:
    """One of a population: its trial with the first inputs, the second inputs, and how many times damping is usual."""

    number: int
    factor: float
    trial: Trial
    later: Held

    @property
    def helds(self) -> tuple[Held, Held]:
        """The inputs of each stretch."""
        return self.trial.held, self.later

    def plant(self, core: Core, method: str, step_s: float) -> Plant:
        """At its start."""
        trial = self.trial
        return plant_of(core, Trial(trial.kind, method, trial.table, step_s, trial.nu, trial.heading_rad, trial.held))


def cuts_s() -> list[list[Fraction]]:
    """The instants of each stretch, exactly as steps reach them."""
    return [[tick * TICK_S for tick in ticks] for ticks in INSTANTS]


def made(seed: int, number: int, of: int) -> Made:
    """The vehicle of this number: damping grows with the number, kinds take turns."""
    random = np.random.default_rng([seed, number])
    trial = made_up(random, KINDS[number % len(KINDS)], "auto")
    factor = float(10 ** (DECADES * (number + random.random()) / of))
    trial.table["motor_damping_Nms"] = float(10 ** random.uniform(-2.5, -1.5) * factor)
    for wheel in trial.table["wheel"]:
        if "motor_damping_Nms" in wheel:
            wheel["motor_damping_Nms"] *= factor
    trial.nu[:] = random.normal(0, 10 ** random.uniform(0, 1.3), 3).tolist()
    return Made(number, factor, trial, held_inputs(random, len(trial.table["wheel"]), any(trial.held["world_force_N"])))
