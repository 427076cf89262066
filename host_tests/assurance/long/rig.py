"""All scenes in lockstep on the virtual bus and over SLCAN to a process, each with the bits of the core."""

from __future__ import annotations

import random

from assurance.common import Clock
from laconic.can.rig.boards import own_node
from laconic.can.rig.judge import judge_same_bits
from laconic.core import REALS
from laconic.scene import read_scene, rigid_scene_names

STEPS = 10_000


def run(clock: Clock, seed: int) -> list[str]:
    """Scenes, scalar types, frames and lines in random order."""
    source, bad, done = random.Random(seed), list[str](), 0
    while done == 0 or clock:
        name, real = source.choice(rigid_scene_names()), source.choice(REALS)
        fd, kind = source.choice((False, True)), source.choice(("virtual", "process"))
        with own_node(kind, real) as node:
            judgement = judge_same_bits(node, read_scene(name).with_run(real=real), STEPS, every=20, fd=fd)
        done += 1
        bad += [] if judgement.passed else [f"{name}, {real}, {kind}, {'FD' if fd else 'classic'}"]
    print(f"  {done} runs of {STEPS} steps")
    return bad
