"""exponential-gauss-8 on made-up vehicles with damping from slow to a million times that, beside their true motion.

docs/integrators.md has the errors of 200 such vehicles; a few of them are run here.
"""

from __future__ import annotations

import numpy as np
import pytest
from mpmath import mp, mpf

from laconic.core import load
from laconic.verification.derivatives.exact_model import exact_model, numbers_of
from laconic.verification.derivatives.exact_steps import exact_step
from laconic.verification.derivatives.trials import INPUTS, Trial, made_up, plant_of

DIGITS = 50
RUN_S = 0.05
KINDS = ("omni", "mecanum", "drive", "own", "locked", "mixed")
LARGEST_STEP_S = 0.0025  # of the true motion's: finer ones move it by 1e-12 at most


def made_stiff(number: int, of: int) -> Trial:
    """A vehicle with its start and inputs; its damping grows with its number, up to 10⁶ times."""
    random = np.random.default_rng(9000 + number)
    trial = made_up(random, KINDS[number % len(KINDS)], "auto")
    factor = 10 ** (6 * (number + random.random()) / of)
    trial.table["motor_damping_Nms"] = float(10 ** random.uniform(-2.5, -1.5) * factor)
    for wheel in trial.table["wheel"]:
        if "motor_damping_Nms" in wheel:
            wheel["motor_damping_Nms"] *= factor
    trial.nu[:] = random.normal(0, 10 ** random.uniform(0, 1.3), 3).tolist()
    return trial


def true_motion(trial: Trial, nu: np.ndarray) -> np.ndarray:
    """(ν, x, y, θ, χ) at the end, in 50 digits; the steps are short beside what has not yet died out."""
    with mp.workdps(DIGITS):
        model = exact_model(numbers_of(trial.table))
        held = {name: [mpf(x) for x in trial.held[name]] for name in INPUTS}
        state = [*(mpf(float(x)) for x in nu), mpf(0), mpf(0), mpf(trial.heading_rad),
                 *([mpf(0)] * len(trial.table["wheel"]))]
        fastest, now = max(1, *model.decay), mpf(0)
        while now < RUN_S:
            step = min(mpf(LARGEST_STEP_S), max(1 / (20 * fastest), now / 4), RUN_S - now)
            state = exact_step(model, "exponential-gauss-8", step, state, held, False)
            now += step
        return np.array([float(x) for x in state])


def error(trial: Trial, truth: np.ndarray, method: str, step_s: float) -> tuple[float, float]:
    """Of ν, and of pose and wheel angles, beside the largest of them, or 1 where that is less."""
    plant = plant_of(load("double"), Trial(trial.kind, method, trial.table, step_s, trial.nu, trial.heading_rad,
                                           trial.held))
    plant.run(trial.held, round(RUN_S / step_s))
    pose = plant.pose
    found = [*plant.nu, pose.x_m, pose.y_m, pose.heading_rad, *plant.wheel_angles()]
    off = np.abs(np.array(found) - truth)
    of = [float(off[part].max() / max(1.0, np.abs(truth[part]).max())) for part in
          (slice(0, 3), slice(3, 6), slice(6, None))]
    return of[0], max(of[1:])


@pytest.mark.parametrize("number", [0, 81, 90])
def test_a_stiff_vehicle_meets_its_true_motion(number: int):
    trial = made_stiff(number, 200)
    truth = true_motion(trial, plant_of(load("double"), trial).nu)
    for step_s, most in ((0.001, 1e-9), (0.01, 3e-8)):
        ours, others = (max(error(trial, truth, method, step_s)) for method in
                        ("exponential-gauss-8", "exponential-kahan-4"))
        assert ours < most
        assert ours <= max(others, 1e-12)
