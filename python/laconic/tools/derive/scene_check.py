"""The C core's derivative against the derived equations, at random states and inputs; of trees also Maggi's (1.2).

Checks of a derivation by numbers: the three forms against each other, and the C core against the derived rates.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import sympy as sp

from laconic.core.articulated import ArticulatedVehicle
from laconic.core.articulated_input import member_of, row_of_hinges
from laconic.errors import Refused
from laconic.tools.analyse.from_core import Subject, nu_rates
from laconic.tools.derive.brackets import Bracketed
from laconic.tools.derive.equations import System, laconic_2_3, laconic_2_4, maggi
from laconic.tools.derive.scene_system import rate_function
from laconic.tools.derive.tree_printing import with_numbers
from laconic.tools.derive.tree_system import (
    OUTER,
    OWN,
    PRESCRIBED,
    SLOPE,
    TIME,
    TWIST,
    Tree,
    TreeNumbers,
    pseudo_velocities,
)


def random_values(symbols: list[sp.Symbol], rng: np.random.Generator, count: int) -> np.ndarray:
    """Rows of random numbers for symbols; positive ones get positive numbers away from zero."""
    sizes = rng.uniform(0.5, 2.0, (count, len(symbols)))
    signs = rng.choice([-1.0, 1.0], (count, len(symbols)))
    return np.where([bool(s.is_positive) for s in symbols], sizes, sizes * signs)


def forms_difference(system: System, *, count: int = 20, seed: int = 1) -> float:
    """Largest difference between (2.3), (2.4) and (1.2) at random numbers, over the size of the equations' terms."""
    forms = [laconic_2_3(system), laconic_2_4(system), maggi(system)]
    symbols = sorted(set().union(*(e.free_symbols for form in forms for e in form)), key=str)
    evaluate = sp.lambdify(symbols, forms, "math")
    worst = 0.0
    for row in random_values(symbols, np.random.default_rng(seed), count):
        values = np.array(evaluate(*row), dtype=float)
        worst = max(worst, float(np.abs(values - values[0]).max() / max(1.0, np.abs(values).max())))
    return worst


def core_difference(subject: Subject, system: Bracketed, *, count: int = 1000, seed: int = 2) -> float:
    """Largest difference of ν' over `count` random states, over the size of what is added up in it."""
    rng, core, n = np.random.default_rng(seed), subject.core, subject.wheel_count
    derived = rate_function(subject.numbers(), system)
    basis = np.linalg.svd(core.numbers(subject.model.nu_of_zeta, 3, 3)[:, : subject.model.dof])[0]
    allowed = basis[:, : subject.model.dof]
    worst = 0.0
    for _ in range(count):
        nu = allowed @ rng.normal(0.0, 5.0, allowed.shape[1])
        theta = rng.uniform(-10.0, 10.0)
        inputs: dict[str, Any] = {
            "voltage_V": rng.normal(0.0, 5.0, n), "axle_torque_Nm": rng.normal(0.0, 0.5, n),
            "body_force_N": rng.normal(0.0, 2.0, 2), "body_moment_Nm": rng.normal(0.0, 0.5),
            "world_force_N": rng.normal(0.0, 2.0, 2), "world_force_point_m": rng.normal(0.0, 0.2, 2),
        }
        found = nu_rates(core, subject.model, nu, theta, core.input(inputs, n))
        wrench = (*inputs["body_force_N"], inputs["body_moment_Nm"])
        expected = derived(nu, theta, inputs["voltage_V"], inputs["axle_torque_Nm"], wrench,
                           inputs["world_force_N"], inputs["world_force_point_m"])
        worst = max(worst, float(np.abs(found - expected).max() / max(1.0, np.abs(expected).max())))
    return worst


# ----------------------------------------------------------------------------- vehicles with hinges


def tree_forms_difference(tree: Tree, *, count: int = 20, seed: int = 1) -> float:
    """Largest difference of the equations from Maggi's (1.2) at random numbers, over the size of their terms.

    Equations by (2.4) are compared with (2.3), too. The other forms keep theta, and forces in the axes of body 0."""
    system, now = tree.system, {TIME: sp.S.Zero}
    found = [tree.mass * sp.Matrix(system.pseudo_rates) - tree.push, sp.Matrix(maggi(system)).xreplace(now)]
    if all(body.motion < PRESCRIBED for body in tree.numbers.bodies):
        found.append(sp.Matrix(laconic_2_3(system)))
    symbols = sorted(set().union(*(each.free_symbols for each in found)), key=str)
    evaluate = sp.lambdify(symbols, found, "numpy", cse=True)
    worst = 0.0
    for row in random_values(symbols, np.random.default_rng(seed), count):
        values = np.array([np.ravel(each) for each in evaluate(*row)])
        worst = max(worst, float(np.abs(values - values[0]).max() / max(1.0, np.abs(values).max())))
    return worst


def tree_rates(tree: Tree) -> Callable[..., np.ndarray]:
    """Numeric eta' of one row of numbers by the name of their symbols."""
    numbers = tree.numbers
    results = with_numbers(tree, [tree.mass, tree.push, tree.constraint, tree.drift])
    symbols = sorted({s for each in results for s in each.free_symbols}, key=str)
    compiled = sp.lambdify(symbols, results, "numpy", cse=True)
    unknown, rows = len(tree.system.pseudo_rates), len(numbers.left)

    def rates(given: dict[str, float]) -> np.ndarray:
        mass, push, constraint, drift = compiled(*(given[s.name] for s in symbols))
        matrix, right = np.zeros((unknown + rows,) * 2), np.zeros(unknown + rows)
        matrix[:unknown, :unknown], right[:unknown] = mass, np.ravel(push)
        if rows:
            matrix[:unknown, unknown:], matrix[unknown:, :unknown] = -np.transpose(constraint), constraint
            right[unknown:] = np.ravel(drift)
        return np.asarray(np.linalg.solve(matrix, right)[:unknown])

    return rates


def eta_of(numbers: TreeNumbers, twists: np.ndarray, twist: np.ndarray) -> np.ndarray:
    """The pseudo-velocities of the core's twists of all bodies; `twist`: T of the centre of mass."""
    carriage = [twists[0] @ twist / (twist @ twist)] if numbers.coordinated else [twists[0, k] for k in numbers.kept]
    return np.array([*carriage, *(twists[b, 2] for b, body in enumerate(numbers.bodies) if body.motion == OWN)])


class RandomMoments:
    """Random states and inputs of a vehicle, as the core takes them and by the names of symbols."""

    def __init__(self, numbers: TreeNumbers, vehicle: ArticulatedVehicle, seed: int):
        self.numbers, self.vehicle, self.rng = numbers, vehicle, np.random.default_rng(seed)
        basis = numbers.basis.xreplace({s: sp.Float(v, 17) for s, v in numbers.values.items()})
        self.basis = np.array(basis, float).reshape(3, -1)
        self.com = [float(numbers.values.get(c, c)) for c in numbers.com]

    def _twist(self) -> np.ndarray:
        """T of the centre of mass: one that the carriage's own wheels allow."""
        return np.asarray(self.basis @ self.rng.uniform(0.4, 1.5, self.basis.shape[1]))

    def _origin(self, twist: np.ndarray) -> np.ndarray:
        x, y = self.com
        return twist + twist[2] * np.array([y, -x, 0.0])

    def next(self) -> tuple[dict[str, float], np.ndarray, np.ndarray]:
        """Numbers by names, eta and the core's eta'; moments that the core refuses are passed over."""
        while True:
            try:
                return self._moment()
            except Refused:
                continue

    def _moment(self) -> tuple[dict[str, float], np.ndarray, np.ndarray]:
        rng, numbers, vehicle = self.rng, self.numbers, self.vehicle
        hinges, wheels, core = vehicle.body_count, vehicle.wheel_count, vehicle.core
        twist, twist_rate = self._twist(), self._twist() - self._twist()
        signals: dict[str, Any] = {
            "voltage_V": rng.normal(0.0, 5.0, wheels), "axle_torque_Nm": rng.normal(0.0, 0.5, wheels),
            "body_force_N": rng.normal(0.0, 2.0, 2), "body_moment_Nm": rng.normal(0.0, 0.5),
            "world_force_N": rng.normal(0.0, 2.0, 2), "world_force_point_m": rng.normal(0.0, 0.2, 2),
            "hinge_voltage_V": rng.normal(0.0, 2.0, hinges), "hinge_torque_Nm": rng.normal(0.0, 0.5, hinges),
            "steering_rate_rad_per_s": rng.normal(0.0, 0.5, hinges), "steering_twist": self._origin(twist)}
        row = row_of_hinges(core, vehicle.names, wheels, signals)  # also what this vehicle does not read
        acceleration = rng.normal(0.0, 0.5, hinges)
        for name, value in (("hinge_acceleration_rad_per_s2", acceleration), ("twist_rate", self._origin(twist_rate))):
            start, _ = member_of(core, name)
            row[start : start + len(value)] = value
        plant = vehicle.plant(velocity_m_per_s=list(rng.normal(0.0, 1.0, 2)), yaw_rate_rad_per_s=rng.normal(0.0, 0.5),
                              heading_rad=rng.uniform(-3.0, 3.0), hinge_angle_rad=list(rng.uniform(-1.2, 1.2, hinges)),
                              hinge_rate_rad_per_s=list(rng.normal(0.0, 1.0, hinges)), inputs=row)
        twists, rates = plant.rates(row)
        eta = eta_of(numbers, twists, twist)
        change = rates.copy()
        if numbers.coordinated:
            change[0] -= eta[0] * twist_rate
        motion = plant.motion()
        signals |= {"hinge_acceleration_rad_per_s2": acceleration, "twist_rate": self._origin(twist_rate),
                    "psi": motion.hinge_angle_rad, "heading_rad": motion.heading_rad}
        self.signals, self.motion = signals, motion
        return self._by_names(signals, eta), eta, eta_of(numbers, change, twist)

    def _by_names(self, signals: dict[str, Any], eta: np.ndarray) -> dict[str, float]:
        cos, sin = np.cos(signals["heading_rad"]), np.sin(signals["heading_rad"])
        turned = np.array([[cos, sin], [-sin, cos]])
        force, (x, y) = turned @ signals["world_force_N"], signals["world_force_point_m"]
        wrench = [*(signals["body_force_N"] + force), signals["body_moment_Nm"] + x * force[1] - y * force[0]]
        found = {s.name: value for s, value in zip(pseudo_velocities(self.numbers), eta, strict=True)}
        found |= {s.name: value for s, value in zip(OUTER, wrench, strict=True)}
        found |= {s.name: value for s, value in zip(SLOPE, turned @ self.numbers.sloped, strict=True)}
        of_hinges = {"psi_{}": "psi", "r_{}": "steering_rate_rad_per_s", "r_{}'": "hinge_acceleration_rad_per_s2",
                     "Y_{}": "hinge_voltage_V", "S_{}": "hinge_torque_Nm", "U_{}": "voltage_V",
                     "T_{}": "axle_torque_Nm"}
        for name, key in of_hinges.items():
            found |= {name.format(k): value for k, value in enumerate(signals[key], 1)}
        found |= dict(zip(TWIST, signals["steering_twist"], strict=True))
        found |= {f"{name}'": value for name, value in zip(TWIST, signals["twist_rate"], strict=True)}
        return {name: float(value) for name, value in found.items()}


def tree_core_difference(tree: Tree, vehicle: ArticulatedVehicle, *, count: int = 200, seed: int = 2) -> float:
    """Largest difference of eta' from the core's over random moments, over the size of what is added up in it."""
    moments, derived, worst = RandomMoments(tree.numbers, vehicle, seed), tree_rates(tree), 0.0
    for _ in range(count):
        given, _, found = moments.next()
        worst = max(worst, float(np.abs(found - derived(given)).max() / max(1.0, np.abs(found).max())))
    return worst
