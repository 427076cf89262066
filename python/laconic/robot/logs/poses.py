"""True poses: quaternions, latitudes, trackers that sit somewhere on the robot or are late, displacements."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from laconic.errors import BadInput
from laconic.robot.logs.log import Log
from laconic.robot.logs.quantity import Quantity
from laconic.robot.logs.rows import Sampled, fresh
from laconic.robot.logs.units import LATITUDE, OF_QUANTITY

TILTED_RAD = np.radians(20.0)    # a robot on the ground does not lean so far
WGS84_A_M, WGS84_E2 = 6378137.0, 6.69437999014e-3

Place = Callable[[int], str]


def with_heading(path: Path, values: np.ndarray, order: str, place: Place) -> tuple[np.ndarray, str | None]:
    """(x, y, heading of poses with a quaternion, a remark where the robot leans); BadInput for one of no length."""
    parts = values[:, 2:]
    if parts.shape[1] == 2:  # z and w: the robot stays upright
        x, y, z, w = np.zeros(len(parts)), np.zeros(len(parts)), parts[:, 0], parts[:, 1]
    else:
        by_name = dict(zip(order, parts.T, strict=True))
        x, y, z, w = (by_name[name] for name in "xyzw")
    square = x * x + y * y + z * z + w * w
    if (square == 0.0).any():
        raise BadInput(f"{path}: {place(int(np.argmax(square == 0.0)))}: the quaternion of pose is 0 in all parts, "
                       "which is no heading; repair the line")
    heading = np.arctan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z)
    upright = 1.0 - 2.0 * (x * x + y * y) / np.where(square > 0.0, square, 1.0)
    lean = float(np.arccos(np.clip(np.nanmin(upright, initial=1.0), -1.0, 1.0)))
    remark = (f"pose leans by up to {np.degrees(lean):.0f}°, of which the heading alone is used; check the order of "
              "the quaternion's parts, or the frame of the tracker") if lean > TILTED_RAD else None
    return np.column_stack([values[:, :2], heading]), remark


def in_metres(values: np.ndarray, units: tuple[str, ...]) -> tuple[np.ndarray, str]:
    """(positions east and north of the first latitude and longitude, a remark that names it)."""
    latitude, longitude = np.radians(values.T if units[0] == LATITUDE else values.T[::-1])
    first = int(np.argmax(~np.isnan(latitude)))
    size = 1.0 - WGS84_E2 * np.sin(latitude[first]) ** 2
    north = WGS84_A_M * (1.0 - WGS84_E2) / size**1.5 * (latitude - latitude[first])
    east = WGS84_A_M / np.sqrt(size) * np.cos(latitude[first]) * (longitude - longitude[first])
    return np.column_stack([east, north]), (
        f"pose is in metres east and north of latitude {np.degrees(latitude[first]):.7f}°, longitude "
        f"{np.degrees(longitude[first]):.7f}°")


def of_robot(values: np.ndarray, mount: tuple[float, float, float]) -> np.ndarray:
    """The pose of the body's frame by that of a tracker on it."""
    heading = values[:, 2] - mount[2]
    cos, sin = np.cos(heading), np.sin(heading)
    return np.column_stack([values[:, 0] - cos * mount[0] + sin * mount[1],
                            values[:, 1] - sin * mount[0] - cos * mount[1], heading])


def earlier(time_s: np.ndarray, values: np.ndarray, lag_s: float) -> np.ndarray:
    """The poses at the instants of the log, of a tracker that states each of them so much too late."""
    found = np.full(values.shape, np.nan)
    there = np.flatnonzero(~np.isnan(values).any(axis=1))
    wanted = there[(time_s[there] + lag_s >= time_s[there[0]]) & (time_s[there] + lag_s <= time_s[there[-1]])]
    found[wanted] = at_times(time_s[wanted] + lag_s, time_s[there], values[there])
    return found


def scaled(quantity: Quantity, values: np.ndarray) -> np.ndarray:
    """By the units and scales of columns that are no angles or speeds of a wheel."""
    units = [known[unit] for unit, known in zip(quantity.units, OF_QUANTITY[quantity.name], strict=False)]
    factor = np.array(quantity.scales) * np.array(units)
    with np.errstate(over="ignore"):
        found: np.ndarray = values * factor + np.array(quantity.offsets)
        return found


def with_pose(log: Log, quantity: Quantity, sampled: Sampled, values: np.ndarray, time_s: np.ndarray,
               rows: np.ndarray) -> Log:
    """The log with its true pose; a heading that was not recorded is NaN."""
    lever = quantity.mount[:2] if quantity.mount is not None and values.shape[1] == 2 else None
    log = replace(log, pose_point=quantity.point if lever is None else lever, pose_rows=fresh(sampled.values, rows))
    if quantity.kind == "body-increments":
        moved, poses = placed_at(sampled.values, time_s, rows)
        return replace(log, pose=poses, moved=moved)
    if values.shape[1] == 2:
        values = np.column_stack([values, np.full(len(values), np.nan)])
    return replace(log, pose=values)


def placed_at(scaled: np.ndarray, time_s: np.ndarray, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(displacements summed, poses) at rows, from displacements at some samples in the frame of the one before."""
    there = np.flatnonzero(~np.isnan(scaled[:, 0]))
    summed, poses = np.cumsum(scaled[there], axis=0), placed(scaled[there])
    if np.array_equal(rows, there):
        return summed, poses
    return at_times(time_s[rows], time_s[there], summed), at_times(time_s[rows], time_s[there], poses)


def at_times(wanted_s: np.ndarray, known_s: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Columns of values, interpolated."""
    return np.column_stack([np.interp(wanted_s, known_s, column) for column in values.T])


def placed(moved: np.ndarray) -> np.ndarray:
    """Poses from displacements in the body's frame: each begins in the frame of the sample before."""
    steps = np.vstack([np.zeros(3), moved[1:]])
    heading = np.cumsum(steps[:, 2])
    before = heading - steps[:, 2]
    cos, sin = np.cos(before), np.sin(before)
    return np.column_stack([np.cumsum(cos * steps[:, 0] - sin * steps[:, 1]),
                            np.cumsum(sin * steps[:, 0] + cos * steps[:, 1]), heading])
