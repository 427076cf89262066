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

FRICTION_PER_WHEEL = ("slip_along_m_per_s", "slip_across_m_per_s", "contact_state", "drive_limit", "motor_current_A")
FRICTION_LENGTHS = dict.fromkeys(
    ("supply_current_A", "supply_voltage_V", "supply_energy_J", "outer_work_J", "slip_loss_J", "axle_loss_J",
     "motor_loss_J", "supply_loss_J", "numerical_loss_J"), 0)
"""Outputs of scenes with ground friction or a drive with limits alone."""

LOADS = ("normal_load_N", "support_load_N")
"""Normal loads: one for each wheel, one for each support."""

OF_SUPPLY = ("supply_current_A", "supply_voltage_V")
OF_MOTOR = ("motor_current_A",)
NEEDED = {**dict.fromkeys((*FRICTION_PER_WHEEL, *FRICTION_LENGTHS), "ground friction, a drive or a motor circuit"),
         **dict.fromkeys(OF_SUPPLY, "`vehicle.drive.supply_V`"),
         **dict.fromkeys(OF_MOTOR, "`[vehicle.motor]` and ground friction, a drive or a motor circuit"),
         LOADS[1]: "`[[vehicle.support]]`",
         **dict.fromkeys(OF_IMU, "`[sensors.imu]`"), **dict.fromkeys(OF_ENCODERS, "`[sensors.encoder]`")}
"""What some outputs need, in words."""


def output_signals(vehicle: dict[str, Any]) -> tuple[dict[str, int], tuple[str, ...]]:
    """What a vehicle shows: names with their lengths, and names with one item for each wheel; with those of sensors,
    which a scene need not have."""
    of_wheels, of_supports = LOADS
    lengths = OUTPUT_LENGTHS | {of_supports: len(vehicle["support"])} | OF_IMU
    if has_friction(vehicle):
        return lengths | FRICTION_LENGTHS, (*OUTPUTS_PER_WHEEL, of_wheels, *OF_ENCODERS, *FRICTION_PER_WHEEL)
    return lengths, (*OUTPUTS_PER_WHEEL, of_wheels, *OF_ENCODERS)


def missing_outputs(vehicle: dict[str, Any], sensors: SensorTables) -> Mapping[str, str]:
    """Outputs that this scene does not have, and what to do about it, by their names with and without an index."""
    count = len(vehicle["wheel"])
    every = {name: 0 for name in FRICTION_LENGTHS} | dict.fromkeys(FRICTION_PER_WHEEL, count)
    why = {name: text for name in every if (text := _lacks(vehicle, name))}
    indexed = {f"{name}[{i}]": text for name, text in why.items() for i in range(1, every[name] + 1)}
    if not vehicle["support"]:
        why[LOADS[1]] = "is of supports, of which the scene has none; give [[vehicle.support]]"
    return {**missing_sensors(sensors, count), **why, **indexed}


def _lacks(vehicle: dict[str, Any], name: str) -> str:
    """Why a vehicle does not show an output of friction and drives; empty where it does."""
    if name in OF_SUPPLY and not vehicle.get("drive", {}).get("supply_V"):
        return "is the supply's, whose voltage the scene does not give; give vehicle.drive.supply_V"
    if name in OF_MOTOR and "motor" not in vehicle:
        return "is a motor's, of which the scene tells no winding; give [vehicle.motor]"
    if not has_friction(vehicle):
        return ("is of slip and of drives with limits, and wheels roll on ideal ground; give "
                "ground.friction_coefficient or [vehicle.drive]")
    return ""


def signal_names(lengths: Mapping[str, int], per_wheel: Sequence[str], wheel_count: int) -> Iterator[str]:
    """Every signal with its index, from 1; a length of 0 is a signal without index."""
    for name, length in {**{name: wheel_count for name in per_wheel}, **lengths}.items():
        yield from (f"{name}[{i}]" for i in range(1, length + 1)) if length or name in per_wheel else (name,)
