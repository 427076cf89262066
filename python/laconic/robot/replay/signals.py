"""A recorded run whose columns have the names of signals, as `laconic simulate --out F.csv --inputs` writes it.

Input columns drive the model from the scene's start on; every output column is then compared with the model's. Where
the file has no inputs, the scene's own drive it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from laconic.base.text_file import beginning_of
from laconic.errors import BadInput
from laconic.robot.logs.formats.text_table import number_of, rows_of, text_of
from laconic.robot.logs.log import counted
from laconic.robot.replay.measures import RunErrors
from laconic.scene import Outputs, Scene
from laconic.scene.inputs import Input, step_in_words, step_remedy
from laconic.scene.sensors import OF_ENCODERS
from laconic.scene.signals import LENGTHS, PER_WHEEL, missing_outputs, output_signals, signal_names
from laconic.simulation import simulate

TIME = "time_s"
ON_THE_GRID = 1e-6  # of a step, as for inputs
WHOLE_COUNT = 2.0**32  # values of an encoder without a wrap


@dataclass(frozen=True)
class SignalLog:
    """Columns over time; time begins at 0, `begin_s` is the first time in the file."""

    path: Path
    begin_s: float
    time_s: np.ndarray
    columns: dict[str, np.ndarray]     # NaN: a blank cell
    faults: dict[str, str] = field(default_factory=dict)  # columns that cannot be used, and why
    lines: tuple[int, ...] = ()        # of each row
    remarks: tuple[str, ...] = ()      # what was left out of the file

    @property
    def names(self) -> list[str]:
        """All columns."""
        return [*self.columns, *self.faults]

    def line(self, row: int) -> int:
        """The line of a row."""
        return self.lines[row] if self.lines else row + 2


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
    remarks: list[str] = field(default_factory=list)


def is_signal_log(path: Path) -> bool:
    """Whether a file begins with the column time_s."""
    first = beginning_of(path).lstrip("\r\n").splitlines()[:1]
    return bool(first) and first[0].split(",")[0].strip().strip('"') == TIME


def read_signal_log(path: Path) -> SignalLog:
    """The file; BadInput names the line that cannot be used. A fault of a column counts once it is used."""
    text = text_of(path)
    rows = [(line, row) for line, row in rows_of(path, text, ",") if row]
    head = [name.strip() for name in rows[0][1]] if rows else []
    if len(rows) < 3:
        raise BadInput(f"{path}: has {max(len(rows) - 1, 0)} rows of numbers; give at least two")
    lines = [line for line, _ in rows[1:]]
    for line, row in rows[1:]:
        if len(row) != len(head):
            raise BadInput(f"{path}: line {line}: has {len(row)} columns, the first line {len(head)}; repair it")
    columns: dict[str, np.ndarray] = {}
    faults: dict[str, str] = {}
    for index, name in enumerate(head):
        if name in columns or name in faults:
            faults[name] = f"has two columns {name!r}; keep one of them"
            columns.pop(name, None)
        else:
            values, fault = _column(name, lines, [row[index] for _, row in rows[1:]])
            if fault:
                faults[name] = fault
            else:
                columns[name] = values
    if TIME in faults:
        raise BadInput(f"{path}: {faults[TIME]}")
    time_s = columns.pop(TIME)
    if np.isnan(time_s).any():
        raise BadInput(f"{path}: line {lines[int(np.argmax(np.isnan(time_s)))]}: {TIME} is blank; give a finite number")
    if not (late := np.diff(time_s) > 0.0).all():
        raise BadInput(f"{path}: line {lines[int(np.argmin(late)) + 1]}: {TIME} does not grow; give rows in order of "
                       "time")
    remark = text.remark()
    return SignalLog(path, float(time_s[0]), time_s - time_s[0], columns, faults, tuple(lines),
                     () if remark is None else (remark,))


def _column(name: str, lines: Sequence[int], texts: Sequence[str]) -> tuple[np.ndarray, str]:
    """(numbers, NaN for a blank cell; what is wrong with the first cell that is neither)."""
    found = np.full(len(texts), np.nan)
    for index, (line, text) in enumerate(zip(lines, texts, strict=True)):
        if not text.strip():
            continue
        try:
            found[index] = number_of(text, ".")
        except ValueError:
            found[index] = math.inf
        if not math.isfinite(found[index]):
            return found, f"line {line}: {name} is {text[:40]!r}; give a finite number, or leave the cell blank"
    return found, ""


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
        raise BadInput(f"{log.path}: line {log.line(row)}: {TIME} {log.begin_s + log.time_s[row]:g} s falls inside a "
                       f"step of {step_s:g} s; change run.step_s: {_remedy(log, scene.run.step_s, changes)}")
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
    inputs = tuple(name for name in log.names if name in known_inputs)
    outputs = tuple(name for name in log.names if name in known_outputs)
    check_used(log, inputs, outputs)
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
    left_out = tuple(name for name in log.names if name not in (*inputs, *outputs))
    return SignalReplay(scene, log, inputs, held, left_out, model,
                        [difference(log, name, model[name], wrap_of(scene)) for name in outputs],
                        [*log.remarks, *blanks(log, inputs, outputs, held)])


def check_used(log: SignalLog, inputs: Sequence[str], outputs: Sequence[str]) -> None:
    """BadInput for a column that is used and cannot be."""
    for name in (*inputs, *outputs):
        if name in log.faults:
            raise BadInput(f"{log.path}: {log.faults[name]}")
        if np.isnan(log.columns[name]).all():
            raise BadInput(f"{log.path}: column {name} is blank on all lines; fill it, or take it out")
        if name in inputs and np.isnan(log.columns[name][0]):
            raise BadInput(f"{log.path}: line {log.line(0)}: {name} is blank, and the model needs this input from the "
                           "first line on; give a number")


def blanks(log: SignalLog, inputs: Sequence[str], outputs: Sequence[str], held: bool) -> list[str]:
    """What is said of columns with blank cells."""
    found = []
    for name in (*inputs, *outputs):
        if count := int(np.isnan(log.columns[name]).sum()):
            how = "not compared" if name in outputs else "held from the line before" if held else "interpolated"
            found.append(f"{name} is blank on {counted(count, 'line')} and is {how} there")
    return found


def wrap_of(scene: Scene) -> float:
    """How many values the scene's encoders show."""
    encoder = scene.sensors.encoder or {}
    return float(encoder.get("wrap") or WHOLE_COUNT)


def recorded_input(log: SignalLog, name: str, held: bool) -> Input:
    """A column as an input: held from row to row, or linear between rows."""
    there = ~np.isnan(log.columns[name])
    time_s, values = log.time_s[there], log.columns[name][there]
    if not held:
        if time_s[-1] < log.time_s[-1]:
            time_s, values = np.append(time_s, log.time_s[-1]), np.append(values, values[-1])
        return Input(name, "table", f"column {name}", tuple(time_s.tolist()), tuple(values.tolist()))
    changes = np.flatnonzero(np.diff(values, prepend=np.nan) != 0.0)
    return Input(name, "steps", f"column {name}", tuple(time_s[changes].tolist()), tuple(values[changes].tolist()))


def difference(log: SignalLog, name: str, model: np.ndarray, wrap: float = WHOLE_COUNT) -> Difference:
    """Model less file, where the file has a value; a wrapped heading and a count by the shorter way around."""
    there = np.flatnonzero(~np.isnan(log.columns[name]))
    off = model[there] - log.columns[name][there]
    if name == "heading_wrapped_rad":
        off = np.remainder(off + math.pi, math.tau) - math.pi
    elif name.partition("[")[0] in OF_ENCODERS:
        off = np.remainder(off + 0.5 * wrap, wrap) - 0.5 * wrap
    worst = int(np.argmax(np.abs(off)))
    return Difference(name, float(np.abs(off[worst])), float(log.begin_s + log.time_s[there[worst]]),
                      float(np.sqrt(np.mean(off**2))), float(np.abs(log.columns[name][there]).max()))


# ---- Results of the replay of a run whose columns are signals: a report, numbers for JSON, a picture.

MOST_PANELS = 6


def as_text(found: SignalReplay) -> str:
    """A report in Markdown."""
    log, run = found.log, found.scene.run
    lines = [f"# {log.path.name} compared with {found.scene.name}", "",
             f"* {len(log.time_s)} rows, {log.begin_s:g} to {log.begin_s + log.time_s[-1]:g} s, in steps of "
             f"{run.step_s:g} s by {run.method}, {run.real}; the model starts as the scene does.",
             f"* {_inputs(found)}"]
    if found.left_out:
        lines.append(f"* Not compared, no signals of this vehicle: {', '.join(found.left_out)}.")
    lines += [f"* Left out or filled in: {remark}." for remark in found.remarks]
    lines += ["", "| compared | largest difference | at [s] | root mean square | largest value in the file |",
              "| --- " * 5 + "|"]
    lines += [f"| {d.signal} | {d.largest:.3g} | {d.at_s:g} | {d.root_mean_square:.3g} | {d.size:.3g} |"
              for d in found.differences]
    return "\n".join([*lines, ""])


def _inputs(found: SignalReplay) -> str:
    if not found.inputs:
        return ("The file has no inputs: the scene's own drive the model (`laconic simulate --inputs` writes them as "
                "columns).")
    how = "held from each row to the next" if found.held else "linear between rows"
    return f"Inputs from the file, {how}: {', '.join(found.inputs)}."


def as_numbers(found: SignalReplay) -> dict[str, Any]:
    """All results for JSON."""
    how = ("held" if found.held else "linear") if found.inputs else "of the scene"
    return {
        "runs": [RunErrors(found.log.path.stem, "").as_json()],
        "scene": str(found.scene.path), "log": str(found.log.path), "rows": len(found.log.time_s),
        "begin_s": found.log.begin_s, "end_s": found.log.begin_s + float(found.log.time_s[-1]),
        "step_s": found.scene.run.step_s, "inputs": list(found.inputs), "inputs_between_rows": how,
        "left_out": list(found.left_out), "remarks": found.remarks,
        "compared": [{"signal": d.signal, "largest_difference": d.largest, "at_s": d.at_s,
                      "root_mean_square": d.root_mean_square, "largest_value": d.size} for d in found.differences]}


def draw(found: SignalReplay, folder: Path) -> list[Path]:
    """Draws the signals with the largest relative difference: file and model over time."""
    from laconic.pictures.curves import wrapped
    from laconic.pictures.plotting import figure, save

    apart = sorted(found.differences, key=lambda d: d.largest / max(d.size, 1e-300), reverse=True)[:MOST_PANELS]
    picture = figure(9.0, 1.9 * len(apart) + 1.0)
    rows = picture.subplots(len(apart), 1, sharex=True, squeeze=False)[:, 0]
    time_s = found.log.begin_s + found.log.time_s
    for axes, each in zip(rows, apart, strict=True):
        there = ~np.isnan(found.log.columns[each.signal])
        axes.plot(time_s[there], found.log.columns[each.signal][there], color="k", lw=2.4, alpha=0.35, label="file")
        axes.plot(time_s, found.model[each.signal], color="tab:blue", ls="--", label="model")
        axes.set_ylabel(each.signal, fontsize=8)
    rows[0].set_title(wrapped(f"{found.log.path.name} compared with {found.scene.name}", 80))
    rows[-1].set_xlabel("time [s]")
    picture.legend(handles=rows[0].get_legend_handles_labels()[0], loc="outside lower center", ncols=2, fontsize=9)
    save(picture, folder / "replay.png")
    return [folder / "replay.png"]
