"""The vehicle that is played: its drives replace its motors, of which gear, rotor and viscous friction are left."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from laconic.core.articulated import ArticulatedVehicle
from laconic.errors import BadInput
from laconic.scene import Scene
from laconic.scene.hinge_friction import OF_LOOPS, OF_SERVOS, PERIOD
from laconic.scene.hinges import Hinge
from laconic.scene.sensors import NO_SENSORS

BRAKES = ("axle_friction_Nm", "roller_drag", "viscous_friction_Nms")  # friction that acts on a wheel that rolls
OWN_MOTOR = ("motor_gain_Nm_per_V", "motor_damping_Nms")
OF_MOTORS = (*OF_SERVOS, *OF_LOOPS, PERIOD, "winding_resistance_ohm", "current_limit_A", "viscous_friction_Nms")
"""What of a hinge its drive replaces where wheels slip."""


def played(scene: Scene, driven: Sequence[bool] | None = None) -> Scene:
    """The scene without voltages: no motor gain, and of the motor damping only viscous friction of [vehicle.motor].

    `driven`: which wheels, then which hinges, have a drive; not given: all that could have one. On ground with friction
    a drive replaces a hinge's servo or loop; one without a drive keeps it and holds its start angle.
    """
    vehicle: dict[str, Any] = {key: value for key, value in scene.vehicle.items() if key != "drive"}
    vehicle["wheel"] = [{key: value for key, value in wheel.items() if key not in (*OWN_MOTOR, "motor_circuit")}
                        for wheel in vehicle["wheel"]]
    if "motor" in vehicle:
        vehicle["motor"] = vehicle["motor"] | {"torque_constant_Nm_per_A": 0.0, "back_emf_Vs_per_rad": 0.0}
    else:
        vehicle |= dict.fromkeys(OWN_MOTOR, 0.0)
    hinges = scene.hinges
    if scene.has_hinges:
        turned = [True] * len(hinges) if driven is None else driven[scene.wheel_count:]
        axes = [_axis(body, hinge, has_drive, scene.slips_on_hinges)
                for body, hinge, has_drive in zip(vehicle["body"], hinges, turned, strict=True)]
        vehicle["body"], hinges = [body for body, _ in axes], tuple(hinge for _, hinge in axes)
    return replace(scene, vehicle=vehicle, inputs=(), hinges=hinges)


def _axis(body: dict[str, Any], hinge: Hinge, has_drive: bool, slips: bool) -> tuple[dict[str, Any], Hinge]:
    """A hinge behind drives. The drive of a steering axis is its motor, and where wheels slip its servo or loop."""
    if hinge.kind == "motor" and not (hinge.follows and not has_drive):
        body = {key: value for key, value in body.items() if key not in OF_MOTORS}
        return body | _without_motor(dict(hinge.motor), slips), replace(hinge, follows="")
    if not slips or hinge.kind not in ("servo", "coordinated"):
        return body, hinge
    if not hinge.follows:  # a coordinated hinge whose rate a command gave
        return body, replace(hinge, kind="prescribed")
    if not has_drive:
        return body, replace(hinge, kind="servo")
    own = {key: value for key, value in body.items() if key not in OF_MOTORS}
    return own | {"hinge": "motor", "gain_Nm_per_V": 0.0}, replace(hinge, kind="motor", follows="")


def _without_motor(motor: dict[str, float], slips: bool) -> dict[str, float]:
    """What is left of a hinge's motor: the viscous friction of one that is given at its shaft."""
    friction = motor.get("gear_ratio", 0.0) ** 2 * motor.get("viscous_friction_Nms", 0.0)
    more = {"viscous_friction_Nms": friction} if slips else {}
    return {"gain_Nm_per_V": 0.0, "damping_Nms": friction, **more}


def without_sensors(scene: Scene) -> Scene:
    """The scene without IMU and encoders, for which protocols of drives have no frames."""
    return replace(scene, sensors=NO_SENSORS)


def silent_sensors(scene: Scene) -> str | None:
    """A line on sensors of the scene that nobody hears behind drives; None: there are none."""
    names = [name for name in ("imu", "encoder") if getattr(scene.sensors, name) is not None]
    if not names:
        return None
    return (f"sensors.{' and sensors.'.join(names)}: not played, since drives send what their own encoders show and "
            "have no frames for others; --dbc and --map send them")


def coasts_for_ever(scene: Scene) -> bool:
    """Whether nothing brakes the vehicle once its drives are off."""
    tables = (scene.vehicle.get("ground", {}), scene.vehicle.get("motor", {}), *scene.vehicle["wheel"])
    return not any(table.get(key) for table in tables for key in BRAKES)


def moved_inertia(scene: Scene, driven: Sequence[bool], radius_m: Sequence[float] | None = None) -> tuple[float, ...]:
    """The inertia about each wheel's axle that its drive turns [kg·m²]: the wheel's own, rotor included, and a share of
    the vehicle's mass, which all drives move together. Behind the wheels that of each hinge about its axis: its body's.
    `radius_m`: what the wheels' radii are taken for, instead of the scene's.
    """
    core, bodies = scene.core(), scene.vehicle["body"] if scene.has_hinges else ()
    whole = hinged_vehicle(scene) if scene.has_hinges else None  # owns the memory of its base
    vehicle = whole.c.base if whole else scene.c_vehicle(core)
    mass_kg = float(vehicle.mass_kg) + float(vehicle.payload.mass_kg) + sum(body["mass_kg"] for body in bodies)
    found, count = [], scene.wheel_count
    for at, (wheel, has_drive) in enumerate(zip(vehicle.wheel, driven[:count], strict=False)):
        radius = float(wheel.own_radius_m or vehicle.wheel_radius_m) if radius_m is None else float(radius_m[at])
        own_kgm2 = float(wheel.own_inertia_kgm2 or vehicle.wheel_inertia_kgm2)
        found.append(own_kgm2 + mass_kg * radius**2 / sum(driven[:count]) if has_drive else 0.0)
    found += [about_hinge(body) if has_drive else 0.0 for body, has_drive in zip(bodies, driven[count:], strict=True)]
    return tuple(found)


def hinged_vehicle(scene: Scene) -> ArticulatedVehicle:
    """The vehicle of a scene with hinges, on ideal ground or on one with friction."""
    core = scene.core()
    return scene.slipping_vehicle(core) if scene.slips_on_hinges else scene.articulated_vehicle(core)


def about_hinge(body: Mapping[str, Any]) -> float:
    """The inertia of a body about its hinge [kg·m²]."""
    arm_m = math.hypot(body.get("com_x_m", 0.0), body.get("com_y_m", 0.0))
    return float(body["yaw_inertia_kgm2"] + body["mass_kg"] * arm_m**2)


def check_playable(scene: Scene) -> None:
    """BadInput for a vehicle that no drive can move."""
    if not scene.vehicle["wheel"]:
        raise BadInput(f"{scene.path}: vehicle.wheel: there is none; a vehicle that is played needs a wheel")
    coordinated = [hinge for hinge in scene.hinges if hinge.kind == "coordinated"]
    if coordinated and not scene.slips_on_hinges:
        raise BadInput(f"{scene.path}: {coordinated[0].place}.steered: drives turn each steering axis by itself, and "
                       "coordinated ones turn together; give ground.friction_coefficient, which lets wheels slip, or "
                       "give one axis \"prescribed\" or \"motor\"")
