"""Pictures: path, velocities, error against run time. Every axis has a label with its unit."""

from __future__ import annotations

import os
import sys
import textwrap
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import matplotlib
import numpy as np

from laconic.base.outputs import check_ending, check_file, whole_file
from laconic.base.paths import as_path
from laconic.core.given import shown
from laconic.errors import BadInput
from laconic.pictures.articulated import is_drawn, plot_hinges, plot_slipping, plot_vehicle_path, slipping_panels
from laconic.pictures.curves import (
    head,
    plot_beside_yaw_rate,
    plot_over_time,
    plot_sensors,
    sensor_panels,
    style_of,
    wrapped,
)

if TYPE_CHECKING:
    from laconic.simulation import Trajectory

if "MPLBACKEND" not in os.environ and "matplotlib.pyplot" not in sys.modules:  # a notebook keeps its own
    matplotlib.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402  (the backend must be chosen first)
from matplotlib.axes import Axes  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402
from matplotlib.mathtext import MathTextParser  # noqa: E402
from matplotlib.text import Text  # noqa: E402
from matplotlib.transforms import ScaledTranslation  # noqa: E402

STYLE: dict[Any, Any] = {"axes.grid": True, "grid.alpha": 0.3, "axes.spines.top": False, "axes.spines.right": False,
         "font.size": 10, "axes.titlesize": 11, "legend.frameon": False, "lines.linewidth": 1.3,
         "agg.path.chunksize": 20_000}  # a path of millions of points does not fit the renderer in one piece
ARROWS = 12
TICK = r"$\mathdefault{"  # how matplotlib begins the number at a tick, which is a formula
LETTERS = 110  # in a line of a run's title
ERROR_CAPTION = (
    "Error: the largest difference to an independent integrator of tight tolerance, over max(1, the largest value).\n"
    "ν: pseudo-velocities. Each point is a step size; a smaller step takes more time and lies further right. In the\n"
    "grey band, that integrator's own error is as large as the difference, which then means nothing more.")
SLIPS, LIFTS = "#c1121f", "#7b2cbf"


def figure(width_in: float, height_in: float) -> Figure:
    """An empty figure in the house style."""
    plt.rcParams.update(STYLE)
    return plt.figure(figsize=(width_in, height_in), layout="constrained")


def save(picture: Figure, path: Path) -> None:
    """Writes and closes a figure, in the format that its name ends in."""
    check_formulas(picture)
    try:
        with whole_file(path) as fresh, warnings.catch_warnings():
            warnings.filterwarnings("ignore", "Glyph .* missing from")  # a box stands for it in the picture
            picture.savefig(fresh, dpi=110, format=path.suffix.lower().lstrip(".") or "png")
    finally:
        plt.close(picture)


def check_formulas(picture: Figure) -> None:
    """Names with dollars that are no formula ("robot for $5, not $6^") are shown as they stand.

    Line by line, as a formula never runs over the end of one: a line feed would be a letter without a glyph.
    """
    for text in picture.findobj(Text):
        try:
            for line in text.get_text().splitlines():
                if "$" in line and not line.startswith(TICK):
                    MathTextParser("path").parse(line)
        except ValueError:
            text.set_parse_math(False)


def plot_path(axes: Axes, run: Trajectory) -> None:
    """Where the centre of mass went, with arrows along the body's ξ axis."""
    x, y, heading = (run.columns[name] for name in ("x_m", "y_m", "heading_rad"))
    axes.plot(x, y, color="tab:blue")
    span = max(np.ptp(x), np.ptp(y), 1e-3)
    at = np.unique(np.linspace(0, len(x) - 1, ARROWS).astype(int))
    axes.quiver(x[at], y[at], np.cos(heading[at]), np.sin(heading[at]), angles=np.degrees(heading[at]),
                width=0.005, scale=14.0, color="tab:orange", zorder=3)
    axes.plot([], [], ls="", marker=r"$\rightarrow$", ms=16, color="tab:orange", label="body axis ξ")
    axes.plot(x[0], y[0], "o", ms=15, mfc="none", mew=2.0, color="tab:green", label="start", zorder=4)
    axes.plot(x[-1], y[-1], "s", color="tab:red", label="end", zorder=4)
    margin = 0.12 * span
    axes.set_xlim(*_around(x, span, margin))
    axes.set_ylim(*_around(y, span, margin))
    axes.set_aspect("equal", adjustable="box")
    axes.set(xlabel="x [m]", ylabel="y [m]", title="Path of the centre of mass")
    below_label = axes.transAxes + ScaledTranslation(0.0, -42 / 72, axes.figure.dpi_scale_trans)
    ncols = 3 if len(axes.get_legend_handles_labels()[0]) == 3 else 2
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, 0.0), bbox_transform=below_label, ncols=ncols,
                borderaxespad=0.0)


def _around(values: np.ndarray, span: float, margin: float) -> tuple[float, float]:
    """Limits that hold the values; at least a third of the other axis wide, so that a straight line keeps a frame."""
    low, high = float(np.min(values)), float(np.max(values))
    missing = max(0.0, span / 3.0 - (high - low)) / 2.0
    return low - missing - margin, high + missing + margin


def plot_velocities(axes: Axes, run: Trajectory) -> None:
    """Velocity of the centre of mass in body axes (left scale) and yaw rate (right scale), with a common zero."""
    velocity = run.columns_of("velocity_body_m_per_s")
    handles = plot_beside_yaw_rate(axes, run.time_s, velocity, ("along ξ [m/s]", "along η [m/s]"),
                                   run.columns["yaw_rate_rad_per_s"])
    axes.set_ylabel("velocity [m/s]")
    head(axes, "Velocities", handles)


def plot_wheel_speeds(axes: Axes, run: Trajectory) -> None:
    """Speed of every wheel: curves, or where there are too many to tell apart, a row of colour for each."""
    speeds = run.columns_of("wheel_speed_rad_per_s")
    plot_over_time(axes, run, speeds, [f"wheel {i}" for i in range(1, speeds.shape[1] + 1)],
                   ("wheel speed [rad/s]", "Wheel speeds"), "wheel")


def mark_ground(panels: Mapping[str, Axes], run: Trajectory) -> None:
    """The first instants at which a wheel would slip and one would lift, along the path and over time."""
    if run.grip is None:
        return
    marks = ((run.grip.first_slip, "slips", SLIPS, 12.0), (run.grip.first_lift, "lifts", LIFTS, 6.5))
    for event, word, colour, size in marks:  # of two sizes, as they may be one instant
        if event is None:
            continue
        x, y = (np.interp(event.time_s, run.time_s, run.columns[name]) for name in ("x_m", "y_m"))
        panels["path"].plot(x, y, "X", ms=size, color=colour, mec="white", zorder=6,
                            label=f"{event.where} {word} first, {event.time_s:g} s")
        for name in ("velocities", "wheels"):
            if name in panels:
                panels[name].axvline(event.time_s, color=colour, lw=size / 5.0, zorder=1.5)
                panels[name].plot(event.time_s, 0.04, "X", ms=size, color=colour, mec="white", zorder=6,
                                  transform=panels[name].get_xaxis_transform())


def plot_error_against_time(axes: Axes, points: Mapping[str, Sequence[tuple[float, float]]], floor: float) -> None:
    """Work against precision: (run time per simulated second [µs], error) for several steps of each method."""
    for name, pairs in points.items():
        if pairs:
            times, errors = zip(*pairs, strict=True)
            axes.loglog(times, np.maximum(errors, 1e-17), **style_of(name))
    axes.set_ylim(bottom=0.3 * min(axes.dataLim.y0, floor))
    axes.axhspan(1e-17, floor, color="0.5", alpha=0.15, lw=0, label="below the\nreference's error")
    axes.set(xlabel="run time per simulated second [µs]", ylabel="largest relative error [–]")
    axes.set_title("Error (ν, pose, wheel angles) against run time, several steps", loc="left")
    axes.annotate(ERROR_CAPTION, (0.0, 0.0), xycoords="axes fraction", xytext=(0.0, -36.0),
                  textcoords="offset points", va="top", fontsize=8, color="0.35")
    axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), fontsize=9)


def simulation_picture(run: Trajectory, path: Path) -> None:
    """Writes the picture of one run."""
    save(run_figure(run), path)


def plot(run: Trajectory, path: str | Path | None = None) -> Figure:
    """Path, velocities, wheel speeds and sensors of a run over time, as `laconic simulate --plot` draws them.

    With `path` (.png, .svg or .pdf) the picture is written there, too. Raises BadInput for a run that has not kept the
    usual signals, and for a path that cannot be written.
    """
    from laconic.simulation import Trajectory, usual_signals

    if not isinstance(run, Trajectory):
        raise BadInput(f"run: {shown(run)} is no run; give what laconic.simulate(scene) returns")
    if missing := [name for name in usual_signals(run.scene) if name not in run.columns]:
        raise BadInput(f"run: has not kept {missing[0]}; simulate without `signals` and [outputs], or name it there")
    target = None if path is None else as_path("path", path)
    if target is not None:
        check_ending("path", target, (".png", ".svg", ".pdf"))
        check_file("path", target)
    picture = run_figure(run)
    check_formulas(picture)
    if target is not None:
        save(picture, target)
    return picture


def run_figure(run: Trajectory) -> Figure:
    """Path, velocities and wheel speeds of one run, what its sensors show, and where the ground could not give what it
    needs."""
    sensors = sensor_panels(run)
    hinges = ["hinges"] if run.scene.has_hinges else []
    slipping = slipping_panels(run)
    picture = figure(12.0, 7.0 + 3.5 * len(sensors) + 2.5 * (len(hinges) + len(slipping)))
    below = "wheels" if run.scene.wheel_count else "velocities"
    rows = ["velocities", *hinges, below, *slipping, *sensors]
    panels = picture.subplot_mosaic([["path", row] for row in rows], width_ratios=(1.0, 1.25))
    title(picture, f"{run.method}, step {run.scene.run.step_s:g} s, {run.scene.run.real}", run)
    plot_velocities(panels["velocities"], run)
    if run.scene.wheel_count:
        plot_wheel_speeds(panels["wheels"], run)
    for panel in slipping:
        plot_slipping(panels[panel], panel, run)
    for panel in sensors:
        plot_sensors(panel, panels[panel], run)
    mark_ground(panels, run)
    if hinges:
        plot_hinges(panels["hinges"], run)
    if hinges and is_drawn(run):
        plot_vehicle_path(panels["path"], run)
    else:
        plot_path(panels["path"], run)
    return picture


def title(picture: Figure, text: str, run: Trajectory) -> None:
    """The picture's title: the scene's name and `text`; at the foot in red what is wrong with the run."""
    missing = run.grip.warning() if run.grip else ""
    at_foot = [f"The ground cannot give what this run needs: {missing}"] if missing else []
    at_foot += [f"The run ends before its time: {run.refused}"] if run.refused else []
    lines = [line for each in at_foot for line in textwrap.wrap(each, 150)]
    picture.suptitle(wrapped(run.scene.name, LETTERS, text))
    if lines:
        picture.supxlabel("\n".join(lines), color=SLIPS, fontsize=9)
