"""Free run: the node steps by its own clock, the rig sends voltages in their cycle and takes what comes.

Every period sends one NU, so counting them (and those that the counter says are missing) gives the step of each answer.
When a voltage takes effect is only known to within the time on the wire: the twin is run once for every delay up to
`latency_s`, and a value must lie between what these twins say.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from laconic.errors import BadInput
from laconic.plant import Plant
from laconic.rig.client import NodeClient
from laconic.rig.errors import NodeRefused, NodeSilent
from laconic.rig.latency import period_figures
from laconic.rig.lockstep import load_scene
from laconic.rig.scaled import SELECT_BIT, Held, Voltages, check_voltages_only, expected_raw
from laconic.rig.verdict import Judgement, Verdict
from laconic.rig.wire import Frame, wire
from laconic.scene import Scene

CYCLE_S = 0.01          # of VOLTAGE, as the contract says
DEFAULT_FRAMES = ("NU", "POSE")
MOST_COMPARED = 5000    # periods; of a longer run every n-th


TwinValues = dict[tuple[int, str, int], dict[str, float]]  # (step, frame, group) → raw values before rounding


@dataclass
class FreeRun:
    """What was sent and what came."""

    rate_Hz: int
    keep: int = 1           # every so many periods are compared with the twins
    commands: list[tuple[int, np.ndarray]] = field(default_factory=list)    # (steps seen when it was sent, input row)
    answers: list[tuple[int, Frame, bytes]] = field(default_factory=list)   # (step, frame, payload)
    instants_s: list[float] = field(default_factory=list)                   # of NU
    steps: int = 0
    elapsed_s: float = 0.0
    node_steps: int = 0
    worst_lateness_us: int = 0
    late_periods: int = 0
    state: str = "ready"
    overranges: int = 0


def run_free(node: NodeClient, scene: Scene, duration_s: float, rate_Hz: int = 0, watchdog_ms: int = 100,
             frames: tuple[str, ...] = DEFAULT_FRAMES, moved: Callable[[float], None] = lambda _: None) -> FreeRun:
    """Loads a scene and lets the node run for so long."""
    check_voltages_only(scene)
    if "NU" not in frames:
        raise BadInput(f"{scene.path}: rig.frames: a free run counts its steps by NU; add it")
    load_scene(node, scene)
    node.select(**{SELECT_BIT[name]: 1 for name in {*frames, "HEARTBEAT", "COUNTERS"}})
    run = FreeRun(rate_Hz or round(1.0 / scene.run.step_s))
    run.keep = max(1, round(duration_s * run.rate_Hz / MOST_COMPARED))
    link, clock, voltages, held = node.link, node.link.clock, Voltages(node, scene), Held(scene.drive())
    start_us = clock.now_us()
    start_clock(node, scene, rate_Hz, watchdog_ms)
    end_us, next_us = start_us + int(1e6 * duration_s), clock.now_us()
    while (now_us := clock.now_us()) < end_us:
        if now_us >= next_us:
            tick = int((now_us - start_us) / 1e6 / scene.run.step_s)
            run.commands.append((run.steps, voltages.send(held.at(tick))))
            next_us += int(1e6 * CYCLE_S)
            moved(CYCLE_S)
        received = link.receive_until(min(next_us, end_us))
        if received is not None:
            take(run, node, *received)
    run.elapsed_s = (clock.now_us() - start_us) / 1e6
    node.others.clear()
    node.stop()
    for frame, data in node.others:
        take(run, node, frame, data)
    run.overranges = voltages.overranges
    return run


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
    if frame.name == "NU":
        run.steps += 1 + node.link.lost_before(frame)
        run.instants_s.append(node.link.clock.now_us() / 1e6)
    values = frame.unpack(data)
    if frame.name in ("NU", "POSE", "WHEEL_SPEED") and run.steps % run.keep == 0:
        run.answers.append((run.steps, frame, bytes(data)))
    elif frame.name == "HEARTBEAT":
        run.node_steps, run.worst_lateness_us = values["steps"], values["worst_lateness"]
        run.state = wire().choice("HEARTBEAT", "state", values["state"])
        if run.state in ("timeout", "fault"):
            raise NodeSilent(f"the node has gone into state {run.state} after {run.node_steps} steps")
    elif frame.name == "COUNTERS" and "late_periods" in values:
        run.late_periods = values["late_periods"]
    elif frame.name == "RESULT":
        node.check(values)


def twin_values(scene: Scene, run: FreeRun, delay: int, per_period: int) -> TwinValues:
    """What a twin whose commands act so many periods later says to every answer."""
    plant: Plant = scene.plant(scene.core())
    wanted: dict[int, list[tuple[str, int, Frame]]] = {}
    for step, frame, data in run.answers:
        wanted.setdefault(step, []).append((frame.name, frame.unpack(data).get("group", 0), frame))
    acting = {}
    for seen, row in run.commands:
        acting[seen + delay] = row
    last, found, held = max(wanted, default=0), {}, plant.core.input()
    events = sorted({0, *(step for step in acting if step < last), *wanted})
    for step, following in zip(events, [*events[1:], last], strict=True):
        for name, group, frame in wanted.get(step, ()):
            found[step, name, group] = expected_raw(plant, frame, group)
        if step in acting:
            held = plant.core.input(acting[step])
        plant.run(held, (following - step) * per_period)
    return found


def judge_free_run(node: NodeClient, scene: Scene, duration_s: float, rate_Hz: int, watchdog_ms: int,
                   tolerances: dict[str, float], latency_s: float = 0.02,
                   moved: Callable[[float], None] = lambda _: None) -> Judgement:
    """A free run and what there is to say about it."""
    frames = scene.rig.frames or DEFAULT_FRAMES
    run = run_free(node, scene, duration_s, rate_Hz, watchdog_ms, frames, moved)
    judgement = Judgement(scene.name, f"free run at {run.rate_Hz} Hz")
    per_period = max(1, round(1.0 / (run.rate_Hz * scene.run.step_s)))
    delays = sorted({0, 1, *np.linspace(0, max(1, round(latency_s * run.rate_Hz)), 6).astype(int).tolist()})
    twins = [twin_values(scene, run, delay, per_period) for delay in delays]
    judgement.add(*envelope_verdicts(run, twins, tolerances), steps_verdict(run), clock_verdict(run))
    judgement.figures |= {"steps": run.steps, "seconds": run.elapsed_s, "late_periods": run.late_periods,
                          "worst_lateness_us": run.worst_lateness_us}
    judgement.figures |= period_figures(run.instants_s, 1.0 / run.rate_Hz)
    return judgement


def envelope_verdicts(run: FreeRun, twins: list[dict], tolerances: dict[str, float]) -> list[Verdict]:
    """One per signal: between the twins, give or take half a last place and the most that ever lay between them: each
    command has a delay of its own, and what one of them has left behind in the pose stays."""
    spread: dict[str, float] = {}
    worst: dict[str, tuple[float, float, int]] = {}
    for step, frame, data in run.answers:
        raw = frame.unpack(data)
        group = raw.get("group", 0)
        for name in twins[0].get((step, frame.name, group), ()):
            values = np.array([twin[step, frame.name, group][name] for twin in twins])
            if name == "heading":  # nearest turn
                turn = 2 * np.pi / frame.fields[name].scale
                values -= turn * np.round((values - raw[name]) / turn)
            scale, label = frame.fields[name].scale, f"{frame.name}.{name}"
            spread[label] = max(spread.get(label, 0.0), float(np.ptp(values)))
            slack = 0.5 + 1e-6 + spread[label]
            slack += tolerances.get(label, tolerances.get(name, 0.0)) / scale
            beyond = max(values.min() - slack - raw[name], raw[name] - values.max() - slack)
            off = float(np.min(np.abs(values - raw[name]))) * scale
            if label not in worst or beyond > worst[label][0]:
                worst[label] = (beyond, off, step)
    return [Verdict(label, beyond <= 0.0, f"{off:.3g} from the nearest twin" if beyond <= 0.0 else
                    f"{off:.3g} off at step {step}", off, 0.0, step) for label, (beyond, off, step) in worst.items()]


def steps_verdict(run: FreeRun) -> Verdict:
    """The node took every step, late or not; what was under way at the end may be missing."""
    expected = run.elapsed_s * run.rate_Hz
    missing = expected - run.steps
    passed = abs(missing) <= 0.05 * run.rate_Hz + 2
    return Verdict("steps", passed, f"{run.steps} of {expected:.0f} steps, {run.late_periods} a period late or more, "
                   f"worst lateness {run.worst_lateness_us} µs", float(missing), 0.05 * run.rate_Hz + 2)


def clock_verdict(run: FreeRun) -> Verdict:
    """The node's clock goes as fast as the rig's."""
    if len(run.instants_s) < 2:
        return Verdict("clock", False, "no two answers came")
    rate = (len(run.instants_s) - 1) / (run.instants_s[-1] - run.instants_s[0])
    off = rate / run.rate_Hz - 1.0
    return Verdict("clock", abs(off) < 0.01, f"{rate:.2f} answers a second, {100 * off:+.3f} %", off, 0.01)
