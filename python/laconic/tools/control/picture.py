"""Pictures of a drive: the course with the truth and the estimate's ellipses, errors beside what the filter says of
them, and voltages beside their limits."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse

from laconic.base.outputs import check_ending
from laconic.base.paths import as_path
from laconic.core.given import shown
from laconic.errors import BadInput
from laconic.pictures.plotting import figure, save
from laconic.tools.control.course import Course
from laconic.tools.control.node_loop import Drive

ENDINGS = (".png", ".svg", ".pdf")
ELLIPSES = 16
TRUTH, ESTIMATE, COURSE, OPEN = "#1d3557", "#c1121f", "#9aa0a6", "#e09f3e"
SIGMAS = 3.0


def plot_drive(run: Drive, course: Course, path: str | Path | None = None, *, limit_V: float | None = None,
               open_loop: Drive | None = None) -> Figure:
    """The picture of a drive along a course; written to `path` where one is given."""
    if path is not None:
        check_ending("path", as_path("path", path), ENDINGS)
    for name, given, kind, what in (("run", run, Drive, "drive; give what drive() gave"),
                                    ("course", course, Course, "course; give a laconic.tools.control.Course")):
        if not isinstance(given, kind):
            raise BadInput(f"{name}: {shown(given)} is no {what}")
    picture = figure(11.0, 6.2)
    grid = picture.add_gridspec(3, 2, width_ratios=(1.25, 1.0))
    plot_course(picture.add_subplot(grid[:, 0]), run, course, open_loop)
    plot_errors(picture.add_subplot(grid[0, 1]), run, 0, "error of x [mm]", 1e3)
    plot_errors(picture.add_subplot(grid[1, 1]), run, 2, "error of heading [mrad]", 1e3)
    plot_voltages(picture.add_subplot(grid[2, 1]), run, limit_V)
    if path is not None:
        save(picture, as_path("path", path))
    return picture


def plot_course(axes: Axes, run: Drive, course: Course, open_loop: Drive | None) -> None:
    """From above."""
    truth, estimate = np.array(run.truth), np.array(run.estimate)
    axes.plot(course.states[:, 3], course.states[:, 4], color=COURSE, linewidth=5.0, alpha=0.5, label="course")
    if open_loop is not None:
        away = np.array(open_loop.truth)
        axes.plot(away[:, 0], away[:, 1], color=OPEN, linestyle="--", label="the course's voltages alone")
    axes.plot(truth[:, 0], truth[:, 1], color=TRUTH, label="robot")
    axes.plot(estimate[:, 3], estimate[:, 4], color=ESTIMATE, linewidth=0.8, label="estimate")
    for row in np.linspace(0, len(truth) - 1, ELLIPSES).astype(int):
        axes.add_patch(ellipse(estimate[row, 3:5], run.covariance[row][3:5, 3:5]))
    axes.add_patch(Ellipse((np.nan, np.nan), 1, 1, fill=False, color=ESTIMATE, label=f"its {SIGMAS:g} σ"))
    axes.set(xlabel="x [m]", ylabel="y [m]", title="From above")
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.08), ncols=3)


def ellipse(centre: np.ndarray, covariance: np.ndarray) -> Ellipse:
    """Where a place is to SIGMAS standard deviations along either axis."""
    squares, axes = np.linalg.eigh(covariance)
    width, height = 2 * SIGMAS * np.sqrt(np.maximum(squares, 0.0))
    angle = float(np.degrees(np.arctan2(axes[1, 0], axes[0, 0])))
    return Ellipse((float(centre[0]), float(centre[1])), width, height, angle=angle, fill=False, color=ESTIMATE,
                   linewidth=0.9)


def plot_errors(axes: Axes, run: Drive, number: int, label: str, scale: float) -> None:
    """One number of the pose, within what the filter says of it."""
    off, std = scale * run.pose_error[:, number], scale * SIGMAS * run.pose_std[:, number]
    axes.fill_between(run.time_s, -std, std, color=ESTIMATE, alpha=0.15, linewidth=0, label=f"±{SIGMAS:g} σ")
    axes.plot(run.time_s, off, color=ESTIMATE)
    axes.set(ylabel=label)
    axes.legend(loc="upper right")


def plot_voltages(axes: Axes, run: Drive, limit_V: float | None) -> None:
    """All wheels, and the limits."""
    for wheel, volts in enumerate(np.array(run.voltage_V).T, start=1):
        axes.step(run.time_s, volts, where="pre", linewidth=1.0, label=f"wheel {wheel}")
    for limit in () if limit_V is None else (-limit_V, limit_V):
        axes.axhline(limit, color="black", linestyle=":", linewidth=1.0)
    axes.set(xlabel="time [s]", ylabel="voltage [V]")
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 0.98), ncols=4, fontsize=8)
