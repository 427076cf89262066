"""One run of `laconic rig` from the open bus to the node at rest, however it ends."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from laconic.progress import progress_bar
from laconic.rig.client import NodeClient
from laconic.rig.errors import BusDied, CannotReach, Interrupted, NodeRefused, NodeSilent
from laconic.rig.free_judge import judge_free_run
from laconic.rig.interruption import Interruption
from laconic.rig.judge import judge_same_bits, judge_scaled
from laconic.rig.live import live_view
from laconic.rig.logs import logged
from laconic.rig.options import Options, node_for, read_id_base
from laconic.rig.scaled import read_tolerances
from laconic.rig.stopping import RUNNING, come_to_rest, stop_running
from laconic.rig.verdict import Judgement
from laconic.scene import Scene

Moved = Callable[[float], None]


def run(scene: Scene, options: Options) -> Judgement:
    """One run against a node. What ends it early, a signal included, is a verdict beside those about all that came
    before; the log is complete, and the node is at rest where it can be reached."""
    limits, base = read_tolerances(options.tolerances, scene), read_id_base(options.id_base, scene)
    with (Interruption() as told, node_for(options, scene.run.real, base) as node, logged(node.link, options.logs),
          shown(node, scene, options) as moved):
        node.link.listeners.append(told.check)  # behind the logs: a frame that is seen is logged first
        judgement, notes = None, []
        try:
            found = reach(node)
            if found in RUNNING:
                notes.append(f"the node was found in state {found} and has been stopped before the run")
            judgement = judge(node, scene, options, limits, moved)
        except Interrupted as ending:  # before the first step
            judgement = Judgement(scene.name, options.mode)
            judgement.ended(ending, 0, options.steps or scene.steps())
        finally:
            if judgement is None or judgement.ending is not None:
                with told.shielded():
                    notes += after_early_end(node)
        judgement.notes += notes
        return judgement


def after_early_end(node: NodeClient) -> list[str]:
    """Stops the node; what there is to say about it."""
    failure = come_to_rest(node)
    state = "is at rest" if failure is None else f"could not be stopped ({failure}): try laconic rig --stop"
    return [f"the node {state}", f"faulty frames: {dict(node.link.faults) or 'none'}"]


def reach(node: NodeClient) -> str:
    """Finds the node and stops it where it runs; the state it was found in. CannotReach when nobody is there."""
    try:
        return stop_running(node)
    except (BusDied, NodeSilent, NodeRefused) as error:
        raise CannotReach(f"no node could be reached: {error}") from None


@contextmanager
def shown(node: NodeClient, scene: Scene, options: Options) -> Iterator[Moved]:
    """The live view, or a bar."""
    steps = options.steps or scene.steps()
    bar = live_view(node.link, scene.name, steps) if options.live else progress_bar(scene.name, steps)
    with bar as moved:
        yield moved


def judge(node: NodeClient, scene: Scene, options: Options, limits: dict[str, float], moved: Moved) -> Judgement:
    """One run in the chosen mode."""
    if options.mode == "free-run":
        duration_s = options.steps * scene.run.step_s if options.steps else scene.run.duration_s
        return judge_free_run(node, scene, duration_s, options.rate or 0, options.watchdog, limits,
                              moved=lambda seconds: moved(seconds / scene.run.step_s))
    if options.mode == "same-bits":
        return judge_same_bits(node, scene, options.steps, every=options.every, fd=options.fd, moved=moved)
    return judge_scaled(node, scene, options.steps, limits, moved)
