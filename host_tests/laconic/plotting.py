"""Pictures: path, velocities, error against run time. Every axis has a label with its unit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib
import numpy as np

from laconic.method_style import look
from laconic.outputs import whole_file

if TYPE_CHECKING:
    from laconic.simulation import Trajectory

matplotlib.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402  (the backend must be chosen first)
from matplotlib.axes import Axes  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402
from matplotlib.transforms import ScaledTranslation  # noqa: E402

STYLE = {"axes.grid": True, "grid.alpha": 0.3, "axes.spines.top": False, "axes.spines.right": False,
         "font.size": 10, "axes.titlesize": 11, "legend.frameon": False, "lines.linewidth": 1.3}
ARROWS = 12


def figure(width_in: float, height_in: float) -> Figure:
    """An empty figure in the house style."""
    plt.rcParams.update(STYLE)
    return plt.figure(figsize=(width_in, height_in), layout="constrained")


def save(picture: Figure, path: Path) -> None:
    """Writes and closes a figure, in the format that its name ends in."""
    try:
        with whole_file(path) as fresh:
            picture.savefig(fresh, dpi=110, format=path.suffix.lower().lstrip(".") or "png")
    finally:
        plt.close(picture)


def plot_path(axes: Axes, run: Trajectory) -> None:
    """Where the centre of mass went, with arrows along the body's ξ axis."""
    x, y, heading = (run.columns[name] for name in ("x_m", "y_m", "heading_rad"))
    axes.plot(x, y, color="tab:blue")
    span = max(np.ptp(x), np.ptp(y), 1e-3)
    at = np.unique(np.linspace(0, len(x) - 1, ARROWS).astype(int))
    axes.quiver(x[at], y[at], np.cos(heading[at]), np.sin(heading[at]), angles=np.degrees(heading[at]),
                width=0.005, scale=14.0, color="tab:orange", zorder=3)
    axes.plot([], [], ls="", marker=r"$\rightarrow$", ms=16, color="tab:orange", label="body axis ξ")
    axes.plot(x[0], y[0], "o", color="tab:green", label="start", zorder=4)
    axes.plot(x[-1], y[-1], "s", color="tab:red", label="end", zorder=4)
    margin = 0.12 * span
    axes.set_xlim(*_around(x, span, margin))
    axes.set_ylim(*_around(y, span, margin))
    axes.set_aspect("equal", adjustable="box")
    axes.set(xlabel="x [m]", ylabel="y [m]", title="Path of the centre of mass")
    below_label = axes.transAxes + ScaledTranslation(0.0, -42 / 72, axes.figure.dpi_scale_trans)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, 0.0), bbox_transform=below_label, ncols=3, borderaxespad=0.0)


def _around(values: np.ndarray, span: float, margin: float) -> tuple[float, float]:
    """Limits that hold the values; at least a third of the other axis wide, so that a straight line keeps a frame."""
    low, high = float(np.min(values)), float(np.max(values))
    missing = max(0.0, span / 3.0 - (high - low)) / 2.0
    return low - missing - margin, high + missing + margin


def plot_velocities(axes: Axes, run: Trajectory) -> None:
    """Velocity of the centre of mass in body axes (left scale) and yaw rate (right scale)."""
    velocity = run.columns_of("velocity_body_m_per_s")
    lines = [*axes.plot(run.time_s, velocity[:, 0], label="along ξ [m/s]"),
             *axes.plot(run.time_s, velocity[:, 1], label="along η [m/s]")]
    right = axes.twinx()
    lines += right.plot(run.time_s, run.columns["yaw_rate_rad_per_s"], "--", color="tab:green",
                        label="yaw rate [rad/s]")
    right.grid(False)
    right.spines["right"].set_visible(True)
    axes.set(xlabel="time [s]", ylabel="velocity [m/s]", title="Velocities")
    right.set_ylabel("yaw rate [rad/s]")
    axes.margins(x=0.01)
    _roomy(axes), _roomy(right)
    axes.legend(handles=lines, loc="upper right", ncols=3, fontsize=9)


def plot_wheel_speeds(axes: Axes, run: Trajectory) -> None:
    """Speed of every wheel."""
    speeds = run.columns_of("wheel_speed_rad_per_s")
    for number, speed in enumerate(speeds.T, start=1):
        axes.plot(run.time_s, speed, label=f"wheel {number}")
    axes.set(xlabel="time [s]", ylabel="wheel speed [rad/s]", title="Wheel speeds")
    axes.margins(x=0.01)
    _roomy(axes)
    axes.legend(loc="upper right", ncols=min(4, max(1, speeds.shape[1])), fontsize=9)


def _roomy(axes: Axes) -> None:
    """Room above the curves for a legend; a flat curve gets a scale that does not show rounding."""
    low, high = axes.dataLim.y0, axes.dataLim.y1
    size = max(high - low, 1e-3 * max(abs(low), abs(high)), 1e-9)
    axes.set_ylim(low - 0.08 * size, high + 0.30 * size)


def plot_error_against_time(axes: Axes, points: Mapping[str, Sequence[tuple[float, float]]], floor: float) -> None:
    """Work against precision: (run time per simulated second [µs], error) for several steps of each method."""
    for name, pairs in points.items():
        if pairs:
            times, errors = zip(*pairs, strict=True)
            axes.loglog(times, np.maximum(errors, 1e-17), **look(name))
    axes.set_ylim(bottom=0.3 * min(axes.dataLim.y0, floor))
    axes.axhspan(1e-17, floor, color="0.5", alpha=0.15, lw=0, label="the reference's own")
    axes.set(xlabel="run time per simulated second [µs]", ylabel="largest relative error [–]",
             title="Error (ν, pose, wheel angles) against run time, several steps")
    axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), fontsize=9)


def simulation_picture(run: Trajectory, path: Path) -> None:
    """Path, velocities and wheel speeds of one run."""
    picture = figure(12.0, 6.0)
    places = picture.subplot_mosaic([["path", "velocities"], ["path", "wheels"]], width_ratios=(1.0, 1.25))
    picture.suptitle(f"{run.scene.name}: {run.method}, step {run.scene.run.step_s:g} s, {run.scene.run.real}")
    plot_path(places["path"], run)
    plot_velocities(places["velocities"], run)
    if run.scene.wheel_count:
        plot_wheel_speeds(places["wheels"], run)
    else:
        places["wheels"].remove()
    save(picture, path)
