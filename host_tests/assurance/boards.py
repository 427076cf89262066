"""Emulated boards started again and again, on an idle machine and on one with every core busy: each start must load a
vehicle and, where it has lockstep, give the bits of the core.

    boards [--runs N] [--seed S]"""

from __future__ import annotations

import argparse
import os
import random
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from assurance.common import Unusable
from laconic.can.rig.boards import emulated_node, why_no_emulation
from laconic.can.rig.choices import BOARDS
from laconic.can.rig.lockstep import load_scene, run_lockstep, twin_states
from laconic.errors import LaconicError
from laconic.scene import read_scene

SCENES = ("kuka_youbot", "turtlebot3_burger", "s1")  # the first has the most parameters
METHOD = "rk4"                                       # every image contains it
STEPS = 20


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
    processes = [subprocess.Popen((sys.executable, "-c", "while True: pass")) for _ in range(count)]
    try:
        yield
    finally:
        for process in processes:
            process.kill()
            process.wait()


def arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--runs", type=int, default=100, metavar="N", help="starts in all, 100 by default")
    parser.add_argument("--seed", type=int, default=1)


def run(options: argparse.Namespace) -> bool:
    """All boards in turn, every second round with all cores busy."""
    if reason := why_no_emulation():
        raise Unusable(reason)
    source, bad, done = random.Random(options.seed), list[str](), 0
    while done < options.runs:
        busy = done // len(BOARDS) % 2 * (os.cpu_count() or 1)
        with busy_cores(busy):
            for name in list(BOARDS)[:options.runs - done]:
                failure = start(name, source.choice(SCENES))
                bad += [f"{name}, {'busy' if busy else 'idle'}: {failure}"] if failure else []
                done += 1
    print(f"{done} starts, {len(bad)} failed", *bad, sep="\n  ")
    return not bad
