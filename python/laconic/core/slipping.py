"""Vehicles with hinges on ground with friction from Python (articulated_friction.h): wheels may slip.

    robot = SlippingVehicle({"mass_kg": 30.0, …, "ground": {"friction_coefficient": 0.8}, "wheel": […], "body": […]})
    plant = robot.plant(step_s=1e-3)
    plant.run({"voltage_V[1]": 6.0, "steering_angle_rad[fork]": 0.3}, steps=1000)
    plant.outputs().slip_across_m_per_s

The table is that of laconic.ArticulatedVehicle, with a ground that has friction and further keys of bodies and wheels.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from laconic.core.articulated import ArticulatedMotion, ArticulatedVehicle, lengths_of, members_of
from laconic.core.articulated_input import input_slots, row_length, row_of_hinges
from laconic.core.binding import Core, load
from laconic.core.copies import OwnMemory
from laconic.core.given import finite_number, finite_numbers, flag, number, shown, step_count
from laconic.core.recording import Structs
from laconic.errors import BadInput, nearest_of

if TYPE_CHECKING:
    from laconic.scene import Scene

TARGET = "steering_angle_rad"
"""The input of servos and loops; the core's hinge_angle_rad."""
PER_POINT = ("normal_N",)
PER_AXIS = ("motor_current_A", "drive_limit")
WHOLE = ("contact_state", "drive_limit")
OUTPUTS = "laconic_tree_outputs"
WATCHED = 256  # steps that a watch keeps before it judges them


@cache
def hinge_keys(core: Core) -> dict[str, str]:
    """Keys that a body has in addition on ground with friction: "number", or "flag"."""
    return _keys(core, "laconic_tree_hinge")


@cache
def wheel_keys(core: Core) -> dict[str, str]:
    """The same of a wheel."""
    return _keys(core, "laconic_tree_wheel")


def _keys(core: Core, struct: str) -> dict[str, str]:
    return {name: "flag" if field.type.cname == "_Bool" else "number"
            for name, field in core.ffi.typeof(struct).fields}


@dataclass(frozen=True)
class SlippingOutputs:
    """Motion, then what ground and hinges did in the last step, for H hinges, N wheels and S supports.

    Forces are those of the ground on a wheel. The books close: energy + spring energy now − at the start = supply
    energy + outer work + servo work − all losses.
    """

    motion: ArticulatedMotion
    slip_along_m_per_s: np.ndarray   # (N,)  of the contact, along the roller's axis; of a fixed wheel ahead
    slip_across_m_per_s: np.ndarray  # (N,)  90° to the left of it
    contact_state: np.ndarray        # (N,)  0 sticks or rolls, 1 slips, 2 has lifted
    along_N: np.ndarray              # (N,)  along the roller's axis; of a fixed wheel ahead
    lateral_N: np.ndarray            # (N,)  90° to the right of it
    scrub_Nm: np.ndarray             # (N,)  about the vertical
    normal_N: np.ndarray             # (N + S,)  wheels, then supports
    wheel_torque_Nm: np.ndarray      # (N,)  of the motor on the axle
    hinge_torque_Nm: np.ndarray      # (H,)  of servo, motor or prescribed rate on the body
    friction_torque_Nm: np.ndarray   # (H,)  dry friction of the hinge
    stop_torque_Nm: np.ndarray       # (H,)
    motor_current_A: np.ndarray      # (N + H,)  wheels, then hinges
    drive_limit: np.ndarray          # (N + H,)  0 none, 1 voltage, 2 current
    supply_current_A: float
    supply_voltage_V: float
    spring_energy_J: float
    supply_energy_J: float
    outer_work_J: float
    servo_work_J: float
    slip_loss_J: float
    scrub_loss_J: float
    axle_loss_J: float
    hinge_loss_J: float
    stop_loss_J: float
    motor_loss_J: float
    supply_loss_J: float
    numerical_loss_J: float          # dissipation of the first-order step


class SlippingVehicle(ArticulatedVehicle):
    """A checked vehicle with hinges whose wheels may slip, in one scalar type; `plant` makes one that moves.

    `table` has the keys of laconic.ArticulatedVehicle's with ground.friction_coefficient, and for drives with limits
    "motor" and "drive". A body may have com_z_m, hitch, dry_friction_Nm, stop_low_rad, stop_high_rad, a servo
    (servo_gain_Nm_per_rad, servo_damping_Nms, servo_limit_Nm), its motor's viscous_friction_Nms,
    winding_resistance_ohm and current_limit_A, and a loop (loop_V_per_rad, loop_Vs_per_rad, control_period_s). A
    wheel may have load_N, scrub_radius_m, scrub_fade_m and creep. Raises BadInput and Refused as that class does.
    """

    def __init__(self, table: Mapping[str, Any], real: str = "double"):
        core = load(real)
        plain, wheels = _without(core, table)
        bodies = self._build(core, plain, hinge_keys(core))
        self.tree = core.ffi.new("laconic_tree_vehicle *", {"hinged": self.c[0]})
        for target, body in zip(self.tree.hinge, bodies, strict=False):
            for key, kind in hinge_keys(core).items():
                if key in body:
                    setattr(target, key, flag(f"vehicle.body.{key}", body[key]) if kind == "flag" else body[key])
        for target, wheel in zip(self.tree.wheel, wheels, strict=False):
            for key, value in wheel.items():
                setattr(target, key, value)
        self.model, why = core.ffi.new("laconic_tree_model *"), core.why()
        core.check(core.lib.laconic_tree_prepare(self.model, self.tree, why), why)

    @classmethod
    def of(cls, scene: Scene) -> SlippingVehicle:
        """That of a scene with hinges and ground friction, in the scene's scalar type; BadInput for any other."""
        from laconic.scene import check_scene  # which is above this room

        if not check_scene(scene).slips_on_hinges:
            raise BadInput(f"{scene.path}: has no bodies on hinges on ground with friction; give "
                           "ground.friction_coefficient, or make a laconic.ArticulatedVehicle of it")
        return scene.slipping_vehicle(scene.core())

    @property
    def is_coordinated(self) -> bool:
        """No hinge is: a servo or a prescribed rate turns each."""
        return False

    def outputs_of(self, rows: Any) -> SlippingOutputs:
        """A laconic_tree_outputs, as `motion_of` of ArticulatedVehicle; states and limits are whole numbers."""
        wheels, hinges = self.wheel_count, self.body_count
        lengths = {**lengths_of(SlippingOutputs, wheels, hinges), **dict.fromkeys(PER_AXIS, wheels + hinges),
                   **dict.fromkeys(PER_POINT, self.point_count)}
        del lengths["motion"]
        values = members_of(rows, lengths)
        whole = {name: values[name].astype(int) for name in WHOLE}
        return SlippingOutputs(motion=self.motion_of(rows["motion"]), **(values | whole))

    @property
    def point_count(self) -> int:
        """Wheels and supports."""
        return int(self.model.point_count)

    def input_row(self, values: Mapping[str, float | Sequence[float]] | None = None) -> np.ndarray:
        """A row of input numbers from names: those of ArticulatedVehicle, of which a twist does nothing here, and
        steering_angle_rad, the target of servos and loops."""
        given = {} if values is None else values
        if not isinstance(given, Mapping):
            return row_of_hinges(self.core, self.names, self.wheel_count, given)
        row = np.zeros(tree_row_length(self.core), self.core.dtype)
        targets = {signal: each for signal, each in given.items() if str(signal).partition("[")[0] == TARGET}
        rest = {signal: each for signal, each in given.items() if signal not in targets}
        row[: row_length(self.core)] = row_of_hinges(self.core, self.names, self.wheel_count, rest)
        for signal, each in targets.items():
            if signal != TARGET and TARGET in targets:
                raise BadInput(f"{signal}: is given besides {TARGET}; keep one of them")
            slots = self.slots(signal)
            many = [each] if isinstance(each, int | float | np.number) else each
            row[slots.start : slots.stop] = finite_numbers(str(signal), many, len(slots))
        return row

    def slots(self, signal: str) -> range:
        """As of ArticulatedVehicle, and steering_angle_rad or steering_angle_rad[fork]."""
        name, bracket, inside = str(signal).partition("[")
        if name != TARGET:
            return input_slots(self.core, self.names, signal)
        if bracket and inside.removesuffix("]") not in self.names:
            raise BadInput(f"{signal}: there is no such hinge; {nearest_of(inside.removesuffix(']'), self.names)}")
        rates = input_slots(self.core, self.names, f"steering_rate_rad_per_s{bracket}{inside}")
        shift = row_length(self.core) - input_slots(self.core, self.names, "steering_rate_rad_per_s").start
        return range(rates.start + shift, rates.stop + shift)

    def plant(self, method: str = "auto", step_s: float = 1e-3, *,  # type: ignore[override]
              velocity_m_per_s: Sequence[float] = (0.0, 0.0), yaw_rate_rad_per_s: float = 0.0, x_m: float = 0.0,
              y_m: float = 0.0, heading_rad: float = 0.0, hinge_angle_rad: Sequence[float] | None = None,
              hinge_rate_rad_per_s: Sequence[float] | None = None,
              wheel_speed_rad_per_s: Sequence[float] | None = None) -> SlippingPlant:
        """The vehicle at a start, ready to step. `method` is auto: there is one step.

        Velocity and yaw rate of the centre of mass of body 0, in body axes; angles and rates of the hinges. Wheels
        roll as the vehicle moves, unless their speeds are given. Raises Refused for a start that cannot be taken.
        """
        if method != "auto":
            raise BadInput(f"method: {shown(method)} does not step wheels that may slip; give auto")
        zeros = [0.0] * self.body_count
        hinged = {
            "velocity_m_per_s": finite_numbers("velocity_m_per_s", velocity_m_per_s, 2),
            "yaw_rate_rad_per_s": finite_number("yaw_rate_rad_per_s", yaw_rate_rad_per_s),
            "x_m": finite_number("x_m", x_m), "y_m": finite_number("y_m", y_m),
            "heading_rad": finite_number("heading_rad", heading_rad),
            "hinge_angle_rad": finite_numbers("hinge_angle_rad", _or(hinge_angle_rad, zeros), self.body_count),
            "hinge_rate_rad_per_s": finite_numbers("hinge_rate_rad_per_s", _or(hinge_rate_rad_per_s, zeros),
                                                   self.body_count)}
        start = self.core.ffi.new("laconic_tree_start *", {"hinged": hinged})
        if wheel_speed_rad_per_s is not None:
            start.wheels_stand = True
            start.wheel_speed_rad_per_s[0 : self.wheel_count] = finite_numbers(
                "wheel_speed_rad_per_s", wheel_speed_rad_per_s, self.wheel_count)
        return SlippingPlant(self, step_s, start)


def _or(given: Sequence[float] | None, usual: list[float]) -> Sequence[float]:
    return usual if given is None else given


def _without(core: Core, table: Any) -> tuple[Any, list[dict[str, float]]]:
    """The table as ideal ground has it, and what else its wheels have."""
    wheels = table.get("wheel") if isinstance(table, Mapping) else None
    if not isinstance(wheels, Sequence) or not all(isinstance(each, Mapping) for each in wheels):
        return table, []
    keys = wheel_keys(core)
    more = [{key: number(f"vehicle.wheel[{i}].{key}", each[key]) for key in keys if key in each}
            for i, each in enumerate(wheels, 1)]
    plain = [{key: value for key, value in each.items() if key not in keys} for each in wheels]
    return {**table, "wheel": plain}, more


def tree_row_length(core: Core) -> int:
    """How many numbers a row has."""
    return int(core.ffi.sizeof("laconic_tree_input")) // int(core.dtype.itemsize)


class SlippingPlant(OwnMemory):
    """Steps and outputs of one vehicle with hinges on ground with friction. A copy moves by itself."""

    def __init__(self, vehicle: SlippingVehicle, step_s: float, start: Any):
        self.core, self.vehicle, self.steps = vehicle.core, vehicle, 0
        self.step_s = finite_number("step_s", step_s)
        self.c, why = self.core.ffi.new("laconic_tree_state *"), self.core.why()
        self.core.check(self.core.lib.laconic_tree_state_set(self.c, vehicle.model, start, why), why)

    @property
    def method(self) -> str:
        """The only one."""
        return "auto"

    @property
    def passes(self) -> int:
        """Of the solver in the last step."""
        return int(self.c.passes)

    def set_step(self, step_s: float) -> None:
        """Another step size from here on."""
        self.step_s = finite_number("step_s", step_s)

    def run(self, inputs: Mapping[str, float | Sequence[float]] | np.ndarray | None = None, steps: int = 1) -> None:
        """Steps with the inputs held: names as `SlippingVehicle.input_row` has them, or a row that it made. Refused
        leaves the state before the refused step."""
        row = self.vehicle.row_of(inputs)
        self.follow(np.broadcast_to(row, (step_count("steps", steps), row.size)))

    def follow(self, rows: np.ndarray, watch: SlipWatch | None = None) -> None:
        """One step for each of `rows`, shape (steps, numbers of a row), held over the step and seen by `watch`."""
        lib, ffi, model, why = self.core.lib, self.core.ffi, self.vehicle.model, self.core.why()
        size = tree_row_length(self.core)
        table = np.ascontiguousarray(rows, self.core.dtype)
        if table.ndim != 2 or table.shape[1] != size:
            raise BadInput(f"rows: has the shape {table.shape}, not (steps, {size}); make each with input_row")
        held = ffi.from_buffer("laconic_tree_input[]", table)
        for at in range(len(table)):
            if lib.laconic_tree_step(model, self.step_s, self.c, held + at, why) != 0:
                raise self.core.refusal(why)
            self.steps += 1
            if watch:
                watch.see()

    def save(self) -> Any:
        """A copy of the state, for `restore`."""
        return self.core.ffi.new("laconic_tree_state *", self.c[0])

    def restore(self, state: Any, steps: int) -> None:
        """Back to a state that `save` of a plant of this vehicle gave."""
        ffi = self.core.ffi
        if not isinstance(state, ffi.CData) or ffi.typeof(state) is not ffi.typeof("laconic_tree_state *"):
            raise BadInput(f"state: {shown(state)} is not a saved state of this core; give what plant.save() returned")
        self.c[0], self.steps = state[0], step_count("steps", steps)

    # ---- outputs

    def motion(self) -> ArticulatedMotion:
        """Velocities, pose, hinges, poses of bodies, wheels and energy of this moment."""
        return self.outputs().motion

    def c_motion(self) -> Any:
        """The same as a laconic_articulated_motion, for callers that read a few of its members in every step."""
        found = self.core.ffi.new(f"{OUTPUTS} *")
        self.see_outputs(found)
        return self.core.ffi.new("laconic_articulated_motion *", found.motion)  # a member alone would not keep it

    def outputs(self) -> SlippingOutputs:
        """Motion of this moment, and what the last step did: slips, forces, loads, drives and the energy book."""
        found = Structs(self.core, OUTPUTS, 1)
        self.see_outputs(found.c)
        return self.vehicle.outputs_of(found.table[0])

    def see_outputs(self, found: Any, state: Any = None) -> None:
        """The same into a laconic_tree_outputs, which `SlippingVehicle.outputs_of` reads; also of another state."""
        self.core.lib.laconic_tree_outputs_of(found, self.vehicle.model, self.c if state is None else state)


class SlipWatch:
    """Which wheels of a plant slipped, and what slip and scrub took at each of them.

    The forces of a step act at its middle angles of the hinges: half a step before those of its end, at the new rates.
    """

    def __init__(self, plant: SlippingPlant):
        core, wheels = plant.core, plant.vehicle.wheel_count
        self._plant, self._seen, self._count = plant, Structs(core, OUTPUTS, WATCHED), 0
        self._middle = core.ffi.new("laconic_tree_state *")
        self._turn = 1 << 8 * core.ffi.sizeof("laconic_binary_angle")
        self._twists = np.frombuffer(core.ffi.buffer(plant.c.body), core.dtype).reshape(-1, 3)
        self._bodies = [int(plant.vehicle.model.wheel[i].body) for i in range(wheels)]
        self._yaw_rates = np.zeros((WATCHED, len(self._twists)), core.dtype)
        self._steps_s = np.zeros((WATCHED, 1), core.dtype)  # a plant may change its step
        self._slipped, self._loss_J = np.zeros(wheels, bool), np.zeros(wheels)

    def see(self) -> None:
        """The end of a step."""
        plant, middle = self._plant, self._middle
        middle[0] = plant.c[0]
        for b in range(plant.vehicle.body_count):
            back = round(0.5 * plant.step_s * float(middle.z[3 + b]) / math.tau * self._turn)
            middle.hinge[b].fraction = (int(middle.hinge[b].fraction) - back) % self._turn
        plant.see_outputs(self._seen.c + self._count, middle)
        self._yaw_rates[self._count], self._steps_s[self._count] = self._twists[:, 2], plant.step_s
        self._count += 1
        if self._count == WATCHED:
            self._judge()

    def _judge(self) -> None:
        """Adds up what was seen since the last time, step by step."""
        found = self._plant.vehicle.outputs_of(self._seen.table[: self._count])
        losses = self._steps_s[: self._count] * (found.lateral_N * found.slip_across_m_per_s
                                                 - found.along_N * found.slip_along_m_per_s
                                                 - found.scrub_Nm * self._yaw_rates[: self._count, self._bodies])
        self._slipped |= (found.contact_state == 1).any(axis=0)
        self._loss_J = np.cumsum(np.vstack([self._loss_J, losses]), axis=0)[-1]
        self._count = 0

    @property
    def slipped(self) -> np.ndarray:
        """Whether each wheel did, shape (N,)."""
        self._judge()
        return self._slipped

    @property
    def loss_J(self) -> np.ndarray:  # noqa: N802
        """Of each wheel, shape (N,)."""
        self._judge()
        return self._loss_J
