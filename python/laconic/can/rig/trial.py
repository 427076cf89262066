"""A run, and its judgement as a separate step: the node is brought to rest between them, and a run that ends early is
judged up to its end."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable

from laconic.can.rig.client import NodeClient
from laconic.can.rig.errors import ENDINGS
from laconic.can.rig.verdict import Judgement
from laconic.errors import LaconicError
from laconic.scene import Scene

Moved = Callable[[float], None]  # called with the number of further steps that the run has taken


class Trial(ABC):
    """One run of a scene against a node, in one of the modes."""

    mode = ""

    def __init__(self, node: NodeClient, scene: Scene, steps: int | None):
        self.node, self.scene = node, scene
        self.wanted = steps or scene.steps()
        self.ending: LaconicError | None = None

    def drive(self, moved: Moved = lambda _: None) -> None:
        """Runs to the end; an error that ends the run early is kept in `ending`."""
        try:
            self.run_it(moved)
        except ENDINGS as ending:
            self.ending = ending

    def judge(self) -> Judgement:
        """Judges every step that was answered."""
        judgement = Judgement(self.scene.name, self.mode)
        if self.done():
            self.judge_it(judgement)
        judgement.ended(self.ending, self.done(), self.wanted)
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
