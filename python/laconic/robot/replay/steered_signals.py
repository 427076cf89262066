"""What drives a steered vehicle from sample to sample, by its log: hinges, wheels or a commanded speed, and the tracker.

Encoders are taken between their lines as straight; commands are held, and followed with a lag and a limited rate in
steps of at most STEP_S. `OfLog` is what a fit changes of all this: it belongs to the map, not to the scene.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from laconic.robot.logs.log import LEAST_SAMPLES, Log, counted

STEP_S = 0.02           # at most, between instants of a run by commands
GAP_S, GAP = 1.0, 5.0   # least length of a gap, and in usual times between lines
LEAST_ROWS = 5          # of a part between gaps
START_S = 0.15          # from whose poses comes the speed at the start


@dataclass
class OfLog:
    """Corrections of what the map says; as it is, none."""

    gain: float = 1.0                   # of the steering, after the map's
    offset_rad: float = 0.0
    curve: dict[float, float] = field(default_factory=dict)   # angles of the hinge at angles of the log, besides 0
    lag_s: float = 0.0                  # of the steering, besides the map's
    rate_limit_rad_per_s: float = math.inf
    speed_gain: float = 1.0
    speed_lag_s: float = 0.0
    tracker_x_m: float = 0.0            # its place on the robot, in its frame
    tracker_y_m: float = 0.0
    tracker_heading_rad: float = 0.0
    clock_lag_s: float = 0.0            # so much later than their lines are the poses


NONE = OfLog()


class Fitted(dict[str, Any]):
    """The keys of `[vehicle]`, with what a fit changed of the log's map."""

    log: OfLog

    def __init__(self, vehicle: Mapping[str, Any], log: OfLog | None = None):
        super().__init__(vehicle)
        self.log = replace(log, curve=dict(log.curve)) if log else OfLog()


def of_log(vehicle: Mapping[str, Any]) -> OfLog:
    """The corrections that a vehicle brings along."""
    return vehicle.log if isinstance(vehicle, Fitted) else NONE


@dataclass(frozen=True)
class Driven:
    """A run as it drives the model: instants, at which hinges have angles, and what happens between two of them."""

    time_s: np.ndarray
    steering_rad: np.ndarray            # instants × columns of the log
    between_rad: np.ndarray             # (instants − 1) × columns: the mean from instant to instant
    rotation_rad: np.ndarray            # (instants − 1) × wheels, NaN: not measured
    way_m: np.ndarray | None            # (instants − 1), of the middle of the fixed axle, by commands


def driven(log: Log, own: OfLog, wheels: int) -> Driven:
    """The run of a log whose steering is there."""
    angle = log.needs("steering_angle_rad", "rolling of a steered vehicle")
    given, following = curved(angle, log.following.curve, own), log.following
    lag_s = max(following.lag_s + own.lag_s, 0.0)
    limit = min(following.rate_limit_rad_per_s, own.rate_limit_rad_per_s)
    by_commands = following.is_command or log.speed_m_per_s is not None
    grid, row = _grid(log.time_s) if by_commands else (log.time_s, np.arange(len(log.time_s)))
    held = given[row] if following.is_command or not by_commands else np.column_stack([
        np.interp(grid, log.time_s, column) for column in given.T])
    angles, between = held, 0.5 * (held[1:] + held[:-1])
    if following.is_command or lag_s > 0.0 or limit < math.inf:
        pairs = [followed(grid, column, column[0], lag_s, limit) for column in held.T]
        angles, between = (np.column_stack(each) for each in zip(*pairs, strict=True))
    steps = np.diff(grid)
    if log.speed_m_per_s is None:
        share = steps / np.diff(log.time_s)[row[:-1]]
        return Driven(grid, angles, between, log.rotation_rad()[row[:-1]] * share[:, None], None)
    wanted, speed_lag_s = own.speed_gain * log.speed_m_per_s[row], max(following.speed_lag_s + own.speed_lag_s, 0.0)
    first = _first_speed(log, float(wanted[0])) if speed_lag_s > 0.0 else float(wanted[0])
    speed = followed(grid, wanted, first, speed_lag_s, math.inf)[1]
    return Driven(grid, angles, between, np.full((len(steps), wheels), np.nan), speed * steps)


def curved(angle: np.ndarray, curve: tuple[tuple[float, float], ...], own: OfLog) -> np.ndarray:
    """Angles of the hinges by those of the log."""
    found = piecewise(angle, *np.array(curve).T) if curve else angle
    if own.curve:
        known = sorted([*own.curve.items(), (0.0, 0.0)])
        found = piecewise(found, *np.array(known).T)
    return own.gain * found + own.offset_rad


def piecewise(x: np.ndarray, at: np.ndarray, value: np.ndarray) -> np.ndarray:
    """Straight between points, and on beyond the last ones."""
    part = np.clip(np.searchsorted(at, x) - 1, 0, len(at) - 2)
    slope = np.diff(value) / np.diff(at)
    found: np.ndarray = value[part] + slope[part] * (x - at[part])
    return found


def followed(time_s: np.ndarray, wanted: np.ndarray, first: float, lag_s: float, limit: float
             ) -> tuple[np.ndarray, np.ndarray]:
    """What follows a target that is held from each instant on, with a lag and at a limited rate: at the instants, and
    its mean from each to the next, which tells lags that are shorter than that."""
    steps = np.diff(time_s)
    found, means = np.empty(len(wanted)), np.empty(len(steps))
    found[0] = value = first
    shares = (1.0 - np.exp(-steps / lag_s) if lag_s > 0.0 else np.ones(len(steps))).tolist()
    left = (lag_s * np.array(shares) / steps).tolist()
    for index, (target, share, rest, most) in enumerate(
            zip(wanted[:-1].tolist(), shares, left, (limit * steps).tolist(), strict=True)):
        off = target - value
        change = share * off
        if -most <= change <= most:
            means[index] = target - rest * off
            value += change
        else:
            change = most if change > 0.0 else -most
            means[index] = value + 0.5 * change
            value += change
        found[index + 1] = value
    return found, means


def _grid(time_s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(instants at most STEP_S apart that hold all lines, the line from which on the log says each)."""
    counts = np.maximum(1, np.ceil(np.diff(time_s) / STEP_S - 1e-9)).astype(int)
    row = np.repeat(np.arange(len(counts)), counts)
    part = np.arange(len(row)) - np.repeat(np.cumsum(counts) - counts, counts)
    grid = time_s[row] + part * (np.diff(time_s) / counts)[row]
    return np.append(grid, time_s[-1]), np.append(row, len(time_s) - 1)


def _first_speed(log: Log, otherwise: float) -> float:
    """By the first poses: a log may begin while the robot moves."""
    if log.pose is None:
        return otherwise
    end = min(max(int(np.searchsorted(log.time_s, START_S)), 1), len(log.time_s) - 1)
    speed = float(np.hypot(*(log.pose[end] - log.pose[0])[:2]) / (log.time_s[end] - log.time_s[0]))
    return math.copysign(speed, otherwise)


def seen_by_tracker(path: np.ndarray, time_s: np.ndarray, wanted_s: np.ndarray, point: tuple[float, float],
                    own: OfLog) -> np.ndarray:
    """Poses of the tracker as a log has them at `wanted_s`, of the body's path at `time_s`; from no certain place."""
    x, y, heading = late(path, time_s, wanted_s, own.clock_lag_s).T
    cos, sin = np.cos(heading), np.sin(heading)
    ahead, left = point[0] + own.tracker_x_m, point[1] + own.tracker_y_m
    return np.column_stack([x + cos * ahead - sin * left, y + sin * ahead + cos * left,
                            heading + own.tracker_heading_rad])


def late(path: np.ndarray, time_s: np.ndarray, wanted_s: np.ndarray, lag_s: float) -> np.ndarray:
    """A path so much earlier than wanted; before its first instant and after its last it goes straight on."""
    if lag_s == 0.0 and len(time_s) == len(wanted_s):
        return path
    at = wanted_s - lag_s
    part = np.clip(np.searchsorted(time_s, at) - 1, 0, len(time_s) - 2)
    share = (at - time_s[part]) / (time_s[part + 1] - time_s[part])
    found: np.ndarray = path[part] + share[:, None] * (path[part + 1] - path[part])
    return found


def begun_at(path: np.ndarray, start: np.ndarray) -> np.ndarray:
    """A path turned and moved as a whole so that it begins at a pose."""
    turn = start[2] - path[0, 2]
    cos, sin = math.cos(turn), math.sin(turn)
    x, y = (path[:, :2] - path[0, :2]).T
    return np.column_stack([start[0] + cos * x - sin * y, start[1] + sin * x + cos * y, path[:, 2] + turn])


def parts_of(log: Log) -> list[Log]:
    """The parts of a log between its gaps, each a run of its own: nothing is integrated over a gap. A remark says so.

    One with positions alone, and one of a part already, stays whole where it has no gap.
    """
    steps = np.diff(log.time_s)
    ends = np.flatnonzero(steps > max(GAP_S, GAP * float(np.median(steps)))) + 1
    if not len(ends) or log.part:
        return [log]
    edges = [0, *ends.tolist(), len(log.time_s)]
    pieces = [(low, high) for low, high in zip(edges[:-1], edges[1:], strict=True) if high - low >= LEAST_ROWS]
    lost = len(log.time_s) - sum(high - low for low, high in pieces)
    remark = (f"{counted(len(ends), 'gap')} in it, the longest {steps.max():.3g} s from {log.time_s[steps.argmax()]:.3f} s "
              f"on: nothing is integrated over them; {counted(len(pieces), 'part')} of at least {LEAST_ROWS} lines count"
              + (f", {counted(lost, 'line')} between gaps are left out" if lost else ""))
    found = [_sliced(log, low, high, f"part {number}") for number, (low, high) in enumerate(pieces, 1)]
    if found:
        found[0] = replace(found[0], remarks=(*found[0].remarks, remark))
    return found


def _sliced(log: Log, low: int, high: int, name: str) -> Log:
    """Lines of a log; the remarks stay with the first part."""
    changed: dict[str, Any] = {key: value[low:high] for key, value in vars(log).items()
                               if isinstance(value, np.ndarray) and key not in ("pose_rows", "time_s")}
    seen = log.seen
    rows = None if log.pose_rows is None else seen[(seen >= low) & (seen < high)] - low
    return replace(log, time_s=log.time_s[low:high] - log.time_s[low], pose_rows=rows, counter=None, part=name,
                   remarks=log.remarks if name == "part 1" else (), **changed)


assert LEAST_ROWS < LEAST_SAMPLES
