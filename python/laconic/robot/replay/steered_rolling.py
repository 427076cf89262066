"""Pure rolling of a vehicle with steered wheels, by the recorded angles of its hinges and wheels.

From sample to sample each wheel on the carriage, or on hinges whose angles are known, gives linear equations for the
motion of the body's frame: along its tread it rolls as far as it turned, along its axle it does not move. Rows are
distances on the ground; the motion is their least-squares fit. Wheels behind casters and trailers, whose angles
nobody recorded, are left out. A commanded speed is one more row: the way of the middle of the fixed axle.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from laconic.core.articulated import CARRIAGE
from laconic.errors import BadInput
from laconic.robot.logs.log import Log
from laconic.robot.replay.placing import fitted, start_of
from laconic.robot.replay.rolling import path_of, wheel_radii
from laconic.robot.replay.steered_signals import Driven, begun_at, driven, first_bend, of_log, seen_by_tracker
from laconic.scene import Scene
from laconic.simulation.loads import centre_of

STEERED = ("motor", "prescribed", "coordinated", "servo")
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
        run = self.driven(log)
        return self.placed(log, run.time_s, path_of(self.moved(log, run), np.zeros(3)))

    def driven(self, log: Log) -> Driven:
        """What drives the vehicle."""
        return driven(log, of_log(self.scene.vehicle), len(self.scene.vehicle["wheel"]), self._first_angle(log))

    def _first_angle(self, log: Log) -> float | None:
        """Of a wheel on the middle line, by the first poses."""
        own = [body["hinge_x_m"] for hinge, body in zip(self.scene.hinges, self.scene.vehicle["body"], strict=True)
               if hinge.kind in STEERED]
        fixed = fixed_wheels(self.scene.vehicle)
        bend = first_bend(log) if log.following.is_command and fixed and own else None
        if bend is None or log.steering_angle_rad is None or log.steering_angle_rad.shape[1] > 1:
            return None
        if log.speed_m_per_s is not None and log.speed_m_per_s[0] < 0.0:
            bend = -bend
        return math.atan(bend * (float(np.mean(own)) - self.driven_point()[0].real))

    def placed(self, log: Log, time_s: np.ndarray, path: np.ndarray) -> np.ndarray:
        """A path of the body's frame as the log's tracker sees it, where the log says that it was."""
        point = log.pose_point
        place = point if not isinstance(point, str) else (0.0, 0.0) if point == "origin" else (
            self._centre.real, self._centre.imag)
        seen = seen_by_tracker(path, time_s, log, place, of_log(self.scene.vehicle))
        if log.pose is not None and not log.has_heading:
            return fitted(seen, log.seen, log.pose[log.seen, :2])
        return begun_at(seen, start_of(log))

    def moved(self, log: Log, run: Driven | None = None) -> np.ndarray:
        """Displacements x, y, angle of the body's frame from instant to instant, in it."""
        run = self.driven(log) if run is None else run
        table, given = self._equations(*self._turns(log, run), run)
        normal = np.einsum("nij,nik->njk", table, table)
        right = np.einsum("nij,ni->nj", table, given)
        size = np.trace(normal, axis1=1, axis2=2) / 3.0
        weak = ~(np.abs(np.linalg.det(normal)) > LEAST * size**3)
        if table.shape[1] < 3 or (weak.all() and _undetermined(table)):
            raise BadInput(f"{log.path}: its wheels and steering angles do not determine the motion; name more of them "
                           "in the map, [steering_angle] and [wheel_angle]")
        normal[weak] = np.eye(3)
        found: np.ndarray = np.linalg.solve(normal, right[:, :, None])[:, :, 0]
        if weak.any():
            found[weak] = (np.linalg.pinv(table[weak], rcond=LEAST) @ given[weak][:, :, None])[:, :, 0]
        return found

    def _turns(self, log: Log, run: Driven) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
        """Of each hinge: its mean angle from instant to instant, and how far it turns."""
        return self.hinge_angles(log, run.between_rad), {
            name: np.diff(angle) for name, angle in self.hinge_angles(log, run.steering_rad).items()}

    def _equations(self, angles: Mapping[str, np.ndarray], turned: Mapping[str, np.ndarray],
                   run: Driven) -> tuple[np.ndarray, np.ndarray]:
        rows, sides = list[np.ndarray](), list[np.ndarray]()
        count, rotation, lines = len(run.time_s) - 1, run.rotation_rad, set[tuple[str, float, float]]()
        measured = ~np.isnan(rotation).any(axis=0)
        for index, wheel in enumerate(self.scene.vehicle["wheel"]):
            placed = self._placed(wheel, angles, turned, count)
            if placed is None:
                continue
            place, axle, swept = placed
            rolled = self._radii[index] * rotation[:, index]
            if "roller_rad" in wheel:  # its rollers take no force across their axes
                along = axle * np.exp(1j * wheel["roller_rad"])
                if measured[index]:
                    _add(rows, sides, along, place, rolled * (np.conj(along) * 1j * axle).real, swept)
                continue
            line = _axle_line(wheel)
            if measured[index] or line not in lines:  # again, it would say nothing new
                _add(rows, sides, axle, place, np.zeros(count), swept)
                lines.add(line)
            if measured[index]:
                _add(rows, sides, 1j * axle, place, rolled, swept)
        if run.way_m is not None:
            place, direction = (np.full(count, each) for each in self.driven_point())
            _add(rows, sides, direction, place, run.way_m, np.zeros(count, complex))
        if not rows:
            return np.zeros((count, 0, 3)), np.zeros((count, 0))
        return np.stack(rows, axis=1), np.stack(sides, axis=1)

    def rotations(self, log: Log, run: Driven, moved: np.ndarray) -> np.ndarray:
        """How far each wheel turns while the body moves so; NaN of wheels behind hinges without an angle."""
        angles, turned = self._turns(log, run)
        found = np.full((len(moved), len(self._radii)), np.nan)
        for index, wheel in enumerate(self.scene.vehicle["wheel"]):
            placed = self._placed(wheel, angles, turned, len(moved))
            if placed is not None:
                place, axle, swept = placed
                way = moved[:, 0] + 1j * moved[:, 1] + 1j * moved[:, 2] * place + swept
                found[:, index] = (np.conj(1j * axle) * way).real / self._radii[index]
        return found

    def driven_point(self) -> tuple[complex, complex]:
        """The middle of the fixed axle (the origin where there is none), and the direction of its way."""
        fixed = fixed_wheels(self.scene.vehicle)
        if not fixed:
            return 0j, 1.0 + 0j
        return complex(*np.mean([(wheel["x_m"], wheel["y_m"]) for wheel in fixed], axis=0)), 1.0 + 0j

    def hinge_angles(self, log: Log, values: np.ndarray | None = None) -> dict[str, np.ndarray]:
        """The angle of each hinge that the log says; BadInput where columns and hinges do not fit."""
        if values is None:
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
        listed = f" ({', '.join(names)})" if names else ""
        raise BadInput(f"{log.path}: has {width} steering angles, the scene {len(names)} steered hinges"
                       f"{listed}; name those of the columns in the map: hinges = "
                       f"[...] in [steering_angle], of {', '.join(self._bodies)}")

    def _of_middle(self, angle: np.ndarray, names: list[str]) -> dict[str, np.ndarray]:
        """Angles of coordinated wheels where the log has that of a wheel on the middle line in their place."""
        places = np.array([(self._bodies[name]["hinge_x_m"], self._bodies[name]["hinge_y_m"]) for name in names])
        axle_x_m = self.driven_point()[0].real
        curvature = np.tan(angle) / (float(places[:, 0].mean()) - axle_x_m)
        return {name: np.arctan2(curvature * (x - axle_x_m), 1.0 - curvature * y)
                for name, (x, y) in zip(names, places, strict=True)}

    def _placed(self, wheel: Mapping[str, Any], angles: Mapping[str, np.ndarray], turned: Mapping[str, np.ndarray],
                count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
        """Place and axle of a wheel in the body's frame, midway from sample to sample, and how far turning hinges
        moved it; None where a hinge that carries it has no angle."""
        place = np.full(count, complex(wheel["x_m"], wheel["y_m"]))
        axle = np.full(count, complex(math.cos(wheel["axle_rad"]), math.sin(wheel["axle_rad"])))
        swept, name = np.zeros(count, complex), wheel.get("body", CARRIAGE)
        while name != CARRIAGE:
            if name not in angles:
                return None
            body, turn = self._bodies[name], np.exp(1j * angles[name])
            swept = turn * (swept + 1j * turned[name] * place)
            place = complex(body["hinge_x_m"], body["hinge_y_m"]) + turn * place
            axle, name = turn * axle, body["parent"]
        return place, axle, swept


def fixed_wheels(vehicle: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """Those on the carriage that roll ahead."""
    return [wheel for wheel in vehicle["wheel"]
            if wheel.get("body", CARRIAGE) == CARRIAGE and abs(math.cos(wheel["axle_rad"])) < LEAST]


def _axle_line(wheel: Mapping[str, Any]) -> tuple[str, float, float]:
    """The body and the line that the axle is on; wheels of one line do not slide along it alike."""
    axle = complex(math.cos(wheel["axle_rad"]), math.sin(wheel["axle_rad"]))
    if abs(axle.real) > abs(axle.imag):
        axle *= math.copysign(1.0, axle.real)
    else:
        axle *= math.copysign(1.0, axle.imag)
    off = (np.conj(1j * axle) * complex(wheel["x_m"], wheel["y_m"])).real
    return str(wheel.get("body", CARRIAGE)), round(math.atan2(axle.imag, axle.real), 9), round(float(off), 9)


def _undetermined(table: np.ndarray) -> bool:
    sizes = np.linalg.svd(table, compute_uv=False)
    return bool((sizes[:, -1] < LEAST * sizes[:, 0]).all())


def _add(rows: list[np.ndarray], sides: list[np.ndarray], direction: np.ndarray, place: np.ndarray,
         distance: np.ndarray, swept: np.ndarray) -> None:
    """The equation that a point of the body moves so far in a direction."""
    turning = (np.conj(direction) * 1j * place).real
    rows.append(np.column_stack([direction.real, direction.imag, turning]))
    sides.append(distance - (np.conj(direction) * swept).real)
