"""A thousand million steps of motions whose end is known in closed form: rest, straight lines, a spin, circles, free
motion with petals. Heading and place after 10³, 10⁴ … steps, in both scalar types."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from laconic.errors import BadInput, nearest_of
from laconic.outputs import make_folder
from laconic.paths import results_dir
from laconic.scene import METHODS
from laconic.soak import StoppedEarly
from laconic.soak._long.cases import CASES
from laconic.soak._long.measure import Row
from laconic.soak._long.run import LongRun

OPTIONS = ("steps", "method", "out")
SEED = 1  # nothing is drawn
STEPS = 10**9
USUAL_METHODS, REALS = ("auto", "rk4"), ("double", "single")
LARGEST_ULP = 16.0  # of heading and place, in units of rounding of what they have come to;
FREE_ULP = 100.0    # where ζ itself turns, which amplifies the rounding of its start in a period,
MOVED_ULP = 2e-4    # and for each step what it changes of ζ, which it rounds: so much of the speed, all one way;
STANDING_M = 1e-12  # and of place what a method's own error at 1 ms holds a motion off by, however long it lasts
STEADY = {case.name for case in CASES if case.steady}


def runs_of(method: str | None) -> list[tuple[str, str]]:
    """Methods and scalar types."""
    if method is not None and method not in METHODS:
        raise BadInput(f"--method {method}: there is no such method; {nearest_of(method, METHODS)}")
    return [(name, real) for real in REALS for name in ((method,) if method else USUAL_METHODS)]


def length(steps: int = STEPS, method: str | None = None, out: Path | None = None) -> float:
    """Steps of all runs, in millions."""
    return len(runs_of(method)) * steps / 1e6


def soak(minutes: float, seed: int, advance: Callable[[float], None], steps: int = STEPS, method: str | None = None,
         out: Path | None = None) -> dict[str, Any]:
    """Each method in each scalar type, whatever `minutes` and `seed`; passed when no heading or place drifts."""
    folder = out or results_dir("long")
    make_folder(folder)
    done: list[LongRun] = []
    try:
        for name, real in runs_of(method):
            done.append(LongRun(name, real, folder))
            advance(min(done[-1].done, steps) / 1e6)
            done[-1].run(steps, lambda piece: advance(piece / 1e6))
    except KeyboardInterrupt as stop:
        raise StoppedEarly(result_of(done, steps)) from stop
    return result_of(done, steps)


def result_of(done: list[LongRun], steps: int) -> dict[str, Any]:
    """The last row of each case, in words."""
    told: dict[str, str] = {}
    wrong = []
    for run in done:
        for row in last_rows(run.rows, steps):
            name = f"{row['case']}, {run.method}, {run.real}"
            told[name] = text_of(row)
            wrong += [name] if row["status"] or drifted(row) else []
    return {"passed": not wrong, **told, "drifted": wrong, "rows": str(done[0].path.parent) if done else "none"}


def last_rows(rows: list[Row], steps: int) -> list[Row]:
    """Of each case, the one after most steps."""
    return list({row["case"]: row for row in sorted(rows, key=lambda row: row["steps"])
                 if row["steps"] <= steps}.values())


def drifted(row: Row) -> bool:
    """Whether heading or place is further off than so many roundings of the heading, and of how far ν would lead."""
    unit = float(np.finfo(np.float64 if row["real"] == "double" else np.float32).eps) / 2
    free = 0.0 if row["case"] in STEADY else FREE_ULP + MOVED_ULP * row["steps"]
    allowed = (LARGEST_ULP + free) * unit
    return not (row["heading_relative"] <= allowed and row["place_error_m"] <= allowed * row["reach_m"] + STANDING_M)


def text_of(row: Row) -> str:
    return (f"{row['steps']:.0e} steps, {row['turns']:.3g} turns, {row['path_m']:.3g} m: heading off by "
            f"{row['heading_error_rad']:.1e} rad ({row['heading_relative']:.1e} of it), place by "
            f"{row['place_error_m']:.1e} m ({row['place_relative']:.1e} of the path), of that not along the path "
            f"{row['aside_m']:.1e} m")
