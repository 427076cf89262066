"""What runs with hinges keep on every ground: rows of outputs, and trailers that fold, as nothing stops them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from laconic.core.spelling import wrapped
from laconic.errors import Refused
from laconic.scene import Scene
from laconic.scene.hinges import Hinge

FOLDED_RAD = math.pi / 2.0


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
    """Watches free hinges that are no casters, by their numbers, row by row."""

    def __init__(self, trailers: Sequence[tuple[int, Hinge]]):
        self._trailers, self._seen = trailers, dict[str, Folded]()

    def take(self, hinge_angle_rad: Sequence[float] | np.ndarray, time_s: float) -> None:
        """Notes trailers beyond a right angle, and how far they come."""
        for at, hinge in self._trailers:
            angle, name = abs(wrapped(float(hinge_angle_rad[at]))), hinge.name
            if angle > FOLDED_RAD or name in self._seen:
                seen = self._seen.setdefault(name, Folded(name, time_s, angle, hinge.has_stops))
                self._seen[name] = replace(seen, most_rad=max(seen.most_rad, angle))

    def found(self) -> tuple[Folded, ...]:
        """Those that folded."""
        return tuple(self._seen.values())


def refusal_of_run(scene: Scene, why: Refused, when: str = "") -> Refused:
    """A refusal with the scene's file in front, which some have already."""
    return why if str(scene.path) in why.message else scene.refusal_in_file(why, when)


class KeptRows:
    """The outputs of a run, row by row; `trailers` are watched for folds."""

    def __init__(self, kept: Sequence[str], trailers: Sequence[tuple[int, Hinge]]):
        self.kept, self._rows, self._folds = kept, list[list[float]](), Folds(trailers)
        self.lifted: tuple[int, float] | None = None  # the first wheel that carries nothing, from 1; and when, in s

    def see_lifted(self, carry_nothing: np.ndarray, time_s: float) -> None:
        """Keeps the first wheel that does, shape (N,)."""
        if self.lifted is None and carry_nothing.any():
            self.lifted = int(np.argmax(carry_nothing)) + 1, time_s

    def __len__(self) -> int:
        return len(self._rows)

    @property
    def folded(self) -> tuple[Folded, ...]:
        """Trailers that folded."""
        return self._folds.found()

    def columns(self) -> dict[str, np.ndarray]:
        """By signal name."""
        table = np.array(self._rows, float).reshape(len(self._rows), len(self.kept))
        return dict(zip(self.kept, table.T.copy(), strict=True))


def parts_of(signal: str, of_hinge: dict[str, int]) -> tuple[str, int]:
    """A signal's name, and the item of its array that it is."""
    name, _, inside = signal.partition("[")
    item = inside.removesuffix("]")
    return name, of_hinge[item] if item in of_hinge else int(item) - 1 if item else 0
