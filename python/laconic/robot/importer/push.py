"""Inputs that push an imported robot so that its scene shows a motion: ahead, or else as its wheels let it move."""

from __future__ import annotations

import math
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
FORCES = ("body_force_N[1]", "body_force_N[2]", "body_moment_Nm")
AHEAD = np.array([1.0, 0.0, 0.0])

Values = dict[str, tuple[float, float]]
"""By signal: at begin and end of the push. Between them they grow with time, as the speed and its damping do."""


@dataclass(frozen=True)
class Axles:
    """Of each wheel what resists its axle, and whether a torque may act on it."""

    damping_Nms: np.ndarray
    friction_Nm: np.ndarray
    are_driven: np.ndarray


@dataclass(frozen=True)
class Push:
    """Inputs by signal, with their values at begin and end, and the speed that they reach; or why there are none."""

    values: Values
    speed_m_per_s: float
    why_not: str = ""
    way: str = "push ahead"  # what they do
    measured: str = ""  # what has the speed, where it is not the robot
    instead: str = ""  # why they do not push ahead
    straight: tuple[float, float] | None = None  # the way, in axes of the body; None for a turn


@dataclass(frozen=True)
class Way:
    """A motion in units of ν·R, whose part along x or y is 1 m/s, or whose fastest wheel rolls at 1 m/s."""

    direction: np.ndarray
    words: str

    @property
    def is_turn(self) -> bool:
        """Whether it is a rotation about a point."""
        return abs(float(self.direction[2])) > SAME_MOTION


def push(scene: Scene, axles: Axles, by_force: bool) -> Push:
    """Torques at the axles, or forces and a moment on the body, that accelerate it from rest as wanted."""
    found = _Rolling(scene)
    instead, way = "", Way(AHEAD, "push ahead")
    if found.slide > SAME_MOTION:
        instead = f"the wheels do not let the robot roll straight ahead ({found.hindrance()})"
        free = found.way()
        if free is None:
            return Push({}, 0.0, f"{instead}; no inputs are given")
        way = free
    signals, columns = found.of_body(way) if by_force else found.of_axles(axles.are_driven)
    numbers = found.solved(columns, axles, way)
    if numbers is None:
        what = "a force on the body pushes" if by_force else "torques that roll the wheels ahead push"
        return Push({}, 0.0, f"{what} the robot aside, too, by where its wheels and its centre of mass are; no inputs "
                             "are given")
    pairs = ((float(begin), float(end)) for begin, end in numbers)
    return _corrected(scene, dict(zip(signals, pairs, strict=True)), found, way, instead)


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

    def way(self) -> Way | None:
        """A straight way that the wheels leave, or else the only rotation; None where they leave neither."""
        if len(self.free) == 1:
            straight = self.free[0]
        elif len(self.free) == 2:
            straight = self.free[1, 2] * self.free[0] - self.free[0, 2] * self.free[1]
        else:
            return None
        size = float(np.hypot(*straight[:2]))
        if size <= SAME_MOTION or abs(straight[2]) > SAME_MOTION * size:
            return self._turn(straight) if len(self.free) == 1 else None
        straight = np.array([*straight[:2] / size, 0.0])
        if max(straight[:2], key=abs) < 0.0:
            straight = -straight
        angle = math.degrees(math.atan2(straight[1], straight[0]))
        return Way(straight, "push to the left" if abs(angle - 90.0) < 1e-6 else f"push along {angle:.3g}° from ahead")

    def _turn(self, direction: np.ndarray) -> Way | None:
        """To the left, so fast that the fastest wheel rolls at 1 m/s."""
        fastest = float(np.abs(self.matrices.wheel_rows @ direction).max())
        if fastest <= SAME_MOTION:
            return None
        direction = np.asarray(direction * (math.copysign(1.0, direction[2]) / fastest))
        yaw_rate = self.yaw_rate_of(direction)
        com = [float(self.scene.vehicle.get(key, 0.0)) for key in ("com_x_m", "com_y_m")]
        x, y = com[0] - direction[1] / yaw_rate, com[1] + direction[0] / yaw_rate
        return Way(direction, f"turn the robot about ({round(x, 6) + 0.0:.3g}, {round(y, 6) + 0.0:.3g}) m")

    def yaw_rate_of(self, direction: np.ndarray) -> float:
        """In rad/s, of a motion in units of ν·R."""
        return float(direction[2] / (self.radius * self.matrices.lambda_yaw))

    def wheel_speeds(self, way: Way) -> np.ndarray:
        """At 1 m/s, in rad/s."""
        return np.asarray(self.matrices.wheel_rows @ way.direction / self.radius)

    def of_axles(self, are_driven: np.ndarray) -> tuple[tuple[str, ...], np.ndarray]:
        """Signals, and the generalised force of 1 N·m at each, times R."""
        chosen = np.flatnonzero(are_driven)
        return tuple(f"axle_torque_Nm[{i + 1}]" for i in chosen), self.matrices.wheel_rows[chosen].T

    def of_body(self, way: Way) -> tuple[tuple[str, ...], np.ndarray]:
        """The same of 1 N along the way and of 1 N·m."""
        each = np.diag([self.radius, self.radius, 1.0 / self.matrices.lambda_yaw])
        chosen = [k for k in range(2) if abs(way.direction[k]) > SAME_MOTION]
        return tuple(FORCES[k] for k in (*chosen, 2)), each[:, [*chosen, 2]]

    def solved(self, columns: np.ndarray, axles: Axles, way: Way) -> np.ndarray | None:
        """The smallest inputs that accelerate as wanted and overcome what resists, in columns for begin and end; None
        where there are none."""
        speeds = self.wheel_speeds(way)
        wanted = self.matrices.inertia @ (way.direction * (ACCELERATION_M_PER_S2 / self.radius))
        wanted = wanted * self.mass * self.radius**2
        wanted = wanted + self.matrices.wheel_rows.T @ (axles.friction_Nm * np.sign(np.round(speeds, 9)))
        damped = self.matrices.wheel_rows.T @ (axles.damping_Nms * speeds * ACCELERATION_M_PER_S2 * PUSH_S)
        columns, both = self.free @ columns, self.free @ np.column_stack([wanted, wanted + damped])
        numbers = np.linalg.pinv(columns, rcond=SAME_MOTION) @ both
        missed = float(np.abs(columns @ numbers - both).max())
        return None if missed > SAME_MOTION * float(np.abs(both).max()) else np.asarray(numbers)


def _corrected(scene: Scene, values: Values, rolling: _Rolling, way: Way, instead: str) -> Push:
    """The inputs, made larger or smaller where slip took a part of their effect; those that go aside are none."""
    wanted = ACCELERATION_M_PER_S2 * PUSH_S
    straight = None if way.is_turn else (float(way.direction[0]), float(way.direction[1]))
    best = Push(values, 0.0, "", way.words, ", its fastest wheel" if way.is_turn else "", instead, straight)
    for _ in range(ROUNDS):
        reached = speed_along(scene, values, rolling, way)
        if reached is None:
            break
        if abs(reached - wanted) < abs(best.speed_m_per_s - wanted):
            best = replace(best, values=values, speed_m_per_s=reached)
        if abs(reached / wanted - 1.0) <= REACHES / 10.0 or reached <= 0.0:
            break
        factor = min(wanted / reached, 2.0)
        values = {signal: (factor * begin, factor * end) for signal, (begin, end) in values.items()}
    if best.speed_m_per_s > 0.0:
        return best
    return Push({}, 0.0, "torques that roll the wheels ahead push the robot aside, too, by where its wheels and its "
                         "centre of mass are; no inputs are given")


def speed_along(scene: Scene, values: Values, rolling: _Rolling, way: Way) -> float | None:
    """The speed at the end of a push from rest; None where it moves the robot aside by more than a small part of the
    way, or where a step is refused."""
    plant = replace(scene, inputs=()).plant(scene.core())
    try:
        _run(plant, values, scene.wheel_count, round(PUSH_S / scene.run.step_s))
    except Refused:
        return None
    velocity, yaw_rate = plant.body_velocity()
    if way.is_turn:
        return float(yaw_rate) / rolling.yaw_rate_of(way.direction)
    ahead, aside = way.direction[:2], np.array([-way.direction[1], way.direction[0]])
    moved = np.array([plant.pose.x_m, plant.pose.y_m])
    way_m = float(ahead @ moved)
    if not way_m > 0.0 or max(abs(float(aside @ moved)), way_m * abs(plant.pose.heading_rad)) > ASIDE * way_m:
        return None
    return float(ahead @ velocity)


def _run(plant: Any, values: Values, wheel_count: int, steps: int) -> None:
    """Holds constant inputs, and in each step of others their value in its middle."""
    if all(begin == end for begin, end in values.values()):
        plant.run(held_of({signal: begin for signal, (begin, _) in values.items()}, wheel_count), steps)
        return
    for step in range(steps):
        share = (step + 0.5) / steps
        now = {signal: begin + share * (end - begin) for signal, (begin, end) in values.items()}
        plant.run(held_of(now, wheel_count), 1)


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


def tables_of(values: Values, step_s: float, rounded: Any) -> list[dict[str, Any]]:
    """As tables of a scene, without those that count as none."""
    least = 1e-9 * max((abs(value) for pair in values.values() for value in pair), default=0.0)
    found = []
    for signal, (begin, end) in values.items():
        if max(abs(begin), abs(end)) <= least:
            continue
        if rounded(begin) == rounded(end):
            found.append({"signal": signal, "kind": "steps", "t_s": [0.0, PUSH_S], "value": [rounded(begin), 0.0]})
        else:
            found.append({"signal": signal, "kind": "table", "t_s": [0.0, PUSH_S, PUSH_S + step_s],
                          "value": [rounded(begin), rounded(end), 0.0]})
    return found
