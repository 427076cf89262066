"""Made-up runs of a robot whose parameters are known: are they found, and do the intervals hold them?"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from laconic.core import Core
from laconic.robot.identify.geometry import geometry_of, usual
from laconic.robot.identify.parameter import Parameters, Vehicle
from laconic.robot.identify.rolling_evidence import RollingEvidence
from laconic.robot.identify.solve import Fit, fit
from laconic.robot.identify.steered_evidence import SteeredEvidence
from laconic.robot.identify.steered_evidence import made_up as made_up_steered
from laconic.robot.logs import Log
from laconic.robot.logs.log import Following
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
    core, parameters = scene.core(), geometry_of(scene, usual(scene))
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


KINDS = {"tricycle_agv": ("radius", "wheelbase", "steering-gain", "steering-offset", "place", "heading", "clock-lag"),
         "f1tenth": ("steering-gain", "steering-offset", "steering-lag", "speed-gain", "place", "heading", "clock-lag")}
"""Of each steered scene: what is free."""
STEERED_SAMPLES = 500
SLID = np.array([3e-3, 2e-3, 5e-3])      # of a way of 1 m: ahead, to the left, turn
STEERED_SHARE = 0.3                      # of the prior's standard deviation, by which true values differ
LEAST_LAG_S = 0.05


def steered_trials(count: int, seed: int) -> Iterator[Trial]:
    """Robots with steered wheels in turn: by encoders, and by commands."""
    for number in range(count):
        name = list(KINDS)[number % len(KINDS)]
        yield steered_trial(read_scene(name), name, np.random.default_rng([seed, number]))


def steered_trial(scene: Scene, name: str, random: np.random.Generator, runs: int = 2) -> Trial:
    """One robot with steered wheels."""
    parameters = geometry_of(scene, KINDS[name])
    truth = parameters.values(STEERED_SHARE * random.standard_normal(len(parameters)))
    for index, parameter in enumerate(parameters.each):
        if parameter.group == "steering-lag":
            truth[index] = LEAST_LAG_S + abs(truth[index])
    vehicle = parameters.vehicle(scene.vehicle, truth)
    logs = [steered_run(scene, vehicle, Path(f"/made-up/{number}/run.csv"), random) for number in range(runs)]
    evidence = SteeredEvidence(scene, scene.vehicle, logs)
    begun = evidence.rough(scene.vehicle, parameters)
    evidence.sized(scene.vehicle, parameters, begun)
    return Trial(name, _named(parameters, truth), fit(scene.vehicle, parameters, evidence, begun))


def steered_run(scene: Scene, vehicle: Vehicle, path: Path, random: np.random.Generator) -> Log:
    """A run that steers from leg to leg; by encoders where a hinge has a motor, else by commands; it slips a little."""
    by_encoders = any(hinge.kind == "motor" for hinge in scene.hinges)
    time = PERIOD_S * np.arange(STEERED_SAMPLES + 1)
    steering = np.repeat(random.uniform(-0.4, 0.4, STEERED_SAMPLES // 30 + 1), 30)[:len(time)]
    speed = np.repeat(random.uniform(0.4, 1.2, STEERED_SAMPLES // 90 + 1), 90)[:len(time)]
    if by_encoders:
        steering = np.convolve(np.pad(steering, 10, mode="edge"), np.ones(21) / 21.0, mode="valid")
    like = Log(path, "made up", time, steering_angle_rad=steering[:, None],
               following=Following(is_command=not by_encoders))

    def slid(moved: np.ndarray) -> np.ndarray:
        return moved + np.sqrt(np.abs(moved[:, :1])) * SLID * random.standard_normal(moved.shape)

    driven = [index for index, wheel in enumerate(scene.vehicle["wheel"]) if wheel.get("driven", True)]
    log = made_up_steered(scene, vehicle, like, time, steering, speed, driven if by_encoders else (), slid)
    assert log.pose is not None
    noise = np.array([CAMERA_M, CAMERA_M, CAMERA_RAD]) * random.standard_normal(log.pose.shape)
    return replace(log, path=path, pose=log.pose + noise)
