"""Frames as 4 × 4 matrices [rotation, translation; 0, 1]: they take coordinates of a frame to those of its parent."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

Array = np.ndarray
IDENTITY = np.eye(4)


def placement(xyz: Sequence[float] = (0.0, 0.0, 0.0), rotation: Array | None = None) -> Array:
    """The frame at `xyz`, turned by a 3 × 3 rotation."""
    frame = np.eye(4)
    frame[:3, 3] = xyz
    if rotation is not None:
        frame[:3, :3] = rotation
    return frame


def rotation_of_rpy(roll: float, pitch: float, yaw: float) -> Array:
    """About the fixed x, then y, then z axis, as URDF and SDF turn."""
    (cr, sr), (cp, sp), (cy, sy) = ((np.cos(a), np.sin(a)) for a in (roll, pitch, yaw))
    return np.array([[cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
                     [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
                     [-sp, cp * sr, cp * cr]])


def rotation_of_quaternion(w: float, x: float, y: float, z: float) -> Array:
    """Of a quaternion of any length but 0."""
    w, x, y, z = np.array([w, x, y, z]) / np.linalg.norm([w, x, y, z])
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def rotation_about(axis: Array, angle_rad: float) -> Array:
    """About a unit vector (Rodrigues)."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle_rad) * cross + (1.0 - np.cos(angle_rad)) * (cross @ cross)


def inverse(frame: Array) -> Array:
    """The way back."""
    back = np.eye(4)
    back[:3, :3] = frame[:3, :3].T
    back[:3, 3] = -frame[:3, :3].T @ frame[:3, 3]
    return back


def point_of(frame: Array, xyz: Sequence[float] | Array = (0.0, 0.0, 0.0)) -> Array:
    """A point, or N × 3 points, of the frame, in the coordinates of its parent."""
    return np.asarray(xyz, float) @ frame[:3, :3].T + frame[:3, 3]
