"""Reference solutions that the report measures errors against."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from laconic.base.paths import SOURCE_DIR
from laconic.core import load
from laconic.scene import METHODS, Scene
from laconic.scene.methods import EXACT_4, EXPLICIT, STIFF, STIFF_4
from laconic.scene.table import Table
from laconic.tools.report.collocation import exact_start, true_states
from laconic.tools.verify.exact.trials import INPUTS
from laconic.tools.verify.reference import Reference, kinks, values_at
from laconic.tools.verify.trajectories import read_reference, verify_case

# ---- The states of a vehicle under held voltages in 50 digits: as near to the truth as doubles can tell.

def exact_states(vehicle: Mapping[str, Any], nu: Sequence[float], stretches_V: Sequence[Sequence[float]],  # noqa: N803
                 cuts_s: Sequence[Sequence[Fraction]]) -> np.ndarray:
    """(ν, x, y, θ, χ) at instants, from the origin; `stretches_V`: the voltages of each stretch, `cuts_s`: its
    instants."""
    model, start = exact_start({key: value for key, value in vehicle.items() if key != "support"}, nu)
    helds = [held_voltages(each) for each in stretches_V]
    return np.array([[float(x) for x in row] for row in true_states(model, start, 0.0, helds, cuts_s)])


def held_voltages(voltages_V: Sequence[float]) -> dict[str, list[float]]:  # noqa: N803
    """Inputs with nothing but these voltages."""
    held = {name: [0.0] * (len(voltages_V) if name == "axle_torque_Nm" else 2) for name in INPUTS}
    return held | {"voltage_V": [float(x) for x in voltages_V], "body_moment_Nm": [0.0]}


# ---- The numpy reference for very stiff vehicles: SciPy's implicit Radau with the exact Jacobian, restarted at
# jumps.

RTOL, ATOL = 1e-10, 1e-12

Terms = Callable[[float], tuple[np.ndarray, ...]]


def jacobian(reference: Reference, state: np.ndarray) -> np.ndarray:
    """Derivative of the rates by the state, for inputs without forces fixed in the world."""
    (n1, n2, n3), per_yaw = state[:3], 1.0 / reference.yaw_scale
    cosine, sine, radius = np.cos(state[5]), np.sin(state[5]), reference.totals.wheel_radius_m
    out = np.zeros((len(state), len(state)))
    turning = per_yaw * np.array([[0.0, n3, n2], [-n3, 0.0, -n1], [0.0, 0.0, 0.0]])
    out[:3, :3] = reference.mobility @ turning - reference.damping
    out[3, :3], out[4, :3] = (radius * cosine, -radius * sine, 0.0), (radius * sine, radius * cosine, 0.0)
    out[3, 5], out[4, 5] = radius * (-n1 * sine - n2 * cosine), radius * (n1 * cosine - n2 * sine)
    out[5, 2] = per_yaw
    out[6:, :3] = reference.rows
    return out


def stiff_states(scene: Scene, at_s: np.ndarray) -> np.ndarray:
    """States (ν, x, y, θ, χ) of a scene at some instants, ascending and after 0."""
    reference, inputs, start = Reference(scene.vehicle), scene.inputs_on_grid(), scene.initial
    state = np.concatenate([reference.nu(scene), [start.x_m, start.y_m, start.heading_rad],
                            np.zeros(len(reference.wheels))])
    edges = np.unique(np.concatenate([[0.0], kinks(inputs), at_s]))
    jumps, found = {0.0, *kinks(inputs)}, {}
    begun = 0.0
    for begin, end in zip(edges, edges[1:], strict=False):
        begun = begin if begin in jumps else begun
        state = _stretch(reference, _terms(reference, scene, begun), state, begin, end)
        found[end] = state
    return np.array([found[t] for t in at_s])


def _terms(reference: Reference, scene: Scene, begun: float) -> Terms:
    inputs = scene.inputs_on_grid()
    if inputs.is_held:
        held = reference.forcing_terms(values_at(inputs, begun, begun))
        return lambda t: held
    return lambda t: reference.forcing_terms(values_at(inputs, t, begun))


def _stretch(reference: Reference, terms: Terms, state: np.ndarray, begin: float, end: float) -> np.ndarray:
    solution = solve_ivp(lambda t, y: reference.rates(y, terms(t)), (begin, end), state, "Radau", rtol=RTOL, atol=ATOL,
                         jac=lambda t, y: jacobian(reference, y))
    if not solution.success:
        raise RuntimeError(f"the reference at t = {end:g} s: {solution.message}")
    return solution.y[:, -1]


# ---- The core against the project's reference trajectories (25 digits): auto at two steps, every method at five.

STEPS_S = (1e-4, 1e-3, 1e-2, 2.5e-2, 5e-2)
# Errors of ν of an earlier prototype: (case, step) → the error by each of its methods; None: the run diverged.
PROTOTYPES_METHODS = (EXPLICIT, STIFF, STIFF_4, EXACT_4)
PROTOTYPE: dict[tuple[str, float], tuple[float | None, ...]] = {
    ("omni3-free-periodic", 0.1): (3.9e-7, 2.0e-3, 1.4e-7, 7e-15),
    ("omni3-driven-stable", 0.1): (3.7e-7, 3.5e-6, 5.9e-10, 3.3e-10),
    ("mecanum4", 0.05): (3.8e-3, 5.6e-1, 2.5e-3, 6.4e-5),
    ("mecanum4-d10", 0.05): (4.0, 2.8e-2, 7.7e-4, 1.1e-2),
    ("mecanum4-d100", 0.05): (None, 3.9e-9, 1.7e-11, 4.8e-1),
    ("mecanum4-d1000", 0.05): (None, 5e-14, 7e-15, 6e-2),
}


def reference_file(name: str) -> Path | None:
    """A reference file of the project's tests."""
    return next(iter(sorted((SOURCE_DIR / "host_tests").rglob(name))), None)


def verified_rows(advance: Any = lambda: None) -> list[dict[str, Any]]:
    """Errors of every case, method and step; refusals with their reason."""
    path = reference_file("trajectories.json")
    if path is None:
        return []
    rows = []
    for case in read_reference(path):
        for method in METHODS:
            for step_s in STEPS_S:
                found = verify_case(load("double"), case, method, step_s, lambda: None)
                status = found.status.partition(":")[0]
                rows.append({"case": found.name, "method": method, "step_s": step_s, "status": status,
                             "error_nu": found.error_nu, "error_pose": found.error_pose,
                             "error_wheel": found.error_wheel})
        advance()
    return rows


def table_rows(advance: Any = lambda: None) -> list[dict[str, Any]]:
    """The prototype's table, case by case: absolute error of ν at the segments' ends."""
    cases: dict[str, Table] = {}
    for name in ("trajectories.json", "methods.json"):
        if (path := reference_file(name)) is not None:
            cases |= {case.text("name"): case for case in read_reference(path)}
    rows = []
    for (name, step_s), expected in PROTOTYPE.items():
        if name not in cases:
            continue
        size = max(1.0, *(abs(float(v)) for state in cases[name].tables("states") for v in state.texts("nu")))
        for method, prototype in zip(PROTOTYPES_METHODS, expected, strict=True):
            found = verify_case(load("double"), cases[name], method, step_s, lambda: None)
            error = None if found.error_nu is None else found.error_nu * size
            rows.append({"case": name, "step_s": step_s, "method": method, "prototype": prototype, "error_nu": error,
                         "status": found.status.partition(":")[0],
                         "as_good": beats(error, prototype)})
        advance()
    return rows


def beats(error: float | None, prototype: float | None) -> bool:
    """Reproduced (within the rounding of the printed digits, and of the last place) or better."""
    if error is None:
        return prototype is None or prototype >= 1.0  # refused where the prototype diverged or had no correct digit
    return prototype is None or error <= 1.1 * prototype + 2e-14 or math.isclose(error, prototype, rel_tol=0.1)
