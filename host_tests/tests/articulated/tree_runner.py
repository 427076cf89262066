"""Vehicles in the format of articulated_friction.json, run by the program run_tree on ground with friction."""

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
                  wheel.get("normal_load_N", 0), wheel["scrub_radius_m"], wheel["scrub_fade_m"]]
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
