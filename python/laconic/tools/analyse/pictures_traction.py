"""What the ground must deliver, over time: a curve for each wheel, or, of many wheels, a coloured row for each."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from laconic.pictures.curve_style import nested
from laconic.pictures.plotting import figure
from laconic.tools.analyse.findings import Study
from laconic.tools.analyse.picture_parts import head
from laconic.tools.analyse.traction import Traction

STYLES = ("-", "--", "-.", (0, (3, 1, 1, 1, 1, 1)))  # so that wheels differ in black and white too
MOST_CURVES = 10  # of points of contact that can be told apart as curves
CUT = 3.0         # uses of the friction cone beyond are drawn as this
QUANTITIES = ("normal load [N]", "reaction [N]", "use of the\nfriction cone [–]")


def traction_picture(study: Study) -> Figure | None:
    """Normal loads, reactions, and use of the friction cone."""
    found = study.traction
    if found is None or study.subject.wheel_count == 0:
        return None
    points = found.normal_N.shape[1]
    return _curves(study, found) if points <= MOST_CURVES else _rows(study, found)


def _values(study: Study, found: Traction) -> list[np.ndarray]:
    """The quantities that are known: time down, points of contact across."""
    reactions = np.hypot(found.along_N, found.lateral_N)[:, : study.subject.wheel_count]
    use = found.use[:, : study.subject.wheel_count]
    return [found.normal_N, reactions, use] if np.isfinite(found.use).any() else [found.normal_N, reactions]


def _names(study: Study, found: Traction) -> list[str]:
    count = study.subject.wheel_count
    return [f"wheel {i + 1}" if i < count else f"support {i - count + 1}" for i in range(found.normal_N.shape[1])]


def _curves(study: Study, found: Traction) -> Figure:
    values, names = _values(study, found), _names(study, found)
    picture = figure(8.0, 7.2 if len(values) == 3 else 5.2)
    rows = picture.subplots(len(values), 1, sharex=True)
    for axes, table, label in zip(rows, values, QUANTITIES, strict=False):
        shown = np.minimum(table, 1.2 * CUT) if label == QUANTITIES[2] else table
        for i, column in enumerate(shown.T):
            style = STYLES[i % 4] if i < study.subject.wheel_count else ":"
            axes.plot(found.time_s, column, label=names[i], ls=style, color=f"C{i}", **nested(i, len(names)))
        axes.set_ylabel(label)
    if len(values) == 3:
        _cone(rows[2], values[2])
    for axes in rows:
        _mark_slip(axes, found, label=axes is rows[0])
    rows[0].set_title(head(study, "what the ground must deliver"))
    rows[-1].set_xlabel("time [s]")
    picture.legend(*rows[0].get_legend_handles_labels(), loc="outside lower center", ncols=4, fontsize=9)
    return picture


def _mark_slip(axes: Axes, found: Traction, label: bool) -> None:
    if found.first_slip_s is not None:
        axes.axvline(found.first_slip_s, color="k", lw=1.2, ls="--", zorder=4,
                     label=f"first slip: {found.first_slip_s:.4g} s" if label else None)


def _cone(axes: Axes, use: np.ndarray) -> None:
    """1: the reaction is as large as friction allows; beyond, the wheel slips."""
    top = min(CUT, max(1.15, 1.08 * float(np.nanmax(np.where(np.isfinite(use), use, 0.0)))))
    axes.axhspan(1.0, top, color="tab:red", alpha=0.10, lw=0)
    axes.axhline(1.0, color="tab:red", lw=1.0)
    axes.set_ylim(0.0, top)
    if top == CUT:
        axes.set_ylabel(f"{axes.get_ylabel()} (cut at {CUT:g})")


def _rows(study: Study, found: Traction) -> Figure:
    """Time across, wheels downwards, the quantity as colour: sixty wheels are as readable as eleven."""
    values, names = _values(study, found), _names(study, found)
    height = 1.2 + len(values) * max(2.0, 0.13 * len(names))
    picture = figure(8.0, height)
    panels = picture.subplots(len(values), 1, sharex=True)
    for axes, table, label in zip(panels, values, QUANTITIES, strict=False):
        is_use = label == QUANTITIES[2]
        lowest = float(min(0.0, np.nanmin(np.where(np.isfinite(table), table, 0.0))))
        mesh = axes.pcolormesh(found.time_s, np.arange(1, table.shape[1] + 1), table.T, shading="nearest",
                               cmap="magma_r" if is_use else "viridis", vmin=lowest, vmax=CUT if is_use else None)
        _row_axis(axes, names[: table.shape[1]])
        bar = picture.colorbar(mesh, ax=axes, label=label, extend="max" if is_use else "neither")
        if is_use:
            _outline_slip(axes, found.time_s, table)
            bar.ax.axhline(1.0, color="tab:cyan", lw=2.0)
        _mark_slip(axes, found, label=axes is panels[0])
    panels[0].set_title(head(study, "what the ground must deliver"))
    panels[-1].set_xlabel("time [s]")
    if len(values) == 3:
        panels[0].plot([], [], color="tab:cyan", lw=2.0, label="inside: a wheel slips (use above 1)")
    handles = panels[0].get_legend_handles_labels()
    if handles[0]:
        picture.legend(*handles, loc="outside lower center", ncols=2, fontsize=9)
    return picture


def _row_axis(axes: Axes, names: list[str]) -> None:
    """Every name where there is room for it, else every few."""
    every = -(-len(names) // 24)
    axes.set_yticks(range(1, len(names) + 1, every), [name.removeprefix("wheel ") for name in names[::every]],
                    fontsize=7)
    axes.set_ylabel("wheel")
    axes.invert_yaxis()
    axes.grid(False)


def _outline_slip(axes: Axes, time_s: np.ndarray, use: np.ndarray) -> None:
    """A line around what is beyond the friction cone, row by row."""
    for i, column in enumerate(np.where(np.isfinite(use), use, 2.0 * CUT).T, start=1):
        beyond = np.concatenate([[False], column > 1.0, [False]])
        for first, last in np.flatnonzero(np.diff(beyond.astype(int))).reshape(-1, 2):
            left, right = time_s[first], time_s[min(last, len(time_s)) - 1]
            axes.plot([left, right, right, left, left], [i - 0.5, i - 0.5, i + 0.5, i + 0.5, i - 0.5],
                      color="tab:cyan", lw=1.0, zorder=3)
