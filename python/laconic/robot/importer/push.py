"""Inputs that push an imported robot straight ahead, so that its scene shows a motion."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from laconic.errors import Refused
from laconic.scene import Scene

ACCELERATION_M_PER_S2 = 0.3
PUSH_S = 1.0
ASIDE = 0.05  # of the way ahead, at which a push still is one ahead
REACHES = 0.02  # of the wanted speed, that it may miss
ROUNDS = 4  # of correcting a push by what it reached
SAME_MOTION = 1e-6
FORCE = ("body_force_N[1]", "body_moment_Nm")


@dataclass(frozen=True)
class Axles:
    """Of each wheel what resists its axle, and whether a torque may act on it."""

    damping_Nms: np.ndarray
    friction_Nm: np.ndarray
    are_driven: np.ndarray


@dataclass(frozen=True)
class Push:
    """Constant inputs by signal, and the speed that they reach; or why there are none."""

    values: dict[str, float]
    speed_m_per_s: float
    why_not: str = ""


def push_ahead(scene: Scene, axles: Axles, by_force: bool) -> Push:
    """Torques at the axles, or a force and a moment on the body, that accelerate it from rest as wanted."""
    found = _Rolling(scene)
    if found.slide > SAME_MOTION:
        return Push({}, 0.0, f"the wheels do not let the robot roll straight ahead ({found.hindrance()}); no inputs "
                             "are given")
    signals, columns = (FORCE, found.of_body()) if by_force else found.of_axles(axles.are_driven)
    numbers = found.solved(columns, axles)
    if numbers is None:
        what = "a force on the body pushes" if by_force else "torques that roll the wheels ahead push"
        return Push({}, 0.0, f"{what} the robot aside, too, by where its wheels and its centre of mass are; no inputs "
                             "are given")
    return _corrected(scene, dict(zip(signals, numbers, strict=True)))


class _Rolling:
    """What the core knows of the motion straight ahead."""

    def __init__(self, scene: Scene):
        core = scene.core()
        vehicle, self.scene = scene.c_vehicle(core), scene
        self.matrices = core.matrices(vehicle)
        self.radius = float(scene.vehicle["wheel_radius_m"])
        self.mass = float(scene.vehicle["mass_kg"])
        rows = self.matrices.constraint_rows
        self.slide = float(np.abs(rows[:, 0]).max()) if rows.size else 0.0
        _, sizes, directions = np.linalg.svd(rows) if rows.size else (None, np.zeros(0), np.eye(3))
        self.free = directions[int((sizes > SAME_MOTION).sum()):]  # a row for each motion that the wheels allow

    def hindrance(self) -> str:
        """The wheel that would slide most, and by how much."""
        fixed = [i for i, wheel in enumerate(self.scene.vehicle["wheel"]) if wheel["kind"] == "fixed"]
        worst = max(fixed, key=lambda i: abs(math.cos(self.scene.vehicle["wheel"][i]["axle_rad"])))
        off = math.degrees(math.asin(min(1.0, abs(math.cos(self.scene.vehicle["wheel"][worst]["axle_rad"])))))
        return f"the axle of wheel {worst + 1} is {off:.3g}° from across"

    @property
    def wheel_speeds(self) -> np.ndarray:
        """At 1 m/s ahead, in rad/s."""
        return np.asarray(self.matrices.wheel_rows[:, 0] / self.radius)

    def of_axles(self, are_driven: np.ndarray) -> tuple[tuple[str, ...], np.ndarray]:
        """Signals, and the generalised force of 1 N·m at each, times R."""
        chosen = np.flatnonzero(are_driven)
        return tuple(f"axle_torque_Nm[{i + 1}]" for i in chosen), self.matrices.wheel_rows[chosen].T

    def of_body(self) -> np.ndarray:
        """The same of 1 N ahead and of 1 N·m."""
        return np.array([[self.radius, 0.0], [0.0, 0.0], [0.0, 1.0 / self.matrices.lambda_yaw]])

    def solved(self, columns: np.ndarray, axles: Axles) -> np.ndarray | None:
        """The smallest inputs that accelerate as wanted and overcome what resists; None where there are none."""
        speeds = self.wheel_speeds
        wanted = self.matrices.inertia @ np.array([ACCELERATION_M_PER_S2 / self.radius, 0.0, 0.0])
        wanted = wanted * self.mass * self.radius**2
        effective_kg = wanted[0] / (ACCELERATION_M_PER_S2 * self.radius)
        drag = speed_of_drag(float(axles.damping_Nms @ speeds**2) / effective_kg)
        wanted = wanted + self.matrices.wheel_rows.T @ (axles.damping_Nms * speeds * drag
                                                        + axles.friction_Nm * np.sign(np.round(speeds, 9)))
        columns, wanted = self.free @ columns, self.free @ wanted
        numbers = np.linalg.pinv(columns, rcond=SAME_MOTION) @ wanted
        missed = float(np.abs(columns @ numbers - wanted).max())
        return None if missed > SAME_MOTION * float(np.abs(wanted).max()) else np.asarray(numbers)


def _corrected(scene: Scene, values: dict[str, float]) -> Push:
    """The inputs, made larger or smaller where slip took a part of their effect; those that go aside are none."""
    wanted = ACCELERATION_M_PER_S2 * PUSH_S
    best = Push(values, 0.0)
    for _ in range(ROUNDS):
        reached = speed_ahead(scene, values)
        if reached is None:
            break
        if abs(reached - wanted) < abs(best.speed_m_per_s - wanted):
            best = Push(values, reached)
        if abs(reached / wanted - 1.0) <= REACHES / 10.0 or reached <= 0.0:
            break
        values = {signal: value * min(wanted / reached, 2.0) for signal, value in values.items()}
    if best.speed_m_per_s > 0.0:
        return best
    return Push({}, 0.0, "torques that roll the wheels ahead push the robot aside, too, by where its wheels and its "
                         "centre of mass are; no inputs are given")


def speed_ahead(scene: Scene, values: dict[str, float]) -> float | None:
    """The speed at the end of a push from rest; None where it moves the robot aside by more than a small part of the
    way, or where a step is refused."""
    plant = replace(scene, inputs=()).plant(scene.core())
    try:
        plant.run(held_of(values, scene.wheel_count), round(PUSH_S / scene.run.step_s))
    except Refused:
        return None
    pose, way_m = plant.pose, plant.pose.x_m
    if not way_m > 0.0 or max(abs(pose.y_m), way_m * abs(pose.heading_rad)) > ASIDE * way_m:
        return None
    velocity, _ = plant.body_velocity()
    return float(velocity[0])


def held_of(values: dict[str, float], wheel_count: int) -> dict[str, Any]:
    """The inputs as a plant takes them."""
    held: dict[str, Any] = {}
    for signal, value in values.items():
        name, _, index = signal.partition("[")
        if not index:
            held[name] = value
            continue
        numbers = held.setdefault(name, [0.0] * (wheel_count if name == "axle_torque_Nm" else 2))
        numbers[int(index.rstrip("]")) - 1] = value
    return held


def speed_of_drag(decay_per_s: float) -> float:
    """The speed (m/s) whose damping a steady push must add, so that it ends as fast as without any.

    Half the speed at the end where damping is weak, nearly all of it where damping balances the push long before.
    """
    k = decay_per_s * PUSH_S
    return ACCELERATION_M_PER_S2 * PUSH_S * (1.0 / -math.expm1(-k) - 1.0 / k if k > 1e-6 else 0.5)


def listed_steps(values: dict[str, float], rounded: Any) -> list[dict[str, Any]]:
    """As tables of a scene."""
    return [{"signal": signal, "kind": "steps", "t_s": [0.0, PUSH_S], "value": [rounded(value), 0.0]}
            for signal, value in values.items()]


def smallest(values: Sequence[float]) -> float:
    """What counts as none among torques."""
    return 1e-9 * max(map(abs, values), default=0.0)
