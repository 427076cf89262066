"""Steady currents of the motors: what the contacts ask of them, and the friction of motor and axle."""

from __future__ import annotations

import copy
from dataclasses import dataclass
from typing import Any

import numpy as np

from laconic.core import Core
from laconic.robot.logs import Log
from laconic.robot.replay.held_wheels import Held

SETTLED_S = 1.5      # after the wheels begin to turn
END_S = 0.3          # before the end, where the motion may stop already
STANDS = 0.02        # share of the fastest wheel's speed below which a wheel stands


@dataclass(frozen=True)
class Axles:
    """What lies between contact and current, one for each wheel, from the core's prepared constants; NaN: no motor."""

    dry_Nm: np.ndarray
    viscous_Nms: np.ndarray
    torque_per_A_Nm: np.ndarray

    def current_A(self, load_Nm: np.ndarray, speed_rad_per_s: np.ndarray) -> np.ndarray:
        """Of wheels at constant speed; one that stands may be held by its axle's friction alone."""
        stands = np.abs(speed_rad_per_s) <= STANDS * np.nanmax(np.abs(speed_rad_per_s), initial=0.0)
        dry = np.where(stands, -np.clip(load_Nm, -self.dry_Nm, self.dry_Nm), np.sign(speed_rad_per_s) * self.dry_Nm)
        current: np.ndarray = (load_Nm + dry + self.viscous_Nms * speed_rad_per_s) / self.torque_per_A_Nm
        return current


def axles_of(core: Core, vehicle: dict[str, Any]) -> Axles | None:
    """None for a vehicle whose motors' constants are not known."""
    plant = core.plant(core.vehicle(vehicle), "auto", 0.01)
    if not plant.has_friction:
        return _without_friction(vehicle)
    friction = plant.c.friction
    each = [friction.axle[i] for i in range(friction.wheel_count)]
    driven = [wheel.get("driven", True) for wheel in vehicle["wheel"]]
    if not any(driven) or any(axle.ampere == 0.0 for axle, has_motor in zip(each, driven, strict=True) if has_motor):
        return None
    energy = friction.energy_J
    return Axles(*(energy * np.array(values) for values in (
        [axle.dry for axle in each], [axle.viscous for axle in each], [1.0 / axle.ampere if axle.ampere else np.nan
                                                                for axle in each])))


def _without_friction(vehicle: dict[str, Any]) -> Axles | None:
    """On ideal ground, from the motors' constants and what a wheel has of its own."""
    motor = vehicle.get("motor")
    if motor is None:
        return None
    ratio, ohm, emf = motor["gear_ratio"], motor["resistance_ohm"], motor["back_emf_Vs_per_rad"]
    usual = ratio * motor["torque_constant_Nm_per_A"] / ohm
    gain = np.array([wheel.get("motor_gain_Nm_per_V", usual) if wheel.get("driven", True) else np.nan
                     for wheel in vehicle["wheel"]])
    own = [wheel.get("motor_damping_Nms", ratio * emf * gain[i] + ratio**2 * motor["viscous_friction_Nms"])
           for i, wheel in enumerate(vehicle["wheel"])]
    return Axles(np.zeros(len(gain)), np.array(own) - ratio * emf * gain, ohm * gain)


def with_torques(vehicle: dict[str, Any], axles: Axles, gain_As_per_rad: float = 0.0) -> dict[str, Any]:
    """A vehicle whose motors' torque comes from outside: their rotors and viscous friction are left in its wheels.

    With a gain the voltage of each motor is the speed from which it takes so many amperes per rad/s.
    """
    found: dict[str, Any] = copy.deepcopy(vehicle)
    found.pop("drive", None)
    motor, usual = found.pop("motor"), found["wheel_inertia_kgm2"]
    rotor = motor["gear_ratio"] ** 2 * motor["rotor_inertia_kgm2"]
    found["motor_gain_Nm_per_V"] = found["motor_damping_Nms"] = 0.0
    for index, wheel in enumerate(found["wheel"]):
        if wheel.get("driven", True):
            gain = gain_As_per_rad * float(axles.torque_per_A_Nm[index])
            wheel["inertia_kgm2"] = wheel.get("inertia_kgm2", usual) + rotor
            wheel["motor_gain_Nm_per_V"] = gain
            wheel["motor_damping_Nms"] = gain + float(axles.viscous_Nms[index])
    return found


def settled(log: Log, time_s: np.ndarray) -> np.ndarray:
    """Which instants lie in steady motion; all of them in a run that is too short for it."""
    rotation = np.nanmax(np.abs(np.cumsum(log.rotation_rad(), axis=0)), axis=1)
    begin = log.time_s[int(np.argmax(rotation > 0.02))] + SETTLED_S
    found: np.ndarray = (time_s > begin) & (time_s < log.time_s[-1] - END_S)
    return found if found.any() else np.ones(len(time_s), dtype=bool)


def steady_parts(log: Log, held: Held) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Means over the steady motion, one for each wheel: load, speed, recorded current."""
    now, then = settled(log, held.time_s), settled(log, log.time_s)
    current = log.needs("current_A", "the comparison of currents")
    return held.load_Nm[now].mean(axis=0), held.speed_rad_per_s[now].mean(axis=0), current[then].mean(axis=0)


def current_error_A(axles: Axles, log: Log, held: Held) -> float:
    """Mean over the wheels of the distance between predicted and recorded steady current."""
    load, speed, current = steady_parts(log, held)
    return float(np.nanmean(np.abs(axles.current_A(load, speed) - current)))
