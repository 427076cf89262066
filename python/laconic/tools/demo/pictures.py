"""The demo's picture of one scene: path, velocities, error against run time."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from laconic.pictures.plotting import (
    figure,
    mark_ground,
    plot_error_against_time,
    plot_path,
    plot_velocities,
    save,
    title,
)
from laconic.simulation import Trajectory
from laconic.tools.demo.work import Point


def draw(run: Trajectory, points: Sequence[Point], floor: float, path: Path) -> None:
    """Writes the picture."""
    picture = figure(13.0, 7.6)
    axes = picture.subplot_mosaic([["path", "velocities"], ["path", "error"]], width_ratios=(1.0, 1.35))
    title(picture, f"{run.steps} steps of {run.scene.run.step_s:g} s by {run.method}", run)
    plot_velocities(axes["velocities"], run)
    mark_ground(axes, run)
    plot_path(axes["path"], run)
    curves: dict[str, list[tuple[float, float]]] = {}
    for point in points:
        curves.setdefault(point.method, [])
        if point.error is not None and point.us_per_s is not None:
            curves[point.method].append((point.us_per_s, point.error))
    plot_error_against_time(axes["error"], curves, floor)
    save(picture, path)
