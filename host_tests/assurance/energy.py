"""Does any method gain energy over a run? Made-up vehicles coast without input, on ideal ground, for many steps.

    python host_tests/assurance/energy.py --vehicles 1000 --steps 100000
    python host_tests/assurance/energy.py --real single --damped --method auto --method exact-flow-4

docs/integrators.md states the bound of each method. The exit status is 1 if a run exceeds its bound.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np

from laconic.core import Core, load
from laconic.errors import Refused

CHECKPOINTS = 50
KEPT = {"double": 1e-9, "single": 1e-4}
ROUNDED = {"double": 1e-15, "single": 3e-8}  # of a step, for methods that nothing corrects


def between(rng: np.random.Generator, low: float, high: float) -> float:
    return math.exp(rng.uniform(math.log(low), math.log(high)))


def made_up(rng: np.random.Generator) -> dict[str, Any]:
    """Keys of `[vehicle]`: omni, mecanum, any rollers, a cart, or a fixed wheel among omni wheels."""
    kind, wide = rng.integers(5), rng.random() < 0.5  # wide: from a crumb to a ship
    size, mass = between(rng, *((0.01, 10) if wide else (0.1, 1))), between(rng, *((1e-3, 1e5) if wide else (1, 100)))
    radius, wheels = size * between(rng, 1e-4 if wide else 0.05, 0.5), []
    for i in range(count := rng.integers(2, 9)):
        bearing = 2 * math.pi * i / count + 0.1 * rng.normal()
        wheel = {"kind": "omni", "x_m": size * math.cos(bearing), "y_m": size * math.sin(bearing), "axle_rad": bearing}
        if kind == 1:
            wheel |= {"kind": "mecanum", "axle_rad": math.pi / 2, "roller_rad": (-1) ** i * math.pi / 4}
        elif kind == 2:
            wheel |= {"kind": "roller", "axle_rad": rng.uniform(-3, 3), "roller_rad": rng.uniform(0.3, 1.5)}
        elif kind == 3:
            wheel |= {"kind": "fixed", "axle_rad": math.pi / 2, "x_m": 0.0}
        elif kind == 4 and i == 0:
            wheel |= {"kind": "fixed", "axle_rad": rng.uniform(-3, 3)}
        wheels.append(wheel)
    aside = 0.3 * size * rng.normal(size=2) * (rng.random() < 0.5)
    return {"mass_kg": mass, "yaw_inertia_kgm2": mass * size**2 * between(rng, 1e-6 if wide else 0.05, 10),
            "wheel_radius_m": radius, "wheel_inertia_kgm2": mass * radius**2 * between(rng, 1e-6 if wide else 0.01, 3),
            "com_x_m": aside[0], "com_y_m": aside[1], "wheel": wheels}


def bound(method: str, real: str, steps: int, turn: float, most_turn: float) -> float:
    """Of the gain after so many steps; turn is h·|w||g·ζ| now, most_turn h·|w||g||ζ| at the start."""
    if method == "exponential-kahan":
        return turn**2 / 4 + steps * ROUNDED[real]
    if method in ("rk4", "taylor-8"):
        return min(most_turn**4 / 150 if method == "rk4" else most_turn**8 / 40, 1 / 128) + steps * ROUNDED[real]
    return 2e-6 * steps if (method, real) == ("exponential-kahan-4", "single") else KEPT[real]


def coast(core: Core, number: int, method: str, steps: int, damped: bool) -> tuple[str, float, float]:
    """How the run ended, its largest gain (with damping over the least energy so far), and that over the bound."""
    rng = np.random.default_rng(number)
    table, step_s = made_up(rng), between(rng, 1e-4, 1)
    most_turn, decay = between(rng, 1e-3, 30), between(rng, 1e-9, 1 if method in ("rk4", "taylor-8") else 100)
    model = core.prepare(core.vehicle(table | {"motor_damping_Nms": table["mass_kg"] * table["wheel_radius_m"] ** 2}))
    if damped and (fastest := max(model.decay_per_s)) > 0:
        table["motor_damping_Nms"] = decay / (fastest * step_s) * table["mass_kg"] * table["wheel_radius_m"] ** 2
    model = core.prepare(core.vehicle(table))
    rows, gyro = np.array([list(row) for row in model.nu_of_zeta]), np.linalg.norm(list(model.gyro))
    zeta = rng.normal(size=3) * (np.arange(3) < model.dof)
    if gyro * model.yaw_scale > 1e-4:  # else w is 0 but for rounding, and nothing turns
        zeta *= most_turn / (step_s * gyro * np.linalg.norm(rows[2]) * np.linalg.norm(zeta))
    plant = core.plant(core.vehicle(table), method, step_s, nu_rad_per_s=tuple(rows @ zeta))
    least, worst, beside = math.inf, 0.0, 0.0
    for _ in range(CHECKPOINTS + 1):
        zeta = np.array([each.value + each.rest for each in plant.c.state.zeta])
        energy, turn = float(zeta @ zeta), step_s * gyro * abs(rows[2] @ zeta)
        worst = max(worst, gain := energy / least - 1 if least > 0 else 0.0)
        beside = max(beside, gain / bound(method, core.real, max(plant.steps, 1), turn, most_turn))
        least = min(least, energy) if damped or plant.steps == 0 else least
        try:
            plant.run(None, steps // CHECKPOINTS)
        except Refused as refusal:
            return refusal.status, worst, beside
    return "ok", worst, beside


def campaign(core: Core, method: str, numbers: Sequence[int], steps: int, damped: bool) -> bool:
    """Prints how the runs of a method ended; whether all are within the bound."""
    ends: Counter[str] = Counter()
    worst, beside, which = 0.0, 0.0, None
    for number in numbers:
        try:
            end, gain, ratio = coast(core, number, method, steps, damped)
        except Refused as refusal:
            end, gain, ratio = f"not prepared: {refusal.status}", 0.0, 0.0
        ends[end] += 1
        worst, beside, which = max(worst, gain), max(beside, ratio), number if ratio > beside else which
        print(f"\r{method}: {sum(ends.values())} of {len(numbers)} ", end="", file=sys.stderr, flush=True)
    print(f"\r{method:20} gains {worst:.1e}, {beside:.1e} of its bound (vehicle {which}); {dict(ends)}", flush=True)
    return beside <= 1


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--vehicles", type=int, default=100)
    parser.add_argument("--steps", type=int, default=10_000)
    parser.add_argument("--first", type=int, default=0, help="number of the first vehicle")
    parser.add_argument("--real", choices=("double", "single"), default="double")
    parser.add_argument("--method", action="append", help="may be given several times; without it all methods run")
    parser.add_argument("--damped", action="store_true", help="the motors damp; then the energy must never grow")
    given = parser.parse_args()
    core, numbers = load(given.real), range(given.first, given.first + given.vehicles)
    methods = given.method or core.method_names
    return 0 if all([campaign(core, each, numbers, given.steps, given.damped) for each in methods]) else 1


if __name__ == "__main__":
    sys.exit(main())
