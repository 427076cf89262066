"""Steady turns of vehicles with hinges: the angle of each hinge, the circle of each body, and how tight a turn may be.

In a steady turn all bodies turn at the rate ω about one point. With q the velocity of a hinge in its parent's axes, a
fixed wheel with axle n and lever ℓ about the hinge asks for n · (e^{−iψ} q) + ℓ ω = 0. This has two solutions ψ where
|ℓ ω| < |q|, and none beyond: a trailer folds, and a caster turns for ever. Plane vectors are complex numbers.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from laconic.core.spelling import wrapped
from laconic.errors import BadInput, nearest_of
from laconic.scene import Scene
from laconic.scene.hinges import Hinge
from laconic.simulation.loads import centre_of

TINY = 1e-9          # of a length or a direction: rounding
SCANNED = 2000       # turns from straight ahead to the spot
HALVINGS = 60
ROUNDINGS = 1e3      # that add up in a rate


@dataclass(frozen=True)
class Axle:
    """A fixed wheel in its body's frame."""

    wheel: int         # from 1, as signals count
    place: complex
    direction: complex  # n, of the axle

    @cached_property
    def lever(self) -> float:
        """ℓ = n · (i P)."""
        return dot(self.direction, 1j * self.place)


@dataclass(frozen=True)
class Limb:
    """One body on a hinge: what a turn needs to know."""

    hinge: Hinge
    parent: int                # 0: the carriage
    place: complex             # of the hinge, in the parent's frame
    axles: tuple[Axle, ...]
    middle: complex            # of its wheels, else its hinge

    @cached_property
    def follows(self) -> bool:
        """Whether its wheels set its yaw rate."""
        return self.hinge.kind == "free" and bool(self.axles) and abs(self.axles[0].lever) > TINY

    @property
    def folds(self) -> bool:
        """Whether it ends a turn where its wheels find no angle; a caster goes round instead."""
        return self.hinge.form != "caster"


class BodyCircle(NamedTuple):
    """One body in a steady turn or in straight motion. `angle_rad` is None where nothing sets it."""

    angle_rad: float | None
    within_stops: bool
    velocity: complex      # of its hinge, in its own axes, as the twist has it
    radius_m: float        # of the circle of the middle of its wheels; infinite on a straight line
    growth: float | None   # of its angle where its wheels follow, 1/s for the twist as it is
    period: float | None   # of a caster that goes round for ever, s
    problem: str           # why there is no such motion, "" where there is


@dataclass(frozen=True)
class Tree:
    """The vehicle as wheels see it."""

    scene: Scene
    carriage: tuple[Axle, ...]
    limbs: tuple[Limb, ...]
    straight: complex        # direction of straight motion, in body axes
    turn: complex | None     # velocity of the origin in a turn on the spot at 1 rad/s; None: it cannot turn
    centre: complex          # of mass of body 0, with its payload
    size_m: float

    def twist(self, curvature_per_m: float) -> tuple[complex, float]:
        """Twist of the origin at 1 m/s along the path; an infinite curvature is a turn at 1 rad/s on the spot."""
        if math.isinf(curvature_per_m):
            return math.copysign(1.0, curvature_per_m) * (self.turn or 0j), math.copysign(1.0, curvature_per_m)
        return self.straight + curvature_per_m * (self.turn or 0j), curvature_per_m

    def circles(self, twist: tuple[complex, float]) -> list[BodyCircle]:
        """Each body on a hinge in the steady motion of a twist of the origin."""
        velocities, found = [twist[0]], list[BodyCircle]()
        known = [True]
        for limb in self.limbs:
            q = velocities[limb.parent] + 1j * twist[1] * limb.place
            each = self._circle(limb, q, twist[1], known[limb.parent])
            velocities.append(each.velocity)
            known.append(each.angle_rad is not None)
            found.append(each)
        return found

    @staticmethod
    def rounding_per_s(limb: Limb, velocity: complex) -> float:
        """What rounding of an angle leaves of the rate of a hinge, whose wheels may be near to it."""
        return ROUNDINGS * np.finfo(float).eps * abs(velocity / limb.axles[0].lever) if limb.follows else 0.0

    def _circle(self, limb: Limb, q: complex, omega: float, parent_known: bool) -> BodyCircle:
        if not parent_known:
            return BodyCircle(None, True, 0j, math.nan, None, None, "")
        if not limb.axles:
            if limb.hinge.kind != "prescribed":
                return BodyCircle(None, True, 0j, math.nan, None, None, "")
            return self._at(limb, limb.hinge.start_angle_rad, q, omega)
        axle = limb.axles[0]
        if limb.hinge.kind == "coordinated":
            if abs(q) < TINY * self.size_m:
                return BodyCircle(None, True, 0j, math.nan, None, None, f"{limb.hinge.name} lies in the turning centre")
            return self._at(limb, cmath.phase(q), q, omega)
        if abs(axle.lever * omega) > abs(q):
            square = omega * omega - (abs(q) / axle.lever)**2
            period = 2.0 * math.pi / math.sqrt(square)
            problem = f"{limb.hinge.name} folds" if limb.folds else ""
            return BodyCircle(None, True, 0j, math.nan, None, period, problem)
        if abs(q) < TINY * self.size_m:
            return BodyCircle(None, True, 0j, math.nan, None, None, f"{limb.hinge.name} lies in the turning centre")
        base = cmath.phase(q) - cmath.phase(axle.direction)
        part = math.acos(max(-1.0, min(1.0, -axle.lever * omega / abs(q))))
        if limb.follows:  # its angle grows by ±|q| sin(part)/ℓ
            return self._at(limb, base - math.copysign(part, axle.lever), q, omega)
        return self._at(limb, min(base + part, base - part, key=lambda angle: abs(wrapped(angle))), q, omega)

    def _at(self, limb: Limb, angle: float, q: complex, omega: float) -> BodyCircle:
        angle = wrapped(angle)
        velocity = q * cmath.exp(-1j * angle)
        axle = limb.axles[0] if limb.axles else None
        growth = dot(axle.direction, 1j * velocity) / axle.lever if axle and limb.follows else None
        problem = disagreement(limb.axles, velocity, omega, self.size_m)
        speed = abs(velocity + 1j * omega * limb.middle)
        within = limb.hinge.low_rad - TINY <= angle <= limb.hinge.high_rad + TINY
        return BodyCircle(angle, within, velocity, speed / abs(omega) if omega else math.inf, growth, None, problem)

    def curvature_of(self, name: str, angle_rad: float) -> float:
        """Curvature of the turn that one steered hinge of the carriage asks for by its angle."""
        names = [limb.hinge.name for limb in self.limbs]
        if name not in names:
            raise BadInput(f"{self.scene.path}: --steering {name}: there is no such hinge; {nearest_of(name, names)}")
        limb = self.limbs[names.index(name)]
        if limb.parent or limb.follows or not limb.axles:
            raise BadInput(f"{self.scene.path}: --steering {name}: does not steer the carriage; name a steered hinge "
                           "that hangs on it, or give --curvature")
        axle = limb.axles[0]
        unturned = cmath.exp(-1j * angle_rad)
        ahead = dot(axle.direction, unturned * self.straight)
        aside = dot(axle.direction, unturned * ((self.turn or 0j) + 1j * limb.place)) + axle.lever
        if abs(aside) < TINY * self.size_m:
            return 0.0 if abs(ahead) < TINY else math.copysign(math.inf, -ahead)
        return -ahead / aside if abs(aside) > TINY * abs(ahead) * self.size_m else math.copysign(math.inf, angle_rad)

    def limit(self, side: int) -> tuple[float, str]:
        """The largest curvature to one side (+1: left) and what ends there; infinite: it turns on the spot."""
        found = 0.0
        for step in range(1, SCANNED + 1):
            curvature = self._of_share(step / SCANNED)
            if self._why_not(side * curvature):
                low, high = (step - 1) / SCANNED, step / SCANNED
                for _ in range(HALVINGS):
                    middle = 0.5 * (low + high)
                    low, high = (low, middle) if self._why_not(side * self._of_share(middle)) else (middle, high)
                return self._of_share(low), self._why_not(side * self._of_share(high))
            found = curvature
        return found, ""

    def _of_share(self, share: float) -> float:
        return math.inf if share >= 1.0 else math.tan(0.5 * math.pi * share) / self.size_m

    def _why_not(self, curvature: float) -> str:
        """Why there is no such turn; "" where there is."""
        for limb, each in zip(self.limbs, self.circles(self.twist(curvature)), strict=True):
            if each.problem:
                return each.problem
            if not each.within_stops:
                return f"{limb.hinge.name} comes to its stop"
        return ""


def dot(a: complex, b: complex) -> float:
    """Of two plane vectors."""
    return (a.conjugate() * b).real


def disagreement(axles: Sequence[Axle], velocity: complex, omega: float, size_m: float) -> str:
    """Which fixed wheel of a body slides in its motion; "" for none."""
    for axle in axles:
        sliding = dot(axle.direction, velocity) + axle.lever * omega
        if abs(sliding) > 1e3 * TINY * (abs(velocity) + abs(omega) * size_m):
            return f"wheel {axle.wheel} would slide"
    return ""


def tree_of(scene: Scene) -> Tree:
    """What the wheels of a scene with hinges allow; BadInput for one that cannot go straight."""
    vehicle = scene.vehicle
    for number, wheel in enumerate(vehicle["wheel"], 1):
        if wheel.get("locked"):
            raise BadInput(f"{scene.path}: {scene.wheel_places[number - 1]}: wheel {number} is locked, so there is no "
                           "steady motion to analyse; take locked out")
    names = [hinge.name for hinge in scene.hinges]
    limbs = []
    for hinge, body in zip(scene.hinges, vehicle["body"], strict=True):
        axles = _axles(vehicle["wheel"], hinge.name)
        places = [complex(w["x_m"], w["y_m"]) for w in vehicle["wheel"] if w.get("body") == hinge.name]
        parent = names.index(body["parent"]) + 1 if body["parent"] in names else 0
        limbs.append(Limb(hinge, parent, complex(body["hinge_x_m"], body["hinge_y_m"]), axles,
                          sum(places) / len(places) if places else 0j))
    carriage = _axles(vehicle["wheel"], None)
    lengths = [abs(axle.place) for axle in carriage] + [abs(limb.place) + abs(limb.middle) for limb in limbs]
    straight, turn = _allowed(scene, carriage)
    return Tree(scene, carriage, tuple(limbs), straight, turn, centre_of(vehicle), max([*lengths, 1e-3]))


def _axles(wheels: Sequence[Mapping[str, Any]], body: str | None) -> tuple[Axle, ...]:
    return tuple(Axle(number, complex(w["x_m"], w["y_m"]), _unit(w["axle_rad"]))
                 for number, w in enumerate(wheels, 1) if w["kind"] == "fixed" and w.get("body") == body)


def _unit(angle: float) -> complex:
    """A direction, exactly along an axis where it is but for rounding."""
    return complex(*(round(part) if abs(part - round(part)) < TINY else part
                     for part in (math.cos(angle), math.sin(angle))))


def _allowed(scene: Scene, carriage: Sequence[Axle]) -> tuple[complex, complex | None]:
    """Direction of straight motion, and the velocity of the origin at 1 rad/s on the spot."""
    rows = np.array([[a.direction.real, a.direction.imag] for a in carriage]).reshape(-1, 2)
    levers = np.array([a.lever for a in carriage])
    _, sizes, right = np.linalg.svd(rows) if len(rows) else (None, np.zeros(0), np.eye(2))
    rank = int(np.sum(sizes > TINY))
    if rank == 2:
        raise BadInput(f"{scene.path}: vehicle.wheel: fixed wheels of the carriage allow no straight motion; analyse "
                       "needs one")
    direction = _unit(math.atan2(right[rank][1], right[rank][0])) if rank else 1.0 + 0j
    if direction.real < -TINY or (abs(direction.real) <= TINY and direction.imag < 0.0):
        direction = -direction
    if not len(rows):
        return direction, 0j
    turn = np.linalg.lstsq(rows, -levers, rcond=None)[0]
    if np.abs(rows @ turn + levers).max() > TINY * max(1.0, float(np.abs(levers).max())):
        return direction, None
    return direction, complex(*(0.0 if abs(part) < TINY else part for part in turn))
