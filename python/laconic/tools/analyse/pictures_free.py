"""Pictures of the free motion: phase portrait (Fig. 4) and path."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from laconic.pictures.method_style import style_of
from laconic.pictures.plotting import figure
from laconic.scene.methods import EXACT
from laconic.tools.analyse.findings import FreePart, Study
from laconic.tools.analyse.picture_parts import BOLD, THIN, head, keys, legend_below, speed_axes
from laconic.tools.analyse.portrait import half_curves

ACROSS = r"$\nu_\perp$: the part of ($\nu_1$, $\nu_2$) across the direction that turning is coupled to"
INTEGRAL = r"$K=(A\nu)_3$ stays in free motion, as the energy does; $A$: the matrix of inertia, $A_{33}$ its last entry"
ROLLING = r"$R\nu_1$, $R\nu_2$: velocity of the centre of mass along the body axes $\xi$, $\eta$; $R$: wheel radius"


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


def explained(label: str, integral: bool) -> str:
    """What the symbols of a portrait mean, as far as they occur."""
    return "\n".join([ACROSS] * ("perp" in label) + [ROLLING] + [INTEGRAL] * integral)


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
