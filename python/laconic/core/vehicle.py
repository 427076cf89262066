"""A vehicle as a Python program knows it: built or taken from a scene, with its matrices, rates and linearisation.

    robot = Vehicle({"mass_kg": 10.0, …, "wheel": [{"kind": "omni", "x_m": 0.1, …}, …]})
    rates = robot.derivative(nu_rad_per_s=(1.0, 0.0, 0.2), inputs={"voltage_V": [6.0, -6.0, 0.0]})
    plant = robot.plant(step_s=0.01)
    plant.run({"voltage_V": [6.0, -6.0, 0.0]}, steps=100)
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from laconic.core.binding import Core, Matrices, load
from laconic.core.copies import OwnMemory
from laconic.core.given import finite_number, finite_numbers
from laconic.core.inputs import check_finite_input
from laconic.core.plant import Plant
from laconic.errors import BadInput

if TYPE_CHECKING:
    from laconic.scene import Scene

Inputs = Mapping[str, float | Sequence[float]]
"""Inputs by their names in a scene: {"voltage_V": [1.0, 2.0], "body_moment_Nm": 0.1}; what is left out is 0. A list has
one number for each wheel; voltage_V[2] is that of one."""
STATES = ("nu_rad_per_s[1]", "nu_rad_per_s[2]", "nu_rad_per_s[3]", "x_m", "y_m", "heading_rad")


@dataclass(frozen=True)
class Rates:
    """How fast a motion changes, for a vehicle with N wheels."""

    nu_rad_per_s2: np.ndarray          # (3,)  ν'
    velocity_m_per_s: np.ndarray       # (2,)  of the centre of mass, world axes
    yaw_rate_rad_per_s: float
    wheel_speed_rad_per_s: np.ndarray  # (N,)  χ'


@dataclass(frozen=True)
class Linearisation:
    """δs' = state_matrix δs + voltage_matrix δU about one motion, s = (ν1, ν2, ν3, x, y, θ) as in `STATES`."""

    state_matrix: np.ndarray    # (6, 6)
    voltage_matrix: np.ndarray  # (6, N)  by each wheel's voltage, 1 V


class Vehicle(OwnMemory):
    """A checked vehicle in one scalar type, which does not move: `plant` makes one that does.

    `table` has the keys of a scene's `[vehicle]` (docs/scenes.md), with "wheel", "support", "motor", "payload", "drive"
    as tables inside and the scene's `[ground]` as "ground", spelled as a scene may spell them: angles in rad or with
    `_deg` at the key's end, a wheel's place by x_m and y_m or by distance_m and bearing_rad. Mass, yaw inertia and
    wheel radius must be given, of a wheel its kind, of a motor what a scene must give, of a support its place; what
    else is left out is 0. Raises BadInput for a key that is unknown, missing or given twice and for what is no number,
    Refused for numbers that make no vehicle; all name the field.
    """

    def __init__(self, table: Mapping[str, Any], real: str = "double"):
        core = load(real)
        self._set(core, core.vehicle(table))

    @classmethod
    def of(cls, scene: Scene) -> Vehicle:
        """That of a scene, in the scene's scalar type; BadInput for what is no Scene."""
        from laconic.scene import check_scene  # which is above this room

        made = cls.__new__(cls)
        if check_scene(scene).has_hinges:
            raise BadInput(f"{scene.path}: {scene.hinges[0].place}: laconic.Vehicle does not take vehicles with hinges"
                           "; use laconic.ArticulatedVehicle.of(scene)")
        core = scene.core()
        made._set(core, scene.c_vehicle(core))
        return made

    def _set(self, core: Core, vehicle: Any) -> None:
        core.check_vehicle(vehicle)
        self.core, self.c, self.model = core, vehicle, core.prepare(vehicle)

    @property
    def wheel_count(self) -> int:
        """N."""
        return int(self.c.wheel_count)

    @property
    def has_friction(self) -> bool:
        """Whether its wheels have states of their own: ground with friction, or motors with limits."""
        return bool(self.core.lib.laconic_vehicle_has_friction(self.c))

    def matrices(self) -> Matrices:
        """The matrices of the paper: Ξ (N, 3), A (3, 3), A⁻¹ (3, 3), C (constraints, 3), Λ, λ."""
        return self.core.matrices(self.c)

    def derivative(self, nu_rad_per_s: Sequence[float] | np.ndarray = (0.0, 0.0, 0.0), heading_rad: float = 0.0,
                   inputs: Inputs | None = None) -> Rates:
        """The right-hand side of the equations of motion (4.7) at a motion.

        `nu_rad_per_s`: ν, three numbers in rad/s, first projected onto what the constraints allow. `inputs`: held ones.
        Raises BadInput for what does not fit, and for a vehicle with friction: its rates depend on wheels that slip;
        Refused where a rate leaves the range of numbers.
        """
        self._has_no_friction("derivative")
        nu, heading, held = self._at(nu_rad_per_s, heading_rad, inputs)
        found = self.core.derivative(self.model, nu, heading, held)
        rates = Rates(self.core.numbers(found.nu_rad_per_s2), np.array([found.x_m_per_s, found.y_m_per_s]),
                      float(found.yaw_rate_rad_per_s),
                      self.core.numbers(found.wheel_speed_rad_per_s)[:self.wheel_count])
        self.core.check_range("derivative", rates.nu_rad_per_s2, rates.velocity_m_per_s, rates.yaw_rate_rad_per_s,
                              rates.wheel_speed_rad_per_s)
        return rates

    def linearise(self, nu_rad_per_s: Sequence[float] | np.ndarray = (0.0, 0.0, 0.0), heading_rad: float = 0.0,
                  inputs: Inputs | None = None) -> Linearisation:
        """The analytic derivatives of the rates by state and voltages at a motion; raises as `derivative`."""
        self._has_no_friction("linearise")
        ffi = self.core.ffi
        nu, heading, held = self._at(nu_rad_per_s, heading_rad, inputs)
        at = ffi.new("laconic_motion *", {"nu_rad_per_s": nu, "heading_rad": heading})
        change = ffi.new("laconic_rates *")

        def column(by: Any) -> list[float]:
            self.core.lib.laconic_derivative_tangent(change, self.model, at, held, by)
            return [*change.nu_rad_per_s2, change.x_m_per_s, change.y_m_per_s, change.yaw_rate_rad_per_s]

        states: list[dict[str, Any]] = [{"nu_rad_per_s": [float(k == i) for k in range(3)]} for i in range(3)]
        states += [{name: 1.0} for name in STATES[3:]]
        of_states = [column(ffi.new("laconic_variation *", by)) for by in states]
        voltages = [{"input": {"voltage_V": [0.0] * i + [1.0]}} for i in range(self.wheel_count)]
        of_voltages = [column(ffi.new("laconic_variation *", by)) for by in voltages]
        found = Linearisation(np.array(of_states, self.core.dtype).T,
                              np.array(of_voltages, self.core.dtype).reshape(-1, len(STATES)).T)
        self.core.check_range("linearise", found.state_matrix, found.voltage_matrix)
        return found

    def plant(self, method: str = "auto", step_s: float = 1e-3, *, nu_rad_per_s: Sequence[float] = (0.0, 0.0, 0.0),
              x_m: float = 0.0, y_m: float = 0.0, heading_rad: float = 0.0,
              wheel_speed_rad_per_s: Sequence[float] = ()) -> Plant:
        """The vehicle at a start, ready to step by a method of `METHODS`.

        Raises Refused for a start that the constraints forbid and for a step that the method cannot take.
        """
        return self.core.plant(self.c, method, step_s, nu_rad_per_s=nu_rad_per_s, x_m=x_m, y_m=y_m,
                               heading_rad=heading_rad, wheel_speed_rad_per_s=wheel_speed_rad_per_s)

    def _at(self, nu_rad_per_s: Any, heading_rad: Any, inputs: Inputs | None) -> tuple[list[float], float, Any]:
        """A motion and its held inputs; BadInput for a number that is not finite."""
        held = check_finite_input(self.core, self.core.input(inputs, self.wheel_count))
        nu = finite_numbers("nu_rad_per_s", nu_rad_per_s, 3)
        return nu, finite_number("heading_rad", heading_rad), held

    def _has_no_friction(self, what: str) -> None:
        if self.has_friction:
            raise BadInput(f"{what}: this vehicle's wheels have states of their own (ground with friction, or motors "
                           "with limits); step it with plant()")
