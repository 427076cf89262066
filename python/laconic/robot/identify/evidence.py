"""Which evidence runs give for what is free: paths by rolling or with friction, turns by a gyro, motion by voltages."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from laconic.errors import BadInput
from laconic.robot.identify import ground, motion
from laconic.robot.identify.ground import GroundEvidence, base_of
from laconic.robot.identify.gyro import GyroEvidence, turned
from laconic.robot.identify.parameter import Parameters
from laconic.robot.identify.resolution import floor_of_all
from laconic.robot.identify.rolling_evidence import RollingEvidence
from laconic.robot.identify.solve import Evidence
from laconic.robot.identify.steered_evidence import SteeredEvidence
from laconic.robot.logs import Log
from laconic.robot.logs.log import run_names
from laconic.robot.replay.measures import RunErrors
from laconic.robot.replay.rolled_paths import roll
from laconic.robot.replay.rolling import rolling_of
from laconic.scene import Scene
from laconic.scene.ground import slips

MEASURE = {"path": "path_error", "turn": "heading_error_rad", "motion": "wheel_speed_error"}
SAID = {"path_error": ("path error", 100.0, "%"), "heading_error_rad": ("heading at the end", 1.0, "rad"),
        "wheel_speed_error": ("error of the wheel speeds", 100.0, "%")}
"""Of each measure: its name, and factor and unit in which it is printed."""


def kind_of(logs: Sequence[Log], parameters: Parameters) -> str:
    """"motion" by voltages or currents, "turn" by a gyro, else "path"; BadInput where two kinds are asked for."""
    groups = [p.group for p in parameters.each]
    moving = [group for group in groups if group in motion.GROUPS]
    others = [group for group in groups if group not in motion.GROUPS]
    if moving and others:
        raise BadInput(f"--free {moving[0]} with {others[0]}: voltages determine the first, paths the second; "
                       f"identify {others[0]} first, then {moving[0]} with the fitted scene")
    if moving:
        return "motion"
    return "turn" if not any(group in ground.GROUPS for group in groups) and all(
        log.pose is None and log.yaw_rate_rad_per_s is not None for log in logs) else "path"


def evidence_of(scene: Scene, logs: Sequence[Log], parameters: Parameters, whole: bool = False) -> Evidence:
    """Of the kind that the parameters need and the logs have. `whole`: by whole paths for vehicles with hinges, too."""
    kind, base = kind_of(logs, parameters), base_of(scene, parameters)
    if scene.has_hinges:
        return SteeredEvidence(scene, base, logs, whole=whole)
    if any(p.group == "clock-lag" for p in parameters.each) and (kind != "path" or slips(base)):
        raise BadInput("--free clock-lag: is found by rolling without slip and a recorded pose; find it so first")
    if kind == "motion":
        return _moved(scene, logs, parameters)
    if kind == "turn" and not slips(base):
        return GyroEvidence(scene.core(), scene.path, logs)
    if slips(base):
        return GroundEvidence(scene.core(), scene.path, logs)
    found = RollingEvidence(scene.core(), scene.path, logs)
    rolling = rolling_of(scene.core(), scene.vehicle, scene.path)
    found.floor = floor_of_all(rolling.path, logs, found.runs, rolling.per_rotation)
    return found


def _moved(scene: Scene, logs: Sequence[Log], parameters: Parameters) -> motion.MotionEvidence:
    inputs = motion.inputs_of(scene, logs, [p.group for p in parameters.each])
    return motion.MotionEvidence(scene.core(), base_of(scene, parameters), logs, inputs)


def errors_of(scene: Scene, logs: Sequence[Log], parameters: Parameters) -> list[RunErrors]:
    """What a scene's predictions of some runs are off by, in the measure of this kind."""
    kind = kind_of(logs, parameters)
    if kind == "motion":
        shares = motion.errors_of_speeds(_moved(scene, logs, parameters), base_of(scene, parameters))
        return [RunErrors(name, log.session, wheel_speed_error=share)
                for name, log, share in zip(run_names(logs), logs, shares, strict=True)]
    if kind == "turn":
        rolling = rolling_of(scene.core(), scene.vehicle, scene.path)
        return [RunErrors(name, log.session, heading_error_rad=float(abs(
            rolling.moved(log.rotation_rad())[:, 2].sum() - turned(log)[-1])))
            for name, log in zip(run_names(logs), logs, strict=True)]
    return roll(scene, logs).errors


def like(logs: Sequence[Log], log: Log, yaw_rate: float) -> Log:
    """A made-up run with the sensors that the others have."""
    if all(each.pose is None and each.yaw_rate_rad_per_s is not None for each in logs):
        return replace(log, pose=None, yaw_rate_rad_per_s=np.full(len(log.time_s), yaw_rate))
    if log.pose is not None and all(each.pose is not None and not each.has_heading for each in logs):
        return replace(log, pose=log.pose * np.array([1.0, 1.0, np.nan]))
    return log
