"""What drives a steered vehicle from sample to sample, by its log: hinges, wheels or a commanded speed; the tracker.

Encoders are taken between their lines as straight; commands are held, and followed with a lag and a limited rate in
steps of at most STEP_S. `OfLog` is what a fit changes of all this: it belongs to the map, not to the scene.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from laconic.errors import BadInput
from laconic.robot.logs.log import Log, counted

STEP_S = 0.02           # at most, between instants of a run by commands
GAP_S, GAP = 1.0, 5.0   # least length of a gap, and in usual times between lines
LEAST_ROWS = 5          # of a part between gaps
TINY_S, LEAST_WAY_M = 1e-9, 0.02
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
    speed_offset_m_per_s: float = 0.0   # in the direction of the command
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


def driven(log: Log, own: OfLog, wheels: int, first_rad: float | None = None) -> Driven:
    """The run of a log whose steering is there. `first_rad`: the angle at which one that follows commands begins."""
    angle = log.needs("steering_angle_rad", "rolling of a steered vehicle")
    given, following = curved(angle, log.following.curve, own), log.following
    lag_s = max(following.lag_s + own.lag_s, 0.0)
    limit = min(following.rate_limit_rad_per_s, own.rate_limit_rad_per_s)
    shift_s = own.clock_lag_s if by_commands(log) else 0.0
    grid, row, line = _grid(log.time_s, shift_s) if by_commands(log) else (log.time_s, *2 * (np.arange(len(angle)),))
    held = given[row] if following.is_command or not by_commands(log) else np.column_stack([
        np.interp(grid - shift_s, log.time_s, column) for column in given.T]) if given.shape[1] else given[row]
    angles, between = held, 0.5 * (held[1:] + held[:-1])
    if given.shape[1] and (following.is_command or lag_s > 0.0 or limit < math.inf):
        start_rad = None if lag_s == 0.0 and limit == math.inf else first_rad
        pairs = [followed(grid, column, column[0] if start_rad is None else start_rad, lag_s, limit)
                 for column in held.T]
        angles, between = (np.column_stack(each) for each in zip(*pairs, strict=True))
    steps = np.diff(grid)
    if log.speed_m_per_s is None:
        share = steps / np.diff(log.time_s)[line[:-1]]
        return Driven(grid, angles, between, log.rotation_rad()[line[:-1]] * share[:, None], None)
    commanded, speed_lag_s = log.speed_m_per_s[row], max(following.speed_lag_s + own.speed_lag_s, 0.0)
    wanted = own.speed_gain * commanded + own.speed_offset_m_per_s * np.sign(commanded)
    first = _first_speed(log, float(wanted[0])) if speed_lag_s > 0.0 else float(wanted[0])
    speed = followed(grid, wanted, first, speed_lag_s, math.inf)[1]
    return Driven(grid, angles, between, np.full((len(steps), wheels), np.nan), speed * steps)


def by_commands(log: Log) -> bool:
    """Whether something in the log is held, so that instants between its lines count."""
    return log.following.is_command or log.speed_m_per_s is not None


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
    found, ways = np.empty(len(wanted)), np.empty(len(wanted) - 1)
    changes = np.flatnonzero(np.diff(wanted[:-1])) + 1
    found[0] = value = first
    for low, high in zip([0, *changes.tolist()], [*changes.tolist(), len(ways)], strict=True):
        after = time_s[low:high + 1] - time_s[low]
        values, summed = _approach(after, value, float(wanted[low]), lag_s, limit)
        found[low + 1:high + 1], ways[low:high], value = values[1:], np.diff(summed), float(values[-1])
    return found, ways / np.diff(time_s)


def _approach(after_s: np.ndarray, value: float, target: float, lag_s: float, limit: float
              ) -> tuple[np.ndarray, np.ndarray]:
    """(a value on its way to a constant target, its integral): at the limit's rate, then exponential."""
    off = target - value
    limited_s = max(0.0, abs(off) / limit - lag_s)
    rate = math.copysign(limit, off) if limited_s else 0.0
    early = np.minimum(after_s, limited_s)
    left, late_s = off - rate * limited_s, after_s - early
    share = np.exp(-late_s / lag_s) if lag_s > 0.0 else np.where(late_s > 0.0, 0.0, 1.0)
    is_late = after_s > limited_s
    values = np.where(is_late, target - left * share, value + rate * early)
    summed = value * early + 0.5 * rate * early**2 + target * late_s - left * lag_s * (1.0 - share)
    if lag_s == 0.0 and not limited_s and len(values) > 1:
        values[0] = value
    return values, summed


def _grid(time_s: np.ndarray, shift_s: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(instants at most STEP_S apart that hold all lines and all changes of commands, which come so much later than
    their lines; the line whose command holds from each on; the line that each follows)."""
    changes = time_s + shift_s
    inside = changes[(changes > time_s[0] + TINY_S) & (changes < time_s[-1] - TINY_S)]
    edges = np.unique(np.concatenate([time_s, inside])) if shift_s else time_s
    if shift_s:
        edges = np.concatenate([edges[:1], edges[1:][np.diff(edges) > TINY_S]])
        edges[-1] = time_s[-1]
    counts = np.maximum(1, np.ceil(np.diff(edges) / STEP_S - 1e-9)).astype(int)
    part = np.repeat(np.arange(len(counts)), counts)
    number = np.arange(len(part)) - np.repeat(np.cumsum(counts) - counts, counts)
    grid = np.append(edges[part] + number * (np.diff(edges) / counts)[part], edges[-1])
    row = np.clip(np.searchsorted(changes, grid + TINY_S, "right") - 1, 0, len(time_s) - 1)
    return grid, row, np.clip(np.searchsorted(time_s, grid + TINY_S, "right") - 1, 0, len(time_s) - 1)


def _first_speed(log: Log, otherwise: float) -> float:
    """By the first poses: a log may begin while the robot moves."""
    if log.pose is None:
        return otherwise
    end = min(max(int(np.searchsorted(log.time_s, START_S)), 1), len(log.time_s) - 1)
    speed = float(np.hypot(*(log.pose[end] - log.pose[0])[:2]) / (log.time_s[end] - log.time_s[0]))
    return math.copysign(speed, otherwise)


def first_bend(log: Log) -> float | None:
    """Turn for each metre of the first poses: the wheels of a log that begins on the way are somewhere."""
    if log.pose is None or not log.has_heading:
        return None
    end = min(max(int(np.searchsorted(log.time_s, START_S)), 1), len(log.time_s) - 1)
    moved = log.pose[end] - log.pose[0]
    way = float(np.hypot(moved[0], moved[1]))
    return float(moved[2]) / way if way > LEAST_WAY_M else None


def seen_by_tracker(path: np.ndarray, time_s: np.ndarray, log: Log, point: tuple[float, float],
                    own: OfLog) -> np.ndarray:
    """Poses of the tracker as a log has them, of the body's path at `time_s`; from no certain place. Commands have been
    shifted by the clocks already."""
    lag_s = 0.0 if by_commands(log) else own.clock_lag_s
    x, y, heading = late(path, time_s, log.time_s, lag_s, _held_ends(log)).T
    cos, sin = np.cos(heading), np.sin(heading)
    ahead, left = point[0] + own.tracker_x_m, point[1] + own.tracker_y_m
    return np.column_stack([x + cos * ahead - sin * left, y + sin * ahead + cos * left,
                            heading + own.tracker_heading_rad])


def _held_ends(log: Log) -> tuple[bool, bool]:
    """Whether the log repeats its first pose, and its last: who joined it had none there."""
    if log.pose is None or len(log.pose) < 2:
        return False, False
    places = log.pose[:, :2]
    return bool((places[0] == places[1]).all()), bool((places[-1] == places[-2]).all())


def late(path: np.ndarray, time_s: np.ndarray, wanted_s: np.ndarray, lag_s: float,
         held: tuple[bool, bool] = (False, False)) -> np.ndarray:
    """A path so much earlier than wanted; before its first instant and after its last it goes straight on, or stays
    where the log holds its poses."""
    if lag_s == 0.0 and len(time_s) == len(wanted_s):
        return path
    at = np.clip(wanted_s - lag_s, time_s[0] if held[0] else -np.inf, time_s[-1] if held[1] else np.inf)
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
    """The parts of a log between its gaps, each a run of its own: nothing is integrated over gaps. A remark says so."""
    steps = np.diff(log.time_s)
    ends = np.flatnonzero(steps > max(GAP_S, GAP * float(np.median(steps)))) + 1
    if not len(ends) or log.part:
        return [log]
    edges = [0, *ends.tolist(), len(log.time_s)]
    pieces = [(low, high) for low, high in zip(edges[:-1], edges[1:], strict=True)
              if high - low >= LEAST_ROWS and _moves(log, low, high)]
    if not pieces:
        raise BadInput(f"{log.path}: has no part of {LEAST_ROWS} lines in which the robot moves between its "
                       f"{counted(len(ends), 'gap')}; record lines at least every {GAP_S:g} s")
    lost = len(log.time_s) - sum(high - low for low, high in pieces)
    remark = (f"{counted(len(ends), 'gap')} in it, the longest {steps.max():.3g} s from "
              f"{log.time_s[steps.argmax()]:.3f} s on: nothing is integrated over gaps; "
              f"{counted(len(pieces), 'part')} of at least {LEAST_ROWS} lines with motion counts separately"
              + (f", {counted(lost, 'line')} between gaps are left out" if lost else ""))
    found = [_sliced(log, low, high, f"part {number}") for number, (low, high) in enumerate(pieces, 1)]
    if found:
        found[0] = replace(found[0], remarks=(*found[0].remarks, remark))
    return found


def _moves(log: Log, low: int, high: int) -> bool:
    """Whether there is a way to compare; without a true pose there is none to compare with anyway."""
    return log.pose is None or bool(np.ptp(log.pose[low:high, :2], axis=0).max() > LEAST_WAY_M)


def _sliced(log: Log, low: int, high: int, name: str) -> Log:
    """Lines of a log; the remarks stay with the first part."""
    changed: dict[str, Any] = {key: value[low:high] for key, value in vars(log).items()
                               if isinstance(value, np.ndarray) and key not in ("pose_rows", "time_s")}
    seen = log.seen
    rows = None if log.pose_rows is None else seen[(seen >= low) & (seen < high)] - low
    return replace(log, time_s=log.time_s[low:high] - log.time_s[low], pose_rows=rows, counter=None, part=name,
                   remarks=log.remarks if name == "part 1" else (), **changed)
