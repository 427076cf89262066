"""What the sampling and the rounding of a log alone make of the errors of its stretches.

Between two samples a motion is taken as a twist that is held, and speeds are integrated by the trapezoidal rule. What
this costs repeats from stretch to stretch, but says nothing against the model. Rolling every second sample shows it:
the errors are of second order, so they are a third of the difference. Steps of recorded speeds, which stay on one side
while a speed stays, count as well; those of angles and poses do not add up.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from laconic.robot.identify.rolling_evidence import Run, relative
from laconic.robot.logs import Log
from laconic.robot.replay.measures import path_length

ON_GRID = 0.02       # of a step: numbers that are written with so many decimals
DIGITS = 12
ROUNDING = 1e-9      # m, rad: of sums in double precision
LEAST_STEPS = 3
OF_STEP = 12.0**-0.5  # root mean square of rounding, in steps


@dataclass(frozen=True)
class Floor:
    """Below it errors of runs say nothing."""

    stretch: np.ndarray     # root mean square of what sampling and rounding make of a stretch: ahead, left, turn
    path_error: float       # what sampling makes of a path error


def floor_of_all(path: Callable[[Log], np.ndarray], logs: Sequence[Log], runs: Sequence[Run],
                 per_rotation: np.ndarray | None = None) -> Floor:
    """Of several runs. `path`: as the model rolls a log; `per_rotation`: what a rotation of each wheel moves, where
    it is known."""
    each = [_floor_of(path, log, run, per_rotation) for log, run in zip(logs, runs, strict=True)]
    known = [one.path_error for one in each if np.isfinite(one.path_error)]
    return Floor(np.sqrt((np.array([one.stretch for one in each]) ** 2).mean(axis=0)),
                 float(np.sqrt(np.mean(np.square(known)))) if known else 0.0)


def _floor_of(path: Callable[[Log], np.ndarray], log: Log, run: Run, per_rotation: np.ndarray | None) -> Floor:
    rows = np.arange(0, len(log.time_s), 2)
    if len(rows) < 2 * len(run.cuts):
        return Floor(np.full(3, np.inf), np.inf)  # as few samples as stretches tell nothing of either
    cuts = run.cuts // 2
    off = (relative(path(log)[rows], cuts) - relative(path(sampled(log, rows)), cuts)) / 3.0
    found = np.sqrt((off**2).mean(axis=0)) + ROUNDING
    step_m = max(path_length(log.time_s[log.seen], run.pose[log.seen]) / max(len(run.cuts) - 1, 1), 1e-9)
    found = found + np.array([step_m * found[2]] * 2 + [np.hypot(*found[:2]) / step_m])  # a fit trades one for another
    path_error = float(np.hypot(*found[:2])) / step_m
    if per_rotation is None or log.wheel_angle_rad is not None or log.wheel_speed_rad_per_s is None:
        return Floor(found, path_error)
    steps = np.array([step_of(column) for column in log.wheel_speed_rad_per_s.T])
    stretch_s = float(log.time_s[-1]) / max(len(run.cuts) - 1, 1)
    return Floor(np.hypot(found, np.abs(per_rotation) @ steps * OF_STEP * stretch_s), path_error)


def sampled(log: Log, rows: np.ndarray) -> Log:
    """The log at some of its samples."""
    parts: dict[str, Any] = {name: value[rows] for name, value in vars(log).items()
                             if isinstance(value, np.ndarray) and name != "pose_rows"}
    return replace(log, pose_rows=None, counter=None, **parts)


def step_of(values: np.ndarray) -> float:
    """The step in which a column is written; 0 where it has none."""
    there = values[np.isfinite(values)]
    size = float(np.abs(there).max(initial=0.0))
    if not size > 0.0:
        return 0.0
    apart = np.diff(np.unique(np.round(there / size, DIGITS))) * size
    if len(apart) < LEAST_STEPS:
        return 0.0
    steps = apart / apart.min()
    return float(apart.min()) if np.abs(steps - np.round(steps)).max() < ON_GRID else 0.0
