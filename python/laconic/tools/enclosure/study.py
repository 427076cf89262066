"""A scene's enclosure beside the core's run of it: how wide it is, and how far the core is from it, proved.

A scene as a case of `laconic verify --enclose`.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np
from flint import arb

from laconic.base.progress import progress_bar
from laconic.scene import Scene
from laconic.simulation import RunRefused, Trajectory, simulate
from laconic.tools.enclosure.balls import precision
from laconic.tools.enclosure.equation import Stretch
from laconic.tools.enclosure.readings import Reading, check_enclosable, reading_of_core, reading_of_file
from laconic.tools.enclosure.state import Sample
from laconic.tools.verify.trajectories import EnclosedResult, bound_text

# ---- What users see of an enclosure: a table and verdicts, columns for a CSV file, JSON.

WORDS = {"nu": "ν", "pose": "pose", "wheel": "wheel angles"}


def verdict(kind: Kind) -> str:
    """Where the core's result is."""
    return "inside" if kind.inside else f"distance ≤ {bound_text(kind.error or 0.0)}"


def rows_of(study: Study) -> list[tuple[str, str, str, str]]:
    """A row of words for each kind: name, width, verdict, distance to the motion by the core's own constants."""
    return [(WORDS[of_file.name], bound_text(of_file.width), verdict(of_file), verdict(of_core))
            for of_file, of_core in zip(study.of_file.kinds(), study.of_core.kinds(), strict=True)
            if of_file.name != "wheel" or study.run.scene.wheel_count]


def lines_of(study: Study) -> list[str]:
    """For people, each line whole."""
    enclosed = study.of_file
    head = (f"enclosure: {len(enclosed.widths)} rows, {enclosed.steps} steps of {enclosed.bits} bits; relative to "
            "max(1, largest value):")
    table = [("", "width at most", "core, by the file's numbers", "core, by its own constants"), *rows_of(study)]
    return [head, *("  " + f"{name:13} {width:>14}  {by_file:28} {by_core}" for name, width, by_file, by_core in table)]


def columns_of(study: Study) -> dict[str, np.ndarray]:
    """Two columns for each state: a bound of the core's error and of the enclosure's width, in the state's unit."""
    assert study.of_file.errors is not None
    found = {}
    for k, name in enumerate(study.states):
        found[f"{name}_error"] = study.of_file.errors[:, k]
        found[f"{name}_width"] = study.of_file.widths[:, k]
    return found


def as_json(study: Study) -> dict[str, Any]:
    """The enclosure of a run, with the digits of its end."""
    shown = (*zip(study.states, study.of_file.end_digits, strict=True),
             *zip(("heading_cosine", "heading_sine"), study.of_file.end_direction, strict=True))
    end = {name: {"middle": digits, "radius": radius} for name, (digits, radius) in shown}
    return {"rows": len(study.of_file.widths), "steps": study.of_file.steps, "bits": study.of_file.bits,
            "seconds": study.of_file.seconds + study.of_core.seconds, **kinds_json(study.of_file),
            "own_constants": kinds_json(study.of_core), "final": end}


def kinds_json(enclosed: Enclosed) -> dict[str, Any]:
    """Errors, widths and verdicts by kind."""
    kinds = dict(zip(KINDS, enclosed.kinds(), strict=True))
    return {**{f"error_{name}": kind.error for name, kind in kinds.items()},
            **{f"width_{name}": kind.width for name, kind in kinds.items()},
            "inside": all(kind.inside for kind in kinds.values())}


GOAL_BITS = 112         # of the first pass
GUARD_BITS = 48         # of rounding, beyond the goal
MOST_BITS = 6000        # of the goal
WIDE = 1e-18            # relative width beyond which a second pass takes more bits,
NARROW_BITS = 76        # so that this many are left
DIGITS = 32             # of the middles that are shown
Seen = Callable[[int, Sample], None]
KINDS = ("nu", "pose", "wheel")


@dataclass(frozen=True)
class Kind:
    """One kind of state: bounds relative to max(1, largest size of the kind), as `laconic verify` has its errors."""

    name: str
    width: float
    error: float | None
    inside: bool


@dataclass(frozen=True)
class Enclosed:
    """One reading's enclosure at all rows: bounds per row and state, in the states' units; the end with all digits."""

    widths: np.ndarray
    errors: np.ndarray | None
    inside: np.ndarray
    sizes: np.ndarray            # largest proved size of each state
    end: Sample
    end_digits: tuple[tuple[str, float], ...]
    end_direction: tuple[tuple[str, float], ...]  # cos θ and sin θ at the end
    steps: int
    bits: int
    seconds: float

    def kinds(self) -> list[Kind]:
        """Over ν, pose and wheel angles."""
        parts = (slice(0, 3), slice(3, 6), slice(6, None))
        return [self.kind(name, part) for name, part in zip(KINDS, parts, strict=True)]

    def kind(self, name: str, part: slice) -> Kind:
        """One kind; without wheels their errors are 0."""
        if not self.sizes[part].size:
            return Kind(name, 0.0, 0.0, True)
        scale = max(1.0, float(np.max(self.sizes[part])))
        error = None if self.errors is None else above(float(np.max(self.errors[:, part])) / scale)
        return Kind(name, above(float(np.max(self.widths[:, part])) / scale), error,
                    bool(np.all(self.inside[:, part])))

    @property
    def width(self) -> float:
        """The largest relative width."""
        return max(kind.width for kind in self.kinds())


def above(number: float) -> float:
    """The next float: quotients of bounds stay bounds."""
    return math.nextafter(number, math.inf) if number else 0.0


def bound_of(number: arb) -> float:
    """A float at or above the size of the ball's numbers."""
    found = float(number.abs_upper())
    return math.nextafter(found, math.inf) if found else 0.0


def row_bounds(sample: Sample, found: Sequence[float] | None) -> Iterator[tuple[float, float, bool, float]]:
    """For each state: width, bound of the core's error, whether the core is inside, a proved size."""
    for k, state in enumerate(sample.row()):
        core = None if found is None else arb(float(found[k]))
        yield (2.0 * bound_of(state.rad()), 0.0 if core is None else bound_of(state - core),
               core is not None and state.contains(core), math.nextafter(float(state.abs_lower()), 0.0))


def shown_digits(state: arb) -> tuple[str, float]:
    """A decimal near the middle, and how far any of the ball's numbers is from it at most."""
    text = state.mid().str(DIGITS, radius=False)
    return text, bound_of(state - arb(text))


def enclose(reading: Reading, instants: Sequence[Fraction], found: np.ndarray | None, title: str, shown: bool = True,
            seen: Seen = lambda *_: None) -> Enclosed:
    """The enclosure at some instants, beside the core's states there; a second pass with more bits where it is wide.

    `seen` is given the number of each instant and what holds the state there, in each pass from the first on.
    """
    once = one_pass(reading, instants, found, GOAL_BITS, title, shown, seen)
    if once.width <= WIDE:
        return once
    lost = math.log2(once.width) if math.isfinite(once.width) else 1024.0
    bits = min(MOST_BITS, GOAL_BITS + math.ceil(max(0.0, lost + NARROW_BITS)))
    again = one_pass(reading, instants, found, bits, f"{title}, {bits} bits", shown, seen)
    return again if again.width < once.width else once


def one_pass(reading: Reading, instants: Sequence[Fraction], found: np.ndarray | None, goal_bits: int, title: str,
             shown: bool, seen: Seen) -> Enclosed:
    """The enclosure at one precision."""
    rows, began = [], time.perf_counter()
    progress = progress_bar(title, float(instants[-1]), forecasts=True) if shown else nullcontext(lambda _: None)
    with precision(goal_bits + GUARD_BITS), progress as moved:
        motion = reading.motion(goal_bits)
        sample = None
        for number, sample in enumerate(motion.samples(up_to(reading, instants[-1]), instants, moved)):
            seen(number, sample)
            rows.append(list(row_bounds(sample, None if found is None else found[number])))
        assert sample is not None
        table = np.array(rows, dtype=float)
        digits = tuple(shown_digits(state) for state in sample.row())
        sine, cosine = sample.heading_rad.sin_cos()
        direction = (shown_digits(cosine), shown_digits(sine))
    return Enclosed(table[:, :, 0], None if found is None else table[:, :, 1], table[:, :, 2].astype(bool),
                    np.max(table[:, :, 3], axis=0), sample, digits, direction, motion.steps_taken,
                    goal_bits + GUARD_BITS, time.perf_counter() - began)


def up_to(reading: Reading, end_s: Fraction) -> list[Stretch]:
    """The stretches until an instant: a run may have ended before its time."""
    return [replace(each, end_s=min(each.end_s, end_s)) for each in reading.stretches if each.begin_s < end_s]


@dataclass(frozen=True)
class Study:
    """A scene's run and its enclosures: by the file's numbers, and by the core's constants."""

    run: Trajectory
    states: tuple[str, ...]
    of_file: Enclosed
    of_core: Enclosed


def state_signals(wheel_count: int) -> tuple[str, ...]:
    """ν, pose and wheel angles, as signals of a run."""
    return (*(f"nu_rad_per_s[{i}]" for i in (1, 2, 3)), "x_m", "y_m", "heading_rad",
            *(f"wheel_angle_rad[{i}]" for i in range(1, wheel_count + 1)))


def study_of(run: Trajectory, shown: bool = True) -> Study:
    """Encloses a run that kept its states; BadInput for a scene that cannot be enclosed."""
    scene = run.scene
    check_enclosable(scene)
    states = state_signals(scene.wheel_count)
    found = np.column_stack([run.columns[name] for name in states])
    ticks = np.rint(run.time_s / scene.run.step_s).astype(np.int64).tolist()
    readings = {"enclosure": reading_of_file(scene), "of the core's constants": reading_of_core(scene)}
    return Study(run, states, *(enclose(reading, reading.instants(ticks), found, title, shown)
                                for title, reading in readings.items()))


def verify_scene_enclosed(scene: Scene, shown: bool = True) -> EnclosedResult:
    """Runs and encloses a scene at its rows; a step that the core refuses becomes the status."""
    check_enclosable(scene)
    try:
        run = simulate(scene, state_signals(scene.wheel_count), progress=shown)
    except RunRefused as refused:
        return EnclosedResult(scene.name, f"{refused.status}: {refused}")
    return scene_result(study_of(run, shown))


def scene_result(study: Study) -> EnclosedResult:
    """The result of a scene's study."""
    return EnclosedResult(study.run.scene.name, "ok", seconds=study.run.seconds,
                          own_constants=kinds_json(study.of_core), **kinds_json(study.of_file))
