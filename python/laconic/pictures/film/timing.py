"""When a film shows which row of a run: in real time, or faster a long one; it rests at the end and begins again."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

LONGEST_S = 20.0   # of the moving part; a longer run is shown faster
RATE_HZ = 12.5     # of the keyframes, between which the browser moves evenly
REST_S = 1.5
SPEEDS = (1, 2, 5)


@dataclass(frozen=True)
class Timing:
    """`rows` of the run are keyframes at `shares` of the film's length."""

    rows: np.ndarray
    shares: np.ndarray
    length_s: float
    run_s: float
    speed: int

    def style(self) -> str:
        """The rules that all moving parts share."""
        return (f".m {{ animation-duration: {self.length_s:g}s; animation-iteration-count: infinite; "
                "animation-timing-function: linear; }\n"
                "@media (prefers-reduced-motion: reduce) { .m { animation: none !important; } }\n")

    def keyframes(self, name: str, states: Sequence[str]) -> str:
        """The rule @keyframes; states: the declarations at each of `rows`."""
        steps = [f"{100.0 * share:.4g}% {{ {state} }}" for share, state in zip(self.shares, states, strict=True)]
        return f"@keyframes {name} {{ {' '.join(steps)} 100% {{ {states[-1]} }} }}\n"

    def in_words(self) -> str:
        """How long the run is, and how fast it is shown."""
        return f"{self.run_s:g} s in real time" if self.speed == 1 else f"{self.run_s:g} s, {self.speed} times as fast"


def timing_of(time_s: np.ndarray) -> Timing:
    """For a run with rows at these instants."""
    run_s = float(time_s[-1])
    speed = _speed(run_s)
    moving_s = max(run_s / speed, 1e-3)
    count = max(2, math.ceil(moving_s * RATE_HZ) + 1)
    rows = np.unique(np.searchsorted(time_s, np.linspace(0.0, run_s, count) * (1.0 - 1e-12)))
    length_s = round(moving_s + REST_S, 3)
    return Timing(rows, time_s[rows] / speed / length_s, length_s, run_s, speed)


def _speed(run_s: float) -> int:
    """The least of 1, 2, 5, 10, 20 … that keeps a film short."""
    decade = 1
    while True:
        for speed in SPEEDS:
            if run_s <= LONGEST_S * speed * decade:
                return speed * decade
        decade *= 10
