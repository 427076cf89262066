"""Vehicles with hinges in the format of data/articulated_reference.json, run by the program run_articulated."""

from __future__ import annotations

import math
import subprocess
from typing import Any

from laconic.base.paths import built

Case = dict[str, Any]
KINDS = {"free": 1, "motor": 2, "prescribed": 3, "coordinated": 4}


def vehicle_words(vehicle: Case) -> list[object]:
    carriage, *hung = vehicle["bodies"]
    words: list[object] = ["vehicle", carriage["mass"], carriage["inertia"], *carriage["com"], 0, 0, 0, len(hung)]
    for body in hung:
        joint = body["joint"]
        words += [body["parent"], KINDS[joint["kind"]], *body["hinge"], body["mass"], *body["com"], body["inertia"],
                  *(joint.get(key, 0) for key in ("damping", "stiffness", "rest", "gain"))]
    words.append(len(vehicle["wheels"]))
    for wheel in vehicle["wheels"]:
        words += [wheel["body"], 2 if wheel["kind"] == "fixed" else 1, *wheel["at"], wheel["axle"],
                  wheel.get("roller", 0), wheel["radius"], wheel["inertia"], wheel["gain"], wheel["damping"],
                  int(wheel.get("locked", False))]
    return words


def input_words(vehicle: Case, segment: Case) -> list[object]:
    wheels, hinges = len(vehicle["wheels"]), range(1, len(vehicle["bodies"]))
    words: list[object] = ["\ninput", *(segment.get("U") or [0] * wheels), *segment.get("axle_torque", [0] * wheels),
                           *segment.get("body_wrench", [0, 0, 0]), *segment.get("world_force", [0, 0]),
                           *segment.get("point", [0, 0])]
    for key in ("hinge_U", "hinge_torque"):
        words += [segment.get(key, {}).get(str(b), 0) for b in hinges]
    polynomials = [segment.get("hinge_rate", {}).get(str(b), []) for b in hinges]
    for polynomial in polynomials + segment.get("twist", [[], [], []]):
        words += [len(polynomial), *polynomial]
    return words


def start_words(start: Case) -> list[object]:
    return ["\nstart", *start["velocity"], *start["pose"], *start["psi"], *start["hinge_rate"]]


def run(words: list[object], real: str = "double") -> list[list[float]]:
    """The rows that the program prints."""
    text = " ".join(repr(float(word)) if isinstance(word, float) else str(word) for word in words)
    result = subprocess.run([str(built(f"bin/run_articulated_{real}"))], input=text, capture_output=True, text=True,
                            check=False)
    assert result.returncode == 0, result.stdout[-300:] + result.stderr
    return [[float(number) for number in line.split()] for line in result.stdout.splitlines()]


def trajectory(case: Case, method: str, step_s: float, real: str = "double") -> list[list[float]]:
    """Motion at the start and at the end of each segment; a step that does not divide a segment is shortened."""
    vehicle = case["vehicle"]
    words = vehicle_words(vehicle)
    for number, segment in enumerate(case["segments"]):
        words += input_words(vehicle, segment)
        if number == 0:
            words += [*start_words(case["initial"]), "motion"]
        steps = max(1, math.ceil(segment["duration"] / step_s - 1e-9))
        words += ["\nmethod", method, segment["duration"] / steps, "run", segment["duration"], steps, "motion"]
    return run(words, real)
