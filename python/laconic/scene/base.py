"""What is between commands and motors: `[base]`, which `laconic ros2` plays, and `[frc]`, which laconic.frc plays.

What `[base]` does not give gets its value in laconic.ros2.base, where the vehicle's matrices are known.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

from laconic.scene.keys import key_of, read_number
from laconic.scene.table import Table

OF_VOLTAGE = ("gain_Vs_per_rad", "integral_gain_V_per_rad", "voltage_limit_V")
OF_STEERING = ("steering_rate_limit_rad_per_s", "steering_voltage_limit_V")
OF_TORQUE = ("gain_Nms_per_rad", "integral_gain_Nm_per_rad", "torque_limit_Nm")


@dataclass(frozen=True)
class BaseTable:
    """The values of `[base]`; None: not given."""

    gain_Vs_per_rad: float | None = None           # noqa: N815
    integral_gain_V_per_rad: float | None = None   # noqa: N815
    voltage_limit_V: float | None = None           # noqa: N815
    gain_Nms_per_rad: float | None = None          # noqa: N815
    integral_gain_Nm_per_rad: float | None = None  # noqa: N815
    torque_limit_Nm: float | None = None           # noqa: N815
    speed_limit_m_per_s: float | None = None
    yaw_rate_limit_rad_per_s: float | None = None
    acceleration_limit_m_per_s2: float | None = None
    yaw_acceleration_limit_rad_per_s2: float | None = None
    steering_rate_limit_rad_per_s: float | None = None
    steering_voltage_limit_V: float | None = None  # noqa: N815
    watchdog_s: float = 0.5
    believed_size: float = 1.0
    believed_radius_m: tuple[float, ...] = ()      # one for each wheel; empty: as they are
    joint_names: tuple[str, ...] = ()              # one for each wheel, and then for each hinge or none of them


def read_base(table: Table, vehicle: Mapping[str, Any]) -> BaseTable:
    """`[base]` of a vehicle."""
    wheels = len(vehicle["wheel"])
    if not wheels:
        table.fail("watchdog_s", "a base drives wheels, and the vehicle has none; take [base] out")
    _check_actuator(table, vehicle)
    for name in () if vehicle.get("body") else OF_STEERING:
        if table.peek(name) is not None:
            table.fail(name, "has no effect: no wheel of this vehicle is steered; take it out")
    lists = ("believed_radius_m", "joint_names")
    numbers = {each.name: read_number(table, each.name) for each in fields(BaseTable) if each.name not in lists}
    found = BaseTable(**numbers, believed_radius_m=_radii(table, wheels),
                      joint_names=_names(table, wheels, len(vehicle.get("body", ()))))
    table.done()
    return found


def usual_joints(count: int) -> list[str]:
    """Names of the wheels' joints where nobody gave others."""
    return [f"wheel_{number}_joint" for number in range(1, count + 1)]


def joint_names(base: BaseTable | None, wheel_count: int, hinges: Sequence[str]) -> list[str]:
    """Names of the joints in messages: of wheels, then of hinges. What `[base]` does not name has usual ones."""
    names = list(base.joint_names) if base and base.joint_names else usual_joints(wheel_count)
    return names if len(names) > wheel_count else [*names, *(f"{name}_hinge_joint" for name in hinges)]


def has_motor(vehicle: Mapping[str, Any]) -> bool:
    """Whether voltages move any wheel of a vehicle."""
    own = any(wheel.get("motor_gain_Nm_per_V") for wheel in vehicle["wheel"])
    return bool("motor" in vehicle or vehicle.get("motor_gain_Nm_per_V") or own)


def _check_actuator(table: Table, vehicle: Mapping[str, Any]) -> None:
    """Fails for gains of the actuator that this vehicle does not have."""
    wrong, right = (OF_TORQUE, OF_VOLTAGE) if has_motor(vehicle) else (OF_VOLTAGE, OF_TORQUE)
    for name, instead in zip(wrong, right, strict=True):
        if table.peek(name) is not None:
            why = "has a motor, which takes voltages" if wrong is OF_TORQUE else "has no motor, so torques drive it"
            table.fail(name, f"has no effect: the vehicle {why}; give {instead}")


def _radii(table: Table, wheels: int) -> tuple[float, ...]:
    if not table.has("believed_radius_m"):
        return ()
    given = table.value("believed_radius_m", ..., (int, float, list), "a number, or a list with one for each wheel")
    many = table.numbers("believed_radius_m", wheels) if isinstance(given, list) else (
        table.number("believed_radius_m"),) * wheels
    for value in many:
        key_of(table, "believed_radius_m").check(table, value)
    return many


def _names(table: Table, wheels: int, hinges: int) -> tuple[str, ...]:
    names = table.texts("joint_names", ())
    if names and (len(names) not in (wheels, wheels + hinges) or len(set(names)) != len(names) or not all(names)):
        both = f", or {wheels + hinges} with the hinges" if hinges else ""
        table.fail("joint_names", f"needs a name of its own for each of the {wheels} wheels; give {wheels} names{both}")
    return names


# ---- a robot of the FIRST Robotics Competition

PORTS = {"PWM": 19, "Encoder": 25, "AnalogInput": 7, "AnalogEncoder": 7, "AnalogGyro": 1, "ADXRS450": 4,
         "DutyCycleEncoder": 25}
"""Devices of WPILib by their numbers, and the largest number."""
OUTPUTS = ("PWM", "CANMotor", "SimDevice")
COUNTERS = ("Encoder", "DutyCycleEncoder", "AnalogEncoder", "AnalogInput", "CANEncoder", "CANDutyCycle", "SimDevice")
GYROS = ("ADXRS450", "AnalogGyro", "CANGyro", "SimDevice")
DEVICE = re.compile(r"(?P<reversed>-?)(?P<kind>\w+)(\[(?P<number>\d+)\]|:(?P<name>[^/]+?)(/(?P<value>[^/]+))?)")


@dataclass(frozen=True)
class Device:
    """A device of WPILib's simulation, as `[frc]` names it."""

    text: str      # as in the file
    kind: str      # PWM, Encoder, … by name or by number
    name: str      # PWM and the like: the number
    value: str     # of a SimDevice
    sign: float    # -1: it turns the other way


MOST_COUNTS = 1e6  # in a turn; WPILib counts in 32 bits


@dataclass(frozen=True)
class FrcTable:
    """The values of `[frc]`; without devices a list is empty."""

    battery_V: float = 12.0                              # noqa: N815
    battery_resistance_ohm: float = 0.02
    current_limit_A: float | None = None                 # noqa: N815
    steering_current_limit_A: float | None = None        # noqa: N815
    drive: tuple[Device, ...] = ()
    drive_encoder: tuple[Device, ...] = ()
    drive_counts: float = 2048.0
    steering: tuple[Device, ...] = ()
    steering_encoder: tuple[Device, ...] = ()
    steering_counts: float = 4096.0
    gyro: Device | None = None


def read_frc(table: Table, vehicle: Mapping[str, Any]) -> FrcTable:
    """`[frc]` of a vehicle."""
    wheels, hinges = len(vehicle["wheel"]), len(vehicle.get("body", ()))
    if not wheels:
        table.fail("drive", "the vehicle has no wheels to drive; take [frc] out")
    numbers = {name: read_number(table, name) for name in (
        "battery_V", "battery_resistance_ohm", "current_limit_A", "steering_current_limit_A", "drive_counts",
        "steering_counts")}
    for name, most, unit in (("battery_V", 1e3, "V"), ("battery_resistance_ohm", 1e3, "ohm"),
                             ("drive_counts", MOST_COUNTS, "counts"), ("steering_counts", MOST_COUNTS, "counts")):
        if numbers[name] > most:
            table.fail(name, f"is {numbers[name]:g}; give at most {most:g} {unit}")
    found = FrcTable(
        **numbers, drive=_devices(table, "drive", OUTPUTS, wheels, "wheels"),
        drive_encoder=_devices(table, "drive_encoder", COUNTERS, wheels, "wheels"),
        steering=_devices(table, "steering", OUTPUTS, hinges, "steered wheels"),
        steering_encoder=_devices(table, "steering_encoder", COUNTERS, hinges, "steered wheels"),
        gyro=_device(table, "gyro", table.text("gyro"), GYROS) if table.has("gyro") else None)
    table.done()
    for wheels_key, hinges_key in (("drive", "steering"), ("drive_encoder", "steering_encoder")):
        _check_apart(table, found, wheels_key, hinges_key)
    return found


def _check_apart(table: Table, found: FrcTable, of_wheels: str, of_hinges: str) -> None:
    """Fails for a device of a steering axis that a wheel has, too: it is on one shaft."""
    taken = {(each.kind, each.name, each.value): number for number, each in enumerate(getattr(found, of_wheels), 1)}
    for number, each in enumerate(getattr(found, of_hinges), 1):
        if (wheel := taken.get((each.kind, each.name, each.value))) is not None:
            table.fail(of_hinges, f'names "{each.text}" for steered wheel {number}, which {of_wheels} names for wheel '
                       f"{wheel}; a device is on one shaft: give the one that turns with the steering")


def _devices(table: Table, key: str, kinds: Sequence[str], count: int, of_what: str) -> tuple[Device, ...]:
    texts = table.texts(key, ())
    if texts and not count:
        table.fail(key, f"has no effect: this vehicle has no {of_what}; take it out")
    if texts and len(texts) != count:
        table.fail(key, f"names {len(texts)} devices for {count} {of_what}; give one for each, in their order")
    return tuple(_device(table, key, text, kinds) for text in texts)


def _device(table: Table, key: str, text: str, kinds: Sequence[str]) -> Device:
    match = DEVICE.fullmatch(text)
    example = f"{kinds[0]}[0]"
    if not match:
        table.fail(key, f'"{text}" is not the name of a device; give one such as "{example}", or "-{example}" for one '
                   "that turns the other way")
    kind, number = match["kind"], match["number"]
    if kind not in kinds:
        table.fail(key, f'"{text}" is not a device for this; give one of {", ".join(kinds)}, such as "{example}"')
    if (number is not None) != (kind in PORTS):
        form = f"{kind}[0]" if kind in PORTS else f"{kind}:NAME" + ("/VALUE" if kind == "SimDevice" else "")
        table.fail(key, f'"{text}": a {kind} is named as "{form}"; write it so')
    if kind in PORTS and int(number) > PORTS[kind]:
        table.fail(key, f'"{text}": a roboRIO has {kind} 0 to {PORTS[kind]}; give one of these numbers')
    if (match["value"] is not None) != (kind == "SimDevice"):
        table.fail(key, f'"{text}": a SimDevice needs the name of its value, and others have none; write '
                   '"SimDevice:NAME/VALUE"')
    return Device(text, kind, number or match["name"], match["value"] or "", -1.0 if match["reversed"] else 1.0)
