"""Steps of every method in 50 digits as a table for the core's C tests, core_c/tests/support/exact_steps.h:

    python -m references.derivatives.c_table core_c/tests/support/exact_steps.h

The adjoint of a step beside its Jacobian and its tangents.
"""

from __future__ import annotations

import sys
import textwrap
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from mpmath import mp, mpf

from laconic.core import load
from laconic.core.binding import Core
from laconic.core.derivatives import StepDerivatives
from laconic.core.plant import Plant
from laconic.errors import Refused
from laconic.scene.methods import EXPLICIT
from laconic.tools.verify.exact.exact_gauss import panels_of
from laconic.tools.verify.exact.exact_model import Vector, exact_model, numbers_of
from laconic.tools.verify.exact.exact_steps import exact_step
from laconic.tools.verify.exact.trials import DIGITS, INPUTS, KINDS, METHODS, Trial, made_up, plant_of

SEED = 20261123
MOST_WHEELS = 4
DAMPED = (0.05, 0.7, 4.0)  # about h·r of the cases of a kind: slow, of the size of a step, stiff
SPEEDS = (5.0, 20.0, 60.0)  # about ν, in rad/s: yaws of a step below and above the polynomials' bounds
REFUSED = "REFUSED"
OF_VEHICLE = ("mass_kg", "yaw_inertia_kgm2", "com_x_m", "com_y_m", "wheel_radius_m", "wheel_inertia_kgm2",
              "motor_gain_Nm_per_V", "motor_damping_Nms", "payload.mass_kg", "payload.x_m", "payload.y_m",
              "payload.yaw_inertia_kgm2", "ground.slope_rad", "ground.slope_heading_rad")
OF_WHEEL = ("x_m", "y_m", "axle_rad", "roller_rad", "radius_m", "inertia_kgm2", "motor_gain_Nm_per_V",
            "motor_damping_Nms")
HEAD = """\
/* Steps of made-up vehicles by every method in 50 digits, of host_tests/references/derivatives, which has no
 * code of the core's. Made by c_table.py there, whose head has the command. */
#ifndef LACONIC_TEST_EXACT_STEPS_H
#define LACONIC_TEST_EXACT_STEPS_H

#define REFUSED 1e300 /* the core does not take this step by this method */

"""


def cases() -> Iterator[Trial]:
    """Two of each kind, of few digits, so that both scalar types begin alike; damping and speed in turn."""
    random = np.random.default_rng(SEED)
    for place, kind in enumerate(KINDS):
        for number in (2 * place, 2 * place + 1):
            damped, fast = DAMPED[number % len(DAMPED)], SPEEDS[(number + number // 3) % len(SPEEDS)]
            drawn = made_up(random, kind, EXPLICIT)
            table = rounded(drawn.table)
            step_s = rounded(float(10 ** random.uniform(-2.3, -1.3)))
            largest = max((float(r) for r in exact_model(numbers_of(table)).decay), default=0.0)
            table["motor_damping_Nms"] = rounded(table["motor_damping_Nms"] * damped / (step_s * largest or damped))
            yield replace(drawn, table=table, step_s=step_s, nu=rounded(random.normal(0, fast, 3).tolist()),
                          heading_rad=rounded(drawn.heading_rad), held=rounded(drawn.held))


def rounded(given: Any) -> Any:
    """The same with four digits."""
    if isinstance(given, dict):
        return {key: rounded(value) for key, value in given.items()}
    if isinstance(given, list):
        return [rounded(value) for value in given]
    is_right_angle = isinstance(given, float) and abs(given) == np.pi / 2  # parallel axles stay parallel
    return float(f"{given:.4g}") if isinstance(given, float) and not is_right_angle else given


def given_numbers(trial: Trial) -> list[str]:
    """What the C test reads of a case."""
    numbers = numbers_of(trial.table)
    wheels = len(trial.table["wheel"])
    values: list[Any] = [numbers.get(name, 0) for name in OF_VEHICLE]
    values += [trial.step_s, *trial.nu, trial.heading_rad, wheels]
    for item in range(MOST_WHEELS):
        wheel = trial.table["wheel"][item] if item < wheels else {}
        values += [{"roller": 1, "fixed": 2}.get(wheel.get("kind", ""), 0), int(wheel.get("locked", False)),
                   int(not wheel.get("driven", True)), *(wheel.get(name, 0) for name in OF_WHEEL)]
    for name in INPUTS:
        room = MOST_WHEELS if name in INPUTS[:2] else len(trial.held[name])
        values += [*trial.held[name], *([0] * (room - len(trial.held[name])))]
    return [f"{float(value) + 0.0!r}".removesuffix(".0") for value in values]


def found_numbers(core: Core, trial: Trial, method: str) -> list[str]:
    """The state after the step, to 17 digits; REFUSED where the core does not take it."""
    of_method = replace(trial, method=method)
    try:
        plant = plant_of(core, of_method)
        plant.run(trial.held)
    except Refused:
        return [REFUSED]
    with mp.workdps(DIGITS):
        return [mp.nstr(value, 17) for value in exact(trial, method, plant)]


def exact(trial: Trial, method: str, plant: Any) -> Vector:
    """The state after the step in 50 digits; what is stiff the core decides."""
    model = exact_model(numbers_of(trial.table))
    nu = model.nu(model.zeta([mpf(value) for value in trial.nu]))
    start = [*nu, mpf(0), mpf(0), mpf(trial.heading_rad), *([mpf(0)] * len(trial.table["wheel"]))]
    held = {name: [mpf(value) for value in values] for name, values in trial.held.items()}
    return exact_step(model, method, mpf(trial.step_s), start, held, bool(plant.c.integrator.stiff),
                      panels_of(plant.c.integrator))


def text() -> str:
    """The header."""
    core, every = load("double"), list(cases())
    given = [given_numbers(trial) for trial in every]
    lines = [f"#define EXACT_CASES {len(every)}", f"#define EXACT_METHODS {len(METHODS)}",
             f"#define EXACT_GIVEN {len(given[0])}", f"#define EXACT_WHEELS {MOST_WHEELS}", "",
             "/* clang-format off */", "static const char *const exact_method[EXACT_METHODS] = {",
             *wrapped(", ".join(f'"{method}"' for method in METHODS)), "};", "",
             "static const double exact_given[EXACT_CASES][EXACT_GIVEN] = {"]
    lines += [row(numbers, f"{trial.kind}") for trial, numbers in zip(every, given, strict=True)]
    lines += ["};", "", "static const double exact_found[EXACT_CASES][EXACT_METHODS][6 + EXACT_WHEELS] = {"]
    for number, trial in enumerate(every):
        lines.append(f"    {{ /* {number}: {trial.kind} */")
        rows = [f"{{{', '.join(found_numbers(core, trial, method))}}}" for method in METHODS]
        lines += [*wrapped(", ".join(rows)), "    },"]
    return HEAD + "\n".join([*lines, "};", "/* clang-format on */", "", "#endif", ""])


def row(numbers: list[str], name: str) -> str:
    """One initialiser over as many lines as it takes."""
    return "\n".join(wrapped(f"{{{', '.join(numbers)}}}, /* {name} */"))


def wrapped(words: str) -> list[str]:
    """Text as lines."""
    return textwrap.wrap(words, 116, initial_indent="    ", subsequent_indent="     ", break_long_words=False,
                         break_on_hyphens=False)


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(text(), encoding="utf-8")


def adjoint_error(random: np.random.Generator, trial: Trial, plant: Plant) -> float:
    """The larger of two errors along random directions: of each number of the adjoint beside its column of the
    Jacobian, and of its product with a direction beside the covector's product with the tangent.

    Both are relative to the sum of magnitudes that such a product adds up, of which its rounding is some units.
    """
    step = StepDerivatives(plant, trial.held)
    gradient, state = random.normal(size=(2, 6 + plant.wheel_count))
    held = {name: random.normal(size=len(values)).tolist() for name, values in trial.held.items()}
    direction = np.concatenate([state, *(held[name] for name in INPUTS)])
    jacobian = step.jacobian(world_force=True)
    matrix = np.hstack([jacobian.by_state, jacobian.by_input])
    size = np.abs(matrix).T @ np.abs(gradient)
    found = np.concatenate(step.adjoint(gradient))
    columns = np.divide(np.abs(found - matrix.T @ gradient), size, out=np.zeros_like(size), where=size > 0.0)
    product = abs(found @ direction - gradient @ step.tangent(state, held)) / (size @ np.abs(direction))
    return max(float(columns.max()), float(product))
