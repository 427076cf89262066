"""Inputs and outputs by name: how many numbers each has, and what a scene must give so that an output is known."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from laconic.core.inputs import PER_WHEEL as PER_WHEEL
from laconic.scene.ground import has_friction
from laconic.scene.sensors import OF_ENCODERS, OF_IMU, SensorTables, missing_sensors

LENGTHS = {"body_force_N": 2, "body_moment_Nm": 0, "world_force_N": 2, "world_force_point_m": 2}
"""Inputs besides those PER_WHEEL: how many numbers, 0 for one without an index."""

OUTPUTS_PER_WHEEL = ("wheel_speed_rad_per_s", "wheel_angle_rad", "wheel_torque_Nm", "wheel_reaction_N",
                     "wheel_lateral_N")
OUTPUT_LENGTHS = {
    "nu_rad_per_s": 3, "velocity_body_m_per_s": 2, "x_m": 0, "y_m": 0, "heading_rad": 0, "heading_wrapped_rad": 0,
    "origin_x_m": 0, "origin_y_m": 0, "yaw_rate_rad_per_s": 0, "acceleration_body_m_per_s2": 2, "no_slip_margin_N": 0,
    "energy_J": 0}

WHEEL_LOAD, SUPPORT_LOAD = "wheel_load_N", "support_load_N"
"""Outputs of vehicles whose loads on the ground are known, of each wheel and of each support."""

FRICTION_PER_WHEEL = ("slip_along_m_per_s", "slip_across_m_per_s", "contact_state", "drive_limit", "motor_current_A")
FRICTION_LENGTHS = dict.fromkeys(
    ("supply_current_A", "supply_voltage_V", "supply_energy_J", "outer_work_J", "slip_loss_J", "axle_loss_J",
     "motor_loss_J", "supply_loss_J", "numerical_loss_J"), 0)
"""Outputs of scenes with ground friction or a drive with limits alone."""

OF_SUPPLY = ("supply_current_A", "supply_voltage_V")
OF_MOTOR = ("motor_current_A",)
NEEDED = {WHEEL_LOAD: "`vehicle.com_z_m`, `vehicle.friction_coefficient` or ground friction",
          SUPPORT_LOAD: "`[[vehicle.support]]`, and as `wheel_load_N`",
          **dict.fromkeys((*FRICTION_PER_WHEEL, *FRICTION_LENGTHS), "ground friction, a drive or a motor circuit"),
         **dict.fromkeys(OF_SUPPLY, "`vehicle.drive.supply_V`"),
         **dict.fromkeys(OF_MOTOR, "`[vehicle.motor]` and ground friction, a drive or a motor circuit"),
         **dict.fromkeys(OF_IMU, "`[sensors.imu]`"), **dict.fromkeys(OF_ENCODERS, "`[sensors.encoder]`")}
"""What some outputs need, in words."""


def output_signals(vehicle: dict[str, Any]) -> tuple[dict[str, int], tuple[str, ...]]:
    """What a vehicle shows: names with their lengths, and names with one item for each wheel; with those of sensors,
    which a scene need not have."""
    lengths: dict[str, int] = OUTPUT_LENGTHS | OF_IMU
    per_wheel: tuple[str, ...] = (*OUTPUTS_PER_WHEEL, *OF_ENCODERS)
    if vehicle["wheel"]:
        per_wheel += (WHEEL_LOAD,)
    if vehicle["wheel"] and vehicle.get("support"):
        lengths |= {SUPPORT_LOAD: len(vehicle["support"])}
    if has_friction(vehicle):
        return lengths | FRICTION_LENGTHS, (*per_wheel, *FRICTION_PER_WHEEL)
    return lengths, per_wheel


def has_loads(vehicle: dict[str, Any]) -> bool:
    """Whether the loads of wheels and supports are more than a guess: the scene tells how high the centre of mass is,
    or of friction, which is judged by the loads."""
    return bool(vehicle["com_z_m"] or vehicle["friction_coefficient"] or has_friction(vehicle))


def missing_outputs(vehicle: dict[str, Any], sensors: SensorTables) -> Mapping[str, str]:
    """Outputs that this scene does not have, and what to do about it, by their names with and without an index."""
    count = len(vehicle["wheel"])
    every = {name: 0 for name in FRICTION_LENGTHS} | dict.fromkeys((*FRICTION_PER_WHEEL, WHEEL_LOAD), count)
    every[SUPPORT_LOAD] = len(vehicle.get("support", ()))
    why = {name: text for name in every if (text := _lacks(vehicle, name))}
    indexed = {f"{name}[{i}]": text for name, text in why.items() for i in range(1, every[name] + 1)}
    return {**missing_sensors(sensors, count), **why, **indexed}


def _lacks(vehicle: dict[str, Any], name: str) -> str:
    """Why a vehicle does not show an output of loads, friction and drives; empty where it does."""
    if name in (WHEEL_LOAD, SUPPORT_LOAD):
        return _lacks_loads(vehicle, name)
    if name in OF_SUPPLY and not vehicle.get("drive", {}).get("supply_V"):
        return "is the supply's, whose voltage the scene does not give; give vehicle.drive.supply_V"
    if name in OF_MOTOR and "motor" not in vehicle:
        return "is a motor's, of which the scene tells no winding; give [vehicle.motor]"
    if not has_friction(vehicle):
        return ("is of slip and of drives with limits, and wheels roll on ideal ground; give "
                "ground.friction_coefficient or [vehicle.drive]")
    return ""


def _lacks_loads(vehicle: dict[str, Any], name: str) -> str:
    if not vehicle["wheel"]:
        return "is of a vehicle on wheels, and the scene has none; give [[vehicle.wheel]]"
    if name == SUPPORT_LOAD and not vehicle.get("support"):
        return "is a support's, and the scene has none; give [[vehicle.support]]"
    if not has_loads(vehicle):
        return ("depends on the height of the centre of mass, which the scene does not give; give vehicle.com_z_m, or "
                "a friction_coefficient")
    return ""


def signal_names(lengths: Mapping[str, int], per_wheel: Sequence[str], wheel_count: int) -> Iterator[str]:
    """Every signal with its index, from 1; a length of 0 is a signal without index."""
    for name, length in {**{name: wheel_count for name in per_wheel}, **lengths}.items():
        yield from (f"{name}[{i}]" for i in range(1, length + 1)) if length or name in per_wheel else (name,)
