"""Straight motion of vehicles with hinges: how fast a small angle of each hinge grows or decays.

A hinge whose wheels follow obeys an exact law while the carriage goes straight at the speed v: a small angle grows like
e^{λt} with λ = n · (iV)/ℓ, which is −v/a for a caster of trail a or a trailer of length a. The whole motion, in which
bodies also move the carriage, is linearised with the core's own accelerations. A force at the centre of mass of body 0
and a moment hold the speed, as motors would.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from laconic.core.articulated import ArticulatedPlant, ArticulatedVehicle
from laconic.errors import BadInput, Refused
from laconic.simulation.articulated import rolling_rates
from laconic.tools.analyse.hinged_turns import Tree

CHANGE = 1e-3     # of angles and, in their own units, of velocities
WEIGHTS = {1.0: 2.0 / 3.0, 2.0: -1.0 / 12.0}  # of a central difference of fourth order
AGREEMENT = 1e-6  # between the exact law and the core, of the largest growth
ROUNDING = 1e-12  # of the matrix: it splits an m-fold eigenvalue by its m-th root, and the mean of the m is exact
ROUNDINGS = 1e3   # that add up in an acceleration
NOTHING = 1e-6    # of the largest eigenvalue
OUTSIDE = ("body_force_N[1]", "body_force_N[2]", "body_moment_Nm")


@dataclass(frozen=True)
class StraightMotion:
    """One speed. `growth_per_s` has None for hinges whose angle no wheel of their own sets."""

    speed_m_per_s: float
    growth_per_s: tuple[float | None, ...]       # by the exact law
    core_growth_per_s: tuple[float | None, ...]  # the same by the core
    eigenvalues_per_s: tuple[complex, ...]       # of the whole motion, the largest real part first
    held_by: tuple[float, float, float]          # force in body axes [N] and moment [N·m] that hold the speed

    @property
    def agrees(self) -> bool:
        """Whether the core confirms the exact law."""
        pairs = [(a, b) for a, b in zip(self.growth_per_s, self.core_growth_per_s, strict=True)
                 if a is not None and b is not None]
        size = max([abs(a) for a, _ in pairs], default=1.0)
        return all(abs(a - b) <= AGREEMENT * size for a, b in pairs)


class _Motions:
    """Motions near one straight motion, as rows of hinge angles, carriage velocities and hinge rates."""

    def __init__(self, tree: Tree, vehicle: ArticulatedVehicle, speed_m_per_s: float, angles: np.ndarray):
        self.tree, self.vehicle, self.angles = tree, vehicle, angles
        self.velocity = speed_m_per_s * tree.straight
        self.commands = {}
        if any(limb.hinge.kind == "coordinated" for limb in tree.limbs):
            self.commands = {"steering_twist": [tree.straight.real, tree.straight.imag, 0.0]}
        self.free = [k for k, limb in enumerate(tree.limbs) if limb.hinge.kind in ("free", "motor")]
        self.inputs: dict[str, float | list[float]] = dict(self.commands)

    def plant(self, angles: np.ndarray, velocity: complex, yaw_rate: float, rates: np.ndarray) -> ArticulatedPlant:
        """One of them, as near to it as the wheels allow."""
        pair = (velocity.real, velocity.imag)
        given = rolling_rates(self.vehicle, pair, yaw_rate, list(angles), list(rates))
        return self.vehicle.plant(velocity_m_per_s=pair, yaw_rate_rad_per_s=yaw_rate, hinge_angle_rad=list(angles),
                                  hinge_rate_rad_per_s=given, inputs=self.commands)

    def states(self, plant: ArticulatedPlant) -> tuple[np.ndarray, np.ndarray]:
        """The row, and its rate of change under the inputs."""
        motion = plant.motion()
        twist, twist_rate = plant.rates(self.inputs)
        parents = np.array([limb.parent for limb in self.tree.limbs], int)
        hinge_rates = np.zeros(len(parents)) if not len(parents) else twist_rate[1:, 2] - twist_rate[parents, 2]
        row = np.concatenate([motion.hinge_angle_rad[self.free], twist[0], motion.hinge_rate_rad_per_s[self.free]])
        rate = np.concatenate([motion.hinge_rate_rad_per_s[self.free], twist_rate[0], hinge_rates[self.free]])
        return row, rate

    def hold(self) -> tuple[float, float, float]:
        """Force and moment, and torques of free hinges, that keep the motion as it is."""
        plant = self.plant(self.angles, self.velocity, 0.0, np.zeros(len(self.angles)))
        torques = [f"hinge_torque_Nm[{self.tree.limbs[k].hinge.name}]" for k in self.free]
        signals = (*OUTSIDE, *torques)
        _, still = self.states(plant)
        columns = []
        for signal in signals:
            self.inputs = {**self.commands, signal: 1.0}
            columns.append(self.states(plant)[1] - still)
        needed = np.linalg.lstsq(np.array(columns).T, -still, rcond=1e-12)[0]
        self.inputs = {**self.commands, **{s: float(v) for s, v in zip(signals, needed, strict=True)}}
        self.check_steady(self.states(plant)[1], max(1.0, float(np.abs(still).max())))
        return float(needed[0]), float(needed[1]), float(needed[2])

    def check_steady(self, rate: np.ndarray, size: float) -> None:
        """BadInput with the cause where what holds the motion leaves it accelerations above rounding, which grows as
        the wheels of a hinge come near to it."""
        left = np.abs(rate) / (1e-7 * size + ROUNDINGS * np.finfo(float).eps * self.sizes()**2)
        worst = int(np.argmax(left))
        if left[worst] <= 1.0:
            return
        hinge = self.free[worst % (len(self.free) + 3)] if worst % (len(self.free) + 3) < len(self.free) else None
        start = f"{self.tree.scene.path}: straight motion at {abs(self.velocity):g} m/s is not steady"
        if hinge is None:
            raise BadInput(f"{start}: no force on the carriage and no torque of a hinge holds it; see the springs and "
                           "start angles of its hinges")
        limb = self.tree.limbs[hinge]
        lever = f", whose wheels lie {abs(limb.axles[0].lever):.3g} m from it," if limb.follows else ""
        raise BadInput(f"{start}: {limb.hinge.place} ({limb.hinge.name}){lever} keeps no angle; give it a longer trail"
                       f"{'' if limb.follows else ', a spring or another start angle'}")

    def sizes(self) -> np.ndarray:
        """How fast each number of the row changes: 1, and of hinges that follow the growth of their angle."""
        of_hinges = [max(1.0, abs(self.velocity) / abs(limb.axles[0].lever)) if limb.follows else 1.0
                     for limb in (self.tree.limbs[k] for k in self.free)]
        return np.array([*of_hinges, 1.0, 1.0, 1.0, *of_hinges])

    def changed(self, number: int, change: float) -> ArticulatedPlant:
        """With one number of the row changed."""
        count = len(self.free)
        angles, rates, velocity, yaw = self.angles.copy(), np.zeros(len(self.angles)), self.velocity, 0.0
        if number < count:
            angles[self.free[number]] += change
        elif number < count + 2:
            velocity += change * (1.0 if number == count else 1j)
        elif number == count + 2:
            yaw = change
        else:
            rates[self.free[number - count - 3]] = change
        return self.plant(angles, velocity, yaw, rates)

    def linearised(self) -> np.ndarray:
        """The matrix of the linearised motion, on the motions that the wheels allow."""
        tangents, slopes = [], []
        for number in range(2 * len(self.free) + 3):
            tangent, slope = np.zeros(2 * len(self.free) + 3), np.zeros(2 * len(self.free) + 3)
            for step, weight in WEIGHTS.items():
                (up, rate_up), (down, rate_down) = (self.states(self.changed(number, sign * step * CHANGE))
                                                    for sign in (1.0, -1.0))
                tangent += weight / CHANGE * (up - down)
                slope += weight / CHANGE * (rate_up - rate_down)
            tangents.append(tangent)
            slopes.append(slope)
        scale = np.concatenate([np.ones(len(self.free) + 3), 1.0 / self.sizes()[len(self.free) + 3:]])
        tangents, slopes = [scale * each for each in tangents], [scale * each for each in slopes]
        left, sizes, right = np.linalg.svd(np.array(tangents).T)
        kept = sizes > 1e-5 * sizes[0]
        return np.asarray(left[:, : len(sizes)][:, kept].T @ np.array(slopes).T @ right[: len(sizes)][kept].T
                          / sizes[kept])

    def core_growth(self, hinge: int) -> float:
        """Growth of one hinge's angle behind a parent that is held on its way, by the core."""
        found, pair = 0.0, (self.velocity.real, self.velocity.imag)
        for step, weight in WEIGHTS.items():
            for sign in (1.0, -1.0):
                angles = self.angles.copy()
                angles[hinge] += sign * step * CHANGE
                rates = rolling_rates(self.vehicle, pair, 0.0, list(angles), [0.0] * len(angles))
                found += sign * weight * rates[hinge] / CHANGE
        return found


def straight_motion(tree: Tree, vehicle: ArticulatedVehicle, speed_m_per_s: float) -> StraightMotion:
    """Growth of all hinges at one speed; below 0 the vehicle reverses with its casters and trailers as they were."""
    circles = tree.circles(tree.twist(0.0))
    for each in circles:
        if each.problem:
            raise BadInput(f"{tree.scene.path}: there is no straight motion: {each.problem}")
    angles = np.array([limb.hinge.start_angle_rad if each.angle_rad is None else each.angle_rad
                       for limb, each in zip(tree.limbs, circles, strict=True)])
    motions = _Motions(tree, vehicle, speed_m_per_s, angles)
    try:
        held, matrix = motions.hold(), motions.linearised()
    except Refused as refused:
        raise tree.scene.refusal_in_file(refused, f"straight motion at {speed_m_per_s:g} m/s") from None
    growth = tuple(None if each.growth is None else each.growth * speed_m_per_s for each in circles)
    by_core = tuple(None if each is None else motions.core_growth(k) for k, each in enumerate(growth))
    eigenvalues = _settled(np.linalg.eigvals(matrix), [each for each in growth if each is not None],
                           abs(speed_m_per_s) / tree.size_m)
    return StraightMotion(speed_m_per_s, growth, by_core, tuple(eigenvalues), held)


def _settled(values: np.ndarray, growth: Sequence[float], typical: float) -> list[complex]:
    """Eigenvalues, the largest real part first; those that are a repeated growth of hinges as their mean.

    What is far below the largest and below the typical one is 0.
    """
    left, found = list(map(complex, values)), list[complex]()
    size = max([abs(z) for z in left] + [typical])
    for value in dict.fromkeys(round(each, 9) for each in growth):
        count = sum(abs(each - value) < 1e-8 for each in growth)
        near = sorted(left, key=lambda z: abs(z - value))[:count]  # noqa: B023
        if count > 1 and all(abs(z - value) <= size * ROUNDING**(1.0 / count) for z in near):
            for each in near:
                left.remove(each)
            found += [complex((sum(near) / count).real)] * count
    found += [0j if abs(z) <= NOTHING * size else complex(z.real, z.imag if abs(z.imag) > NOTHING * size else 0.0)
              for z in left]
    return sorted(found, key=lambda z: (-z.real, -z.imag))
