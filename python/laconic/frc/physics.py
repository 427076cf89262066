"""The physics engine of a robot in Python: `physics.py` of pyfrc, in the process and in lock-step with the robot.

    PhysicsEngine = laconic.frc.engine("robot.toml")                                    # devices as in [frc]
    PhysicsEngine = laconic.frc.engine("robot.toml", lambda robot: {"drive": robot.drive_motors, …})

A device is one of WPILib (by its name in [frc], or the object), or an object of Phoenix 6 (TalonFX, CANcoder, Pigeon2)
or of REV (SparkMax, SparkFlex), whose own simulations do the rest. Outputs act from the end of the cycle that set them.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from laconic.errors import BadInput, nearest_of, shown
from laconic.frc.drivetrain import Drivetrain
from laconic.scene import read_scene
from laconic.scene.base import Device

TURN = 2.0 * math.pi
PARTS = ("drive", "drive_encoder", "steering", "steering_encoder", "gyro")
NEVER_S = 1e30               # between two counts of an encoder that stands
FULL_SCALE_V = 5.0           # of an absolute encoder at an analog input
Devices = Callable[[Any], Mapping[str, Any]]


@dataclass
class Reading:
    """What one motor, encoder or gyro shows."""

    angle_rad: float
    rate_rad_per_s: float
    seconds: float           # since the reading before
    battery_V: float         # noqa: N815
    supply_A: float = 0.0    # noqa: N815
    motor_A: float = 0.0     # noqa: N815


class Port(Protocol):
    """One device."""

    def show(self, reading: Reading) -> None:
        """Sets what the robot program reads."""


class Output(Port, Protocol):
    """A device that drives a motor."""

    def output(self, battery_V: float) -> float:  # noqa: N803
        """The share of the battery's voltage."""


class Pwm:
    """A PWM port."""

    def __init__(self, channel: int, sign: float):
        from wpilib.simulation import PWMSim

        self._sim, self._sign = PWMSim(channel), sign
        self.is_there = self._sim.getInitialized()

    def output(self, battery_V: float) -> float:  # noqa: N803
        """As Output.output."""
        return self._sign * float(self._sim.getSpeed())

    def show(self, reading: Reading) -> None:
        """A PWM port reads nothing."""


class Resettable:
    """A counter that the robot program may set to zero: what it left there is kept as an offset."""

    def __init__(self) -> None:
        self._written, self._offset = 0.0, 0.0

    def shifted(self, value: float, there: float) -> float:
        """The value to write, where `there` is what the counter shows."""
        if there != self._written:
            self._offset = there - (self._written - self._offset)
        self._written = value + self._offset
        return self._written


class Counter(Resettable):
    """A quadrature encoder."""

    def __init__(self, sim: Any, counts: float, sign: float):
        super().__init__()
        self._sim, self._per_rad = sim, sign * counts / TURN
        self.is_there = sim.getInitialized()
        self._written = sim.getCount()
        self._offset = self._written

    def show(self, reading: Reading) -> None:
        """As Port.show."""
        there = self._sim.getCount()
        self._sim.setCount(int(self.shifted(math.floor(reading.angle_rad * self._per_rad), there)))
        rate = reading.rate_rad_per_s * self._per_rad
        self._sim.setPeriod(1.0 / rate if rate else NEVER_S)


class Absolute:
    """An encoder that shows the share of a turn."""

    def __init__(self, write: Callable[[float], None], scale: float, sign: float, is_there: bool = True):
        self._write, self._scale, self._sign, self.is_there = write, scale, sign, is_there

    def show(self, reading: Reading) -> None:
        """As Port.show."""
        self._write(self._scale * ((self._sign * reading.angle_rad / TURN) % 1.0))


class Gyro(Resettable):
    """A gyro in degrees."""

    def __init__(self, read: Callable[[], float], write: Callable[[float], None],
                 write_rate: Callable[[float], None] | None, sign: float):
        super().__init__()
        self._read, self._write, self._write_rate, self._sign = read, write, write_rate, sign
        self._written = self._offset = read()

    def show(self, reading: Reading) -> None:
        """As Port.show."""
        self._write(self.shifted(self._sign * math.degrees(reading.angle_rad), self._read()))
        if self._write_rate:
            self._write_rate(self._sign * math.degrees(reading.rate_rad_per_s))


class Values:
    """A SimDevice, as vendors and WPILib make them for devices on CAN."""

    def __init__(self, name: str):
        from wpilib.simulation import SimDeviceSim

        self._sim, self.name = SimDeviceSim(name), name

    def value(self, name: str) -> Any:
        """One of its numbers; BadInput where there is no such."""
        value = self._sim.getDouble(name)
        if value:
            return value
        wanted = f"{self.name}/{name}"
        raise BadInput(f"frc: the robot program has no {wanted}; {nearest_of(wanted, self._known(), 'correct [frc]')}")

    def _known(self) -> list[str]:
        from wpilib.simulation import SimDeviceSim

        return [f"{device}/{name}" for device in SimDeviceSim.enumerateDevices()
                for name, _ in SimDeviceSim(device).enumerateValues()]


class CanMotor:
    """A motor controller on CAN that WPILib knows."""

    def __init__(self, device: Device):
        values = Values(f"CANMotor:{device.name}" if device.kind == "CANMotor" else device.name)
        self._output, self._sign = values.value(device.value or "percentOutput"), device.sign

    def output(self, battery_V: float) -> float:  # noqa: N803
        """As Output.output."""
        return self._sign * float(self._output.get())

    def show(self, reading: Reading) -> None:
        """An encoder of its own is a device of its own."""


class CanEncoder:
    """An encoder on CAN that WPILib knows, or another number in turns."""

    def __init__(self, device: Device):
        values = Values(device.name if device.kind == "SimDevice" else f"{device.kind}:{device.name}")
        self._position, self._sign = values.value(device.value or "position"), device.sign
        self._velocity = values.value("velocity") if device.kind == "CANEncoder" else None

    def show(self, reading: Reading) -> None:
        """As Port.show."""
        self._position.set(self._sign * reading.angle_rad / TURN)
        if self._velocity is not None:
            self._velocity.set(self._sign * reading.rate_rad_per_s / TURN)


class Talon:
    """A TalonFX of Phoenix 6."""

    def __init__(self, motor: Any, gearing: float, sign: float):
        self._sim, self._gearing = motor.sim_state, sign * gearing

    def output(self, battery_V: float) -> float:  # noqa: N803
        """As Output.output."""
        self._sim.set_supply_voltage(battery_V)
        return math.copysign(1.0, self._gearing) * float(self._sim.motor_voltage) / battery_V

    def show(self, reading: Reading) -> None:
        """As Port.show."""
        self._sim.set_raw_rotor_position(self._gearing * reading.angle_rad / TURN)
        self._sim.set_rotor_velocity(self._gearing * reading.rate_rad_per_s / TURN)


class Spark:
    """A SPARK MAX or SPARK Flex of REV."""

    def __init__(self, motor: Any, gearing: float, sign: float):
        import rev
        from wpimath.system.plant import DCMotor

        is_flex = isinstance(motor, rev.SparkFlex)
        self._sim = rev.SparkFlexSim(motor, DCMotor.neoVortex(1)) if is_flex else rev.SparkMaxSim(motor, DCMotor.NEO(1))
        self._factor = motor.configAccessor.encoder.getVelocityConversionFactor
        self._gearing, self._angle = sign * gearing, 0.0

    def output(self, battery_V: float) -> float:  # noqa: N803
        """As Output.output."""
        return math.copysign(1.0, self._gearing) * float(self._sim.getAppliedOutput())

    def show(self, reading: Reading) -> None:
        """As Port.show; its encoder adds up speed over time, so it gets the mean."""
        turned, self._angle = reading.angle_rad - self._angle, reading.angle_rad
        if reading.seconds > 0.0:
            rpm = 60.0 * self._gearing * turned / TURN / reading.seconds
            self._sim.iterate(rpm * self._factor(), reading.battery_V, reading.seconds)
        self._sim.setMotorCurrent(reading.motor_A)


class Cancoder:
    """A CANcoder of Phoenix 6."""

    def __init__(self, coder: Any, sign: float):
        self._sim, self._sign = coder.sim_state, sign

    def show(self, reading: Reading) -> None:
        """As Port.show."""
        self._sim.set_raw_position(self._sign * reading.angle_rad / TURN)
        self._sim.set_velocity(self._sign * reading.rate_rad_per_s / TURN)


class Pigeon:
    """A Pigeon 2 of Phoenix 6, which counts counter-clockwise."""

    def __init__(self, gyro: Any, sign: float):
        self._sim, self._sign = gyro.sim_state, sign

    def show(self, reading: Reading) -> None:
        """As Port.show."""
        self._sim.set_raw_yaw(self._sign * math.degrees(reading.angle_rad))
        self._sim.set_angular_velocity_z(self._sign * math.degrees(reading.rate_rad_per_s))


def identity(given: Any) -> object:
    """The same for all wheels that share a device; a second writer would look like a reset by the program."""
    if isinstance(given, Device):
        return given.kind, given.name, given.value
    return id(given[1] if isinstance(given, tuple) and len(given) == 2 else given)


def port_of(part: str, given: Any, counts: float, gearing: float | None) -> Any:
    """The device that `[frc]` names, or that the robot program has as an object; (-1, object): it turns backwards."""
    if isinstance(given, Device):
        return _named(part, given, counts)
    sign = 1.0
    if isinstance(given, tuple) and len(given) == 2 and given[0] in (-1, 1):
        sign, given = float(given[0]), given[1]
    sim_state = getattr(given, "sim_state", None)
    if hasattr(sim_state, "set_raw_rotor_position"):
        return Talon(given, _known(part, gearing), sign)
    if hasattr(sim_state, "set_raw_position"):
        return Cancoder(given, sign)
    if hasattr(sim_state, "set_raw_yaw"):
        return Pigeon(given, sign)
    if type(given).__module__.partition(".")[0] == "rev" and hasattr(given, "configAccessor"):
        return Spark(given, _known(part, gearing), sign)
    return _of_wpilib(part, given, counts, sign)


def _known(part: str, gearing: float | None) -> float:
    if gearing is None:
        raise BadInput(f"frc.{part}: needs the gearing of its motor; give the scene [vehicle.motor] or steering_motor")
    return gearing


def _named(part: str, device: Device, counts: float) -> Any:
    import wpilib.simulation as sim

    number = int(device.name) if device.name.isdigit() else 0
    made: Any = None
    if device.kind == "PWM":
        made = Pwm(number, device.sign)
    elif device.kind == "Encoder":
        made = Counter(_encoder(sim, number, device), counts, device.sign)
    elif device.kind == "AnalogInput":
        analog = sim.AnalogInputSim(number)
        made = Absolute(analog.setVoltage, FULL_SCALE_V, device.sign, analog.getInitialized())
    elif device.kind in ("DutyCycleEncoder", "AnalogEncoder"):
        name = f"{device.kind}[{device.name}]"
        made = Absolute(Values({"DutyCycleEncoder": f"DutyCycle:{name}"}.get(device.kind, name)).value("Position").set,
                        1.0, device.sign)
    elif device.kind == "AnalogGyro":
        gyro = sim.AnalogGyroSim(number)
        made = Gyro(gyro.getAngle, gyro.setAngle, gyro.setRate, -device.sign)
        made.is_there = gyro.getInitialized()
    elif part == "gyro":
        made = _gyro(device)
    else:
        made = CanMotor(device) if part in ("drive", "steering") else CanEncoder(device)
    if not getattr(made, "is_there", True):
        raise BadInput(f'frc.{part}: the robot program has no "{device.text.lstrip("-")}"; make it in the program, or '
                       "correct [frc]")
    return made


def _encoder(sim: Any, number: int, device: Device) -> Any:
    try:
        return sim.EncoderSim.createForChannel(number)
    except (IndexError, RuntimeError):
        raise BadInput(f'frc: the robot program has no "{device.text.lstrip("-")}", an Encoder with its channel A on '
                       f"DIO {number}; correct [frc]") from None


def _gyro(device: Device) -> Gyro:
    name = {"ADXRS450": f"Gyro:ADXRS450[{device.name}]", "CANGyro": f"CANGyro:{device.name}"}.get(
        device.kind, device.name)
    values, axis = Values(name), "z" if device.kind == "CANGyro" else "x"
    angle = values.value(device.value or f"angle_{axis}")
    rate = None if device.kind == "SimDevice" else values.value(f"rate_{axis}").set
    return Gyro(angle.get, angle.set, rate, device.sign if device.kind == "CANGyro" else -device.sign)


def _of_wpilib(part: str, given: Any, counts: float, sign: float) -> Any:
    import wpilib
    import wpilib.simulation as sim

    if isinstance(given, wpilib.PWMMotorController):
        return Pwm(given.getChannel(), sign)
    if isinstance(given, wpilib.Encoder):
        return Counter(sim.EncoderSim(given), counts, sign)
    if isinstance(given, wpilib.DutyCycleEncoder):
        return Absolute(sim.DutyCycleEncoderSim(given).set, 1.0, sign)
    if isinstance(given, wpilib.AnalogEncoder):
        return Absolute(sim.AnalogEncoderSim(given).set, 1.0, sign)
    if isinstance(given, wpilib.AnalogGyro):
        gyro = sim.AnalogGyroSim(given)
        return Gyro(gyro.getAngle, gyro.setAngle, gyro.setRate, -sign)
    raise BadInput(f"frc.{part}: {shown(given)} is not a device that laconic.frc knows; give one of WPILib, Phoenix 6 "
                   "or REV, or drive laconic.frc.Drivetrain from your own physics.py")


class Engine:
    """pyfrc's PhysicsEngine for a scene; `engine` makes the class that a physics.py names."""

    scene: Path
    devices: Devices | None = None

    def __init__(self, physics_controller: Any, robot: Any):
        self.drivetrain = Drivetrain(read_scene(self.scene))
        table, parts = self.drivetrain.table, self._parts(robot)
        ratios = self._gearings()
        wheels = self.drivetrain.wheel_count
        counts = {"drive_encoder": table.drive_counts, "steering_encoder": table.steering_counts}
        self._ports: dict[str, list[Any]] = {}
        shown_by: dict[object, tuple[str, int, Any]] = {}  # one for each device, however many wheels name it: the last
        for part in PARTS:
            given = parts.get(part) or ()
            many = given if isinstance(given, Sequence) and not isinstance(given, str) else (given,)
            of_part = ratios[:wheels] if part.startswith("drive") else ratios[wheels:]
            self._check_count(part, many)
            self._ports[part] = [port_of(part, each, counts.get(part, 0.0), of_part[at] if at < len(of_part) else None)
                                 for at, each in enumerate(many)]
            shown_by |= {identity(each): (part, at, port) for at, (each, port) in
                         enumerate(zip(many, self._ports[part], strict=True))}
        self._shown = {part: [(at, port) for of_part, at, port in shown_by.values() if of_part == part]
                       for part in PARTS}
        self._field = getattr(physics_controller, "field", None)
        self._outputs: tuple[list[float], list[float]] = ([0.0] * wheels, [0.0] * self.drivetrain.steered_count)
        robot.physics = self
        self._show(0.0)

    def _parts(self, robot: Any) -> dict[str, Any]:
        table = self.drivetrain.table
        parts: dict[str, Any] = {part: getattr(table, part) for part in PARTS}
        given = type(self).devices
        own = given(robot) if given else {}
        if not isinstance(own, Mapping):
            raise BadInput(f"frc: the function of devices gave {shown(own)}; let it return a dict of lists by "
                           f"{', '.join(PARTS)}")
        if unknown := [each for each in own if each not in PARTS]:
            raise BadInput(f"frc.{unknown[0]}: there is no such list of devices; {nearest_of(str(unknown[0]), PARTS)}")
        return parts | dict(own)

    def _check_count(self, part: str, many: Sequence[Any]) -> None:
        wanted = {"drive": self.drivetrain.wheel_count, "steering": self.drivetrain.steered_count}.get(
            part.partition("_")[0], 1)
        if not many and "_" not in part and part != "gyro" and wanted:
            raise BadInput(f"{self.drivetrain.scene.path}: frc.{part}: is missing; name the output of each motor, such "
                           'as "PWM[0]", or give the objects to laconic.frc.engine')
        if many and len(many) != wanted:
            raise BadInput(f"frc.{part}: has {len(many)} devices for {wanted} axes; give one for each, in the scene's "
                           "order")

    def _gearings(self) -> list[float | None]:
        scene = self.drivetrain.scene
        motor = scene.vehicle.get("motor")
        found: list[float | None] = [motor["gear_ratio"] if motor else None] * scene.wheel_count
        return found + [dict(hinge.motor)["gear_ratio"] if hinge.motor else None for hinge in scene.hinges]

    def update_sim(self, now: float, tm_diff: float) -> None:
        """One cycle of the robot: moves under the outputs that were set before it, then shows sensors."""
        from wpilib.simulation import DriverStationSim

        self.drivetrain.run(tm_diff, *self._outputs)
        self._show(tm_diff)
        battery, is_on = self.drivetrain.battery.voltage_V, DriverStationSim.getEnabled()
        self._outputs = ([each.output(battery) if is_on else 0.0 for each in self._ports["drive"]],
                         [each.output(battery) if is_on else 0.0 for each in self._ports["steering"]])

    def _show(self, seconds: float) -> None:
        motion, battery = self.drivetrain.motion(), self.drivetrain.battery
        wheels = self.drivetrain.wheel_count
        for part, first, angles, rates in (
                ("drive", 0, motion.wheel_angle_rad, motion.wheel_speed_rad_per_s),
                ("steering", wheels, motion.steering_angle_rad, motion.steering_rate_rad_per_s)):
            for name in (part, f"{part}_encoder"):
                for at, port in self._shown[name]:
                    port.show(Reading(angles[at], rates[at], seconds, battery.voltage_V,
                                      battery.supply_current_A[first + at], battery.motor_current_A[first + at]))
        for _, port in self._shown["gyro"]:
            port.show(Reading(motion.heading_rad, motion.yaw_rate_rad_per_s, seconds, battery.voltage_V))
        self._show_power()
        if self._field is not None:
            from wpimath.geometry import Pose2d

            self._field.setRobotPose(Pose2d(motion.x_m, motion.y_m, motion.heading_rad))

    def _show_power(self) -> None:
        from wpilib.simulation import PowerDistributionSim, RoboRioSim

        battery = self.drivetrain.battery
        RoboRioSim.setVInVoltage(battery.voltage_V)
        for module in (0, 1):  # of CTRE, of REV
            panel = PowerDistributionSim(module)
            if panel.getInitialized():
                panel.setVoltage(battery.voltage_V)
                for channel, current in enumerate(battery.supply_current_A):
                    panel.setCurrent(channel, current)


def engine(scene: str | Path, devices: Devices | None = None) -> type[Engine]:
    """The PhysicsEngine of a physics.py for a scene, whose path counts from the folder of that file.

    `devices`: a function that takes the robot and returns lists of its objects by `drive`, `drive_encoder`,
    `steering`, `steering_encoder` and `gyro`; what it leaves out is that of `[frc]`.
    """
    beside = Path(sys._getframe(1).f_code.co_filename).parent / scene
    path = beside if beside.is_file() else Path(scene)

    class PhysicsEngine(Engine):
        pass

    PhysicsEngine.scene = path
    PhysicsEngine.devices = staticmethod(devices) if devices else None
    read_scene(path)  # so that a mistake in it is known before the robot starts
    return PhysicsEngine
