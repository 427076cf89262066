"""Vehicles in the format of articulated_friction.json, recorded or random, run by run_tree on ground with friction."""

from __future__ import annotations

import subprocess
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from laconic.base.paths import built

Case = dict[str, Any]
Vector = NDArray[np.float64]


def _or_zero(value: float | None) -> float:
    return 0.0 if value is None else value


def hinge_words(body: Case) -> list[object]:
    kind = 3 if body["prescribed"] else 2 if body.get("gain_Nm_per_V") else 1
    return [body["parent"], kind, *body["hinge_at_parent_m"], body["mass_kg"], *body["com_m"],
            body["yaw_inertia_kgm2"], body["hinge_viscous_Nms"] + body.get("back_emf_Nms", 0),
            body["spring_Nm_per_rad"], body["spring_rest_rad"], body.get("gain_Nm_per_V", 0),
            body.get("com_z_m", 0), int(body.get("hitch", False)), body["hinge_dry_Nm"],
            _or_zero(body["stop_low_rad"]), _or_zero(body["stop_high_rad"]), body["servo_kp"], body["servo_kd"],
            _or_zero(body["servo_limit_Nm"]), body["hinge_viscous_Nms"] if body.get("gain_Nm_per_V") else 0,
            body.get("resistance_ohm", 0), body.get("current_limit_A", 0), body.get("loop_V_per_rad", 0),
            body.get("loop_Vs_per_rad", 0), body.get("control_period_s", 0)]


def vehicle_words(vehicle: Case) -> list[object]:
    carriage, *hung = vehicle["bodies"]
    words: list[object] = ["vehicle", carriage["mass_kg"], carriage["yaw_inertia_kgm2"], 0, 0,
                           carriage.get("com_z_m", 0), 1, 0, 0, *vehicle.get("slope", [0, 0]),
                           *vehicle.get("drive", [0, 0, 0, 0, 0]), len(hung)]
    for body in hung:
        words += hinge_words(body)
    words.append(len(vehicle["wheels"]))
    for wheel in vehicle["wheels"]:
        fixed = abs(wheel["roller_rad"] - np.pi / 2) < 1e-12 and wheel["roller_drag"] == 1
        words += [wheel["body"], 2 if fixed else 1, *wheel["at_m"], wheel["axle_rad"], wheel["roller_rad"],
                  wheel["radius_m"], wheel["inertia_kgm2"], wheel["motor_gain_Nm_per_V"],
                  wheel["motor_damping_Nms"], int(wheel.get("locked", False)), wheel["friction_coefficient"],
                  wheel["roller_drag"], wheel["axle_friction_Nm"], wheel.get("circuit", 0),
                  wheel.get("normal_load_N", 0), wheel["scrub_radius_m"], wheel["scrub_fade_m"], wheel.get("creep", 0)]
    supports = vehicle.get("supports", [])
    return [*words, len(supports), *(number for point in supports for number in point)]


def start_words(start: Case) -> list[object]:
    z = start["z"]
    return ["\nstart", *z[:3], *start.get("pose", [0, 0, 0]), *start["psi_rad"], *z[3:], *start["wheel_speed"]]


def input_words(vehicle: Case, segment: Case) -> list[object]:
    wheels, hinges = len(vehicle["wheels"]), len(vehicle["bodies"]) - 1
    return ["\ninput", *segment.get("voltage_V", [0] * wheels), *segment.get("axle_torque_Nm", [0] * wheels),
            *segment.get("body_wrench", [0, 0, 0]), *segment.get("world_force_N", [0, 0]), 0, 0,
            *segment.get("hinge_voltage_V", [0] * hinges), *segment.get("hinge_torque_Nm", [0] * hinges),
            *segment.get("hinge_rate", [0] * hinges), *segment.get("servo_angle_rad", [0] * hinges)]


def run(words: list[object], real: str = "double") -> list[Vector]:
    """The rows that the program prints."""
    text = " ".join(repr(float(word)) if isinstance(word, float) else str(word) for word in words)
    result = subprocess.run([str(built(f"bin/run_tree_{real}"))], input=text, capture_output=True, text=True,
                            check=False)
    assert result.returncode == 0, result.stdout[-300:] + result.stderr
    return [np.array([float(number) for number in line.split()]) for line in result.stdout.splitlines()]


@dataclass(frozen=True)
class State:
    """A row of `state` or `trace`, by parts."""

    pose: Vector
    psi: Vector
    z: Vector
    wheel_speed: Vector
    velocity: Vector  # of each body: its centre of mass and yaw rate, axes of body 0
    grip_N: Vector  # along u, across it over k; of the robot on the ground
    scrub_Nm: Vector
    dry_Nm: Vector
    stop_Nm: Vector
    drive_Nm: Vector
    normal_N: Vector


def state_of(vehicle: Case, row: Vector) -> State:
    hinges, wheels = len(vehicle["bodies"]) - 1, len(vehicle["wheels"])
    points = wheels + len(vehicle.get("supports", []))
    sizes = [3, hinges, 3 + hinges, wheels, 3 * (hinges + 1), 2 * wheels, wheels, hinges, 2 * hinges, hinges, points]
    parts = np.split(row, np.cumsum(sizes)[:-1])
    assert len(parts[-1]) == points
    return State(parts[0], parts[1], parts[2], parts[3], parts[4].reshape(-1, 3), parts[5].reshape(-1, 2), parts[6],
                 parts[7], parts[8].reshape(-1, 2), parts[9], parts[10])


def course_words(vehicle: Case, start: Case, segments: list[Case], step_s: float, word: str = "run") -> list[object]:
    words = [*vehicle_words(vehicle), *start_words(start)]
    for segment in segments:
        words += [*input_words(vehicle, segment), f"\n{word}", step_s, round(segment["duration_s"] / step_s)]
    return words


def end_of(vehicle: Case, start: Case, segments: list[Case], step_s: float, real: str = "double") -> State:
    return state_of(vehicle, run([*course_words(vehicle, start, segments, step_s), "state"], real)[-1])


# ------------------------------------------------------------------------------------ random vehicles

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
    if rng.random() < 0.2:
        wheel["creep"] = rng.choice([0.02, 0.1])
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
