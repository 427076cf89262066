"""A robot from above: where its wheels stand, which way they roll, how their rollers lie."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Polygon

from laconic.core import load
from laconic.pictures.curve_style import wrapped
from laconic.pictures.plotting import figure
from laconic.scene import Scene
from laconic.tools.report.svg import SIZE, TITLE_LETTERS, svg

WIDTH = 0.7         # of a drawn wheel, in wheel radii
ROLLERS = np.array([-0.66, 0.0, 0.66])  # where rollers are drawn on the tread, in wheel radii


def plan(scene: Scene) -> str:
    """Body axes ξ ahead (up), η to the left; wheels from above, the roller that touches the ground as a line."""
    picture = figure(*SIZE)
    axes = picture.add_subplot()
    plant = scene.with_run(real="double").plant(load("double"))  # owns the memory of its model
    radius = float(plant.c.model.wheel_radius_m)
    for number, wheel in enumerate(scene.vehicle["wheel"], start=1):
        _wheel(axes, wheel, number, wheel.get("radius_m") or radius)
    for support in scene.vehicle["support"]:
        axes.plot(-support["y_m"], support["x_m"], "o", color="0.55", mfc="none", ms=9)
    if scene.vehicle["support"]:
        axes.plot([], [], "o", color="0.55", mfc="none", ms=8, ls="", label="support")
    _centre(axes, scene, radius)
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.12)
    axes.set(xlabel="η, to the left [m]", ylabel="ξ, ahead [m]", title=wrapped(scene.name, TITLE_LETTERS))
    axes.xaxis.set_major_formatter(lambda value, _: f"{-value:g}" if abs(value) > 1e-12 else "0")
    picture.legend(fontsize=8, loc="outside lower center", ncols=2)
    return svg(picture)


def _on_paper(x_m: np.ndarray, y_m: np.ndarray) -> np.ndarray:
    """ξ upwards and η to the left."""
    return np.column_stack([-np.atleast_1d(y_m), np.atleast_1d(x_m)])


def _wheel(axes: Axes, wheel: dict[str, Any], number: int, radius: float) -> None:
    """A tread along the direction the wheel rolls, with its rollers (thin) across."""
    axle = np.array([np.cos(wheel["axle_rad"]), np.sin(wheel["axle_rad"])])
    rolls, at = np.array([-axle[1], axle[0]]), np.array([wheel["x_m"], wheel["y_m"]])
    half = 0.5 * WIDTH * radius
    corners = np.array([at + a * radius * rolls + b * half * axle for a, b in ((1, 1), (1, -1), (-1, -1), (-1, 1))])
    fixed = wheel["kind"] == "fixed"
    tread = Polygon(_on_paper(*corners.T), closed=True, facecolor="#5b6470" if fixed else "#dfe5ec",
                    edgecolor="#1c1f24", linewidth=1.0, zorder=2)
    axes.add_patch(tread)
    axes.update_datalim(_on_paper(*corners.T))
    if not fixed:
        angle = wheel["axle_rad"] + wheel["roller_rad"]
        across = np.array([np.cos(angle), np.sin(angle)])
        reach = min(half / max(abs(across @ axle), 1e-9), 0.3 * radius)
        for share in ROLLERS:
            ends = np.array([at + share * radius * rolls + side * reach * across for side in (-1.0, 1.0)])
            axes.plot(*_on_paper(*ends.T).T, color="#3066be", lw=1.6, zorder=3)
    outside = at * (1.0 + 1.9 * radius / max(float(np.hypot(*at)), radius))
    axes.annotate(str(number), _on_paper(*outside)[0], ha="center", va="center", fontsize=8)
    axes.update_datalim(_on_paper(*outside))


def _centre(axes: Axes, scene: Scene, radius: float) -> None:
    """Centre of mass, body axis ξ, and what the signs mean."""
    com = _on_paper(scene.vehicle.get("com_x_m", 0.0), scene.vehicle.get("com_y_m", 0.0))[0]
    axes.annotate("", xy=(0.0, 2.5 * radius), xytext=(0.0, 0.0),
                  arrowprops={"arrowstyle": "-|>", "color": "#e9a23b", "lw": 1.6})
    axes.plot([], [], color="#e9a23b", label="body axis ξ")
    axes.plot(*com, "k+", ms=11, mew=1.6, ls="", label="centre of mass")
    if any(wheel["kind"] != "fixed" for wheel in scene.vehicle["wheel"]):
        axes.plot([], [], color="#3066be", label="roller axis, at the ground")
    axes.update_datalim([(0.0, 2.5 * radius), (0.0, 0.0)])
