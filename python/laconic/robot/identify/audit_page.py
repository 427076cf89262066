"""The page and the picture of an audit, and what it found in the forms that robots read."""

from __future__ import annotations

import re
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from laconic.errors import BadInput
from laconic.robot.identify.audit import LEFT, Audit
from laconic.robot.identify.fitted_toml import fitted_text
from laconic.robot.identify.ground import has_rollers
from laconic.robot.identify.report import as_numbers as numbers_of_study
from laconic.robot.identify.rolling_evidence import STRETCHES
from laconic.robot.identify.steered_audit import controllers_text as steered_text
from laconic.robot.identify.steered_audit import place_of_wheel
from laconic.robot.logs.log import counted, remarks_of
from laconic.robot.replay.rolling import wheel_radii
from laconic.robot.replay.steered_signals import of_log
from laconic.scene.base import joint_names

WORTH_A_LINE = 0.002    # of a radius
SLIPS, DEVIATIONS = 0.02, 2.0   # of true over rolled motion: what is beyond both it and so many standard errors
ROUNDING = 1e-4         # path error of a log of the model itself, at most
PARALLEL_RAD = 0.02     # between axles that count as one direction


def export(found: Audit, path: Path) -> str:
    """The text for a file of this ending."""
    if path.suffix.lower() == ".toml":
        return fitted_text(found.study)
    if path.suffix.lower() == ".h":
        return header_text(found, path)
    return controllers_text(found)


def _joints(found: Audit) -> list[str]:
    """Of the wheels: as the log names them, else as the scene does."""
    names, count = found.logs[0].column_names, found.scene.wheel_count
    return list(names) if len(names) == count else joint_names(found.scene.base, count, [])[:count]


def _hinge_joints(found: Audit) -> list[str]:
    names = [hinge.name for hinge in found.scene.hinges]
    return joint_names(found.scene.base, found.scene.wheel_count, names)[found.scene.wheel_count:]


def _is_differential(wheels: list[dict[str, Any]]) -> bool:
    """All driven wheels are fixed on one line across the robot, on both sides."""
    driven = [wheel for wheel in wheels if wheel.get("driven", True)]
    return (all(wheel["kind"] == "fixed" and abs(np.sin(wheel["axle_rad"])) > 1.0 - PARALLEL_RAD for wheel in driven)
            and any(wheel["y_m"] > 0.0 for wheel in driven) and any(wheel["y_m"] < 0.0 for wheel in driven))


def controllers_text(found: Audit) -> str:
    """Parameters of diff_drive_controller, mecanum_drive_controller, or those of steered vehicles."""
    wheels = found.scene.vehicle["wheel"]
    if found.scene.has_hinges:
        lines = steered_text(found.scene, found.fitted, of_log(found.vehicle), _joints(found), _hinge_joints(found))
        return "\n".join([*_head(found, "#"), *lines, ""])
    if _is_differential(wheels):
        return _differential(found)
    if len(wheels) == 4 and all(wheel["kind"] not in ("fixed",) for wheel in wheels) and all(
            abs(wheel["x_m"]) > 0.0 and abs(wheel["y_m"]) > 0.0 for wheel in wheels):
        return _mecanum(found)
    raise BadInput(f"{found.scene.path}: its wheels are neither those of diff_drive_controller nor of "
                   "mecanum_drive_controller; export a .h or .toml file")


def _differential(found: Audit) -> str:
    wheels, joints = found.scene.vehicle["wheel"], _joints(found)
    driven = [index for index, wheel in enumerate(wheels) if wheel.get("driven", True)]
    left = [index for index in driven if wheels[index]["y_m"] > 0.0]
    right = [index for index in driven if wheels[index]["y_m"] < 0.0]
    nominal, fitted = found.scene.vehicle, found.fitted.vehicle
    before, after = wheel_radii(nominal), wheel_radii(fitted)
    radius = float(before.mean())
    widths = [float(np.mean([each["wheel"][i]["y_m"] for i in left])
                    - np.mean([each["wheel"][i]["y_m"] for i in right])) for each in (nominal, fitted)]

    def listed(some: list[int]) -> str:
        return ", ".join(f'"{joints[index]}"' for index in some)

    return "\n".join([
        *_head(found, "#"), "diff_drive_controller:", "  ros__parameters:",
        f"    left_wheel_names: [{listed(left)}]", f"    right_wheel_names: [{listed(right)}]",
        f"    wheel_separation: {widths[0]:.6g}", f"    wheel_radius: {radius:.6g}",
        f"    wheel_separation_multiplier: {widths[1] / widths[0]:.6f}",
        f"    left_wheel_radius_multiplier: {after[left].mean() / radius:.6f}",
        f"    right_wheel_radius_multiplier: {after[right].mean() / radius:.6f}", ""])


def _mecanum(found: Audit) -> str:
    """One radius for all wheels, as that controller has it: the mean of those found."""
    fitted = found.fitted.vehicle
    radii = wheel_radii(fitted)
    reach = float(np.mean([abs(wheel["x_m"]) + abs(wheel["y_m"]) for wheel in fitted["wheel"]]))
    spread = float(np.ptp(radii) / radii.mean())
    note = [f"# The wheels' radii differ by {100 * spread:.1f} %, which this controller cannot state."]
    return "\n".join([
        *_head(found, "#"), *(note if spread > WORTH_A_LINE else []), "mecanum_drive_controller:",
        "  ros__parameters:", "    kinematics:",
        f"      wheels_radius: {radii.mean():.6g}",
        f"      sum_of_robot_center_projection_on_X_Y_axis: {reach:.6g}", ""])


def _head(found: Audit, mark: str) -> list[str]:
    runs = ", ".join(log.stem for log in found.logs[:6]) + (" …" if len(found.logs) > 6 else "")
    return [f"{mark} {found.scene.name}, by `laconic audit` from {runs}.",
            f"{mark} Path error {100 * found.nominal:.3f} % nominal, {100 * found.found:.3f} % with these numbers."]


def header_text(found: Audit, path: Path) -> str:
    """Radii and places of the wheels as constants in C."""
    guard = re.sub(r"\W", "_", path.name.upper())
    guard = guard if guard[0].isalpha() else f"H_{guard}"
    vehicle = found.fitted.vehicle
    radii = wheel_radii(vehicle)
    rows = [("ROBOT_WHEEL_COUNT", str(len(radii)))]
    for number, (radius, wheel) in enumerate(zip(radii, vehicle["wheel"], strict=True), start=1):
        x_m, y_m = place_of_wheel(found.fitted, wheel)
        values = {"RADIUS_M": radius, "X_M": x_m, "Y_M": y_m, "AXLE_RAD": wheel["axle_rad"]}
        rows += [(f"ROBOT_WHEEL_{number}_{key}", f"{value:.9g}") for key, value in values.items()]
    if found.scene.has_hinges:
        own = of_log(found.vehicle)
        rows += [(f"ROBOT_{name}", f"{value:.9g}") for name, value in (
            ("STEERING_GAIN", own.gain), ("STEERING_OFFSET_RAD", own.offset_rad), ("TRACKER_X_M", own.tracker_x_m),
            ("TRACKER_Y_M", own.tracker_y_m), ("TRACKER_HEADING_RAD", own.tracker_heading_rad))]
    if found.lag_s is not None:
        rows.append(("ROBOT_POSE_LAG_S", f"{found.lag_s:.9g}"))
    lines = [f"#define {name} ({value})" for name, value in rows]
    comment = [line.replace("*/", "* /") for line in _head(found, " *")]
    return "\n".join(["/*", *comment, " */", f"#ifndef {guard}", f"#define {guard}", "", *lines, "", "#endif", ""])


SPREADS = ("ahead_m_per_m", "left_m_per_m", "turn_rad_per_m")
COLOURS = {"nominal": "tab:red", "fitted": "tab:blue"}


def as_text(found: Audit, picture: str | None = None) -> str:
    """A page in Markdown."""
    lines = [f"# Audit of {found.scene.name}, from {counted(len(found.logs), 'run')}", "",
             f"The wheels' odometry is off by **{100 * found.nominal:.3f} %** of the way with the scene's numbers, and "
             f"by **{100 * found.found:.3f} %** with those found.", ""]
    if found.nominal < ROUNDING:
        lines += ["That is no more than sampling and rounding of the logs make: the scene's numbers are right, and the "
                  "shares below are of that rest alone.", ""]
    if picture is not None:
        lines += [f"![{picture}]({picture})", ""]
    lines += ["| cause | share of the squared error [%] | path error that it makes alone [%] | found |",
              "| --- " * 4 + "|"]
    lines += [f"| {cause.name} | {100 * cause.share:.1f} | {100 * cause.alone:.3f} | {cause.words} |"
              for cause in found.causes]
    lines += [f"| {LEFT} | {100 * found.left:.1f} | – | – |", "", "## What is left", ""]
    lines += [f"* {word}" for word in words_of_rest(found)]
    if remarks := remarks_of(found.logs):
        lines += ["", "## The logs", "", *(f"* {each}" for each in remarks)]
    lines += ["", "## What the fit states", "", *(f"* {word}" for word in found.study.words if word not in remarks), ""]
    return "\n".join(lines)


def words_of_rest(found: Audit) -> list[str]:
    """Spread of single stretches, and gains of the motion against the fitted wheels."""
    ahead, left, turn = found.spread
    words = [f"per metre of way the fitted odometry errs by {1e3 * ahead:.1f} mm/m ahead, {1e3 * left:.1f} mm/m to the "
             f"left and {np.degrees(turn):.2f}°/m in heading: root mean square over stretches (a {STRETCHES}th of a "
             "run each), whose errors partly cancel along the path"]
    why = "rollers slip or drag there" if has_rollers(found.scene) else "wheels slip there"
    for name, gain in found.gains.items():
        what = "radian that the fitted wheels turn it, the robot turns" if name == "turn" else \
            f"metre that the fitted wheels roll {name}, the robot moves"
        is_off = abs(gain - 1.0) > max(SLIPS, DEVIATIONS * found.gain_errors[name])
        words.append(f"for each {what} {gain:.4f} {'rad' if name == 'turn' else 'm'}"
                     + (f": {why}, or a number is off that was not free" if is_off else ""))
    words.append("no time lag was found between wheels and pose" if found.lag_s is None else
                 f"the pose is {abs(1e3 * found.lag_s):.0f} ms {'behind' if found.lag_s > 0 else 'ahead of'} the "
                 f"wheels; lag_s = {found.lag_s:g} under [pose] in the map takes it out")
    return words


def as_numbers(found: Audit) -> dict[str, Any]:
    """For JSON."""
    return {"nominal": found.nominal, "found": found.found, "left": found.left,
            "causes": [asdict(cause) for cause in found.causes],
            "lag_s": found.lag_s, "gains": found.gains, "gain_errors": found.gain_errors,
            "spread": dict(zip(SPREADS, found.spread.tolist(), strict=True)),
            "fit": numbers_of_study(found.study)}


def draw(found: Audit, path: Path) -> None:
    """True, nominal and fitted path of the longest run; the share of each cause; the error along the run."""
    from laconic.pictures.plotting import figure, save

    index = int(np.argmax([len(log.time_s) for log in found.logs]))
    log = found.logs[index]
    assert log.pose is not None
    paths = found.paths(log)
    picture = figure(11.0, 4.6)
    where, how_much, along = picture.subplots(1, 3)
    where.plot(log.pose[log.seen, 0], log.pose[log.seen, 1], color="k", lw=2.6, alpha=0.35, label="true")
    for name, rolled in paths.items():
        where.plot(rolled[:, 0], rolled[:, 1], color=COLOURS[name], lw=1.1, label=name)
        off = np.hypot(*(rolled - log.pose)[log.seen, :2].T)
        along.plot(log.time_s[log.seen], 1e3 * off, color=COLOURS[name], lw=1.1, label=name)
    where.set_aspect("equal", "datalim")
    where.set(xlabel="x [m]", ylabel="y [m]", title=f"path of {log.stem}")
    where.legend(fontsize=8)
    along.set(xlabel="time [s]", ylabel="distance from the true path [mm]", title="along the run")
    rows = [*((cause.name, cause.share, "tab:blue") for cause in found.causes), ("left", found.left, "tab:gray")]
    for row, (_, share, colour) in enumerate(rows):
        how_much.barh(row, 100.0 * share, color=colour)
        how_much.text(max(0.0, 100.0 * share), row, f" {100.0 * share:.1f} %", va="center", fontsize=8)
    how_much.set_yticks(range(len(rows)), [name.replace(" of ", "\nof ", 1) for name, _, _ in rows], fontsize=8)
    how_much.invert_yaxis()
    how_much.margins(x=0.2)
    how_much.set(xlabel="share of the squared error [%]", title=f"{100 * found.nominal:.2f} % → "
                 f"{100 * found.found:.2f} % of the way")
    save(picture, path)
