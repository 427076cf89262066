"""Results of a replay: a Markdown report, numbers for JSON, pictures."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from laconic.pictures.curves import wrapped
from laconic.pictures.plotting import figure, save
from laconic.robot.logs import Log
from laconic.robot.logs.log import Log as Run
from laconic.robot.replay.compare import Comparison
from laconic.robot.replay.friction import Friction
from laconic.robot.replay.held_wheels import hold
from laconic.robot.replay.rolling import rolling_of, rotations_of
from laconic.robot.replay.runs import Replay
from laconic.scene import Scene

COLOURS = {"ideal": "tab:green", "dry": "tab:orange", "dry and drag": "tab:blue"}
STYLES = {"ideal": "--", "dry": "-.", "dry and drag": "-"}
UNITS = {"damping_Nms": ("damping c2", "N·m·s"), "drag_N": ("drag against the travel", "N")}


def as_text(replay: Replay) -> str:
    """A report in Markdown."""
    lines = [f"# Recorded runs of {replay.subject.scene.name}", "", *_fit_lines(replay), "",
             "## Rolled distance over camera distance, and steady currents", "", *_run_table(replay), "",
             "## Errors of the prediction", "", *_error_table(replay), "", "## In words", ""]
    words = [*in_words(replay), *(f"Left out or filled in: {each}" for each in replay.remarks)]
    return "\n".join([*lines, *(f"* {sentence}" for sentence in words), ""])


def _fit_lines(replay: Replay) -> list[str]:
    alone = "" if len(replay.comparisons) > 1 else " (the very run that is judged: a fit, no prediction)"
    lines = [f"Fitted on {', '.join(replay.fitted_on)}{alone}; torques at the wheel, 95 % confidence intervals:", ""]
    for model in replay.models:
        parts = [f"{_name(name)[0]} {_pm(value, half)} {_name(name)[1]}"
                 for name, value, half in zip(model.names, model.values, model.half_widths, strict=True)]
        lines.append(f"* **{model.model}**: {', '.join(parts)}; residual {model.residual_Nm:.3f} N·m")
    if replay.skipped:
        lines += ["", f"Left out, not runs of this kind: {', '.join(replay.skipped)}."]
    return lines


def _name(name: str) -> tuple[str, str]:
    if name in UNITS:
        return UNITS[name]
    return f"dry torque of wheel {name.partition('[')[2].rstrip(']')}", "N·m"


def _pm(value: float, half: float) -> str:
    return f"{value:.3g}" if not np.isfinite(half) else f"{value:.3g} ± {half:.2g}"


def _run_table(replay: Replay) -> list[str]:
    count = replay.subject.wheel_count
    head = "".join(f" current {i + 1} [A] |" for i in range(count))
    lines = [f"| run | direction [°] | set speed [m/s] | rolled [m] | camera [m] | rolled / camera | "
             f"rolled to [°] | went to [°] |{head}", "| --- " * (8 + count) + "|"]
    for c in replay.comparisons:
        r = c.rolled
        camera = "–" if r.ratio is None else f"{r.camera_m:.3f}"
        ratio = "–" if r.ratio is None else f"{r.ratio.value:.2f} ± {r.ratio.half_width:.2f}"
        currents = "".join(f" {m.value:.2f} ± {m.half_width:.2f} |" for m in c.steady_current_A)
        went = "–" if r.ratio is None else f"{_whole_deg(r.camera_direction_deg)}"
        lines.append(f"| {c.recording.name} | {_whole_deg(r.direction_deg)} | {r.speed_m_per_s:.1f} | {r.rolled_m:.3f} "
                     f"| {camera} | {ratio} | {_whole_deg(r.rolled_direction_deg)} | {went} |{currents}")
    if any((c.recording.set_speed_rad_per_s == 0.0).all(axis=0).any() for c in replay.comparisons):
        lines += ["", "The log has no sign for the current of a wheel with set speed 0; it counts as zero."]
    return lines


def _whole_deg(angle_deg: float) -> int:
    return round(angle_deg) % 360


def _error_table(replay: Replay) -> list[str]:
    names = [model.model for model in replay.models]
    lines = ["Wheel speeds over the first second (root mean square, share of the measured speed) and steady "
             "currents:", "",
             "| run | used for |" + "".join(f" {n}: speed [rad/s] | {n}: current [A] |" for n in names),
             "| --- " * (2 + 2 * len(names)) + "|"]
    for c in replay.comparisons:
        use = "fit" if c.recording.name in replay.fitted_on else "judging"
        cells = "".join(f" {p.transient_error:.2f} ({100 * p.transient_error_share:.0f} %) | {p.steady_error_A:.3f} |"
                        for p in c.predictions)
        lines.append(f"| {c.recording.name} | {use} |{cells}")
    means = "".join(f" {_mean(replay, k, 'transient_error'):.2f} "
                    f"({100 * _mean(replay, k, 'transient_error_share'):.0f} %)"
                    f" | {_mean(replay, k, 'steady_error_A'):.3f} |" for k in range(len(names)))
    return [*lines, f"| **mean of the judged** | |{means}"]


def _mean(replay: Replay, model: int, what: str) -> float:
    return float(np.mean([getattr(c.predictions[model], what) for c in replay.judged()]))


def in_words(replay: Replay) -> list[str]:
    """Sentences on what the ideal model explains and what it does not; every number is computed."""
    words = [sentence for sentence in (_slip_words(replay), _direction_words(replay)) if sentence]
    ideal, dry, drag = (_mean(replay, k, "steady_error_A") for k in range(3))
    size = float(np.mean([np.sqrt(np.mean([m.value**2 for m in c.steady_current_A])) for c in replay.judged()]))
    unseen = any(c.recording.name not in replay.fitted_on for c in replay.comparisons)
    judged = "the runs that were not fitted" if unseen else "the very runs of the fit"
    words.append(f"Steady currents of {judged}: (4.7) alone, with the best constant damping, is wrong by "
                 f"{ideal:.2f} A of {size:.2f} A; with a dry-friction torque per wheel by {dry:.2f} A; and also "
                 f"with a drag against the travel by {drag:.2f} A.")
    words.append(_damping_words(replay.models[1]))
    words.append(_drag_words(replay.models[2]))
    words.append(_transient_words(replay))
    return words


def _transient_words(replay: Replay) -> str:
    shares = [100.0 * _mean(replay, k, "transient_error_share") for k in range(3)]
    listed = ", ".join(f"{share:.0f} % ({model.model})" for share, model in zip(shares, replay.models, strict=True))
    sentence = f"Wheel speeds of the first second, driven by the measured currents alone, are wrong by {listed}."
    if min(shares) < 25.0:
        return sentence
    return (f"{sentence} The motors' torque is almost all spent on friction, and what is left to accelerate is a small "
            "difference of large numbers: with none of these constant friction laws does the current give the speed.")


def _slip_words(replay: Replay) -> str:
    ratios = [c.rolled.ratio for c in replay.comparisons if c.rolled.ratio is not None]
    if not ratios:
        return "There is no camera: rolling cannot be judged."
    low, high = min(r.value for r in ratios), max(r.value for r in ratios)
    beyond = sum(r.value - r.half_width > 1.0 for r in ratios)
    return (f"Pure rolling gives {low:.2f} to {high:.2f} times the distance that the camera saw; in {beyond} of "
            f"{len(ratios)} runs the interval excludes 1. The model's no-slip assumption over-predicts the path on "
            "this floor.")


def _damping_words(dry: Friction) -> str:
    value, half = dry.values[0], dry.half_widths[0]
    if not np.isfinite(half):
        return f"Damping in addition to dry friction: {value:.3g} N·m·s, from one run, so without an interval."
    seen = "does not differ from zero" if abs(value) < half else "differs from zero"
    return (f"Once dry friction is allowed, the fitted damping {value:.3g} ± {half:.2g} N·m·s {seen}: what (4.7) has "
            "to call damping is mostly not proportional to speed.")


def _drag_words(drag: Friction) -> str:
    torques, halves = drag.values[1:-1], drag.half_widths[1:-1]
    listed = ", ".join(_pm(v, h) for v, h in zip(torques, halves, strict=True))
    sentence = (f"With a drag of {_pm(drag.values[-1], drag.half_widths[-1])} N against the travel, the wheels' own "
                f"dry torques become {listed} N·m")
    if (np.abs(torques) > halves).any():
        return f"{sentence}: both kinds of loss are there."
    return (f"{sentence}, none beyond its interval: the loss is in the contact, where the rollers slip or rub, "
            "rather than in the gears.")


def _direction_words(replay: Replay) -> str | None:
    seen = [c.rolled for c in replay.comparisons if c.rolled.ratio is not None]
    if not seen:
        return None

    def off(a: float, b: float) -> float:
        return abs((a - b + 180.0) % 360.0 - 180.0)

    worst = max(seen, key=lambda r: off(r.camera_direction_deg, r.direction_deg))
    wanted, went, rolled = (_whole_deg(angle) for angle in (worst.direction_deg, worst.camera_direction_deg,
                                                           worst.rolled_direction_deg))
    return (f"The direction of travel is off by up to {off(worst.camera_direction_deg, worst.direction_deg):.0f}° "
            f"(set {wanted}°, went to {went}°; the wheels rolled to {rolled}°): slip is not the same in all "
            "directions.")


def as_numbers(replay: Replay) -> dict[str, Any]:
    """All results for JSON."""
    from laconic.tools.analyse.report import plain

    models = [{"model": m.model, "residual_Nm": m.residual_Nm,
               "parameters": {name: {"value": value, "half_width_95": half}
                              for name, value, half in zip(m.names, m.values, m.half_widths, strict=True)}}
              for m in replay.models]
    return plain({"scene": str(replay.subject.scene.path), "fitted_on": replay.fitted_on, "models": models,
                  "runs": [e.as_json() | _numbers(c) for c, e in zip(replay.comparisons, replay.errors, strict=True)],
                  "words": in_words(replay), "remarks": replay.remarks,
                  "skipped": replay.skipped})


def _numbers(c: Comparison) -> dict[str, Any]:
    r = c.rolled
    ratio = None if r.ratio is None else {"value": r.ratio.value, "half_width_95": r.ratio.half_width}
    return {
        "run": c.recording.name, "direction_deg": r.direction_deg, "set_speed_m_per_s": r.speed_m_per_s,
        "rolled_m": r.rolled_m, "camera_m": r.camera_m, "rolled_over_camera": ratio,
        "rolled_direction_deg": r.rolled_direction_deg, "camera_direction_deg": r.camera_direction_deg,
        "steady_speed_rad_per_s": c.steady_speed_rad_per_s,
        "steady_current_A": [{"value": m.value, "half_width_95": m.half_width} for m in c.steady_current_A],
        "predictions": [{"model": p.model, "transient_error_rad_per_s": p.transient_error,
                         "transient_error_share": p.transient_error_share, "steady_current_A": p.steady_current_A,
                         "steady_error_A": p.steady_error_A} for p in c.predictions]}


# ---- pictures


def draw(replay: Replay, folder: Path) -> list[Path]:
    """Draws wheel speeds with residuals, rolled over camera distance, and steady currents."""
    makers = {"replay": _speeds_picture, "rolled": _rolled_picture, "currents": _currents_picture}
    drawn = []
    for name, make in makers.items():
        picture = make(replay)
        if picture is not None:
            save(picture, folder / f"{name}.png")
            drawn.append(folder / f"{name}.png")
    return drawn


def _speeds_picture(replay: Replay) -> Figure:
    """Wheel speeds of one run, measured and predicted, and the residuals."""
    shown, count = replay.shown, replay.subject.wheel_count
    picture = figure(9.0, 2.0 * (count + 1))
    rows = picture.subplots(count + 1, 1, sharex=True)
    time, measured = shown.recording.time_s, shown.recording.smooth_speed_rad_per_s
    for i in range(count):
        rows[i].plot(time, measured[:, i], color="k", lw=1.6)
        for p in shown.predictions:
            rows[i].plot(time, p.speed_rad_per_s[:, i], color=COLOURS[p.model], ls=STYLES[p.model], lw=1.1)
        rows[i].set_ylabel(f"wheel {i + 1}\nspeed [rad/s]")
    for p in shown.predictions:
        residual = np.sqrt(((p.speed_rad_per_s - measured) ** 2).mean(axis=1))
        rows[-1].plot(time, residual, color=COLOURS[p.model], ls=STYLES[p.model], lw=1.1)
    rows[-1].set(ylabel="residual, root mean\nsquare [rad/s]", xlabel="time [s]")
    rows[0].set_title(f"{wrapped(shown.recording.name, 60)}: {shown.rolled.direction_deg:.0f}°, "
                      f"{shown.rolled.speed_m_per_s:.1f} m/s\n"
                      "wheel speeds from the measured currents")
    handles = [rows[0].plot([], [], color="k", lw=1.6, label="measured")[0]]
    handles += [rows[0].plot([], [], color=COLOURS[p.model], ls=STYLES[p.model], label=p.model)[0]
                for p in shown.predictions]
    picture.legend(handles=handles, loc="outside lower center", ncols=4, fontsize=9)
    return picture


def _rolled_picture(replay: Replay) -> Figure | None:
    """Rolled over camera distance by direction; one colour per speed."""
    seen = [(c.rolled, c.rolled.ratio) for c in replay.comparisons if c.rolled.ratio is not None]
    if not seen:
        return None
    picture = figure(7.2, 4.6)
    axes = picture.subplots()
    speeds = sorted({round(rolled.speed_m_per_s, 3) for rolled, _ in seen})
    for k, speed in enumerate(speeds):
        at = [(rolled, ratio) for rolled, ratio in seen if round(rolled.speed_m_per_s, 3) == speed]
        axes.errorbar([rolled.direction_deg + 4.0 * (k - 0.5 * (len(speeds) - 1)) for rolled, _ in at],
                      [ratio.value for _, ratio in at], [ratio.half_width for _, ratio in at], fmt="osD^v"[k % 5],
                      capsize=4, label=f"{speed:g} m/s")
    axes.axhline(1.0, color="k", lw=1.0, ls="--", label="pure rolling")
    axes.set(xlabel="direction of travel in the robot's frame [°]", ylabel="rolled / camera distance [–]",
             title="How far the wheels roll for one metre of travel\n(95 % intervals)", xlim=(-25, 315))
    axes.set_xticks(range(0, 316, 45))
    axes.set_ylim(0.9, None)
    picture.legend(handles=axes.get_legend_handles_labels()[0], loc="outside lower center", ncols=4, fontsize=9)
    return picture


def _currents_picture(replay: Replay) -> Figure:
    """Steady currents: predicted over measured, for the runs that were not fitted."""
    picture = figure(6.4, 5.8)
    axes = picture.subplots()
    judged = replay.judged()
    measured = np.array([[m.value for m in c.steady_current_A] for c in judged])
    widths = np.array([[m.half_width for m in c.steady_current_A] for c in judged])
    for k, model in enumerate(replay.models):
        predicted = np.array([c.predictions[k].steady_current_A for c in judged])
        axes.errorbar(measured.ravel(), predicted.ravel(), xerr=widths.ravel(), fmt="osD"[k], ms=5, lw=0.8,
                      color=COLOURS[model.model], mfc="none", label=model.model)
    reach = 1.15 * max(float(np.abs(measured).max()), 0.1)
    axes.plot([-reach, reach], [-reach, reach], "k--", lw=1.0, label="right")
    axes.set(xlabel="measured steady current [A]", ylabel="predicted from the steady speed [A]",
             title="Steady currents of the runs not fitted on", xlim=(-reach, reach))
    axes.set_ylim(-1.6 * reach, 1.6 * reach)
    picture.legend(handles=axes.get_legend_handles_labels()[0], loc="outside lower center", ncols=4, fontsize=9)
    return picture


# ---- Rolled over travelled distance against the drag of the rollers: the law for this robot, and what the runs show.

DRAGS = np.linspace(0.05, 0.95, 13)
DIRECTIONS_DEG = (0.0, 45.0, 90.0)
SPEED_M_PER_S, SECONDS, PERIOD_S, STEADY_S = 0.2, 1.0, 0.1, 0.3


def draw_drag(scene: Scene, logs: Sequence[Log], folder: Path) -> Path:
    """Lines: the core with wheels held for straight motion; points: recorded runs, at the drag of the scene.

    A line and the points whose direction is nearest to its own have one colour.
    """
    from laconic.pictures.plotting import figure, save

    picture = figure(6.4, 4.2)
    axes = picture.subplots()
    drag = scene.vehicle["ground"].get("roller_drag", 0.0)
    found = [_recorded(scene, log) for log in logs if log.pose is not None]
    for direction in DIRECTIONS_DEG:
        line, = axes.plot(DRAGS, [_ratio(scene, direction, drag) for drag in DRAGS], label=f"{direction:g}°, the model")
        near = [ratio for degrees, ratio in found if min(DIRECTIONS_DEG, key=lambda d: abs(d - degrees)) == direction]
        if near:
            axes.scatter([drag] * len(near), near, color=line.get_color(), zorder=3, label=f"{direction:g}°, the runs")
    axes.set(xlabel="drag of the rollers k", ylabel="rolled over travelled distance")
    axes.legend(fontsize=8, title="direction of travel from the x axis", title_fontsize=8)
    save(picture, folder / "drag.png")
    return folder / "drag.png"


def _ratio(scene: Scene, direction_deg: float, drag: float) -> float:
    """Of the distance that the wheels' speeds mean over that which the core goes, in steady motion."""
    vehicle = copy.deepcopy(scene.vehicle)
    vehicle["ground"]["roller_drag"], vehicle["com_z_m"] = float(drag), 0.0  # no load moves from wheel to wheel
    way, count = np.radians(direction_deg), round(SECONDS / PERIOD_S)
    moved = SPEED_M_PER_S * PERIOD_S * np.tile([np.cos(way), np.sin(way), 0.0], (count, 1))
    rotation = rotations_of(scene.core(), vehicle, moved)
    angle = np.vstack([np.zeros(rotation.shape[1]), np.cumsum(rotation, axis=0)])
    log = Run(Path("straight"), "straight", PERIOD_S * np.arange(count + 1), wheel_angle_rad=angle)
    held = hold(scene.core(), vehicle, log)
    steady = held.time_s >= STEADY_S
    length = np.hypot(*np.diff(held.pose[steady][:, :2], axis=0).T).sum()
    return float(SPEED_M_PER_S * np.ptp(held.time_s[steady]) / length)


def _recorded(scene: Scene, log: Log) -> tuple[float, float]:
    """(angle of travel to the x axis, 0 to 90°, by the wheels; rolled over true distance)."""
    assert log.pose is not None
    moved = rolling_of(scene.core(), scene.vehicle, scene.path).moved(log.rotation_rad())[:, :2].sum(axis=0)
    travelled = np.hypot(*(log.pose[-1] - log.pose[0])[:2])
    return float(np.degrees(np.arctan2(abs(moved[1]), abs(moved[0])))), float(np.hypot(*moved) / travelled)
