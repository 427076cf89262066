"""The node process in free run at 1 kHz: no step may be lost; the worst lateness is reported."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from laconic.rig.boards import own_node
from laconic.rig.free_judge import judge_free_run
from laconic.scene import read_scene

SCENE = "turtlebot3_burger"
RATE_HZ = 1000


def soak(minutes: float, seed: int, advance: Callable[[float], None]) -> dict[str, Any]:
    """One long run; the seed has no effect."""
    scene = read_scene(SCENE).with_run(step_s=1.0 / RATE_HZ, duration_s=60.0 * minutes)
    with own_node("process", scene.run.real) as node:
        judgement = judge_free_run(node, scene, 60.0 * minutes, RATE_HZ, 200, {}, moved=advance)
    steps = [each for each in judgement.verdicts if each.name in ("steps", "clock")]
    return {"passed": judgement.passed, **{each.name: each.detail for each in steps}, **judgement.figures,
            "failed": [f"{each.name}: {each.detail}" for each in judgement.verdicts if not each.passed]}
