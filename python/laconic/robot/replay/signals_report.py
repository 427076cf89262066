"""Results of the replay of a run whose columns are signals: a report, numbers for JSON, a picture."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from laconic.pictures.curve_style import wrapped
from laconic.robot.replay.measures import RunErrors
from laconic.robot.replay.signals import SignalReplay

MOST_PANELS = 6


def as_text(found: SignalReplay) -> str:
    """A report in Markdown."""
    log, run = found.log, found.scene.run
    lines = [f"# {log.path.name} beside {found.scene.name}", "",
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
    rows[0].set_title(wrapped(f"{found.log.path.name} beside {found.scene.name}", 80))
    rows[-1].set_xlabel("time [s]")
    picture.legend(handles=rows[0].get_legend_handles_labels()[0], loc="outside lower center", ncols=2, fontsize=9)
    save(picture, folder / "replay.png")
    return [folder / "replay.png"]
