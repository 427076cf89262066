"""What recorded runs with a true pose say about a steered vehicle: rolling without slip, or on ground with friction.

What counts is the motion of each stretch of about a second, from where the recorded path had got to. A whole path goes
around in circles with its robot, so that its distance from the recorded one has many least values, and the errors of
all its stretches are in it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from laconic.robot.identify.parameter import Parameters, Vehicle
from laconic.robot.identify.resolution import floor_of_all
from laconic.robot.identify.rolling_evidence import RollingEvidence, path_residual, stretch_errors, stretch_scores
from laconic.robot.logs import Log
from laconic.robot.replay.measures import path_length
from laconic.robot.replay.rolling import path_of
from laconic.robot.replay.steered_rolling import SteeredRolling
from laconic.robot.replay.steered_signals import Fitted, of_log, seen_by_tracker
from laconic.robot.replay.steered_slip import SteeredSlip
from laconic.scene import Scene
from laconic.scene.ground import slips

STRETCH_S = 1.0       # long enough that the noise of poses is small in it
ROBUST = 0.1          # m or rad: an error of a stretch beyond which it counts less in the rough fit
WEAK_PRIOR = 0.02     # of the rough fit
SMALL = 2e-3          # of z: the core's contact forces are exact to far less
USUAL = 1.4826        # standard deviation over the median of sizes
LEAST_SIZE = 1e-6
SAMPLES, PERIOD_S = 400, 0.05
LAGS, INSIDE = ("steering-lag", "speed-lag"), 0.5   # a lag of 0 is a bound, and that is no place to begin


class SteeredEvidence(RollingEvidence):
    """Runs of one vehicle, for `solve.fit`: what the motion of each stretch is off by, ahead, to the left, in turn, in
    units of the usual error of each. With `whole`, the distance of whole paths instead, begun from what the stretches
    say: an audit explains that error."""

    by_wheels = False
    has_noise = False

    def __init__(self, scene: Scene, base: Vehicle, logs: Sequence[Log], sizes: np.ndarray | None = None,
                 whole: bool = False):
        super().__init__(scene.core(), scene.path, logs)
        self.stretches = [replace(run, cuts=_cuts(log)) for run, log in zip(self.runs, logs, strict=True)]
        self.counts_stretches = not whole
        self.difference = SMALL if slips(base) else 0.0
        if self.counts_stretches:
            self.runs, self.sessions = self.stretches, [f"{log.path} {log.part}" for log in logs]
            self.directions = 3 * sum(len(run.cuts) - 1 for run in self.runs) / len(self.runs)
        self.sizes = np.ones(3) if sizes is None else sizes
        self._scene, self._logs = scene, list(logs)
        if whole:
            self.floor = floor_of_all(self._kind(base)(replace(scene, vehicle=base)).path, logs, self.runs)

    @staticmethod
    def _kind(vehicle: Vehicle) -> type[SteeredRolling]:
        return SteeredSlip if slips(vehicle) else SteeredRolling

    def paths(self, vehicle: Vehicle) -> list[np.ndarray]:
        """Predicted, as the tracker sees them."""
        rolling = self._kind(vehicle)(replace(self._scene, vehicle=vehicle))
        return [rolling.path(log) for log in self._logs]

    def errors(self, vehicle: Vehicle) -> list[np.ndarray]:
        """Of each stretch of each run."""
        return [stretch_errors(run, path) for run, path in zip(self.runs, self.paths(vehicle), strict=True)]

    def residuals(self, vehicle: Vehicle) -> list[np.ndarray]:
        """In units of their usual sizes; of whole paths, over their length."""
        if not self.counts_stretches:
            return [path_residual(run, path) for run, path in zip(self.runs, self.paths(vehicle), strict=True)]
        return [(each / self.sizes).ravel() for each in self.errors(vehicle)]

    def scores(self, vehicle: Vehicle, jacobians: list[np.ndarray]) -> list[np.ndarray]:
        """Of each stretch."""
        if not self.counts_stretches:
            return [stretch_scores(run, path, jacobian.reshape(len(run.taken), 2, -1))
                    for run, path, jacobian in zip(self.runs, self.paths(vehicle), jacobians, strict=True)]
        return [np.einsum("sc,scp->sp", each / self.sizes, jacobian.reshape(*each.shape, -1))
                for each, jacobian in zip(self.errors(vehicle), jacobians, strict=True)]

    def rough(self, base: Vehicle, parameters: Parameters) -> dict[str, float]:
        """Values near the solution."""
        def vehicle(z: np.ndarray) -> Vehicle:
            return parameters.vehicle(base, parameters.values(z))

        def residual(z: np.ndarray) -> np.ndarray:
            off = (stretch_errors(run, path) for run, path in zip(self.stretches, self.paths(vehicle(z)), strict=True))
            return np.concatenate([*(each.ravel() for each in off), WEAK_PRIOR * z])

        start = np.array([INSIDE if p.group in LAGS else 0.0 for p in parameters.each])
        if len(parameters):
            start = least_squares(residual, start, loss="soft_l1", f_scale=ROBUST, ftol=1e-3, xtol=1e-3, max_nfev=30,
                                  diff_step=1e-3 if self.difference else None, x_scale=1.0).x
        return dict(zip((p.name for p in parameters.each), parameters.values(start).tolist(), strict=True))

    def sized(self, base: Vehicle, parameters: Parameters, values: Mapping[str, float]) -> None:
        """Takes the usual sizes from what these values leave."""
        given = np.array([values.get(p.name, p.nominal) for p in parameters.each])
        self.sizes = sizes_of(self.errors(parameters.vehicle(base, given)))


def sizes_of(errors: Sequence[np.ndarray]) -> np.ndarray:
    """The usual size of each component, which few large ones hardly change."""
    found: np.ndarray = np.maximum(USUAL * np.median(np.abs(np.concatenate(list(errors))), axis=0), LEAST_SIZE)
    return found


def _cuts(log: Log) -> np.ndarray:
    """Recorded samples about STRETCH_S apart."""
    seen = log.seen
    count = max(1, round(float(log.time_s[seen[-1]] - log.time_s[seen[0]]) / STRETCH_S))
    wanted = np.linspace(log.time_s[seen[0]], log.time_s[seen[-1]], count + 1)
    found: np.ndarray = np.unique(seen[np.searchsorted(log.time_s[seen], wanted - 1e-9)])
    return found


def made_up(scene: Scene, vehicle: Vehicle, like: Log, time_s: np.ndarray, steering_rad: np.ndarray,
            speed_m_per_s: np.ndarray, measured: Sequence[int] = (),
            slid: Callable[[np.ndarray], np.ndarray] = lambda moved: moved) -> Log:
    """A run of a vehicle that rolls without slip: the log's columns are given, its wheels and poses follow.

    `steering_rad`: as the log has it; `speed_m_per_s`: of the middle of the fixed axle; `measured`: the wheels whose
    turning the log has instead of that speed; `slid`: what becomes of the motion that the wheels roll.
    """
    steering = np.broadcast_to(steering_rad[:, None], (len(time_s), _width(like)))
    log = replace(like, path=Path("motion"), time_s=time_s, steering_angle_rad=steering.copy(), pose_rows=None,
                  speed_m_per_s=speed_m_per_s, wheel_angle_rad=None, wheel_speed_rad_per_s=None, pose=None, moved=None,
                  current_A=None, voltage_V=None, set_speed_rad_per_s=None, counter=None, remarks=(), part="")
    own = of_log(vehicle)
    at_once = Fitted(vehicle, replace(own, clock_lag_s=0.0) if len(measured) else own)  # encoders are of one clock
    rolling = SteeredRolling(replace(scene, vehicle=at_once))
    run = rolling.driven(log)
    moved = rolling.moved(log, run)
    path = path_of(slid(moved), np.zeros(3))
    if len(measured):
        angles = rolling.rotations(log, run, moved)
        at = np.searchsorted(run.time_s, time_s - 1e-9)
        summed = np.vstack([np.zeros(angles.shape[1]), np.cumsum(angles, axis=0)])[at]
        summed[:, [i for i in range(angles.shape[1]) if i not in measured]] = np.nan
        log = replace(log, wheel_angle_rad=summed, speed_m_per_s=None)
    place = (0.0, 0.0) if isinstance(like.pose_point, str) else like.pose_point
    return replace(log, pose=seen_by_tracker(path, run.time_s, log, place, own))


def _width(log: Log) -> int:
    return 1 if log.steering_angle_rad is None else log.steering_angle_rad.shape[1]


def motions(scene: Scene, vehicle: Vehicle, runs: Sequence[Log]) -> dict[str, Log]:
    """Runs of the kind that was recorded which another recording could be, by their names."""
    log = max(runs, key=lambda each: len(each.time_s))
    steering = log.needs("steering_angle_rad", "identify")
    if not steering.shape[1]:  # nothing steers, so that no angle says how it turns
        return {}
    reach = float(np.abs(steering).max(initial=0.0)) or 0.3
    speed = max(float(path_length(each.time_s, each.pose) / each.time_s[-1]) for each in runs if each.pose is not None)
    time = PERIOD_S * np.arange(SAMPLES + 1)
    measured = [] if log.wheel_angle_rad is None and log.wheel_speed_rad_per_s is None else [
        int(index) for index in np.flatnonzero(~np.isnan(log.rotation_rad()).any(axis=0))]
    weave = reach * np.sin(2.0 * np.pi * time / 4.0)
    kinds: Mapping[str, tuple[Any, float]] = {
        "straight ahead": (0.0, speed), "a circle to the left": (reach, speed),
        "a circle to the right": (-reach, speed),
        "turns to both sides": (weave, speed), "turns to both sides in reverse": (weave, -speed),
        "a circle at twice the speed": (reach, 2.0 * speed)}
    found = {}
    for name, (angle, pace) in kinds.items():
        ramp = np.minimum(1.0, time / 2.0) if measured else 1.0
        found[name] = made_up(scene, vehicle, log, time, angle + np.zeros(len(time)), pace * ramp + np.zeros(len(time)),
                              measured)
    return found
