"""Verdicts of a free run.

The period in which a voltage takes effect is known only to within the delay on the bus: one twin is run for each of
several delays up to `latency_s`, and each answer must lie between the values of these twins.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from laconic.can.rig.client import NodeClient
from laconic.can.rig.free_run import CYCLE_S, DEFAULT_FRAMES, HINGED_DEFAULT_FRAMES, FreeRun, run_free
from laconic.can.rig.hinged import HingedTwin, resting_row, run_commanded
from laconic.can.rig.judge import link_verdict
from laconic.can.rig.lockstep import period_figures
from laconic.can.rig.scaled import expected_raw, rounding_limit
from laconic.can.rig.sensed import WHOLE_COUNT, Twin, part_of, period_of, plant_of, twin_of
from laconic.can.rig.verdict import Judgement, Moved, Trial, Verdict, driven
from laconic.can.rig.wire import Frame
from laconic.errors import BadInput
from laconic.scene import Scene

TwinValues = dict[tuple[int, str, int], dict[str, float]]  # (step, frame, group) → raw values before rounding
Advance = Callable[[Any, int], None]                       # a command, if there is a new one, and steps


def twin_values(scene: Scene, run: FreeRun, delay: int, per_period: int) -> TwinValues:
    """The values, for every answer, of a twin on which commands act `delay` periods later."""
    twin, advance = hinged_twin(scene) if scene.has_hinges else rigid_twin(scene)
    wanted: dict[int, list[tuple[str, int, Frame]]] = {}
    for step, frame, data in run.answers:
        wanted.setdefault(step, []).append((frame.name, part_of(frame, frame.unpack(data)), frame))
    acting = {seen + delay: command for seen, command in run.commands}
    last, found = max(wanted, default=0), TwinValues()
    events = sorted({0, *(step for step in acting if step < last), *wanted})
    for step, following in zip(events, [*events[1:], last], strict=True):
        for name, group, frame in wanted.get(step, ()):
            found[step, name, group] = expected_raw(twin, frame, group)
        advance(acting.get(step), (following - step) * per_period)
    return found


def rigid_twin(scene: Scene) -> tuple[Twin, Advance]:
    """A twin without hinges, and what steps it; a command holds until the next."""
    twin = twin_of(scene, scene.plant(scene.core()), scene.rig.frames)
    held = plant_of(twin).core.input()

    def advance(command: Any, steps: int) -> None:
        nonlocal held
        held = held if command is None else plant_of(twin).core.input(command)
        twin.run(held, steps)

    return twin, advance


def hinged_twin(scene: Scene) -> tuple[Twin, Advance]:
    """The same of a vehicle with hinges."""
    twin = HingedTwin(scene)
    now = resting_row(twin)

    def advance(command: Any, steps: int) -> None:
        nonlocal now
        now = run_commanded(twin.plant, now, command, steps)

    return twin.plant, advance


class Free(Trial):
    """A free run against twins with delays from 0 to the latency."""

    def __init__(self, node: NodeClient, scene: Scene, duration_s: float, rate_Hz: int, watchdog_ms: int,
                 tolerances: dict[str, float], latency_s: float = 0.02):
        if 0 < watchdog_ms <= 1000 * CYCLE_S:
            raise BadInput(f"--watchdog {watchdog_ms}: the rig sends voltages every {1000 * CYCLE_S:.0f} ms; give "
                           "more, or 0 for none")
        self.rate_Hz = rate_Hz or round(1.0 / scene.run.step_s)
        super().__init__(node, scene, round(duration_s * self.rate_Hz))
        self.mode = f"free run at {self.rate_Hz} Hz"
        usual = HINGED_DEFAULT_FRAMES if scene.has_hinges else DEFAULT_FRAMES
        self.given = (duration_s, rate_Hz, watchdog_ms, scene.rig.frames or usual)
        self.tolerances, self.latency_s, self.run = tolerances, latency_s, FreeRun()

    def run_it(self, moved: Moved) -> None:
        run_free(self.node, self.scene, *self.given, lambda seconds: moved(seconds * self.rate_Hz), self.run)

    def done(self) -> int:
        return self.run.steps

    def judge_it(self, judgement: Judgement) -> None:
        run = self.run
        if run.answers:
            twins = twins_of(self.scene, run, self.latency_s)
            wrap = (self.scene.sensors.encoder or {}).get("wrap", WHOLE_COUNT)
            judgement.add(*envelope_verdicts(run, twins, self.tolerances, self.scene.core().dtype, wrap))
        judgement.add(link_verdict(self.node), steps_verdict(run), clock_verdict(run), run.silence.verdict(),
                      run.punctuality.verdict())
        judgement.figures |= {"steps": run.steps, "seconds": run.elapsed_s, "late_periods": run.late_periods,
                              "worst_lateness_us": run.worst_lateness_us}
        judgement.figures |= period_figures(run.instants_s, 1.0 / run.rate_Hz)
        judgement.figures |= run.punctuality.figures()


def judge_free_run(node: NodeClient, scene: Scene, duration_s: float, rate_Hz: int, watchdog_ms: int,
                   tolerances: dict[str, float], latency_s: float = 0.02, moved: Moved = lambda _: None) -> Judgement:
    """Runs free and judges."""
    return driven(Free(node, scene, duration_s, rate_Hz, watchdog_ms, tolerances, latency_s), moved)


def twins_of(scene: Scene, run: FreeRun, latency_s: float) -> list[TwinValues]:
    """The values of twins with delays from 0 to the latency."""
    per_period = max(1, round(1.0 / (run.rate_Hz * scene.run.step_s)))
    delays = sorted({0, 1, *np.linspace(0, max(1, round(latency_s * run.rate_Hz)), 6).astype(int).tolist()})
    return [twin_values(scene, run, delay, per_period) for delay in delays]


def envelope_verdicts(run: FreeRun, twins: list[TwinValues], tolerances: dict[str, float],
                      dtype: np.dtype, wrap: int = WHOLE_COUNT) -> list[Verdict]:
    """One per signal: between the twins, with a slack of the rounding limit and of the largest spread of the twins so
    far: each command has its own delay, and the error that it causes in the pose remains."""
    spread: dict[str, float] = {}
    worst: dict[str, tuple[float, float, int]] = {}
    for step, frame, data in run.answers:
        raw = frame.unpack(data)
        group = part_of(frame, raw)
        for name in twins[0].get((step, frame.name, group), ()):
            values = [twin[step, frame.name, group][name] for twin in twins]
            if turn := period_of(frame, name, wrap):  # of all equal angles, the one nearest to the answer
                values = [value - turn * round((value - raw[name]) / turn) for value in values]
            least, largest = min(values), max(values)
            scale, label = frame.fields[name].scale, f"{frame.name}.{name}"
            spread[label] = max(spread.get(label, 0.0), largest - least)
            slack = float(rounding_limit(raw[name], dtype)) + spread[label]
            slack += tolerances.get(label, tolerances.get(name, 0.0)) / scale
            beyond = max(least - slack - raw[name], raw[name] - largest - slack)
            off = min(abs(value - raw[name]) for value in values) * scale
            if label not in worst or beyond > worst[label][0]:
                worst[label] = (beyond, off, step)
    return [Verdict(label, beyond <= 0.0, f"{off:.3g} from the nearest twin" if beyond <= 0.0 else
                    f"{off:.3g} off at step {step}", off, 0.0, step) for label, (beyond, off, step) in worst.items()]


def steps_verdict(run: FreeRun) -> Verdict:
    """The node took every step, late or not; frames on their way at the end may be missing."""
    expected = run.elapsed_s * run.rate_Hz
    missing = expected - run.steps
    allowed = 0.05 * run.rate_Hz + 2
    passed = abs(missing) <= allowed
    under_way = f" (up to {allowed:.0f} may be on their way at the end)" if passed and round(missing) > 0 else ""
    return Verdict("steps", passed, f"{run.steps} of {expected:.0f} steps{under_way}, the node took "
                   f"{run.late_periods} a period late or more, worst {run.worst_lateness_us} µs late",
                   float(missing), allowed)


def clock_verdict(run: FreeRun) -> Verdict:
    """The node's clock is as fast as the rig's, by the steps of answers, so that lost answers do not matter."""
    if len(run.instants_s) < 2:
        return Verdict("clock", False, "no two answers came")
    rate = (run.instant_steps[-1] - run.instant_steps[0]) / (run.instants_s[-1] - run.instants_s[0])
    off = rate / run.rate_Hz - 1.0
    return Verdict("clock", abs(off) < 0.01, f"{rate:.2f} steps a second, {100 * off:+.3f} %", off, 0.01)
