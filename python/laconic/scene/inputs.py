"""What acts on a vehicle over time: the `[[input]]` tables of a scene, on the grid of its steps.

`steps` hold a value from t_s on, and are zero before the first. `table` interpolates linearly and keeps its first and
last value outside. `sine` is amplitude · sin(2π f t + phase). Several inputs of one signal add up.

A change of `steps` exactly at the end of a run moves nothing and shows in the last row, as what acts from there on.

A scene with nothing but `steps` runs with held inputs; every change must fall on the start of a step, because a change
moved to the grid would be another experiment. Any other scene is sampled at the start, middle and end of each step.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from laconic.core.inputs import FOR_EVER, Schedule
from laconic.errors import BadInput

if TYPE_CHECKING:
    from laconic.core import Core

CHUNK = 4096        # sampled steps made ready at once
ON_THE_GRID = 1e-6  # of a step, as laconic_steps_in
STEPS_A_PERIOD = 4  # of a sine at least: the parabola through start, middle and end of a step is then within 3 % of it


@dataclass(frozen=True)
class Input:
    """One `[[input]]`: `location` is its name in the file, for messages."""

    signal: str
    kind: str
    location: str
    t_s: tuple[float, ...] = ()
    value: tuple[float, ...] = ()
    amplitude: float = 0.0
    frequency_Hz: float = 0.0
    phase_rad: float = 0.0

    @np.errstate(over="ignore", invalid="ignore")  # the core names a number that is not finite
    def at(self, time_s: np.ndarray) -> np.ndarray:
        """Values of a table or sine at some instants."""
        if self.kind == "table":
            return np.interp(time_s, self.t_s, self.value)
        return self.amplitude * np.sin(2.0 * np.pi * self.frequency_Hz * time_s + self.phase_rad)


@dataclass(frozen=True)
class Segment:
    """Some steps with one set of values."""

    first_step: int
    steps: int
    values: dict[str, float]


@dataclass(frozen=True)
class Window:
    """A schedule for some steps of the run."""

    first: int
    end: int
    schedule: Schedule


@dataclass(frozen=True)
class InputsOnGrid:
    """A scene's inputs on the grid of `step_s`, for `steps` steps."""

    path: Path
    given: tuple[Input, ...]
    step_s: float
    steps: int
    signals: tuple[str, ...] = ()
    changes: tuple[int, ...] = ()
    _ticks: dict[str, np.ndarray] = field(default_factory=dict)   # where each `steps` input changes, by its location
    _levels: dict[str, np.ndarray] = field(default_factory=dict)  # its values, with the zero before the first
    _made: dict[str, Window] = field(default_factory=dict)        # the last schedule for each scalar type

    @classmethod
    def on_grid(cls, path: Path, inputs: tuple[Input, ...], step_s: float, steps: int,
                grid_s: Sequence[float] = ()) -> InputsOnGrid:
        """Puts the changes on the grid; BadInput where one falls inside a step, with a step that fits `grid_s` too."""
        grid: list[float | Fraction] = [*grid_s, Fraction(repr(step_s)) * steps]
        stepped = [each for each in inputs if each.kind == "steps"]
        ticks = {each.location: change_ticks(path, each, step_s, steps, grid) for each in stepped}
        levels = {each.location: np.array([0.0, *each.value]) for each in stepped}
        within = {int(t) for ends in ticks.values() for t in ends if t < steps}
        signals = tuple(dict.fromkeys(each.signal for each in inputs))
        return cls(path, inputs, step_s, steps, signals, tuple(sorted({0} | within)), ticks, levels)

    @property
    def is_held(self) -> bool:
        """Whether every input holds its values over each step."""
        return all(each.kind == "steps" for each in self.given)

    def held_at(self, tick: int) -> dict[str, float]:
        """Values at the start of a step, for those that hold them over it (FMU, node, held scenes)."""
        row = self._rows(np.array([tick]), np.array([0.0]))[0, 0]
        return dict(zip(self.signals, row.tolist(), strict=True))

    def starts(self, ticks: np.ndarray) -> dict[str, np.ndarray]:
        """The same at the starts of many steps, by signal."""
        return dict(zip(self.signals, self._rows(ticks, np.array([0.0]))[:, 0].T, strict=True))

    def segments(self) -> Iterator[Segment]:
        """Stretches of constant inputs of a held scene."""
        ends = [*self.changes[1:], self.steps]
        for first, last in zip(self.changes, ends, strict=True):
            yield Segment(first, last - first, self.held_at(first))

    def samples(self, first: int, count: int) -> np.ndarray:
        """Values (step, start|middle|end, signal) of some steps; `steps` inputs hold theirs over each."""
        return self._rows(np.arange(first, first + count), np.array([0.0, 0.5, 1.0]))

    def schedule(self, core: Core, step: int) -> tuple[Schedule, int]:
        """The inputs from a step on as the core follows them, counted from the run's start, and where they end."""
        window = self._made.get(core.real)
        if window is None or not window.first <= step < window.end:
            window = self._made[core.real] = self._window(core, step)
        return window.schedule, window.end

    def _window(self, core: Core, step: int) -> Window:
        """All stretches of a held scene; of a sampled one as many steps as are made ready at once."""
        offsets = [core.input_offset(signal) for signal in self.signals]
        if self.is_held:
            held = self._rows(np.array(self.changes), np.array([0.0]))[:, 0]
            return Window(0, FOR_EVER, Schedule(core, offsets, held, [*self.changes[1:], FOR_EVER]))
        first = step - step % CHUNK
        end = min(first + CHUNK, self.steps) if step < self.steps else first + CHUNK
        return Window(first, end, Schedule(core, offsets, self.samples(first, end - first), first_step=first))

    @np.errstate(over="ignore", invalid="ignore")
    def _rows(self, ticks: np.ndarray, parts: np.ndarray) -> np.ndarray:
        rows = np.zeros((len(ticks), len(parts), len(self.signals)))
        time_s = (ticks[:, None] + parts[None, :]) * self.step_s
        for each in self.given:
            column = rows[:, :, self.signals.index(each.signal)]
            column += self._steps_at(each, ticks)[:, None] if each.kind == "steps" else each.at(time_s)
        return rows

    def ticks_of(self, each: Input) -> np.ndarray:
        """The steps at whose start a `steps` input changes."""
        return self._ticks[each.location]

    def levels_of(self, each: Input) -> np.ndarray:
        """Its values: the zero before the first, then one from each change on."""
        return self._levels[each.location]

    def _steps_at(self, each: Input, ticks: np.ndarray) -> np.ndarray:
        return self.levels_of(each)[np.searchsorted(self.ticks_of(each), ticks, side="right")]


def check_resolved(path: Path, inputs: tuple[Input, ...], step_s: float, grid_s: Sequence[float]) -> None:
    """BadInput for a sine that the samples at the start, middle and end of each step would take for a slower one."""
    fastest = max((each for each in inputs if each.kind == "sine"), key=lambda e: abs(e.frequency_Hz), default=None)
    if fastest is None or abs(fastest.frequency_Hz) * step_s * STEPS_A_PERIOD <= 1.0 + ON_THE_GRID:
        return
    remedy = step_remedy(grid_s, 1 / abs(STEPS_A_PERIOD * Fraction(repr(fastest.frequency_Hz))))
    raise BadInput(f"{path}: {fastest.location}.frequency_Hz: {fastest.frequency_Hz:g} Hz has fewer than "
                   f"{STEPS_A_PERIOD} steps of {step_s:g} s a period, too few to follow it; {remedy}")


def change_ticks(path: Path, each: Input, step_s: float, steps: int, grid: Sequence[float | Fraction]) -> np.ndarray:
    """The steps at whose start a `steps` input changes."""
    instants = np.array(each.t_s)
    ticks = np.rint(instants / step_s)
    off = np.abs(ticks * step_s - instants) > ON_THE_GRID * step_s
    late = instants >= steps * step_s
    for instant in instants[off & ~late]:
        remedy = step_remedy([*instants[~late], *grid], step_s)
        raise BadInput(f"{path}: {each.location}.t_s: {instant:g} s falls inside a step of {step_s:g} s; {remedy}")
    return np.where(late, np.maximum(ticks, steps), ticks).astype(np.int64)


def step_remedy(instants_s: Iterable[float | Fraction], step_s: float | Fraction) -> str:
    """The largest step, `step_s` or less, that has all these instants on its grid: their common divisor over n."""
    exact = [as_written(t) for t in instants_s]
    whole = math.lcm(*(t.denominator for t in exact))
    grid = Fraction(math.gcd(*(int(t * whole) for t in exact)), whole)
    return step_in_words(float(grid / math.ceil(grid / as_written(step_s))))


def step_in_words(step_s: float) -> str:
    """With all digits, as the same number taken from the message must fit."""
    return f"a step of {step_s!r} s would do"


def as_written(number: float | Fraction) -> Fraction:
    """The decimal number that a float was read from."""
    return number if isinstance(number, Fraction) else Fraction(repr(float(number)))
