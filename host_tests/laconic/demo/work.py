"""Error against run time: every method, several steps, against the independent reference."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from laconic.drive import Drive
from laconic.errors import Refused
from laconic.reference import reference_states
from laconic.scene import METHODS, Scene
from laconic.simulation import advance_plant
from laconic.verification import error_of

FACTORS = (1, 2, 5, 10, 20, 50, 100)  # steps, as multiples of the scene's; 100 of them between two looks
LOOK = 100
REPETITIONS = 5
TIMED_STEPS = 5000
KINDS = (slice(0, 3), slice(3, 6), slice(6, None))  # ν, pose, wheel angles in a row of states


@dataclass(frozen=True)
class Point:
    """One run; a refused one has the refusal's words instead of numbers."""

    method: str
    chosen: str
    step_s: float
    error_nu: float | None = None
    error_pose: float | None = None
    error_wheel: float | None = None
    ns_per_step: float | None = None
    us_per_s: float | None = None
    refusal: str = ""

    @property
    def error(self) -> float | None:
        """The largest of the errors of ν, pose and wheel angles."""
        return None if self.error_nu is None else max(self.error_nu, self.error_pose, self.error_wheel)


@dataclass(frozen=True)
class Target:
    """States (ν, x, y, θ, χ) of the reference at some instants, and how far they can be trusted."""

    ticks: np.ndarray
    states: np.ndarray
    floor: float

    def error(self, found: np.ndarray, part: slice) -> float:
        """Largest error over max(1, largest value)."""
        return error_of(found[:, part], self.states[:, part])


def target_of(scene: Scene) -> Target:
    """The reference every 100 steps of the scene and at its end; its floor is what another tolerance changes."""
    steps = scene.steps()
    ticks = np.unique([*range(0, steps, LOOK), steps])
    instants = ticks * scene.run.step_s
    states = reference_states(scene, instants, rtol=1e-13, atol=1e-14)
    looser = reference_states(scene, instants)
    target = Target(ticks, states, 0.0)
    return Target(ticks, states, max(1e-16, *(target.error(looser, part) for part in KINDS)))


def usable_factors(scene: Scene) -> list[int]:
    """Multiples of the scene's step that keep every change of the inputs and every look on a step."""
    drive = scene.drive()
    marks = [LOOK, scene.steps(), *drive.changes]
    return [factor for factor in FACTORS if all(mark % factor == 0 for mark in marks)]


def measure(scene: Scene, target: Target, method: str, factor: int) -> Point:
    """One method with one step: errors, and the least run time of some repetitions."""
    coarse = scene.with_run(method=method, step_s=scene.run.step_s * factor)
    drive = Drive.on_grid(scene.path, scene.inputs, coarse.run.step_s, scene.steps() // factor)
    try:
        states, chosen = states_at(coarse, drive, target.ticks // factor)
        seconds = least_run_time(coarse, drive)
    except Refused as refused:
        return Point(method, method, coarse.run.step_s, refusal=refused.status)
    errors = [target.error(states, part) for part in KINDS]
    return Point(method, chosen, coarse.run.step_s, *errors, 1e9 * seconds,
                 1e6 * seconds / coarse.run.step_s)


def states_at(scene: Scene, drive: Drive, ticks: np.ndarray) -> tuple[np.ndarray, str]:
    """States after so many steps, and the method that worked."""
    plant = scene.plant(scene.core())
    states = np.empty((len(ticks), 6 + 2 * scene.wheel_count))
    for row, tick in enumerate(ticks):
        advance_plant(plant, drive, plant.steps, int(tick) - plant.steps)
        states[row] = plant.row()
    return without_speeds(states, scene.wheel_count), plant.chosen_method


def without_speeds(rows: np.ndarray, wheel_count: int) -> np.ndarray:
    """ν, pose, wheel angles of rows that have the wheel speeds between."""
    return np.delete(rows, np.s_[6 : 6 + wheel_count], axis=1)


def run_time(scene: Scene, drive: Drive, least_steps: int) -> float:
    """Seconds a step of the core's loop costs, everything else made ready before.

    Short runs are stretched to `least_steps` by holding each input longer, so that calling the loop does not count.
    """
    plant = scene.plant(scene.core())
    if not drive.is_held:
        began = time.thread_time()
        advance_plant(plant, drive, 0, drive.steps)
        return (time.thread_time() - began) / drive.steps
    longer = -(-least_steps // drive.steps)
    stretches = [(plant.core.input(plant.core.input_row(each.values)), each.steps * longer)
                 for each in drive.segments()]
    began = time.thread_time()
    for held, steps in stretches:
        plant.run(held, steps)
    return (time.thread_time() - began) / plant.steps


def least_run_time(scene: Scene, drive: Drive) -> float:
    """The least of some repetitions; where a stretched run leaves what the step can follow, of the run as it is."""
    try:
        return min(run_time(scene, drive, TIMED_STEPS) for _ in range(REPETITIONS))
    except Refused:
        return min(run_time(scene, drive, drive.steps) for _ in range(REPETITIONS))


def measure_all(scene: Scene, target: Target) -> list[Point]:
    """Every method with every usable step."""
    return [measure(scene, target, method, factor) for method in METHODS for factor in usable_factors(scene)]
