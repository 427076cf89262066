"""All scenes in lockstep on the virtual bus, compared with the bits of the core, repeatedly."""

from __future__ import annotations

import random
import time
from collections.abc import Callable
from typing import Any

from laconic.core import REALS
from laconic.paths import scene_names
from laconic.rig.boards import own_node
from laconic.rig.judge import judge_same_bits
from laconic.scene import read_scene

KIND = "virtual"
STEPS = 20_000


def soak(minutes: float, seed: int, advance: Callable[[float], None], kind: str = KIND) -> dict[str, Any]:
    """Scenes, scalar types and frames in random order until the time is up."""
    source, runs, steps, bad = random.Random(seed), 0, 0, []
    began = last = time.monotonic()
    while (now := time.monotonic()) - began < 60.0 * minutes:
        name, real, fd = source.choice(scene_names()), source.choice(REALS), source.choice((False, True))
        with own_node(kind, real) as node:
            judgement = judge_same_bits(node, read_scene(name).with_run(real=real), STEPS, every=20, fd=fd)
        runs, steps = runs + 1, steps + STEPS
        bad += [] if judgement.passed else [f"{name}, {real}, {'FD' if fd else 'classic'}"]
        advance(now - last)
        last = now
    return {"passed": not bad, "runs": runs, "steps": steps, "bad": bad}
