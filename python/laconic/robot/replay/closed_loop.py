"""A recorded run through the robot's own speed controller: set speeds → currents → the core → wheel speeds.

The controller asks each motor for the current P (set − s) + I ∫(set − s) dt, some time after the set speed is given. P
acts within a step like the damping of a motor whose voltage is the set speed, so the core takes it as one: implicitly,
with the current limit of `[vehicle.drive]`. The integral is renewed at each sample of the log.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from laconic.core import Core
from laconic.errors import BadInput
from laconic.robot.logs import Log
from laconic.robot.replay.held_wheels import Vehicle, in_small_steps, intervals, mean_speeds, point_pose
from laconic.robot.replay.steady_currents import Axles, axles_of, settled, with_torques
from laconic.scene.drives import SpeedController

STEP_S = 0.002


@dataclass(frozen=True)
class Followed:
    """A run from its set speeds; a row for each instant, wheels in columns."""

    time_s: np.ndarray
    speed_rad_per_s: np.ndarray      # mean since the instant before, as the log's in mean_speeds
    current_A: np.ndarray            # at the instant
    pose: np.ndarray                 # of the log's point at the log's samples, from the origin on


def follow(core: Core, vehicle: Vehicle, controller: SpeedController, log: Log) -> Followed:
    """The whole run from rest; BadInput without the motors' constants."""
    wanted = np.nan_to_num(log.needs("set_speed_rad_per_s", "--inputs set-speeds"))
    axles = axles_of(core, vehicle)
    if axles is None:
        raise BadInput("--inputs set-speeds: the controller gives currents, which need [vehicle.motor] in the scene")
    controlled = core.vehicle(_controlled(vehicle, controller, axles))
    found: Followed = in_small_steps(lambda step_s: _follow(step_s, core, controlled, controller, log, wanted), STEP_S)
    return found


def _follow(step_s: float, core: Core, vehicle: Any, controller: SpeedController, log: Log,
            wanted: np.ndarray) -> Followed:
    plant = core.plant(vehicle, "auto", step_s)
    time, delayed = log.time_s, np.zeros_like(wanted)
    source = np.searchsorted(time, time - controller.dead_time_s, side="right") - 1
    delayed[source >= 0] = wanted[source[source >= 0]]
    summed, share = np.zeros(wanted.shape[1]), controller.integral_gain_A_per_rad / controller.gain_As_per_rad
    angle, current, pose = np.zeros_like(wanted), np.zeros_like(wanted), np.zeros((len(time), 3))
    pose[0] = point_pose(plant, log.pose_point)
    for k in range(1, len(time)):
        length = time[k] - time[k - 1]
        count = max(1, round(length / step_s))
        plant.set_step(length / count)
        plant.run({"voltage_V": delayed[k - 1] + share * summed}, count)
        angle[k] = plant.wheel_angles()
        summed = summed + delayed[k - 1] * length - (angle[k] - angle[k - 1])
        error = delayed[k - 1] - plant.wheel_speeds()
        current[k] = controller.gain_As_per_rad * error + controller.integral_gain_A_per_rad * summed
        pose[k] = point_pose(plant, log.pose_point)
    pose[:, :2] -= pose[0, :2].copy()  # the heading begins at 0
    taken = intervals(time)
    speed = np.vstack([np.zeros(wanted.shape[1]), np.diff(angle[taken], axis=0) / np.diff(time[taken])[:, None]])
    return Followed(time[taken], speed, current[taken], pose)


def _controlled(vehicle: Vehicle, controller: SpeedController, axles: Axles) -> Vehicle:
    """The motors with the controller in them: gain and damping P · torque per ampere, voltage: the set speed."""
    found = with_torques(vehicle, axles, controller.gain_As_per_rad)
    limit = vehicle.get("drive", {}).get("current_limit_A", 0.0)
    if limit:
        found["drive"] = {"current_limit_A": limit, "viscous_friction_Nms": float(np.nanmax(axles.viscous_Nms)),
                          "winding_resistance_ohm": 1.0 / controller.gain_As_per_rad}
    return found


def wheel_speed_error(log: Log, followed: Followed) -> float:
    """Root mean square over all wheels and intervals, over that of the recorded speeds."""
    recorded = mean_speeds(log)[1]
    off = followed.speed_rad_per_s - recorded
    return float(np.sqrt(np.nansum(off**2) / max(np.nansum(recorded**2), 1e-300)))


def current_error_A(log: Log, followed: Followed) -> float:
    """Mean over the wheels of the distance between predicted and recorded steady current."""
    now, then = settled(log, followed.time_s), settled(log, log.time_s)
    recorded = log.needs("current_A", "the comparison of currents")[then].mean(axis=0)
    return float(np.nanmean(np.abs(followed.current_A[now].mean(axis=0) - recorded)))
