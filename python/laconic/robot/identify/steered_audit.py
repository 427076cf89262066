"""What an audit frees of a vehicle with steered wheels, and what it found as parameters of its controllers.

Radius and distance are one factor each: for a robot in doubt that tells more than many numbers. Gain and offset of the
steering, place and lag of the tracker belong to the log's map, as in every fit of such vehicles.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from laconic.core.articulated import CARRIAGE
from laconic.errors import BadInput
from laconic.robot.identify.geometry import ANGLE_SD_RAD, RELATIVE_SD
from laconic.robot.identify.parameter import Parameters
from laconic.robot.identify.steered import LEAST_SHARE, distance_of, of_map, radius_of_all
from laconic.robot.identify.study import Study
from laconic.robot.replay.rolling import wheel_radii
from laconic.robot.replay.steered_rolling import STEERED
from laconic.robot.replay.steered_signals import OfLog
from laconic.scene import Scene

GAIN_SD, OFFSET_SD_RAD, TRACKER_SD_M = 0.3, 0.1, 0.3   # steering is known far less well than a radius
LAG_SD_S = 0.1
FREE = {"radius of the wheels": ("radius",), "distance of the wheels": ("distance",),
        "gain of the steering": ("steering-gain",), "offset of the steering": ("steering-offset",),
        "place of the tracker": ("place", "heading"), "time lag": ("clock-lag",)}
"""Of each cause: the groups of parameters."""


def parameters_of(scene: Scene, groups: Sequence[str]) -> Parameters:
    """Those of some groups; factors are 1 as the scene and the map say."""
    found = [radius_of_all(scene, RELATIVE_SD), distance_of(scene, RELATIVE_SD),
             of_map("gain", "gain of the steering, factor", "steering-gain", "", 1.0, GAIN_SD, LEAST_SHARE),
             of_map("offset_rad", "offset of the steering", "steering-offset", "rad", 0.0, OFFSET_SD_RAD),
             *(of_map(f"tracker_{axis}_m", f"place of the tracker, {axis}", "place", "m", 0.0, TRACKER_SD_M)
               for axis in "xy"),
             of_map("tracker_heading_rad", "heading of the tracker", "heading", "rad", 0.0, ANGLE_SD_RAD),
             of_map("clock_lag_s", "lag of the pose", "clock-lag", "s", 0.0, LAG_SD_S)]
    return Parameters(tuple(each for each in found if each.group in groups))


def lag_of_fit(study: Study) -> float | None:
    """The lag found; None where its interval contains 0, or the runs do not tell it."""
    found = study.found
    return next((float(value) for p, value, half in zip(found.parameters.each, found.values, found.half_widths,
                                                        strict=True) if p.group == "clock-lag" and abs(value) > half),
                None)


def place_of_wheel(scene: Scene, wheel: Mapping[str, Any]) -> tuple[float, float]:
    """Of a wheel in the frame of the carriage, all hinges at angle 0."""
    bodies = {hinge.name: body for hinge, body in zip(scene.hinges, scene.vehicle.get("body", ()), strict=True)}
    x_m, y_m, name = wheel["x_m"], wheel["y_m"], wheel.get("body", CARRIAGE)
    while name != CARRIAGE:
        x_m, y_m = x_m + bodies[name]["hinge_x_m"], y_m + bodies[name]["hinge_y_m"]
        name = bodies[name]["parent"]
    return x_m, y_m


def controllers_text(scene: Scene, fitted_one: Scene, own: OfLog, joints: Sequence[str],
                     steering: Sequence[str]) -> list[str]:
    """Parameters of tricycle_controller or ackermann_steering_controller; BadInput for other vehicles. `joints`: of
    the wheels, `steering`: of the hinges."""
    vehicle = fitted_one.vehicle
    steered = [index for index, hinge in enumerate(scene.hinges) if hinge.kind in STEERED]
    carried = [[number for number, wheel in enumerate(vehicle["wheel"])
                if wheel.get("body", CARRIAGE) == scene.hinges[index].name] for index in steered]
    rear = [number for number, wheel in enumerate(vehicle["wheel"]) if wheel.get("body", CARRIAGE) == CARRIAGE]
    if len(scene.hinges) != len(steered) or len(rear) != 2 or len(steered) > 2 or any(len(c) != 1 for c in carried):
        raise BadInput(f"{scene.path}: its wheels are neither those of tricycle_controller nor of "
                       "ackermann_steering_controller; export a .h file")
    axle_x_m = float(np.mean([vehicle["wheel"][number]["x_m"] for number in rear]))
    places = [(vehicle["body"][index]["hinge_x_m"] - axle_x_m, vehicle["body"][index]["hinge_y_m"])
              for index in steered]
    radii, base = wheel_radii(vehicle), float(np.mean([x for x, _ in places]))
    note = (f"# Multiply each measured steering angle by {own.gain:.6g} and add {own.offset_rad:.6g} rad; these "
            "controllers have no keys for that.")
    if len(steered) == 1:
        return [note, "tricycle_controller:", "  ros__parameters:",
                f'    traction_joint_name: "{joints[carried[0][0]]}"',
                f'    steering_joint_name: "{steering[steered[0]]}"',
                f"    wheelbase: {base:.6g}", f"    wheel_radius: {radii[carried[0][0]]:.6g}"]
    tracks = [float(np.ptp([y for _, y in places])), float(np.ptp([vehicle["wheel"][n]["y_m"] for n in rear]))]

    def listed(names: Sequence[str]) -> str:
        return ", ".join(f'"{name}"' for name in names)

    return [note, "# Before Kilted the keys are rear_wheels_names, front_wheels_names, rear_wheel_track,",
            "# front_wheel_track and rear_wheels_radius.", "ackermann_steering_controller:", "  ros__parameters:",
            f"    traction_joints_names: [{listed([joints[number] for number in rear])}]",
            f"    steering_joints_names: [{listed([steering[index] for index in steered])}]",
            f"    wheelbase: {base:.6g}", f"    traction_track_width: {tracks[1]:.6g}",
            f"    steering_track_width: {tracks[0]:.6g}", f"    traction_wheels_radius: {radii[rear].mean():.6g}"]
