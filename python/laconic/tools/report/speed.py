"""S1 against integrators of other projects, in one interleaved run."""

from __future__ import annotations

import ctypes
import time
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from laconic.scene import METHODS, Scene
from laconic.tools.report import peers
from laconic.tools.report.accuracy import Truth, fits, follow
from laconic.tools.report.counting import cachegrind_present, host_instructions
from laconic.tools.report.workshop import Variant, Workshop
from laconic.tools.verify.reference import reference_states

# ---- Wall-clock figures: thread CPU time, minimum over repetitions, all sides interleaved in one run.

Contestant = Callable[[], float]
Key = TypeVar("Key")


def race(contestants: Mapping[Key, Contestant], repetitions: int) -> dict[Key, float]:
    """Least seconds of each: every round runs all of them once, so a slow moment of the machine hits all."""
    best = dict.fromkeys(contestants, float("inf"))
    for _ in range(repetitions):
        for name, run in contestants.items():
            best[name] = min(best[name], run())
    return best


def bench_contestant(library: Path, steps: int) -> Contestant:
    """Seconds for `steps` steps of a bench library (workshop.host_library)."""
    bench = ctypes.CDLL(str(library))
    bench.bench_run.argtypes, bench.bench_run.restype = [ctypes.c_uint32], ctypes.c_int
    bench.bench_reset()

    def run() -> float:
        start = time.thread_time_ns()
        status = bench.bench_run(steps)
        seconds = (time.thread_time_ns() - start) * 1e-9
        if status != 0:
            raise RuntimeError(f"{library.name}: a step was refused (status {status})")
        return seconds

    return run


STEP_S, RACE_STEPS, ROUNDS = 0.01, 20_000, 60
LADDER_S = tuple(0.5 / n for n in (500, 250, 100, 50, 40, 32, 25, 20, 16, 12, 10, 8, 7, 6, 5, 4, 3, 2))
TOLERANCES = tuple(10.0**-k for k in range(2, 12))
WANTED_ERROR = 1e-6


def step_rows(workshop: Workshop, scene: Scene, folder: Path, rounds: int = ROUNDS) -> list[dict[str, Any]]:
    """ns and instructions a step of every method, whole and trimmed, beside CasADi's RK4."""
    variants = _variants(scene, "whole", "trimmed")
    contestants = _contestants(workshop, variants)
    programs = {key: workshop.host_program(variant) for key, variant in variants.items()}
    if "casadi" not in peers.missing_peers():
        casadi = peers.CasadiRk4(peers.course_of(scene.with_run(step_s=STEP_S)), round(1.0 / STEP_S), folder / "casadi")
        contestants["CasADi RK4", "double", "generated"] = lambda: casadi.run(RACE_STEPS)
        programs["CasADi RK4", "double", "generated"] = casadi.program()
    best = race(contestants, rounds)
    base = best.get(("CasADi RK4", "double", "generated"))
    counted = cachegrind_present()
    return [{"who": who, "real": real, "build": build, "ns_per_step": seconds / RACE_STEPS * 1e9,
             "ratio": seconds / base if base else None,
             "instructions": round(host_instructions(programs[who, real, build]), 1) if counted else None}
            for (who, real, build), seconds in best.items()]


def _variants(scene: Scene, *builds: str) -> dict[tuple[str, str, str], Variant]:
    fixed = scene.with_run(step_s=STEP_S)
    return {(method, real, build): Variant(fixed.with_run(method=method), real, "-O2", build == "trimmed")
            for method in METHODS[1:] for real in ("double", "single") for build in builds}


def _contestants(workshop: Workshop, variants: dict[tuple[str, str, str], Variant]) -> dict[Any, Contestant]:
    return {key: bench_contestant(workshop.host_library(variant), RACE_STEPS) for key, variant in variants.items()}


def precision_rows(workshop: Workshop, scene: Scene, folder: Path, rounds: int = ROUNDS) -> list[dict[str, Any]]:
    """Whole run of S1: error of ν at the ends of the voltage's half periods, against milliseconds of run time."""
    ends = np.cumsum(peers.course_of(scene).durations_s)
    truth = Truth(ends, reference_states(scene, ends))
    steps = _contestants(workshop, _variants(scene, "whole"))
    runs: dict[Any, Contestant] = {}
    found: dict[tuple[str, float], peers.Solution] = {}
    for name, run in _solvers(scene, folder).items():
        for rtol in TOLERANCES:
            slow = name.startswith("SciPy")
            if slow and rtol not in TOLERANCES[2::3]:
                continue
            found[name, rtol] = run(rtol)
            runs[name, rtol] = partial(_seconds, run, rtol)
    quick = {key: run for key, run in runs.items() if found[key].seconds < 0.02}
    best = race(steps | quick, rounds) | {key: found[key].seconds for key in runs if key not in quick}
    rows = [row for method, real, build in steps
            for row in _core_rows(scene, method, real, best[method, real, build] / RACE_STEPS, truth)]
    for (name, rtol), solution in found.items():
        error = float(np.max(np.abs(solution.states[:, :3] - truth.states[:, :3])))
        rows.append({"who": name, "real": "double", "setting": rtol, "error_nu": error, "ms": best[name, rtol] * 1e3})
    return rows


def _seconds(run: Callable[[float], peers.Solution], rtol: float) -> float:
    return run(rtol).seconds


def _core_rows(scene: Scene, method: str, real: str, seconds_per_step: float, truth: Truth) -> list[dict[str, Any]]:
    """A step of any size takes as long as one of STEP_S."""
    rows = []
    for step_s in LADDER_S:
        run = scene.with_run(method=method, step_s=step_s)
        if fits(run, truth):
            error = float(np.max(np.abs(follow(run, real, truth.at_s)[:, :3] - truth.states[:, :3])))
            rows.append({"who": method, "real": real, "setting": step_s, "error_nu": error,
                         "ms": seconds_per_step * 1e3 * scene.run.duration_s / step_s})
    return rows


def _solvers(scene: Scene, folder: Path) -> dict[str, Callable[[float], peers.Solution]]:
    course, missing = peers.course_of(scene), peers.missing_peers()
    found: dict[str, Callable[[float], peers.Solution]] = {}
    if not any("CVODE" in name for name in missing):
        cvode = peers.cvode_runner(course, folder / "cvode")
        found["CVODE Adams"] = lambda rtol: cvode(False, rtol)
        found["CVODE BDF"] = lambda rtol: cvode(True, rtol)
    if "numbalsoda" not in missing:
        found["DOP853 compiled, C right-hand side"] = peers.dop853_runner(course, folder / "dop853", True)
        found["DOP853 compiled, numba right-hand side"] = peers.dop853_runner(course, folder / "dop853", False)
    return found | {f"SciPy {solver}": peers.scipy_runner(course, solver) for solver in ("DOP853", "Radau")}


def cheapest(rows: list[dict[str, Any]], who: Callable[[str], bool],
             error: float = WANTED_ERROR) -> dict[str, Any] | None:
    """The quickest run of some contestants that is accurate enough."""
    good = [row for row in rows if who(row["who"]) and row["error_nu"] <= error]
    return min(good, key=lambda row: row["ms"], default=None)
