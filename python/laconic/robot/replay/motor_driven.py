"""A recorded run through the motors: the core from rest, driven by the recorded currents or voltages."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from laconic.core import Core
from laconic.core.plant import Plant
from laconic.errors import BadInput
from laconic.robot.logs import Log
from laconic.robot.replay.closed_loop import Followed
from laconic.robot.replay.held_wheels import Vehicle, in_small_steps, intervals, point_pose
from laconic.robot.replay.rolling import null_space
from laconic.robot.replay.steady_currents import axles_of, with_torques
from laconic.scene.ground import slips

STEP_S = 0.002
AROUND_S = 0.2     # to either side of a sample, of which angles tell the speed there
SAME_STEP = 1e-9   # of a step: times in a log carry their rounding


def by_currents(core: Core, vehicle: Vehicle, log: Log, restart_s: float = math.inf) -> Followed:
    """Each motor's torque is its recorded current's; between two samples their mean.

    Torques fix accelerations alone, so errors of the speeds add up; restart_s: the model takes the recorded speeds anew
    so often. The path means nothing then.
    """
    axles = axles_of(core, vehicle)
    if axles is None:
        raise BadInput("--inputs currents: the torque of a current needs [vehicle.motor] in the scene")
    current = log.needs("current_A", "--inputs currents")
    torque = np.nan_to_num(current * axles.torque_per_A_Nm)
    found = _run(core, with_torques(vehicle, axles), log, "axle_torque_Nm", 0.5 * (torque[1:] + torque[:-1]), restart_s)
    return Followed(found.time_s, found.speed_rad_per_s, current[intervals(log.time_s)], found.pose)


def by_voltages(core: Core, vehicle: Vehicle, log: Log) -> Followed:
    """The scene's motors at the recorded voltages, each held until the next sample, as controllers hold them."""
    voltage = np.nan_to_num(log.needs("voltage_V", "--inputs voltages"))
    return _run(core, vehicle, log, "voltage_V", voltage[:-1])


def _run(core: Core, vehicle: Vehicle, log: Log, signal: str, values: np.ndarray,
         restart_s: float = math.inf) -> Followed:
    found: Followed = in_small_steps(
        lambda step_s: _run_in(step_s, core, vehicle, log, signal, values, restart_s), STEP_S)
    return found


def _run_in(step_s: float, core: Core, vehicle: Vehicle, log: Log, signal: str, values: np.ndarray,
            restart_s: float) -> Followed:
    """values: one row for each interval between samples."""
    c_vehicle, time = core.vehicle(vehicle), log.time_s
    plant, anew = core.plant(c_vehicle, "auto", step_s, **_start(core, vehicle, log)), restarts(time, restart_s)
    before = np.zeros(values.shape[1])
    shape = (len(time), values.shape[1])
    angle, pose, current = np.zeros(shape), np.zeros((len(time), 3)), np.zeros(shape)
    pose[0], rows, last = point_pose(plant, log.pose_point), {}, 0.0
    for k in range(1, len(time)):
        if k - 1 in anew:
            plant = core.plant(c_vehicle, "auto", step_s, **_moving(core, vehicle, speed_at(log, k - 1)))
            before, last = angle[k - 1], 0.0
        length = time[k] - time[k - 1]
        count = max(1, round(length / step_s))
        if abs(length / count - last) > SAME_STEP * last:
            last = length / count
            plant.set_step(last)
        row = values[k - 1].tobytes()
        if row not in rows:
            rows = {row: plant.input_of({signal: values[k - 1]})}
        plant.run(rows[row], count)
        angle[k], pose[k] = before + plant.wheel_angles(), point_pose(plant, log.pose_point)
        current[k] = _currents(plant, vehicle, values[k - 1])
    pose[:, :2] -= pose[0, :2].copy()  # the heading begins at 0
    taken = intervals(time)
    speed = np.vstack([np.zeros(shape[1]), np.diff(angle[taken], axis=0) / np.diff(time[taken])[:, None]])
    return Followed(time[taken], speed, current[taken], pose)


def restarts(time_s: np.ndarray, restart_s: float) -> list[int]:
    """The samples, ends of intervals, at which the recorded speeds are taken anew."""
    found, begun = [], time_s[0]
    for index in intervals(time_s)[1:-1]:
        if time_s[index] - begun >= (1.0 - SAME_STEP) * restart_s:
            found.append(int(index))
            begun = time_s[index]
    return found


def _start(core: Core, vehicle: Vehicle, log: Log) -> dict[str, Any]:
    """Rest, or the speeds with which a log begins; on ideal ground as far as its wheels roll alike."""
    return {} if log.wheel_speed_rad_per_s is None or slips(vehicle) else _moving(
        core, vehicle, log.wheel_speed_rad_per_s[0])


def speed_at(log: Log, index: int) -> np.ndarray:
    """Of the wheels at a sample: the slope of a cubic through their angles around it."""
    time = log.time_s - log.time_s[index]
    near = np.abs(time) <= AROUND_S
    first = max(int(np.argmax(near)) - 1, 0)
    taken = slice(first, int(np.flatnonzero(near)[-1]) + 2)
    rotation = np.cumsum(log.rotation_rad()[taken.start:taken.stop - 1], axis=0)
    angle = np.vstack([np.zeros(rotation.shape[1]), rotation])
    measured = ~np.isnan(angle).any(axis=0)
    slope: np.ndarray = np.polyfit(time[taken], np.where(measured, angle, 0.0), min(3, len(angle) - 1))[-2]
    return np.where(measured, slope, np.nan)


def _moving(core: Core, vehicle: Vehicle, speed: np.ndarray) -> dict[str, Any]:
    """The start at some speeds of the wheels, as far as they roll alike; on ground with friction each has its own."""
    measured, matrices = ~np.isnan(speed), core.matrices(core.vehicle(vehicle))
    allowed = null_space(matrices.constraint_rows)
    moving = np.linalg.pinv(matrices.wheel_rows[measured] @ allowed) @ speed[measured]
    start = {"nu_rad_per_s": allowed @ moving}
    return start | {"wheel_speed_rad_per_s": np.nan_to_num(speed)} if slips(vehicle) else start


def _currents(plant: Plant, vehicle: Vehicle, voltage: np.ndarray) -> Any:
    """With friction or a drive the core tells them; else they follow from the motors' constants, NaN without those."""
    if plant.has_friction:
        return [plant.c.slip.current_A[i] for i in range(len(voltage))]
    if (motor := vehicle.get("motor")) is None:
        return np.nan
    emf = motor["back_emf_Vs_per_rad"] * motor["gear_ratio"] * plant.wheel_speeds()
    return (voltage - emf) / motor["resistance_ohm"]
