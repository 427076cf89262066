"""Pictures of steady motions: bifurcation diagram (Fig. 5), eigenvalues, motions under constant voltages."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from laconic.pictures.plotting import figure
from laconic.tools.analyse import confirm
from laconic.tools.analyse.findings import BifurcationPart, SteadyPart, Study
from laconic.tools.analyse.motions import COMMANDS
from laconic.tools.analyse.picture_parts import (
    BOLD,
    THIN,
    YAW,
    explained,
    head,
    keys,
    legend_below,
    metres_beside,
    power_aside,
    speed_axes,
)
from laconic.tools.analyse.portrait import across_direction
from laconic.tools.analyse.speeds import wheel_radius_m

STABLE, UNSTABLE, NEUTRAL = "tab:blue", "tab:red", "tab:gray"
SPECIALS: dict[str, dict[str, Any]] = {  # the second fits into the first: where both are at one place, both are seen
    "fold": {"marker": "D", "color": "k", "markerfacecolor": "w", "markersize": 9, "linestyle": "", "zorder": 5},
    "branch point": {"marker": "o", "color": "k", "markerfacecolor": "w", "markersize": 5, "linestyle": "",
                     "zorder": 6}}
COLOURS = {"stable": STABLE, "unstable": UNSTABLE, "neutral": NEUTRAL}


def bifurcation_picture(study: Study) -> Figure | None:
    """Fig. 5."""
    part = study.bifurcation
    if part is None:
        return None
    picture = figure(7.6, 5.4)
    axes = picture.subplots()
    big = study.subject.matrices.lambda_yaw
    for branch in part.diagram.branches:
        _branch(axes, np.array(branch.parameter), branch.nu()[:, 2] / big, branch.stable())
    for special in part.diagram.specials:
        axes.plot(special.parameter, special.nu[2] / big, **SPECIALS[special.kind])
    for hopf in part.diagram.hopf:
        axes.plot(hopf.parameter, hopf.nu[2] / big, "*", color="tab:purple", ms=14, zorder=6)
    _cycle_marks(axes, part, big)
    looks = {True: (STABLE, BOLD, "-", "stable"), False: (UNSTABLE, THIN, "--", "unstable")}
    found = {bool(stable) for branch in part.diagram.branches for stable in branch.stable()}
    entries = [look for stable, look in looks.items() if stable in found]
    if part.low <= part.parameter.at_scene <= part.high:
        axes.axvline(part.parameter.at_scene, color="0.3", lw=1.0, ls=":")
        entries.append(("0.3", 1.0, ":", "the scene's own value"))
    axes.set_xlim(part.low, part.high)
    handles = keys(axes, entries) + _marks(axes, part)
    axes.set(xlabel=part.parameter.label, ylabel=YAW, title=head(study, "steady motions"))
    power_aside(axes.yaxis)
    if part.parameter.name in COMMANDS:
        metres_beside(axes, "top", "the same in m/s", wheel_radius_m(study.subject))
    legend_below(picture, handles, _meaning(part))
    return picture


def _meaning(part: BifurcationPart) -> str:
    """What a commanded motion is, in words."""
    if part.parameter.name not in COMMANDS:
        return ""
    return "Commanded: the straight motion that the constant voltages would hold. The vehicle may yaw by itself."


def _marks(axes: Axes, part: BifurcationPart) -> list[Line2D]:
    kinds = {special.kind for special in part.diagram.specials}
    handles: list[Line2D] = []
    if "fold" in kinds:
        handles += axes.plot([], [], label="fold (vertex)", **SPECIALS["fold"])
    if "branch point" in kinds:
        handles += axes.plot([], [], label="branch point", **SPECIALS["branch point"])
    if part.diagram.hopf:
        handles += axes.plot([], [], "*", color="tab:purple", ms=11, ls="", label="Andronov–Hopf point")
    if part.cycles:
        handles += axes.plot([], [], "_", color="tab:purple", ms=9, ls="", label="limit cycle: lowest, highest")
    return handles


def _branch(axes: Axes, x: np.ndarray, y: np.ndarray, stable: np.ndarray) -> None:
    """Stable stretches bold, unstable ones thin and dashed, without gaps between them."""
    change = np.flatnonzero(np.diff(stable.astype(int)) != 0) + 1
    for first, last in zip([0, *change], [*change, len(x)], strict=True):
        end = min(last + 1, len(x))
        is_stable = bool(stable[first])
        axes.plot(x[first:end], y[first:end], color=STABLE if is_stable else UNSTABLE,
                  lw=BOLD if is_stable else THIN, ls="-" if is_stable else "--", solid_capstyle="butt",
                  zorder=3 if is_stable else 2)


def _cycle_marks(axes: Axes, part: BifurcationPart, big: float) -> None:
    for item in part.cycles:
        yaw = item.cycle.path_nu[:, 2] / big
        axes.plot([item.cycle.parameter] * 2, [yaw.min(), yaw.max()], "_", color="tab:purple", ms=9, mew=1.5, zorder=4)


def eigenvalue_picture(study: Study) -> Figure | None:
    """Eigenvalues of the steady motions in the complex plane."""
    steady = study.steady
    if steady is None or not steady.motions:
        return None
    picture = figure(7.2, 4.8)
    axes = picture.subplots()
    markers, big, count = "osD^v", study.subject.matrices.lambda_yaw, len(steady.motions)
    if study.bifurcation is not None:
        _loci(axes, study.bifurcation)
    for number, motion in enumerate(steady.motions):
        colour = COLOURS[motion.stability]
        shape = "turning" if motion.is_turning else "straight"
        yaw_rate = motion.nu[2] / big if motion.is_turning else 0.0
        text = f"{shape}, ω = {yaw_rate:.3g} rad/s: {motion.stability}"
        axes.plot(motion.eigenvalues.real, motion.eigenvalues.imag, markers[number % 5], color=colour,
                  ms=6 + 6 * (count - 1 - number), mfc="none", mew=1.6, ls="", label=text, zorder=4)
    axes.axvline(0.0, color="k", lw=0.9)
    axes.axhline(0.0, color="0.7", lw=0.7)
    axes.margins(0.08)
    axes.set(xlabel="real part [1/s]", ylabel="imaginary part [rad/s]",
             title=head(study, "eigenvalues of the steady motions"))
    legend_below(picture, axes.get_legend_handles_labels()[0],
                 "A push along an eigenvector grows (right of 0) or dies away (left) at the rate of the real part.", 2)
    return picture


def _loci(axes: Axes, part: BifurcationPart) -> None:
    """Where the eigenvalues of all branches run as the parameter varies."""
    for branch in part.diagram.branches:
        values = np.concatenate([motion.eigenvalues for motion in branch.motion])
        axes.plot(values.real, values.imag, ".", color="0.7", ms=2.5, zorder=1)
    axes.plot([], [], ".", color="0.7", ms=8, ls="", label=f"along the branches, {part.parameter.name} varied")


def driven_picture(study: Study) -> Figure | None:
    """Motions under the held inputs, run by the core, around the steady ones."""
    steady, subject = study.steady, study.subject
    direction = across_direction(subject)
    if steady is None or not steady.motions or direction is None or not any(m.is_turning for m in steady.motions):
        return None
    across, label = direction
    picture = figure(7.2, 5.8)
    axes = picture.subplots()
    for nu in _driven_runs(study, steady):
        axes.plot(nu[:, 2], nu[:, :2] @ across, color="0.55", lw=0.8)
        axes.plot(nu[0, 2], nu[0, :2] @ across, ".", color="0.55", ms=4)
    handles = []
    for stability, colour in COLOURS.items():
        nu = np.array([motion.nu for motion in steady.motions if motion.stability == stability]).reshape(-1, 3)
        if len(nu):
            handles += axes.plot(nu[:, 2], nu[:, :2] @ across, "o", color=colour, ms=8, zorder=5,
                                 label=f"{stability} steady motion")
    handles += keys(axes, [("0.55", 0.8, "-", "motions (start: dot)")]) + _nearest_cycles(axes, study, across)
    axes.set(xlabel=r"$\nu_3$ [rad/s]", ylabel=f"{label} [rad/s]",
             title=head(study, "motions under constant voltages"))
    speed_axes(axes, subject, label.partition(" (")[0])
    legend_below(picture, handles, explained(label, integral=False))
    return picture


def _nearest_cycles(axes: Axes, study: Study, across: np.ndarray) -> list[Line2D]:
    """The limit cycles that were found nearest to the scene's own parameter value."""
    part = study.bifurcation
    if part is None or not part.cycles:
        return []
    gap = min(abs(item.cycle.parameter - part.parameter.at_scene) for item in part.cycles)
    value = 0.0
    for item in part.cycles:
        if abs(item.cycle.parameter - part.parameter.at_scene) <= gap + 1e-9:
            path, value = item.cycle.path_nu, item.cycle.parameter
            axes.plot(path[:, 2], path[:, :2] @ across, color="tab:purple", lw=1.8, ls="--", zorder=4)
    return keys(axes, [("tab:purple", 1.8, "--", f"unstable limit cycle at {part.parameter.name} = {value:.4g}")])


def _driven_runs(study: Study, steady: SteadyPart) -> list[np.ndarray]:
    """Runs of the core from states on a frame around the steady motions."""
    subject = study.subject
    field = subject.field(steady.inputs)
    states = np.array([motion.nu for motion in steady.motions])
    spread = np.ptp(states, axis=0) if len(states) > 1 else np.abs(states[0])
    middle, size = states.mean(axis=0), 0.75 * np.maximum(spread, 0.2 * spread.max())
    basis = field.nu_of_zeta[:, : field.dof]
    rng = np.random.default_rng(7)
    starts = [field.nu(field.zeta(middle + size * push)) for push in rng.uniform(-1.0, 1.0, (14, 3))]
    unstable = [motion for motion in steady.motions if motion.stability == "unstable"]
    starts += [motion.nu + 0.02 * spread.max() * basis[:, k] * side
               for motion in unstable for k in range(field.dof) for side in (-1, 1)]
    slowest = min(float(np.abs(motion.eigenvalues.real).min()) for motion in steady.motions)
    fastest = max(float(np.abs(motion.eigenvalues).max()) for motion in steady.motions)
    duration = float(np.clip(5.0 / max(slowest, 1e-9), 3.0 / fastest, 80.0 / fastest))
    held = subject.core.input(steady.inputs)
    runs = []
    for start in starts:
        plant = confirm.plant_at(subject, start, duration / 1600)
        rows = [plant.nu]
        for _ in range(800):
            plant.run(held, 2)
            rows.append(plant.nu)
        runs.append(np.array(rows))
    return runs
