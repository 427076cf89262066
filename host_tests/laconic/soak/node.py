"""One node process for hours: lockstep with the core's bits and free runs at 1 kHz in turn, new vehicles all the time.

Its memory may not grow, no motion may be another than the core's, and its own checks of memory must stay silent."""

from __future__ import annotations

import math
import random
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from laconic.errors import BadInput
from laconic.paths import scene_names
from laconic.rig.boards import own_node
from laconic.rig.client import NodeClient
from laconic.rig.free_judge import judge_free_run
from laconic.rig.judge import judge_same_bits
from laconic.rig.verdict import Judgement
from laconic.scene import read_scene
from laconic.soak import StoppedEarly

OPTIONS = ("hours",)
LOCKSTEP_STEPS = 5_000
FREE_S, RATE_HZ = 20.0, 1000
MOST_GROWTH_KB = 1024
REAL = "double"


def length(hours: float = 24.0) -> float:
    """Seconds."""
    if not 0.0 < hours < float("inf"):
        raise BadInput(f"--hours {hours:g}: is not usable; give a finite number above zero")
    return 3600.0 * hours


def soak(minutes: float, seed: int, advance: Callable[[float], None], hours: float = 24.0) -> dict[str, Any]:
    """So many hours, whatever the minutes; Ctrl-C ends it with what was found until then."""
    source, end = random.Random(seed), time.monotonic() + length(hours)
    found: dict[str, Any] = {"seed": seed, "lockstep_runs": 0, "lockstep_steps": 0, "free_runs": 0, "free_s": 0.0,
                             "late_periods": 0, "bad": []}
    with own_node("process", REAL) as node:
        memory = [memory_kb()]
        try:
            while time.monotonic() < end:
                one_turn(node, source, found, advance, end)
                memory.append(memory_kb())
        except KeyboardInterrupt as stop:
            raise StoppedEarly(result_of(found, memory)) from stop
    return result_of(found, memory)


def one_turn(node: NodeClient, source: random.Random, found: dict[str, Any], advance: Callable[[float], None],
             end: float) -> None:
    """One vehicle in lockstep, then in free run as far as its step allows; at most until the end."""
    name, fd, began = source.choice(scene_names()), source.choice((False, True)), time.monotonic()
    scene = read_scene(name).with_run(real=REAL)
    note(found, f"{name}, lockstep", judge_same_bits(node, scene, LOCKSTEP_STEPS, every=20, fd=fd))
    found["lockstep_runs"] += 1
    found["lockstep_steps"] += LOCKSTEP_STEPS
    advance(time.monotonic() - began)
    left_s = float(min(FREE_S, math.floor(end - time.monotonic())))  # a whole number of steps
    if left_s < 1.0:
        return
    free = read_scene("turtlebot3_burger").with_run(step_s=1.0 / RATE_HZ, duration_s=left_s, real=REAL)
    judgement = judge_free_run(node, free, left_s, RATE_HZ, 200, {}, moved=lambda _: None)
    note(found, "free run", judgement)
    found["free_runs"] += 1
    found["free_s"] += left_s
    found["late_periods"] += judgement.figures.get("late_periods", 0)
    advance(left_s)


def note(found: dict[str, Any], what: str, judgement: Judgement) -> None:
    """Failed verdicts, but lateness, which is the machine's."""
    wrong = [f"{each.name}: {each.detail}" for each in judgement.verdicts
             if not each.passed and each.name not in ("punctuality", "clock", "envelope")]
    found["bad"] += [f"{what}: {text}" for text in wrong]


def memory_kb() -> int:
    """Resident memory of the youngest child of this process that is a node; 0 where the system does not tell."""
    for process in sorted(Path("/proc").glob("[0-9]*"), key=lambda each: -int(each.name)):
        try:
            if "laconic-node" in (process / "cmdline").read_text(encoding="utf-8", errors="replace").split("\0")[0]:
                status = (process / "status").read_text(encoding="utf-8")
                return int(status.split("VmRSS:")[1].split()[0])
        except (OSError, IndexError):
            continue
    return 0


def result_of(found: dict[str, Any], memory: list[int]) -> dict[str, Any]:
    """Passed where nothing was wrong and the memory did not grow after its first turn."""
    growth = memory[-1] - memory[min(1, len(memory) - 1)]
    return {"passed": not found["bad"] and growth <= MOST_GROWTH_KB, **found, "memory_kB": memory[-1],
            "grown_by_kB": growth}
