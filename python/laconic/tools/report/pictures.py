"""The report's pictures, each as SVG text small enough for a phone's width.

A figure as text inside a page, small enough for a phone's width.

A robot from above: where its wheels stand, which way they roll, how their rollers lie.
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from laconic.core import load
from laconic.pictures.curves import alternating_markers, nested, style_of, wrapped
from laconic.pictures.plotting import check_formulas, figure
from laconic.scene import METHODS, Scene

SIZE = (4.5, 3.9)  # inches; at a phone's 390 pixels its letters are still of reading size
TITLE_LETTERS = 44  # in a line of that width


def svg(picture: Figure) -> str:
    """The figure as an svg element without prolog; text stays text, identifiers stay the same in every run."""
    check_formulas(picture)
    out = io.StringIO()
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "laconic"}):
        picture.savefig(out, format="svg", metadata={"Date": None})
    plt.close(picture)
    text = out.getvalue()
    return text[text.index("<svg"):]


Row = dict[str, Any]
FLOOR, REFERENCE = 1e-16, 1e-11  # below the second, errors are the reference's own as much as the method's
LETTERS, MARKS = 8, 3.5


def _lines(axes: Axes, rows: Sequence[Row], x: str, y: str, style: Row) -> None:
    points = sorted((row[x], max(row[y], FLOOR)) for row in rows if row.get(y) is not None and np.isfinite(row[y]))
    if points:
        axes.loglog(*zip(*points, strict=True), **style)


def _legend_below(picture: Figure, axes: Axes, columns: int = 2) -> None:
    """A legend outside of the axes, where it covers no curve; three columns would be cut on a phone."""
    handles, labels = axes.get_legend_handles_labels()
    picture.legend(handles, labels, fontsize=LETTERS, loc="outside lower center", ncols=columns)


def error_against_time(rows: Sequence[Row], scene: str, title: str = "") -> str:
    """One scene: error of ν over run time; full lines double, dashed single. The scene's own step is marked."""
    picture = figure(*SIZE)
    axes = picture.add_subplot()
    mine = [r for r in rows if r["scene"] == scene]
    alone = all(r["method"] == "auto" for r in mine)  # else its points lie on another method's, and have no line
    for method in METHODS:
        for real, line, name in (("double", "-", method), ("single", "--", None)):
            chosen = [r for r in mine if (r["method"], r["real"]) == (method, real)]
            style = style_of(method, MARKS, label=name)
            if alone:
                style |= {"linestyle": line, "markersize": MARKS * (2.0 if real == "double" else 1.2),
                          "markerfacecolor": "none" if real == "double" else style["color"]}
            elif method != "auto":
                style["linestyle"] = line
            _lines(axes, chosen, "us_per_second", "error_nu", style)
    axes.plot([], [], "-", color="0.4", label="double")
    axes.plot([], [], "--", color="0.4", label="single")
    own = [r for r in mine if r.get("own")]
    if own:
        _lines(axes, own, "us_per_second", "error_nu", {
            "marker": "o", "markersize": 12, "color": "#f2dc7e", "linestyle": "none", "zorder": 0.5,
            "label": f"the scene's own step, {own[0]['step_s']:g} s"})
    mark_reference(axes, mine)
    axes.set(xlabel="run time per simulated second [µs]", ylabel="error of ν, relative",
             title=wrapped(title or scene, TITLE_LETTERS))
    _legend_below(picture, axes)
    return svg(picture)


def mark_reference(axes: Axes, rows: Sequence[Row]) -> None:
    """The band in which an error may be the reference's own: of a run in finer steps what that is found to be."""
    errors = [r["error_nu"] for r in rows if r.get("error_nu") is not None and np.isfinite(r["error_nu"])]
    if not errors:
        return
    reference = max((r["reference_error_nu"] for r in rows if "reference_error_nu" in r), default=REFERENCE)
    reference = max(reference, FLOOR)
    low, high = 0.3 * min(*errors, reference), 3.0 * max(*errors, reference)
    axes.set_ylim(max(low, 0.3 * FLOOR), high)
    axes.axhspan(max(low, 0.3 * FLOOR), reference, color="0.5", alpha=0.15, lw=0, label="error of the reference itself")


def precision(rows: Sequence[Row]) -> str:
    """S1 with integrators of other projects."""
    picture = figure(SIZE[0], SIZE[1] + 0.9)
    axes = picture.add_subplot()
    for method in METHODS[1:]:
        mine = [r for r in rows if r["who"] == method and r["real"] == "double"]
        _lines(axes, mine, "ms", "error_nu", style_of(method, MARKS))
    others = sorted({r["who"] for r in rows} - set(METHODS))
    greys = np.linspace(0.15, 0.75, max(1, len(others)))
    for name, grey, marker in zip(others, greys, "xxxx1234+*"[: len(others)].ljust(len(others), "x"), strict=True):
        _lines(axes, [r for r in rows if r["who"] == name], "ms", "error_nu",
               style_of(name, MARKS + 1.0, color=str(round(float(grey), 2)), linestyle=":", marker=marker))
    axes.axhline(1e-6, color="0.6", linewidth=0.8, label="error of 1e-6")
    axes.set(xlabel="run time of all ten seconds [ms]", ylabel="largest error of ν [rad/s]", title="S1")
    _legend_below(picture, axes)
    return svg(picture)


def stability(rows: Sequence[Row], method: str, own: tuple[float, float] | None = None,
              whose: str = "") -> str:
    """Step across, damping upwards, error as colour; refused steps are grey. `own`: a robot's step and damping."""
    mine = [r for r in rows if r["method"] == method]
    steps = sorted({r["step_s"] for r in mine})
    rates = sorted({r["fastest_decay_per_s"] for r in mine})
    error = np.full((len(rates), len(steps)), np.nan)
    for r in mine:
        if r["status"] == "ok":
            error[rates.index(r["fastest_decay_per_s"]), steps.index(r["step_s"])] = max(r["error_nu"], FLOOR)
    picture = figure(*SIZE)
    axes = picture.add_subplot()
    axes.set_facecolor("#c9c9c9")
    mesh = axes.pcolormesh(_edges(steps), _edges(rates), error, norm=LogNorm(FLOOR, 1.0), cmap="viridis_r",
                           rasterized=False)
    left, right = _edges(steps)[[0, -1]]
    if own:
        left, right = min(left, 0.8 * own[0]), max(right, 1.25 * own[0])
        axes.plot(*own, "*", color="#d1495b", markeredgecolor="white", ms=13, ls="", label="this robot at its own step")
    across = np.array([left, right])
    axes.plot(across, 1.0 / across, color="white", linewidth=1.6)
    axes.plot(across, 1.0 / across, color="0.2", linewidth=0.9, linestyle="--", label="h·r = 1")
    axes.plot([], [], "s", color="#c9c9c9", ms=8, label="refused or not run")
    axes.set(xscale="log", yscale="log", xlabel="step h [s]", ylabel="fastest damping r [1/s]",
             title=method + whose,
             ylim=(_edges(rates)[0], _edges(rates)[-1]), xlim=(left, right))
    axes.grid(False)
    picture.colorbar(mesh, ax=axes, label="error of ν, relative")
    _legend_below(picture, axes)
    return svg(picture)


def _edges(values: Sequence[float]) -> np.ndarray:
    middle = np.log(np.asarray(values))
    between = 0.5 * (middle[1:] + middle[:-1])
    return np.exp(np.concatenate([[2 * middle[0] - between[0]], between, [2 * middle[-1] - between[-1]]]))


def drift(rows: Sequence[Row], real: str, what: str) -> str:
    """Largest relative change so far over the number of steps; curves that coincide show through each other."""
    picture = figure(*SIZE)
    axes = picture.add_subplot()
    count = len(METHODS[1:])
    for order, method in enumerate(METHODS[1:]):
        mine = [r for r in rows if r["method"] == method and r["real"] == real and r["status"] == "ok"]
        _lines(axes, mine, "steps", what, style_of(method, MARKS + 1.0, markevery=alternating_markers(order, count),
                                           **nested(order, count)))
    name = {"K": "the yaw integral K = (Aν)₃"}.get(what, what)
    axes.set(xlabel="steps of 0.1 s", ylabel="relative change so far", title=f"{name}, {real}")
    _legend_below(picture, axes)
    return svg(picture)


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
