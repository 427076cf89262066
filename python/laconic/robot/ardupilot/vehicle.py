"""The vehicle of a scene behind the outputs of an autopilot: pulses in, motion of the body frame's origin out."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from laconic.core.articulated import CARRIAGE, ArticulatedMotion
from laconic.core.spelling import wrapped
from laconic.errors import BadInput
from laconic.ros2.base import Loop, driven_wheels, loop_of
from laconic.scene import Scene
from laconic.scene.base import BaseTable, has_motor
from laconic.scene.drives import SET_SPEED, ArduPilotTable, Channel
from laconic.scene.hinge_signals import ANGLE
from laconic.scene.hinges import Hinge
from laconic.simulation.articulated import follow_rows, start_plant
from laconic.simulation.loads import GRAVITY_M_PER_S2, Loads, centre_of
from laconic.simulation.slipping import SlippingCommands, start_slipping
from laconic.simulation.steering import Commands, LiveInputs

LEFT, RIGHT, STEERING, THROTTLE = 1, 3, 1, 3  # outputs of a rover by ArduPilot's usual SERVOn_FUNCTION
AHEAD = 0.5      # of a wheel's rolling direction along the vehicle's axis at least, to be on its left or right side
OF_ROW = 1e-6    # of the largest number: a wheel that a motion does not turn
MIXES = {  # of AP_MotorsUGV: throttle, steering to the right and lateral to the right, for motors 1, 2 …
    "OmniX": ((1, -1, -1), (1, -1, 1), (1, 1, -1), (1, 1, 1)),
    "OmniPlus": ((0, 1, 1), (1, 0, 0), (0, -1, 1), (1, 0, 0)),
    "Omni3": ((1, -1, -1), (0, -1, 1), (1, 1, 1))}


@dataclass(frozen=True)
class Seen:
    """The motion of the body frame's origin, x ahead and y to the left, and what the supply gives."""

    place: complex                        # m, in the world
    heading_rad: float
    wrapped_rad: float                    # the same in (−π, π]
    velocity: complex                     # m/s, in the world
    yaw_rate_rad_per_s: float
    supply: tuple[float, float] | None    # V, A; None: the scene has none
    imu: tuple[float, float, float] | None = None  # of the scene: m/s² ahead and left, rad/s


class Robot(Protocol):
    """A plant that takes steps of any size."""

    def step(self, values: np.ndarray, count: int) -> None:
        """Some steps with these inputs held."""

    def set_step(self, step_s: float) -> None:
        """Another step from here on."""

    def speeds(self) -> np.ndarray:
        """Of the wheels."""

    def look(self) -> Seen:
        """Now."""


class Rigid:
    """A vehicle without hinges."""

    def __init__(self, scene: Scene, signals: Sequence[str]):
        core = scene.core()
        self.plant, self._centre = scene.plant(core), centre_of(scene.vehicle)
        self._sensors = scene.sensors_of(self.plant) if scene.sensors.imu is not None else None
        self._slots = [core.input_offset(signal) for signal in signals]
        self._row = np.zeros(core.input_length, core.dtype)
        self._has_supply = bool(scene.vehicle.get("drive", {}).get("supply_V"))

    def step(self, values: np.ndarray, count: int) -> None:
        """As Robot.step."""
        self._row[self._slots] = values
        (self._sensors or self.plant).run(self.plant.core.input(self._row), count)

    def set_step(self, step_s: float) -> None:
        """As Robot.set_step."""
        self.plant.set_step(step_s)

    def speeds(self) -> np.ndarray:
        """As Robot.speeds."""
        return self.plant.wheel_speeds()

    def look(self) -> Seen:
        """As Robot.look."""
        pose, (velocity, yaw_rate) = self.plant.pose, self.plant.body_velocity()
        slip, imu = self.plant.c.slip, None
        if self._sensors is not None:
            read = self._sensors.read()
            ahead, left = read.imu_acceleration_m_per_s2.tolist()
            imu = (ahead, left, read.imu_yaw_rate_rad_per_s)
        supply = (float(slip.supply_voltage_V), float(slip.supply_current_A)) if self._has_supply else None
        return Seen(complex(pose.origin_x_m, pose.origin_y_m), pose.heading_rad, pose.heading_wrapped_rad,
                    of_origin(complex(*velocity.tolist()), float(yaw_rate), self._centre, pose.heading_rad),
                    float(yaw_rate), supply, imu)


class OnHinges:
    """A vehicle with hinges on ideal ground."""

    def __init__(self, scene: Scene, signals: Sequence[str]):
        self._live = LiveInputs(signals, scene.run.step_s)
        self._centre, self._loads = centre_of(scene.vehicle), Loads(scene)
        self._watched = [(at, hinge) for at, hinge in enumerate(scene.hinges)
                         if hinge.has_stops and not hinge.is_commanded]
        self._start(scene)

    def _start(self, scene: Scene) -> None:
        vehicle = scene.articulated_vehicle(scene.core())
        self.commands = Commands(scene, vehicle, self._live)
        self.plant: Any = start_plant(scene, vehicle, self.commands.first_row())

    def step(self, values: np.ndarray, count: int) -> None:
        """As Robot.step."""
        self._live.values[:] = values
        self._follow(count)
        if self.commands.refused:
            raise self.commands.refused

    def _follow(self, count: int) -> None:
        follow_rows(self.plant, self.commands.rows(self.plant.steps, count), self._watched)

    def set_step(self, step_s: float) -> None:
        """As Robot.set_step."""
        self._live.step_s = step_s
        self.plant.set_step(step_s)

    def speeds(self) -> np.ndarray:
        """As Robot.speeds."""
        found: np.ndarray = self.plant.motion().wheel_speed_rad_per_s
        return found

    def look(self) -> Seen:
        """As Robot.look."""
        return self._seen(self.plant.motion(), None)

    def _seen(self, motion: ArticulatedMotion, supply: tuple[float, float] | None) -> Seen:
        velocity = of_origin(complex(*motion.velocity_m_per_s.tolist()), motion.yaw_rate_rad_per_s, self._centre,
                             motion.heading_rad)
        return Seen(complex(*self._loads.origin_of(motion)), motion.heading_rad, wrapped(motion.heading_rad), velocity,
                    motion.yaw_rate_rad_per_s, supply)


class SlippingOnHinges(OnHinges):
    """A vehicle with hinges on ground with friction."""

    commands: SlippingCommands

    def _start(self, scene: Scene) -> None:
        vehicle = scene.slipping_vehicle(scene.core())
        self.commands = SlippingCommands(scene, vehicle, self._live)
        self.plant = start_slipping(scene, vehicle, self.commands.start_angles())
        self._has_supply = bool(scene.vehicle.get("drive", {}).get("supply_V"))

    def _follow(self, count: int) -> None:
        self.plant.follow(self.commands.held_rows(self.plant.steps, count))

    def look(self) -> Seen:
        """As Robot.look."""
        found = self.plant.outputs()
        return self._seen(found.motion, (found.supply_voltage_V, found.supply_current_A) if self._has_supply else None)


def of_origin(velocity: complex, yaw_rate: float, centre: complex, heading_rad: float) -> complex:
    """The velocity of the body frame's origin in the world, from that of the centre of mass in body axes."""
    return (velocity - 1j * yaw_rate * centre) * cmath.exp(1j * heading_rad)


def robot_of(scene: Scene, signals: Sequence[str]) -> Robot:
    """The robot of a scene of any kind."""
    if not scene.has_hinges:
        return Rigid(scene, signals)
    return (SlippingOnHinges if scene.slips_on_hinges else OnHinges)(scene, signals)


class Outputs:
    """The autopilot's outputs as inputs of the vehicle."""

    def __init__(self, scene: Scene):
        self.table = scene.ardupilot or ArduPilotTable()
        self.channels = self.table.channels or usual_channels(scene, self.table)
        self._loop = self._loop_of(scene)
        places: dict[str, int] = {}
        self._parts: list[tuple[int, int, float]] = []
        self.speed_of: dict[int, int] = {}  # place of a signal → the wheel whose set speed it is
        for channel in self.channels:
            for signal in channel.signals:
                at = places.setdefault(self._input_of(signal), len(places))
                self._parts.append((channel.number - 1, at, channel.full))
                if signal.startswith(SET_SPEED):
                    self.speed_of[at] = wheel_of(signal)
        self.signals = tuple(places)
        self.restart()

    def _loop_of(self, scene: Scene) -> Loop | None:
        if not any(signal.startswith(SET_SPEED) for channel in self.channels for signal in channel.signals):
            return None
        if scene.slips_on_hinges:
            raise BadInput(f"{scene.path}: ardupilot: {SET_SPEED} is not played for hinges on ground with friction "
                           "yet; set voltages")
        return loop_of(scene, scene.base or BaseTable())

    def _input_of(self, signal: str) -> str:
        if self._loop is None or not signal.startswith(SET_SPEED):
            return signal
        return f"{self._loop.signal}[{wheel_of(signal) + 1}]"

    def restart(self) -> None:
        """The controllers forget."""
        self._integral = np.zeros(len(self.signals))

    @property
    def has_controllers(self) -> bool:
        """Whether an output sets speeds, so that the inputs change from step to step."""
        return self._loop is not None

    def shares(self, pulses_us: Sequence[int]) -> tuple[list[float], list[int]]:
        """Shares from −1 to 1, and the outputs, from 1, whose pulse was beyond and was cut. No pulse (0) is a share of
        0."""
        low, middle, high = self.table.pwm_us
        shares, cut = [], []
        for number, pulse in enumerate(pulses_us, start=1):
            within = min(max(float(pulse), low), high) if pulse else middle
            shares.append((within - middle) / ((high if within > middle else middle) - (middle if within > middle
                                                                                       else low)))
            if pulse and within != pulse and any(channel.number == number for channel in self.channels):
                cut.append(number)
        return shares, cut

    def values(self, shares: Sequence[float]) -> np.ndarray:
        """What the shares make of each of `signals`; set speeds where it has a controller."""
        found = np.zeros(len(self.signals))
        for at, slot, full in self._parts:
            found[slot] += full * (shares[at] if at < len(shares) else 0.0)
        return found

    def controlled(self, wanted: np.ndarray, speeds: np.ndarray, step_s: float) -> np.ndarray:
        """The values with voltages or torques instead of set speeds, for one step."""
        loop, found = self._loop, wanted.copy()
        for at, wheel in self.speed_of.items() if loop is not None else ():
            assert loop is not None
            error = wanted[at] - float(speeds[wheel])
            free = float(loop.gain[wheel, 0]) * error + self._integral[at]
            found[at] = free if loop.limit is None else min(max(free, -loop.limit), loop.limit)
            growth = float(loop.integral_gain[wheel, 0]) * step_s * error
            if found[at] == free or growth * free < 0.0:
                self._integral[at] += growth
        return found


def wheel_of(signal: str) -> int:
    """The wheel of a signal, from 0."""
    return int(signal.partition("[")[2].rstrip("]")) - 1


# ---- the usual outputs of each kind of vehicle

REMEDY = "name the outputs as [[ardupilot.channel]]"


def usual_channels(scene: Scene, table: ArduPilotTable) -> tuple[Channel, ...]:
    """Those of a car, a skid-steered rover, or an omni or mecanum rover of ArduPilot's frames."""
    driven = [wheel for wheel, is_driven in enumerate(driven_wheels(scene), start=1) if is_driven]
    if not driven:
        raise BadInput(f"{scene.path}: vehicle.wheel: none is driven, so no output can move the vehicle; give one with "
                       "driven = true")
    full, signal = throttle_of(scene, table)
    wheels = scene.vehicle["wheel"]
    steered = [hinge for hinge in scene.hinges if hinge.kind != "free" or hinge.follows]
    if steered:
        signals, most = steering_of(scene, steered)
        return (Channel(STEERING, signals, -(table.full_steering_rad or most)),  # to the right: below 0 here
                *(Channel(THROTTLE, (f"{signal}[{wheel}]",), sign * full) for wheel, sign in
                  ((wheel, ahead(scene, wheel)) for wheel in driven)))
    if all(wheels[wheel - 1]["kind"] == "fixed" for wheel in driven):
        return tuple(Channel(side_of(scene, wheel), (f"{signal}[{wheel}]",), ahead(scene, wheel) * full)
                     for wheel in driven)
    return omni_channels(scene, driven, full, signal)


def throttle_of(scene: Scene, table: ArduPilotTable) -> tuple[float, str]:
    """The value at full throttle, and the signal's name."""
    if table.full_speed_rad_per_s is not None:
        return table.full_speed_rad_per_s, SET_SPEED
    if not has_motor(scene.vehicle):
        raise BadInput(f"{scene.path}: vehicle.motor: is missing, so throttle is no voltage; give it, or "
                       "ardupilot.full_speed_rad_per_s")
    of_drives = scene.rig.drives.numbers.get("supply_V", ()) if scene.rig.drives else ()
    found = table.full_V or scene.vehicle.get("drive", {}).get("supply_V") or max(of_drives, default=0.0)
    if not found:
        raise BadInput(f"{scene.path}: ardupilot.full_V: is missing, and the scene has no supply; give the voltage of "
                       "the motors at full throttle")
    return float(found), "voltage_V"


def steering_of(scene: Scene, steered: Sequence[Hinge]) -> tuple[tuple[str, ...], float]:
    """The signals of one steering output, and the angle at full steering."""
    coordinated = [hinge for hinge in steered if hinge.kind == "coordinated"]
    for hinge in steered:
        if hinge.kind == "motor" and hinge.follows != "angle":
            raise BadInput(f"{scene.path}: {hinge.place}: its motor turns it, and a steering output gives an angle; "
                           f'make it "prescribed", or {REMEDY}')
        if not hinge.follows and not math.isfinite(hinge.rate_limit_rad_per_s):
            raise BadInput(f"{scene.path}: {hinge.place}.rate_limit_rad_per_s: is missing; the angle of a steering "
                           "output is followed within a largest rate, which it must give")
    on_carriage = [wheel for wheel in scene.vehicle["wheel"] if wheel.get("body", CARRIAGE) == CARRIAGE]
    if coordinated and not any(wheel["kind"] == "fixed" for wheel in on_carriage):
        raise BadInput(f"{scene.path}: vehicle.wheel: all wheels are steered together, and ArduPilot has no output for "
                       f"that; {REMEDY}")
    stops = [min(-hinge.low_rad, hinge.high_rad) for hinge in steered if hinge.has_stops]
    if not stops and not (scene.ardupilot and scene.ardupilot.full_steering_rad):
        raise BadInput(f"{scene.path}: ardupilot.full_steering_rad: is missing, and no steered wheel has stops; give "
                       "the angle at full steering")
    singly = tuple(f"{ANGLE}[{hinge.name}]" for hinge in steered if hinge.kind != "coordinated")
    return ((ANGLE,) if coordinated else ()) + singly, min(stops, default=0.0)


def ahead(scene: Scene, wheel: int) -> float:
    """1 for a wheel whose positive speed rolls the vehicle forward, else −1."""
    found = -math.sin(scene.vehicle["wheel"][wheel - 1]["axle_rad"])
    if abs(found) < AHEAD:
        raise refused(scene, wheel, "does not roll along the vehicle")
    return math.copysign(1.0, found)


def side_of(scene: Scene, wheel: int) -> int:
    """The output of a wheel of a skid-steered rover."""
    y_m = scene.vehicle["wheel"][wheel - 1]["y_m"]
    if not y_m:
        raise refused(scene, wheel, "is on the middle line, neither left nor right")
    return LEFT if y_m > 0.0 else RIGHT


def refused(scene: Scene, wheel: int, why: str) -> BadInput:
    """No usual output for a wheel."""
    return BadInput(f"{scene.path}: vehicle.wheel[{wheel}]: {why}, so it has no usual output of ArduPilot; {REMEDY}")


def omni_channels(scene: Scene, driven: Sequence[int], full: float, signal: str) -> tuple[Channel, ...]:
    """The motor of each wheel, by the frame whose mix has the signs of the wheels' speeds."""
    core = scene.core()
    rows = core.matrices(scene.c_vehicle(core)).wheel_rows[[wheel - 1 for wheel in driven]]
    signs = np.where(np.abs(rows) > OF_ROW * np.abs(rows).max(), np.sign(rows), 0.0)
    for mix in MIXES.values():
        if len(mix) == len(driven) and (motors := matched(signs, mix)):
            return tuple(Channel(motor, (f"{signal}[{wheel}]",), sign * full)
                         for wheel, (motor, sign) in zip(driven, motors, strict=True))
    raise BadInput(f"{scene.path}: vehicle.wheel: these wheels are none of ArduPilot's frames {', '.join(MIXES)}; "
                   f"{REMEDY}")


def matched(signs: np.ndarray, mix: Sequence[tuple[int, int, int]]) -> list[tuple[int, float]]:
    """The motor, from 1, and the direction of each wheel; empty where the mix is not that of these wheels."""
    free, found = list(range(len(mix))), list[tuple[int, float]]()
    for ahead_sign, left_sign, turn_sign in signs.tolist():
        for motor, sign in ((motor, sign) for motor in free for sign in (1.0, -1.0)):
            throttle, steering, lateral = (sign * each for each in mix[motor])
            if (throttle, -lateral) == (ahead_sign, left_sign) and steering in (0.0, -turn_sign):
                found.append((motor + 1, sign))
                free.remove(motor)
                break
    return found if not free else []


def specific_force(before: Seen, now: Seen, seconds: float) -> tuple[float, float, float]:
    """Mean over a frame, in the axes of its middle, forward, right and down: what an accelerometer shows."""
    middle = 0.5 * (before.heading_rad + now.heading_rad)
    mean = (now.velocity - before.velocity) / seconds * cmath.exp(-1j * middle)
    return mean.real, -mean.imag, -GRAVITY_M_PER_S2


def usual_or_given(scene: Scene) -> str:
    """Where the outputs come from, in words."""
    return "of [ardupilot]" if scene.ardupilot and scene.ardupilot.channels else "the usual ones"


def check_level(scene: Scene) -> None:
    """BadInput for a slope, on which down is not across the ground."""
    if scene.vehicle.get("ground", {}).get("slope_rad"):
        raise BadInput(f"{scene.path}: ground.slope_rad: an autopilot is played on level ground alone; take it out")
