"""Where the wheels' odometry and the true path part, and how much of that is radius, distance, marker, lag or slip.

Parameters are freed one kind after another, and each kind gets the error that it takes away from what was left before.
So a kind's share is what no kind before it explains; the order is from what every robot has to what few have.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from laconic.errors import BadInput
from laconic.robot.identify.geometry import geometry_of
from laconic.robot.identify.rolling_evidence import run_of, stretch_errors
from laconic.robot.identify.study import Study, fitted_scene, identify
from laconic.robot.logs import Log
from laconic.robot.logs.for_vehicle import for_wheels
from laconic.robot.logs.poses import at_times
from laconic.robot.replay.measures import path_length
from laconic.robot.replay.rolled_paths import roll
from laconic.robot.replay.rolling import rolling_of
from laconic.scene import Scene
from laconic.scene.ground import slips

MOST_LAG_S, COARSE_S, FINE_S = 0.4, 0.04, 0.005
WORTH = 0.05            # of the error: a lag that takes away less is noise
LEAST_MOVED = 0.02      # of the largest direction: in others the runs do not tell a gain
DIRECTIONS = ("ahead", "to the left", "turn")


@dataclass(frozen=True)
class Stage:
    """The error once one more kind of parameter is free."""

    name: str
    error: float            # root mean square path error over the runs
    words: str              # the values found


@dataclass(frozen=True)
class Audit:
    """All stages, and what is left."""

    scene: Scene
    logs: list[Log]         # with the lag taken out
    stages: list[Stage]     # the first one is nominal
    study: Study            # the last fit
    lag_s: float | None     # of the true pose behind the wheels; None: not found
    gains: dict[str, float]  # true motion over that of the fitted wheels, in each direction that the runs tell
    spread: np.ndarray      # root mean square of the stretches' errors: ahead, left [m for 1 m], turn [rad for 1 m]

    @property
    def fitted(self) -> Scene:
        """The scene with the values found."""
        return fitted_scene(self.scene, self.study.found)

    def shares(self) -> list[tuple[str, float]]:
        """Of each kind the part of the squared error that it takes away, and what is left."""
        whole = self.stages[0].error ** 2
        if not whole > 0.0:
            return [("left", 0.0)]
        parts = [(after.name, (before.error**2 - after.error**2) / whole)
                 for before, after in zip(self.stages[:-1], self.stages[1:], strict=True)]
        return [*parts, ("left: slip, noise of the pose, what the model lacks", self.stages[-1].error ** 2 / whole)]


def audit(scene: Scene, logs: Sequence[Log], advance: Callable[..., None] = lambda *_, **__: None) -> Audit:
    """BadInput where a log has no true pose, or the scene has friction, for which rolling is no model."""
    if slips(scene.vehicle):
        raise BadInput(f"{scene.path}: has a [ground] with friction; give the scene without it, as an audit compares "
                       "with rolling and names slip as what is left")
    runs = [for_wheels(log, scene.vehicle["wheel"], scene.vehicle.get("wheel_radius_m")) for log in logs]
    for run in runs:
        run.needs("pose", "an audit")
    stages = [Stage("nominal", error_of(scene, runs), "")]
    free: tuple[str, ...] = ()
    study: Study | None = None
    for names in _kinds(scene, runs):
        free = (*(name for name in free if name != "common-radius"), *names)
        study = identify(scene, runs, geometry_of(scene, free))
        advance()
        error = error_of(fitted_scene(scene, study.found), runs)
        if error < stages[-1].error * (1.0 - 1e-9):
            stages.append(Stage(TITLES[names], error, in_words(study, names)))
    assert study is not None
    lag_s, moved = lag_of(fitted_scene(scene, study.found), runs)
    advance()
    if lag_s is not None:
        runs = moved
        study = identify(scene, runs, geometry_of(scene, free))
        stages.append(Stage("time lag", error_of(fitted_scene(scene, study.found), runs), f"{1e3 * lag_s:.0f} ms"))
    gains, spread = leftovers(fitted_scene(scene, study.found), runs)
    advance()
    return Audit(scene, runs, stages, study, lag_s, gains, spread)


TITLES = {("common-radius",): "radius of all wheels", ("radius",): "radius of each wheel", ("distance",):
          "distance of the wheels", ("place", "heading"): "place and heading of the tracker"}


def _kinds(scene: Scene, runs: Sequence[Log]) -> list[tuple[str, ...]]:
    """What is freed, in this order."""
    has_own = any(wheel.get("radius_m") for wheel in scene.vehicle["wheel"])
    kinds: list[tuple[str, ...]] = [] if has_own else [("common-radius",)]
    kinds += [("radius",), ("distance",)]
    if all(run.has_heading and isinstance(run.pose_point, str) for run in runs):
        kinds.append(("place", "heading"))
    return kinds


def stages_expected() -> int:
    """Steps of the progress bar."""
    return len(TITLES) + 2


def error_of(scene: Scene, runs: Sequence[Log]) -> float:
    """Root mean square over the runs."""
    errors = [each.path_error for each in roll(scene, runs).errors if each.path_error is not None]
    if not errors:
        raise BadInput(f"{runs[0].path}: its true path has no length; give runs in which the robot moves")
    return float(np.sqrt(np.mean(np.square(errors))))


def in_words(study: Study, names: Sequence[str]) -> str:
    """The values of some kinds, with half of their intervals."""
    found = study.found
    words = [f"{p.name} {value:.5g} ± {half:.2g}{f' {p.unit}' if p.unit else ''}"
             for p, value, half in zip(found.parameters.each, found.values, found.half_widths, strict=True)
             if p.group in names]
    return ", ".join(words)


def lag_of(scene: Scene, runs: Sequence[Log]) -> tuple[float | None, list[Log]]:
    """(how late the true pose is, the runs with it taken out), or (None, the runs) where no lag is worth a word."""
    def error(lag_s: float) -> float:
        return error_of(scene, [without_lag(run, lag_s) for run in runs])

    shortest = min(float(run.time_s[-1]) for run in runs)
    most = min(MOST_LAG_S, 0.1 * shortest)
    known: dict[float, float] = {}

    def best(candidates: np.ndarray) -> float:
        for each in candidates:
            known.setdefault(round(float(each), 6), error(round(float(each), 6)))
        return min(known, key=lambda lag: known[lag])

    middle = best(np.arange(-most, most + 1e-9, COARSE_S) + 0.0)
    best(np.array([0.0]))
    found = best(middle + np.arange(-COARSE_S, COARSE_S + 1e-9, FINE_S))
    if known[found] > (1.0 - WORTH) * known[0.0] or abs(found) >= most - COARSE_S:
        return None, list(runs)
    return found, [without_lag(run, found) for run in runs]


def without_lag(log: Log, lag_s: float) -> Log:
    """The run with each pose so much earlier, at the rows that have one then."""
    if lag_s == 0.0 or log.pose is None:
        return log
    seen = log.seen
    rows = np.flatnonzero((log.time_s + lag_s >= log.time_s[seen[0]]) & (log.time_s + lag_s <= log.time_s[seen[-1]]))
    if len(rows) < 2:
        return log
    moved = at_times(log.time_s[rows] + lag_s, log.time_s[seen], log.pose[seen])
    parts: dict[str, Any] = {name: value[rows] for name in PER_ROW if (value := getattr(log, name)) is not None}
    return replace(log, time_s=log.time_s[rows] - log.time_s[rows[0]], pose=moved, pose_rows=None, **parts)


PER_ROW = ("set_speed_rad_per_s", "wheel_angle_rad", "wheel_speed_rad_per_s", "current_A", "voltage_V",
           "yaw_rate_rad_per_s", "moved")


def leftovers(scene: Scene, runs: Sequence[Log]) -> tuple[dict[str, float], np.ndarray]:
    """(true over rolled motion in each direction that the runs tell, spread of the stretches' errors for a metre)."""
    rolling = rolling_of(scene.core(), scene.vehicle, scene.path)
    told, true, errors = [], [], []
    for log in runs:
        run = run_of(log)
        path = run.path(rolling.moved(run.rotation_rad, run.point))
        off = stretch_errors(run, path)
        step, heading = np.diff(path[run.cuts], axis=0), path[run.cuts[:-1], 2]
        cos, sin = np.cos(heading), np.sin(heading)
        motion = np.column_stack([cos * step[:, 0] + sin * step[:, 1], cos * step[:, 1] - sin * step[:, 0], step[:, 2]])
        told.append(motion)
        true.append(motion - off)
        errors.append(off / max(path_length(log.time_s, path) / len(off), 1e-9))
    rolled, wanted = np.vstack(told), np.vstack(true)
    gains = {}
    size = np.sqrt((rolled**2).mean(axis=0))
    for index, name in enumerate(DIRECTIONS):
        if size[index] > LEAST_MOVED * size[:2].max() and size[index] > 0.0:
            gains[name] = float((rolled[:, index] * wanted[:, index]).sum() / (rolled[:, index] ** 2).sum())
    return gains, np.sqrt((np.vstack(errors) ** 2).mean(axis=0))
