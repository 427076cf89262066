"""A scene through the firmware node over CAN, in lockstep with raw frames."""

from __future__ import annotations

from collections.abc import Callable

from laconic.can.rig.buses import process_node
from laconic.can.rig.lockstep import run_lockstep
from laconic.scene import Scene
from laconic.tools.demo.rows import Rows


def node_rows(scene: Scene, steps: int, every: int = 1, moved: Callable[[int], None] = lambda _: None) -> Rows:
    """Rows of the node that runs as a process of its own, over SLCAN on a TCP socket."""
    with process_node(scene.run.real) as node:
        run = run_lockstep(node, scene, steps, every=every, moved=moved)
    return Rows("node", run.ticks, run.states, run.seconds)
