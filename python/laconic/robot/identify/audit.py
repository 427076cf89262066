"""Where the wheels' odometry and the true path part, and how much of that is radius, distance, tracker, lag or slip.

All causes are found together, as each of them can hide another. Then each one alone goes back to what the scene states:
the error that comes back is its own. The shares are those of the squared errors, so that they add up.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from laconic.errors import BadInput
from laconic.robot.identify.geometry import geometry_of
from laconic.robot.identify.ground import base_of
from laconic.robot.identify.rolling_evidence import run_of, stretch_errors
from laconic.robot.identify.study import Study, fitted_scene, identify
from laconic.robot.logs import Log
from laconic.robot.logs.poses import at_times
from laconic.robot.replay.measures import path_length
from laconic.robot.replay.missed_wraps import fitting
from laconic.robot.replay.rolled_paths import roll
from laconic.robot.replay.rolling import path_of, rolling_of
from laconic.scene import Scene
from laconic.scene.ground import slips

MOST_LAG_S, COARSE_S, FINE_S = 0.5, 0.02, 0.001
WINDOW_S, POINTS = 0.4, 600   # of the motions that are compared, and how many of them in each run
WORTH = 0.05                  # of the difference in motion: a lag that takes away less is noise
LEAST_MOVED = 0.02            # of the largest direction: in others the runs do not tell a gain
STEPS = 3                     # of the progress bar
DIRECTIONS = ("ahead", "to the left", "turn")
RADIUS, DISTANCE, TRACKER, LAG = "radius of the wheels", "distance of the wheels", "place of the tracker", "time lag"
FREE = {RADIUS: ("radius",), DISTANCE: ("distance",), TRACKER: ("place", "heading")}
LEFT = "left: slip, noise of the pose, what the model lacks"


@dataclass(frozen=True)
class Cause:
    """One kind of fault, with its part of the error."""

    name: str
    share: float            # of the squared path error
    alone: float            # path error that this cause makes alone
    words: str              # the values found


@dataclass(frozen=True)
class Audit:
    """The causes, and what is left."""

    scene: Scene
    logs: list[Log]         # with the lag taken out
    nominal: float          # path error, root mean square over the runs
    found: float            # with all causes taken out
    causes: list[Cause]
    study: Study            # the fit of all of them
    lag_s: float | None     # of the true pose behind the wheels; None: not found
    gains: dict[str, float]  # true motion over that of the fitted wheels, in each direction that the runs tell
    spread: np.ndarray      # root mean square of the stretches' errors: ahead, left [m for 1 m], turn [rad for 1 m]

    @property
    def fitted(self) -> Scene:
        """The scene with the values found."""
        return fitted_scene(self.scene, self.study.found)

    @property
    def left(self) -> float:
        """The part of the squared error that no cause explains."""
        return min(1.0, (self.found / self.nominal) ** 2) if self.nominal > 0.0 else 1.0


def audit(scene: Scene, logs: Sequence[Log], advance: Callable[..., None] = lambda *_, **__: None) -> Audit:
    """BadInput where a log has no true pose, or the scene has friction, for which rolling is no model."""
    if slips(scene.vehicle):
        raise BadInput(f"{scene.path}: has a [ground] with friction; give the scene without it, as an audit compares "
                       "with rolling and names slip as what is left")
    runs = fitting(scene, logs)
    for run in runs:
        run.needs("pose", "an audit")
    lag_s = lag_of(scene, runs)
    moved = runs if lag_s is None else [without_lag(run, lag_s) for run in runs]
    advance()
    names = [name for name in (RADIUS, DISTANCE, TRACKER) if name != TRACKER or _tells_tracker(runs)]
    study = identify(scene, moved, geometry_of(scene, [each for name in names for each in FREE[name]]))
    advance()
    fitted = fitted_scene(scene, study.found)
    nominal, found = error_of(scene, runs), error_of(fitted, moved)
    alone = {name: error_of(_with_nominal(study, FREE[name]), moved) for name in names}
    if lag_s is not None:
        alone[LAG] = error_of(fitted, runs)
    gains, spread = leftovers(fitted, moved)
    advance()
    causes = _causes(study, alone, nominal, found, lag_s)
    return Audit(scene, moved, nominal, found, causes, study, lag_s, gains, spread)


def _causes(study: Study, alone: dict[str, float], nominal: float, found: float, lag_s: float | None) -> list[Cause]:
    own = {name: max(0.0, error**2 - found**2) for name, error in alone.items()}
    whole, left = sum(own.values()), (found / nominal) ** 2 if nominal > 0.0 else 1.0
    return [Cause(name, max(0.0, 1.0 - left) * own[name] / whole if whole > 0.0 else 0.0, float(np.sqrt(own[name])),
                  f"{1e3 * (lag_s or 0.0):.0f} ms" if name == LAG else in_words(study, FREE[name])) for name in alone]


def _with_nominal(study: Study, groups: Sequence[str]) -> Scene:
    """The fitted scene, where parameters of some groups have the values that the scene states."""
    parameters = study.found.parameters
    values = np.array([each.nominal if each.group in groups else value
                       for each, value in zip(parameters.each, study.found.values, strict=True)])
    return replace(study.scene, vehicle=parameters.vehicle(base_of(study.scene, parameters), values))


def _tells_tracker(runs: Sequence[Log]) -> bool:
    return all(run.has_heading and run.pose_point == "origin" for run in runs)


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


def lag_of(scene: Scene, runs: Sequence[Log]) -> float | None:
    """How late the true pose is: at which shift its speed and turn are most like those of the wheels, whatever their
    size. None where no shift is worth a word."""
    rolling = rolling_of(scene.core(), scene.vehicle, scene.path)
    paths = [path_of(rolling.moved(run.rotation_rad(), run.pose_point), np.zeros(3)) for run in runs]
    most = min(MOST_LAG_S, 0.1 * min(float(run.time_s[-1]) for run in runs))

    def unlike(lag_s: float) -> float:
        parts = [_motions(run, path, lag_s, most) for run, path in zip(runs, paths, strict=True)]
        rolled, true = (np.vstack([part[index] for part in parts]) for index in (0, 1))
        left = 0.0
        for one, other in zip(rolled.T, true.T, strict=True):
            size, whole = float(one @ one), float(other @ other)
            if size > 0.0 and whole > 0.0:
                left += 1.0 - float(one @ other) ** 2 / (size * whole)
        return left

    coarse = np.arange(-most, most + 1e-9, COARSE_S)
    middle = float(coarse[np.argmin([unlike(float(each)) for each in coarse])])
    fine = middle + np.arange(-COARSE_S, COARSE_S + 1e-9, FINE_S)
    values = [unlike(float(each)) for each in fine]
    found = round(float(fine[int(np.argmin(values))]), 6)
    now = unlike(0.0)
    if not min(values) < (1.0 - WORTH) * now or now < 1e-9 or abs(found) >= most - COARSE_S or found == 0.0:
        return None
    return found


def _motions(run: Log, path: np.ndarray, lag_s: float, most_s: float) -> tuple[np.ndarray, np.ndarray]:
    """(way and turn of the wheels, of the true pose so much later) over short windows."""
    assert run.pose is not None
    seen, end = run.seen, float(run.time_s[-1])
    window = min(WINDOW_S, 0.1 * end)
    begin = np.linspace(most_s, end - most_s - window, POINTS)
    found = []
    for time, pose, shift in ((run.time_s, path, 0.0), (run.time_s[seen], run.pose[seen], lag_s)):
        steps = at_times(begin + window + shift, time, pose) - at_times(begin + shift, time, pose)
        way = np.hypot(steps[:, 0], steps[:, 1])
        found.append(np.column_stack([way, steps[:, 2]]) if run.has_heading else way[:, None])
    return found[0], found[1]


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
