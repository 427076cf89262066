"""Pictures of an analysis: portrait, path, bifurcation diagram, eigenvalues, driven portrait, traction."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from laconic.analysis import confirm
from laconic.analysis.portrait import across_direction, half_curves
from laconic.analysis.study import BifurcationPart, FreePart, SteadyPart, Study
from laconic.analysis.traction import Traction
from laconic.plotting import figure, save

STABLE, UNSTABLE, NEUTRAL = "tab:blue", "tab:red", "tab:gray"
BOLD, THIN = 3.0, 1.1


def draw(study: Study, folder: Path) -> list[Path]:
    """All pictures that the study has something for."""
    drawn = []
    for name, make in (("portrait", _portrait), ("path", _path), ("bifurcation", _bifurcation),
                       ("eigenvalues", _eigenvalues), ("driven_portrait", _driven_portrait), ("traction", _traction)):
        picture = make(study)
        if picture is not None:
            path = folder / f"{name}.png"
            save(picture, path)
            drawn.append(path)
    return drawn


def _arrow(axes: Axes, x: np.ndarray, y: np.ndarray, colour: str) -> None:
    """One arrow in the middle of a curve, by arc length."""
    scale_x, scale_y = np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim())
    length = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x) / scale_x, np.diff(y) / scale_y))])
    if length[-1] < 0.05:
        return
    k = int(np.clip(np.searchsorted(length, 0.5 * length[-1]), 1, len(x) - 2))
    axes.annotate("", xy=(x[k + 1], y[k + 1]), xytext=(x[k - 1], y[k - 1]),
                  arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 1.2, "mutation_scale": 14})


# ---- free motion


def _portrait(study: Study):
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
        colour = "tab:blue" if kind == "periodic" else "tab:orange"
        axes.plot(piece[:, 2], piece[:, :2] @ view.across, color=colour, lw=THIN)
        _arrow(axes, piece[:, 2], piece[:, :2] @ view.across, colour)
    for piece in own:
        axes.plot(piece[:, 2], piece[:, :2] @ view.across, color="k", lw=2.0)
    _line_of_straight_motion(axes, view.straight_slope)
    axes.plot(view.centre, 0.0, "k+", ms=11, mew=1.6)
    kinds = {kind for _, kind in pieces}
    entries = [(c, THIN, "-", k) for c, k in (("tab:blue", "periodic"), ("tab:orange", "asymptotic")) if k in kinds]
    entries += [("k", 2.0, "-", "this motion")] if own else []
    entries += [("tab:green", BOLD, "-", "straight motion, stable"), ("tab:green", THIN, "--", "straight motion, "
                                                                                               "unstable")]
    handles = _keys(axes, entries)
    about = rf"$K/A_{{33}}$ = {view.centre:.4g} rad/s (+)" if view.integral is not None else "the origin (+)"
    axes.set(xlabel=r"$\nu_3$ [rad/s]", ylabel=f"{view.label} [rad/s]",
             title=f"{study.subject.scene.name}\nfree motion: ellipses about {about}")
    picture.legend(handles=handles, loc="outside lower center", ncols=3, fontsize=9)
    return picture


def _line_of_straight_motion(axes: Axes, slope: float) -> None:
    """ν3 = 0, bold where straight motion is stable: where slope · ν⊥ < 0."""
    low, high = axes.get_ylim()
    stable, unstable = ((low, 0.0), (0.0, high)) if slope > 0.0 else ((0.0, high), (low, 0.0))
    axes.plot([0.0, 0.0], stable, color="tab:green", lw=BOLD, zorder=1)
    axes.plot([0.0, 0.0], unstable, color="tab:green", lw=THIN, ls="--", zorder=1)


def _keys(axes: Axes, entries: list[tuple[str, float, str, str]]):
    return [axes.plot([], [], color=c, lw=w, ls=s, label=text)[0] for c, w, s, text in entries]


def _padded(values: np.ndarray, share: float = 0.07) -> tuple[float, float]:
    low, high = float(np.min(values)), float(np.max(values))
    room = share * ((high - low) or max(1.0, abs(high)))
    return low - room, high + room


def _path(study: Study):
    """The free motion's path; without a free part, none."""
    free = study.free
    if free is None:
        return None
    picture = figure(7.2, 6.4)
    axes = picture.subplots()
    axes.plot(*free.path_m.T, color="tab:blue", lw=1.4, label="closed form")
    every = max(1, len(free.path_m) // 120)
    axes.plot(*free.core_path_m[::every].T, ".", color="tab:orange", ms=4, label="core, exact-flow")
    axes.plot(0.0, 0.0, "o", color="tab:green", label="start")
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(xlabel="x [m]", ylabel="y [m]", title=f"{study.subject.scene.name}\n{_path_title(free)}")
    picture.legend(handles=axes.get_legend_handles_labels()[0], loc="outside lower center", ncols=3, fontsize=9)
    return picture


def _path_title(free: FreePart) -> str:
    kind = free.motion.kind
    if kind == "periodic":
        periods = free.path_time_s[-1] / free.motion.period_s
        return f"path of the centre of mass in free motion: {periods:.0f} periods of ν"
    tail = {"asymptotic": "tends to a straight line", "straight": "straight", "uniform": "turns evenly"}[kind]
    return f"path of the centre of mass in free motion: {tail}"


# ---- steady motions and bifurcations


def _bifurcation(study: Study):
    part = study.bifurcation
    if part is None:
        return None
    picture = figure(7.6, 5.4)
    axes = picture.subplots()
    big = study.subject.matrices.lambda_yaw
    for branch in part.diagram.branches:
        _branch(axes, np.array(branch.parameter), branch.nu()[:, 2] / big, branch.stable())
    for special in part.diagram.specials:
        marker = "D" if special.kind == "fold" else "o"
        axes.plot(special.parameter, special.nu[2] / big, marker, color="k", mfc="w", ms=7, zorder=5)
    for hopf in part.diagram.hopf:
        axes.plot(hopf.parameter, hopf.nu[2] / big, "*", color="tab:purple", ms=14, zorder=6)
    _cycle_marks(axes, part, big)
    if part.low <= part.parameter.at_scene <= part.high:
        axes.axvline(part.parameter.at_scene, color="0.6", lw=0.9, ls=":")
    axes.set_xlim(part.low, part.high)
    handles = _keys(axes, [(STABLE, BOLD, "-", "stable"), (UNSTABLE, THIN, "--", "unstable"),
                           ("0.6", 0.9, ":", "the scene's own value")])
    handles += _marks(axes, part)
    axes.set(xlabel=part.parameter.label, ylabel=r"yaw rate $\omega=\nu_3/\Lambda$ [rad/s]",
             title=f"{study.subject.scene.name}\nsteady motions")
    picture.legend(handles=handles, loc="outside lower center", ncols=3, fontsize=9)
    return picture


def _marks(axes: Axes, part: BifurcationPart):
    kinds = {special.kind for special in part.diagram.specials}
    handles = []
    if "fold" in kinds:
        handles += axes.plot([], [], "D", color="k", mfc="w", ls="", label="fold (vertex)")
    if "branch point" in kinds:
        handles += axes.plot([], [], "o", color="k", mfc="w", ls="", label="branch point")
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


def _eigenvalues(study: Study):
    steady = study.steady
    if steady is None or not steady.motions:
        return None
    picture = figure(7.2, 4.8)
    axes = picture.subplots()
    markers, big = "osD^v", study.subject.matrices.lambda_yaw
    if study.bifurcation is not None:
        _loci(axes, study.bifurcation)
    for number, motion in enumerate(steady.motions):
        colour = {"stable": STABLE, "unstable": UNSTABLE, "neutral": NEUTRAL}[motion.stability]
        shape = "turning" if motion.turns else "straight"
        yaw_rate = motion.nu[2] / big if motion.turns else 0.0
        text = f"{shape}, ω = {yaw_rate:.3g} rad/s: {motion.stability}"
        axes.plot(motion.eigenvalues.real, motion.eigenvalues.imag, markers[number % 5], color=colour, ms=8,
                  mfc="none" if motion.turns else colour, mew=1.6, ls="", label=text, zorder=4)
    axes.axvline(0.0, color="k", lw=0.9)
    axes.axhline(0.0, color="0.7", lw=0.7)
    axes.margins(0.08)
    axes.set(xlabel="real part [1/s]", ylabel="imaginary part [rad/s]",
             title=f"{study.subject.scene.name}\neigenvalues of the steady motions")
    picture.legend(handles=axes.get_legend_handles_labels()[0], loc="outside lower center", ncols=2, fontsize=9)
    return picture


def _loci(axes: Axes, part: BifurcationPart) -> None:
    """Where the eigenvalues of all branches run as the parameter varies."""
    first = True
    for branch in part.diagram.branches:
        values = np.concatenate([motion.eigenvalues for motion in branch.motion])
        axes.plot(values.real, values.imag, ".", color="0.8", ms=2, zorder=1,
                  label=f"along the branches, {part.parameter.name} varied" if first else None)
        first = False


def _driven_portrait(study: Study):
    """Motions under the held inputs, run by the core, around the steady ones."""
    steady, subject = study.steady, study.subject
    direction = across_direction(subject)
    if steady is None or not steady.motions or direction is None or not any(motion.turns for motion in steady.motions):
        return None
    across, label = direction
    picture = figure(7.2, 5.8)
    axes = picture.subplots()
    for nu in _driven_runs(study, steady):
        axes.plot(nu[:, 2], nu[:, :2] @ across, color="0.55", lw=0.8)
        axes.plot(nu[0, 2], nu[0, :2] @ across, ".", color="0.55", ms=4)
    for motion in steady.motions:
        colour = {"stable": STABLE, "unstable": UNSTABLE, "neutral": NEUTRAL}[motion.stability]
        axes.plot(motion.nu[2], motion.nu[:2] @ across, "o", color=colour, ms=8, zorder=5)
    handles = [axes.plot([], [], "o", color=c, ls="", label=f"{t} steady motion")[0]
               for c, t in ((STABLE, "stable"), (UNSTABLE, "unstable"))]
    handles += _keys(axes, [("0.55", 0.8, "-", "motions (start: dot)")]) + _nearest_cycles(axes, study, across)
    axes.set(xlabel=r"$\nu_3$ [rad/s]", ylabel=f"{label} [rad/s]",
             title=f"{subject.scene.name}\nmotions under constant voltages")
    picture.legend(handles=handles, loc="outside lower center", ncols=3, fontsize=9)
    return picture


def _nearest_cycles(axes: Axes, study: Study, across: np.ndarray):
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
    return _keys(axes, [("tab:purple", 1.8, "--", f"unstable limit cycle at {part.parameter.name} = {value:.4g}")])


def _driven_runs(study: Study, steady: SteadyPart) -> list[np.ndarray]:
    """Runs of the core from states on a frame around the steady motions."""
    subject = study.subject
    field = subject.field(steady.inputs)
    states = np.array([motion.nu for motion in steady.motions])
    spread = np.ptp(states, axis=0)
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
        plant = confirm.plant_at(subject, start, duration / 2400)
        rows = [plant.nu]
        for _ in range(1200):
            plant.run(held, 2)
            rows.append(plant.nu)
        runs.append(np.array(rows))
    return runs


# ---- traction


def _traction(study: Study):
    found = study.traction
    if found is None or study.subject.wheel_count == 0:
        return None
    judged = np.isfinite(found.use).any()
    picture = figure(8.0, 7.2 if judged else 5.2)
    rows = picture.subplots(3 if judged else 2, 1, sharex=True)
    n, t = study.subject.wheel_count, found.time_s
    for i in range(found.normal_N.shape[1]):
        label = f"wheel {i + 1}" if i < n else f"support {i - n + 1}"
        rows[0].plot(t, found.normal_N[:, i], label=label, ls="-" if i < n else ":")
    for i in range(n):
        rows[1].plot(t, np.hypot(found.along_N[:, i], found.lateral_N[:, i]), label=f"wheel {i + 1}")
    rows[0].set(ylabel="normal load [N]", title=f"{study.subject.scene.name}\nwhat the ground must deliver")
    rows[1].set(ylabel="reaction [N]")
    if judged:
        _use(rows[2], found, n)
    if found.first_slip_s is not None:
        for axes in rows:
            axes.axvline(found.first_slip_s, color="k", lw=1.2, ls="--")
    rows[-1].set_xlabel("time [s]")
    handles, labels = rows[0].get_legend_handles_labels()
    if found.first_slip_s is not None:
        handles += rows[0].plot([], [], "k--", lw=1.2)
        labels.append(f"no slip stops being true: {found.first_slip_s:.4g} s")
    picture.legend(handles, labels, loc="outside lower center", ncols=4, fontsize=9)
    return picture


def _use(axes: Axes, found: Traction, count: int) -> None:
    top = min(3.0, max(1.15, 1.08 * float(np.nanmax(np.where(np.isfinite(found.use), found.use, 0.0)))))
    for i in range(count):
        axes.plot(found.time_s, np.minimum(found.use[:, i], 1.2 * top))
    axes.axhspan(1.0, top, color="tab:red", alpha=0.10, lw=0)
    axes.axhline(1.0, color="tab:red", lw=1.0)
    axes.set_ylim(0.0, top)
    cut = " (cut at 3)" if top == 3.0 else ""
    axes.set(ylabel=f"use of the\nfriction cone [–]{cut}")


