"""`laconic replay`: what the model predicts from a log beside what it has: paths, wheel speeds, currents."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from laconic.errors import BadInput
from laconic.robot.logs import Log
from laconic.robot.logs.log import counted, remarks_of
from laconic.robot.replay.measures import RunErrors, grand_mean, session_means
from laconic.robot.replay.missed_wraps import fitting, rolled_alone
from laconic.robot.replay.poor_fit import words_of_poor
from laconic.robot.replay.predicted import predict
from laconic.scene import Scene
from laconic.scene.ground import slips

MOST_PANELS = 12
SAID = {
    "wheel-speeds": "the recorded rotation of the wheels, rolled without slip",
    "steered": "the recorded rotation of the wheels at the recorded steering angles, rolled without slip",
    "steered with friction": "the recorded rotation of the wheels, or the commanded speed, at the recorded steering "
                             "angles, on ground with friction",
    "held": "the recorded rotation of the wheels, held by strong motors on ground with friction",
    "currents": "the recorded currents, as torques",
    "voltages": "the recorded voltages",
    "set-speeds": "the recorded set speeds, through the speed controller of the scene"}


@dataclass(frozen=True)
class RolledPaths:
    """The predicted path of each run, and its errors."""

    scene: Scene
    logs: list[Log]
    paths: list[np.ndarray]
    errors: list[RunErrors]
    skipped: list[str]
    inputs: str = "wheel-speeds"

    @cached_property
    def poor(self) -> list[str]:
        """A sentence where the fit is poor."""
        return words_of_poor(self.scene, self.logs, self.errors, self.inputs)


def roll(scene: Scene, logs: Sequence[Log], skipped: Sequence[Path] = (), inputs: str = "wheel-speeds") -> RolledPaths:
    """A prediction for every run; BadInput where no log has a true pose to compare a path with."""
    if inputs == "wheel-speeds":
        scene, [logs] = rolled_alone(scene, logs)
    runs = fitting(scene, logs)
    if inputs == "wheel-speeds" and all(log.pose is None for log in runs):
        other = next((f", or take --inputs {name}" for name, values in (
            ("voltages", runs[0].voltage_V), ("currents", runs[0].current_A)) if values is not None), "")
        raise BadInput(f"{runs[0].path}: has no true pose to compare with; name its columns in the map, table "
                       f"[pose]{other}")
    found = predict(scene, runs, inputs)
    return RolledPaths(scene, runs, [path for path, _ in found], [errors for _, errors in found],
                       [path.name for path in skipped], inputs)


def as_numbers(found: RolledPaths) -> dict[str, Any]:
    """For JSON."""
    return {"runs": [each.as_json() for each in found.errors], "remarks": [*found.poor, *remarks_of(found.logs)]}


def as_text(found: RolledPaths) -> str:
    """A report in Markdown."""
    lines = [f"# {counted(len(found.logs), 'run')} compared with {found.scene.name}", "",
             f"Inputs: {_said(found)}.", "", *error_table(found.errors)]
    lines += ["", *(f"**{each}**" for each in found.poor)] if found.poor else []
    lines += remark_lines(found.logs)
    if found.skipped:
        lines += ["", f"Left out, no logs that the map recognises: {', '.join(dict.fromkeys(found.skipped))}."]
    return "\n".join([*lines, ""])


def remark_lines(logs: Sequence[Log]) -> list[str]:
    """What was left out of the files or filled in; nothing where they are taken as they are."""
    remarks = remarks_of(logs)
    return ["", "Left out or filled in:", "", *(f"* {each}" for each in remarks)] if remarks else []


def _said(found: RolledPaths) -> str:
    if found.inputs != "wheel-speeds":
        return SAID[found.inputs]
    if found.scene.has_hinges:
        return SAID["steered with friction" if slips(found.scene.vehicle) else "steered"]
    return SAID["held"] if slips(found.scene.vehicle) else SAID["wheel-speeds"]


def error_table(errors: Sequence[RunErrors]) -> list[str]:
    """A row for each run, the mean of each session, and the mean over the sessions."""
    lines = ["| session | run | path error [%] | displacement error [%] | heading at the end [rad] | "
             "wheel speeds [%] | steady currents [A] |", "| --- " * 7 + "|"]
    means = {each.session: each for each in session_means(errors)}
    for session, mean in means.items():
        lines += [_row(each) for each in errors if each.session == session]
        if sum(each.session == session for each in errors) > 1:
            lines.append(_row(mean))
    return [*lines, _row(grand_mean(errors))] if len(means) > 1 else lines


def _row(each: RunErrors) -> str:
    cells = [_share(each.path_error), _share(each.displacement_error), _number(each.heading_error_rad),
             _share(each.wheel_speed_error), _number(each.current_error_A)]
    name = f"**{each.run}**" if each.run.startswith("mean") else each.run.removeprefix(f"{each.session}/")
    return f"| {each.session} | {name} | {' | '.join(cells)} |"


def _share(value: float | None) -> str:
    return "–" if value is None else f"{100.0 * value:.3f}"


def _number(value: float | None) -> str:
    return "–" if value is None else f"{value:.4f}"


def draw(found: RolledPaths, folder: Path) -> list[Path]:
    """The paths of the first runs: true and predicted."""
    from laconic.pictures.plotting import figure, save

    shown = [(log, path, each) for log, path, each in zip(found.logs, found.paths, found.errors, strict=True)
             if log.pose is not None][:MOST_PANELS]
    columns = min(3, len(shown))
    rows = -(-len(shown) // columns)
    picture = figure(4.0 * columns, 3.6 * rows + 0.6)
    panels = picture.subplots(rows, columns, squeeze=False).ravel()
    several = len({each.session for _, _, each in shown}) > 1
    for axes, (log, path, each) in zip(panels, shown, strict=False):
        assert log.pose is not None
        axes.plot(log.pose[:, 0], log.pose[:, 1], color="k", lw=2.4, alpha=0.35, label="true")
        axes.plot(path[:, 0], path[:, 1], color="tab:blue", lw=1.0, label="predicted")
        axes.set_aspect("equal", "datalim")
        session = f"{each.session}\n" if several else ""
        axes.set_title(f"{session}{each.run}: {_share(each.path_error)} %", fontsize=11)
    for axes in panels[len(shown):]:
        axes.remove()
    panels[0].set(xlabel="x [m]", ylabel="y [m]")
    picture.legend(handles=panels[0].get_legend_handles_labels()[0], loc="outside lower center", ncols=2, fontsize=9)
    save(picture, folder / "paths.png")
    if slips(found.scene.vehicle) and not found.scene.has_hinges:
        from laconic.robot.replay.report import draw_drag

        return [folder / "paths.png", draw_drag(found.scene, found.logs, folder)]
    return [folder / "paths.png"]
