"""The drive of an FRC robot: a scene's vehicle with a battery, driven by what motor controllers put out.

    robot = Drivetrain("robot.toml")
    robot.run(0.02, drive=[0.5, 0.5, 0.5, 0.5], steering=[0.0, 0.1, 0.0, 0.0])
    robot.motion().x_m, robot.battery_V

An output is the share of the battery's voltage, −1 to 1, as WPILib's motor controllers take it. Wheels and steered
wheels have the scene's order. The vehicle is stepped by the core: rigid ones (differential, mecanum), steered wheels
with motors on ground with friction, and coordinated steered wheels on ideal ground.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from laconic.core.given import finite_number, finite_numbers
from laconic.errors import BadInput, Refused
from laconic.scene import Scene, read_scene
from laconic.scene.base import FrcTable
from laconic.simulation.articulated import start_plant
from laconic.simulation.loads import centre_of
from laconic.simulation.slipping import start_slipping

BROWNOUT_V = 6.75          # at which a roboRIO 2 switches its outputs off
NOMINAL_V = 12.0           # at which a coordinated wheel steers with its rate limit
APART_RAD = 0.05           # of steered wheels from the nearest common motion, before it is reported
LOCKED_RAD = 0.35          # the same before the robot is held
SHARE = 2.0                # of a rate limit: the nearest common motion may turn a wheel faster than its own motor
ROUNDS = 12                # to find which motors are at their current limit


@dataclass(frozen=True)
class Motion:
    """Where the robot is and how it moves, with WPILib's axes: ahead, to the left, counter-clockwise."""

    x_m: float                                 # of the body frame's origin, which is WPILib's robot centre
    y_m: float
    heading_rad: float                         # not wrapped
    ahead_m_per_s: float                       # of that point
    left_m_per_s: float
    yaw_rate_rad_per_s: float
    wheel_angle_rad: tuple[float, ...]         # not wrapped
    wheel_speed_rad_per_s: tuple[float, ...]
    steering_angle_rad: tuple[float, ...]      # not wrapped
    steering_rate_rad_per_s: tuple[float, ...]


class Chassis(Protocol):
    """A vehicle that takes voltages of its wheels and steering motors."""

    def step(self, wheels: Sequence[float], steering: Sequence[float]) -> None:
        """One step of the scene with these voltages held."""

    def speeds(self) -> list[float]:
        """Of wheels, then of steering [rad/s]."""

    def motion(self) -> Motion:
        """As it is now."""


class Rigid:
    """Wheels that do not steer."""

    def __init__(self, scene: Scene):
        self._plant = scene.plant(scene.core())
        self._held = self._plant.input_of(None)
        self._of_held = self._held.voltage_V

    def step(self, wheels: Sequence[float], steering: Sequence[float]) -> None:
        """As Chassis.step."""
        for at, volts in enumerate(wheels):
            self._of_held[at] = volts
        self._plant.run(self._held)

    def speeds(self) -> list[float]:
        """As Chassis.speeds."""
        found: list[float] = self._plant.wheel_speeds().tolist()
        return found

    def motion(self) -> Motion:
        """As Chassis.motion."""
        pose, (velocity, rate) = self._plant.pose, self._plant.body_velocity()
        x, y = self._centre
        return Motion(pose.origin_x_m, pose.origin_y_m, pose.heading_rad, float(velocity[0]) + rate * y,
                      float(velocity[1]) - rate * x, rate, tuple(self._plant.wheel_angles().tolist()),
                      tuple(self._plant.wheel_speeds().tolist()), (), ())

    @property
    def _centre(self) -> tuple[float, float]:
        return float(self._plant.c.model.com_x_m), float(self._plant.c.model.com_y_m)


class Slipping:
    """Wheels that motors steer, on ground with friction."""

    def __init__(self, scene: Scene):
        self._vehicle = scene.slipping_vehicle(scene.core())
        self._plant = start_slipping(scene, self._vehicle, [hinge.start_angle_rad for hinge in scene.hinges])
        self._row, self._slot = self._vehicle.input_row(), self._vehicle.slot("voltage_V[1]")
        self._hinge = self._vehicle.slot(f"hinge_voltage_V[{scene.hinges[0].name}]")
        self._found = self._vehicle.core.ffi.new("laconic_tree_outputs *")
        self._centre = centre_of(scene.vehicle)
        self._look()

    def step(self, wheels: Sequence[float], steering: Sequence[float]) -> None:
        """As Chassis.step."""
        self._row[self._slot : self._slot + len(wheels)] = wheels
        self._row[self._hinge : self._hinge + len(steering)] = steering
        self._plant.follow(self._row[None])
        self._look()

    def _look(self) -> None:
        self._vehicle.core.lib.laconic_tree_outputs_of(self._found, self._vehicle.model, self._plant.c)

    def speeds(self) -> list[float]:
        """As Chassis.speeds."""
        motion, unpack = self._found.motion, self._vehicle.core.ffi.unpack
        found: list[float] = unpack(motion.wheel_speed_rad_per_s, self._vehicle.wheel_count)
        return found + unpack(motion.hinge_rate_rad_per_s, self._vehicle.body_count)

    def motion(self) -> Motion:
        """As Chassis.motion."""
        return motion_of(self._found.motion, self._centre, self._vehicle.core.ffi, self._vehicle.wheel_count,
                         self._vehicle.body_count)


def motion_of(found: Any, centre: complex, ffi: Any, wheels: int, hinges: int) -> Motion:
    """That of a laconic_articulated_motion; `centre`: the centre of mass of body 0 in the body frame."""
    cosine, sine, rate = math.cos(found.heading_rad), math.sin(found.heading_rad), found.yaw_rate_rad_per_s
    x, y = centre.real, centre.imag
    return Motion(found.x_m - cosine * x + sine * y, found.y_m - sine * x - cosine * y, found.heading_rad,
                  found.velocity_m_per_s[0] + rate * y, found.velocity_m_per_s[1] - rate * x, rate,
                  tuple(ffi.unpack(found.wheel_angle_rad, wheels)),
                  tuple(ffi.unpack(found.wheel_speed_rad_per_s, wheels)),
                  tuple(ffi.unpack(found.hinge_angle_rad, hinges)),
                  tuple(ffi.unpack(found.hinge_rate_rad_per_s, hinges)))


class Coordinated:
    """Coordinated steered wheels on ideal ground, each turned by an output of its own.

    Ideal ground allows only motions in which no wheel slides. So the robot follows the motion that is nearest to the
    angles of all wheels, as fast as the rate limits allow. A wheel steers with its rate limit at 12 V, without lag.
    """

    def __init__(self, scene: Scene):
        for hinge in scene.hinges:
            if not math.isfinite(hinge.rate_limit_rad_per_s):
                raise BadInput(f"{scene.path}: {hinge.place}.rate_limit_rad_per_s: is missing; give the rate at 12 V")
        self._vehicle = vehicle = scene.articulated_vehicle(scene.core())
        first = np.array([1.0, 0.0, 0.0])
        self._rows = np.repeat(vehicle.input_row({"steering_twist": first.tolist()})[None, None], 2, axis=1)
        self._plant = start_plant(scene, vehicle, self._rows[0, 0])
        self._volts, self._of_twist = vehicle.slot("voltage_V[1]"), vehicle.slot("steering_twist[1]")
        self._rates = np.array([hinge.rate_limit_rad_per_s for hinge in scene.hinges])
        self._places = np.array([complex(each["hinge_x_m"], each["hinge_y_m"]) for each in scene.vehicle["body"]])
        self._length_m = max(float(np.abs(self._places).max()), 1e-3)
        names = [each["name"] for each in scene.vehicle["body"]]
        self._of_wheel = [names.index(wheel["body"]) if "body" in wheel else -1 for wheel in scene.vehicle["wheel"]]
        self._step_s, self._centre = scene.run.step_s, centre_of(scene.vehicle)
        self._found = vehicle.core.ffi.new("laconic_articulated_motion *")
        self._look()
        self._angles = np.array(self._core_motion.steering_angle_rad)
        self._turning, self.apart_rad = np.zeros(len(names)), 0.0
        self._twist = first
        self._signs = np.ones(scene.wheel_count)
        self._last = self._turned = np.zeros(scene.wheel_count)

    def _look(self) -> None:
        vehicle = self._vehicle
        vehicle.core.lib.laconic_articulated_motion_of(self._found, vehicle.model, self._plant.c)
        self._core_motion = motion_of(self._found, self._centre, vehicle.core.ffi, vehicle.wheel_count,
                                      vehicle.body_count)

    def step(self, wheels: Sequence[float], steering: Sequence[float]) -> None:
        """As Chassis.step."""
        self._turning = self._rates * np.array(steering) / NOMINAL_V
        self._angles = self._angles + self._step_s * self._turning
        twist, self.apart_rad = self._common()
        held = 0.0 if self.apart_rad > LOCKED_RAD else 1.0
        start, end = self._rows[0]
        start[self._volts : self._volts + len(wheels)] = held * self._signs * np.array(wheels)
        end[:] = start
        start[self._of_twist : self._of_twist + 3] = self._twist
        self._twist = self._towards(twist) if held else self._twist
        end[self._of_twist : self._of_twist + 3] = self._twist
        self._plant.follow(self._rows)
        self._look()
        angles = np.array(self._core_motion.wheel_angle_rad)
        self._turned = self._turned + self._signs * (angles - self._last)
        self._last = angles
        ways = np.sign(np.cos(self._angles - np.array(self._core_motion.steering_angle_rad)))
        self._signs = np.array([ways[at] or 1.0 if at >= 0 else 1.0 for at in self._of_wheel])

    def _velocities(self, twist: np.ndarray) -> np.ndarray:
        found: np.ndarray = complex(twist[0], twist[1]) + 1j * twist[2] * self._places
        return found

    def _common(self) -> tuple[np.ndarray, float]:
        """The motion that lets wheels at these angles slide least, and how far the worst wheel points from it."""
        across = 1j * np.exp(1j * self._angles)
        rows = np.stack([across.real, across.imag, (np.conj(across) * 1j * self._places).real / self._length_m], axis=1)
        least = np.linalg.eigh(rows.T @ rows)[1][:, 0]
        twist = least / np.array([1.0, 1.0, self._length_m])
        speeds = np.maximum(np.abs(self._velocities(twist)), 1e-9)
        apart = float(np.arcsin(np.minimum(np.abs(rows @ least) / speeds, 1.0)).max())
        scale = np.array([1.0, 1.0, self._length_m**2])
        return twist if float((scale * twist) @ self._twist) >= 0.0 else -twist, apart

    def _towards(self, twist: np.ndarray) -> np.ndarray:
        """The twist, or one on the way to it that no wheel needs more than its rate for."""
        turns = np.abs(np.angle(self._velocities(twist) * np.conj(self._velocities(self._twist))))
        share = float((turns / (SHARE * self._rates * self._step_s)).max())
        return twist if share <= 1.0 else self._twist + (twist - self._twist) / share

    def speeds(self) -> list[float]:
        """As Chassis.speeds."""
        found: list[float] = (self._signs * np.array(self._core_motion.wheel_speed_rad_per_s)).tolist()
        return found + self._turning.tolist()

    def motion(self) -> Motion:
        """As Chassis.motion."""
        speeds = self._signs * np.array(self._core_motion.wheel_speed_rad_per_s)
        return replace(self._core_motion, wheel_angle_rad=tuple(self._turned.tolist()),
                       wheel_speed_rad_per_s=tuple(speeds.tolist()), steering_angle_rad=tuple(self._angles.tolist()),
                       steering_rate_rad_per_s=tuple(self._turning.tolist()))


@dataclass(frozen=True)
class Axis:
    """The motor of one wheel, or of its steering, as seen from the axle."""

    resistance_ohm: float   # inf: not known, or no motor
    back_emf_Vs: float      # noqa: N815  of the axle's speed
    limit_A: float          # noqa: N815


class Battery:
    """WPILib's battery: voltage = open voltage − resistance · current of all motors together.

    A controller draws `output · motor current` from the battery. Voltage and currents hold at the same time, so a
    battery of more resistance than the motors does not make the voltage jump from cycle to cycle.
    """

    def __init__(self, table: FrcTable, axes: Sequence[Axis]):
        self.open_V, self._resistance, self._axes = table.battery_V, table.battery_resistance_ohm, axes
        self.voltage_V, self.current_A, self.other_A = table.battery_V, 0.0, 0.0
        self.motor_current_A = [0.0] * len(axes)
        self.supply_current_A = [0.0] * len(axes)

    def volts(self, outputs: Sequence[float], speeds: Sequence[float]) -> list[float]:
        """The voltage at each motor for these outputs and speeds; sets battery and currents."""
        emf = [axis.back_emf_Vs * speed for axis, speed in zip(self._axes, speeds, strict=True)]
        self._solve(outputs, emf)
        volts = []
        for at, (axis, output, each) in enumerate(zip(self._axes, outputs, emf, strict=True)):
            ideal = output * self.voltage_V
            current = min(max((ideal - each) / axis.resistance_ohm, -axis.limit_A), axis.limit_A)
            held = ideal if math.isinf(axis.resistance_ohm) else each + current * axis.resistance_ohm
            volts.append(held)
            self.motor_current_A[at] = current
            self.supply_current_A[at] = current * held / self.voltage_V
        self.current_A = sum(self.supply_current_A) + self.other_A
        return volts

    def _solve(self, outputs: Sequence[float], emf: Sequence[float]) -> None:
        """Voltage of the battery at which it gives what the motors draw at that voltage."""
        if not self._resistance:
            return
        voltage, before = self.voltage_V, None
        for _ in range(ROUNDS):
            conductance, pushed, power, limited = 0.0, 0.0, 0.0, 0
            for at, (axis, output, each) in enumerate(zip(self._axes, outputs, emf, strict=True)):
                current = (output * voltage - each) / axis.resistance_ohm
                if abs(current) > axis.limit_A:
                    current = math.copysign(axis.limit_A, current)
                    power += current * (each + current * axis.resistance_ohm)
                    limited |= 1 << at
                else:
                    conductance += output * output / axis.resistance_ohm
                    pushed += output * each / axis.resistance_ohm
            if limited == before:
                break
            before = limited
            whole = 1.0 + self._resistance * conductance
            given = self.open_V + self._resistance * (pushed - self.other_A)
            root = given * given - 4.0 * whole * self._resistance * power
            voltage = max((given + math.sqrt(max(root, 0.0))) / (2.0 * whole), 1e-3)
        self.voltage_V = voltage


class Drivetrain:
    """An FRC robot of a scene, which moves by `run`; `events` counts what its team should know."""

    def __init__(self, scene: Scene | str | Path):
        self.scene = scene if isinstance(scene, Scene) else read_scene(scene)
        self.table = self.scene.frc or FrcTable()
        check_steering(self.scene)
        self.wheel_count, self.steered_count = self.scene.wheel_count, len(self.scene.hinges)
        self.events: dict[str, int] = {}
        self.restart()

    def restart(self) -> None:
        """Puts the robot back to the scene's start, with a battery at rest."""
        self._start(self.scene)

    def _start(self, scene: Scene) -> None:
        self.chassis, self._left_over_s = chassis_of(scene), 0.0
        self.battery = Battery(self.table, axes_of(scene, self.table))

    def place(self, x_m: float, y_m: float, heading_rad: float) -> None:
        """Puts the robot at rest to this pose of its centre."""
        centre = centre_of(self.scene.vehicle) * complex(math.cos(heading_rad), math.sin(heading_rad))
        start = replace(self.scene.initial, x_m=finite_number("x_m", x_m) + centre.real,
                        y_m=finite_number("y_m", y_m) + centre.imag,
                        heading_rad=finite_number("heading_rad", heading_rad))
        self._start(replace(self.scene, initial=start))

    def run(self, duration_s: float, drive: Sequence[float], steering: Sequence[float] = ()) -> None:
        """Moves on with outputs held; what is left of the duration, less than a step, is added to the next."""
        wheels = self._outputs("drive", drive, self.wheel_count)
        outputs = wheels + self._outputs("steering", steering, self.steered_count)
        step_s = self.scene.run.step_s
        left = self._left_over_s + finite_number("duration_s", duration_s)
        if duration_s < 0.0:
            raise BadInput(f"duration_s: {duration_s:g} s is not usable; give 0 or more")
        steps = int(left / step_s + 1e-6)
        self._left_over_s = left - steps * step_s
        for _ in range(steps):
            volts = self.battery.volts(outputs, self.chassis.speeds())
            try:
                self.chassis.step(volts[: self.wheel_count], volts[self.wheel_count :])
            except Refused as refused:
                raise self.scene.refusal_in_file(refused) from None
        if steps:
            self._watch()

    def _outputs(self, name: str, given: Sequence[float], count: int) -> list[float]:
        values = list(finite_numbers(name, given, count))
        if any(abs(each) > 1.0 for each in values):
            self._tell(f"{name}: an output beyond ±1 was cut to the battery's voltage")
            values = [min(max(each, -1.0), 1.0) for each in values]
        return values

    def _watch(self) -> None:
        if self.battery.voltage_V < BROWNOUT_V:
            self._tell(f"the battery was below {BROWNOUT_V:g} V, where a roboRIO switches its outputs off; it was not")
        apart = getattr(self.chassis, "apart_rad", 0.0)
        if apart > LOCKED_RAD:
            self._tell("steered wheels allowed no common motion, so the robot was braked; on ground with friction they "
                       "would slip")
        elif apart > APART_RAD:
            self._tell(f"steered wheels pointed more than {math.degrees(APART_RAD):.0f} degrees from any common motion;"
                       " on ideal ground the robot takes the nearest")

    def _tell(self, event: str) -> None:
        self.events[event] = self.events.get(event, 0) + 1

    def motion(self) -> Motion:
        """Where the robot is, and how it moves."""
        return self.chassis.motion()

    @property
    def battery_V(self) -> float:  # noqa: N802
        """Voltage of the battery in the last step."""
        return self.battery.voltage_V


def check_steering(scene: Scene) -> None:
    """BadInput for a scene with hinges that outputs do not steer."""
    wanted = "motor" if scene.slips_on_hinges else "coordinated"
    for hinge in scene.hinges:
        if hinge.kind != wanted:
            ground = "on ground with friction" if scene.slips_on_hinges else "on ideal ground"
            raise BadInput(f'{scene.path}: {hinge.place}: laconic.frc steers wheels {ground} with steered = "{wanted}";'
                           f' this hinge is "{hinge.kind}"')
    if scene.vehicle.get("drive"):
        raise BadInput(f"{scene.path}: vehicle.drive: the battery of laconic.frc is that of [frc]; take it out, and "
                       "give frc.battery_V and frc.current_limit_A")


def axes_of(scene: Scene, table: FrcTable) -> list[Axis]:
    """Motors of wheels, then of steering."""
    motor = scene.vehicle.get("motor")
    found = [Axis(motor["resistance_ohm"], motor["gear_ratio"] * motor["back_emf_Vs_per_rad"],
                  table.current_limit_A or math.inf) if motor and wheel.get("driven", True)
             else Axis(math.inf, 0.0, math.inf) for wheel in scene.vehicle["wheel"]]
    if table.current_limit_A and not motor:
        raise BadInput(f"{scene.path}: frc.current_limit_A: needs the resistance of the motors; give [vehicle.motor]")
    return found + [_steering_axis(scene, body, table) for body in scene.vehicle.get("body", ())]


def _steering_axis(scene: Scene, body: dict[str, Any], table: FrcTable) -> Axis:
    resistance = body.get("winding_resistance_ohm")
    if not resistance:
        if table.steering_current_limit_A:
            raise BadInput(f"{scene.path}: frc.steering_current_limit_A: needs the resistance of the motors that steer"
                           "; give each wheel a steering_motor")
        return Axis(math.inf, 0.0, math.inf)
    electric = body["damping_Nms"] - body.get("viscous_friction_Nms", 0.0)
    return Axis(resistance, electric / body["gain_Nm_per_V"], table.steering_current_limit_A or math.inf)


def chassis_of(scene: Scene) -> Chassis:
    """The vehicle of a scene at its start."""
    if not scene.has_hinges:
        return Rigid(scene)
    return Slipping(scene) if scene.slips_on_hinges else Coordinated(scene)
