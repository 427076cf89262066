"""Emulated boards started again and again, on an idle machine and on one with every core busy: each start must load a
vehicle and, where it has lockstep, give the bits of the core."""

from __future__ import annotations

import os
import random
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from typing import Any

from laconic.errors import BadInput, LaconicError
from laconic.rig.boards import emulated_node, why_no_emulation
from laconic.rig.choices import BOARDS
from laconic.rig.lockstep import load_scene, run_lockstep, twin_states
from laconic.scene import read_scene

SCENES = ("kuka_youbot", "turtlebot3_burger", "s1")  # the first has the most parameters
METHOD = "rk4"                                       # every image contains it
STEPS = 20
BUSY = (sys.executable, "-c", "while True: pass")


def soak(minutes: float, seed: int, advance: Callable[[float], None]) -> dict[str, Any]:
    """All boards in turn until the time is up, every second round with all cores busy."""
    if reason := why_no_emulation():
        raise BadInput(f"soak boards: {reason}")
    source, starts, bad = random.Random(seed), Counter[str](), list[str]()
    began = last = time.monotonic()
    while time.monotonic() - began < 60.0 * minutes:
        for busy in (False, True):
            with busy_cores(os.cpu_count() or 1) if busy else ExitStack():
                for name in BOARDS:
                    failure = start(name, source.choice(SCENES))
                    starts[f"{name}, {'busy' if busy else 'idle'}"] += 1
                    bad += [f"{name}, {'busy' if busy else 'idle'}: {failure}"] if failure else []
                    now = time.monotonic()
                    advance(now - last)
                    last = now
    return {"passed": not bad, **starts, "bad": bad}


def start(name: str, scene_name: str) -> str | None:
    """Starts a board and runs a scene briefly; returns the error, or None."""
    scene = read_scene(scene_name).with_run(real=BOARDS[name].real, method=METHOD)
    try:
        with emulated_node(name) as node:
            if BOARDS[name].plays_only:
                load_scene(node, scene)
                return None
            run = run_lockstep(node, scene, STEPS)
        return None if run.states.tobytes() == twin_states(scene, run).tobytes() else "other bits than the core"
    except LaconicError as error:
        return str(error)


@contextmanager
def busy_cores(count: int) -> Iterator[None]:
    """Runs so many processes that only use processor time."""
    processes = [subprocess.Popen(BUSY) for _ in range(count)]
    try:
        yield
    finally:
        for process in processes:
            process.kill()
            process.wait()
