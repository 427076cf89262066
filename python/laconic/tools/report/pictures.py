"""The report's pictures, each as SVG text small enough for a phone's width."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from laconic.pictures.curve_style import alternating_markers, nested, wrapped
from laconic.pictures.method_style import style_of
from laconic.pictures.plotting import figure
from laconic.scene import METHODS
from laconic.tools.report.svg import SIZE, TITLE_LETTERS, svg

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
