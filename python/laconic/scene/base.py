"""`[base]`: what a mobile base has between velocity commands and its motors; `laconic ros2` plays it.

What is not given gets its value in laconic.ros2.base, where the vehicle's matrices are known.
"""

from __future__ import annotations

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
