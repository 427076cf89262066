"""A recorded run whose columns have the names of signals, as `laconic simulate --out F.csv --inputs` writes it.

Input columns drive the model from the scene's start on; every output column is then compared with the model's. Where
the file has no inputs, the scene's own drive it.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from laconic.errors import BadInput, reason_of, shown
from laconic.scene import Outputs, Scene
from laconic.scene.inputs import Input, step_in_words, step_remedy
from laconic.scene.signals import LENGTHS, PER_WHEEL, missing_outputs, output_signals, signal_names
from laconic.simulation import simulate

TIME = "time_s"
ON_THE_GRID = 1e-6  # of a step, as for inputs


@dataclass(frozen=True)
class SignalLog:
    """Columns over time; time begins at 0, `begin_s` is the first time in the file."""

    path: Path
    begin_s: float
    time_s: np.ndarray
    columns: dict[str, np.ndarray]


@dataclass(frozen=True)
class Difference:
    """Difference of one signal between file and model."""

    signal: str
    largest: float
    at_s: float                # instant of the largest difference
    root_mean_square: float
    size: float                # the largest value in the file


@dataclass(frozen=True)
class SignalReplay:
    """The signals compared, and their differences."""

    scene: Scene
    log: SignalLog
    inputs: tuple[str, ...]    # columns that drove the model; none: the scene's own inputs
    held: bool                 # inputs held from row to row; else linear between rows
    left_out: tuple[str, ...]  # columns that are no signals of this vehicle
    model: dict[str, np.ndarray]
    differences: list[Difference]


def is_signal_log(path: Path) -> bool:
    """Whether a file begins with the column time_s."""
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            return file.readline(4096).split(",")[0].strip().strip('"') == TIME
    except (OSError, UnicodeDecodeError):
        return False


def read_signal_log(path: Path) -> SignalLog:
    """The file; BadInput names the line and column that cannot be used."""
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            head, *rows = [row for row in csv.reader(file) if row]
    except OSError as error:
        raise BadInput(f"{path}: cannot be read ({reason_of(error)}); give the path of a recorded run") from None
    except (UnicodeDecodeError, csv.Error):
        raise BadInput(f"{path}: is no CSV text; give a recorded run as CSV") from None
    head = [name.strip() for name in head]
    for index, name in enumerate(head):
        if name in head[:index]:
            raise BadInput(f"{path}: has two columns {shown(name)}; keep one of them")
    if len(rows) < 2:
        raise BadInput(f"{path}: has {len(rows)} rows of numbers; give at least two")
    table = np.array([_numbers(path, head, line, row) for line, row in enumerate(rows, start=2)])
    time_s = table[:, 0]
    if not (late := np.diff(time_s) > 0.0).all():
        raise BadInput(f"{path}: line {int(np.argmin(late)) + 3}: {TIME} does not grow; give rows in order of time")
    return SignalLog(path, float(time_s[0]), time_s - time_s[0], dict(zip(head[1:], table[:, 1:].T, strict=True)))


def _numbers(path: Path, head: list[str], line: int, row: list[str]) -> list[float]:
    if len(row) != len(head):
        raise BadInput(f"{path}: line {line}: has {len(row)} columns, the first line {len(head)}; repair it")
    for name, text in zip(head, row, strict=True):
        try:
            is_number = math.isfinite(float(text))
        except ValueError:
            is_number = False
        if not is_number:
            raise BadInput(f"{path}: line {line}: {name} is {shown(text[:40])}; give a finite number")
    return [float(text) for text in row]


def _changes(scene: Scene, end_s: float) -> list[float]:
    """When the scene's own inputs change."""
    return [t for each in scene.inputs if each.kind == "steps" for t in each.t_s if t < end_s]


def ticks_of(log: SignalLog, scene: Scene, changes: Sequence[float]) -> np.ndarray:
    """The rows' times in steps; BadInput for a row inside a step, with a step that suits these instants, too."""
    step_s = scene.run.step_s
    ticks = np.rint(log.time_s / step_s)
    off = is_inside(log.time_s, step_s)
    if off.any():
        row = int(np.argmax(off))
        raise BadInput(f"{log.path}: line {row + 2}: {TIME} {log.begin_s + log.time_s[row]:g} s falls inside a step of "
                       f"{step_s:g} s; change run.step_s: {_remedy(log, scene.run.step_s, changes)}")
    return ticks.astype(np.int64)


def is_inside(time_s: np.ndarray, step_s: float) -> np.ndarray:
    """Which instants lie inside a step."""
    found: np.ndarray = np.abs(np.rint(time_s / step_s) * step_s - time_s) > ON_THE_GRID * step_s
    return found


def _remedy(log: SignalLog, longest_s: float, changes: Sequence[float]) -> str:
    """A part of the rows' usual distance, which need not be a short decimal number, or of all times as written."""
    end, usual = float(log.time_s[-1]), float(np.median(np.diff(log.time_s)))
    between = end / max(round(end / usual), 1)
    step_s = between / math.ceil(between / longest_s)
    if not is_inside(np.array([*log.time_s, *changes]), step_s).any():
        return step_in_words(step_s)
    return step_remedy([*(round(float(t), 9) for t in log.time_s[1:]), *changes], longest_s)


def replay_signals(scene: Scene, log: SignalLog) -> SignalReplay:
    """Runs the model along the file and compares."""
    count, held = scene.wheel_count, all(each.kind == "steps" for each in scene.inputs)
    known_inputs = list(signal_names(LENGTHS, PER_WHEEL, count))
    missing = missing_outputs(scene.vehicle, scene.sensors)
    known_outputs = [name for name in signal_names(*output_signals(scene.vehicle), count) if name not in missing]
    inputs = tuple(name for name in log.columns if name in known_inputs)
    outputs = tuple(name for name in log.columns if name in known_outputs)
    if not outputs:
        raise BadInput(f"{log.path}: has no column to compare; name columns as the signals of [outputs], "
                       f"such as {known_outputs[0]}")
    if log.begin_s != 0.0 and not inputs:
        raise BadInput(f"{log.path}: begins at {log.begin_s:g} s, the scene's inputs at 0; give the inputs as "
                       "columns, as simulate --inputs writes them")
    ticks = ticks_of(log, scene, () if inputs else _changes(scene, float(log.time_s[-1])))
    every = int(np.gcd.reduce(np.diff(ticks)))
    run = scene.with_run(duration_s=int(ticks[-1]) * scene.run.step_s)
    run = replace(run, outputs=Outputs(outputs, every * scene.run.step_s))
    if inputs:
        run = replace(run, inputs=tuple(recorded_input(log, name, held) for name in inputs))
    found = simulate(run, outputs, progress=True).columns
    model = {name: found[name][(ticks - ticks[0]) // every] for name in outputs}
    left_out = tuple(name for name in log.columns if name not in (*inputs, *outputs))
    return SignalReplay(scene, log, inputs, held, left_out, model,
                        [difference(log, name, model[name]) for name in outputs])


def recorded_input(log: SignalLog, name: str, held: bool) -> Input:
    """A column as an input: held from row to row, or linear between rows."""
    values = log.columns[name]
    if not held:
        return Input(name, "table", f"column {name}", tuple(log.time_s.tolist()), tuple(values.tolist()))
    changes = np.flatnonzero(np.diff(values, prepend=np.nan) != 0.0)
    return Input(name, "steps", f"column {name}", tuple(log.time_s[changes].tolist()), tuple(values[changes].tolist()))


def difference(log: SignalLog, name: str, model: np.ndarray) -> Difference:
    """Model less file; a wrapped heading by the shorter way around."""
    off = model - log.columns[name]
    if name == "heading_wrapped_rad":
        off = np.remainder(off + math.pi, math.tau) - math.pi
    worst = int(np.argmax(np.abs(off)))
    return Difference(name, float(np.abs(off[worst])), float(log.begin_s + log.time_s[worst]),
                      float(np.sqrt(np.mean(off**2))), float(np.abs(log.columns[name]).max()))
