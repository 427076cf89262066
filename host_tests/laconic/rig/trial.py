"""A run and its judgement, apart from each other: the node can be brought to rest between them, and what ends a run
early leaves everything to be judged that came before."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable

from laconic.errors import LaconicError
from laconic.rig.client import NodeClient
from laconic.rig.errors import ENDINGS
from laconic.rig.verdict import Judgement
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
        """Runs to the end, or to what ends it early; that is kept in `ending`."""
        try:
            self.run_it(moved)
        except ENDINGS as ending:
            self.ending = ending

    def judge(self) -> Judgement:
        """What there is to say about everything that came."""
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
    """Both, one after the other."""
    trial.drive(moved)
    return trial.judge()
