"""The ground of a film: a grid in metres, the path, and the frame in which the robot moves."""

from __future__ import annotations

import numpy as np

from laconic.core.articulated import CARRIAGE
from laconic.pictures.film.timing import Timing
from laconic.pictures.outlines import outline_points
from laconic.simulation import Trajectory

GRIDS_M = tuple(digit * 10.0**power for power in range(-3, 5) for digit in (1, 2, 5))
MOST_LINES = 7
MOST_POINTS = 500  # of the path
PATH, FAINT, GRID = "#1f6fb2", "#c3d5e6", "#e6eaee"
Box = tuple[float, float, float, float]  # x, y, width, height in the picture


def world(run: Trajectory, timing: Timing, box: Box) -> tuple[str, str]:
    """The group with a place {robot} for what moves, and the rules by which path and robot move."""
    scale, centre = _fit(run, box)
    points, driven = _path(run)
    style = timing.keyframes("path", [f"stroke-dashoffset: {1.0 - driven[row]:.4f}" for row in timing.rows])
    style += timing.keyframes("body", [f"transform: {pose(run, row)}" for row in timing.rows])
    style += f".path {{ animation-name: path; }} .body {{ animation-name: body; transform: {pose(run, -1)}; }}\n"
    stroke = f'fill="none" stroke-width="{2.6 / scale:.5f}" stroke-linejoin="round"'
    left, top, width, height = box
    grid = _grid(scale, grid_m(run, box), centre, box)
    middle = f"{left + width / 2:g} {top + height / 2:g}"
    return (f'<clipPath id="field"><rect x="{left}" y="{top}" width="{width}" height="{height}" rx="6"/></clipPath>\n'
            f'<g clip-path="url(#field)"><rect x="{left}" y="{top}" width="{width}" height="{height}" fill="#f7f9fb"/>'
            f'<path d="{grid}" stroke="{GRID}" stroke-width="1.5"/>\n'
            f'<g transform="translate({middle}) scale({scale:.4f} {-scale:.4f}) '
            f'translate({-centre[0]:.4f} {-centre[1]:.4f})">'
            f'<g {stroke}><polyline id="way" points="{points}" pathLength="1" style="stroke: inherit"/>'
            f'<use href="#way" stroke="{FAINT}"/><use href="#way" class="m path" stroke="{PATH}" stroke-dasharray="1"/>'
            "</g>\n"
            f'<g class="m body">{{robot}}</g>{{bodies}}</g></g>\n', style)


def pose(run: Trajectory, row: int) -> str:
    """Place and heading of the body frame as a transformation, in metres."""
    x, y, heading = (run.columns[name][row] for name in ("origin_x_m", "origin_y_m", "heading_rad"))
    return f"translate({x:.4f}px, {y:.4f}px) rotate({np.degrees(heading):.2f}deg)"


def reach_m(run: Trajectory) -> float:
    """From the body frame's origin to the farthest end of a wheel."""
    vehicle = run.scene.vehicle
    radius = vehicle["wheel_radius_m"]
    if run.scene.has_hinges:
        return max(2.0 * radius, radius + max(map(abs, outline_points(run.scene)[CARRIAGE]), default=0.0))
    return max([2.0 * radius, *(float(np.hypot(wheel["x_m"], wheel["y_m"])) + wheel.get("radius_m", radius)
                                for wheel in vehicle["wheel"])])


def _fit(run: Trajectory, box: Box) -> tuple[float, tuple[float, float]]:
    """Pixels to a metre, and the middle of the field in metres, so that the robot stays in it."""
    reach = 1.15 * reach_m(run)
    x, y = run.columns["origin_x_m"], run.columns["origin_y_m"]
    for name, points in outline_points(run.scene).items() if run.scene.has_hinges else ():
        if name != CARRIAGE:  # all that is on hinges stays in the field, too
            reach = max(reach, 1.15 * (max(map(abs, points)) + run.scene.vehicle["wheel_radius_m"]))
            x = np.append(x, run.columns[f"body_x_m[{name}]"])
            y = np.append(y, run.columns[f"body_y_m[{name}]"])
    spans = np.ptp(x) + 2.0 * reach, np.ptp(y) + 2.0 * reach
    scale = min(box[2] / spans[0], box[3] / spans[1])
    return float(scale), (float(np.min(x) + np.max(x)) / 2.0, float(np.min(y) + np.max(y)) / 2.0)


def _path(run: Trajectory) -> tuple[str, np.ndarray]:
    """The points of the line, and the share of its length that is behind each row of the run."""
    x, y = run.columns["x_m"], run.columns["y_m"]
    along = np.concatenate(([0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))))
    drawn = np.unique(np.linspace(0, len(x) - 1, MOST_POINTS).astype(int))
    return " ".join(f"{x[row]:.4f},{y[row]:.4f}" for row in drawn), along / max(float(along[-1]), 1e-9)


def grid_m(run: Trajectory, box: Box) -> float:
    """The grid's step: 1, 2, 5, 10 … of some power of ten metres."""
    return next(each for each in GRIDS_M if box[2] / (_fit(run, box)[0] * each) <= MOST_LINES)


def _grid(scale: float, step: float, centre: tuple[float, float], box: Box) -> str:
    """The grid's lines."""
    left, top, width, height = box
    middle = left + width / 2.0, top + height / 2.0
    lines = []
    for at in np.arange(np.ceil(-width / 2.0 / scale + centre[0]) - step, centre[0] + width / 2.0 / scale, step):
        lines.append(f"M{middle[0] + scale * (round(at / step) * step - centre[0]):.1f} {top}v{height}")
    for at in np.arange(np.ceil(-height / 2.0 / scale + centre[1]) - step, centre[1] + height / 2.0 / scale, step):
        lines.append(f"M{left} {middle[1] - scale * (round(at / step) * step - centre[1]):.1f}h{width}")
    return "".join(lines)
