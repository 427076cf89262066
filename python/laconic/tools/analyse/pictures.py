"""All pictures of an analysis.

Pictures of the free motion: phase portrait (Fig. 4) and path.

What the ground must deliver, over time: a curve for each wheel, or, of many wheels, a coloured row for each.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from laconic.pictures.curves import nested, style_of
from laconic.pictures.plotting import figure, save
from laconic.scene.methods import EXACT
from laconic.tools.analyse.findings import FreePart, Study
from laconic.tools.analyse.picture_parts import BOLD, THIN, explained, head, keys, legend_below, speed_axes
from laconic.tools.analyse.pictures_steady import bifurcation_picture, driven_picture, eigenvalue_picture
from laconic.tools.analyse.portrait import half_curves
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




def _arrow(axes: Axes, x: np.ndarray, y: np.ndarray, colour: str) -> None:
    """One arrow in the middle of a curve, by arc length."""
    scale_x, scale_y = np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim())
    length = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x) / scale_x, np.diff(y) / scale_y))])
    if length[-1] < 0.05:
        return
    k = int(np.clip(np.searchsorted(length, 0.5 * length[-1]), 1, len(x) - 2))
    axes.annotate("", xy=(x[k + 1], y[k + 1]), xytext=(x[k - 1], y[k - 1]),
                  arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 1.2, "mutation_scale": 14})


def _padded(values: np.ndarray, share: float = 0.07) -> tuple[float, float]:
    low, high = float(np.min(values)), float(np.max(values))
    room = share * ((high - low) or max(1.0, abs(high)))
    return low - room, high + room


def portrait_picture(study: Study) -> Figure | None:
    """Fig. 4."""
    free = study.free
    if free is None or free.portrait is None:
        return None
    view = free.portrait
    picture = figure(7.2, 5.6)
    axes = picture.subplots()
    pieces = [(piece, motion.kind) for motion in view.curves for piece in half_curves(motion)]
    own = half_curves(free.motion) if free.motion.kind in ("periodic", "asymptotic") else []
    every = np.concatenate([piece for piece, _ in pieces] + own)
    ordinate = every[:, :2] @ view.across
    axes.set_xlim(*_padded(every[:, 2]))
    axes.set_ylim(*_padded(ordinate))
    for piece, kind in pieces:
        colour, style = ("tab:blue", "-") if kind == "periodic" else ("tab:orange", "-.")
        axes.plot(piece[:, 2], piece[:, :2] @ view.across, color=colour, lw=THIN, ls=style)
        _arrow(axes, piece[:, 2], piece[:, :2] @ view.across, colour)
    for piece in own:
        axes.plot(piece[:, 2], piece[:, :2] @ view.across, color="k", lw=2.0)
    _line_of_straight_motion(axes, view.straight_slope)
    axes.plot(view.centre, 0.0, "k+", ms=11, mew=1.6)
    kinds = {kind for _, kind in pieces}
    looks = (("tab:blue", "-", "periodic"), ("tab:orange", "-.", "asymptotic"))
    entries = [(colour, THIN, style, kind) for colour, style, kind in looks if kind in kinds]
    entries += [("k", 2.0, "-", "this motion")] if own else []
    entries += [("tab:green", BOLD, "-", "straight motion, stable"), ("tab:green", THIN, "--", "straight motion, "
                                                                                               "unstable")]
    handles = keys(axes, entries)
    about = rf"$K/A_{{33}}$ = {view.centre:.4g} rad/s (+)" if view.integral is not None else "the origin (+)"
    axes.set(xlabel=r"$\nu_3$ [rad/s]", ylabel=f"{view.label} [rad/s]",
             title=head(study, f"free motion: ellipses about {about}"))
    speed_axes(axes, study.subject, view.label.partition(" (")[0])
    legend_below(picture, handles, explained(view.label, view.integral is not None))
    return picture


def _line_of_straight_motion(axes: Axes, slope: float) -> None:
    """ν3 = 0, bold where straight motion is stable: where slope · ν⊥ < 0."""
    low, high = axes.get_ylim()
    stable, unstable = ((low, 0.0), (0.0, high)) if slope > 0.0 else ((0.0, high), (low, 0.0))
    axes.plot([0.0, 0.0], stable, color="tab:green", lw=BOLD, zorder=1)
    axes.plot([0.0, 0.0], unstable, color="tab:green", lw=THIN, ls="--", zorder=1)


def path_picture(study: Study) -> Figure | None:
    """The free motion's path; without a free part, none."""
    free = study.free
    if free is None:
        return None
    picture = figure(7.2, 6.4)
    axes = picture.subplots()
    axes.plot(*free.path_m.T, color="0.75", lw=3.0, label="closed form")
    every = max(1, len(free.path_m) // 120)
    axes.plot(*free.core_path_m[::every].T, **style_of(EXACT, 4.0, linestyle="none", label=f"core, {EXACT}"))
    axes.plot(0.0, 0.0, "o", color="tab:green", label="start")
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(xlabel="x [m]", ylabel="y [m]", title=head(study, _path_title(free)))
    legend_below(picture, axes.get_legend_handles_labels()[0],
                 r"$\nu$: velocity of the centre of mass and yaw rate, as seen from the body")
    return picture


def _path_title(free: FreePart) -> str:
    kind = free.motion.kind
    if kind == "periodic":
        periods = free.path_time_s[-1] / free.motion.period_s
        return f"path of the centre of mass in free motion: {periods:.0f} periods of ν"
    tail = {"asymptotic": "tends to a straight line", "straight": "straight", "uniform": "yaws evenly"}[kind]
    return f"path of the centre of mass in free motion: {tail}"


PICTURES = {
    "portrait": portrait_picture, "path": path_picture, "bifurcation": bifurcation_picture,
    "eigenvalues": eigenvalue_picture, "driven_portrait": driven_picture, "traction": traction_picture,
}


def draw(study: Study, folder: Path) -> list[Path]:
    """All pictures that the study has something for."""
    drawn = []
    for name, make in PICTURES.items():
        picture = make(study)
        if picture is not None:
            path = folder / f"{name}.png"
            save(picture, path)
            drawn.append(path)
    return drawn
