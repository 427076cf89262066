"""How a scene file spells what the core calls by names of its own: tables, numbers of wheels, angles in degrees."""

from __future__ import annotations

import math
from collections.abc import Collection

from laconic.errors import Refused

VEHICLE = ("mass_kg", "yaw_inertia_kgm2", "com_x_m", "com_y_m", "com_z_m", "wheel_radius_m", "wheel_inertia_kgm2",
           "motor_gain_Nm_per_V", "motor_damping_Nms", "friction_coefficient")
PAYLOAD = ("mass_kg", "x_m", "y_m", "yaw_inertia_kgm2")
MOTOR = ("resistance_ohm", "torque_constant_Nm_per_A", "back_emf_Vs_per_rad", "gear_ratio", "viscous_friction_Nms",
         "rotor_inertia_kgm2")
IN_FILE = {
    **{name: f"vehicle.{name}" for name in VEHICLE},
    **{f"payload_{name}": f"vehicle.payload.{name}" for name in PAYLOAD},
    **{name: f"vehicle.motor.{name}" for name in MOTOR},
    "wheel_count": "vehicle.wheel", "support_count": "vehicle.support",
    "wheel_kind": "vehicle.wheel[#].kind", "wheel_x_m": "vehicle.wheel[#].x_m", "wheel_y_m": "vehicle.wheel[#].y_m",
    "axle_rad": "vehicle.wheel[#].axle_rad", "roller_rad": "vehicle.wheel[#].roller_rad",
    "wheel_locked": "vehicle.wheel[#].locked",
    "support_x_m": "vehicle.support[#].x_m", "support_y_m": "vehicle.support[#].y_m",
    "start_nu_rad_per_s": "initial.nu_rad_per_s[#]", "start_x_m": "initial.x_m", "start_y_m": "initial.y_m",
    "start_heading_rad": "initial.heading_rad",
    "method": "run.method", "step_s": "run.step_s",
}
"""The core's name → the file's, with # for the number of the wheel, support or component."""

DEGREES = {"pi/2": "90", "pi/4": "45"}


def spelled(key: str, in_degrees: Collection[str]) -> str:
    """The key as the file has it: some angles are given in degrees."""
    return f"{key.removesuffix('_rad')}_deg" if key in in_degrees else key


def in_file(refused: Refused, in_degrees: Collection[str]) -> Refused:
    """A refusal of the core by the name, and in the unit, that the file has."""
    key, _, text = refused.message.partition(": ")
    if known := IN_FILE.get(refused.field):
        key = known.replace("[#]", f"[{refused.item}]" if refused.item else "")
    if key in in_degrees:
        text = text.replace(f"{refused.value:.6g} rad", f"{math.degrees(refused.value):.6g} degrees")
        for radians, degrees in DEGREES.items():
            text = text.replace(radians, degrees)
    text = f"{spelled(key, in_degrees)}: {text}"
    return Refused(refused.status, refused.field, refused.item, text, value=refused.value, limit=refused.limit)
