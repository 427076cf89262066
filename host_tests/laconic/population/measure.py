"""What one vehicle of a population tells: a row for each method and step, beside its true motion."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from laconic.core import load
from laconic.core.estimate import Errors, ErrorSizes
from laconic.core.plant import Plant
from laconic.errors import Refused
from laconic.population.made import INSTANTS, TICK_S, Made
from laconic.population.truth import KINDS, Truth, truth_of

STEPS_S = (0.001, 0.01)

ESTIMATED: dict[str, Callable[[ErrorSizes], float]] = {
    "nu": lambda sizes: sizes.nu_rad_per_s, "pose": lambda sizes: max(sizes.place_m, sizes.heading_rad),
    "wheel": lambda sizes: sizes.wheel_angle_rad}
"""What an estimate has of each kind of a truth."""

Row = dict[str, Any]


def rows_of(vehicle: Made, methods: Sequence[str]) -> list[Row]:
    """The vehicle's rows; a refusal has the status, and no errors."""
    core = load(vehicle.real)
    truth = truth_of(vehicle, vehicle.plant(core, "auto", STEPS_S[0]).nu)
    known = {"number": vehicle.number, "kind": vehicle.trial.kind, "real": vehicle.real, "factor": vehicle.factor,
             "truth": truth.by, "width": truth.width}
    return [known | {"method": method, "step_s": step_s} | measured(vehicle, truth, method, step_s)
            for method in methods for step_s in STEPS_S]


def measured(vehicle: Made, truth: Truth, method: str, step_s: float) -> Row:
    """Errors at all instants of one run."""
    try:
        plant = vehicle.plant(load(vehicle.real), method, float(TICK_S[vehicle.real] / per_tick(step_s)))
        estimate, estimated = plant.estimate(), list[Errors]()
        found = states_of(plant, vehicle, step_s, estimate.run, lambda: estimated.append(estimate.read()))
    except Refused as refused:
        return {"status": refused.status}
    return {"status": "ok", "taken": plant.chosen_method,
            **{f"error_{name}": error for name, error in truth.errors(found).items()},
            **{f"estimate_{name}": max(size(errors.now) for errors in estimated) / truth.size(KINDS[name])
               for name, size in ESTIMATED.items()},
            **{f"rounding_{name}": max(size(errors.rounding) for errors in estimated) / truth.size(KINDS[name])
               for name, size in ESTIMATED.items()}}


def per_tick(step_s: float) -> int:
    """Steps of about this length in a tick."""
    return round(float(TICK_S["double"]) / step_s)


def states_of(plant: Plant, vehicle: Made, step_s: float, run: Callable[..., None] | None = None,
              seen: Callable[[], None] = lambda: None) -> np.ndarray:
    """The core's states at the instants, one row each; `run` steps the plant, `seen` is called at each instant."""
    rows, done, steps = [], 0, per_tick(step_s)
    for held, ticks in zip(vehicle.helds, INSTANTS, strict=True):
        for tick in ticks:
            (run or plant.run)(held, tick * steps - done)
            seen()
            done = tick * steps
            pose = plant.pose
            rows.append([*plant.nu, pose.x_m, pose.y_m, pose.heading_rad, *plant.wheel_angles()])
    return np.array(rows)
