"""Made-up runs of a robot whose parameters are known: are they found, and do the intervals hold them?"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from laconic.core import Core
from laconic.robot.identify.geometry import USUAL, geometry_of
from laconic.robot.identify.parameter import Parameters, Vehicle
from laconic.robot.identify.rolling_evidence import RollingEvidence
from laconic.robot.identify.solve import Fit, fit
from laconic.robot.logs import Log
from laconic.robot.replay.rolling import path_of, rotations_of
from laconic.scene import Scene, read_scene

ROBOTS = ("optiodom_diff", "optiodom_omni3", "robotino2", "optiodom_omni4")
PERIOD_S = 0.05
SAMPLES = 600
LEGS = 10                    # of a run, each with a velocity of its own
SPEED_M_PER_S, YAW_RAD_PER_S = 0.3, 0.8
SLIP_RAD = 0.02              # of a wheel, for one radian of rotation: standard deviation, which grows with the root
CAMERA_M, CAMERA_RAD = 3e-4, 1e-3
TICK_RAD = 2e-3              # resolution of the encoders
TRUTH_SHARE = 1.0            # of the prior's standard deviation, by which true values differ from the nominal ones
RUNS = 6


@dataclass(frozen=True)
class Trial:
    """What was put in and what was found."""

    robot: str
    truth: dict[str, float]
    found: Fit

    def held(self) -> list[bool]:
        """For each parameter that was told: whether its interval holds the truth."""
        return [abs(value - self.truth[p.name]) <= half for p, value, half in
                zip(self.found.parameters.each, self.found.values, self.found.half_widths, strict=True)]


def trials(count: int, seed: int, robots: Sequence[str] = ROBOTS, runs: int = RUNS) -> Iterator[Trial]:
    """Robots in turn, each time with other true values, runs and noise."""
    for number in range(count):
        name = robots[number % len(robots)]
        yield trial(read_scene(name), name, np.random.default_rng([seed, number]), runs)


def trial(scene: Scene, name: str, random: np.random.Generator, runs: int = RUNS) -> Trial:
    """One robot, its runs, and what is found from them."""
    core, parameters = scene.core(), geometry_of(scene, USUAL)
    truth = parameters.values(TRUTH_SHARE * random.standard_normal(len(parameters)))
    vehicle = parameters.vehicle(scene.vehicle, truth)
    logs = [made_up(core, vehicle, Path(f"/made-up/{number}/run.csv"), random) for number in range(runs)]
    found = fit(scene.vehicle, parameters, RollingEvidence(core, scene.path, logs))
    return Trial(name, _named(parameters, truth), found)


def _named(parameters: Parameters, values: np.ndarray) -> dict[str, float]:
    return {p.name: float(value) for p, value in zip(parameters.each, values, strict=True)}


def made_up(core: Core, vehicle: Vehicle, path: Path, random: np.random.Generator) -> Log:
    """A run with velocities that change from leg to leg; slip, quantised encoders, a camera with noise."""
    moved = PERIOD_S * np.repeat(_legs(core, vehicle, random), SAMPLES // LEGS, axis=0)
    true = path_of(moved, np.zeros(3))
    rotation = rotations_of(core, vehicle, moved)
    slipped = rotation + SLIP_RAD * np.sqrt(np.abs(rotation)) * random.standard_normal(rotation.shape)
    angle = np.vstack([np.zeros(rotation.shape[1]), np.cumsum(slipped, axis=0)])
    seen = true + np.array([CAMERA_M, CAMERA_M, CAMERA_RAD]) * random.standard_normal(true.shape)
    return Log(path, "made up", PERIOD_S * np.arange(len(true)), wheel_angle_rad=TICK_RAD * np.round(angle / TICK_RAD),
               pose=seen)


def _legs(core: Core, vehicle: Vehicle, random: np.random.Generator) -> np.ndarray:
    """Velocities of the body's origin that the wheels allow."""
    legs = random.uniform(-1.0, 1.0, (LEGS, 3)) * np.array([SPEED_M_PER_S, SPEED_M_PER_S, YAW_RAD_PER_S])
    if len(core.matrices(core.vehicle(vehicle)).constraint_rows):
        legs[:, 1] = 0.0  # the scenes with fixed wheels here have their axles through the origin
    return legs
