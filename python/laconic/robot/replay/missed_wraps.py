"""Counters that a log samples too seldom: a row in which a wheel turns by half the counter's range or more is read as
a smaller turn, or as one back. What else the log has shows it: the true pose, speeds of wheels, and other wheels."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations, product

import numpy as np

from laconic.errors import BadInput, Refused
from laconic.robot.logs import Log
from laconic.robot.logs.for_vehicle import carriage_of, for_carriage, for_vehicle, without_free
from laconic.robot.logs.log import POINTS
from laconic.robot.logs.wraps import REMEDY
from laconic.robot.replay.rolling import Rolling, rolling_of, rotations_of
from laconic.robot.replay.steered_signals import parts_of
from laconic.scene import Scene

HALF = 0.5       # of the range: a turn that is longer is read as another one
MISSED = 0.6     # of the range, that the evidence must differ by: a whole one, less what evidence is off
AROUND = 2       # rows before and after one, in whose middle the evidence counts: single ones may be noise
GAP = 2.0        # times the usual time between rows
AGREES = 0.05    # of the range: wheels that are right fit each other so well
CLEARLY = 0.2    # of the range, that wheels must contradict each other by


def rolled_alone(scene: Scene, *given: Sequence[Log]) -> tuple[Scene, list[list[Log]]]:
    """What rolls by the wheels' angles alone: the carriage and its logs where only casters and trailers hang on it, or
    the scene and the logs as they are."""
    carriage = carriage_of(scene, [log for logs in given for log in logs])
    if carriage is scene:
        return scene, [list(logs) for logs in given]
    return carriage, [[for_carriage(log, scene) for log in logs] for logs in given]


def fitting(scene: Scene, logs: Sequence[Log]) -> list[Log]:
    """The logs for the scene's vehicle; a remark names the first row whose counter missed a part of its range."""
    if scene.has_hinges:
        return [part for log in logs for part in parts_of(
            _examined(scene, without_free(for_vehicle(log, scene.vehicle), scene)))]
    return [_examined(scene, for_vehicle(log, scene.vehicle)) for log in logs]


def _examined(scene: Scene, log: Log) -> Log:
    if log.counter is None or log.wheel_angle_rad is None:
        return log
    remark = _remark(scene, log)
    return replace(log, counter=None, remarks=(*log.remarks, remark) if remark else log.remarks)


def _remark(scene: Scene, log: Log) -> str | None:
    assert log.counter is not None and log.wheel_angle_rad is not None
    turned = np.diff(log.wheel_angle_rad, axis=0) / log.counter.wrap_rad
    rolling = _rolling(scene)
    for what, expected in _evidence(scene, log, rolling):
        share = expected / log.counter.wrap_rad
        off = np.where(_gaps(log), share - turned, _middle(share - turned))
        rows = (np.abs(off) > MISSED) & (np.abs(share) > HALF - AGREES)
        if rows.any():
            row = int(np.argmax(rows.any(axis=1)))
            wheel = int(np.argmax(rows[row]))
            return _words(log, row, wheel, float(turned[row, wheel]), f"by {what} by {100.0 * share[row, wheel]:.0f} %",
                          int(rows.any(axis=1).sum()))
    return _by_other_wheels(rolling, log, turned)


def _words(log: Log, row: int, wheel: int, turned: float, instead: str, rows: int) -> str:
    counter = log.counter
    assert counter is not None
    more = f", and so in {rows} of {len(log.time_s) - 1} rows" if rows > 1 else ""
    return (f"{counter.place(row + 1)}: wheel {wheel + 1} turns by {100.0 * turned:.0f} % of {counter.said} in one "
            f"row, but {instead}{more}; a counter does not show more than half its range in a row, so its motion is "
            f"wrong; {REMEDY}")


def _gaps(log: Log) -> np.ndarray:
    """Rows that come much later than usual: a wheel turns further in them, so each one counts by itself."""
    steps = np.diff(log.time_s)
    return (steps > GAP * np.median(steps))[:, None]


def _middle(rows: np.ndarray) -> np.ndarray:
    """The median of each row and those around it; of steady noise it is small."""
    padded = np.pad(rows, ((AROUND, AROUND), (0, 0)), mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * AROUND + 1, axis=0)
    return np.asarray(np.median(windows, axis=2))


def _evidence(scene: Scene, log: Log, rolling: Rolling | None) -> list[tuple[str, np.ndarray]]:
    """What else tells the rotation of each wheel from row to row; of wheels on hinges a pose alone does not."""
    found = []
    if log.wheel_speed_rad_per_s is not None:
        speed = log.wheel_speed_rad_per_s
        found.append(("its speed", 0.5 * (speed[1:] + speed[:-1]) * np.diff(log.time_s)[:, None]))
    if log.pose is None or scene.has_hinges:
        return found
    if log.has_heading:
        found.append(("the pose", rotations_of(scene.core(), scene.vehicle, _moved(log, rolling))))
    elif rolling is not None:
        found.append(("the positions", _as_far(log, rolling)))
    return found


def _rolling(scene: Scene) -> Rolling | None:
    """None where wheels do not determine a motion, or the scene's vehicle is refused: others report that."""
    try:
        return rolling_of(scene.core(), scene.vehicle, scene.path)
    except (BadInput, Refused):
        return None


def _moved(log: Log, rolling: Rolling | None) -> np.ndarray:
    """Displacements of the body's origin from row to row in its own axes, by the true pose."""
    assert log.pose is not None
    steps = np.diff(log.pose, axis=0)
    half = 0.5 * steps[:, 2]
    cos, sin = np.cos(log.pose[:-1, 2] + half), np.sin(log.pose[:-1, 2] + half)
    x, y = cos * steps[:, 0] + sin * steps[:, 1], cos * steps[:, 1] - sin * steps[:, 0]
    moved = np.column_stack([x / np.sinc(half / np.pi), y / np.sinc(half / np.pi), steps[:, 2]])
    if log.pose_point == POINTS[0]:
        return moved
    point = log.pose_point if not isinstance(log.pose_point, str) else rolling.centre_of_mass if rolling else (0.0, 0.0)
    return np.asarray(moved - moved[:, 2:] * np.array([-point[1], point[0], 0.0]))


def _as_far(log: Log, rolling: Rolling) -> np.ndarray:
    """The rotations, lengthened to the way between two positions where they are much too short for it."""
    assert log.pose is not None
    rotations = log.rotation_rad()
    way = np.linalg.norm(np.diff(log.pose[:, :2], axis=0), axis=1)[:, None]
    rolled = np.linalg.norm(rolling.moved(rotations, log.pose_point)[:, :2], axis=1)[:, None]
    return np.where(rolled < 0.9 * way, way / rolling.radii_m, rotations)


def _by_other_wheels(rolling: Rolling | None, log: Log, turned: np.ndarray) -> str | None:
    """Of more wheels than motions: one or two that contradict the others, and with a whole range more agree."""
    assert log.counter is not None
    if rolling is None or np.isnan(turned).any() or rolling.distance_rows.shape[0] <= rolling.distance_rows.shape[1]:
        return None
    lengths = rolling.radii_m * log.counter.wrap_rad[0]
    rows = rolling.distance_rows
    contradiction = np.eye(len(lengths)) - rows @ np.linalg.pinv(rows)
    off = (turned * lengths) @ contradiction.T
    size = np.linalg.norm(off, axis=1)
    for row in np.flatnonzero(size > CLEARLY * lengths.min()):
        for missed in _missed(len(lengths)):
            share = turned[row] + missed
            left = off[row] + contradiction @ (missed * lengths)
            if np.linalg.norm(left) < AGREES * lengths.min() and np.abs(share).max() < 1.0:
                wheel = int(np.flatnonzero(missed)[0])
                return _words(log, int(row), wheel, float(turned[row, wheel]),
                              f"by the other wheels by {100.0 * share[wheel]:.0f} %", 1)
    return None


def _missed(wheels: int) -> Iterator[np.ndarray]:
    """Whole ranges that one wheel or two may have missed."""
    for count in (1, 2):
        for which in combinations(range(wheels), count):
            for senses in product((1.0, -1.0), repeat=count):
                missed = np.zeros(wheels)
                missed[list(which)] = senses
                yield missed
