"""A mobile base without any wire: velocity commands in, wheels' voltages by a speed controller, odometry out.

One object has one robot or several, side by side; each of them has the bits that it would have alone. The base drives
and measures by what it believes of its wheels, which `[base]` of the scene may set apart from what they are.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from laconic.can.play.vehicle import moved_inertia
from laconic.core.grip import wheels_text
from laconic.errors import BadInput, Refused
from laconic.ros2.motion import Lanes, Motion, Seen, Singles, motion_of, product
from laconic.scene import Scene
from laconic.scene.base import BaseTable, has_motor, joint_names

BANDWIDTH_RAD_PER_S = 20.0  # of a wheel's speed, where the scene gives no gain: 50 ms, as small bases have
SHARE_OF_STEP = 0.1         # the bandwidth is at most this over the step
MOST_RECORDED_STEPS = 10**6
IMPOSSIBLE = 1e-6           # of a command, m/s or rad/s
TWIST_NAMES = ("linear.x", "linear.y", "angular.z")


@dataclass(frozen=True)
class Beliefs:
    """What the base takes its geometry for: rows of the wheels' speeds, and the way back to a velocity."""

    rows: np.ndarray       # (N, 3)  wheel speeds of a velocity (ahead, left, yaw rate) of the body frame's origin
    estimate: np.ndarray   # (3, N)  the velocity of wheel speeds
    possible: np.ndarray   # (3, 3)  the part of a commanded velocity that the wheels allow


@dataclass(frozen=True)
class Loop:
    """The controller of each wheel: P, I and limit of its voltage, or of its torque."""

    signal: str            # "voltage_V" or "axle_torque_Nm"
    gain: np.ndarray       # (N, 1)
    integral_gain: np.ndarray
    limit: float | None


class Odometry:
    """Where the base takes itself for, from the angles that its encoders show."""

    def __init__(self, travelled: Callable[[np.ndarray, np.ndarray], Sequence[float]]):
        self._travelled = travelled  # ahead, left and turn between two looks at the encoders
        self._angles: np.ndarray | None = None
        self.x_m = self.y_m = self.heading_rad = 0.0
        self.velocity = (0.0, 0.0, 0.0)

    def see(self, angles_rad: np.ndarray, period_s: float) -> None:
        """Adds the motion since the last look, along an arc."""
        before, self._angles = self._angles, angles_rad
        if before is not None and period_s > 0.0:
            ahead, left, turn = self._travelled(before, angles_rad)
            self.add(ahead, left, turn, period_s)

    def add(self, ahead: float, left: float, turn: float, period_s: float) -> None:
        """A motion in the axes of where it began, along an arc."""
        self.velocity = (ahead / period_s, left / period_s, turn / period_s)
        sine, cosine = math.sin(self.heading_rad), math.cos(self.heading_rad)
        half = 0.5 * turn
        along, across = (math.sin(half) / half * math.cos(half), math.sin(half) / half * math.sin(half)) \
            if abs(half) > 1e-9 else (1.0, half)
        dx, dy = along * ahead - across * left, across * ahead + along * left
        self.x_m += cosine * dx - sine * dy
        self.y_m += sine * dx + cosine * dy
        self.heading_rad += turn


class Base:
    """Robots that follow velocity commands. `advance` steps all of them; commands hold until the next."""

    def __init__(self, scene: Scene, robots: int = 1):
        check_drivable(scene)
        self.scene, self.table = scene, scene.base or BaseTable()
        self.step_s, self.robots = scene.run.step_s, robots
        self.wheel_count = scene.wheel_count
        self.motion, self.loop = self._make(robots)
        self.odometry = [self._new_odometry() for _ in range(robots)]
        self.record: list[np.ndarray] | None = None  # of the first robot's input, step by step
        self.is_recording = False
        self.limited = np.zeros((scene.wheel_count, robots), bool)  # at a voltage or torque limit since the last report
        self._wanted = np.zeros((3, robots))   # commands
        self._set = np.zeros((3, robots))      # what the ramps have made of them
        self._integral = np.zeros((scene.wheel_count, robots))
        self._speeds = self.motion.speeds()
        self._set_speeds = np.zeros((scene.wheel_count, robots))
        self._ramps: tuple[Any, float | None] = (self.table.acceleration_limit_m_per_s2,
                                                 self.table.yaw_acceleration_limit_rad_per_s2)
        self._seen_steps = 0
        self.look()

    def _make(self, robots: int) -> tuple[Motion, Loop]:
        """Robots that step, and the controller of their wheels."""
        motion = motion_of(self.scene, robots)
        self.beliefs = beliefs_of(self.scene, self.table, motion)
        return motion, loop_of(self.scene, self.table)

    def _new_odometry(self) -> Odometry:
        return Odometry(self._travelled)

    def _travelled(self, before: np.ndarray, after: np.ndarray) -> Sequence[float]:
        """Ahead, left and turn between two looks at the encoders."""
        found: list[float] = (self.beliefs.estimate @ (after - before)).tolist()
        return found

    @property
    def joint_names(self) -> list[str]:
        """Of the joints in `Seen`: wheels, then hinges."""
        return joint_names(self.table, self.wheel_count, [hinge.name for hinge in self.scene.hinges])

    @property
    def signals(self) -> list[str]:
        """Inputs of a scene that the columns of `record` are."""
        return [f"{self.loop.signal}[{wheel}]" for wheel in range(1, self.wheel_count + 1)]

    # ---- commands

    def command(self, robot: int, ahead: float, left: float, yaw_rate: float) -> list[str]:
        """Sets the velocity of a robot's body frame; returns what of it was limited or is impossible, in words."""
        given = np.array([ahead, left, yaw_rate])
        wanted = self.beliefs.possible @ given
        remarks = [*self._impossible(TWIST_NAMES, given, wanted), *self._limit(wanted)]
        self._wanted[:, robot] = wanted
        return remarks

    @staticmethod
    def _impossible(names: Sequence[str], given: np.ndarray, wanted: np.ndarray) -> list[str]:
        """What of a velocity the wheels do not allow, in words."""
        return [f"{name} = {asked:g} is impossible for these wheels and becomes {got:g}"
                for name, asked, got in zip(names, given, np.round(wanted, 9) + 0.0, strict=False)
                if abs(asked - got) > IMPOSSIBLE]

    def _limit(self, wanted: np.ndarray) -> list[str]:
        """Holds a velocity within the limits of the scene; returns what was limited, in words."""
        remarks = []
        speed, most = float(np.hypot(wanted[0], wanted[1])), self.table.speed_limit_m_per_s
        if most is not None and speed > most:
            wanted[:2] *= most / speed
            remarks.append(f"a speed of {speed:g} m/s is limited to {most:g} m/s")
        most = self.table.yaw_rate_limit_rad_per_s
        if most is not None and abs(wanted[2]) > most:
            remarks.append(f"a yaw rate of {wanted[2]:g} rad/s is limited to {most:g} rad/s")
            wanted[2] = math.copysign(most, wanted[2])
        return remarks

    @property
    def is_car(self) -> bool:
        """Whether `ackermann` drives it."""
        return False

    def ackermann(self, robot: int, speed_m_per_s: float, steering_rad: float, *, acceleration_m_per_s2: float = 0.0,
                  steering_rad_per_s: float = 0.0) -> list[str]:
        """Drives a car by the angle of a wheel on its middle line; returns as `command`."""
        return ["a steering angle is impossible for these wheels"]

    def advance(self, steps: int) -> list[tuple[int, Refused]]:
        """Takes steps of all robots; returns those whose step the core refused, which stand still from then on."""
        loop, step_s, refused = self.loop, self.step_s, []
        for _ in range(steps):
            self._aim()
            error = self._set_speeds - self._speeds
            given = loop.gain * error + self._integral
            growth = loop.integral_gain * step_s * error
            if loop.limit is not None:
                held = np.clip(given, -loop.limit, loop.limit)
                is_over = held != given
                if is_over.any():
                    self.limited |= is_over
                    growth = np.where(is_over & (growth * given > 0.0), 0.0, growth)
                    given = held
            self._integral += growth
            if self.is_recording and self.record is not None and len(self.record) < MOST_RECORDED_STEPS:
                self.record.append(self._inputs(given))
            refused += self.motion.step(given)
            self._speeds = self.motion.speeds()
        return refused

    def words_of_limit(self, robot: int) -> str:
        """Which wheels were at the limit of their voltage or torque since the last report; "" where none was."""
        wheels = (np.flatnonzero(self.limited[:, robot]) + 1).tolist()
        if not wheels or self.loop.limit is None:
            return ""
        which = f"{wheels_text(wheels)} {'are at their' if wheels[1:] else 'is at its'}"
        is_voltage, table = self.loop.signal == "voltage_V", self.table
        key = ("base.torque_limit_Nm" if not is_voltage else
               "base.voltage_limit_V" if table.voltage_limit_V else "vehicle.drive.supply_V")
        return (f"{which} limit of {self.loop.limit:g} {'V' if is_voltage else 'Nm'} ({key}), so the robot follows "
                "more slowly than commanded; command less, give base.acceleration_limit_m_per_s2, or raise the limit")

    def _aim(self) -> None:
        """Makes the set speeds of the coming step."""
        if (self._set != self._wanted).any():
            self._ramp()
            self._set_speeds = self._speeds_of(self._set)

    def _inputs(self, given: np.ndarray) -> np.ndarray:
        """What acts on the first robot in the coming step, by `signals`."""
        return given[:, 0].copy()

    def _ramp(self) -> None:
        """Moves the set velocity towards the command, as far as the acceleration limits allow in one step."""
        change = self._wanted - self._set
        linear, yaw = self._ramps
        if linear is not None:
            size = np.hypot(change[0], change[1])
            change[:2] *= np.minimum(1.0, linear * self.step_s / np.maximum(size, 1e-300))
        if yaw is not None:
            change[2] = np.clip(change[2], -yaw * self.step_s, yaw * self.step_s)
        self._set = np.where(np.abs(self._wanted - self._set - change) < 1e-15, self._wanted, self._set + change)

    def _speeds_of(self, velocity: np.ndarray) -> np.ndarray:
        return product(self.beliefs.rows, velocity)

    # ---- what there is to see

    def look(self) -> list[Seen]:
        """What is true and what the sensors show, robot by robot; the odometry takes its part."""
        steps = self.motion.steps
        period_s, self._seen_steps = (steps - self._seen_steps) * self.step_s, steps
        seen = [self.motion.look(robot, period_s) for robot in range(self.robots)]
        for odometry, each in zip(self.odometry, seen, strict=True):
            odometry.see(each.encoder_rad, period_s)
        return seen

    def is_commanded(self, robot: int) -> bool:
        """Whether a robot's command is to move."""
        return bool(self._wanted[:, robot].any())

    def reset(self, robot: int) -> None:
        """Puts a robot back to the scene's start, with all that it believes."""
        self.motion.restart(robot)
        self.odometry[robot] = self._new_odometry()
        self._forget(robot)

    def place(self, robot: int, x_m: float, y_m: float, heading_rad: float) -> None:
        """Lifts a robot to another pose of its body frame, at rest; its odometry does not notice."""
        self.motion.place(robot, x_m, y_m, heading_rad)
        self.odometry[robot]._angles = None
        self._forget(robot)

    def _forget(self, robot: int) -> None:
        self.is_recording = False  # what comes is no longer the run that began at the scene's start
        for each in (self._wanted, self._set, self._integral):
            each[:, robot] = 0.0
        self._set_speeds[:, robot] = 0.0
        self._speeds = self.motion.speeds()
        self.odometry[robot].see(self.motion.look(robot, 0.0).encoder_rad, 0.0)


# ---- how it is made

def check_drivable(scene: Scene) -> None:
    """BadInput for a vehicle that no base can drive."""
    if not any(driven_wheels(scene)):
        raise BadInput(f"{scene.path}: vehicle.wheel: none is driven, so no command can move the robot; give one with "
                       "driven = true")


def driven_wheels(scene: Scene) -> list[bool]:
    """Which wheels a controller turns."""
    return [bool(wheel["driven"] and not wheel["locked"] and not wheel.get("motor_circuit"))
            for wheel in scene.vehicle["wheel"]]


def beliefs_of(scene: Scene, table: BaseTable, motion: Singles | Lanes) -> Beliefs:
    """The geometry as the base has it."""
    wheels = scene.vehicle["wheel"]
    rows = motion.rows.copy()
    if table.believed_radius_m:
        radii = [wheel.get("radius_m", scene.vehicle["wheel_radius_m"]) for wheel in wheels]
        rows *= np.divide(radii, table.believed_radius_m)[:, np.newaxis]
    rows[:, 2] *= table.believed_size
    across = across_row(wheels)
    full = np.vstack([rows[motion.measured], across])
    inverse = np.linalg.pinv(full)
    estimate = np.zeros((3, len(wheels)))
    estimate[:, motion.measured] = inverse[:, :sum(motion.measured)]
    driven = np.vstack([rows[driven_wheels(scene)], across])
    without = driven.copy()
    without[len(driven) - len(across):] = 0.0
    return Beliefs(rows, estimate, np.linalg.pinv(driven) @ without)


def across_row(wheels: Sequence[dict[str, Any]]) -> np.ndarray:
    """The velocity across fixed wheels, in the mean of them, which a base takes for zero; no row without such wheels.

    For two wheels on one line this is exact. A base on four drags its wheels sideways when it turns.
    """
    fixed = [wheel for wheel in wheels if wheel["kind"] == "fixed"]
    if not fixed:
        return np.zeros((0, 3))
    rows = []
    for wheel in fixed:
        along, up = math.cos(wheel["axle_rad"]), math.sin(wheel["axle_rad"])
        rows.append([along, up, wheel["x_m"] * up - wheel["y_m"] * along])
    signs = [1.0 if np.dot(row[:2], rows[0][:2]) >= 0.0 else -1.0 for row in rows]
    return np.mean(np.array(rows) * np.array(signs)[:, np.newaxis], axis=0, keepdims=True)


def loop_of(scene: Scene, table: BaseTable, radius_m: Sequence[float] | None = None) -> Loop:
    """Gains of the scene, or those of a first-order loop; a wheel without a motor has none. `radius_m`: as in
    `moved_inertia`."""
    core, driven = scene.core(), driven_wheels(scene)
    inertia = moved_inertia(scene, [*driven, *[False] * len(scene.hinges)], radius_m)
    whole = scene.articulated_vehicle(core) if scene.has_hinges else None  # owns the memory of its base
    vehicle = whole.c.base if whole else scene.c_vehicle(core)
    bandwidth = min(BANDWIDTH_RAD_PER_S, SHARE_OF_STEP / scene.run.step_s)
    is_voltage = has_motor(scene.vehicle)
    gains, integrals = np.zeros((2, scene.wheel_count, 1))
    for wheel in (number for number, is_driven in enumerate(driven) if is_driven):
        push, drag = of_motor(vehicle, wheel) if is_voltage else (1.0, 0.0)
        if push == 0.0:
            continue
        own = (table.gain_Vs_per_rad, table.integral_gain_V_per_rad) if is_voltage else (
            table.gain_Nms_per_rad, table.integral_gain_Nm_per_rad)
        proportional = bandwidth * inertia[wheel] / abs(push) if own[0] is None else own[0]
        integral = proportional * max(drag / inertia[wheel], bandwidth / 4.0) if own[1] is None else own[1]
        sign = math.copysign(1.0, push)
        gains[wheel], integrals[wheel] = sign * proportional, sign * integral
    if not is_voltage:
        return Loop("axle_torque_Nm", gains, integrals, table.torque_limit_Nm)
    limit = table.voltage_limit_V or scene.vehicle.get("drive", {}).get("supply_V") or None
    return Loop("voltage_V", gains, integrals, limit)


def of_motor(vehicle: Any, wheel: int) -> tuple[float, float]:
    """Gain and damping of a wheel's motor."""
    own = vehicle.wheel[wheel]
    return (float(own.own_motor_gain_Nm_per_V or vehicle.motor_gain_Nm_per_V),
            float(own.own_motor_damping_Nms or vehicle.motor_damping_Nms))
