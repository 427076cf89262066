"""What the model says of recorded runs, from whatever of the log drives it: paths, wheel speeds, steady currents."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from laconic.core import Core
from laconic.errors import BadInput, Refused
from laconic.robot.logs import Log
from laconic.robot.logs.log import run_names
from laconic.robot.replay import closed_loop, motor_driven, steady_currents
from laconic.robot.replay.closed_loop import Followed
from laconic.robot.replay.held_wheels import hold, placed_at
from laconic.robot.replay.measures import RunErrors, path_errors
from laconic.robot.replay.placing import fitted_to, start_of
from laconic.robot.replay.rolling import rolling_of
from laconic.robot.replay.steered_rolling import SteeredRolling
from laconic.robot.replay.steered_signals import begun_at, late, of_log
from laconic.robot.replay.steered_slip import SteeredSlip
from laconic.scene import Scene
from laconic.scene.ground import slips

Prediction = tuple[np.ndarray, RunErrors]
"""Path of a run at the log's samples, and its errors."""


def predict(scene: Scene, logs: Sequence[Log], inputs: str) -> list[Prediction]:
    """One prediction for each run; BadInput names the log where the core refuses."""
    one = _predictor(scene, inputs)
    found = []
    for name, log in zip(run_names(logs), logs, strict=True):
        try:
            found.append(one(name, log))
        except Refused as refused:
            raise refused.at(f"{log.path}: {scene.path}") from None
    return found


def _predictor(scene: Scene, inputs: str) -> Callable[[str, Log], Prediction]:
    if scene.has_hinges:
        return _steered(scene, inputs)
    core = scene.core()
    if inputs == "wheel-speeds" and not slips(scene.vehicle):
        rolling = rolling_of(core, scene.vehicle, scene.path)
        lag_s = of_log(scene.vehicle).clock_lag_s
        return lambda name, log: _with_path(name, log, _delayed(log, rolling.path(log), lag_s))
    if inputs == "wheel-speeds":
        return lambda name, log: _held(core, scene, name, log)
    if inputs == "set-speeds" and scene.speed_controller is None:
        raise BadInput(f"{scene.path}: speed_controller: is missing, which --inputs set-speeds needs; let `laconic "
                       "identify --free controller` find it, or take --inputs wheel-speeds")
    drive = {"currents": motor_driven.by_currents, "voltages": motor_driven.by_voltages}.get(inputs)
    if drive is None:
        controller = scene.speed_controller
        assert controller is not None
        return lambda name, log: _followed(name, log, closed_loop.follow(core, scene.vehicle, controller, log))
    return lambda name, log: _followed(name, log, drive(core, scene.vehicle, log), inputs == "currents")


def _steered(scene: Scene, inputs: str) -> Callable[[str, Log], Prediction]:
    if inputs != "wheel-speeds":
        raise BadInput(f"{scene.path}: --inputs {inputs} does not take vehicles with hinges yet; take --inputs "
                       "wheel-speeds, with [steering_angle] in the map")
    rolling = (SteeredSlip if slips(scene.vehicle) else SteeredRolling)(scene)
    return lambda name, log: _with_path(name, log, rolling.path(log))


def _delayed(log: Log, path: np.ndarray, lag_s: float) -> np.ndarray:
    """What a tracker saw whose poses are late."""
    if lag_s == 0.0:
        return path
    seen = late(path, log.time_s, log.time_s, lag_s)
    return begun_at(seen, start_of(log)) if log.has_heading or log.pose is None else fitted_to(log, seen)


def _with_path(name: str, log: Log, path: np.ndarray) -> Prediction:
    return path, path_errors(name, log, path)


def _held(core: Core, scene: Scene, name: str, log: Log) -> Prediction:
    held = hold(core, scene.vehicle, log)
    path, errors = _with_path(name, log, fitted_to(log, held.at(log.time_s, start_of(log))))
    axles = None if log.current_A is None else steady_currents.axles_of(core, scene.vehicle)
    error = None if axles is None else steady_currents.current_error_A(axles, log, held)
    return path, replace(errors, current_error_A=error)


def _followed(name: str, log: Log, followed: Followed, is_given: bool = False) -> Prediction:
    """is_given: the currents are the log's own."""
    path, errors = _with_path(name, log, fitted_to(log, placed_at(followed.pose, start_of(log))))
    turns = log.wheel_angle_rad is not None or log.wheel_speed_rad_per_s is not None
    compares = not is_given and log.current_A is not None and not np.isnan(followed.current_A).all()
    return path, replace(
        errors, wheel_speed_error=closed_loop.wheel_speed_error(log, followed) if turns else None,
        current_error_A=closed_loop.current_error_A(log, followed) if compares else None)
