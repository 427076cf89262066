"""Random vehicles on ground with friction, and the problem of one step straight from the vehicle's lengths and angles.

A vehicle is a mapping with the keys of a scene's `[vehicle]` (wheel places in the body frame, whose origin is S here).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from references.friction.problem import StepProblem

GRAVITY = 9.80665
ROLLER_RAD = {"omni": (math.pi / 2,), "mecanum": (math.pi / 4, -math.pi / 4), "fixed": (math.pi / 2,)}


def random_vehicle(random: np.random.Generator, wheels: int | None = None) -> dict[str, Any]:
    """A vehicle of 1 to 4 wheels mostly, one in ten of up to 16; sizes, grips and frictions over decades."""
    count = wheels or int(random.integers(1, 5) if random.random() < 0.9 else random.integers(5, 17))
    radius, mass = 10.0 ** random.uniform(-2, 0), 10.0 ** random.uniform(-1, 3)
    reach = radius * 10.0 ** random.uniform(0, 1)
    unit = mass * radius**2
    same = str(random.choice(["omni", "mecanum", "fixed", "any"]))
    vehicle: dict[str, Any] = {
        "mass_kg": mass, "yaw_inertia_kgm2": mass * reach**2 * 10.0 ** random.uniform(-1, 0.5),
        "wheel_radius_m": radius, "wheel_inertia_kgm2": unit * 10.0 ** random.uniform(-3, 0.5),
        "motor_gain_Nm_per_V": unit * 10.0 ** random.uniform(-1, 1),
        "motor_damping_Nms": unit * float(random.choice([0.0, 10.0 ** random.uniform(-2, 3)])),
        "wheel": [_wheel(random, i, count, reach, same) for i in range(count)],
        "ground": {"friction_coefficient": 10.0 ** random.uniform(-2, 0.5), "roller_drag": _drag(random),
                   "axle_friction_Nm": unit * float(random.choice([0.0, 10.0 ** random.uniform(-2, 2)]))},
    }
    if random.random() < 0.4:
        vehicle["drive"] = {"supply_V": 10.0 ** random.uniform(0, 2), "winding_resistance_ohm": 1.0,
                            "current_limit_A": float(10.0 ** random.uniform(-1, 2)),
                            "viscous_friction_Nms": 0.1 * vehicle["motor_damping_Nms"]}
    return vehicle


def _wheel(random: np.random.Generator, i: int, count: int, reach: float, same: str) -> dict[str, Any]:
    kind = str(random.choice(["omni", "mecanum", "fixed"])) if same == "any" else same
    around = 2 * math.pi * i / count
    tidy = random.random() < 0.6        # real vehicles are symmetric, which is the hard case
    place = around if tidy else random.uniform(-math.pi, math.pi)
    far = reach if tidy else reach * random.uniform(0.1, 1.5)
    axle = {"omni": place, "mecanum": -math.pi / 2, "fixed": -math.pi / 2}[kind]
    if not tidy:
        axle = random.uniform(-math.pi, math.pi)
    rollers = ROLLER_RAD[kind]
    wheel = {"kind": kind, "x_m": far * math.cos(place), "y_m": far * math.sin(place), "axle_rad": axle}
    return wheel if kind == "fixed" else wheel | {"roller_rad": rollers[i % len(rollers)]}


def _drag(random: np.random.Generator) -> float:
    return float(random.choice([0.0, 1.0, 0.87, random.random(), 10.0 ** random.uniform(-6, -1)],
                               p=[0.25, 0.15, 0.2, 0.2, 0.2]))


def geometry(vehicle: Mapping[str, Any]) -> dict[str, np.ndarray]:
    """Rows of the contact points' velocity over R, along and across the roller axis, and what the rims take off.

    v_P/R = (ν1, ν2) + ν3/(R Λ) e_z × r, less s R_i/R e_t with e_t = e_z × axle; R Λ = √(I_S/M).
    """
    wheels = vehicle["wheel"]
    gyration = math.sqrt(vehicle["yaw_inertia_kgm2"] / vehicle["mass_kg"])
    along, across, rim = np.zeros((len(wheels), 3)), np.zeros((len(wheels), 3)), np.zeros((len(wheels), 2))
    for i, wheel in enumerate(wheels):
        roller = wheel.get("roller_rad", math.pi / 2)
        axis, x, y = wheel["axle_rad"] + roller, wheel["x_m"], wheel["y_m"]
        u = np.array([math.cos(axis), math.sin(axis)])
        w = np.array([-u[1], u[0]])
        along[i] = *u, (x * u[1] - y * u[0]) / gyration
        across[i] = *w, (x * w[1] - y * w[0]) / gyration
        size = wheel.get("radius_m", vehicle["wheel_radius_m"]) / vehicle["wheel_radius_m"]
        rim[i] = size * math.sin(roller), size * math.cos(roller)
    return {"along": along, "across": across, "rim_along": rim[:, 0], "rim_across": rim[:, 1]}


def step_problem(vehicle: Mapping[str, Any], free_nu: np.ndarray, free_speed: np.ndarray, step_s: float, *,
                 voltage_V: np.ndarray, torque_Nm: np.ndarray, load_N: np.ndarray) -> StepProblem:
    """The step's problem from the free motion (ν*, s*), with the motors' voltages, axle torques and normal loads."""
    count, ground = len(vehicle["wheel"]), vehicle["ground"]
    radius, mass = vehicle["wheel_radius_m"], vehicle["mass_kg"]
    impulse = step_s / (mass * radius**2)      # of a torque
    drive = vehicle.get("drive")
    viscous = drive["viscous_friction_Nms"] if drive else 0.0
    limit, volts = np.inf, voltage_V
    if drive:
        limit = vehicle["motor_gain_Nm_per_V"] * drive["winding_resistance_ohm"] * drive["current_limit_A"]
        volts = np.clip(voltage_V, -drive["supply_V"], drive["supply_V"])
    inertia = np.full(count, vehicle["wheel_inertia_kgm2"] / (mass * radius**2))
    drag = np.array([1.0 if w["kind"] == "fixed" else ground["roller_drag"] for w in vehicle["wheel"]])
    each = np.ones(count)
    return StepProblem(
        **geometry(vehicle), inertia=inertia, drag=drag,
        grip=step_s * ground["friction_coefficient"] * load_N / (mass * radius),
        axle=impulse * ground["axle_friction_Nm"] * each,
        drive=impulse * vehicle["motor_gain_Nm_per_V"] * volts,
        drive_slope=impulse * (vehicle["motor_damping_Nms"] - viscous) * each,
        drive_limit=impulse * limit * each, viscous=impulse * viscous * each,
        free_speed=free_speed + impulse * torque_Nm / inertia, free_nu=free_nu)


def random_problem(random: np.random.Generator, vehicle: Mapping[str, Any]) -> StepProblem:
    """A cold state: rolling, slipping or resting; forces, voltages and loads over decades, some wheels unloaded."""
    count, radius, mass = len(vehicle["wheel"]), vehicle["wheel_radius_m"], vehicle["mass_kg"]
    step_s = 10.0 ** random.uniform(-4, -1.5)
    pace = 10.0 ** random.uniform(-2, 2) * float(random.random() < 0.85)
    nu = pace * random.standard_normal(3)
    rows = geometry(vehicle)
    safe = np.where(np.abs(rows["rim_along"]) > 0.1, rows["rim_along"], 1.0)
    rolling = (rows["along"] @ nu) / safe
    speed = rolling + pace * float(random.choice([0.0, 1e-6, 1e-3, 0.1, 1.0])) * random.standard_normal(count)
    force = step_s * GRAVITY / radius * random.standard_normal(3) * float(random.choice([0.0, 1e-3, 0.1, 1.0]))
    share = random.uniform(0.2, 1.8, count) if random.random() < 0.5 else np.ones(count)
    load = mass * GRAVITY / count * share * (random.random(count) > 0.05)
    unit = mass * radius**2
    volts = random.standard_normal(count) * 10.0 ** random.uniform(-1, 2) * float(random.random() < 0.6)
    torque = unit * random.standard_normal(count) * 10.0 ** random.uniform(-1, 2) * float(random.random() < 0.2)
    return step_problem(vehicle, nu + force, speed, step_s, voltage_V=volts, torque_Nm=torque, load_N=load)
