"""The report's pictures, each as SVG text small enough for a phone's width."""

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

from laconic.method_style import look
from laconic.plotting import figure
from laconic.scene import METHODS

Row = dict[str, Any]
FLOOR = 1e-16
SIZE = (5.2, 3.9)


def svg(picture: Figure) -> str:
    """The figure as an svg element without prolog; text stays text, identifiers stay the same in every run."""
    out = io.StringIO()
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "laconic"}):
        picture.savefig(out, format="svg", metadata={"Date": None})
    plt.close(picture)
    text = out.getvalue()
    return text[text.index("<svg"):]


def _lines(axes: Axes, rows: Sequence[Row], x: str, y: str, style: Row) -> None:
    points = sorted((row[x], max(row[y], FLOOR)) for row in rows if row.get(y) is not None and np.isfinite(row[y]))
    if points:
        axes.loglog(*zip(*points, strict=True), **style)


def error_against_time(rows: Sequence[Row], scene: str) -> str:
    """One scene: error of ν over run time; full lines double, dashed single."""
    picture = figure(*SIZE)
    axes = picture.add_subplot()
    for method in METHODS:
        for real, style, name in (("double", "-", method), ("single", "--", None)):
            mine = [r for r in rows if (r["scene"], r["method"], r["real"]) == (scene, method, real)]
            _lines(axes, mine, "us_per_second", "error_nu", look(method, 3.5, label=name, linestyle=style))
    axes.set(xlabel="run time per simulated second [µs]", ylabel="error of ν, relative", title=scene)
    picture.legend(fontsize=7.5, loc="outside lower center", ncols=3)
    return svg(picture)


def precision(rows: Sequence[Row]) -> str:
    """S1 with other people's integrators."""
    picture = figure(7.4, 5.0)
    axes = picture.add_subplot()
    for method in METHODS[1:]:
        mine = [r for r in rows if r["who"] == method and r["real"] == "double"]
        _lines(axes, mine, "ms", "error_nu", look(method, 3.5))
    others = sorted({r["who"] for r in rows} - set(METHODS))
    for name, grey in zip(others, np.linspace(0.15, 0.75, max(1, len(others))), strict=True):
        _lines(axes, [r for r in rows if r["who"] == name], "ms", "error_nu",
               look(name, 3.5, color=str(round(float(grey), 2)), linestyle=":"))
    axes.axhline(1e-6, color="0.6", linewidth=0.8)
    axes.set(xlabel="run time of all ten seconds [ms]", ylabel="largest error of ν [rad/s]", title="S1")
    axes.legend(fontsize=7.5, loc="upper right")
    return svg(picture)


def stability(rows: Sequence[Row], method: str) -> str:
    """Step across, damping upwards, error as colour; refused steps are grey."""
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
    axes.plot(steps, 1.0 / np.array(steps), color="white", linewidth=0.8, linestyle="--")
    axes.set(xscale="log", yscale="log", xlabel="step h [s]", ylabel="fastest damping r [1/s]", title=method,
             ylim=(_edges(rates)[0], _edges(rates)[-1]))
    axes.grid(False)
    picture.colorbar(mesh, ax=axes, label="error of ν")
    return svg(picture)


def _edges(values: Sequence[float]) -> np.ndarray:
    middle = np.log(np.asarray(values))
    between = 0.5 * (middle[1:] + middle[:-1])
    return np.exp(np.concatenate([[2 * middle[0] - between[0]], between, [2 * middle[-1] - between[-1]]]))


def drift(rows: Sequence[Row], real: str, what: str) -> str:
    """Largest relative change so far over the number of steps."""
    picture = figure(*SIZE)
    axes = picture.add_subplot()
    for method in METHODS[1:]:
        mine = [r for r in rows if r["method"] == method and r["real"] == real and r["status"] == "ok"]
        _lines(axes, mine, "steps", what, look(method, 3.5))
    axes.set(xlabel="steps of 0.1 s", ylabel=f"relative change of {what}", title=f"{what}, {real}")
    axes.legend(fontsize=7.5)
    return svg(picture)
