"""How a scene's vehicle stands at rest: the load of each wheel and support, and whether anything keeps it from tipping.

A vehicle of the core stays level whatever happens, so a robot that would fall over moves as if it were held.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from laconic.core import load
from laconic.scene.axle_lines import tolerance_m

if TYPE_CHECKING:
    from laconic.scene.scene import Scene

STEP_S = 1e-3   # of a plant that takes none
OUTSIDE_M = 1e-6  # what is less is rounding
ABOVE_MM = 0.5  # of a line: above it, but for rounding in a file
NO_LOAD = 1e-9  # of the weight: rounding
MAY_TIP = "it may tip"
REMEDY = "give what else it stands on as [[vehicle.support]]; the run holds it level"


@dataclass(frozen=True)
class Standing:
    """Normal loads at rest in N, and in words why the vehicle tips; empty where it stands."""

    wheel_N: tuple[float, ...]
    support_N: tuple[float, ...]
    tips: str

    @property
    def weight_N(self) -> float:
        """What all of them carry."""
        return sum(self.wheel_N) + sum(self.support_N)

    def share(self, load_N: float) -> str:
        """A load for people, with its part of the weight."""
        part = load_N / self.weight_N if self.weight_N > 0.0 else 0.0
        return f"{100.0 * part:.3g} % of the weight ({load_N:.3g} N)"

    def in_words(self) -> str:
        """All loads in one line."""
        of_all = (("wheel", self.wheel_N), ("support", self.support_N))
        each = [f"{what} {i} {n:.3g} N ({100.0 * n / (self.weight_N or 1.0):.3g} %)"
                for what, loads in of_all for i, n in enumerate(loads, 1)]
        return f"normal loads at rest: {', '.join(each)}"

    def as_json(self) -> dict[str, Any]:
        """Machine-readable."""
        return {"wheel_load_N": list(self.wheel_N), "support_load_N": list(self.support_N),
                "stands": not self.tips or self.tips.startswith(MAY_TIP), "tips": self.tips or None}


def standing_of(scene: Scene) -> Standing:
    """Of a scene with wheels; the core's statics, by which points that cannot pull are left out."""
    vehicle = scene.vehicle
    ground = {"friction_coefficient": 1.0, **vehicle.get("ground", {})}
    core = load("double")
    plant = core.plant(core.vehicle({**vehicle, "ground": ground, "friction_coefficient": 0.0}), "auto", STEP_S)
    count, supports = len(vehicle["wheel"]), len(vehicle["support"])
    weight = float(plant.c.friction.weight_N)
    loads = core.numbers(plant.c.slip.normal_N)[: count + supports].astype(float)
    loads[loads < NO_LOAD * weight] = 0.0
    if (total := float(loads.sum())) > 0.0:
        loads *= weight / total
    return Standing(tuple(map(float, loads[:count])), tuple(map(float, loads[count:])), why_it_tips(vehicle))


def why_it_tips(vehicle: Mapping[str, Any]) -> str:
    """Empty where the centre of mass lies inside the polygon of wheels and supports, and not on its edge."""
    points = np.array([(each["x_m"], each["y_m"]) for each in (*vehicle["wheel"], *vehicle["support"])], float)
    names = [*(f"wheel {i}" for i in range(1, len(vehicle["wheel"]) + 1)),
             *(f"support {i}" for i in range(1, len(vehicle["support"]) + 1))]
    return why_points_tip(points, names, _centre(vehicle))


def why_points_tip(points: np.ndarray, names: Sequence[str], centre: np.ndarray) -> str:
    """Empty where the centre, shape (2,), lies inside the polygon of points, shape (n, 2), and not on its edge."""
    if (line := _one_line(points)) is not None:
        off_mm = 1e3 * abs(float(np.cross([*line[1], 0.0], [*(centre - line[0]), 0.0])[2]))
        where = "on one point" if len(points) == 1 else f"in one line ({_listed(names)})"
        centre_is = "above it" if off_mm < ABOVE_MM else f"{off_mm:.3g} mm off"
        return f"nothing keeps it from tipping: it stands {where}, and its centre of mass is {centre_is}; {REMEDY}"
    hull = hull_of(points)
    edges = [(hull[k], hull[(k + 1) % len(hull)]) for k in range(len(hull))]
    outside = [(_right_of(points[a], points[b], centre), a, b) for a, b in edges]
    distance, a, b = max(outside)
    if distance < -OUTSIDE_M:
        return ""
    if distance <= OUTSIDE_M:
        return (f"{MAY_TIP}: its centre of mass is above the line from {names[a]} to {names[b]}, the edge of what it "
                "stands on, so that points off this line carry nothing; check com_x_m and com_y_m; the run holds it "
                "level")
    return (f"it tips: its centre of mass lies {1e3 * distance:.3g} mm outside what it stands on, beyond the line from "
            f"{names[a]} to {names[b]}; {REMEDY}")


def _centre(vehicle: Mapping[str, Any]) -> np.ndarray:
    """Of the mass with its payload, seen from above."""
    payload = vehicle.get("payload") or {}
    own, more = float(vehicle["mass_kg"]), float(payload.get("mass_kg", 0.0))
    places = [np.array([float(each.get(f"{key}x_m", 0.0)), float(each.get(f"{key}y_m", 0.0))])
              for each, key in ((vehicle, "com_"), (payload, ""))]
    return np.asarray((own * places[0] + more * places[1]) / (own + more))


def _one_line(points: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """A point and the direction of the line that all lie on, but for rounding; None where they span an area."""
    first = points[0]
    farthest = points[int(np.argmax(np.linalg.norm(points - first, axis=1)))]
    length = float(np.linalg.norm(farthest - first))
    direction = (farthest - first) / length if length > 0.0 else np.array([0.0, 1.0])
    off = np.abs((points - first) @ np.array([-direction[1], direction[0]]))
    return (first, direction) if off.max() <= tolerance_m([*points]) else None


def hull_of(points: np.ndarray) -> list[int]:
    """The corners of the polygon around all points, counter-clockwise."""
    order = sorted(range(len(points)), key=lambda k: (points[k][0], points[k][1]))
    halves: list[list[int]] = []
    for way in (order, order[::-1]):
        half: list[int] = []
        for k in way:
            while len(half) > 1 and _turn(points, half[-2], half[-1], k) <= 0.0:
                half.pop()
            half.append(k)
        halves.append(half[:-1])
    return halves[0] + halves[1]


def _turn(points: np.ndarray, a: int, b: int, c: int) -> float:
    (ux, uy), (vx, vy) = points[b] - points[a], points[c] - points[a]
    return float(ux * vy - uy * vx)


def _right_of(a: np.ndarray, b: np.ndarray, point: np.ndarray) -> float:
    """How far a point lies to the right of the way from a to b."""
    (ux, uy), (vx, vy) = b - a, point - a
    return float((uy * vx - ux * vy) / np.hypot(ux, uy))


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names[:-1]) + f" and {names[-1]}" if names[1:] else names[0]
