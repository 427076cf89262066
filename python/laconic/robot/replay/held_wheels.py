"""A recorded run on ground with friction: the core moves, its wheels held at the speeds that the log has.

Strong motors turn the wheels as recorded whatever the ground does. In the core this is a wheel of so large an inertia
that the contacts cannot change its speed, which is written anew for each interval. What the contacts then ask of the
motors tells the currents.
"""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from laconic.core import Core
from laconic.errors import Refused
from laconic.robot.logs import Log
from laconic.robot.logs.log import Point

STEP_S = 0.01
DIVIDED = (1, 1.4, 2, 5, 16)   # of the step, where the core does not find the contact forces
APART_S = 0.09             # least length of an interval: drives send their counts at another pace than a log has rows
HOLDINGS = (3e3, 1e4, 1e3)
"""Inertia of a held wheel, in M R²: contacts change its speed by thousandths. The others: where the core finds no
contact forces, as at a standstill with one wheel that creeps by a tick."""

Vehicle = dict[str, Any]


@dataclass(frozen=True)
class Held:
    """A run with held wheels; a row for each instant (the first is the start), wheels in columns."""

    time_s: np.ndarray
    pose: np.ndarray           # x, y [m], heading [rad] of the log's point, from the origin on
    speed_rad_per_s: np.ndarray
    load_Nm: np.ndarray        # what the contact asks of the motor, positive: forward

    def at(self, time_s: np.ndarray, start: np.ndarray) -> np.ndarray:
        """The path at a log's samples, from its first true pose."""
        at_samples = np.column_stack([np.interp(time_s, self.time_s, self.pose[:, i]) for i in range(3)])
        return placed_at(at_samples, start)


def placed_at(pose: np.ndarray, start: np.ndarray) -> np.ndarray:
    """A path that begins at the origin, moved to another first pose."""
    cos, sin = np.cos(start[2]), np.sin(start[2])
    x, y, angle = pose.T
    return np.column_stack([start[0] + cos * x - sin * y, start[1] + sin * x + cos * y, start[2] + angle])


def intervals(time_s: np.ndarray) -> np.ndarray:
    """Samples at least APART_S apart, with the first and the last."""
    taken = [0]
    for index in range(1, len(time_s)):
        if time_s[index] - time_s[taken[-1]] >= APART_S:
            taken.append(index)
    if taken[-1] != len(time_s) - 1:
        taken.append(len(time_s) - 1)
    return np.array(taken)


def mean_speeds(log: Log) -> tuple[np.ndarray, np.ndarray]:
    """(instants, mean speed of each wheel since the instant before; 0 in the first row)."""
    taken = intervals(log.time_s)
    angle = np.vstack([np.zeros(log.rotation_rad().shape[1]), np.cumsum(log.rotation_rad(), axis=0)])[taken]
    time = log.time_s[taken]
    return time, np.vstack([np.zeros(angle.shape[1]), np.diff(angle, axis=0) / np.diff(time)[:, None]])


def hold(core: Core, vehicle: Vehicle, log: Log) -> Held:
    """The whole run; Refused where the core finds no contact forces even in small steps."""
    time, speed = mean_speeds(log)
    measured = ~np.isnan(speed).any(axis=0)

    def run(holding: float) -> Callable[[float], Held]:
        held = core.vehicle(_held_vehicle(vehicle, holding, measured))
        return lambda step_s: _run(core, held, time, speed, log.pose_point, step_s)

    found: Held
    for holding in HOLDINGS[:-1]:
        try:
            found = in_small_steps(run(holding), STEP_S)
            return found
        except Refused:
            continue
    found = in_small_steps(run(HOLDINGS[-1]), STEP_S)
    return found


def in_small_steps(run: Callable[[float], Any], step_s: float) -> Any:
    """The result of run(step), in smaller steps where the core refuses; Refused where the smallest does not help."""
    for divided in DIVIDED[:-1]:
        try:
            return run(step_s / divided)
        except Refused:
            continue
    return run(step_s / DIVIDED[-1])


def _held_vehicle(vehicle: Vehicle, holding: float, measured: np.ndarray) -> Vehicle:
    """Wheels that the log does not have stay as they are: those without a motor roll freely."""
    found = copy.deepcopy({key: value for key, value in vehicle.items() if key not in ("motor", "drive")})
    found["motor_gain_Nm_per_V"] = found["motor_damping_Nms"] = 0.0
    usual, found["wheel_inertia_kgm2"] = (
        found["wheel_inertia_kgm2"], holding * found["mass_kg"] * found["wheel_radius_m"] ** 2)
    for wheel, is_held in zip(found["wheel"], measured, strict=True):
        own = wheel.get("inertia_kgm2", usual)
        for key in ("inertia_kgm2", "motor_gain_Nm_per_V", "motor_damping_Nms", "motor_circuit", "driven"):
            wheel.pop(key, None)
        if not is_held:
            wheel["inertia_kgm2"] = own
    return found


def _run(core: Core, vehicle: Any, time: np.ndarray, speed: np.ndarray, point: Point, step_s: float) -> Held:
    plant = core.plant(vehicle, "auto", step_s)
    slip, resting = plant.c.slip, core.input({})
    arms = _arms(plant)
    pose, load = np.zeros((len(time), 3)), np.zeros(speed.shape)
    pose[0] = point_pose(plant, point)
    for k in range(1, len(time)):
        count = max(1, round((time[k] - time[k - 1]) / step_s))
        plant.set_step((time[k] - time[k - 1]) / count)
        for i in np.flatnonzero(~np.isnan(speed[k])):
            slip.wheel_speed_rad_per_s[i] = speed[k, i]
        plant.run(resting, count)
        pose[k] = point_pose(plant, point)
        load[k] = [-(arm[0] * slip.grip_N[i][0] + arm[1] * slip.grip_N[i][1]) for i, arm in enumerate(arms)]
    pose[:, :2] -= pose[0, :2].copy()  # the heading begins at 0
    return Held(time, pose, speed, load)


def _arms(plant: Any) -> np.ndarray:
    """Torque on the wheel per force of the contact's law: R sin γ along the roller, k R cos γ across it."""
    friction = plant.c.friction
    return np.array([[friction.axle[i].arm_m[0], friction.wheel[i].drag * friction.axle[i].arm_m[1]]
                     for i in range(friction.wheel_count)])


def point_pose(plant: Any, point: Point) -> np.ndarray:
    """x, y, heading of the body's origin, of its centre of mass or of a point on it, as a log has it."""
    found = plant.pose
    x, y = (found.x_m, found.y_m) if point == "centre_of_mass" else (found.origin_x_m, found.origin_y_m)
    if not isinstance(point, str):
        cos, sin = np.cos(found.heading_rad), np.sin(found.heading_rad)
        x, y = x + cos * point[0] - sin * point[1], y + sin * point[0] + cos * point[1]
    return np.array([x, y, found.heading_rad])
