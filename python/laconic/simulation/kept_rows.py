"""What runs with hinges keep on every ground: rows of outputs, and trailers that fold, as nothing stops them."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from laconic.core.spelling import wrapped
from laconic.errors import Refused
from laconic.scene import Scene
from laconic.scene.hinges import Hinge
from laconic.scene.inputs import InputsOnGrid

FOLDED_RAD = math.pi / 2.0
ROOM = 256  # rows that the core fills before their columns are cut


@dataclass(frozen=True)
class Folded:
    """A trailer that turned by more than a right angle against what draws it."""

    hinge: str
    first_s: float   # of the rows
    most_rad: float
    has_stops: bool = False

    def in_words(self) -> str:
        """For people."""
        return (f"{self.hinge} folds: its hinge angle is beyond 90° from t = {self.first_s:g} s on, at most "
                f"{math.degrees(self.most_rad):.4g}°; {self.remedy()}")

    def remedy(self) -> str:
        """What a user can do about it."""
        return ("its stops allow that" if self.has_stops else
                "a real one would hit what draws it; give stop_low_deg and stop_high_deg")


class Folds:
    """Watches free hinges that are no casters, by their numbers."""

    def __init__(self, trailers: Sequence[tuple[int, Hinge]]):
        self._trailers, self._seen = trailers, dict[str, Folded]()

    def take(self, hinge_angle_rad: np.ndarray, time_s: np.ndarray) -> None:
        """Notes trailers beyond a right angle in some rows (rows, H), and how far they come."""
        for at, hinge in self._trailers:
            angles, name = np.abs(wrapped(hinge_angle_rad[:, at].astype(float))), hinge.name
            seen, is_beyond = self._seen.get(name), angles > FOLDED_RAD
            if seen is None and is_beyond.any():
                first = int(np.argmax(is_beyond))
                seen, angles = Folded(name, float(time_s[first]), 0.0, hinge.has_stops), angles[first:]
            if seen is not None:
                self._seen[name] = replace(seen, most_rad=max(seen.most_rad, float(angles.max())))

    def found(self) -> tuple[Folded, ...]:
        """Those that folded."""
        return tuple(self._seen.values())


def refusal_of_run(scene: Scene, why: Refused, when: str = "") -> Refused:
    """A refusal with the scene's file in front, which some have already."""
    return why if str(scene.path) in why.message else scene.refusal_in_file(why, when)


class Blocks(ABC):
    """A table that grows row by row; what the rows are made of is kept for the last ones alone."""

    def __init__(self, width: int):
        self._blocks, self._count = [np.zeros((0, width))], 0

    def _count_row(self) -> None:
        """A row is there."""
        self._count += 1
        if self._count == ROOM:
            self.finish()

    def finish(self) -> None:
        """Judges the rows since the last time and cuts their numbers."""
        if self._count:
            self._blocks.append(self._cut(self._count))
            self._count = 0

    @abstractmethod
    def _cut(self, count: int) -> np.ndarray:
        """The numbers of the last rows, (count, width)."""

    def table(self) -> np.ndarray:
        """All rows."""
        self.finish()
        return np.concatenate(self._blocks)


class KeptRows(Blocks):
    """The outputs of a run, row by row; `trailers` are watched for folds."""

    def __init__(self, kept: Sequence[str], trailers: Sequence[tuple[int, Hinge]], inputs: InputsOnGrid,
                 input_length: int):
        super().__init__(len(kept))
        self.kept, self._folds, self._inputs = kept, Folds(trailers), inputs
        self._ticks, self._given = np.zeros(ROOM, int), np.zeros((ROOM, input_length))
        self.lifted: tuple[int, float] | None = None  # the first wheel that carries nothing, from 1; and when, in s

    def _keep(self, row: np.ndarray, tick: int) -> None:
        """Ends a row: these inputs act from this step on."""
        self._ticks[self._count], self._given[self._count] = tick, row
        self._count_row()

    def _times(self, count: int) -> np.ndarray:
        """Of the last rows."""
        return self._ticks[:count] * self._inputs.step_s

    def __len__(self) -> int:
        return sum(map(len, self._blocks)) + self._count

    def see_lifted(self, carry_nothing: np.ndarray, time_s: np.ndarray) -> None:
        """Keeps the first wheel that does in some rows, (rows, N)."""
        if self.lifted is None and carry_nothing.any():
            first = int(np.argmax(carry_nothing.any(axis=1)))
            self.lifted = int(np.argmax(carry_nothing[first])) + 1, float(time_s[first])

    @property
    def folded(self) -> tuple[Folded, ...]:
        """Trailers that folded."""
        return self._folds.found()

    def columns(self) -> dict[str, np.ndarray]:
        """By signal name."""
        return dict(zip(self.kept, self.table().T.copy(), strict=True))


def parts_of(signal: str, of_hinge: dict[str, int]) -> tuple[str, int]:
    """A signal's name, and the item of its array that it is."""
    name, _, inside = signal.partition("[")
    item = inside.removesuffix("]")
    return name, of_hinge[item] if item in of_hinge else int(item) - 1 if item else 0
