"""How far a predicted path is from the true one."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from laconic.robot.logs.log import Log, run_names

APART_S = 0.2        # between the samples whose distances add up to a path's length, so that noise adds none
ROUNDING_S = 1e-9
LEAST_LENGTH_M = 1e-3
CLOSED = 0.02        # displacement over length of a path below which it ends where it began


@dataclass(frozen=True)
class RunErrors:
    """The errors of one run; None where its log cannot tell."""

    run: str
    session: str
    path_error: float | None = None             # root mean square distance over the length of the true path
    displacement_error: float | None = None     # distance at the end over the true displacement
    heading_error_rad: float | None = None      # at the end
    wheel_speed_error: float | None = None      # root mean square, over that of the recorded speeds
    current_error_A: float | None = None        # mean over the wheels, of steady currents

    def as_json(self) -> dict[str, Any]:
        """Without the session, which its own table has."""
        return {key: value for key, value in asdict(self).items() if key != "session"}


MEASURES = ("path_error", "displacement_error", "heading_error_rad", "wheel_speed_error", "current_error_A")


def path_length(time_s: np.ndarray, pose: np.ndarray) -> float:
    """Length of a path sampled at least APART_S apart."""
    taken = [0]
    for index in range(1, len(time_s)):
        if time_s[index] - time_s[taken[-1]] >= APART_S - ROUNDING_S:
            taken.append(index)
    return float(np.hypot(*np.diff(pose[taken, :2], axis=0).T).sum())


def path_errors(name: str, log: Log, predicted: np.ndarray) -> RunErrors:
    """The errors of a predicted path where the true one was recorded; one of no length has none, a closed one no
    displacement to compare with, and positions alone no heading."""
    if log.pose is None or not len(log.seen):
        return RunErrors(name, log.session)
    true, off = log.pose[log.seen], (predicted - log.pose)[log.seen]
    distance = np.hypot(off[:, 0], off[:, 1])
    length, displacement = path_length(log.time_s[log.seen], true), float(np.hypot(*(true[-1] - true[0])[:2]))
    return RunErrors(
        name, log.session,
        float(np.sqrt((distance**2).mean()) / length) if length > LEAST_LENGTH_M else None,
        float(distance[-1] / displacement) if displacement > max(LEAST_LENGTH_M, CLOSED * length) else None,
        float(abs(off[-1, 2])) if log.has_heading else None)


def all_errors(logs: Sequence[Log], predicted: Iterable[np.ndarray]) -> list[RunErrors]:
    """Those of several runs, by the names of their files."""
    return [path_errors(name, log, path) for name, log, path in zip(run_names(logs), logs, predicted, strict=True)]


def mean_of(errors: Sequence[RunErrors], name: str, session: str) -> RunErrors:
    """The mean of each measure over the runs that have it."""
    means: list[float | None] = []
    for measure in MEASURES:
        values = [value for each in errors if (value := getattr(each, measure)) is not None]
        means.append(float(np.mean(values)) if values else None)
    return RunErrors(name, session, *means)


def session_means(errors: Sequence[RunErrors]) -> list[RunErrors]:
    """The mean of each session's runs, in the order in which they came."""
    sessions = dict.fromkeys(each.session for each in errors)
    return [mean_of([each for each in errors if each.session == session], "mean", session) for session in sessions]


def grand_mean(errors: Sequence[RunErrors]) -> RunErrors:
    """The mean over the sessions, so that a session with many runs does not count more."""
    return mean_of(session_means(errors), "mean over sessions", "")
