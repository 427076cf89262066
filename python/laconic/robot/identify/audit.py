"""Where the wheels' odometry and the true path part, and how much of that is radius, distance, tracker, lag or slip.

All causes are found together, as each of them can hide another. Then each one alone goes back to what the scene states:
the error that comes back is its own. The shares are those of the squared errors, so that they add up.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from laconic.errors import BadInput
from laconic.robot.identify.geometry import geometry_of, tracker_of
from laconic.robot.identify.ground import base_of
from laconic.robot.identify.parameter import Parameters, Vehicle
from laconic.robot.identify.rolling_evidence import in_frame, relative, run_of, stretch_errors
from laconic.robot.identify.solve import Fit
from laconic.robot.identify.steered_audit import FREE as FREE_OF_STEERED
from laconic.robot.identify.steered_audit import lag_of_fit, parameters_of
from laconic.robot.identify.study import Study, fitted_scene, identify
from laconic.robot.logs import Log
from laconic.robot.logs.log import POINTS as OF_POSES
from laconic.robot.logs.poses import at_times
from laconic.robot.replay.measures import path_errors, path_length
from laconic.robot.replay.missed_wraps import fitting, rolled_alone
from laconic.robot.replay.rolling import rolling_of
from laconic.robot.replay.steered_rolling import SteeredRolling
from laconic.scene import Scene
from laconic.scene.ground import slips

MOST_LAG_S, COARSE_S, FINE_S = 0.5, 0.02, 0.001
WINDOW_S, POINTS = 0.4, 600   # of the motions that are compared, and how many of them in each run
WORTH = 0.05                  # of the difference in motion: a lag that takes away less is noise
LEAST_MOVED = 0.02            # of the largest direction: in others the runs do not tell a gain
STEPS = 3                     # of the progress bar
CLEARLY = 0.5                 # of the error: a path that goes round and round has many least values
SIDEWAYS = "to the left"
DIRECTIONS = ("ahead", SIDEWAYS, "turn")
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
    gain_errors: dict[str, float]  # standard errors of these
    spread: np.ndarray      # root mean square of the stretches' errors: ahead, left [m for 1 m], turn [rad for 1 m]
    model: Model

    @property
    def fitted(self) -> Scene:
        """The scene with the values found."""
        return self.model.fitted(self.study.found)

    @property
    def vehicle(self) -> Vehicle:
        """The vehicle with the values found, as the model takes it."""
        found = self.study.found
        return found.parameters.vehicle(base_of(self.scene, found.parameters), found.values)

    def paths(self, log: Log) -> dict[str, np.ndarray]:
        """Rolled by the scene as it is, and with the values found."""
        return {"nominal": self.model.path(self.scene.vehicle, log), "fitted": self.model.path(self.vehicle, log)}

    @property
    def left(self) -> float:
        """The part of the squared error that no cause explains."""
        return min(1.0, (self.found / self.nominal) ** 2) if self.nominal > 0.0 else 1.0


class Model:
    """How a vehicle rolls, by the values of a fit."""

    def __init__(self, scene: Scene):
        self.scene = scene
        self.free = FREE_OF_STEERED if scene.has_hinges else FREE

    def path(self, vehicle: Vehicle, log: Log) -> np.ndarray:
        """Poses at the samples' times, from the true first one; placed to fit positions alone."""
        if self.scene.has_hinges:
            return SteeredRolling(replace(self.scene, vehicle=vehicle)).path(log)
        return rolling_of(self.scene.core(), vehicle, self.scene.path).path(log)

    def fit(self, runs: Sequence[Log], groups: Sequence[str]) -> Study:
        """Finds the values of some groups."""
        if not self.scene.has_hinges:
            of_centre = all(run.pose_point == OF_POSES[1] for run in runs)
            tracker = tracker_of(of_centre, any(run.has_heading for run in runs))
            rolling = geometry_of(self.scene, [each for each in groups if each not in FREE[TRACKER]])
            return identify(self.scene, runs, Parameters((*rolling.each, *tracker)))
        free = parameters_of(self.scene, groups)
        whole, parts = (identify(self.scene, runs, free, whole=each) for each in (True, False))
        return parts if self._error(parts, runs) < CLEARLY * self._error(whole, runs) else whole

    def _error(self, study: Study, runs: Sequence[Log]) -> float:
        return error_of(self, self.fitted(study.found).vehicle, runs)

    def fitted(self, found: Fit) -> Scene:
        """The scene with the values found."""
        return fitted_scene(self.scene, found)


def audit(scene: Scene, logs: Sequence[Log], advance: Callable[..., None] = lambda *_, **__: None) -> Audit:
    """BadInput where a log has no true pose, or the scene has friction, for which rolling is no model."""
    if slips(scene.vehicle):
        raise BadInput(f"{scene.path}: has a [ground] with friction; give the scene without it, as an audit compares "
                       "with rolling and names slip as what is left")
    scene, [logs] = rolled_alone(scene, logs)
    runs = fitting(scene, logs)
    for run in runs:
        run.needs("pose", "an audit")
    model = Model(scene)
    free = dict(model.free)
    lag_s = None if LAG in free else lag_of(runs, [model.path(scene.vehicle, run) for run in runs])
    moved = runs if lag_s is None else [without_lag(run, lag_s) for run in runs]
    advance()
    study = model.fit(moved, [each for groups in free.values() for each in groups])
    vehicle = study.found.parameters.vehicle(base_of(scene, study.found.parameters), study.found.values)
    advance()
    nominal, found = error_of(model, scene.vehicle, runs), error_of(model, vehicle, moved)
    alone = {name: error_of(model, _with_nominal(study, groups), moved) for name, groups in free.items()}
    if lag_s is not None:
        alone[LAG] = error_of(model, vehicle, runs)
    gains, gain_errors, spread = leftovers([(run, model.path(vehicle, run)) for run in moved])
    advance()
    causes = _causes(study, free, alone, (nominal, found), lag_s)
    lag_s = lag_of_fit(study) if LAG in free else lag_s
    return Audit(scene, moved, nominal, found, causes, study, lag_s, gains, gain_errors, spread, model)


def _causes(study: Study, free: Mapping[str, Sequence[str]], alone: dict[str, float], errors: tuple[float, float],
            lag_s: float | None) -> list[Cause]:
    nominal, found = errors
    own = {name: max(0.0, error**2 - found**2) for name, error in alone.items()}
    whole, left = sum(own.values()), (found / nominal) ** 2 if nominal > 0.0 else 1.0
    words = {name: in_words(study, groups) for name, groups in free.items()}
    return [Cause(name, max(0.0, 1.0 - left) * own[name] / whole if whole > 0.0 else 0.0, float(np.sqrt(own[name])),
                  words.get(name, f"{1e3 * (lag_s or 0.0):.0f} ms")) for name in alone]


def _with_nominal(study: Study, groups: Sequence[str]) -> Vehicle:
    """The fitted vehicle, where parameters of some groups have the values that the scene states."""
    parameters = study.found.parameters
    values = np.array([each.nominal if each.group in groups else value
                       for each, value in zip(parameters.each, study.found.values, strict=True)])
    return parameters.vehicle(base_of(study.scene, parameters), values)


def error_of(model: Model, vehicle: Vehicle, runs: Sequence[Log]) -> float:
    """Root mean square over the runs."""
    every = [path_errors(run.stem, run, model.path(vehicle, run)).path_error for run in runs]
    errors = [each for each in every if each is not None]
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


def lag_of(runs: Sequence[Log], paths: Sequence[np.ndarray]) -> float | None:
    """How late the true pose is against the rolled paths: at which shift its speed and turn are most like theirs,
    whatever their size. None where no shift is worth a word."""
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
    parts: dict[str, Any] = {name: value[rows] for name, value in vars(log).items()
                             if isinstance(value, np.ndarray) and name not in OF_ROWS}
    return replace(log, time_s=log.time_s[rows] - log.time_s[rows[0]], pose=moved, pose_rows=None, **parts)


OF_ROWS = ("time_s", "pose", "pose_rows")     # which are made anew


def _roll_sideways(paths: Sequence[np.ndarray]) -> bool:
    """Whether the wheels roll to the left at all, from row to row, apart from what turning does to a point ahead of
    the axle. Stretches do not show this, because a curve ends to the left of its beginning."""
    ahead, left, turn = np.vstack([in_frame(np.diff(path, axis=0), 0.5 * (path[1:, 2] + path[:-1, 2]))
                                   for path in paths]).T
    whole = float(turn @ turn)
    rest = left - turn * (float(left @ turn) / whole if whole > 0.0 else 0.0)
    return bool(np.linalg.norm(rest) > LEAST_MOVED * np.hypot(np.linalg.norm(ahead), np.linalg.norm(left)))


def leftovers(runs: Sequence[tuple[Log, np.ndarray]]) -> tuple[dict[str, float], dict[str, float], np.ndarray]:
    """(true over rolled motion in each direction that the runs tell, standard errors of that, spread of the stretches'
    errors for a metre) of runs with their rolled paths."""
    told, true, errors = [], [], []
    is_sideways = _roll_sideways([path for _, path in runs])
    for log, path in runs:
        run = run_of(log, by_wheels=False)
        off = stretch_errors(run, path)
        motion = relative(path, run.cuts)
        told.append(motion)
        true.append(motion - off)
        errors.append(off / max(path_length(log.time_s, path) / len(off), 1e-9))
    rolled, wanted = np.vstack(told), np.vstack(true)
    gains, gain_errors = {}, {}
    size = np.sqrt((rolled**2).mean(axis=0))
    for index, name in enumerate(DIRECTIONS):
        if name == SIDEWAYS and not is_sideways:
            continue
        if size[index] > LEAST_MOVED * size[:2].max() and size[index] > 0.0:
            whole = float((rolled[:, index] ** 2).sum())
            gains[name] = float((rolled[:, index] * wanted[:, index]).sum() / whole)
            left = wanted[:, index] - gains[name] * rolled[:, index]
            gain_errors[name] = float(np.sqrt((left**2).sum() / max(len(left) - 1, 1) / whole))
    return gains, gain_errors, np.sqrt((np.vstack(errors) ** 2).mean(axis=0))
