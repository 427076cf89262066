"""From a scene to what the analysis works on: everything is read from what the core has prepared."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from laconic.core import Core, Matrices
from laconic.errors import BadInput, Refused
from laconic.scene import Scene
from laconic.scene.ground import on_ideal_ground, slips
from laconic.tools.analyse.field import Field

if TYPE_CHECKING:
    from laconic.tools.derive.scene_system import VehicleNumbers  # brings SymPy, which takes a while

BY_SLIP_ALONE = ("nothing moves", "straight only")  # why ideal ground holds a robot that skids
Inputs = Mapping[str, float | Sequence[float]]


@dataclass(frozen=True)
class Subject:
    """One vehicle as prepared by the core, with the constant inputs it is studied under."""

    scene: Scene
    core: Core
    vehicle: Any              # laconic_vehicle
    model: Any                # laconic_model
    matrices: Matrices
    inputs: dict[str, float]  # held: signal → value
    held: str = ""            # a sentence with the instant of these inputs; "": the inputs never vary

    @property
    def wheel_count(self) -> int:
        """N."""
        return int(self.vehicle.wheel_count)

    def voltages(self) -> np.ndarray:
        """U [V]."""
        return np.array([self.inputs.get(f"voltage_V[{i + 1}]", 0.0) for i in range(self.wheel_count)])

    def field(self, inputs: Inputs | None = None) -> Field:
        """The vector field under the given constant inputs (None: the subject's own)."""
        return field_of(self.core, self.model, self.inputs if inputs is None else inputs)

    @property
    def allowed_columns(self) -> np.ndarray:
        """The columns of G, which span the ν that the constraints allow: shape (3, m)."""
        return self.core.numbers(self.model.nu_of_zeta, 3, 3)[:, : self.model.dof]

    def start_nu(self) -> np.ndarray:
        """ν at the scene's start."""
        return np.array(self.scene.initial.nu(self.model), dtype=float)

    def of_wheels(self, name: str) -> np.ndarray:
        """A member of the model that has a value for each wheel: motor_gain_Nm_per_V …"""
        return self.core.numbers(getattr(self.model, name))[: self.wheel_count]

    def radii_m(self) -> np.ndarray:
        """R_i [m]."""
        common = float(self.vehicle.wheel_radius_m)
        return np.array([float(w.own_radius_m) or common for w in self.vehicle.wheel[0 : self.wheel_count]])

    @property
    def wheels_differ(self) -> bool:
        """Whether damping and inertia have axes of their own, as c2_i : J_i is not common to all wheels."""
        return bool(self.model.rotated_twice)

    def numbers(self) -> VehicleNumbers:
        """The vehicle for the derivation."""
        from laconic.tools.derive.scene_system import VehicleNumbers

        inertia = self.of_wheels("wheel_inertia_kgm2")
        share = np.sqrt(inertia / (inertia.max(initial=0.0) or 1.0)) if inertia.any() else np.ones_like(inertia)
        return VehicleNumbers(
            name=self.scene.name, mass_kg=float(self.model.mass_kg), wheel_radius_m=float(self.model.wheel_radius_m),
            lambda_yaw=self.matrices.lambda_yaw, lambda_wheel=self.matrices.lambda_wheel * share,
            motor_gain_Nm_per_V=self.of_wheels("motor_gain_Nm_per_V"),
            motor_damping_Nms=self.of_wheels("motor_damping_Nms"),
            wheel_rows=self.matrices.wheel_rows, constraint_rows=self.matrices.constraint_rows)


def subject_of(scene: Scene, at_s: float = 0.0) -> Subject:
    """The scene's vehicle in the core (double), with the inputs as they are held at one instant."""
    scene = scene.with_run(real="double")
    core = scene.core()
    vehicle, model = scene.c_vehicle(core), scene.model(core)
    inputs = scene.inputs_on_grid()
    if not 0.0 <= at_s <= scene.run.duration_s:
        raise BadInput(f"{scene.path}: --at {at_s:g} s lies outside the run; give 0 to {scene.run.duration_s:g} s")
    tick = int(np.floor(at_s / scene.run.step_s + 1e-6))
    varying = not inputs.is_held or len(inputs.changes) > 1
    held = f"The inputs are held as they are at {at_s:g} s (--at takes another instant)." if varying else ""
    return Subject(scene, core, vehicle, model, core.matrices(vehicle), inputs.held_at(tick), held)


def rolling_subject(scene: Scene, at_s: float = 0.0) -> Subject:
    """The same on ideal ground: what the wheels can do with the body does not depend on the ground, but for those that
    move by slip alone (skid steering), which stay on theirs."""
    try:
        return subject_of(on_ideal_ground(scene), at_s)
    except Refused as refused:
        if refused.status not in BY_SLIP_ALONE or not slips(scene.vehicle):
            raise
        return subject_of(scene, at_s)


def changed(subject: Subject, key: str, value: float) -> Subject:
    """The same with one number of `[vehicle]` replaced; BadInput when the core refuses it."""
    data = {**subject.scene.vehicle, key: value}
    try:
        vehicle = subject.core.vehicle(data)
        model, matrices = subject.core.prepare(vehicle), subject.core.matrices(vehicle)
    except Refused as refused:
        raise refused.at(f"{subject.scene.path}, {key} = {value:g}") from None
    return replace(subject, vehicle=vehicle, model=model, matrices=matrices)


def nu_rates(core: Core, model: Any, nu: Sequence[float] | np.ndarray, heading_rad: float, held: Any) -> np.ndarray:
    """ν' of (4.7) by the core. A variable holds the struct, since its array alone would not keep it alive."""
    rates = core.derivative(model, nu, heading_rad, held)
    return core.numbers(rates.nu_rad_per_s2)


def field_of(core: Core, model: Any, inputs: Inputs) -> Field:
    """The field of a model under constant inputs; BadInput for a force fixed in the world: its forcing varies."""
    forcing = core.ffi.new("laconic_forcing *")
    core.lib.laconic_forcing_of(forcing, model, core.input(inputs, model.wheel_count))
    if forcing.rotates:
        raise BadInput("a force fixed in the world acts: it rotates against the body with the heading, so there are no "
                       "steady motions; leave it out of the scene, or use `laconic simulate`")
    return Field(
        dof=int(model.dof),
        nu_of_zeta=core.numbers(model.nu_of_zeta, 3, 3),
        gyro=core.numbers(model.gyro),
        decay_per_s=core.numbers(model.decay_per_s),
        forcing=core.numbers(forcing.constant),
        lambda_yaw=float(model.yaw_scale),
    )
