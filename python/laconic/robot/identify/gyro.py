"""What runs with a gyro but without a true pose say about rolling: how far the robot turned.

They tell the wheels' radii over their distance, and nothing of lengths. The rate while the wheels stand before the
first motion is the gyro's offset.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from laconic.core import Core
from laconic.errors import BadInput
from laconic.robot.identify.parameter import Vehicle
from laconic.robot.logs import Log
from laconic.robot.replay.rolling import rolling_of

STRETCHES = 24
STANDS_RAD, LEAST_REST_S = 0.01, 0.5   # rotation of a wheel before which it stands; least time for an offset
LEAST_TURN_RAD = 0.1


def turned(log: Log) -> np.ndarray:
    """Heading by the gyro, from 0 on."""
    rate = log.needs("yaw_rate_rad_per_s", "identify without a true pose")
    rotation = np.nanmax(np.abs(np.cumsum(log.rotation_rad(), axis=0)), axis=1)
    still = int(np.argmax(rotation > STANDS_RAD)) if (rotation > STANDS_RAD).any() else len(rate) - 1
    offset = float(rate[:still].mean()) if log.time_s[still] - log.time_s[0] >= LEAST_REST_S else 0.0
    steps = 0.5 * (rate[1:] + rate[:-1] - 2.0 * offset) * np.diff(log.time_s)
    return np.concatenate([[0.0], np.cumsum(steps)])


class GyroEvidence:
    """Runs with yaw rates; residuals are headings, over all that the robot turned."""

    directions = 1
    difference = 0.0

    def __init__(self, core: Core, scene_path: Path, logs: Sequence[Log]):
        self._core, self._path, self._logs = core, scene_path, list(logs)
        self.sessions = [str(log.path.resolve().parent) for log in logs]
        self._headings = [turned(log) for log in logs]
        self._cuts = [np.unique(np.linspace(0, len(log.time_s) - 1, STRETCHES + 1).astype(int)) for log in logs]
        self._turns = [float(np.abs(np.diff(heading)).sum()) for heading in self._headings]
        for log, turn in zip(logs, self._turns, strict=True):
            if turn < LEAST_TURN_RAD:
                raise BadInput(f"{log.path}: turns by {turn:.2g} rad in all, so its gyro tells nothing; give runs with "
                               "turns, or a true pose")

    def _off(self, vehicle: Vehicle) -> list[np.ndarray]:
        """Heading errors at the cuts, over the whole turn."""
        rolling = rolling_of(self._core, vehicle, self._path)
        found = []
        for log, heading, cuts, turn in zip(self._logs, self._headings, self._cuts, self._turns, strict=True):
            rolled = np.concatenate([[0.0], np.cumsum(rolling.moved(log.rotation_rad())[:, 2])])
            found.append((rolled - heading)[cuts] / turn)
        return found

    def residuals(self, vehicle: Vehicle) -> list[np.ndarray]:
        """The mean of their squares is the run's squared error."""
        return [each[1:] / np.sqrt(len(each) - 1) for each in self._off(vehicle)]

    def errors(self, vehicle: Vehicle) -> list[np.ndarray]:
        """What each stretch turns too much."""
        return [np.diff(each)[:, None] for each in self._off(vehicle)]

    def scores(self, vehicle: Vehicle, jacobians: list[np.ndarray]) -> list[np.ndarray]:
        """Of each stretch: its error, carried to all headings after it, times the Jacobian there."""
        return [each * np.cumsum(jacobian[::-1], axis=0)[::-1] / np.sqrt(len(each))
                for each, jacobian in zip(self.errors(vehicle), jacobians, strict=True)]
