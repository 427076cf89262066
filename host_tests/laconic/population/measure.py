"""What one vehicle of a population tells: a row for each method and step, beside its true motion."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from laconic.core import load
from laconic.core.plant import Plant
from laconic.errors import Refused
from laconic.population.made import INSTANTS, TICK_S, Made
from laconic.population.truth import Truth, truth_of

STEPS_S = (0.001, 0.01)

Row = dict[str, Any]


def rows_of(vehicle: Made, methods: Sequence[str]) -> list[Row]:
    """The vehicle's rows; a refusal has the status, and no errors."""
    core = load("double")
    truth = truth_of(vehicle, vehicle.plant(core, "auto", STEPS_S[0]).nu)
    known = {"number": vehicle.number, "kind": vehicle.trial.kind, "factor": vehicle.factor, "truth": truth.by,
             "width": truth.width}
    return [known | {"method": method, "step_s": step_s} | measured(vehicle, truth, method, step_s)
            for method in methods for step_s in STEPS_S]


def measured(vehicle: Made, truth: Truth, method: str, step_s: float) -> Row:
    """Errors at all instants of one run."""
    try:
        plant = vehicle.plant(load("double"), method, step_s)
        found = states_of(plant, vehicle, step_s)
    except Refused as refused:
        return {"status": refused.status}
    return {"status": "ok", "taken": plant.chosen_method,
            **{f"error_{name}": error for name, error in truth.errors(found).items()}}


def states_of(plant: Plant, vehicle: Made, step_s: float) -> np.ndarray:
    """The core's states at the instants, one row each."""
    rows, done, per_tick = [], 0, round(float(TICK_S) / step_s)
    for held, ticks in zip(vehicle.helds, INSTANTS, strict=True):
        for tick in ticks:
            plant.run(held, tick * per_tick - done)
            done = tick * per_tick
            pose = plant.pose
            rows.append([*plant.nu, pose.x_m, pose.y_m, pose.heading_rad, *plant.wheel_angles()])
    return np.array(rows)
