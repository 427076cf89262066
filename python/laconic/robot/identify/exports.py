"""What was found, in the forms that robots read: parameters of ros2_controllers, a header for firmware, the scene."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

from laconic.errors import BadInput
from laconic.robot.identify.audit import Audit
from laconic.robot.identify.fitted_toml import fitted_text
from laconic.robot.replay.rolling import wheel_radii

ENDINGS = (".yaml", ".yml", ".h", ".toml")
WORTH_A_LINE = 0.002    # of a radius
PARALLEL_RAD = 0.02     # between axles that count as one direction


def export(found: Audit, path: Path) -> str:
    """The text for a file of this ending."""
    if path.suffix.lower() == ".toml":
        return fitted_text(found.study)
    if path.suffix.lower() == ".h":
        return header_text(found, path)
    return controllers_text(found)


def _joints(found: Audit) -> list[str]:
    names = found.logs[0].column_names
    count = len(found.scene.vehicle["wheel"])
    return list(names) if len(names) == count else [f"wheel_{number}_joint" for number in range(1, count + 1)]


def _is_differential(wheels: list[dict[str, Any]]) -> bool:
    """All driven wheels are fixed on one line across the robot, on both sides."""
    driven = [wheel for wheel in wheels if wheel.get("driven", True)]
    return (all(wheel["kind"] == "fixed" and abs(np.sin(wheel["axle_rad"])) > 1.0 - PARALLEL_RAD for wheel in driven)
            and any(wheel["y_m"] > 0.0 for wheel in driven) and any(wheel["y_m"] < 0.0 for wheel in driven))


def controllers_text(found: Audit) -> str:
    """Parameters of diff_drive_controller or mecanum_drive_controller."""
    wheels = found.scene.vehicle["wheel"]
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
        values = {"RADIUS_M": radius, "X_M": wheel["x_m"], "Y_M": wheel["y_m"], "AXLE_RAD": wheel["axle_rad"]}
        rows += [(f"ROBOT_WHEEL_{number}_{key}", f"{value:.9g}") for key, value in values.items()]
    if found.lag_s is not None:
        rows.append(("ROBOT_POSE_LAG_S", f"{found.lag_s:.9g}"))
    lines = [f"#define {name} ({value})" for name, value in rows]
    comment = [line.replace("*/", "* /") for line in _head(found, " *")]
    return "\n".join(["/*", *comment, " */", f"#ifndef {guard}", f"#define {guard}", "", *lines, "", "#endif", ""])
