"""What recorded runs with a true pose say about rolling: the distance between rolled and true path, over its length.

This is the path error that `laconic replay` judges. Its residuals are sums: an error of one stretch moves all of the
path after it. So the covariance of the score is built from the errors of single stretches, each with its effect on what
follows.

Noise of single poses does not move the path after it. It makes neighbouring samples err against each other, which
shows its size. Where it is most of a stretch's error, poses around the ends of stretches are averaged, the rest of the
noise is taken out of the mean squares, and the noise itself counts once in each compared point.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from laconic.core import Core
from laconic.errors import BadInput
from laconic.robot.identify.parameter import Vehicle
from laconic.robot.logs import Log
from laconic.robot.logs.log import Point
from laconic.robot.replay.measures import LEAST_LENGTH_M, path_length
from laconic.robot.replay.placing import fitted
from laconic.robot.replay.rolling import path_of, rolling_of
from laconic.robot.replay.steered_signals import begun_at, late, of_log

if TYPE_CHECKING:
    from laconic.robot.identify.resolution import Floor

POINTS = 120      # of a path that are compared
STRETCHES = 24    # of a run whose errors count as independent
SHORT = 0.2       # of the usual length: a shorter stretch has no clear direction
MOSTLY = 0.5      # share of a stretch's squared error above which the tracker's noise is taken out of it
DEVIATIONS = 3.5  # of chance, beyond which neighbouring samples that err against each other show noise


@dataclass(frozen=True)
class Run:
    """One run, ready to be rolled many times."""

    rotation_rad: np.ndarray
    pose: np.ndarray
    point: Point
    taken: np.ndarray       # samples that are compared
    cuts: np.ndarray        # samples between which a stretch lies
    scale: float            # 1 / (length · √points)
    has_heading: bool = True

    time_s: np.ndarray = field(default_factory=lambda: np.zeros(0))
    seen: np.ndarray = field(default_factory=lambda: np.zeros(0, int))  # samples with a recorded pose

    def path(self, moved: np.ndarray, lag_s: float = 0.0) -> np.ndarray:
        """The path of displacements, from the true first pose; where positions alone are known, fitted to them. With a
        lag of the tracker, what it saw at each sample."""
        if self.has_heading and lag_s == 0.0:
            return path_of(moved, self.pose[0])
        path = late(path_of(moved, np.zeros(3)), self.time_s, self.time_s, lag_s)
        return begun_at(path, self.pose[0]) if self.has_heading else fitted(
            path, self.taken, self.pose[self.taken, :2])


class RollingEvidence:
    """Runs with a true pose, for `solve.fit`."""

    directions: float = 2
    difference = 0.0
    floor: Floor | None = None     # of errors: what sampling and rounding make
    by_wheels = True
    has_noise = True               # scores are without the noise of single poses, which noise_scores has

    def __init__(self, core: Core, scene_path: Path, logs: Sequence[Log]):
        self._core, self._path = core, scene_path
        self.sessions = [str(log.path.resolve().parent) for log in logs]
        self.runs = [run_of(log, by_wheels=self.by_wheels) for log in logs]

    def residuals(self, vehicle: Vehicle) -> list[np.ndarray]:
        """Distances x, y between rolled and true path."""
        rolling, lag_s = rolling_of(self._core, vehicle, self._path), of_log(vehicle).clock_lag_s
        return [path_residual(run, run.path(rolling.moved(run.rotation_rad, run.point), lag_s)) for run in self.runs]

    def scores(self, vehicle: Vehicle, jacobians: list[np.ndarray]) -> list[np.ndarray]:
        """Of each stretch: its error, carried to all points of the path after it, times the Jacobian there."""
        rolling, lag_s = rolling_of(self._core, vehicle, self._path), of_log(vehicle).clock_lag_s
        found = []
        for run, jacobian in zip(self.runs, jacobians, strict=True):
            path = run.path(rolling.moved(run.rotation_rad, run.point), lag_s)
            found.append(stretch_scores(run, path, jacobian.reshape(len(run.taken), 2, -1), noise_of(run, path)))
        return found

    def noise_scores(self, vehicle: Vehicle, jacobians: list[np.ndarray]) -> list[np.ndarray]:
        """Of each run: one standard deviation of each pose's noise, times the Jacobian; independent rows."""
        rolling, lag_s = rolling_of(self._core, vehicle, self._path), of_log(vehicle).clock_lag_s
        paths = (run.path(rolling.moved(run.rotation_rad, run.point), lag_s) for run in self.runs)
        return [_noise_scores(run, jacobian.reshape(len(run.taken), 2, -1), noise_of(run, path))
                for run, path, jacobian in zip(self.runs, paths, jacobians, strict=True)]

    def errors(self, vehicle: Vehicle) -> list[np.ndarray]:
        """Of each stretch of each run: displacement ahead and to the left, turn."""
        rolling, lag_s = rolling_of(self._core, vehicle, self._path), of_log(vehicle).clock_lag_s
        return [stretch_errors(run, run.path(rolling.moved(run.rotation_rad, run.point), lag_s)) for run in self.runs]


def run_of(log: Log, *, by_wheels: bool = True) -> Run:
    """BadInput for a log without a true pose, or whose true path has no length. `by_wheels`: their rotations are
    used."""
    pose = log.needs("pose", "identify")
    seen = log.seen
    length = path_length(log.time_s[seen], pose[seen])
    if not length > LEAST_LENGTH_M:
        raise BadInput(f"{log.path}: its true path has no length; give runs in which the robot moves")
    last = len(seen) - 1
    taken = seen[np.unique(np.linspace(0, last, POINTS + 1).astype(int)[1:])]
    cuts = seen[np.unique(np.linspace(0, last, STRETCHES + 1).astype(int))]
    rotation = log.rotation_rad() if by_wheels else np.zeros((len(log.time_s) - 1, 0))
    return Run(rotation, pose, log.pose_point, taken, cuts, 1.0 / (length * np.sqrt(len(taken))),
               log.has_heading, log.time_s, seen)


def path_residual(run: Run, path: np.ndarray) -> np.ndarray:
    """Distances x, y of the compared points, over the path's length; their squares sum to the squared path error."""
    found: np.ndarray = ((path - run.pose)[run.taken, :2] * run.scale).ravel()
    return found


@dataclass(frozen=True)
class Noise:
    """Of single poses, each on its own."""

    place_m: float = 0.0
    heading_rad: float = 0.0


def noise_of(run: Run, path: np.ndarray) -> Noise:
    """None unless it is most of the stretches' errors."""
    if not run.has_heading or len(run.seen) < len(run.cuts):
        return Noise()
    error = relative(path, run.seen) - relative(run.pose, run.seen)
    against = -(error[1:] * error[:-1]).mean(axis=0)
    against[against * np.sqrt(len(error)) < DEVIATIONS * (error**2).mean(axis=0)] = 0.0
    noise = Noise(float(np.sqrt(against[:2].mean())), float(np.sqrt(against[2])))
    return noise if (_noise_share(run, noise, stretch_errors(run, path)) > MOSTLY).any() else Noise()


def _noise_share(run: Run, noise: Noise, error: np.ndarray) -> np.ndarray:
    """Of the mean squared error of stretches: ahead, left, turn."""
    ahead, left, _ = (relative(run.pose, run.cuts) ** 2).mean(axis=0)
    place, heading = noise.place_m**2, noise.heading_rad**2
    made = np.array([2.0 * place + left * heading, 2.0 * place + ahead * heading, 2.0 * heading])
    share: np.ndarray = np.minimum(1.0, made / np.maximum((error**2).mean(axis=0), 1e-300))
    return share


def _quiet_errors(run: Run, path: np.ndarray, noise: Noise) -> np.ndarray:
    """Errors of stretches between poses that are averaged over a stretch, with what is left of the noise taken
    out. Means of a drift that wanders differ less than it: by a third of the variance."""
    off = path - run.pose
    pose, ends = run.pose.copy(), np.searchsorted(run.seen, run.cuts)
    half = max(int(np.diff(ends).min()) // 2, 1)
    for cut, end in zip(run.cuts, ends, strict=True):
        pose[cut] = path[cut] - off[run.seen[max(end - half, 0):end + half + 1]].mean(axis=0)
    quiet, count = replace(run, pose=pose), 2 * half + 1
    error = stretch_errors(quiet, path)
    left = _noise_share(quiet, Noise(noise.place_m / count**0.5, noise.heading_rad / count**0.5), error)
    left = np.minimum(left, 1.0 - 1.0 / len(error))  # so many stretches show no smaller share of other errors
    found: np.ndarray = error * np.sqrt((1.0 - left) / (1.0 - 1.0 / 3.0))
    return found


def _noise_scores(run: Run, jacobian: np.ndarray, noise: Noise) -> np.ndarray:
    """That of each compared point, and that of the pose from which the path starts, which moves all points."""
    lever = run.pose[run.taken, :2] - run.pose[0, :2]
    turned = np.einsum("kcp,kc->p", jacobian, np.column_stack([-lever[:, 1], lever[:, 0]]))
    points = jacobian.reshape(-1, jacobian.shape[2])
    return run.scale * np.vstack([noise.place_m * points, noise.place_m * jacobian.sum(axis=0),
                                  noise.heading_rad * turned])


def stretch_scores(run: Run, path: np.ndarray, jacobian: np.ndarray, noise: Noise | None = None) -> np.ndarray:
    """jacobian: points × 2 × parameters; `noise` is taken out of the errors."""
    error = stretch_errors(run, path)
    if noise is not None and noise != Noise():
        error = _quiet_errors(run, path, noise)
    found = []
    for index, (begin, end) in enumerate(zip(run.cuts[:-1], run.cuts[1:], strict=True)):
        after = run.taken >= end
        cos, sin = np.cos(path[begin, 2]), np.sin(path[begin, 2])
        ahead, left, turn = error[index]
        shift = np.array([cos * ahead - sin * left, sin * ahead + cos * left])
        lever = path[run.taken[after], :2] - path[end, :2]
        moved = shift + turn * np.column_stack([-lever[:, 1], lever[:, 0]])
        found.append(np.einsum("kcp,kc->p", jacobian[after], moved) * run.scale)
    return np.array(found)


def stretch_errors(run: Run, path: np.ndarray) -> np.ndarray:
    """What the motion of each stretch is off by, in the body's frame at its beginning."""
    true = run.pose if run.has_heading else with_headings(run.pose, path, run.cuts)
    return relative(path, run.cuts) - relative(true, run.cuts)


def with_headings(pose: np.ndarray, path: np.ndarray, cuts: np.ndarray) -> np.ndarray:
    """Positions with headings at the cuts: those of a path, turned as each of its stretches must be turned to go where
    the positions go. A stretch that is too short to have a direction is turned as those around it."""
    own, other = np.diff(path[cuts, :2], axis=0), np.diff(pose[cuts, :2], axis=0)
    turn = np.arctan2(own[:, 0] * other[:, 1] - own[:, 1] * other[:, 0], (own * other).sum(axis=1))
    size = np.minimum(np.hypot(*own.T), np.hypot(*other.T))
    clear = np.flatnonzero(size > SHORT * np.median(size)) if size.any() else np.zeros(0, int)
    turn = np.interp(np.arange(len(turn)), clear, np.unwrap(turn[clear])) if len(clear) else np.zeros(len(turn))
    found = pose.copy()
    found[cuts, 2] = path[cuts, 2] + np.append(turn, turn[-1:])
    return found


def relative(pose: np.ndarray, cuts: np.ndarray) -> np.ndarray:
    """Displacement of each stretch in the body's frame at its beginning, and turn."""
    return in_frame(np.diff(pose[cuts], axis=0), pose[cuts[:-1], 2])


def in_frame(step: np.ndarray, heading: np.ndarray) -> np.ndarray:
    """Displacements in frames of these headings, and turns."""
    cos, sin = np.cos(heading), np.sin(heading)
    return np.column_stack([cos * step[:, 0] + sin * step[:, 1], cos * step[:, 1] - sin * step[:, 0], step[:, 2]])
