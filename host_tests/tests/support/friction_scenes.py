"""Scenes with ground friction, drives with limits and slopes, made of those that come with the project."""

from __future__ import annotations

import re
from pathlib import Path

from laconic.base.paths import scene_path
from laconic.scene import Scene, read_scene

GROUND = "[ground]\nfriction_coefficient = 0.3\nroller_drag = 0.6\naxle_friction_Nm = 0.02\n"
SLOPE = "slope_deg = 4.0\nslope_heading_deg = 70.0\n"
DRIVE = "[vehicle.drive]\nsupply_V = 12.0\nsupply_resistance_ohm = 0.4\ncurrent_limit_A = 0.9\n"


def with_tables(name: str, tables: str, folder: Path, called: str = "") -> Scene:
    """A scene of the project with more tables; its friction_coefficient goes where the ground has its own."""
    text = scene_path(name).read_text(encoding="utf-8")
    if "[ground]" in tables:
        text = re.sub(r"(?m)^friction_coefficient.*$", "", text)
    at = text.index("[run]")
    path = folder / f"{called or name}_slips.toml"
    path.write_text(text[:at] + tables + text[at:], encoding="utf-8")
    return read_scene(path)


def slipping(folder: Path) -> Scene:
    """A robot on a slope whose motors reach their limits and whose wheels slip."""
    return with_tables("robotino2", GROUND + SLOPE + DRIVE, folder)


def four_mecanum_wheels(folder: Path) -> Scene:
    """A heavier one without limits of its motors, on level ground."""
    return with_tables("kuka_youbot", GROUND, folder)


def limited(folder: Path) -> Scene:
    """A drive with limits on ideal ground."""
    return with_tables("robotino2", DRIVE, folder, "drive")


def skid_steering(folder: Path) -> Scene:
    """Four fixed wheels, which on ideal ground cannot yaw."""
    wheels = "".join(f'[[vehicle.wheel]]\nkind = "fixed"\nx_m = {x}\ny_m = {y}\naxle_deg = -90\n'
                     for x in (0.2, -0.2) for y in (0.25, -0.25))
    inputs = "".join(f'[[input]]\nsignal = "voltage_V[{i}]"\nkind = "sine"\namplitude = {4 * (-1) ** i}.0\n'
                     f'frequency_Hz = 0.7\nphase_deg = {20 * i}\n' for i in (1, 2, 3, 4))
    path = folder / "skid_steering.toml"
    path.write_text(f"[vehicle]\nmass_kg = 20.0\nyaw_inertia_kgm2 = 1.2\ncom_z_m = 0.1\nwheel_radius_m = 0.1\n"
                    f"wheel_inertia_kgm2 = 0.01\nmotor_gain_Nm_per_V = 1.0\nmotor_damping_Nms = 0.8\n{wheels}"
                    f"[ground]\nfriction_coefficient = 0.5\n{inputs}[run]\nduration_s = 2.0\nstep_s = 0.002\n",
                    encoding="utf-8")
    return read_scene(path)


SCENES = (slipping, four_mecanum_wheels, limited, skid_steering)
