"""The parameters of motion: masses, inertias and motors, from runs whose voltages or currents were recorded.

The core drives the whole run with what the log has, and its wheel speeds are set beside the recorded ones. Voltages
alone tell every force in units of one of them: mass, inertias, gain and damping may all be larger by one factor.
Currents are torques, once the motor's constant is known, and tell sizes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from laconic.core import Core
from laconic.errors import BadInput
from laconic.robot.identify.ground import DIFFERENCE
from laconic.robot.identify.parameter import Parameter, Vehicle
from laconic.robot.logs import Log
from laconic.robot.replay.held_wheels import mean_speeds
from laconic.robot.replay.motor_driven import by_currents, by_voltages, restarts
from laconic.scene import Scene
from laconic.scene.ground import slips

STRETCHES = 24
RESTART_S = 1.0                # by currents: speeds follow from torques only so long
SD = 0.5                       # of each beforehand, as a share of its nominal value
ELECTRIC = ("motor-gain", "motor-damping", "resistance", "torque-constant")
OF_VEHICLE = {
    "mass": ("mass_kg", "mass", "kg"), "yaw-inertia": ("yaw_inertia_kgm2", "yaw inertia", "kg·m²"),
    "wheel-inertia": ("wheel_inertia_kgm2", "inertia of the wheels", "kg·m²"),
    "motor-gain": ("motor_gain_Nm_per_V", "gain of the motors", "N·m/V"),
    "motor-damping": ("motor_damping_Nms", "damping of the motors", "N·m·s")}
OF_MOTOR = {"resistance": ("resistance_ohm", "resistance of the motors", "Ω"),
            "torque-constant": ("torque_constant_Nm_per_A", "torque constant of the motors", "N·m/A")}
GROUPS = (*OF_VEHICLE, *OF_MOTOR)
LEAST_SHARE = 0.02


def _of_vehicle(key: str, name: str, group: str, unit: str) -> Callable[[Scene, float], list[Parameter]]:
    def write(vehicle: Vehicle, value: float) -> None:
        vehicle[key] = value

    def make(scene: Scene, relative_sd: float) -> list[Parameter]:
        nominal = scene.vehicle.get(key, 0.0)
        return [Parameter(name, f"vehicle.{key}", group, unit, nominal, SD * nominal, write, low=LEAST_SHARE * nominal)
                for _ in scene.vehicle["wheel"][:1] if nominal > 0.0]

    return make


def _of_motor(key: str, name: str, group: str, unit: str) -> Callable[[Scene, float], list[Parameter]]:
    def make(scene: Scene, relative_sd: float) -> list[Parameter]:
        motor = scene.vehicle.get("motor")
        if motor is None:
            return []

        def write(vehicle: Vehicle, value: float) -> None:
            vehicle["motor"] = {**vehicle["motor"], key: value}
            if group == "torque-constant":  # in SI units the back-EMF's constant is the same number
                vehicle["motor"]["back_emf_Vs_per_rad"] = motor["back_emf_Vs_per_rad"] * value / motor[key]

        return [Parameter(name, f"vehicle.motor.{key}", group, unit, motor[key], SD * motor[key], write,
                          low=LEAST_SHARE * motor[key])]

    return make


MAKERS: dict[str, Callable[[Scene, float], list[Parameter]]] = {
    **{group: _of_vehicle(key, name, group, unit) for group, (key, name, unit) in OF_VEHICLE.items()},
    **{group: _of_motor(key, name, group, unit) for group, (key, name, unit) in OF_MOTOR.items()}}


def why_none(scene: Scene, group: str) -> str:
    """Why a scene has no parameter of this group, and the remedy."""
    has_motor = "motor" in scene.vehicle
    if group in ("motor-gain", "motor-damping") and has_motor:
        return ("has [vehicle.motor], which makes the motors' gain and damping; take --free resistance or "
                "torque-constant")
    if group in OF_MOTOR and not has_motor:
        return "has no [vehicle.motor]; give it, or take --free motor-gain,motor-damping"
    return "has no wheel with one that could move; leave it out"


def inputs_of(scene: Scene, logs: Sequence[Log], groups: Sequence[str]) -> str:
    """"currents" where they tell sizes and nothing electric is free, else "voltages"; BadInput without either."""
    electric = [group for group in groups if group in ELECTRIC]
    if not electric and "motor" in scene.vehicle and all(log.current_A is not None for log in logs):
        return "currents"
    for log in logs:
        if log.voltage_V is None:
            why = "" if electric else ", or its currents and [vehicle.motor] in the scene"
            raise BadInput(f"--free {groups[0]}: {log.path} has no voltages, which drive the model; name their columns "
                           f"in the map{why}")
    return "voltages"


class MotionEvidence:
    """Runs whose inputs drive the core; residuals are wheel speeds, over the size of the recorded ones."""

    def __init__(self, core: Core, vehicle: Vehicle, logs: Sequence[Log], inputs: str):
        self._core, self._logs = core, list(logs)
        self._follow = partial(by_currents, restart_s=RESTART_S) if inputs == "currents" else by_voltages
        self._restarts = inputs == "currents"
        self.sessions = [str(log.path.resolve().parent) for log in logs]
        self.recorded = [_recorded(log) for log in logs]
        self.directions = self.recorded[0].shape[1]
        self.difference = DIFFERENCE if slips(vehicle) else 0.0

    def _off(self, vehicle: Vehicle) -> list[np.ndarray]:
        """Of each run: intervals × wheels; a wheel that was not measured counts nothing."""
        found = []
        for log, speed in zip(self._logs, self.recorded, strict=True):
            followed = self._follow(self._core, vehicle, log)
            off = np.nan_to_num(followed.speed_rad_per_s - speed) / np.sqrt(np.nansum(speed**2))
            found.append(_without_offsets(log, followed.time_s, off) if self._restarts else off)
        return found

    def residuals(self, vehicle: Vehicle) -> list[np.ndarray]:
        """Their squares sum to the squared error of the wheel speeds."""
        return [each.ravel() for each in self._off(vehicle)]

    def errors(self, vehicle: Vehicle) -> list[np.ndarray]:
        """The mean error of each stretch, wheels in columns."""
        return [np.array([part.mean(axis=0) for part in np.array_split(each, STRETCHES)])
                for each in self._off(vehicle)]

    def scores(self, vehicle: Vehicle, jacobians: list[np.ndarray]) -> list[np.ndarray]:
        """Of each stretch: the errors within it times the Jacobian there."""
        found = []
        for off, jacobian in zip(self._off(vehicle), jacobians, strict=True):
            rows = jacobian.reshape(*off.shape, -1)
            parts = zip(np.array_split(off, STRETCHES), np.array_split(rows, STRETCHES), strict=True)
            found.append(np.array([np.einsum("kw,kwp->p", error, part) for error, part in parts]))
        return found


def _without_offsets(log: Log, time_s: np.ndarray, off: np.ndarray) -> np.ndarray:
    """Less the mean of each restart: the speed that it took from the log carries the encoder's noise."""
    window = np.searchsorted(log.time_s[restarts(log.time_s, RESTART_S)], time_s, side="left")
    found = off.copy()
    for number in np.unique(window):
        found[window == number] -= found[window == number].mean(axis=0)
    return found


def errors_of_speeds(evidence: MotionEvidence, vehicle: Vehicle) -> list[float]:
    """Of each run, over the size of the recorded speeds."""
    return [float(np.sqrt(each @ each)) for each in evidence.residuals(vehicle)]


def _recorded(log: Log) -> np.ndarray:
    """Mean speeds; BadInput for a run that is too short to be cut into stretches, or stands."""
    speed = mean_speeds(log)[1]
    if len(speed) < STRETCHES:
        raise BadInput(f"{log.path}: has {len(speed)} intervals of 0.09 s; give runs of {0.09 * STRETCHES:.1f} s or "
                       "more, sampled as often")
    if not np.nansum(speed**2) > 0.0:
        raise BadInput(f"{log.path}: its wheels stand; give runs in which the robot moves")
    return speed


def stepping(core: Core, vehicle: Vehicle, velocity: np.ndarray, seconds: float, inputs: str) -> Log:
    """A run whose voltages or currents turn the wheels one way, then the other way, as a velocity of the body asks."""
    from laconic.robot.replay.rolling import rotations_of

    period = 0.1  # so that the intervals of mean speeds are those of the samples
    wheels = rotations_of(core, vehicle, velocity[None, :])[0]
    count = round(seconds / period)
    pattern = np.where(np.arange(count + 1) // (count // 4) % 2 == 0, 1.0, -1.0)[:, None] * wheels
    time, log_path = period * np.arange(count + 1), Path("motion")
    log = Log(log_path, "motion", time, voltage_V=pattern, current_A=pattern,
              wheel_speed_rad_per_s=np.zeros_like(pattern))
    done = (by_currents if inputs == "currents" else by_voltages)(core, vehicle, log)
    angle = np.cumsum(period * done.speed_rad_per_s, axis=0)
    return Log(log_path, "motion", time, voltage_V=pattern, current_A=pattern, wheel_angle_rad=angle)
