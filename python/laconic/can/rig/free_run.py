"""Free run: the node steps by its own clock, the rig sends voltages in their cycle and receives answers.

Every period sends one NU, so counting them (and those that the counter says are missing) gives the step of each answer.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from laconic.can.rig.client import NodeClient
from laconic.can.rig.errors import NodeRefused, NodeSilent
from laconic.can.rig.hinged import check_hinged_frames
from laconic.can.rig.lockstep import load_scene
from laconic.can.rig.punctuality import Punctuality, Silence
from laconic.can.rig.scaled import ANSWERS, Held, Hinged, Voltages, check_voltages_only, select_bits
from laconic.can.rig.wire import Frame, wire
from laconic.errors import BadInput
from laconic.scene import Scene

CYCLE_S = 0.01          # of VOLTAGE, as in the contract
LONGEST_CATCH_UP_US = 1_000_000
DEFAULT_FRAMES = ("NU", "POSE")
HINGED_DEFAULT_FRAMES = ("VELOCITY", "POSE", "HINGE_ANGLE")  # where the scene has hinges
COUNTED = ("NU", "VELOCITY")                         # one a period, of vehicles without and with hinges
MOST_COMPARED = 5000    # periods; of a longer run every n-th


@dataclass
class FreeRun:
    """Commands sent and frames received."""

    rate_Hz: int = 0
    keep: int = 1           # every keep-th period is compared with the twins
    commands: list[tuple[int, np.ndarray]] = field(default_factory=list)    # (steps seen when it was sent, input row)
    answers: list[tuple[int, Frame, bytes]] = field(default_factory=list)   # (step, frame, payload)
    instants_s: list[float] = field(default_factory=list)                   # of NU
    instant_steps: list[int] = field(default_factory=list)                  # the step of each of these instants
    steps: int = 0
    elapsed_s: float = 0.0
    node_steps: int = 0
    worst_lateness_us: int = 0
    late_before: int = 0    # late periods of earlier runs, which the node's counter includes
    late_periods: int = 0   # of this run
    state: str = "ready"
    overranges: int = 0
    fed_answers: int = 0    # number of answers at the last HEARTBEAT by which the node followed the rig's voltages
    deaf_heartbeats: int = 0  # in a row
    punctuality: Punctuality = field(init=False)  # of the rig; this and `silence` are set at START
    silence: Silence = field(init=False)          # of the node


def run_free(node: NodeClient, scene: Scene, duration_s: float, rate_Hz: int = 0, watchdog_ms: int = 100,
             frames: tuple[str, ...] = DEFAULT_FRAMES, moved: Callable[[float], None] = lambda _: None,
             run: FreeRun | None = None) -> FreeRun:
    """Loads a scene and lets the node run for so long. Frames are put into `run`, where one is given, so that they are
    kept even if the run ends early."""
    check_voltages_only(scene)
    counted = COUNTED[scene.has_hinges]
    check_hinged_frames(scene, frames)
    if counted not in frames:
        raise BadInput(f"{scene.path}: rig.frames: a free run counts its steps by {counted}; add it")
    run = run or FreeRun()
    run.rate_Hz = rate_Hz or round(1.0 / scene.run.step_s)
    run.keep = max(1, round(duration_s * run.rate_Hz / MOST_COMPARED))
    held: Held | Hinged
    if scene.has_hinges:
        held = Hinged(node, scene, scene.steps())
    else:
        load_scene(node, scene)
        held = Held(scene.inputs_on_grid())
    node.select(**select_bits({*frames, "COUNTERS"}))
    run.late_before = node.counter("late_periods")
    voltages = Voltages(node, scene)
    start_us = node.link.clock.now_us()
    start_clock(node, scene, rate_Hz, watchdog_ms)
    run.punctuality = Punctuality(node.link.clock, CYCLE_S, watchdog_ms)
    run.silence = Silence((*frames, "HEARTBEAT", "COUNTERS"), 1.0 / run.rate_Hz, run.punctuality.now_us())
    try:
        follow(run, voltages, held, scene.run.step_s, start_us, start_us + int(1e6 * duration_s), moved)
    finally:
        run.elapsed_s = (node.link.clock.now_us() - start_us) / 1e6
        run.punctuality.ended()
    node.others.clear()
    node.stop()
    for frame, data in node.others:
        take(run, node, frame, data)
    return run


def follow(run: FreeRun, voltages: Voltages, held: Held | Hinged, step_s: float, start_us: int, end_us: int,
           moved: Callable[[float], None]) -> None:
    """Commands out in their cycle, answers in, until the end."""
    node, rig = voltages.node, run.punctuality
    clock = node.link.clock
    while (now_us := clock.now_us()) < end_us:
        if rig.is_late():  # frames that wait to be read give the node's present step
            catch_up(run, node, now_us + rig.cycle_us)
        if rig.is_due():
            tick = int((clock.now_us() - start_us) / 1e6 / step_s)
            run.commands.append((run.steps, held.send(voltages, tick, sync=False)))
            run.overranges = voltages.overranges + held.overranges
            rig.sent()
            moved(CYCLE_S)
        if not listen(run, node, min(rig.next_us, end_us)):
            run.silence.check(rig.now_us())
    if rig.is_late():
        catch_up(run, node, end_us + LONGEST_CATCH_UP_US)


def catch_up(run: FreeRun, node: NodeClient, until_us: int) -> None:
    """Reads the frames that wait, until none is left or `until_us` has passed."""
    clock = node.link.clock
    while clock.now_us() < until_us and listen(run, node, clock.now_us()):
        pass


def listen(run: FreeRun, node: NodeClient, until_us: int) -> bool:
    """Takes the next frame of the node; False iff none has come in time."""
    run.punctuality.listens()
    received = node.link.receive_until(until_us)
    run.punctuality.listened(until_us)
    if received is None:
        return False
    run.silence.received(received[0].name, run.punctuality.now_us())
    take(run, node, *received)
    return True


def start_clock(node: NodeClient, scene: Scene, rate_Hz: int, watchdog_ms: int) -> None:
    """The node begins to step; BadInput where its periods cannot be made of whole steps."""
    try:
        node.start_free_run(rate_Hz, watchdog_ms)
    except NodeRefused as refused:
        if refused.status != "out of range":
            raise
        raise BadInput(f"{scene.path}: run.step_s: {rate_Hz or 1.0 / scene.run.step_s:g} periods a second take no "
                       f"small whole number of steps of {scene.run.step_s:g} s each; choose another --rate") from None


def take(run: FreeRun, node: NodeClient, frame: Frame, data: bytes) -> None:
    """One frame of the node."""
    if frame.name in COUNTED:
        run.steps += 1 + node.link.lost_before(frame)
        run.instants_s.append(node.link.clock.now_us() / 1e6)
        run.instant_steps.append(run.steps)
    values = frame.unpack(data)
    if frame.name in ANSWERS and frame.name != "STATE_FD" and run.steps % run.keep == 0:
        run.answers.append((run.steps, frame, bytes(data)))
    elif frame.name == "HEARTBEAT":
        take_heartbeat(run, values)
    elif frame.name == "COUNTERS" and "late_periods" in values:
        run.late_periods = values["late_periods"] - run.late_before
    elif frame.name == "RESULT":
        node.check(values)


def take_heartbeat(run: FreeRun, values: dict[str, int]) -> None:
    """Keeps what HEARTBEAT states; NodeSilent where the node has stopped or no longer follows the voltages."""
    run.node_steps, run.worst_lateness_us = values["steps"], values["worst_lateness"]
    run.state = wire().choice("HEARTBEAT", "state", values["state"])
    run.deaf_heartbeats = run.deaf_heartbeats + 1 if values["deaf"] else 0
    if run.state == "fault":
        raise NodeSilent(f"the node has gone into state fault after {run.node_steps} steps")
    if run.state == "timeout":
        del run.answers[run.fed_answers :]  # it may have coasted since, from an unknown step on
        raise NodeSilent(f"the node's watchdog has stopped it after {run.node_steps} steps, "
                         f"{run.punctuality.explains_timeout()}")
    if run.deaf_heartbeats > 1:  # a single one may be due to one bad frame
        del run.answers[run.fed_answers :]
        raise NodeSilent("the node refuses the rig's voltages: more of them in a row were lost on the way than its "
                         "counters can bridge, and it accepts them again only after STOP and START")
    if run.state == "free run" and not values["deaf"]:
        run.fed_answers = len(run.answers)
