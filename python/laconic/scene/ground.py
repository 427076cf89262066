"""The keys of a scene about ground with friction, slopes, and drives with limits; the core checks their values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from laconic.core import load
from laconic.core.fields import OF_GROUND
from laconic.errors import BadInput
from laconic.scene.hinges import check_without_hinges
from laconic.scene.keys import MOTOR_CIRCUITS, key_of, read_choice
from laconic.scene.table import Table, read_field

if TYPE_CHECKING:
    from laconic.scene.scene import Scene

OF_MOTOR = ("winding_resistance_ohm", "viscous_friction_Nms")  # of a drive, that laconic_motor_fit() fills


def has_friction(vehicle: dict[str, Any]) -> bool:
    """Whether the core steps the vehicle by its friction step (laconic_vehicle_has_friction)."""
    circuits = any(wheel.get("motor_circuit") for wheel in vehicle["wheel"])
    return bool(vehicle["wheel"]) and (slips(vehicle) or circuits or "drive" in vehicle)


def slips(vehicle: Mapping[str, Any]) -> bool:
    """Whether a wheel can slip."""
    return "friction_coefficient" in vehicle.get("ground", {})


def check_ideal_ground(scene: Scene, command: str, instead: str = "") -> None:
    """BadInput where a command that treats (4.7) gets a vehicle with friction or limits of its drives."""
    check_without_hinges(scene, f"laconic {command}")
    check_rolling(scene, command, instead)


def check_rolling(scene: Scene, command: str, instead: str = "") -> None:
    """BadInput for friction or limits of drives, with hinges or without."""
    if has_friction(scene.vehicle):
        raise BadInput(f"{scene.path}: laconic {command} treats ideal ground and motors without limits; give a scene "
                       f"without friction in [ground], without [vehicle.drive] and motor_circuit{instead}")


def on_ideal_ground(scene: Scene) -> Scene:
    """The scene without ground friction, slope and limits of its drives."""
    vehicle = {key: value for key, value in scene.vehicle.items() if key not in ("ground", "drive")}
    of_friction = (*OF_GROUND, "motor_circuit")
    wheels = [{key: value for key, value in wheel.items() if key not in of_friction} for wheel in vehicle["wheel"]]
    return replace(scene, vehicle=vehicle | {"wheel": wheels})


def read_ground(table: Table) -> dict[str, float]:
    """`[ground]`: friction, or a slope, or both."""
    ground = {field.key: read_field(table, field) for field in load().fields_of("ground") if has(table, field.key)}
    if "friction_coefficient" in ground:
        key_of(table, "friction_coefficient").check(table, ground["friction_coefficient"])
    for key in OF_GROUND[1:]:
        if key in ground and "friction_coefficient" not in ground:
            table.fail(key, "has no effect on ideal ground; give friction_coefficient, too")
    if "slope_heading_rad" in ground and "slope_rad" not in ground:
        key = spelled(table, "slope_heading_rad")
        table.fail(key, f"has no effect on level ground; give {key.replace('_heading', '')}, too")
    table.done()
    return ground


def has(table: Table, key: str) -> bool:
    """Whether a key is given, an angle also in degrees."""
    return table.has(key) or table.has(spelled(table, key))


def spelled(table: Table, key: str) -> str:
    """The key as the file has it: an angle that is given in degrees by that name."""
    in_degrees = f"{key.removesuffix('_rad')}_deg"
    return in_degrees if key.endswith("_rad") and table.has(in_degrees) else key


def read_drive(vehicle: Table) -> dict[str, float]:
    """`[vehicle.drive]`: limits of the motors in `[vehicle.motor]`."""
    table = vehicle.table("drive")
    fields = [field for field in load().fields_of("vehicle.drive") if field.key not in OF_MOTOR]
    drive = {field.key: read_field(table, field) for field in fields if table.has(field.key)}
    table.done()
    if not drive:
        vehicle.fail("drive", "is empty; give supply_V or current_limit_A, or take it out")
    if not vehicle.has("motor"):
        vehicle.fail("drive", "limits the currents of motors, which need [vehicle.motor]; give it instead of "
                     "motor_gain_Nm_per_V, or take [vehicle.drive] out")
    for key in filter(drive.__contains__, ("supply_V", "current_limit_A")):
        key_of(table, key).check(table, drive[key])
    if "supply_resistance_ohm" in drive and "supply_V" not in drive:
        table.fail("supply_resistance_ohm", "has no effect without supply_V; give it, too")
    return drive


def read_circuit(wheel: Table) -> int:
    """What the wheel's motor is connected to."""
    return list(MOTOR_CIRCUITS).index(read_choice(wheel, "motor_circuit"))


def check_friction(top: Table, vehicle: dict[str, Any]) -> None:
    """Fails for keys that contradict each other or have no effect."""
    if "friction_coefficient" in vehicle.get("ground", {}) and top.table("vehicle").has("friction_coefficient"):
        top.fail("vehicle.friction_coefficient", "is given besides ground.friction_coefficient, by which wheels slip; "
                 "keep one of them")
    if top.table("initial").has("wheel_speed_rad_per_s") and not slips(vehicle):
        top.fail("initial.wheel_speed_rad_per_s", "has no effect on ideal ground, where wheels roll; give "
                 "ground.friction_coefficient, too")
