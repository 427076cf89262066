"""Results of the rig: one verdict per signal, with the worst difference and the limit.

A run, and its judgement as a separate step: the node is brought to rest between them, and a run that ends early is
judged up to its end.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import can
import numpy as np

from laconic.can.rig.client import NodeClient
from laconic.can.rig.errors import ENDINGS
from laconic.can.rig.link import Link
from laconic.can.rig.wire import wire
from laconic.errors import LaconicError
from laconic.scene import Scene


@dataclass(frozen=True)
class Verdict:
    """About one signal, or about the run as a whole."""

    name: str
    passed: bool
    detail: str
    worst: float = 0.0
    limit: float = 0.0
    step: int = 0       # where the worst was

    def __post_init__(self) -> None:
        """Plain Python numbers, whatever NumPy gave: results go to JSON and XML."""
        for name, kind in (("passed", bool), ("worst", float), ("limit", float), ("step", int)):
            object.__setattr__(self, name, kind(getattr(self, name)))


@dataclass
class Judgement:
    """All verdicts of one run and the figures that go with them."""

    scene: str
    mode: str
    verdicts: list[Verdict] = field(default_factory=list)
    figures: dict[str, float] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    facts: dict[str, Any] = field(default_factory=dict)  # what else --json tells, by name
    ending: LaconicError | None = None      # what ended the run before its last step
    unwritten: list[LaconicError] = field(default_factory=list)  # files that could not be written to their end

    @property
    def passed(self) -> bool:
        """Whether there is a verdict and every verdict is passed."""
        return bool(self.verdicts) and all(each.passed for each in self.verdicts)

    @property
    def exit_status(self) -> int:
        """0: passed, 1: failed, 128 and the number of the signal that has ended the run."""
        return self.ending.exit_status if self.ending is not None else 0 if self.passed else 1

    def ended(self, ending: LaconicError | None, step: int, steps: int) -> None:
        """Notes how far the run came. What ended it early is the verdict `run`, before those about its signals."""
        self.figures |= {"last_step": step, "steps_wanted": steps}
        if ending is not None:
            self.ending = ending
            self.verdicts.insert(0, Verdict("run", False, f"{ending}; after step {step} of {steps}", step=step))

    def add(self, *verdicts: Verdict) -> None:
        """Adds verdicts at the end."""
        self.verdicts.extend(verdicts)


def same_bits(name: str, ours: np.ndarray, theirs: np.ndarray, ticks: np.ndarray) -> Verdict:
    """Every number the same, down to the last bit."""
    different = np.flatnonzero((np.asarray(ours) != np.asarray(theirs)).reshape(len(ticks), -1).any(axis=1))
    if not len(different):
        return Verdict(name, True, f"same bits in {len(ticks)} answers")
    first = different[0]
    worst = float(np.max(np.abs(np.asarray(ours, float) - np.asarray(theirs, float))))
    return Verdict(name, False, f"differs from the twin in {len(different)} of {len(ticks)} answers, first at step "
                   f"{ticks[first]}", worst, 0.0, int(ticks[first]))


def within(name: str, ours: np.ndarray, theirs: np.ndarray, limit: np.ndarray | float, ticks: np.ndarray) -> Verdict:
    """No difference above the limit, which may vary from answer to answer."""
    error = np.abs(np.asarray(ours, float) - np.asarray(theirs, float))
    allowed = np.broadcast_to(np.asarray(limit, float), error.shape)
    at = int(np.argmax(error - allowed)) if len(error) else 0
    worst, limit_there = (float(error[at]), float(allowed[at])) if len(error) else (0.0, 0.0)
    passed = len(error) > 0 and bool(np.all(error <= allowed))
    detail = f"largest difference {float(error.max()) if len(error) else 0:.3g}"
    if not passed:
        detail = f"{worst:.6g} off at step {ticks[at]}, {limit_there:.6g} allowed" if len(error) else "never came"
    return Verdict(name, passed, detail, worst, limit_there, int(ticks[at]) if len(error) else 0)


Moved = Callable[[float], None]  # called with the number of further steps that the run has taken


class Calibration:
    """Hears on the bus whether a master of XCP changes numbers of the vehicle: a command that the node affirms."""

    COMMANDS, AFFIRMED = {0xF0, 0xEB, 0xE4}, 0xFF  # DOWNLOAD, SET_CAL_PAGE, COPY_CAL_PAGE

    def __init__(self, link: Link):
        self.happened, self._asked = False, False
        self._command, self._answer = (link.id_base + wire().xcp[name].offset
                                       for name in ("XCP_COMMAND", "XCP_RESPONSE"))

    def hear(self, message: can.Message) -> None:
        """One frame of the bus."""
        if message.is_extended_id or message.is_error_frame or not message.data:
            return
        if message.arbitration_id == self._command:
            self._asked = message.data[0] in self.COMMANDS
        elif message.arbitration_id == self._answer and message.data[0] >= 0xFE:
            self.happened |= self._asked and message.data[0] == self.AFFIRMED
            self._asked = False


class Trial(ABC):
    """One run of a scene against a node, in one of the modes."""

    mode = ""

    def __init__(self, node: NodeClient, scene: Scene, steps: int | None):
        self.node, self.scene = node, scene
        self.wanted = steps or scene.steps()
        self.ending: LaconicError | None = None
        self.calibration = Calibration(node.link)

    def drive(self, moved: Moved = lambda _: None) -> None:
        """Runs to the end; an error that ends the run early is kept in `ending`."""
        self.node.link.listeners.append(self.calibration.hear)
        try:
            self.run_it(moved)
        except ENDINGS as ending:
            self.ending = ending
        finally:
            self.node.link.listeners.remove(self.calibration.hear)

    def judge(self) -> Judgement:
        """Judges every step that was answered."""
        judgement = Judgement(self.scene.name, self.mode)
        if self.done():
            self.judge_it(judgement)
        judgement.ended(self.ending, self.done(), self.wanted)
        if self.calibration.happened:
            judgement.notes.append("numbers of the vehicle were changed by XCP during the run; the reference run keeps "
                                   "the scene's, so signals differ")
        return judgement

    @abstractmethod
    def run_it(self, moved: Moved) -> None:
        """The run itself."""

    @abstractmethod
    def done(self) -> int:
        """Steps that can be judged."""

    @abstractmethod
    def judge_it(self, judgement: Judgement) -> None:
        """Adds verdicts and figures about at least one step."""


def driven(trial: Trial, moved: Moved = lambda _: None) -> Judgement:
    """Runs and judges."""
    trial.drive(moved)
    return trial.judge()
