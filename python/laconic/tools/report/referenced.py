"""The core against the project's reference trajectories (25 digits): auto at two steps, every method at five."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from laconic.base.paths import SOURCE_DIR
from laconic.core import load
from laconic.scene import METHODS
from laconic.scene.methods import EXACT_4, EXPLICIT, STIFF, STIFF_4
from laconic.scene.table import Table
from laconic.tools.verify.trajectories import read_reference, verify_case

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
