"""One run of `laconic rig` from the open bus to the node at rest, however it ends."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from laconic.base.progress import progress_bar
from laconic.can.rig.bagged import viewed
from laconic.can.rig.client import RUNNING, NodeClient, come_to_rest, is_estimated, read_estimate, stop_running
from laconic.can.rig.errors import Interrupted, Interruption
from laconic.can.rig.free_judge import Free
from laconic.can.rig.judge import SameBits, Scaled
from laconic.can.rig.live import live_view
from laconic.can.rig.logs import Lost, logged
from laconic.can.rig.options import Options, node_for, read_id_base
from laconic.can.rig.scaled import read_tolerances
from laconic.can.rig.verdict import Judgement, Moved, Trial, Verdict
from laconic.scene import Scene


def run(scene: Scene, options: Options) -> Judgement:
    """One run against a node. What ends it early, a signal included, is a verdict beside those about all that came
    before, and so is a log that takes no more bytes; the log is complete otherwise, and the node is at rest where it
    can be reached."""
    limits, base = read_tolerances(options.tolerances, scene), read_id_base(options.id_base, scene)
    lost = Lost()
    with (Interruption() as signals, node_for(options, scene.run.real, base) as node,
          logged(node.link, options.logs, lost),
          viewed(node.link, scene, base, options.mode, options.recorded), shown(node, scene, options) as moved):
        node.link.may_go_on = signals.check  # between frames, so that no frame and no log entry is cut in two
        trial, notes, is_over = trial_of(node, scene, options, limits), [], False
        estimate: dict[str, float] = {}
        try:
            found = stop_running(node)
            if found in RUNNING:
                notes.append(f"the node was found in state {found} and has been stopped before the run")
            trial.drive(moved)
            is_over = trial.ending is None
            estimate = read_estimate(node) if is_over and is_estimated(scene) else {}
        except Interrupted as ending:  # before the first step
            trial.ending = ending
        finally:
            if not is_over:
                with signals.shielded():
                    notes += after_early_end(node)
    judgement = trial.judge()
    judgement.add(*(Verdict("log", False, f"{why}; what was judged does not depend on it") for why in lost.values()))
    judgement.notes += notes
    judgement.figures |= estimate
    return judgement


def trial_of(node: NodeClient, scene: Scene, options: Options, limits: dict[str, float]) -> Trial:
    """A run in the chosen mode."""
    if options.mode == "free-run":
        duration_s = options.steps * scene.run.step_s if options.steps else scene.run.duration_s
        return Free(node, scene, duration_s, options.rate or 0, options.watchdog, limits)
    if options.mode == "same-bits":
        return SameBits(node, scene, options.steps, every=options.every, fd=options.fd)
    return Scaled(node, scene, options.steps, limits)


def after_early_end(node: NodeClient) -> list[str]:
    """Stops the node; returns notes on its state and on faulty frames."""
    failure = come_to_rest(node)
    state = "is at rest" if failure is None else f"could not be stopped ({failure}): try laconic rig --stop"
    return [f"the node {state}", f"faulty frames: {dict(node.link.faults) or 'none'}"]


@contextmanager
def shown(node: NodeClient, scene: Scene, options: Options) -> Iterator[Moved]:
    """The live view, or a bar."""
    steps = options.steps or scene.steps()
    bar = live_view(node.link, scene.name, steps) if options.live else progress_bar(scene.name, steps)
    with bar as moved:
        yield moved
