"""A vehicle that moves: the core's laconic_plant with its outputs as numpy arrays."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np

from laconic.core.copies import OwnMemory
from laconic.core.derivatives import StepDerivatives
from laconic.core.estimate import USUAL_STEPS, Estimate
from laconic.core.given import c_object, number, shown, step_count
from laconic.core.inputs import Schedule, check_held, sampled_rows
from laconic.core.saved import check_motion_of, check_saved, check_wheels_of
from laconic.core.sensors import Sensors, settings_of, shows_unsigned
from laconic.errors import BadInput

if TYPE_CHECKING:
    from laconic.core import Core
    from laconic.core.recording import Recorder

PLACED_BY = ("kind", "x_m", "y_m", "axle_rad", "roller_rad")  # what of a wheel no change changes


class Pose(NamedTuple):
    """Place and direction of a vehicle in the world."""

    x_m: float                  # centre of mass
    y_m: float
    heading_rad: float          # not wrapped
    heading_wrapped_rad: float  # in (−π, π]
    origin_x_m: float           # the body frame's origin
    origin_y_m: float


class Plant(OwnMemory):
    """Steps and outputs of one vehicle; `c` is the laconic_plant itself. A copy moves by itself from where this is."""

    RENEWED: ClassVar[dict[str, Any]] = {"_contact": None, "_parts": {}}

    def __init__(self, core: Core, plant: Any):
        self.core, self.c = core, plant
        self._contact: Any = None
        self._parts: dict[str, Any] = {}

    # ---- motion

    @property
    def steps(self) -> int:
        """Steps taken since the start."""
        return int(self.c.steps)

    @property
    def step_s(self) -> float:
        """The step, as the core's scalar type has it."""
        return float(self.c.integrator.step_s)

    @property
    def chosen_method(self) -> str:
        """The method that steps; it differs from the given one only with auto."""
        return self.core.text(self.c.integrator.chosen.name)

    def run(self, held: Any = None, steps: int = 1) -> None:
        """Steps with the input held: {"voltage_V": [1.0, 2.0]}, None for none, or what `input_of` made.

        Refused leaves the state before the refused step. A controller that steps often makes its input once.
        """
        why = self.core.why()
        held, steps = self.input_of(held), step_count("steps", steps)
        self.core.check(self.core.lib.laconic_plant_run(self.c, held, steps, why), why)

    def run_sampled(self, samples: np.ndarray) -> None:
        """One step per samples[k] = rows of input numbers at the step's start, middle and end."""
        rows = sampled_rows(self.core, samples, self.wheel_count)
        signals = range(self.core.input_length)
        self.follow(Schedule(self.core, signals, rows, first_step=self.steps), self.steps + len(rows))

    def follow(self, schedule: Schedule, until_step: int, recorder: Recorder | None = None) -> None:
        """Steps along a schedule, recorded on the way; Refused leaves the state before the refused step."""
        why = self.core.why()
        until_step = step_count("until_step", until_step)
        record = recorder.c if recorder else self.core.ffi.NULL
        self.core.check(self.core.lib.laconic_plant_follow(self.c, schedule.c, until_step, record, why), why)

    def set_step(self, step_s: float) -> None:
        """Another step size from here on."""
        why = self.core.why()
        self.core.check(self.core.lib.laconic_plant_set_step(self.c, number("step_s", step_s), why), why)

    def change(self, vehicle: Any) -> None:
        """Another payload, motor … while it moves, of a Vehicle; BadInput where its wheels are not the plant's, each at
        its place."""
        why = self.core.why()
        vehicle = c_object(self.core, "vehicle", vehicle)
        self._check_wheels_of(vehicle)
        self.core.check(self.core.lib.laconic_plant_change(self.c, vehicle, why), why)
        self._contact = None

    def _check_wheels_of(self, vehicle: Any) -> None:
        if vehicle.wheel_count != self.wheel_count:
            raise BadInput(f"vehicle: has {vehicle.wheel_count} wheels, and the plant {self.wheel_count}; make a plant "
                           "of it")
        for index in range(self.wheel_count):
            ours, its = self.c.vehicle.wheel[index], vehicle.wheel[index]
            for name in PLACED_BY:
                if (now := getattr(ours, name)) != (then := getattr(its, name)):
                    raise BadInput(f"vehicle.wheel[{index + 1}].{name}: is {then:g}, and the plant's {now:g}; wheels "
                                   "stay where they are, or make a plant of this vehicle")

    def save(self) -> Any:
        """A copy of the state; with friction of the whole plant, whose wheels have states of their own."""
        if self.has_friction:
            return self.core.ffi.new("laconic_plant *", self.c[0])
        return self.core.ffi.new("laconic_state *", self.c.state)

    def restore(self, state: Any, steps: int) -> None:
        """Back to a state that `save`, or a batch of this robot, gave.

        BadInput for one with a number that is infinite or NaN, and for one that this robot cannot have: with a motion
        that its wheels forbid, with friction of another number of wheels. Without friction a state does not say of
        which robot it is: that of another, which may move alike, is taken.
        """
        steps = step_count("steps", steps)
        if self.has_friction:
            saved = c_object(self.core, "plant", state)
            check_wheels_of("plant", saved, self)
            check_saved(self.core, "plant.state", saved.state)
            check_saved(self.core, "plant.slip", saved.slip)
            self.c.state, self.c.slip, self.c.steps = saved.state, saved.slip, steps
        else:
            found = c_object(self.core, "state", state)[0]
            check_saved(self.core, "state", found)
            check_motion_of("state", found, self)
            self.c.state, self.c.steps = found, steps

    # ---- sensors

    def sensors(self, settings: Mapping[str, Any] | None = None) -> Sensors:
        """Sensors beside this plant, as after power-up: {"imu": {…}, "encoder": {…}} with the keys of laconic.core's
        fields (docs/python.md), an ideal IMU at the body's origin and no encoders where nothing is given.

        BadInput names a key that is unknown or no number; Refused one that the core refuses.
        """
        given = {} if settings is None else settings
        return Sensors(self, settings_of(self.core, given, self.wheel_count), shows_unsigned(given))

    def estimate(self, most_steps: int = USUAL_STEPS) -> Estimate:
        """An error estimate that watches the run from here on; one step in `most_steps` is taken twice."""
        return Estimate(self, most_steps)

    def step_derivatives(self, held: Any = None) -> StepDerivatives:
        """How the state after the next step changes with state, input and vehicle before it; input as for `run`.

        BadInput for a vehicle with friction, whose step is not smooth.
        """
        return StepDerivatives(self, held)

    # ---- outputs

    def _at(self, name: str) -> Any:
        if name not in self._parts:
            self._parts[name] = self.core.ffi.addressof(self.c, name)
        return self._parts[name]

    @property
    def wheel_count(self) -> int:
        """N."""
        return int(self.c.model.wheel_count)

    @property
    def has_friction(self) -> bool:
        """Whether it is stepped by the friction step: ground with friction, or motors with limits."""
        return bool(self.c.friction.acts)

    def input_of(self, held: Any) -> Any:
        """The laconic_input that is given, or that names and numbers make; BadInput for wheels that are not there."""
        if held is None or isinstance(held, Mapping):
            return self.core.input(held, self.wheel_count)
        if isinstance(held, list | tuple | np.ndarray):
            numbers = np.ravel(held).tolist() if isinstance(held, np.ndarray) else [*held]
            raise BadInput(f'input: {shown(held)} names no signal; give them by its name, such as {{"voltage_V": '
                           f"{shown(numbers[: self.wheel_count])}}}")
        made = c_object(self.core, "input", held)
        check_held(self.core, made, self.wheel_count)
        return made

    def outputs(self, held: Any = None) -> Any:
        """The laconic_outputs with the reactions; its `friction` where the vehicle has friction. Input as for `run`.

        Refused where one of them leaves the range of numbers."""
        held = self.input_of(held)
        found = self._outputs(held)
        self.core.check_range("outputs", self.core.numbers(found))
        found.reactions = self.reactions(held)[0]
        return found

    def _outputs(self, held: Any) -> Any:
        found = self.core.ffi.new("laconic_outputs *")
        self.core.lib.laconic_outputs_of(found, self.c, held)
        return found

    @property
    def nu(self) -> np.ndarray:
        """ν1, ν2, ν3 [rad/s], shape (3,)."""
        nu = self.core.ffi.new("laconic_real[3]")
        self.core.lib.laconic_nu(self._at("model"), self._at("state"), nu)
        return self.core.numbers(nu)

    @property
    def pose(self) -> Pose:
        """Where the vehicle is."""
        pose = self.core.ffi.new("laconic_pose *")
        self.core.lib.laconic_pose_of(pose, self._at("model"), self._at("state"))
        return Pose(pose.x_m, pose.y_m, pose.heading_rad, pose.heading_wrapped_rad, pose.origin_x_m, pose.origin_y_m)

    def body_velocity(self) -> tuple[np.ndarray, float]:
        """v_S in body axes [m/s], shape (2,), and the yaw rate [rad/s]."""
        velocity = self.core.ffi.new("laconic_real[2]")
        yaw_rate = self.core.lib.laconic_body_velocity(self._at("model"), self._at("state"), velocity)
        return self.core.numbers(velocity), yaw_rate

    def body_acceleration(self, held: Any = None) -> np.ndarray:
        """Acceleration of the body's origin in body axes, shape (2,) [m/s²], at this moment with this input.

        Refused where it leaves the range of numbers. BadInput for a vehicle with friction, whose acceleration is known
        of a whole step alone: Sensors.read has it.
        """
        if self.has_friction:
            raise BadInput("plant: has ground friction or limits of its drive, so its acceleration is the mean over a "
                           "step; step it by sensors = plant.sensors(), and take sensors.read()")
        held, found = self.input_of(held), self.core.ffi.new("laconic_real[2]")
        self.core.lib.laconic_acceleration_body(found, self.core.ffi.NULL, self.c, held)
        acceleration = self.core.numbers(found)
        self.core.check_range("body_acceleration", acceleration)
        return acceleration

    def _per_wheel(self, function: Any, *more: Any) -> np.ndarray:
        room = self.core.ffi.new("laconic_real[]", max(self.wheel_count, 1))
        function(self._at("model"), self._at("state"), *more, room)
        return self.core.numbers(room)[: self.wheel_count]

    def wheel_speeds(self) -> np.ndarray:
        """χ' [rad/s], shape (N,)."""
        if self.has_friction:
            return self.core.numbers(self.c.slip.wheel_speed_rad_per_s)[: self.wheel_count]
        return self._per_wheel(self.core.lib.laconic_wheel_speeds)

    def wheel_torques(self, held: Any = None) -> np.ndarray:
        """Torque on each axle: motor and applied [N·m], shape (N,). Input as for `run`."""
        held = self.input_of(held)
        if self.has_friction:
            torques = self.core.numbers(self._outputs(held).wheel_torque_Nm)[: self.wheel_count]
        else:
            torques = self._per_wheel(self.core.lib.laconic_wheel_torques, held)
        self.core.check_range("wheel_torques", torques)
        return torques

    def wheel_angles(self) -> np.ndarray:
        """χ [rad], shape (N,)."""
        if self.has_friction:
            angles = [each.value for each in self.c.slip.wheel_angle_rad]
            return np.array(angles[: self.wheel_count], self.core.dtype)
        return self._per_wheel(self.core.lib.laconic_wheel_angles)

    def row(self) -> np.ndarray:
        """ν(3), x, y, heading, wheel speeds (N), wheel angles (N): what adapters are compared by."""
        pose = self.pose
        row = np.empty(6 + 2 * self.wheel_count, self.core.dtype)
        row[:3], row[3:6] = self.nu, (pose.x_m, pose.y_m, pose.heading_rad)
        row[6 : 6 + self.wheel_count], row[6 + self.wheel_count :] = self.wheel_speeds(), self.wheel_angles()
        return row

    def energy_J(self) -> float:
        """Kinetic energy."""
        if self.has_friction:
            parts = (self._at("friction"), self._at("state"), self._at("slip"))
            return float(self.core.lib.laconic_friction_energy_J(*parts))
        return float(self.core.lib.laconic_energy_J(self._at("model"), self._at("state")))

    @property
    def contact(self) -> Any:
        """The laconic_contact of the vehicle as it is now."""
        if self._contact is None:
            contact, why = self.core.ffi.new("laconic_contact *"), self.core.why()
            self.core.check(self.core.lib.laconic_contact_prepare(contact, self._at("vehicle"), why), why)
            self._contact = contact
        return self._contact

    def wheel_loads(self, held: Any = None) -> np.ndarray:
        """Normal load of each wheel [N], shape (N,): below 0 where it would lift, or with friction has lifted. Input as
        for `run`; on ideal ground the loads change with the reactions that it needs."""
        return self.core.numbers(self.reactions(held).normal_N)[: self.wheel_count]

    def support_loads(self, held: Any = None) -> np.ndarray:
        """The same of each support."""
        supports = int(self.c.vehicle.support_count)
        return self.core.numbers(self.reactions(held).normal_N)[self.wheel_count : self.wheel_count + supports]

    def reactions(self, held: Any = None) -> Any:
        """The laconic_reactions of this state and input, given as for `run`; Refused where one leaves the range of
        numbers."""
        held, found = self.input_of(held), self.core.ffi.new("laconic_reactions *")
        self.core.lib.laconic_plant_reactions(found, self.c, self.contact, held)
        self.core.check_range("reactions", self.core.numbers(found))
        return found
