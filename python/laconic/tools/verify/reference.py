"""An independent reference: the equations again, in NumPy, integrated by SciPy with tight tolerances.

Nothing here touches the core. It works in the paper's pseudo-velocities ν with plain dense algebra (Ξ, A, a basis G of
the motions that the constraints leave), the core in principal axes; it restarts at every change of an input, the core
does not. So the two agree only if both are right.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from laconic.errors import BadInput
from laconic.scene import Scene
from laconic.scene.inputs import InputsOnGrid

RANK_TOLERANCE = 1e-9
STIFF_DECAYS = 2e4      # decay rate times duration above which an explicit solver would take too long

Values = Mapping[str, float]


@dataclass(frozen=True)
class Totals:
    """The vehicle with its payload: mass, centre of mass, yaw inertia about it; then what all wheels have in common,
    and what each wheel has."""

    mass_kg: float
    com_m: np.ndarray
    yaw_inertia_kgm2: float
    wheel_radius_m: float
    wheel_inertia_kgm2: float
    motor_gain_Nm_per_V: float
    motor_damping_Nms: float
    radii_m: np.ndarray
    inertias_kgm2: np.ndarray
    gains_Nm_per_V: np.ndarray
    dampings_Nms: np.ndarray


def totals_of(vehicle: Mapping[str, Any]) -> Totals:
    """Robot and payload about their common centre of mass (parallel axes), motor data at the wheel."""
    mass, com = vehicle["mass_kg"], np.array([vehicle.get("com_x_m", 0.0), vehicle.get("com_y_m", 0.0)])
    payload = vehicle.get("payload", {"mass_kg": 0.0, "x_m": 0.0, "y_m": 0.0, "yaw_inertia_kgm2": 0.0})
    payload_m = np.array([payload["x_m"], payload["y_m"]])
    total = mass + payload["mass_kg"]
    common = (mass * com + payload["mass_kg"] * payload_m) / total
    yaw = vehicle["yaw_inertia_kgm2"] + payload["yaw_inertia_kgm2"]
    yaw += mass * np.sum((com - common) ** 2) + payload["mass_kg"] * np.sum((payload_m - common) ** 2)
    gain, damping = vehicle.get("motor_gain_Nm_per_V", 0.0), vehicle.get("motor_damping_Nms", 0.0)
    wheel_inertia, rotor = vehicle["wheel_inertia_kgm2"], 0.0
    if motor := vehicle.get("motor"):
        ratio, resistance = motor["gear_ratio"], motor["resistance_ohm"]
        gain = ratio * motor["torque_constant_Nm_per_A"] / resistance
        braking = motor["torque_constant_Nm_per_A"] * motor["back_emf_Vs_per_rad"] / resistance
        damping = ratio**2 * (braking + motor["viscous_friction_Nms"])
        rotor = ratio**2 * motor["rotor_inertia_kgm2"]
    wheels = vehicle["wheel"]
    driven = np.array([float(wheel.get("driven", True)) for wheel in wheels])
    return Totals(
        total, common, float(yaw), vehicle["wheel_radius_m"], wheel_inertia + rotor, gain, damping,
        own_or_common(wheels, "radius_m", vehicle["wheel_radius_m"]),
        own_or_common(wheels, "inertia_kgm2", wheel_inertia) + driven * rotor,
        driven * own_or_common(wheels, "motor_gain_Nm_per_V", gain),
        driven * own_or_common(wheels, "motor_damping_Nms", damping))


def own_or_common(wheels: Sequence[Mapping[str, Any]], key: str, common: float) -> np.ndarray:
    """Each wheel's own value, else the vehicle's."""
    return np.array([float(wheel.get(key, common)) for wheel in wheels])


class Reference:
    """ν' = G (GᵀAG)⁻¹ Gᵀ [Λ⁻¹a(ν) + (MR²)⁻¹(Ξᵀ(c1 U + T) − Ξᵀ c2 Ξν + w)], with pose and wheel angles (4.1–4.7);
    J, c1 and c2 are diagonal, with each wheel's value."""

    def __init__(self, vehicle: Mapping[str, Any]):
        if vehicle.get("body"):
            raise BadInput("vehicle.body: this reference does not take vehicles with hinges; use laconic verify")
        self.totals = totals_of(vehicle)
        self.wheels = vehicle["wheel"]
        t = self.totals
        self.scale = 1.0 / (t.mass_kg * t.wheel_radius_m**2)
        self.yaw_scale = math.sqrt(t.yaw_inertia_kgm2 * self.scale)  # Λ
        rows = np.array([self._row(w, roller_of(w)) for w in self.wheels]).reshape(-1, 3)
        self.rows = rows * (t.wheel_radius_m / t.radii_m)[:, None]  # Ξ
        self.inertia = np.eye(3) + self.scale * self.rows.T @ (t.inertias_kgm2[:, None] * self.rows)  # A
        basis = self._basis()
        self.mobility = basis @ np.linalg.inv(basis.T @ self.inertia @ basis) @ basis.T
        self.damping = self.mobility @ (self.scale * self.rows.T @ (t.dampings_Nms[:, None] * self.rows))

    def _row(self, wheel: Mapping[str, Any], angle_rad: float) -> np.ndarray:
        """Velocity of the wheel's centre along β + angle, over R sin(angle)."""
        along = wheel["axle_rad"] + angle_rad
        arm = np.array([wheel["x_m"], wheel["y_m"]]) - self.totals.com_m
        lever = (arm[0] * math.sin(along) - arm[1] * math.cos(along)) / (self.totals.wheel_radius_m * self.yaw_scale)
        return np.array([math.cos(along), math.sin(along), lever]) / math.sin(angle_rad)

    def _lateral(self, wheel: Mapping[str, Any]) -> np.ndarray:
        """Velocity of a fixed wheel's centre along its axle: the constraint keeps it at zero."""
        arm = np.array([wheel["x_m"], wheel["y_m"]]) - self.totals.com_m
        cosine, sine = math.cos(wheel["axle_rad"]), math.sin(wheel["axle_rad"])
        lever = (arm[0] * sine - arm[1] * cosine) / (self.totals.wheel_radius_m * self.yaw_scale)
        return np.array([cosine, sine, lever])

    def _basis(self) -> np.ndarray:
        """Orthonormal columns that span the ν which no fixed or locked wheel forbids."""
        bound = [self._lateral(w) for w in self.wheels if w["kind"] == "fixed"]
        bound += [row for w, row in zip(self.wheels, self.rows, strict=True) if w.get("locked")]
        if not bound:
            return np.eye(3)
        _, sizes, directions = np.linalg.svd(np.array(bound))
        rank = int(np.sum(sizes > RANK_TOLERANCE * sizes[0]))
        return directions[rank:].T

    def fastest_decay_per_s(self) -> float:
        """The largest damping rate."""
        return float(np.max(np.abs(np.linalg.eigvals(self.damping))))

    def nu(self, scene: Scene) -> np.ndarray:
        """The scene's initial ν."""
        start = scene.initial
        if start.nu_rad_per_s is not None:
            return np.array(start.nu_rad_per_s)
        velocity = np.array(start.velocity_body_m_per_s) / self.totals.wheel_radius_m
        return np.array([*velocity, self.yaw_scale * start.yaw_rate_rad_per_s])

    def forcing_terms(self, values: Values) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Forcing of ν' by the inputs: a constant, and the factors of cos θ and sin θ (force given in the world)."""
        t = self.totals
        numbers = range(1, len(self.wheels) + 1)
        torque = np.array([t.gains_Nm_per_V[i - 1] * values.get(f"voltage_V[{i}]", 0.0)
                           + values.get(f"axle_torque_Nm[{i}]", 0.0) for i in numbers])
        body = np.array([values.get(f"body_force_N[{i}]", 0.0) for i in (1, 2)])
        world = np.array([values.get(f"world_force_N[{i}]", 0.0) for i in (1, 2)])
        point = np.array([values.get(f"world_force_point_m[{i}]", 0.0) for i in (1, 2)])
        constant = self.rows.T @ torque + self._wrench(body, values.get("body_moment_Nm", 0.0))
        rotated = np.array([world[1], -world[0]])  # world force in body axes: cos θ · world + sin θ · rotated
        parts = [self._wrench(f, point[0] * f[1] - point[1] * f[0]) for f in (world, rotated)]
        return tuple(self.mobility @ (self.scale * part) for part in (constant, *parts))

    def _wrench(self, force: np.ndarray, moment: float) -> np.ndarray:
        radius = self.totals.wheel_radius_m
        return np.array([radius * force[0], radius * force[1], moment / self.yaw_scale])

    def rates(self, state: np.ndarray, terms: tuple[np.ndarray, ...]) -> np.ndarray:
        """d/dt of (ν, x, y, θ, χ)."""
        nu, (constant, cosine_part, sine_part) = state[:3], terms
        cosine, sine = math.cos(state[5]), math.sin(state[5])
        gyroscopic = np.array([nu[1] * nu[2], -nu[0] * nu[2], 0.0]) / self.yaw_scale
        out = np.empty_like(state)
        out[:3] = self.mobility @ gyroscopic - self.damping @ nu + constant + cosine * cosine_part + sine * sine_part
        radius = self.totals.wheel_radius_m
        out[3] = radius * (nu[0] * cosine - nu[1] * sine)
        out[4] = radius * (nu[0] * sine + nu[1] * cosine)
        out[5] = nu[2] / self.yaw_scale
        out[6:] = self.rows @ nu
        return out

    def solve(self, state: np.ndarray, begin_s: float, at_s: np.ndarray, values: Callable[[float], Values] | Values,
              rtol: float, atol: float) -> np.ndarray:
        """States at some instants after `begin_s`, with inputs that are smooth from there to the last instant."""
        from scipy.integrate import solve_ivp  # slow to import

        if callable(values):
            def right(t: float, y: np.ndarray) -> np.ndarray:
                return self.rates(y, self.forcing_terms(values(t)))
        else:
            terms = self.forcing_terms(values)

            def right(t: float, y: np.ndarray) -> np.ndarray:
                return self.rates(y, terms)
        stiff = self.fastest_decay_per_s() * (at_s[-1] - begin_s) > STIFF_DECAYS
        rows, first_step = [], None
        for end in at_s:  # one call per instant: the solver's interpolation between its steps is less accurate
            found = solve_ivp(right, (begin_s, end), state, "LSODA" if stiff else "DOP853", rtol=rtol, atol=atol,
                              first_step=first_step and min(first_step, end - begin_s))
            if not found.success:
                raise RuntimeError(f"the reference at t = {end:g} s: {found.message}")
            state, begin_s = found.y[:, -1], end
            first_step = float(np.max(np.diff(found.t)))
            rows.append(state)
        return np.array(rows)


def kinks(inputs: InputsOnGrid) -> list[float]:
    """Instants within the run where an input jumps or bends."""
    end = inputs.steps * inputs.step_s
    times = {t for each in inputs.given for t in each.t_s if 0.0 < t < end * (1.0 - 1e-12)}
    return sorted(times)


def values_at(inputs: InputsOnGrid, time_s: float, from_s: float) -> Values:
    """Input values at an instant of the smooth stretch that begins at `from_s`."""
    found = dict.fromkeys(inputs.signals, 0.0)
    for each in inputs.given:
        if each.kind == "steps":
            passed = np.searchsorted(each.t_s, from_s * (1.0 + 1e-12), side="right")
            found[each.signal] += each.value[passed - 1] if passed else 0.0
        else:
            found[each.signal] += float(each.at(np.array(time_s)))
    return found


def reference_states(scene: Scene, at_s: np.ndarray, rtol: float = 1e-12, atol: float = 1e-13) -> np.ndarray:
    """States (ν, x, y, θ, χ) of a scene at some instants, ascending, the first not before 0."""
    reference, inputs, start = Reference(scene.vehicle), scene.inputs_on_grid(), scene.initial
    state = np.concatenate([reference.nu(scene), [start.x_m, start.y_m, start.heading_rad],
                            np.zeros(len(reference.wheels))])
    rows = np.empty((len(at_s), len(state)))
    rows[at_s == 0.0] = state
    edges = [0.0, *kinks(inputs), float(max(at_s[-1], 0.0))]
    for begin, end in pairwise(edges):
        if end <= begin:
            continue
        inside = (at_s > begin) & (at_s <= end)
        instants = np.unique(np.append(at_s[inside], end))
        held = values_at(inputs, begin, begin)
        values = held if inputs.is_held else (lambda t, begin=begin: values_at(inputs, t, begin))
        states = reference.solve(state, begin, instants, values, rtol, atol)
        rows[inside] = states[np.searchsorted(instants, at_s[inside])]
        state = states[-1]
    return rows


def roller_of(wheel: Mapping[str, Any]) -> float:
    """γ; a fixed wheel rolls like an omni wheel, with a constraint added."""
    return math.pi / 2 if wheel["kind"] == "fixed" else wheel.get("roller_rad", math.pi / 2)
