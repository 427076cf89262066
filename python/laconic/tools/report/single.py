"""What single precision must still deliver: S1's digits, a heading after 10⁹ turns, x and y after 10⁷ steps."""

from __future__ import annotations

from typing import Any

import numpy as np

from laconic.core import load
from laconic.scene import Scene
from laconic.scene.methods import EXACT
from laconic.tools.report.accuracy import follow
from laconic.tools.verify.reference import reference_states

TURNS, LONG_STEPS, LONG_STEP_S = 10**9, 10_000_000, 1e-3


def s1_rows(scene: Scene, methods: tuple[str, ...]) -> list[dict[str, Any]]:
    """Absolute error of ν in single precision: at S1's end, and the largest at its half seconds."""
    ends = np.linspace(0.0, scene.run.duration_s, 21)[1:]
    rows = []
    for step_s in (0.01, 0.001):
        fixed = scene.with_run(step_s=step_s)
        truth = reference_states(fixed, ends)
        for method in methods:
            found = follow(fixed.with_run(method=method), "single", ends)
            error = np.max(np.abs(found[:, :3] - truth[:, :3]), axis=1)
            rows.append({"method": method, "step_s": step_s, "error_nu": float(error[-1]), "error_anywhere":
                         float(np.max(error)), "largest_nu": float(np.max(np.abs(truth[:, :3])))})
    return rows


def heading_after_many_turns(scene: Scene, steps: int = 1000) -> bool:
    """Whether a heading a billion turns on advances by the same bits as one that starts at zero."""
    core = load("single")
    near, far = (scene.with_run(step_s=0.01).plant(core) for _ in range(2))
    far.c.state.heading.turns = TURNS
    held = core.input(scene.with_run(step_s=0.01).inputs_on_grid().held_at(0))
    for plant in (near, far):
        plant.run(held, steps)
    a, b = near.c.state.heading, far.c.state.heading
    return a.fraction == b.fraction and a.rest == b.rest and b.turns - a.turns == TURNS


def straight_run(scene: Scene, speed: float = 0.7) -> dict[str, float]:
    """Ten million steps straight ahead in single precision: relative error of x."""
    core = load("single")
    free = {**scene.vehicle, "motor_gain_Nm_per_V": 0.0, "motor_damping_Nms": 0.0}
    plant = core.plant(core.vehicle(free), EXACT, LONG_STEP_S, nu_rad_per_s=(speed, 0.0, 0.0), x_m=100.0)
    plant.run(core.input(), LONG_STEPS)
    travelled = float(np.float32(LONG_STEP_S)) * LONG_STEPS * float(np.float32(speed)) * scene.vehicle["wheel_radius_m"]
    expected = 100.0 + travelled
    return {"expected_m": expected, "found_m": float(plant.pose.x_m), "error": abs(plant.pose.x_m / expected - 1.0)}
