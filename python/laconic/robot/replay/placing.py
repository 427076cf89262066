"""Where a predicted path begins: at the true first pose, or, where positions alone were recorded, where it fits them.

GPS and total stations have no heading. A path from wheels has a shape and no place, so it is turned and moved as a
rigid body until the squared distances to the positions are least.
"""

from __future__ import annotations

import numpy as np

from laconic.robot.logs.log import Log


def start_of(log: Log) -> np.ndarray:
    """The true first pose; the origin where no heading was recorded."""
    if log.pose is None or not log.has_heading:
        return np.zeros(3)
    first: np.ndarray = log.pose[0]
    return first


def fitted_to(log: Log, path: np.ndarray) -> np.ndarray:
    """A path that began at start_of(log): as it is, or where it fits recorded positions."""
    if log.pose is None or log.has_heading:
        return path
    return fitted(path, log.seen, log.pose[log.seen, :2])


def fitted(path: np.ndarray, rows: np.ndarray, positions: np.ndarray) -> np.ndarray:
    """A path x, y, heading turned and moved to positions at some of its rows."""
    own = path[rows, :2]
    middle, wanted = own.mean(axis=0), positions.mean(axis=0)
    own, other = own - middle, positions - wanted
    angle = np.arctan2((own[:, 0] * other[:, 1] - own[:, 1] * other[:, 0]).sum(), (own * other).sum())
    cos, sin = np.cos(angle), np.sin(angle)
    x, y = (path[:, :2] - middle).T
    return np.column_stack([wanted[0] + cos * x - sin * y, wanted[1] + sin * x + cos * y, path[:, 2] + angle])
