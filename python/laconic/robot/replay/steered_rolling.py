"""Pure rolling of a vehicle with steered wheels, by the recorded angles of its hinges and wheels.

From sample to sample each wheel on the carriage, or on hinges whose angles are known, gives linear equations for the
motion of the body's frame: along its tread it rolls as far as it turned, along its axle it does not move. Rows are
distances on the ground; the motion is their least-squares fit. Wheels behind casters and trailers, whose angles
nobody recorded, are left out.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from laconic.core.articulated import CARRIAGE
from laconic.errors import BadInput
from laconic.robot.logs.log import Log
from laconic.robot.replay.placing import fitted_to, start_of
from laconic.robot.replay.rolling import at_point, path_of, wheel_radii
from laconic.scene import Scene
from laconic.simulation.loads import centre_of

STEERED = ("motor", "prescribed", "coordinated")
LEAST = 1e-6       # of the largest singular value: the motion is determined


class SteeredRolling:
    """Makes rotations of wheels and angles of hinges motions of the body."""

    def __init__(self, scene: Scene):
        self.scene = scene
        self._bodies: dict[str, Mapping[str, Any]] = {
            hinge.name: body for hinge, body in zip(scene.hinges, scene.vehicle["body"], strict=True)}
        self._radii = wheel_radii(scene.vehicle)
        self._centre = centre_of(scene.vehicle)

    def path(self, log: Log) -> np.ndarray:
        """Predicted poses at the samples' times, from the true first pose; placed to fit where the log has positions
        alone."""
        steps = at_point(self.moved(log), log.pose_point, (self._centre.real, self._centre.imag))
        return fitted_to(log, path_of(steps, start_of(log)))

    def moved(self, log: Log) -> np.ndarray:
        """Displacements x, y, angle of the body's frame from sample to sample, in it."""
        angles, rotation = self.hinge_angles(log), log.rotation_rad()
        rows, sides = list[np.ndarray](), list[np.ndarray]()
        for index, wheel in enumerate(self.scene.vehicle["wheel"]):
            placed = self._placed(wheel, angles, len(rotation))
            if placed is None:
                continue
            place, axle, swept = placed
            rolled = self._radii[index] * rotation[:, index]
            if "roller_rad" in wheel:  # its rollers take no force across their axes
                along = axle * np.exp(1j * wheel["roller_rad"])
                if not np.isnan(rolled).any():
                    _add(rows, sides, along, place, rolled * (np.conj(along) * 1j * axle).real, swept)
                continue
            _add(rows, sides, axle, place, np.zeros(len(rotation)), swept)
            if not np.isnan(rolled).any():
                _add(rows, sides, 1j * axle, place, rolled, swept)
        table, given = np.stack(rows, axis=1), np.stack(sides, axis=1)
        sizes = np.linalg.svd(table, compute_uv=False)
        if table.shape[1] < 3 or (sizes[:, -1] < LEAST * sizes[:, 0]).all():
            raise BadInput(f"{log.path}: its wheels and steering angles do not determine the motion; name more of them "
                           "in the map, [steering_angle] and [wheel_angle]")
        found: np.ndarray = (np.linalg.pinv(table, rcond=LEAST) @ given[:, :, None])[:, :, 0]
        return found

    def hinge_angles(self, log: Log) -> dict[str, np.ndarray]:
        """The angle of each hinge that the log says; BadInput where columns and hinges do not fit."""
        values = log.needs("steering_angle_rad", "rolling of a steered vehicle")
        steered = [hinge for hinge in self.scene.hinges if hinge.kind in STEERED]
        names, width = [hinge.name for hinge in steered], values.shape[1]
        wanted = log.hinge_names or tuple(names)
        if unknown := [name for name in wanted if name not in self._bodies]:
            raise BadInput(f"{self.scene.path}: has no hinge {unknown[0]}; give hinges of the map [steering_angle] as "
                           f"the scene names them: {', '.join(self._bodies)}")
        if len(wanted) == width:
            return dict(zip(wanted, values.T, strict=True))
        coordinated = [hinge.name for hinge in steered if hinge.kind == "coordinated"]
        if width == 1 and coordinated and not log.hinge_names:
            return self._of_middle(values[:, 0], coordinated)
        raise BadInput(f"{log.path}: has {width} steering angles, the scene {len(names)} steered hinges "
                       f"({', '.join(names)}); name those of the columns in the map: hinges = [...] in "
                       "[steering_angle]")

    def _of_middle(self, angle: np.ndarray, names: list[str]) -> dict[str, np.ndarray]:
        """Angles of coordinated wheels where the log has that of a wheel on the middle line in their place."""
        places = np.array([(self._bodies[name]["hinge_x_m"], self._bodies[name]["hinge_y_m"]) for name in names])
        fixed = [wheel for wheel in self.scene.vehicle["wheel"]
                 if wheel.get("body", CARRIAGE) == CARRIAGE and abs(math.cos(wheel["axle_rad"])) < LEAST]
        axle_x_m = float(np.mean([wheel["x_m"] for wheel in fixed])) if fixed else 0.0
        curvature = np.tan(angle) / (float(places[:, 0].mean()) - axle_x_m)
        return {name: np.arctan2(curvature * (x - axle_x_m), 1.0 - curvature * y)
                for name, (x, y) in zip(names, places, strict=True)}

    def _placed(self, wheel: Mapping[str, Any], angles: Mapping[str, np.ndarray], count: int
                ) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
        """Place and axle of a wheel in the body's frame, midway from sample to sample, and how far turning hinges
        moved it; None where a hinge that carries it has no angle."""
        place = np.full(count, complex(wheel["x_m"], wheel["y_m"]))
        axle = np.full(count, complex(math.cos(wheel["axle_rad"]), math.sin(wheel["axle_rad"])))
        swept, name = np.zeros(count, complex), wheel.get("body", CARRIAGE)
        while name != CARRIAGE:
            if name not in angles:
                return None
            body, angle = self._bodies[name], angles[name]
            turn = np.exp(0.5j * (angle[1:] + angle[:-1]))
            swept = turn * (swept + 1j * np.diff(angle) * place)
            place = complex(body["hinge_x_m"], body["hinge_y_m"]) + turn * place
            axle, name = turn * axle, body["parent"]
        return place, axle, swept


def _add(rows: list[np.ndarray], sides: list[np.ndarray], direction: np.ndarray, place: np.ndarray,
         distance: np.ndarray, swept: np.ndarray) -> None:
    """The equation that a point of the body moves so far in a direction."""
    turning = (np.conj(direction) * 1j * place).real
    rows.append(np.column_stack([direction.real, direction.imag, turning]))
    sides.append(distance - (np.conj(direction) * swept).real)
