"""Tables of scene files for tests, as TOML text.

A scene of three omni wheels that moves at its start, without inputs and run.

Scenes with sensors, as TOML text, for the tests of several rooms.
"""

from __future__ import annotations

import json
from pathlib import Path

from laconic.scene import Scene, read_scene, rigid_scene_names
from laconic.scene.ground import has_friction


def ideal_scene_names() -> list[str]:
    """Names of the project's scenes on ideal ground, whose equation is (4.7)."""
    return [name for name in rigid_scene_names() if not has_friction(read_scene(name).vehicle)]


def table(head: str, **entries: object) -> str:
    """A table such as "[vehicle]"; values are numbers, texts, flags or lists."""
    return "".join([f"{head}\n", *(f"{key} = {json.dumps(value)}\n" for key, value in entries.items())])


def wheel(kind: str, x_m: float, y_m: float, **entries: object) -> str:
    """One `[[vehicle.wheel]]`."""
    return table("[[vehicle.wheel]]", kind=kind, x_m=x_m, y_m=y_m, **entries)


def constant(signal: str, value: float) -> str:
    """An `[[input]]` that holds one value."""
    return table("[[input]]", signal=signal, kind="steps", t_s=[0.0], value=[value])


MOVING_CARRIAGE = """
[vehicle]
mass_kg = 10.0
yaw_inertia_kgm2 = 0.3
com_x_m = 0.03
wheel_radius_m = 0.05
wheel_inertia_kgm2 = 0.002
motor_gain_Nm_per_V = 0.5
motor_damping_Nms = 0.05
wheel = [
    {kind = "omni", x_m = 0.2, y_m = 0.0, axle_deg = 0.0},
    {kind = "omni", x_m = -0.1, y_m = 0.17, axle_deg = 120.0},
    {kind = "omni", x_m = -0.1, y_m = -0.17, axle_deg = 240.0},
]
[initial]
nu_rad_per_s = [10.0, -5.0, 20.0]
"""


BODY = """name = "Sensed"
source = "a test"
[vehicle]
mass_kg = 20.0
yaw_inertia_kgm2 = 1.2
com_x_m = 0.04
com_y_m = 0.03
wheel_radius_m = 0.05
wheel_inertia_kgm2 = 0.004
motor_gain_Nm_per_V = 0.4
motor_damping_Nms = 0.05
"""
WHEELS = "".join(f'[[vehicle.wheel]]\nkind = "omni"\ndistance_m = 0.2\nbearing_deg = {b}\naxle_deg = {b}\n'
                 for b in (60, 180, 300))
SINES = "".join(f'[[input]]\nsignal = "voltage_V[{i}]"\nkind = "sine"\namplitude = {a}\nfrequency_Hz = {f}\n'
                for i, a, f in ((1, 6.0, 1.0), (2, -4.0, 1.7), (3, 5.0, 0.6)))
STEPS = '[[input]]\nsignal = "voltage_V[1]"\nkind = "steps"\nt_s = [0.0, 0.1]\nvalue = [6.0, -3.0]\n'
PLACE = "x_m = 0.15\ny_m = -0.1\nheading_deg = 30\n"
ERRORS = """acceleration_scale_error = [0.01, -0.02]
acceleration_bias_m_per_s2 = 0.05
acceleration_noise_m_per_s2_per_sqrt_Hz = 0.003
acceleration_range_m_per_s2 = 6.0
yaw_rate_scale_error = 0.002
yaw_rate_bias_rad_per_s = -0.01
yaw_rate_noise_rad_per_s_per_sqrt_Hz = 0.0002
yaw_rate_range_rad_per_s = 9.0
seed = 11
"""
IMU = f"[sensors.imu]\n{PLACE}{ERRORS}delay_s = 0.006\n"
ENCODERS = "[sensors.encoder]\ncounts_per_turn = [4096, false, 360]\ngear_ratio = [1.0, -12.5]\nwrap = 65536\n"
RUN = "[run]\nduration_s = 0.4\nstep_s = 0.002\n"


def sensed_scene(folder: Path, *tables: str, head: str = BODY + WHEELS, name: str = "sensed") -> Scene:
    """A vehicle with three omni wheels, or another one, with these tables after it."""
    path = folder / f"{name}.toml"
    path.write_text(head + "".join(tables), encoding="utf-8")
    return read_scene(path)
