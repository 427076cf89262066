"""Loads of the wheels of a vehicle with hinges, as it would stand still in its posture on level ground.

A vertical hinge carries the body's weight and its tipping moments, so all bodies on hinges stand as one with their
parents. The hitch of a trailer is a ball: it carries weight alone. Where more points carry than the balance needs, they
share as springs of one stiffness on a rigid body. Accelerations shift no load here.
"""

from __future__ import annotations

import cmath

import numpy as np

from laconic.core.articulated import CARRIAGE, ArticulatedMotion
from laconic.scene import Scene

GRAVITY_M_PER_S2 = 9.80665


def loads_of(scene: Scene, motion: ArticulatedMotion) -> np.ndarray:
    """The load of each wheel [N], shape (N,)."""
    names = [CARRIAGE, *(hinge.name for hinge in scene.hinges)]
    forms = ["", *(hinge.form for hinge in scene.hinges)]
    parents = [0, *(names.index(body["parent"]) for body in scene.vehicle["body"])]
    group = [0] * len(names)  # the trailer, or the carriage, with which a body stands
    for b in range(1, len(names)):
        group[b] = b if forms[b] == "trailer" else group[parents[b]]
    frames = _frames(scene, motion)
    weights: dict[int, list[tuple[complex, float]]] = {g: [] for g in group}
    for b, (place, newtons) in enumerate(_weights(scene, frames)):
        weights[group[b]].append((place, newtons))
    payload = scene.vehicle.get("payload")
    if payload:
        weights[0].append((_at(frames[0], payload["x_m"], payload["y_m"]), GRAVITY_M_PER_S2 * payload["mass_kg"]))
    wheels = scene.vehicle["wheel"]
    of_wheel = [group[names.index(wheel.get("body", CARRIAGE))] for wheel in wheels]
    loads = np.zeros(len(wheels))
    for g in sorted(weights, reverse=True):
        mine = [i for i, each in enumerate(of_wheel) if each == g]
        points = [_at(frames[names.index(wheels[i].get("body", CARRIAGE))], wheels[i]["x_m"], wheels[i]["y_m"])
                  for i in mine]
        points += [frames[g][0]] if g else [_at(frames[0], each["x_m"], each["y_m"])
                                            for each in scene.vehicle["support"]]
        shares = _shares(points, weights[g])
        loads[mine] = shares[: len(mine)]
        if g:
            weights[group[parents[g]]].append((frames[g][0], float(shares[-1])))
    return loads


def _frames(scene: Scene, motion: ArticulatedMotion) -> list[tuple[complex, complex]]:
    """Origin and direction of each body's frame in the world."""
    from laconic.simulation.articulated import origin_of

    found = [(complex(*origin_of(scene, motion)), cmath.rect(1.0, motion.heading_rad))]
    return found + [(complex(x, y), cmath.rect(1.0, heading)) for x, y, heading in zip(
        motion.body_x_m, motion.body_y_m, motion.body_heading_rad, strict=True)]


def _weights(scene: Scene, frames: list[tuple[complex, complex]]) -> list[tuple[complex, float]]:
    """Where the weight of each body acts, and how much."""
    bodies = [scene.vehicle, *scene.vehicle["body"]]
    return [(_at(frame, body.get("com_x_m", 0.0), body.get("com_y_m", 0.0)), GRAVITY_M_PER_S2 * body["mass_kg"])
            for frame, body in zip(frames, bodies, strict=True)]


def _at(frame: tuple[complex, complex], x_m: float, y_m: float) -> complex:
    return frame[0] + frame[1] * complex(x_m, y_m)


def _shares(points: list[complex], weights: list[tuple[complex, float]]) -> np.ndarray:
    """Loads of points that balance weights, with the least sum of squares."""
    if not points:
        return np.zeros(0)
    middle = sum(points) / len(points)
    size = max(max(abs(point - middle) for point in points), 1e-9)
    rows = np.array([[1.0, (p - middle).real / size, (p - middle).imag / size] for p in points]).T
    total = sum((w * np.array([1.0, (p - middle).real / size, (p - middle).imag / size]) for p, w in weights),
                np.zeros(3))
    return np.asarray(np.linalg.lstsq(rows, total, rcond=1e-9)[0])
