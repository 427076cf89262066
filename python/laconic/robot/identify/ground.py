"""The parameters of ground with friction, and what runs say about them through the core's own friction step.

Wheels are held at the recorded speeds (recorded_runs.held_wheels). The path then tells the radius and the rollers'
drag, as the contacts' law has no scale of its own; steady currents tell how large forces and axle friction are.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from laconic.core import Core
from laconic.errors import BadInput, Refused
from laconic.robot.identify.parameter import Parameter, Parameters, Vehicle
from laconic.robot.identify.rolling_evidence import (
    RollingEvidence,
    path_residual,
    stretch_errors,
    stretch_scores,
)
from laconic.robot.logs import Log
from laconic.robot.replay.held_wheels import Held, hold
from laconic.robot.replay.placing import fitted_to, start_of
from laconic.robot.replay.steady_currents import axles_of, steady_parts
from laconic.scene import Scene
from laconic.scene.ground import slips

USUAL_FRICTION = 0.5      # where the scene has none
USUAL_DRAG = 0.3
LEAST = {"friction_coefficient": 0.01, "roller_drag": 0.02, "axle_friction_Nm": 0.0}
CURRENT_SHARE = 1.0       # weight of the currents' relative error beside the path's
ROUNDED = 0.05            # relative errors of currents beyond it count by their size, not its square
DIFFERENCE = 0.02         # of z: far above the tolerance of the core's solver


def base_of(scene: Scene, parameters: Parameters) -> Vehicle:
    """The vehicle; with usual friction where parameters of it are free and the scene has none."""
    if slips(scene.vehicle) or not any(p.group in (*GROUPS, *OF_TREES) for p in parameters.each):
        return scene.vehicle
    vehicle = copy.deepcopy(scene.vehicle)
    coefficient = vehicle.pop("friction_coefficient", 0.0) or USUAL_FRICTION
    vehicle["ground"] = {**vehicle.get("ground", {}), "friction_coefficient": coefficient}
    if has_rollers(scene):
        vehicle["ground"]["roller_drag"] = USUAL_DRAG
    return vehicle


def has_rollers(scene: Scene) -> bool:
    """Whether any wheel has rollers, which may drag."""
    return any(wheel["kind"] != "fixed" for wheel in scene.vehicle["wheel"])


def _of_ground(key: str, name: str, group: str, unit: str, usual: float, sd: float) -> Callable[[Scene, float],
                                                                                          list[Parameter]]:
    def write(vehicle: Vehicle, value: float) -> None:
        vehicle["ground"][key] = value

    def make(scene: Scene, relative_sd: float) -> list[Parameter]:
        nominal = scene.vehicle.get("ground", {}).get(key, scene.vehicle.get(key) or usual)
        high = 1.0 if key == "roller_drag" else math.inf
        return [Parameter(name, f"ground.{key}", group, unit, nominal, sd, write, low=LEAST[key], high=high)
                for _ in scene.vehicle["wheel"][:1] if key != "roller_drag" or has_rollers(scene)]

    return make


def _viscous(scene: Scene, relative_sd: float) -> list[Parameter]:
    """Of the motors, at their shafts."""
    motor = scene.vehicle.get("motor")
    if not motor:
        return []

    def write(vehicle: Vehicle, value: float) -> None:
        vehicle["motor"] = {**vehicle["motor"], "viscous_friction_Nms": value}

    sd = 0.02 / motor["gear_ratio"] ** 2
    return [Parameter("viscous friction of the motors", "vehicle.motor.viscous_friction_Nms", "viscous", "N·m·s",
                      motor["viscous_friction_Nms"], sd, write, low=0.0)]


def _of_each_wheel(scene: Scene, relative_sd: float) -> list[Parameter]:
    """How much more or less than the others each wheel holds: loads and floor are not alike below all of them."""
    def writer(index: int) -> Callable[[Vehicle, float], None]:
        def write(vehicle: Vehicle, value: float) -> None:
            usual = vehicle["ground"]["friction_coefficient"]
            vehicle["wheel"][index]["friction_coefficient"] = value * usual
        return write

    if any(wheel.get("friction_coefficient") for wheel in scene.vehicle["wheel"]):
        return []
    return [Parameter(f"friction of wheel {i + 1}, share of the ground's",
                      f"vehicle.wheel[{i + 1}].friction_coefficient", "wheel-friction", "", 1.0, WHEEL_SHARE_SD,
                      writer(i), low=0.05)
            for i in range(len(scene.vehicle["wheel"]))]


MAKERS: dict[str, Callable[[Scene, float], list[Parameter]]] = {
    "drag": _of_ground("roller_drag", "drag of the rollers", "drag", "", USUAL_DRAG, 0.3),
    "friction": _of_ground("friction_coefficient", "friction coefficient of the ground", "friction", "", USUAL_FRICTION,
                           3.0),
    "axle-friction": _of_ground("axle_friction_Nm", "dry friction of the axles", "axle-friction", "N·m", 0.0, 0.3),
    "viscous": _viscous, "wheel-friction": _of_each_wheel}
GROUPS = tuple(MAKERS)
OF_TREES = ("creep", "scrub", "scrub-fade")   # of vehicles with hinges
BY_CURRENTS = ("friction", "axle-friction", "viscous")
WHEEL_SHARE_SD = 0.3


class GroundEvidence(RollingEvidence):
    """Runs whose wheels are held: path, and steady currents where a log has them and the motors are known."""

    difference = DIFFERENCE
    has_noise = False

    def __init__(self, core: Core, scene_path: Path, logs: Sequence[Log]):
        super().__init__(core, scene_path, logs)
        self.sessions = [str(log.path) for log in logs]  # a run tells of its own direction of travel
        self._logs = list(logs)

    def _parts(self, vehicle: Vehicle) -> list[tuple[np.ndarray, np.ndarray]]:
        """Path and relative errors of the steady currents of each run."""
        axles = axles_of(self._core, vehicle)
        found = []
        for log in self._logs:
            held = self._held(vehicle, log)
            off = np.zeros(0)
            if axles is not None and log.current_A is not None:
                load, speed, current = steady_parts(log, held)
                off = (axles.current_A(load, speed) - current) / max(float(np.abs(current).mean()), 0.1)
            found.append((fitted_to(log, held.at(log.time_s, start_of(log))), off))
        return found

    def _held(self, vehicle: Vehicle, log: Log) -> Held:
        """The run with held wheels; Refused names its log and the scene."""
        try:
            return hold(self._core, vehicle, log)
        except Refused as refused:
            raise refused.at(f"{log.path}: {self._path}, on the way to better values") from None

    def residuals(self, vehicle: Vehicle) -> list[np.ndarray]:
        """Path residuals, then those of the currents."""
        return [np.concatenate([path_residual(run, path), _rounded(off)])
                for run, (path, off) in zip(self.runs, self._parts(vehicle), strict=True)]

    def errors(self, vehicle: Vehicle) -> list[np.ndarray]:
        """Of each stretch of each run."""
        return [stretch_errors(run, path) for run, (path, _) in zip(self.runs, self._parts(vehicle), strict=True)]

    def scores(self, vehicle: Vehicle, jacobians: list[np.ndarray]) -> list[np.ndarray]:
        """Of each stretch of the path, and of the currents of each run together."""
        found = []
        for run, (path, off), jacobian in zip(self.runs, self._parts(vehicle), jacobians, strict=True):
            count = 2 * len(run.taken)
            rows = [stretch_scores(run, path, jacobian[:count].reshape(len(run.taken), 2, -1))]
            if len(off):
                rows.append((jacobian[count:].T @ _rounded(off))[None, :])
            found.append(np.vstack(rows))
        return found


def _rounded(off: np.ndarray) -> np.ndarray:
    """Numbers whose squares are pseudo-Huber's: a current that the model cannot explain outweighs no other."""
    size = np.sqrt(1.0 + (off / ROUNDED) ** 2) - 1.0
    found: np.ndarray = CURRENT_SHARE * np.sign(off) * ROUNDED * np.sqrt(2.0 * size / max(len(off), 1))
    return found


def need_currents(parameters: Parameters, logs: Sequence[Log], scene: Scene) -> None:
    """BadInput where parameters are free that only currents tell, and there are none."""
    asked = [p for p in parameters.each if p.group in BY_CURRENTS]
    if asked and not any(log.current_A is not None for log in logs):
        raise BadInput(f"--free {asked[0].group}: only currents tell it, and {logs[0].path} has none; leave it out")
    if asked and not scene.vehicle.get("motor"):
        raise BadInput(f"--free {asked[0].group}: {scene.path}: vehicle.motor is missing, which makes torques of "
                       "currents; give it, or leave the name out")
