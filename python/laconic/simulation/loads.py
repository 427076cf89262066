"""Loads of the wheels of a vehicle with hinges, as it would stand still in its posture on level ground.

A vertical hinge carries the body's weight and its tipping moments, so all bodies on hinges stand as one with their
parents. The hitch of a trailer is a ball: it carries weight alone. Where more points carry than the balance needs, they
share as springs of one stiffness on a rigid body. An acceleration of the carriage shifts its weight as far as com_z_m
is high, as of a vehicle without hinges; bodies on hinges count as being at the ground.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from laconic.core.articulated import CARRIAGE, ArticulatedMotion, ArticulatedPlant
from laconic.scene import Scene
from laconic.scene.standing import NO_LOAD, Standing, why_points_tip

GRAVITY_M_PER_S2 = 9.80665
Places = Any  # one complex number, or an array of that of each row
Frame = tuple[Places, Places]  # origin and direction in the world
Weights = list[tuple[Places, Any]]  # where each acts, and how much


def centre_of(vehicle: Mapping[str, Any]) -> complex:
    """Centre of mass of body 0 with its payload, in the body frame."""
    x, y, payload = vehicle["com_x_m"], vehicle["com_y_m"], vehicle.get("payload")
    if not payload:
        return complex(x, y)
    own, more = vehicle["mass_kg"], payload["mass_kg"]
    whole = own + more
    return complex((own * x + more * payload["x_m"]) / whole, (own * y + more * payload["y_m"]) / whole)


class Loads:
    """What the loads of a scene's wheels need to know, and the loads in each posture."""

    def __init__(self, scene: Scene):
        vehicle, names = scene.vehicle, [CARRIAGE, *(hinge.name for hinge in scene.hinges)]
        forms = ["", *(hinge.form for hinge in scene.hinges)]
        self._names = names
        self._hinges = [complex(body["hinge_x_m"], body["hinge_y_m"]) for body in vehicle["body"]]
        self._centre = centre_of(vehicle)
        self.height_m = float(vehicle["com_z_m"])
        self._parents = [0, *(names.index(body["parent"]) for body in vehicle["body"])]
        self._group = [0] * len(names)  # the trailer, or the carriage, with which a body stands
        for b in range(1, len(names)):
            self._group[b] = b if forms[b] == "trailer" else self._group[self._parents[b]]
        self._weights = [(complex(each.get("com_x_m", 0.0), each.get("com_y_m", 0.0)),
                          GRAVITY_M_PER_S2 * each["mass_kg"]) for each in (vehicle, *vehicle["body"])]
        payload = vehicle.get("payload")
        self._payload = [(_place(payload), GRAVITY_M_PER_S2 * payload["mass_kg"])] if payload else []
        self._wheels = [(names.index(wheel.get("body", CARRIAGE)), _place(wheel)) for wheel in vehicle["wheel"]]
        self._of_group = {g: [i for i, (b, _) in enumerate(self._wheels) if self._group[b] == g]
                          for g in sorted(set(self._group), reverse=True)}
        self._supports = [_place(each) for each in vehicle["support"]]

    def origin_of(self, motion: ArticulatedMotion) -> tuple[float, float]:
        """The place of the body frame's origin."""
        return self._origin_at(motion.x_m, motion.y_m, motion.heading_rad)

    def origins_of(self, rows: ArticulatedMotion) -> np.ndarray:
        """The same of many rows (`ArticulatedVehicle.motion_of`), shape (rows, 2), with the same bits."""
        poses = np.stack([rows.x_m, rows.y_m, rows.heading_rad], axis=1)
        return np.array([self._origin_at(*pose) for pose in poses.tolist()])

    def _origin_at(self, x_m: float, y_m: float, heading_rad: float) -> tuple[float, float]:
        x, y = self._centre.real, self._centre.imag
        cosine, sine = math.cos(heading_rad), math.sin(heading_rad)
        return x_m - cosine * x + sine * y, y_m - sine * x - cosine * y

    def of(self, motion: ArticulatedMotion, acceleration_m_per_s2: Sequence[float] | np.ndarray = (0.0, 0.0)
           ) -> np.ndarray:
        """The load of each wheel [N], shape (N,); of motions of many rows (rows, N). The acceleration is that of body
        0's centre of mass, in its axes."""
        frames, acceleration = self._frames(motion), np.asarray(acceleration_m_per_s2)
        shift = -(acceleration[..., 0] + 1j * acceleration[..., 1]) * frames[0][1] * (self.height_m / GRAVITY_M_PER_S2)
        return self._carried(frames, shift)[0]

    def under(self, plant: ArticulatedPlant, motion: ArticulatedMotion, row: np.ndarray) -> np.ndarray:
        """The load of each wheel [N] with the acceleration by the inputs of a row; at height 0 it shifts no load."""
        return self.of(motion, plant.acceleration(row) if self.height_m else (0.0, 0.0))

    def standing(self, angles_rad: Sequence[float]) -> Standing:
        """How it stands with its hinges at these angles, and why it tips, or a trailer of it."""
        frames = self._frames_at(angles_rad)
        wheels, supports, weights = self._carried(frames)
        least = NO_LOAD * sum(newtons for _, newtons in weights)
        for g, of_group in self._of_group.items():
            for i in of_group if g else ():
                if wheels[i] < -least:
                    return Standing(tuple(wheels), tuple(supports),
                                    f"{self._names[g]} tips: wheel {i + 1} would have to pull with {-wheels[i]:.3g} N; "
                                    "move its centre of mass between its wheels and the hitch")
        of_carriage = self._of_group.get(0, [])
        points = [_at(frames[b], place) for b, place in (self._wheels[i] for i in of_carriage)]
        points += [_at(frames[0], place) for place in self._supports]
        names = [*(f"wheel {i + 1}" for i in of_carriage), *(f"support {k + 1}" for k in range(len(self._supports)))]
        middle = sum((place * newtons for place, newtons in weights), 0j) / sum(newtons for _, newtons in weights)
        tips = why_points_tip(np.array([(p.real, p.imag) for p in points]), names, np.array([middle.real, middle.imag]))
        return Standing(tuple(wheels), tuple(supports), tips)

    def _carried(self, frames: list[Frame], shift: Places = 0j) -> tuple[np.ndarray, np.ndarray, Weights]:
        """Loads of wheels and supports, and what the carriage with its supports and wheels carries. `shift`: of the
        carriage's own weight, in the world."""
        loads, supports = np.zeros((*np.shape(frames[0][0]), len(self._wheels))), np.zeros(len(self._supports))
        weights: dict[int, Weights] = {g: [] for g in self._of_group}
        for frame, g, (place, newtons) in zip(frames, self._group, self._weights, strict=True):
            weights[g].append((_at(frame, place), newtons))
        (place, newtons), *others = weights[0]  # that of body 0 is the first
        weights[0] = [(place + shift, newtons), *others]
        weights[0] += [(_at(frames[0], place) + shift, newtons) for place, newtons in self._payload]
        for g, wheels in self._of_group.items():  # trailers before what they hang on
            points = [_at(frames[b], place) for b, place in (self._wheels[i] for i in wheels)]
            points += [frames[g][0]] if g else [_at(frames[0], place) for place in self._supports]
            shares = _shares(points, weights[g])
            loads[..., wheels] = shares[..., : len(wheels)]
            if not g:
                supports = shares[..., len(wheels):]
            else:
                weights[self._group[self._parents[g]]].append((frames[g][0], shares[..., -1]))
        return loads, supports, weights[0]

    def _frames_at(self, angles_rad: Sequence[float]) -> list[Frame]:
        """Those of bodies whose carriage stands at the origin."""
        found: list[Frame] = [(0j, 1.0 + 0j)]
        for parent, hinge, angle in zip(self._parents[1:], self._hinges, angles_rad, strict=True):
            found.append((_at(found[parent], hinge), found[parent][1] * cmath.rect(1.0, angle)))
        return found

    def _frames(self, motion: ArticulatedMotion) -> list[Frame]:
        """That of each body."""
        direction = np.exp(1j * motion.heading_rad)
        bodies = (each.T.astype(float) for each in (motion.body_x_m, motion.body_y_m, motion.body_heading_rad))
        return [(motion.x_m + 1j * motion.y_m - direction * self._centre, direction),
                *((x + 1j * y, np.exp(1j * heading)) for x, y, heading in zip(*bodies, strict=True))]


def _place(table: Mapping[str, Any]) -> complex:
    return complex(table["x_m"], table["y_m"])


def _at(frame: Frame, place: complex) -> Places:
    return frame[0] + frame[1] * place


def _shares(points: list[Places], weights: Weights) -> np.ndarray:
    """Loads of points that balance weights, with the least sum of squares, in the last axis."""
    if not points:
        return np.zeros(0)
    places = np.stack(points, axis=-1)
    middle = places.mean(axis=-1, keepdims=True)
    size = np.maximum(np.abs(places - middle).max(axis=-1, keepdims=True), 1e-9)
    needed = _moments(np.stack([place for place, _ in weights], axis=-1) - middle, size)
    newtons = np.stack([np.broadcast_to(each, np.shape(points[0])) for _, each in weights], axis=-1)
    inverse = np.linalg.pinv(_moments(places - middle, size), rcond=1e-9)
    return np.asarray((inverse @ (needed @ newtons[..., None]))[..., 0])


def _moments(arms: np.ndarray, size: np.ndarray) -> np.ndarray:
    """What a unit force at each arm adds to the balance of forces and of moments, (…, 3, arms)."""
    return np.stack([np.ones(arms.shape), arms.real / size, arms.imag / size], axis=-2)
