"""Wall-clock figures: thread CPU time, minimum over repetitions, all sides interleaved in one run."""

from __future__ import annotations

import ctypes
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TypeVar

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
