"""The core's solver of a friction step from Python, through plain arrays: core_c/tests/friction/friction_probe.c."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from functools import cache

import numpy as np

from laconic.base.paths import library
from references.friction.problem import StepProblem

COLUMNS = ("rim_along", "rim_across", "inertia", "drag", "grip", "axle", "drive", "drive_slope", "drive_limit",
           "viscous", "free_speed")


@dataclass
class CoreSolution:
    """What the core found; passes is 0 where it refused, and then the rest means nothing."""

    z: np.ndarray               # (ν, s)
    slip_impulse: np.ndarray    # N × 2, along the slip
    passes: int


@cache
def _library(real: str) -> ctypes.CDLL:
    loaded = ctypes.CDLL(str(library(f"friction_probe_{real}")))
    loaded.friction_probe.restype = ctypes.c_int32
    return loaded


def solve_in_core(problem: StepProblem, real: str = "double", *, nu: np.ndarray | None = None,
                  speed: np.ndarray | None = None, impulse: np.ndarray | None = None) -> CoreSolution:
    """Cold, where no guess is given: from the free motion, without impulses."""
    number = np.float64 if real == "double" else np.float32
    count = problem.wheels
    with np.errstate(over="ignore"):
        rows = np.column_stack([problem.along, problem.across, *(getattr(problem, name) for name in COLUMNS)])
        data, free = np.ascontiguousarray(rows, number), problem.free_nu.astype(number)
    z_nu = np.array(problem.free_nu if nu is None else nu, number)
    z_speed = np.array(problem.free_speed if speed is None else speed, number)
    p = np.zeros((count, 2), number) if impulse is None else np.array(impulse, number)
    passes = _library(real).friction_probe(
        count, *(ctypes.c_void_p(array.ctypes.data) for array in (data, free, z_nu, z_speed, p)))
    return CoreSolution(np.concatenate([z_nu, z_speed]).astype(float), p.astype(float), int(passes))
