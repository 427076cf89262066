"""Random vehicles with hinges on ground with friction, with everything that articulated_friction.json leaves out."""

from __future__ import annotations

import numpy as np
from tree_runner import Case

FIXED = {"axle_rad": -np.pi / 2, "roller_rad": np.pi / 2, "roller_drag": 1.0}


def random_wheel(rng: np.random.Generator, body: int, at: list[float], load_N: float) -> Case:
    driven = rng.random() < 0.5
    wheel: Case = {"body": body, "at_m": at, "radius_m": rng.uniform(0.03, 0.12),
                   "inertia_kgm2": 10 ** rng.uniform(-4, -2), "friction_coefficient": rng.uniform(0.1, 1),
                   "normal_load_N": load_N, "axle_friction_Nm": rng.choice([0, 0.02, 0.1]),
                   "motor_gain_Nm_per_V": 0.4 if driven else 0.0, "motor_damping_Nms": 0.3 if driven else 0.0,
                   "scrub_radius_m": rng.choice([0, 0.01]), "scrub_fade_m": 0.0, **FIXED}
    if wheel["scrub_radius_m"] > 0:
        wheel["scrub_fade_m"] = rng.choice([0, 0.1])
    if rng.random() < 0.25:
        wheel |= {"roller_rad": rng.choice([np.pi / 4, -np.pi / 4, np.pi / 2]), "roller_drag": rng.uniform(0.05, 0.9)}
    return wheel


def random_body(rng: np.random.Generator, parent: int) -> Case:
    kind = rng.choice(["free", "servo", "limited", "prescribed", "spring", "stops"])
    body: Case = {"parent": parent, "hinge_at_parent_m": list(rng.uniform(-0.4, 0.4, 2)),
                  "mass_kg": 10 ** rng.uniform(-1, 1), "com_m": list(rng.uniform(-0.1, 0.1, 2)),
                  "yaw_inertia_kgm2": 10 ** rng.uniform(-3, -0.5), "hinge_viscous_Nms": rng.choice([0, 0.01]),
                  "hinge_dry_Nm": rng.choice([0, 0.05]), "spring_Nm_per_rad": 0.0, "spring_rest_rad": 0.0,
                  "stop_low_rad": None, "stop_high_rad": None, "servo_kp": 0.0, "servo_kd": 0.0,
                  "servo_limit_Nm": None, "prescribed": kind == "prescribed"}
    if kind in ("servo", "limited"):
        body |= {"servo_kp": 50.0, "servo_kd": 1.0, "servo_limit_Nm": 2.0 if kind == "limited" else None}
    if kind == "spring":
        body |= {"spring_Nm_per_rad": 20.0, "spring_rest_rad": rng.uniform(-0.5, 0.5)}
    if kind == "stops":
        body |= {"stop_low_rad": -0.6, "stop_high_rad": 0.6}
    return body


def random_tree(rng: np.random.Generator, plain: bool = False) -> Case:
    """One to four hinged bodies, some on others, each with a wheel. `plain`: no hinge has a command or a spring."""
    count = int(rng.integers(1, 5))
    bodies = [{"mass_kg": rng.uniform(8, 40), "yaw_inertia_kgm2": rng.uniform(0.3, 3), "com_m": [0.0, 0.0],
               "hinge_at_parent_m": [0.0, 0.0]}]
    bodies += [random_body(rng, int(rng.integers(0, b)) if rng.random() < 0.4 else 0) for b in range(1, count + 1)]
    for body in bodies[1:]:
        if plain:
            body |= {"servo_kp": 0.0, "servo_kd": 0.0, "servo_limit_Nm": None, "prescribed": False,
                     "spring_Nm_per_rad": 0.0}
    load = 9.81 * sum(body["mass_kg"] for body in bodies) / (2 + count)
    wheels = [random_wheel(rng, 0, [0.1, side * 0.2], load) for side in (1, -1)]
    wheels += [random_wheel(rng, b, [rng.uniform(-0.1, 0.0), rng.uniform(-0.02, 0.02)], load * rng.uniform(0.6, 1.4))
               for b in range(1, count + 1)]
    return {"bodies": bodies, "wheels": wheels}


def random_start(rng: np.random.Generator, vehicle: Case, speed: float = 1.0) -> Case:
    hinges, wheels = len(vehicle["bodies"]) - 1, len(vehicle["wheels"])
    return {"psi_rad": list(rng.uniform(-0.5, 0.5, hinges)),
            "z": list(speed * rng.normal(size=3 + hinges) * np.array([1, 1, 2] + [2] * hinges)),
            "wheel_speed": list(speed * 10 * rng.normal(size=wheels))}


def random_segment(rng: np.random.Generator, vehicle: Case) -> Case:
    hinges, wheels = len(vehicle["bodies"]) - 1, len(vehicle["wheels"])
    return {"voltage_V": list(rng.uniform(-10, 10, wheels)), "servo_angle_rad": list(rng.uniform(-0.5, 0.5, hinges)),
            "hinge_rate": list(rng.uniform(-1, 1, hinges)), "hinge_torque_Nm": list(rng.uniform(-1, 1, hinges)),
            "body_wrench": list(rng.uniform(-5, 5, 3))}
