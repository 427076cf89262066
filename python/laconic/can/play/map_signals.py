"""What a map can join a DBC's signals to: inputs and outputs of the model by name, counted from 1."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from laconic.errors import nearest_of, shown
from laconic.scene.signals import LENGTHS, PER_WHEEL, signal_names

if TYPE_CHECKING:
    from laconic.can.play.map_plant import MapPlant

ENABLE = "drive_enable"
TARGETS = ("drive_speed_rad_per_s", "drive_current_A", "drive_position_rad")  # at the motor's shaft
OF_DRIVES = (*TARGETS, ENABLE)
OF_ANGLE = re.compile(r"(drive_position_rad|wheel_angle_rad|drive_angle_rad)\[")  # may be given in counts

Reader = Callable[["MapPlant", int], float]
"""The value of an output now; the index counts from 0."""


def _pose(name: str) -> Reader:
    return lambda plant, _: float(getattr(plant.pose(), name))


WHEEL_OUTPUTS: Mapping[str, Reader] = {
    "wheel_speed_rad_per_s": lambda plant, i: float(plant.wheel_speeds()[i]),
    "wheel_angle_rad": lambda plant, i: float(plant.wheel_angles()[i]),
    "wheel_torque_Nm": lambda plant, i: float(plant.wheel_torques()[i]),
    "encoder_count": lambda plant, i: float(plant.sensed().encoder_count[i])}
DRIVE_OUTPUTS: Mapping[str, Reader] = {
    "drive_count": lambda plant, i: float(plant.drive(i).count),
    "drive_angle_rad": lambda plant, i: plant.drive_angle_rad(i),
    "drive_speed_rad_per_s": lambda plant, i: float(plant.drive(i).speed_rad_per_s),
    "drive_current_A": lambda plant, i: float(plant.drive(i).current_A),
    "drive_torque_Nm": lambda plant, i: float(plant.drive(i).torque_Nm),
    "drive_enabled": lambda plant, i: float(plant.drive(i).mode != 0 and not plant.drive(i).faults),
    "drive_faults": lambda plant, i: float(plant.drive(i).faults)}
BODY_OUTPUTS: Mapping[str, tuple[int, Reader]] = {
    **{name: (0, _pose(name)) for name in ("x_m", "y_m", "heading_rad", "heading_wrapped_rad", "origin_x_m",
                                           "origin_y_m")},
    "nu_rad_per_s": (3, lambda plant, i: float(plant.plant.nu[i])),
    "velocity_body_m_per_s": (2, lambda plant, i: float(plant.plant.body_velocity()[0][i])),
    "yaw_rate_rad_per_s": (0, lambda plant, _: float(plant.plant.body_velocity()[1])),
    "acceleration_body_m_per_s2": (2, lambda plant, i: float(plant.sensed().acceleration_body_m_per_s2[i])),
    "imu_acceleration_m_per_s2": (2, lambda plant, i: float(plant.sensed().imu_acceleration_m_per_s2[i])),
    "imu_yaw_rate_rad_per_s": (0, lambda plant, _: plant.sensed().imu_yaw_rate_rad_per_s),
    "energy_J": (0, lambda plant, _: plant.plant.energy_J()),
    "time_s": (0, lambda plant, _: plant.plant.steps * plant.plant.step_s)}


def inputs_of(wheel_count: int) -> list[str]:
    """Every input of a vehicle with so many wheels; `drive_enable` without an index is of all its drives."""
    return [*signal_names(LENGTHS, (*PER_WHEEL, *OF_DRIVES), wheel_count), ENABLE]


def outputs_of(wheel_count: int) -> list[str]:
    """Every output."""
    lengths = {name: length for name, (length, _) in BODY_OUTPUTS.items()}
    return list(signal_names(lengths, (*WHEEL_OUTPUTS, *DRIVE_OUTPUTS), wheel_count))


def why_unknown(name: str, known: list[str], what: str, wheel_count: int) -> str | None:
    """The message for a name that the model does not have; None where it has it."""
    if name in known:
        return None
    stem = name.partition("[")[0]
    numbered = [each for each in known if each.partition("[")[0] == stem]
    if len(numbered) > 1 or (numbered and "[" in numbered[0]):
        count = "" if not re.search(r"wheel|drive|encoder|voltage|axle", stem) else f" (the vehicle has {wheel_count})"
        return f"there is no {what} {shown(name)}{count}; give {numbered[0]} to {[n for n in numbered if '[' in n][-1]}"
    return f"the model has no {what} {shown(name)}; {nearest_of(name, known)}"


def split(name: str) -> tuple[str, int]:
    """("wheel_speed_rad_per_s", 0) from "wheel_speed_rad_per_s[1]"; the index is 0 where there is none."""
    stem, bracket, index = name.partition("[")
    return stem, int(index.removesuffix("]")) - 1 if bracket else 0


def needs_drives(name: str) -> bool:
    """Whether an input or output is of a drive."""
    return split(name)[0] in (*OF_DRIVES, *DRIVE_OUTPUTS)


def reader_of(name: str) -> Callable[[MapPlant], float]:
    """A function that reads an output."""
    stem, index = split(name)
    found: Any = WHEEL_OUTPUTS.get(stem) or DRIVE_OUTPUTS.get(stem) or BODY_OUTPUTS[stem][1]
    return lambda plant: found(plant, index)
