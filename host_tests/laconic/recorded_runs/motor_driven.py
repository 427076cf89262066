"""A recorded run through the motors: the core from rest, driven by the recorded currents or voltages."""

from __future__ import annotations

import numpy as np

from laconic.core import Core
from laconic.errors import BadInput
from laconic.logs import Log
from laconic.recorded_runs.closed_loop import Followed
from laconic.recorded_runs.held_wheels import Vehicle, in_small_steps, intervals, point_pose
from laconic.recorded_runs.steady_currents import axles_of, with_torques

STEP_S = 0.002


def by_currents(core: Core, vehicle: Vehicle, log: Log) -> Followed:
    """Each motor's torque is its recorded current's; between samples it is linear."""
    axles = axles_of(core, vehicle)
    if axles is None:
        raise BadInput("--inputs currents: the torque of a current needs [vehicle.motor] in the scene")
    current = log.needs("current_A", "--inputs currents")
    torque = np.nan_to_num(current * axles.torque_per_A_Nm)
    found = _run(core, with_torques(vehicle, axles), log, "axle_torque_Nm", torque)
    return Followed(found.time_s, found.speed_rad_per_s, current[intervals(log.time_s)], found.pose)


def by_voltages(core: Core, vehicle: Vehicle, log: Log) -> Followed:
    """The scene's motors at the recorded voltages; between samples they are linear."""
    voltage = np.nan_to_num(log.needs("voltage_V", "--inputs voltages"))
    return _run(core, vehicle, log, "voltage_V", voltage)


def _run(core: Core, vehicle: Vehicle, log: Log, signal: str, values: np.ndarray) -> Followed:
    found: Followed = in_small_steps(lambda step_s: _run_in(step_s, core, vehicle, log, signal, values), STEP_S)
    return found


def _run_in(step_s: float, core: Core, vehicle: Vehicle, log: Log, signal: str, values: np.ndarray) -> Followed:
    plant, time = core.plant(core.vehicle(vehicle), "auto", step_s), log.time_s
    angle, pose, current = np.zeros_like(values), np.zeros((len(time), 3)), np.zeros_like(values)
    pose[0] = point_pose(plant, log.pose_point)
    for k in range(1, len(time)):
        length = time[k] - time[k - 1]
        count = max(1, round(length / step_s))
        plant.set_step(length / count)
        for part in range(count):
            share = (part + 0.5) / count
            plant.run(core.input({signal: (1.0 - share) * values[k - 1] + share * values[k]}), 1)
        angle[k], pose[k] = plant.wheel_angles(), point_pose(plant, log.pose_point)
        current[k] = [plant.c.slip.current_A[i] for i in range(values.shape[1])]
    pose[:, :2] -= pose[0, :2].copy()  # the heading begins at 0
    taken = intervals(time)
    speed = np.vstack([np.zeros(values.shape[1]), np.diff(angle[taken], axis=0) / np.diff(time[taken])[:, None]])
    return Followed(time[taken], speed, current[taken], pose)
