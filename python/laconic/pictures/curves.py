"""Curves that stay readable: where they coincide, where there are many, where two scales share an axis.

Limits are set so that nothing but the curves lies within the axes; legends stand above them.

Panels of a run's picture with what its sensors show.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import CenteredNorm
from matplotlib.lines import Line2D

from laconic.scene.methods import METHODS

MOST_CURVES = 8       # beyond, colours are hard to tell apart
STRIPES = 60          # stretches of the axis, in which coinciding curves alternate on top
SAME = 0.012          # of the axis' height: closer curves hide each other
FLAT = 1e-9           # a curve that varies less is flat: its scale is 1, so that its rounding is not shown
MOST_CELLS = 1000     # instants in a picture of rows


def plot_curves(axes: Axes, x: np.ndarray, columns: np.ndarray, labels: Sequence[str]) -> list[Line2D]:
    """One curve for each column. Where some coincide they are striped in their colours, so that each is seen."""
    colours = [f"C{k}" for k in range(columns.shape[1])]
    handles = [axes.plot(x, columns[:, k], color=colour, label=label)[0]
               for k, (colour, label) in enumerate(zip(colours, labels, strict=True))]
    for first, last, k in stripes(columns):
        axes.plot(x[first:last], columns[first:last, k], color=colours[k], zorder=2.2, solid_capstyle="butt")
    return handles


def plot_beside_yaw_rate(axes: Axes, time_s: np.ndarray, columns: np.ndarray, labels: Sequence[str],
                         yaw_rate_rad_per_s: np.ndarray) -> list[Line2D]:
    """Curves on the left scale and a yaw rate on the right one, with a common zero; all lines."""
    handles = plot_curves(axes, time_s, columns, labels)
    right = axes.twinx()
    handles += right.plot(time_s, yaw_rate_rad_per_s, "--", color="tab:green", label="yaw rate [rad/s] (right scale)")
    right.grid(False)
    right.spines["right"].set_visible(True)
    axes.set_xlabel("time [s]")
    right.set_ylabel("yaw rate [rad/s]")
    axes.margins(x=0.01)
    share_zero(axes, right)
    return handles


def stripes(columns: np.ndarray) -> list[tuple[int, int, int]]:
    """(first row, row after the last, column) of what is drawn once more on top, where columns coincide."""
    finite = np.where(np.isfinite(columns), columns, 0.0)
    near = SAME * max(float(np.ptp(finite, axis=None)) if finite.size else 0.0, FLAT)
    edges = np.unique(np.linspace(0, len(columns) - 1, STRIPES + 1).astype(int))
    found = []
    for stretch, (first, last) in enumerate(zip(edges, edges[1:], strict=False)):
        part = finite[first : last + 1]
        apart = np.max(np.abs(part[:, :, None] - part[:, None, :]), axis=0)
        for k in range(columns.shape[1]):
            together = np.flatnonzero(apart[k] <= near)
            if len(together) > 1 and together[stretch % len(together)] == k:
                found.append((int(first), int(last) + 1, k))
    return found


def plot_rows(axes: Axes, x: np.ndarray, columns: np.ndarray, what: str) -> None:
    """A row of colour for each column, the first on top: for more of them than curves can be told apart."""
    rows = np.unique(np.linspace(0, len(x) - 1, min(len(x), MOST_CELLS)).astype(int))
    numbers = np.arange(1, columns.shape[1] + 1)
    mesh = axes.pcolormesh(x[rows], numbers, columns[rows].T, cmap="RdBu_r", norm=CenteredNorm(0.0), shading="nearest",
                           rasterized=True)
    axes.set_yticks(numbers)
    axes.invert_yaxis()
    axes.grid(False)
    axes.figure.colorbar(mesh, cax=axes.inset_axes((1.015, 0.0, 0.018, 1.0)), label=what)


def share_zero(left: Axes, right: Axes) -> None:
    """Limits of twin axes such that both have their zero at one height, and all curves a margin."""
    spans = [_span(axes) for axes in (left, right)]
    sizes = [_size(max(high, -low)) for low, high in spans]
    low = min(span[0] / size for span, size in zip(spans, sizes, strict=True))
    high = max(span[1] / size for span, size in zip(spans, sizes, strict=True))
    if not high > low:  # nothing moves
        low, high = -1.0, 1.0
    margin = 0.06 * (high - low)
    for axes, size in zip((left, right), sizes, strict=True):
        axes.set_ylim(size * (low - margin), size * (high + margin))


def _span(axes: Axes) -> tuple[float, float]:
    low, high = axes.dataLim.y0, axes.dataLim.y1
    return min(low, 0.0), max(high, 0.0)


def _size(size: float) -> float:
    return size if size > FLAT else 1.0


def keep_scale(axes: Axes) -> None:
    """A margin around the curves; a flat curve gets a scale that does not show rounding."""
    low, high = axes.dataLim.y0, axes.dataLim.y1
    size = _size(max(high - low, 1e-3 * max(abs(low), abs(high))))
    middle = (low + high) / 2.0
    axes.set_ylim(middle - 0.56 * size, middle + 0.56 * size)


def head(axes: Axes, title: str, handles: Sequence[Line2D]) -> None:
    """Above the axes the legend, and above that the title."""
    columns = min(4, max(1, len(handles)))
    rows = -(-len(handles) // columns)
    axes.set_title(title, loc="left", pad=6.0 + 14.0 * rows)
    axes.legend(handles=list(handles), loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=columns, fontsize=9,
                borderaxespad=0.2, columnspacing=1.4, handlelength=1.6)


if TYPE_CHECKING:
    from laconic.simulation import Trajectory

def plot_over_time(axes: Axes, run: Trajectory, columns: np.ndarray, labels: Sequence[str], words: tuple[str, str],
                   rows: str = "") -> None:
    """Curves with a unit and a title; `rows`: what the rows are of where there are too many for curves."""
    unit, title = words
    axes.set_xlabel("time [s]")
    if columns.shape[1] > MOST_CURVES:
        plot_rows(axes, run.time_s, columns, unit)
        if rows:
            axes.set_ylabel(rows)
        axes.set_title(title, loc="left")
        return
    handles = plot_curves(axes, run.time_s, columns, labels)
    axes.set_ylabel(unit)
    axes.margins(x=0.01)
    keep_scale(axes)
    head(axes, title, handles)


IMU, ENCODERS = "imu", "encoders"


def sensor_panels(run: Trajectory) -> list[str]:
    """The panels that a run has, one for each kind of sensor."""
    sensors = run.scene.sensors
    return [name for name, there in ((IMU, sensors.imu), (ENCODERS, sensors.encoder)) if there is not None]


def plot_sensors(panel: str, axes: Axes, run: Trajectory) -> None:
    """One of those panels."""
    (plot_imu if panel == IMU else plot_encoders)(axes, run)


def plot_imu(axes: Axes, run: Trajectory) -> None:
    """Accelerations (left scale) and yaw rate (right scale) as the IMU shows them, with a common zero."""
    accelerations = run.columns_of("imu_acceleration_m_per_s2")
    handles = plot_beside_yaw_rate(axes, run.time_s, accelerations, ("along its x [m/s²]", "along its y [m/s²]"),
                                   run.columns["imu_yaw_rate_rad_per_s"])
    axes.set_ylabel("acceleration [m/s²]")
    head(axes, "What the IMU shows", handles)


def plot_encoders(axes: Axes, run: Trajectory) -> None:
    """The count of every encoder; for too many curves a row of colour each."""
    names = [name for name in run.columns if name.startswith("encoder_count[")]
    counts = np.column_stack([run.columns[name] for name in names])
    wheels = [name.partition("[")[2].removesuffix("]") for name in names]
    plot_over_time(axes, run, counts, [f"wheel {wheel}" for wheel in wheels], ("count", "Encoders"), "encoder")


# ---- How curves that may lie on each other, and long names, are drawn in the pictures of analyses and reports.

MOST_LINES = 3         # of a name in a title
THICK, THIN = 3.6, 0.9  # points: the first of curves that coincide, and the last


def nested(order: int, count: int) -> dict[str, Any]:
    """Line width and height in the picture of curve `order` (from 0) of `count`: later ones are thinner and lie on top.

    So where curves coincide, the earlier ones show on both sides of the later ones.
    """
    share = order / max(1, count - 1)
    return {"linewidth": THICK + share * (THIN - THICK), "zorder": 2.0 + share}


def alternating_markers(order: int, count: int) -> tuple[int, int]:
    """`markevery` of curve `order` of `count`: where curves coincide, their markers do not."""
    return order % count, count


def wrapped(name: str, letters: int, addition: str = "") -> str:
    """A title in lines as wide as so many letters: a long name is wrapped, one of too many lines ends in an ellipsis.

    The `addition` follows the name after a colon and is never cut off.
    """
    lines: list[str] = []
    words = " ".join(name.split())
    while words and len(lines) < MOST_LINES:
        line = _fitting(words, letters)
        lines.append(line)
        words = words[len(line):].lstrip()
    if words:
        lines[-1] = _fitting(lines[-1], letters - 1, at_a_space=False) + "…"
    if addition and lines:
        is_short = _width(f"{lines[-1]}: {addition}") <= letters
        lines[-1:] = [f"{lines[-1]}: {addition}"] if is_short else [f"{lines[-1]}:", addition]
    return "\n".join(lines) or addition


def _fitting(words: str, letters: int, at_a_space: bool = True) -> str:
    """As much of the words as one line takes; a word that is longer than a line is broken."""
    if _width(words) <= letters:
        return words
    count = 1
    while _width(words[: count + 1]) <= letters:
        count += 1
    space = words.rfind(" ", 1, count + 1)
    return words[: space if at_a_space and space > 0 else count].rstrip()


def _width(words: str) -> float:
    """In letters of middle width: capitals are wider, those of Chinese twice as wide."""
    return sum(2.0 if unicodedata.east_asian_width(letter) in "WF" else 1.7 if letter in "MWmw@%" else
               1.2 if letter.isupper() else 1.0 for letter in words[:MOST_LINES * 200])


MARKER_SIZE = 5.0  # points; hollow markers are twice as large


@dataclass(frozen=True)
class MethodStyle:
    """A colour that differs from the others in lightness as well as in hue, and a marker that no other method has."""

    colour: str
    marker: str
    hollow: bool = False


PALETTE = (
    MethodStyle("#111111", "o", hollow=True), MethodStyle("#d1495b", "s"), MethodStyle("#e9a23b", "^"),
    MethodStyle("#2a9d8f", "D"), MethodStyle("#8d6cab", "v"), MethodStyle("#3066be", "P"), MethodStyle("#7a5230", "X"),
    MethodStyle("#c2185b", "*"), MethodStyle("#9bc53d", "p"), MethodStyle("#5bc0eb", "h"), MethodStyle("#1b5e20", "<"),
    MethodStyle("#f4a6c0", ">"))
"""By the numbers of the methods; those beyond the first eight are for methods to come."""
METHOD_STYLES = dict(zip(METHODS, PALETTE, strict=False))
FOREIGN = MethodStyle("#777777", "x")  # somebody else's integrator


def style_of(method: str, size: float = MARKER_SIZE, **replaced: Any) -> dict[str, Any]:
    """Keywords for matplotlib's plot functions: colour, marker and label of a method. `size`: marker size in points."""
    style = METHOD_STYLES.get(method, FOREIGN)
    keywords: dict[str, Any] = {"color": style.colour, "marker": style.marker, "markersize": size, "label": method}
    if style.hollow:
        keywords |= {"markersize": 2.0 * size, "markerfacecolor": "none", "linestyle": "none", "zorder": 3}
    return keywords | replaced
