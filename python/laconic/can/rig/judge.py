"""Lockstep runs and their judgement."""

from __future__ import annotations

import numpy as np

from laconic.can.rig.client import NodeClient
from laconic.can.rig.lockstep import LockstepRun, latency_figures, run_lockstep, twin_states
from laconic.can.rig.scaled import Comparison, ScaledRun, rounding_limit, run_scaled
from laconic.can.rig.sensed import has_sensors
from laconic.can.rig.verdict import Judgement, Moved, Trial, Verdict, driven, same_bits, within
from laconic.scene import Scene


class SameBits(Trial):
    """Lockstep with raw frames against the core: every bit."""

    mode = "lockstep, same bits"

    def __init__(self, node: NodeClient, scene: Scene, steps: int | None, *, every: int = 1, fd: bool = False):
        super().__init__(node, scene, steps)
        self.steps, self.every, self.fd, self.run = steps, every, fd, LockstepRun()

    def run_it(self, moved: Moved) -> None:
        run_lockstep(self.node, self.scene, self.steps, every=self.every, fd=self.fd, moved=moved, run=self.run)

    def done(self) -> int:
        return self.run.steps

    def judge_it(self, judgement: Judgement) -> None:
        run, count = self.run, self.scene.wheel_count
        theirs = run.hinged_states if run.hinged else twin_states(self.scene, run)
        parts = {"nu": slice(0, 3), "pose": slice(3, 6), "wheel_speed": slice(6, 6 + count),
                 "wheel_angle": slice(6 + count, 6 + 2 * count)}
        if run.hinged:
            parts = run.hinged.parts()
        if has_sensors(self.scene):
            end = 6 + 2 * count
            parts |= {"acceleration_body": slice(end, end + 2), "imu": slice(end + 2, end + 5),
                      "encoder_count": slice(end + 5, end + 5 + count)}
        for name, part in parts.items():
            if part.stop > part.start:
                judgement.add(same_bits(name, run.states[:, part], theirs[:, part], run.ticks))
        judgement.add(link_verdict(self.node))
        judgement.figures |= speed_figures(run.steps, run.seconds, run.frames_out, run.frames_in, len(run.ticks))
        judgement.figures |= latency_figures(run.latencies_s)


class Scaled(Trial):
    """Lockstep with scaled frames against a twin that gets the same integers, to half the resolution."""

    mode = "lockstep"

    def __init__(self, node: NodeClient, scene: Scene, steps: int | None, tolerances: dict[str, float]):
        super().__init__(node, scene, steps)
        self.steps, self.tolerances, self.run = steps, tolerances, ScaledRun()

    def run_it(self, moved: Moved) -> None:
        run_scaled(self.node, self.scene, self.steps, moved, self.run)

    def done(self) -> int:
        return self.run.steps

    def judge_it(self, judgement: Judgement) -> None:
        run = self.run
        judgement.add(*signal_verdicts(run.comparison, self.tolerances), link_verdict(self.node),
                      overrange_verdict(run.voltage_overranges, run.comparison.overranges))
        judgement.figures |= speed_figures(run.steps, run.seconds, run.frames_out, run.frames_in, run.steps)
        judgement.figures |= latency_figures(run.latencies_s)


def judge_same_bits(node: NodeClient, scene: Scene, steps: int | None, *, every: int = 1, fd: bool = False,
                    moved: Moved = lambda _: None) -> Judgement:
    """Lockstep with raw frames against the core: every bit."""
    return driven(SameBits(node, scene, steps, every=every, fd=fd), moved)


def judge_scaled(node: NodeClient, scene: Scene, steps: int | None, tolerances: dict[str, float],
                 moved: Moved = lambda _: None) -> Judgement:
    """Lockstep with scaled frames against a twin that gets the same integers, to half the resolution."""
    return driven(Scaled(node, scene, steps, tolerances), moved)


def signal_verdicts(comparison: Comparison, tolerances: dict[str, float]) -> list[Verdict]:
    """One per signal; a tolerance may be given by the full name or the part behind the dot."""
    verdicts = []
    for name, record in comparison.signals.items():
        short = name.rpartition(".")[2]
        twin = np.array(record.twin)
        limit: np.ndarray | float | None = tolerances.get(name, tolerances.get(short))
        if limit is None:
            limit = rounding_limit(twin / record.scale, record.dtype) * record.scale
        verdicts.append(within(name, np.array(record.measured), twin, limit, np.array(record.ticks)))
    return verdicts


def link_verdict(node: NodeClient) -> Verdict:
    """No frame was wrong, missing or doubled."""
    faults = {name: count for name, count in node.link.faults.items() if count}
    detail = ", ".join(f"{count} × {name}" for name, count in faults.items())
    return Verdict("frames", not faults, detail or f"{node.link.frames_in} in, all right", float(sum(faults.values())))


def overrange_verdict(out: int, back: int) -> Verdict:
    """No value left the range of its frame."""
    return Verdict("range", out + back == 0, f"{out} voltages and {back} answers out of range" if out + back else
                   "every value fits its frame", float(out + back))


def speed_figures(steps: int, seconds: float, frames_out: int, frames_in: int, exchanges: int) -> dict[str, float]:
    """Steps and frames a second."""
    return {"steps": steps, "seconds": seconds, "steps_per_s": steps / seconds if seconds else 0.0,
            "exchanges_per_s": exchanges / seconds if seconds else 0.0,
            "frames_out_per_exchange": frames_out / max(exchanges, 1),
            "frames_in_per_exchange": frames_in / max(exchanges, 1)}
