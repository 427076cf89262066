"""Panels of a sweep's page, each a small picture of its own, so that a narrow window puts one below the other."""

from __future__ import annotations

import io
from collections.abc import Mapping

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from laconic.pictures.plotting import check_formulas, figure

WIDTH_IN, HEIGHT_IN = 3.6, 2.8
MOST_POINTS = 1500
BINS = 12
LETTERS = 34  # of a key below its axis
LARGEST_SHOWN = 1e150
ROUNDING = 1e-13  # of values that a histogram cannot tell apart
POINTS, LINE, BAND = "#8fb3d9", "#1f4e8c", "#c9d9ec"


def svg_of(picture: Figure) -> str:
    """The picture as SVG, the same text for the same picture."""
    check_formulas(picture)
    text = io.StringIO()
    with plt.rc_context({"svg.hashsalt": "laconic", "svg.fonttype": "path"}):
        picture.savefig(text, format="svg", metadata={"Date": None}, dpi=150)
    plt.close(picture)
    return text.getvalue()


def _panel(xlabel: str, ylabel: str) -> tuple[Figure, Axes]:
    picture = figure(WIDTH_IN, HEIGHT_IN)
    axes = picture.add_subplot()
    axes.set(xlabel=_broken(xlabel), ylabel=_broken(ylabel))
    axes.xaxis.label.set_fontsize(9)
    axes.yaxis.label.set_fontsize(9)
    axes.tick_params(labelsize=8)
    axes.locator_params(axis="x", nbins=5)
    return picture, axes


def _broken(name: str) -> str:
    """A long name in two lines, broken at a dot or an underscore."""
    if len(name) <= LETTERS:
        return name
    at = max(name.rfind(".", 0, LETTERS), name.rfind("_", 0, LETTERS)) + 1 or LETTERS
    return f"{name[:at]}\n{name[at:]}"


def histogram(name: str, values: np.ndarray) -> str:
    """How often which values come."""
    picture, axes = _panel(name, "runs")
    if words := _without_picture(values):
        _tell(axes, words)
        return svg_of(picture)
    axes.hist(values, bins=min(60, max(10, int(np.sqrt(len(values))))), color=LINE)
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))
    return svg_of(picture)


def _without_picture(values: np.ndarray) -> str:
    """What is told of values that no axis can show: alike but for rounding, or beyond the numbers of a picture."""
    low, high = float(values.min()), float(values.max())
    if max(abs(low), abs(high)) > LARGEST_SHOWN:
        return f"{low:g} … {high:g}:\nbeyond what a picture shows"
    alike = high - low <= ROUNDING * max(abs(low), abs(high))
    return f"{high:g}\nin all runs" if alike else ""


def _tell(axes: Axes, words: str) -> None:
    axes.text(0.5, 0.5, words, ha="center", va="center", transform=axes.transAxes)
    axes.set(xticks=[], yticks=[])


def effect(key: str, given: np.ndarray, name: str, values: np.ndarray) -> str:
    """Runs as points, and over them the mean with the middle 90 % of each level of the key, or of each part of its
    range."""
    picture, axes = _panel(key, name)
    beyond = [each for each in (values, given) if each.dtype.kind == "f" and np.abs(each).max() > LARGEST_SHOWN]
    if beyond:
        _tell(axes, _without_picture(beyond[0]))
    elif given.dtype.kind == "f":
        few = np.random.default_rng(1).permutation(len(given))[:MOST_POINTS]
        axes.plot(given[few], values[few], ".", ms=2.5, color=POINTS, rasterized=True)
        _middle(axes, *_parts(given, values))
    else:
        words = [str(word) for word in given]
        names = sorted(set(words))
        at = np.array([names.index(word) for word in words], float)
        few = np.random.default_rng(1).permutation(len(at))[:MOST_POINTS]
        axes.plot(at[few], values[few], ".", ms=2.5, color=POINTS, rasterized=True)
        for place in range(len(names)):
            own = values[at == place]
            low, high = np.quantile(own, [0.05, 0.95])
            axes.errorbar([place], [own.mean()], [[own.mean() - min(low, own.mean())],
                                                  [max(high, own.mean()) - own.mean()]], fmt="o", color=LINE, capsize=4)
        axes.set_xticks(range(len(names)), names)
        axes.set_xlim(-0.5, len(names) - 0.5)
    return svg_of(picture)


def _middle(axes: Axes, at: np.ndarray, groups: list[np.ndarray]) -> None:
    means = np.array([group.mean() for group in groups])
    low, high = np.array([np.quantile(group, [0.05, 0.95]) for group in groups]).T
    axes.fill_between(at, low, high, color=BAND, alpha=0.6, zorder=2.5, linewidth=0)
    axes.plot(at, means, "-o", ms=3, color=LINE, zorder=3)


def _parts(given: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, list[np.ndarray]]:
    """Where the groups are, and their values: levels, or parts of the range with equally many runs."""
    levels = np.unique(given)
    if len(levels) <= 3 * BINS:
        return levels, [values[given == level] for level in levels]
    order = np.argsort(given, kind="stable")
    parts = [part for part in np.array_split(order, BINS) if len(part)]
    return np.array([given[part].mean() for part in parts]), [values[part] for part in parts]


def bars(title: str, indices: Mapping[str, tuple[float, float]], first: Mapping[str, tuple[float, float]],
         name: str) -> str:
    """Sensitivity indices with their intervals, the largest on top."""
    picture, axes = _panel(f"index for {title}", "")
    keys = sorted(indices, key=lambda key: indices[key][0])
    rows = np.arange(len(keys))
    for shift, (label, shown, colour) in ((0.2, (name, indices, LINE)), (-0.2, ("first order", first, POINTS))):
        axes.barh(rows + shift, [shown[key][0] for key in keys], 0.38, xerr=[shown[key][1] for key in keys],
                  label=label, color=colour, error_kw={"linewidth": 0.8})
    axes.set_axisbelow(True)
    axes.set_yticks(rows, [_broken(key.removeprefix("vehicle.")) for key in keys])
    axes.set_xlim(left=min(0.0, axes.get_xlim()[0]))
    axes.tick_params(axis="y", labelsize=7)
    axes.legend(fontsize=7, loc="lower right")
    return svg_of(picture)
