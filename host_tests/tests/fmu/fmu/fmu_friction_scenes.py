"""Scenes of vehicles with ground friction, limits of a drive or a slope, for the tests of their FMUs."""

from __future__ import annotations

from pathlib import Path

from laconic.scene import Scene, read_scene

MOTOR = """[vehicle.motor]
resistance_ohm = 0.5
torque_constant_Nm_per_A = 0.05
back_emf_Vs_per_rad = 0.05
gear_ratio = 20.0
viscous_friction_Nms = 1e-5
rotor_inertia_kgm2 = 1e-6
"""
DRIVE = "[vehicle.drive]\nsupply_V = 12.0\nsupply_resistance_ohm = 0.1\ncurrent_limit_A = 5.0\n"
GROUND = "[ground]\nfriction_coefficient = 0.6\naxle_friction_Nm = 0.05\n"
DRAG = "roller_drag = 0.1\n"
SLOPE = "slope_rad = 0.1\nslope_heading_rad = 0.4\n"
FIXED = "".join(f'[[vehicle.wheel]]\nkind = "fixed"\nx_m = {x}\ny_m = {y}\naxle_deg = -90.0\n'
                for x in (0.2, -0.2) for y in (0.2, -0.2))
OMNI = "".join(f'[[vehicle.wheel]]\nkind = "omni"\ndistance_m = 0.2\nbearing_deg = {b}\naxle_deg = {b}\n'
               for b in (60.0, 180.0, 300.0))

PARTS = {
    "skid_steering": FIXED + MOTOR + DRIVE + GROUND + SLOPE,
    "omni_on_friction": OMNI + MOTOR + GROUND + DRAG,
    "omni_with_limits": OMNI + MOTOR + DRIVE,
    "omni_on_a_slope": OMNI + MOTOR + "[ground]\n" + SLOPE,
}
"""By name: ground with friction and a drive with limits on a slope; friction alone; limits on ideal ground; a slope."""


def friction_scene(name: str, folder: Path, com_z_m: float = 0.1, last: str = "") -> Scene:
    """One of the scenes above; `last`: its last tables."""
    path = folder / f"{name}.toml"
    path.write_text(f'name = "{name}"\nsource = "a test"\n[vehicle]\nmass_kg = 20.0\nyaw_inertia_kgm2 = 0.8\n'
                    f"com_x_m = 0.03\ncom_z_m = {com_z_m}\nwheel_radius_m = 0.08\nwheel_inertia_kgm2 = 0.004\n"
                    f"{PARTS[name]}[run]\nduration_s = 2.0\nstep_s = 0.002\n{last}")
    return read_scene(path)
