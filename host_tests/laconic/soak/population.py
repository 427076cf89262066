"""Made-up vehicles, six kinds of wheels, damping from usual to a million times that, beside their true motion: errors
of `auto`, of chosen methods and of exponential-kahan-4 at 1 ms and 10 ms, and what error estimates are of them.

What is done stays in the folder of --out, and the next run goes on after it.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

from laconic.core import REALS, load
from laconic.errors import BadInput, nearest_of
from laconic.outputs import write_text
from laconic.paths import results_dir
from laconic.population.made import made
from laconic.population.measure import STEPS_S, Row, rows_of
from laconic.population.store import About, Store, core_digest
from laconic.population.summary import by_truth, groups_of, name_of, summary_of, text_of, worst_of, wrong_estimates
from laconic.population.worst_scene import scene_text
from laconic.scene import METHODS
from laconic.soak import StoppedEarly

OPTIONS = ("vehicles", "method", "real", "out")
SEED = 1
VEHICLES, REAL = 2000, "double"
AUTO, BESIDE = "auto", "exponential-kahan-4"  # measured whatever others --method names
LARGEST = {"double": {(AUTO, 0.001): 1e-12, (AUTO, 0.01): 1e-8},
           "single": {(AUTO, 0.001): 1e-3, (AUTO, 0.01): 1e-3}}
MOST_WRONG = 20
NEVER_WORSE = {"double": 1e-12, "single": 1e-3}  # than BESIDE's error, but for this


def length(vehicles: int = VEHICLES, method: str = BESIDE, real: str = REAL, out: Path | None = None) -> float:
    """One for each vehicle."""
    for each in method.split(","):
        if each not in METHODS:
            raise BadInput(f"--method {method}: there is no method {each!r}; {nearest_of(each, METHODS)}")
    if real not in REALS:
        raise BadInput(f"--real {real}: there is no such scalar type; {nearest_of(real, REALS)}")
    return float(vehicles)


def soak(minutes: float, seed: int, advance: Callable[[float], None], vehicles: int = VEHICLES, method: str = BESIDE,
         real: str = REAL, out: Path | None = None) -> dict[str, Any]:
    """All vehicles, whatever `minutes`; passed when nothing is refused by `auto`, no error is too large, and estimates
    are near their errors."""
    folder = out or results_dir("population")
    methods = tuple(dict.fromkeys((AUTO, *method.split(","), BESIDE)))
    store = Store(folder, About(seed, vehicles, methods, real, core_digest(real)))
    advance(len(store.done))
    try:
        for number in range(len(store.done), vehicles):
            store.keep(rows_of(made(seed, number, vehicles, real), methods))
            advance(1)
    except BaseException as stop:
        raise StoppedEarly(result_of(store)) from stop
    return result_of(store)


def result_of(store: Store) -> dict[str, Any]:
    """What the rows tell, also as summary.json beside them, and the scenes of the worst vehicles."""
    folder, about = store.path.parent, store.about
    groups = groups_of([row for each in store.done for row in each])
    told = {name_of(*which): summary_of(rows) | {"by truth": by_truth(rows)} for which, rows in groups.items()}
    wrong = [f"{name}: {each}" for name, summary in told.items() for each in wrong_estimates(summary)]
    wrong += wrong_of(groups, about.real)
    scenes = [save_worst(store, *which, told[name_of(*which)]["worst vehicle"]) for which in groups]
    write_text(folder / "summary.json", json.dumps({**asdict(about), "done": len(store.done), **told}, indent=1) + "\n")
    return {"passed": not wrong, "seed": about.seed, "vehicles": f"{len(store.done)} of {about.vehicles}",
            **{name: text_of(each) for name, each in told.items()}, "wrong": wrong[:MOST_WRONG],
            "worst scenes": scenes, "rows": str(store.path)}


def wrong_of(groups: dict[tuple[str, float], list[Row]], real: str) -> list[str]:
    """What errors must not be, in words."""
    found = []
    for (name, step_s), rows in groups.items():
        for row in rows:
            if not worst_of(row) <= LARGEST[real].get((name, step_s), math.inf):
                found.append(f"vehicle {row['number']}, {name_of(name, step_s)}: {row['status']}, {worst_of(row):.1e}")
    for step_s in STEPS_S:
        for ours, others in zip(groups.get((AUTO, step_s), ()), groups.get((BESIDE, step_s), ()), strict=False):
            if not worst_of(ours) <= max(worst_of(others), NEVER_WORSE[real]):
                found.append(f"vehicle {ours['number']}, {name_of(AUTO, step_s)}: worse than {BESIDE}")
    return found


def save_worst(store: Store, method: str, step_s: float, number: int) -> str:
    """The scene of the vehicle with the largest error."""
    vehicle = made(store.about.seed, number, store.about.vehicles, store.about.real)
    start = vehicle.plant(load(store.about.real), "auto", step_s).nu
    path = store.path.parent / f"worst-{method}-{step_s * 1e3:g}ms.toml"
    write_text(path, scene_text(vehicle, start, method, step_s))
    return str(path)
