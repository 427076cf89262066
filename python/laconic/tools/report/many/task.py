"""What every contestant steps: vehicles of one kind, their voltages held over a run of many steps, and its equations as
plain numbers for those who write them anew.

The step is the classical Runge-Kutta step of ν, x, y, heading and wheel angles. What is the same for all steps of a run
is computed once, for every contestant: b from the voltages, and wheel angles from ∫ν dt at the end.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from laconic.batch import Batch
from laconic.core import Vehicle
from laconic.scene import Scene
from laconic.scene.methods import EXPLICIT
from laconic.tools.verify.reference import Reference

Runner = tuple[Callable[[], None], Callable[[], np.ndarray]]
"""A run of all vehicles over all steps, each from where the last ended; and their states, (numbers, lanes)."""

AGREEMENT = {"double": 1e-12, "single": 2e-5}
"""Largest difference to the core after one run, over the largest number of its kind."""


@dataclass(frozen=True)
class Task:
    """A scene's vehicle, how many of it, and how many steps a run has."""

    scene: Scene
    lanes: int
    steps: int
    step_s: float

    @property
    def voltages_V(self) -> np.ndarray:  # noqa: N802
        """(N, lanes): no two vehicles alike."""
        spread = np.linspace(0.2, 1.0, self.lanes)
        signs = np.array([(-1.0) ** wheel * (1.0 - 0.2 * wheel) for wheel in range(self.scene.wheel_count)])
        return 6.0 * signs[:, None] * spread + np.linspace(0.0, 1.0, self.lanes)

    @property
    def headings_rad(self) -> np.ndarray:
        """(lanes,): at the start."""
        return np.linspace(-3.0, 3.0, self.lanes)


@dataclass(frozen=True)
class Equations:
    """ν' = yaw(ν) − damping ν + b, b = forcing U, and the rates of pose and wheels; numbers of one scalar type."""

    turning: np.ndarray   # (3, 2): times ν3·(ν2, −ν1)
    damping: np.ndarray   # (3, 3)
    forcing: np.ndarray   # (3, N)
    wheels: np.ndarray    # (N, 3): χ' = wheels ν
    radius_m: Any
    yaw_scale: Any        # θ' = ν3/yaw_scale
    step_s: Any


def equations_of(task: Task, dtype: Any) -> Equations:
    """From the reference, which shares no code with the core."""
    r = Reference(task.scene.vehicle)
    forcing = r.mobility @ r.rows.T * (r.scale * r.totals.gains_Nm_per_V)
    return Equations((r.mobility[:, :2] / r.yaw_scale).astype(dtype), r.damping.astype(dtype), forcing.astype(dtype),
                     r.rows.astype(dtype), dtype(r.totals.wheel_radius_m), dtype(r.yaw_scale), dtype(task.step_s))


def core_batch(task: Task, real: str, width_bytes: int = 0) -> Batch:
    """The core's lanes at their start; width 1 steps vehicle after vehicle by laconic_run()."""
    batch = Batch(Vehicle(task.scene.vehicle, real), task.lanes, EXPLICIT, task.step_s, width_bytes=width_bytes)
    batch.voltage_V = task.voltages_V
    for lane, heading in enumerate(task.headings_rad):
        batch.start(lane, heading_rad=heading)
    return batch


def core_states(task: Task, batch: Batch) -> np.ndarray:
    """(6 + N, lanes): ν, x, y, heading, wheel angles."""
    plant = Vehicle(task.scene.vehicle, batch.core.real).plant(EXPLICIT, task.step_s)
    angles = np.empty((task.scene.wheel_count, task.lanes))
    for lane in range(task.lanes):
        plant.restore(batch.state(lane), 0)
        angles[:, lane] = plant.wheel_angles()
    return np.vstack([batch.nu_rad_per_s, batch.x_m, batch.y_m, batch.heading_rad, angles])


def difference(found: np.ndarray, wanted: np.ndarray) -> float:
    """The largest over all lanes, for each number over the largest of its kind: ν, place, heading, wheel angles."""
    kinds = (slice(0, 3), slice(3, 5), slice(5, 6), slice(6, None))
    return max(float(np.max(np.abs(found[k] - wanted[k])) / np.max(np.abs(wanted[k]))) for k in kinds)
