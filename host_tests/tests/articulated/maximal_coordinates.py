"""Accelerations of a vehicle with hinges by the longest way: each body with its three coordinates, each wheel with its
angle, and a multiplier for every hinge, contact, brake and commanded rate. Nothing here is shared with the core.

M a = Q + Aᵀλ and A a = b, where A v = 0 holds the bodies together and b = −A'v. Dependent rows are allowed: of all
solutions of A a = b it is the one that is nearest to M⁻¹Q, measured by M."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
Case = dict[str, Any]


def left_of(v: Vector) -> Vector:
    """e_z × v"""
    return np.array([-v[1], v[0]])


def turned(angle: float, v: Vector) -> Vector:
    return np.array([math.cos(angle) * v[0] - math.sin(angle) * v[1], math.sin(angle) * v[0] + math.cos(angle) * v[1]])


def toward(angle: float) -> Vector:
    return np.array([math.cos(angle), math.sin(angle)])


class Maximal:
    """One vehicle at one moment: headings and velocities of all bodies (of their centres of mass, world axes)."""

    def __init__(self, vehicle: Case, heading: Vector, velocity: Vector, yaw_rate: Vector, spin: Vector) -> None:
        self.bodies, self.wheels = vehicle["bodies"], vehicle["wheels"]
        self.heading, self.velocity, self.yaw_rate, self.spin = heading, velocity, yaw_rate, spin
        self.size = 3 * len(self.bodies) + len(self.wheels)
        self.rows: list[Vector] = []
        self.right: list[float] = []

    def arm(self, body: int, point: list[float]) -> Vector:
        return turned(self.heading[body], np.array(point) - np.array(self.bodies[body]["com"]))

    def add(self, row: Vector, right: float) -> None:
        self.rows.append(row)
        self.right.append(right)

    def point_row(self, body: int, arm: Vector, along: Vector) -> Vector:
        row = np.zeros(self.size)
        row[3 * body:3 * body + 2] = along
        row[3 * body + 2] = along @ left_of(arm)
        return row

    def point_drift(self, body: int, arm: Vector) -> Vector:
        """Acceleration of a point while the body's own are 0."""
        drift: Vector = -self.yaw_rate[body] ** 2 * arm
        return drift

    def point_velocity(self, body: int, arm: Vector) -> Vector:
        sum_of: Vector = self.velocity[body] + self.yaw_rate[body] * left_of(arm)
        return sum_of

    def join(self, body: int, commanded: float | None) -> None:
        parent = self.bodies[body]["parent"]
        outer, inner = self.arm(parent, self.bodies[body]["hinge"]), self.arm(body, [0.0, 0.0])
        for axis in np.eye(2):
            row = self.point_row(parent, outer, axis) - self.point_row(body, inner, axis)
            self.add(row, float(axis @ (self.point_drift(body, inner) - self.point_drift(parent, outer))))
        if commanded is not None:
            row = np.zeros(self.size)
            row[3 * body + 2], row[3 * parent + 2] = 1.0, -1.0
            self.add(row, commanded)

    def contact(self, number: int) -> None:
        """The hub moves by the wheel's rotation: in all directions, or along the roller's axis alone."""
        wheel = self.wheels[number]
        body, arm = wheel["body"], self.arm(wheel["body"], wheel["at"])
        axle = self.heading[body] + wheel["axle"]
        rolling = left_of(toward(axle))
        fixed = wheel["kind"] == "fixed"
        directions = [rolling, toward(axle)] if fixed else [toward(axle + wheel["roller"])]
        for along in directions:
            row = self.point_row(body, arm, along)
            row[3 * len(self.bodies) + number] = -wheel["radius"] * float(along @ rolling)
            slip = self.point_velocity(body, arm)
            # along turns with the body: d/dt(along·v) has the part (ω e_z × along)·v; along·rolling is constant
            drift = along @ self.point_drift(body, arm) + self.yaw_rate[body] * (left_of(along) @ slip)
            self.add(row, -float(drift))

    def accelerations(self, force: Vector, commanded: dict[int, float | None]) -> Vector:
        for body in range(1, len(self.bodies)):
            self.join(body, commanded[body])
        for number in range(len(self.wheels)):
            self.contact(number)
        mass = [x for body in self.bodies for x in (body["mass"], body["mass"], body["inertia"])]
        root = np.sqrt(np.array(mass + [wheel["inertia"] for wheel in self.wheels]))
        rows = np.array(self.rows) / root
        scale = np.linalg.norm(rows, axis=1)
        free = force / root
        missing = np.array(self.right) / scale - rows @ free / scale
        change = np.linalg.lstsq(rows / scale[:, None], missing, rcond=1e-9)[0]
        solved: Vector = (free + change) / root
        return solved
