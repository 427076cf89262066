"""A made-up vehicle with its start and inputs: six kinds of wheels, damping from usual to a million times that."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np

from laconic.core import Core
from laconic.core.plant import Plant
from laconic.verification.derivatives.trials import Trial, held_inputs, made_up, plant_of

Held = dict[str, list[float]]

KINDS = ("omni", "mecanum", "drive", "own", "locked", "mixed")
DECADES = 6                       # of damping
TICK_S = {"double": Fraction(0.01), "single": Fraction(5368710, 2**29)}
"""Ten milliseconds: in both scalar types a number, as is the tenth of it, to the last bit."""
INSTANTS = ((1, 5), (6, 10))      # in ticks, when states are compared; the inputs change after the fifth
END_S = float(INSTANTS[-1][-1] * TICK_S["double"])


@dataclass(frozen=True)
class Made:
    """One of a population: its trial with the first inputs, the second inputs, and how many times damping is usual."""

    number: int
    factor: float
    trial: Trial
    later: Held
    real: str = "double"

    @property
    def helds(self) -> tuple[Held, Held]:
        """The inputs of each stretch."""
        return self.trial.held, self.later

    def plant(self, core: Core, method: str, step_s: float) -> Plant:
        """At its start."""
        trial = self.trial
        return plant_of(core, Trial(trial.kind, method, trial.table, step_s, trial.nu, trial.heading_rad, trial.held))


def cuts_s(real: str) -> list[list[Fraction]]:
    """The instants of each stretch, exactly as steps reach them."""
    return [[tick * TICK_S[real] for tick in ticks] for ticks in INSTANTS]


def as_single(given: Any) -> Any:
    """The same with each number rounded to single precision, so that the true motion is of what the core was given."""
    if isinstance(given, dict):
        return {name: as_single(each) for name, each in given.items()}
    if isinstance(given, list):
        return [as_single(each) for each in given]
    return float(np.float32(given)) if isinstance(given, float) else given


def table_in_single(table: dict[str, Any]) -> dict[str, Any]:
    """A vehicle's table in single precision. Fixed wheels share an axle line along y, whose direction no single number
    has: it is turned to x, or their true constraints would forbid all turning."""
    turned = [{**wheel, "x_m": -wheel["y_m"], "y_m": wheel["x_m"], "axle_rad": 0.0}
              if wheel["axle_rad"] == -np.pi / 2 else wheel for wheel in table["wheel"]]
    rounded: dict[str, Any] = as_single({**table, "wheel": turned})
    return rounded


def made(seed: int, number: int, of: int, real: str = "double") -> Made:
    """The vehicle of this number: damping grows with the number, kinds take turns."""
    if real == "single":
        double = made(seed, number, of)
        trial = double.trial
        return replace(double, real=real, later=as_single(double.later), trial=replace(
            trial, table=table_in_single(trial.table), nu=as_single(trial.nu), heading_rad=as_single(trial.heading_rad),
            held=as_single(trial.held)))
    random = np.random.default_rng([seed, number])
    trial = made_up(random, KINDS[number % len(KINDS)], "auto")
    factor = float(10 ** (DECADES * (number + random.random()) / of))
    trial.table["motor_damping_Nms"] = float(10 ** random.uniform(-2.5, -1.5) * factor)
    for wheel in trial.table["wheel"]:
        if "motor_damping_Nms" in wheel:
            wheel["motor_damping_Nms"] *= factor
    trial.nu[:] = random.normal(0, 10 ** random.uniform(0, 1.3), 3).tolist()
    return Made(number, factor, trial, held_inputs(random, len(trial.table["wheel"]), any(trial.held["world_force_N"])))
