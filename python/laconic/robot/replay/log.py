"""A recorded run with currents and set speeds, as the fit of friction needs it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from laconic.errors import BadInput
from laconic.robot.logs.column_map import MAPS, ColumnMap, read_map
from laconic.robot.logs.log import Log
from laconic.robot.logs.read import read_log as read_any

__all__ = ["DEFAULT_MAP", "ColumnMap", "Recording", "read_log", "read_map", "recording_of"]

DEFAULT_MAP = MAPS / "robotino.toml"
SMOOTHING = 2  # samples to either side for a speed from positions
WHY = "the fit of friction"


@dataclass(frozen=True)
class Recording:
    """One run; one row per sample, wheels in columns, everything at the wheel and in SI units."""

    name: str
    time_s: np.ndarray
    set_speed_rad_per_s: np.ndarray
    wheel_angle_rad: np.ndarray
    wheel_speed_rad_per_s: np.ndarray  # as recorded (quantised)
    current_A: np.ndarray              # signed: positive drives the wheel forward
    camera: np.ndarray | None          # x, y [m], angle [rad]: summed displacements in the robot's frame

    @property
    def smooth_speed_rad_per_s(self) -> np.ndarray:
        """Wheel speeds from the positions, over a few samples."""
        k, t, angle = SMOOTHING, self.time_s, self.wheel_angle_rad
        ahead = np.minimum(np.arange(len(t)) + k, len(t) - 1)
        behind = np.maximum(np.arange(len(t)) - k, 0)
        return (angle[ahead] - angle[behind]) / (t[ahead] - t[behind])[:, None]


def read_log(path: Path, columns: ColumnMap) -> Recording:
    """A recorded run; BadInput names the file, line and column that cannot be used."""
    return recording_of(read_any(path, columns))


def recording_of(log: Log) -> Recording:
    """A log with everything that the fit of friction needs; BadInput for one that lacks some of it."""
    if log.by_radius:
        raise BadInput(f"{log.path}: has wheels in metres, and {WHY} needs angles; give radius_m in the map")
    return Recording(log.stem, log.time_s, log.needs("set_speed_rad_per_s", WHY), log.needs("wheel_angle_rad", WHY),
                     log.needs("wheel_speed_rad_per_s", WHY), log.needs("current_A", WHY), camera_of(log))


def camera_of(log: Log) -> np.ndarray | None:
    """True displacements in the robot's frame, summed; None without a heading, which that frame needs."""
    if log.moved is not None or log.pose is None or not log.has_heading:
        return log.moved
    steps = np.diff(log.pose, axis=0)
    cos, sin = np.cos(log.pose[:-1, 2]), np.sin(log.pose[:-1, 2])
    moved = np.column_stack([cos * steps[:, 0] + sin * steps[:, 1], cos * steps[:, 1] - sin * steps[:, 0], steps[:, 2]])
    return np.vstack([np.zeros(3), np.cumsum(moved, axis=0)])
