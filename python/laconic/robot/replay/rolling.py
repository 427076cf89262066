"""Pure rolling: the path that the recorded rotation of the wheels gives, by the core's own matrices.

The wheels' speeds are s = Ξ ν for every ν that the constraints C allow. With more wheels than directions the recorded
ones never fit exactly; the motion is then the one that fits them best in the least-squares sense of distances on the
ground, R_i s_i. Between two samples the body's velocity is taken as constant and the pose follows exactly.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from laconic.core import Core
from laconic.errors import BadInput
from laconic.robot.logs.log import POINTS, Log, Point
from laconic.robot.replay.placing import fitted_to, start_of


@dataclass(frozen=True)
class Rolling:
    """What makes rotations of the wheels motions of the body: (x, y [m], angle [rad]) = per_rotation · rotations."""

    scene_path: Path
    radii_m: np.ndarray            # of each wheel
    distance_rows: np.ndarray      # N × k: distances on the ground for each of the k motions that are allowed
    origin: np.ndarray             # 3 × k: x, y [m], angle [rad] of the body's origin for each of them
    centre_of_mass: np.ndarray     # x, y in the body's frame

    @cached_property
    def per_rotation(self) -> np.ndarray:
        """3 × N, of the body's origin, from all wheels."""
        return self.from_wheels(np.full(len(self.radii_m), True))

    def from_wheels(self, measured: np.ndarray) -> np.ndarray:
        """3 × N from some of the wheels, 0 for the others; BadInput where those do not determine the motion."""
        rows = self.distance_rows[measured]
        if np.linalg.matrix_rank(rows, tol=1e-9 * self.radii_m.max(initial=0.0)) < rows.shape[1]:
            which = "wheel" if measured.all() else "measured wheel"
            raise BadInput(f"{self.scene_path}: its {which} speeds do not determine its motion; rolling needs wheels "
                           "that turn whatever the motion")
        found = np.zeros((3, len(measured)))
        found[:, measured] = self.origin @ np.linalg.pinv(rows) * self.radii_m[measured]
        return found

    def moved(self, rotation_rad: np.ndarray, point: Point = POINTS[0]) -> np.ndarray:
        """Displacements of a point from sample to sample in the body's frame, one row each; NaN: not measured."""
        measured = ~np.isnan(rotation_rad).any(axis=0)
        steps: np.ndarray = rotation_rad @ self.per_rotation.T if measured.all() else (
            np.where(measured, rotation_rad, 0.0) @ self.from_wheels(measured).T)
        return at_point(steps, point, self.centre_of_mass)

    def path(self, log: Log, start: np.ndarray | None = None) -> np.ndarray:
        """Predicted poses x, y, heading at the samples' times, from the true first pose (or from `start`); placed to
        fit where the log has positions alone."""
        path = path_of(self.moved(log.rotation_rad(), log.pose_point), start_of(log) if start is None else start)
        return fitted_to(log, path) if start is None else path


def at_point(steps: np.ndarray, point: Point, centre_of_mass: Sequence[float] | np.ndarray) -> np.ndarray:
    """Displacements of a point, from those of the body's origin."""
    if point == POINTS[0]:
        return steps
    x, y = centre_of_mass if isinstance(point, str) else point
    found: np.ndarray = steps + steps[:, 2:] * np.array([-y, x, 0.0])
    return found


def path_of(moved: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Poses from displacements that are twists held from sample to sample: the exact arc for each."""
    half = 0.5 * moved[:, 2]
    heading = start[2] + np.concatenate([[0.0], np.cumsum(moved[:, 2])])
    middle = heading[:-1] + half
    chord = np.sinc(half / np.pi)  # sin(x)/x
    cos, sin = chord * np.cos(middle), chord * np.sin(middle)
    x = np.concatenate([[0.0], np.cumsum(cos * moved[:, 0] - sin * moved[:, 1])])
    y = np.concatenate([[0.0], np.cumsum(sin * moved[:, 0] + cos * moved[:, 1])])
    return np.column_stack([start[0] + x, start[1] + y, heading])


def rolling_of(core: Core, vehicle: Mapping[str, Any], path: Path) -> Rolling:
    """Pure rolling of a vehicle (the keys of `[vehicle]`); BadInput where its wheels do not determine its motion."""
    c_vehicle = core.vehicle(vehicle)
    matrices = core.matrices(c_vehicle)
    radii, reference = wheel_radii(vehicle), float(c_vehicle.wheel_radius_m)
    allowed = null_space(matrices.constraint_rows)
    distance_rows = radii[:, None] * (matrices.wheel_rows @ allowed)
    centre = centre_of_mass(core, c_vehicle)
    angle = allowed[2] / matrices.lambda_yaw
    # the origin's velocity is the centre of mass's less that of turning about it: v_O = v_S − θ' × c
    origin = [reference * allowed[0] + angle * centre[1], reference * allowed[1] - angle * centre[0], angle]
    found = Rolling(path, radii, distance_rows, np.array(origin), centre)
    assert found.per_rotation.shape == (3, len(radii))  # BadInput here, not with the first log
    return found


def rotations_of(core: Core, vehicle: Mapping[str, Any], moved: np.ndarray) -> np.ndarray:
    """Rotation of each wheel (columns) for displacements x, y, angle of the body's origin, one row each."""
    c_vehicle = core.vehicle(vehicle)
    matrices = core.matrices(c_vehicle)
    x, y = centre_of_mass(core, c_vehicle)
    centre = moved + moved[:, 2:] * np.array([-y, x, 0.0])
    nu = centre * np.array([1.0, 1.0, matrices.lambda_yaw * c_vehicle.wheel_radius_m]) / c_vehicle.wheel_radius_m
    found: np.ndarray = nu @ matrices.wheel_rows.T
    return found


def centre_of_mass(core: Core, c_vehicle: Any) -> np.ndarray:
    """x, y [m] in the body's frame, with the payload: the point to whose motion the core's matrices refer."""
    model = core.prepare(c_vehicle)
    return np.array([float(model.com_x_m), float(model.com_y_m)])


def wheel_radii(vehicle: Mapping[str, Any]) -> np.ndarray:
    """The radius of each wheel: its own, or the vehicle's."""
    return np.array([wheel.get("radius_m", vehicle["wheel_radius_m"]) for wheel in vehicle["wheel"]], dtype=float)


def null_space(rows: np.ndarray) -> np.ndarray:
    """The ν that the constraints allow, as columns."""
    if not len(rows):
        return np.eye(3)
    _, size, right = np.linalg.svd(rows)
    rank = int((size > 1e-9 * size[0]).sum())
    found: np.ndarray = right[rank:].T
    return found
