"""Error against run time: every method, several steps, against the independent reference."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np

from laconic.core.plant import Plant
from laconic.errors import Refused
from laconic.scene import METHODS, Scene
from laconic.scene.inputs import InputsOnGrid
from laconic.simulation import advance_plant
from laconic.tools.verify.reference import reference_states
from laconic.tools.verify.trajectories import error_of

FACTORS = (1, 2, 5, 10, 20, 50, 100)  # of the scene's step
COMPARED_EVERY = 100  # steps of the scene between two states that are compared
REPETITIONS = 5
TIMED_STEPS = 5000
KINDS = (slice(0, 3), slice(3, 6), slice(6, None))  # ν, pose, wheel angles in a row of states


@dataclass(frozen=True)
class Point:
    """One run; a refused one has the refusal instead of numbers."""

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
        errors = (self.error_nu, self.error_pose, self.error_wheel)
        return max((error for error in errors if error is not None), default=None)


@dataclass(frozen=True)
class Target:
    """States (ν, x, y, θ, χ) of the reference at some instants, and their own error (floor)."""

    ticks: np.ndarray
    states: np.ndarray
    floor: float

    def error(self, found: np.ndarray, part: slice) -> float:
        """Largest error over max(1, largest value)."""
        return error_of(found[:, part], self.states[:, part])


def target_of(scene: Scene) -> Target:
    """The reference every 100 steps of the scene and at its end; its floor is the change under another tolerance."""
    steps = scene.steps()
    ticks = np.unique([*range(0, steps, COMPARED_EVERY), steps])
    instants = ticks * scene.run.step_s
    states = reference_states(scene, instants, rtol=1e-13, atol=1e-14)
    looser = reference_states(scene, instants)
    target = Target(ticks, states, 0.0)
    return Target(ticks, states, max(1e-16, *(target.error(looser, part) for part in KINDS)))


def usable_factors(scene: Scene) -> list[int]:
    """Multiples of the scene's step that keep every change of the inputs and every compared state on a step."""
    inputs = scene.inputs_on_grid()
    marks = [COMPARED_EVERY, scene.steps(), *inputs.changes]
    return [factor for factor in FACTORS if all(mark % factor == 0 for mark in marks)]


def measure(scene: Scene, target: Target, method: str, factor: int) -> tuple[Point, Scene, InputsOnGrid]:
    """One method with one step: errors, and what is needed to time it."""
    coarse = scene.with_run(method=method, step_s=scene.run.step_s * factor)
    inputs = InputsOnGrid.on_grid(scene.path, scene.inputs, coarse.run.step_s, scene.steps() // factor)
    try:
        states, chosen = states_at(coarse, inputs, target.ticks // factor)
    except Refused as refused:
        return Point(method, method, coarse.run.step_s, refusal=refused.status), coarse, inputs
    nu, pose, wheel = (target.error(states, part) for part in KINDS)
    return Point(method, chosen, coarse.run.step_s, nu, pose, wheel), coarse, inputs


def states_at(scene: Scene, inputs: InputsOnGrid, ticks: np.ndarray) -> tuple[np.ndarray, str]:
    """States after so many steps, and the method that was used."""
    plant = scene.plant(scene.core())
    states = np.empty((len(ticks), 6 + 2 * scene.wheel_count))
    for row, tick in enumerate(ticks):
        advance_plant(plant, inputs, plant.steps, int(tick) - plant.steps)
        states[row] = plant.row()
    return without_speeds(states, scene.wheel_count), plant.chosen_method


def without_speeds(rows: np.ndarray, wheel_count: int) -> np.ndarray:
    """ν, pose, wheel angles of rows that have the wheel speeds between."""
    return np.delete(rows, np.s_[6 : 6 + wheel_count], axis=1)


class Stopwatch:
    """Seconds per step of the core's loop: the least time of a run, less the least time of its calls with 0 steps."""

    def __init__(self, scene: Scene, inputs: InputsOnGrid):
        self.scene, self.inputs = scene, inputs
        self.cycles = -(-TIMED_STEPS // inputs.steps)  # a short run is continued from its end, so many times
        self.run_s = self.empty_s = float("inf")

    def measure(self) -> None:
        """Times one more run."""
        plant = self.scene.plant(self.scene.core())
        if not self.inputs.is_held:
            began, self.cycles, self.empty_s = time.thread_time(), 1, 0.0
            advance_plant(plant, self.inputs, 0, self.inputs.steps)
            self.run_s = min(self.run_s, time.thread_time() - began)
            return
        stretches = [(plant.core.input(plant.core.input_row(each.values)), each.steps)
                     for each in self.inputs.segments()]
        try:
            self.run_s = min(self.run_s, call_time(plant, self.cycles * stretches))
        except Refused:  # continuing leads to states where the step is too large
            self.cycles, self.run_s = 1, float("inf")
            self.run_s = call_time(self.scene.plant(self.scene.core()), stretches)
        bare = self.cycles * [(held, 0) for held, _ in stretches]
        self.empty_s = min(self.empty_s, call_time(plant, bare))

    @property
    def step_s(self) -> float:
        """Seconds per step."""
        return (self.run_s - self.empty_s) / (self.cycles * self.inputs.steps)


def call_time(plant: Plant, stretches: Sequence[tuple[Any, int]]) -> float:
    """Seconds of some calls of the core's loop."""
    began = time.thread_time()
    for held, steps in stretches:
        plant.run(held, steps)
    return time.thread_time() - began


def measure_all(scene: Scene, target: Target) -> list[Point]:
    """Every method with every usable step; timed alternately, so that other work of the machine affects all alike."""
    points, watches = [], []
    for method, factor in product(METHODS, usable_factors(scene)):
        point, coarse, inputs = measure(scene, target, method, factor)
        points.append(point)
        watches.append(None if point.refusal else Stopwatch(coarse, inputs))
    for _, watch in product(range(REPETITIONS), watches):
        if watch:
            watch.measure()
    return [point if watch is None else
            replace(point, ns_per_step=1e9 * watch.step_s, us_per_s=1e6 * watch.step_s / point.step_s)
            for point, watch in zip(points, watches, strict=True)]
