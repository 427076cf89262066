"""The vehicle that is played: its drives replace its motors, of which gear, rotor and viscous friction are left."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from laconic.errors import BadInput
from laconic.scene import Scene

OWN_MOTOR = ("motor_gain_Nm_per_V", "motor_damping_Nms")


def played(scene: Scene) -> Scene:
    """The scene without voltages: no motor gain, and of the motor damping only viscous friction of [vehicle.motor]."""
    vehicle: dict[str, Any] = {key: value for key, value in scene.vehicle.items() if key != "drive"}
    vehicle["wheel"] = [{key: value for key, value in wheel.items() if key not in (*OWN_MOTOR, "motor_circuit")}
                        for wheel in vehicle["wheel"]]
    if "motor" in vehicle:
        vehicle["motor"] = vehicle["motor"] | {"torque_constant_Nm_per_A": 0.0, "back_emf_Vs_per_rad": 0.0}
    else:
        vehicle |= dict.fromkeys(OWN_MOTOR, 0.0)
    return replace(scene, vehicle=vehicle, inputs=())


def moved_inertia(scene: Scene, driven: Sequence[bool]) -> tuple[float, ...]:
    """The inertia about each wheel's axle that its drive turns [kg·m²]: the wheel's own, rotor included, and a share of
    the vehicle's mass, which all drives move together."""
    vehicle = scene.c_vehicle(scene.core())
    mass_kg = float(vehicle.mass_kg) + float(vehicle.payload.mass_kg)
    found = []
    for wheel, has_drive in zip(vehicle.wheel, driven, strict=False):
        radius_m = float(wheel.own_radius_m or vehicle.wheel_radius_m)
        own_kgm2 = float(wheel.own_inertia_kgm2 or vehicle.wheel_inertia_kgm2)
        found.append(own_kgm2 + mass_kg * radius_m**2 / sum(driven) if has_drive else 0.0)
    return tuple(found)


def check_playable(scene: Scene) -> None:
    """BadInput for a vehicle that no drive can move."""
    if not scene.vehicle["wheel"]:
        raise BadInput(f"{scene.path}: vehicle.wheel: there is none; a vehicle that is played needs a wheel")
