"""The race: the core's batch, the core alone and other programs in turn, in one process on one core.

Energy that the processor took, where the system lets it be read: Linux's powercap counters (RAPL).
"""

from __future__ import annotations

import importlib.util
import os
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from laconic.base.progress import progress_bar
from laconic.scene import read_scene
from laconic.tools.report.many.jax_lanes import jax_run
from laconic.tools.report.many.mujoco_base import mujoco_run
from laconic.tools.report.many.numba_loop import numba_runs
from laconic.tools.report.many.task import AGREEMENT, Task, core_batch, core_states, difference, equations_of

COUNTERS = Path("/sys/class/powercap")
UNREADABLE = ("energy: no counter of /sys/class/powercap can be read here; on Linux with RAPL, as root or with read "
              "permission on energy_uj, the table has a column of it")


class EnergyCounter:
    """The packages' counters together; `joules` between two readings, across one wrap of each."""

    def __init__(self, folder: Path = COUNTERS):
        self._counters = [path for path in sorted(folder.glob("*:*")) if path.name.count(":") == 1 and _read(path)]

    @property
    def is_readable(self) -> bool:
        """Whether there is one."""
        return bool(self._counters)

    def reading(self) -> list[tuple[int, int]]:
        """(µJ, range) of each."""
        return [found for path in self._counters if (found := _read(path))]

    @staticmethod
    def joules(before: list[tuple[int, int]], after: list[tuple[int, int]]) -> float:
        """Between two readings."""
        return sum((b - a) % size for (a, _), (b, size) in zip(before, after, strict=True)) * 1e-6


def _read(path: Path) -> tuple[int, int] | None:
    try:
        return int((path / "energy_uj").read_text()), int((path / "max_energy_range_uj").read_text()) + 1
    except (OSError, ValueError):
        return None


SCENE, STEP_S, STEPS = "robotino2", 1e-3, 100
CHECK_STEP_S = 1e-4  # at which the textbook's pose and the core's formula of it differ by less than AGREEMENT
MUJOCO_LANES, MUJOCO_SLIP = 10, 0.02  # of the largest velocity: that its contacts give way
BATCH, ALONE = "core, batch", "core, one by one"
REALS = ("double", "single")
PEERS = ("numba", "jax", "mujoco")


@dataclass(frozen=True)
class Contestant:
    """A run of so many vehicle-steps."""

    who: str
    real: str
    run: Callable[[], object]
    vehicle_steps: int


class Disagreement(RuntimeError):
    """A contestant that computes something else."""


def missing_peers() -> list[str]:
    """Names of what is not installed here."""
    return [name for name in PEERS if importlib.util.find_spec(name) is None]


def stay_on_one_core() -> None:
    """This process and the threads that it starts from here on, where the system can be told."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})


def task_of(lanes: int, step_s: float = STEP_S) -> Task:
    """Robotino 2."""
    return Task(read_scene(SCENE), lanes, STEPS, step_s)


def rows(lanes: int = 1000, rounds: int = 15) -> list[dict[str, Any]]:
    """One for each contestant: vehicle-steps a second, ratios to the core's batch and to the core alone, energy.

    Raises Disagreement for a peer that does not compute what the core does; then nothing is timed.
    """
    with progress_bar("race", len(REALS) + rounds) as advance:
        contestants = []
        for real in REALS:
            advance(0, f"compiling and checking, {real}")
            check(real)
            contestants += contestants_of(task_of(lanes), real)
            advance()
        advance(0, "racing")
        return _race(contestants, rounds, advance)


def contestants_of(task: Task, real: str) -> list[Contestant]:
    """The core's two, and those peers that are installed."""
    many, alone, missing = core_batch(task, real), core_batch(task, real, width_bytes=1), missing_peers()
    steps = task.lanes * task.steps
    found = [Contestant(BATCH, real, lambda: many.run(task.steps), steps),
             Contestant(ALONE, real, lambda: alone.run(task.steps), steps)]
    if "numba" not in missing:
        found += [Contestant(name, real, run, steps) for name, (run, _) in numba_runs(task, real).items()]
    if "jax" not in missing:
        found.append(Contestant("JAX, vmap and jit", real, jax_run(task, real)[0], steps))
    if "mujoco" not in missing and real == "double":
        few = task_of(min(MUJOCO_LANES, task.lanes))
        found.append(Contestant("MuJoCo, with contacts", real, mujoco_run(few)[0], few.lanes * few.steps))
    return found


def check(real: str, lanes: int = 16) -> None:
    """All agree with the core over STEPS steps, or Disagreement tells who does not."""
    task, missing = task_of(lanes, CHECK_STEP_S), missing_peers()
    batch = core_batch(task, real)
    batch.run(task.steps)
    wanted = core_states(task, batch)
    runs = numba_runs(task, real) if "numba" not in missing else {}
    if "jax" not in missing:
        runs["JAX"] = jax_run(task, real)
    for name, (run, states) in runs.items():
        run()
        if not (apart := difference(states(), wanted)) <= AGREEMENT[real]:
            raise Disagreement(f"{name}, {real}: differs from the core by {apart:.1e} after {task.steps} steps")
    if "mujoco" not in missing and real == "double":
        check_mujoco()


def check_mujoco(runs: int = 8) -> None:
    """Its carriage reaches the core's velocities but for what its contacts give way."""
    task = task_of(4)
    batch, (run, velocities), e = core_batch(task, "double"), mujoco_run(task), equations_of(task, np.float64)
    for _ in range(runs):
        run()
        batch.run(task.steps)
    nu = batch.nu_rad_per_s
    wanted = np.vstack([nu[:2] * e.radius_m, nu[2:] / e.yaw_scale])
    apart = float(np.max(np.abs(velocities() - wanted)) / np.max(np.abs(wanted)))
    if not apart <= MUJOCO_SLIP:
        raise Disagreement(f"MuJoCo: its velocities differ from the core's by {apart:.1e}")


def _race(contestants: list[Contestant], rounds: int, advance: Callable[..., None]) -> list[dict[str, Any]]:
    """CPU time of the process, so that threads of a contestant count, too; the least of each, all in turn."""
    counter = EnergyCounter()
    seconds, joules = [float("inf")] * len(contestants), [float("inf")] * len(contestants)
    for _ in range(rounds):
        for k, each in enumerate(contestants):
            before, start = counter.reading(), time.process_time_ns()
            each.run()
            seconds[k] = min(seconds[k], (time.process_time_ns() - start) * 1e-9)
            joules[k] = min(joules[k], counter.joules(before, counter.reading()))
        advance()
    ns = {(each.who, each.real): s / each.vehicle_steps * 1e9 for each, s in zip(contestants, seconds, strict=True)}
    return [{"who": each.who, "real": each.real, "million_steps_per_s": 1e3 / ns[each.who, each.real],
             "ns_per_step": ns[each.who, each.real],
             "times_batch": ns[each.who, each.real] / ns[BATCH, each.real],
             "times_alone": ns[each.who, each.real] / ns[ALONE, each.real],
             "nJ_per_step": j / each.vehicle_steps * 1e9 if counter.is_readable else None}
            for each, j in zip(contestants, joules, strict=True)]
