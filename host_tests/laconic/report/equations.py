"""The equations of one vehicle in plain numpy, written apart from the core: for peers and references.

Follows PHYSICS of the paper: rows of Ξ (4.3, 4.4), A (4.6), constraints of fixed and locked wheels. Dense linear
algebra throughout; nothing here is shared with the C core.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Wheel:
    """One wheel in the body frame; `roller_rad` is None for a fixed wheel."""

    x_m: float
    y_m: float
    axle_rad: float
    roller_rad: float | None
    locked: bool = False


@dataclass(frozen=True)
class Vehicle:
    """A vehicle in SI units: totals with wheels, about the centre of mass."""

    mass_kg: float
    yaw_inertia_kgm2: float
    com_m: tuple[float, float]
    wheel_radius_m: float
    wheel_inertia_kgm2: float
    motor_gain_Nm_per_V: float
    motor_damping_Nms: float
    wheels: tuple[Wheel, ...]


@dataclass(frozen=True)
class Segment:
    """An interval with everything held: voltages, a body wrench, a force fixed in the world at a body point."""

    duration_s: float
    voltage_V: tuple[float, ...]
    body_wrench: tuple[float, float, float] = (0.0, 0.0, 0.0)
    world_force_N: tuple[float, float] = (0.0, 0.0)
    point_m: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True)
class Course:
    """A vehicle, where it starts and what drives it."""

    name: str
    vehicle: Vehicle
    nu: tuple[float, float, float]
    pose: tuple[float, float, float]
    segments: tuple[Segment, ...]


@dataclass(frozen=True)
class Equations:
    """ν' = inverse_inertia·(Λ⁻¹a(ν) + gain·ΞᵀU − damping·ΞᵀΞν + force_scale·w), χ' = Ξν."""

    wheel_rows: Array
    inertia: Array
    inverse_inertia: Array
    yaw_scale: float
    radius_m: float
    gain: float
    damping: float
    force_scale: float

    def acceleration(self, nu: Array, heading: float, segment: Segment) -> Array:
        """ν' for a held segment (4.7)."""
        gyroscopic = np.array([nu[1] * nu[2], -nu[0] * nu[2], 0.0]) / self.yaw_scale
        torque = self.gain * np.asarray(segment.voltage_V) - self.damping * (self.wheel_rows @ nu)
        force = gyroscopic + self.wheel_rows.T @ torque + self.force_scale * self._outer(heading, segment)
        return self.inverse_inertia @ force

    def _outer(self, heading: float, segment: Segment) -> Array:
        cosine, sine = np.cos(heading), np.sin(heading)
        world = segment.world_force_N
        turned = np.array([cosine * world[0] + sine * world[1], cosine * world[1] - sine * world[0]])
        moment = segment.body_wrench[2] + segment.point_m[0] * turned[1] - segment.point_m[1] * turned[0]
        body = turned + np.asarray(segment.body_wrench[:2])
        return np.array([self.radius_m * body[0], self.radius_m * body[1], moment / self.yaw_scale])

    def derivative(self, _t: float, state: Array, segment: Segment) -> Array:
        """Rates of ν, x, y, θ, χ."""
        nu, heading = state[:3], state[5]
        cosine, sine = np.cos(heading), np.sin(heading)
        travel = self.radius_m * np.array([nu[0] * cosine - nu[1] * sine, nu[0] * sine + nu[1] * cosine])
        acceleration = self.acceleration(nu, heading, segment)
        return np.concatenate([acceleration, travel, [nu[2] / self.yaw_scale], self.wheel_rows @ nu])


def equations_of(vehicle: Vehicle) -> Equations:
    """Prepare the matrices of a vehicle."""
    m, r = vehicle.mass_kg, vehicle.wheel_radius_m
    yaw_scale = float(np.sqrt(vehicle.yaw_inertia_kgm2 / m) / r)
    rows = np.array([_rolling_row(vehicle, wheel, yaw_scale) for wheel in vehicle.wheels]).reshape(-1, 3)
    lambda2 = vehicle.wheel_inertia_kgm2 / (m * r * r)
    inertia = np.eye(3) + lambda2 * rows.T @ rows
    basis = _allowed(_constraints(vehicle, rows, yaw_scale))
    inverse = basis @ np.linalg.solve(basis.T @ inertia @ basis, basis.T)
    scale = 1.0 / (m * r * r)
    gain, damping = vehicle.motor_gain_Nm_per_V * scale, vehicle.motor_damping_Nms * scale
    return Equations(rows, inertia, inverse, yaw_scale, r, gain, damping, scale)


def _lever_row(vehicle: Vehicle, wheel: Wheel, yaw_scale: float, angle: float) -> Array:
    """Velocity of the wheel's centre along a direction, over R, as a row that acts on ν."""
    arm = (wheel.x_m - vehicle.com_m[0], wheel.y_m - vehicle.com_m[1])
    lever = arm[0] * np.sin(angle) - arm[1] * np.cos(angle)
    return np.array([np.cos(angle), np.sin(angle), lever / (vehicle.wheel_radius_m * yaw_scale)])


def _rolling_row(vehicle: Vehicle, wheel: Wheel, yaw_scale: float) -> Array:
    roller = np.pi / 2 if wheel.roller_rad is None else wheel.roller_rad
    return _lever_row(vehicle, wheel, yaw_scale, wheel.axle_rad + roller) / np.sin(roller)


def _constraints(vehicle: Vehicle, rows: Array, yaw_scale: float) -> Array:
    found = []
    for wheel, row in zip(vehicle.wheels, rows, strict=True):
        if wheel.roller_rad is None:
            found.append(_lever_row(vehicle, wheel, yaw_scale, wheel.axle_rad))
        if wheel.locked:
            found.append(row)
    return np.array(found).reshape(-1, 3)


def _allowed(constraints: Array) -> Array:
    """Orthonormal columns that span the motions the constraints leave."""
    _, singular, right = np.linalg.svd(constraints, full_matrices=True)
    rank = int(np.sum(singular > 1e-9 * max([1.0, *singular])))
    return right[rank:].T


def s1_course(seconds: float = 10.0) -> Course:
    """The speed benchmark S1: three omni wheels, a ±1 square wave of 1 s on all voltages, from rest."""
    quarter = np.pi / 2
    wheels = tuple(
        Wheel(0.05 * d * float(np.cos(a)), 0.05 * d * float(np.sin(a)), a, quarter)
        for d, a in ((1.0, 0.0), (1.0, float(np.pi)), (1.2, quarter))
    )
    vehicle = Vehicle(10.0, 0.225, (0.0, 0.02), 0.05, 0.009, 0.5, 0.02, wheels)
    halves = round(seconds / 0.5)
    drive = tuple(Segment(0.5, tuple((-1.0) ** k * u for u in (2.0, -2.0, 1.0))) for k in range(halves))
    return Course("S1", vehicle, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), drive)


def solve(course: Course, solver: str = "DOP853", rtol: float = 1e-13, atol: float = 1e-14) -> list[Array]:
    """States at the segments' ends by SciPy, restarted where the inputs jump."""
    from scipy.integrate import solve_ivp

    equations = equations_of(course.vehicle)
    state = np.concatenate([course.nu, course.pose, np.zeros(len(course.vehicle.wheels))])
    ends = []
    for segment in course.segments:
        solution = solve_ivp(
            equations.derivative, (0.0, segment.duration_s), state, solver, args=(segment,), rtol=rtol, atol=atol
        )
        if not solution.success:
            raise RuntimeError(f"{solver} gave up on {course.name}: {solution.message}")
        state = solution.y[:, -1]
        ends.append(state)
    return ends


def worst_difference(found: Sequence[Array], expected: Sequence[Array], part: slice) -> float:
    """Largest |found − expected| of some components over all states."""
    return max((float(np.max(np.abs(a[part] - b[part]), initial=0.0)) for a, b in zip(found, expected, strict=True)))
