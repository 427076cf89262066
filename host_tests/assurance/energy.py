"""Does any method gain energy over a run? Random vehicles coast without input, on ideal ground, for many steps.

    python host_tests/assurance/energy.py --vehicles 1000 --steps 100000          # every method, double, no damping
    python host_tests/assurance/energy.py --real single --damped --method auto

docs/integrators.md states the bound of each method. Exit status 1 if a run exceeds its bound.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections import Counter
from typing import Any

import numpy as np

from laconic.core import REALS, Core, load
from laconic.errors import Refused

CHECKPOINTS = 50
KEPT = {"double": 1e-9, "single": 1e-4}
ROUNDED = {"double": 1e-15, "single": 3e-8}  # of a step, for methods that nothing corrects


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(math.exp(rng.uniform(math.log(low), math.log(high))))


def made_up(rng: np.random.Generator) -> dict[str, Any]:
    """Keys of `[vehicle]`: omni, mecanum, any rollers, a cart, or a fixed wheel among omni wheels."""
    wide, kind = rng.random() < 0.5, int(rng.integers(5))
    size = log_uniform(rng, 0.01, 10) if wide else log_uniform(rng, 0.1, 1)
    mass = log_uniform(rng, 1e-3, 1e5) if wide else log_uniform(rng, 1, 100)
    radius = size * (log_uniform(rng, 1e-4, 1) if wide else log_uniform(rng, 0.05, 0.3))
    inertia = mass * radius**2 * (log_uniform(rng, 1e-6, 10) if wide else log_uniform(rng, 1e-3, 0.3))
    wheels = []
    for i in range(count := int(rng.integers(2, 9))):
        bearing = 2 * math.pi * i / count + 0.1 * rng.normal()
        wheel: dict[str, Any] = {"kind": "omni", "axle_rad": bearing, "y_m": size * math.sin(bearing),
                                 "x_m": size * math.cos(bearing) if kind != 3 else 0.0}
        if kind == 1:
            wheel |= {"kind": "mecanum", "axle_rad": math.pi / 2, "roller_rad": math.pi / 4 * (-1) ** i}
        elif kind == 2:
            wheel |= {"kind": "roller", "axle_rad": rng.uniform(-3, 3), "roller_rad": rng.uniform(0.3, 1.5)}
        elif kind == 3 or (kind == 4 and i == 0):
            wheel |= {"kind": "fixed", "axle_rad": math.pi / 2 if kind == 3 else rng.uniform(-3, 3)}
        wheels.append(wheel)
    beside = 0.3 * size * rng.normal(size=2) * (rng.random() < 0.5)
    return {"mass_kg": mass, "yaw_inertia_kgm2": mass * size**2 * log_uniform(rng, 1e-6 if wide else 0.05, 10),
            "wheel_radius_m": radius, "wheel_inertia_kgm2": inertia * (rng.random() < 0.8), "com_x_m": beside[0],
            "com_y_m": beside[1], "wheel": wheels}


def bound(method: str, real: str, turn: float, most_turn: float, steps: int) -> float:
    """Of a run's gain over its start: turn is h·|w||g·ζ| now, most_turn h·|w||g||ζ| at the start."""
    if method == "exponential-kahan":
        return turn**2 / 4 + steps * ROUNDED[real]
    if method in ("rk4", "taylor-8"):
        by_truncation = most_turn**4 / 150 if method == "rk4" else most_turn**8 / 40
        return min(by_truncation, 1 / 128) + steps * ROUNDED[real]
    return KEPT[real] if method != "exponential-kahan-4" or real == "double" else steps * 2e-6


def coast(core: Core, seed: int, method: str, steps: int, damped: bool) -> tuple[str, float, float]:
    """How the run ended, its largest gain, and that beside the bound; with damping from the lowest energy so far."""
    rng = np.random.default_rng(seed)
    table, step_s = made_up(rng), log_uniform(rng, 1e-4, 1)
    turn, decay = log_uniform(rng, 1e-3, 30), log_uniform(rng, 1e-9, 1)
    model = core.prepare(core.vehicle(table | {"motor_damping_Nms": 1.0}))
    if damped and (fastest := max(model.decay_per_s)) > 0:
        table["motor_damping_Nms"] = decay / (fastest * step_s)
        model = core.prepare(core.vehicle(table))
    rows, gyro = np.array([list(row) for row in model.nu_of_zeta]), float(np.linalg.norm(list(model.gyro)))
    zeta = rng.normal(size=3) * (np.arange(3) < model.dof)
    per_turn = step_s * gyro * float(np.linalg.norm(rows[2]) * np.linalg.norm(zeta))
    zeta *= turn / per_turn if per_turn > 0 else 1.0
    plant = core.plant(core.vehicle(table), method, step_s, nu_rad_per_s=tuple(rows @ zeta))
    lowest, worst, beside = math.inf, 0.0, 0.0
    for _ in range(CHECKPOINTS + 1):
        zeta = np.array([float(each.value) + float(each.rest) for each in plant.c.state.zeta])
        energy, now = float(zeta @ zeta), step_s * gyro * abs(float(rows[2] @ zeta))
        if lowest > 0 and (gain := energy / lowest - 1) > 0:
            worst = max(worst, gain)
            beside = max(beside, gain / bound(method, core.real, now, turn, max(plant.steps, 1)))
        lowest = min(lowest, energy) if damped or not plant.steps else lowest
        try:
            plant.run(None, steps // CHECKPOINTS)
        except Refused as refusal:
            return refusal.status, worst, beside
    return "ok", worst, beside


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--vehicles", type=int, default=100)
    parser.add_argument("--steps", type=int, default=10_000)
    parser.add_argument("--first", type=int, default=0, help="the first vehicle's number")
    parser.add_argument("--real", choices=REALS, default="double")
    parser.add_argument("--method", action="append", help="may be given several times; all without it")
    parser.add_argument("--damped", action="store_true")
    given, failed = parser.parse_args(), False
    core = load(given.real)
    for method in given.method or core.method_names:
        ends: Counter[str] = Counter()
        worst, beside, which = 0.0, 0.0, -1
        for seed in range(given.first, given.first + given.vehicles):
            try:
                end, gain, ratio = coast(core, seed, method, given.steps, given.damped)
            except Refused as refusal:
                end, gain, ratio = f"not prepared: {refusal.status}", 0.0, 0.0
            ends[end] += 1
            worst, beside, which = max(worst, gain), max(beside, ratio), seed if ratio > beside else which
            print(f"\r{method}: {sum(ends.values())} of {given.vehicles}", end="", file=sys.stderr, flush=True)
        print("\r", end="", file=sys.stderr)
        failed |= beside > 1
        print(f"{method:20} largest gain {worst:.2g}, {beside:.2g} of its bound (vehicle {which}); {dict(ends)}")
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
