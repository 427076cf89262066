"""A steered vehicle on ground with friction, by its log: the core moves, with hinges at the recorded angles and driven
wheels at the recorded speeds.

Hinges whose angles the log says are prescribed ones. Driven wheels have so large an inertia that the contacts cannot
change their speed, which is written anew for each step, as for vehicles without hinges. Of a commanded speed the
wheels of the fixed axle get their shares as a differential gives them, by the yaw rate that there is.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from laconic.core.articulated import CARRIAGE
from laconic.core.slipping import SlippingVehicle, hinge_keys
from laconic.errors import Refused
from laconic.robot.logs.log import Log
from laconic.robot.replay.held_wheels import intervals
from laconic.robot.replay.rolling import path_of
from laconic.robot.replay.steered_rolling import STEERED, SteeredRolling
from laconic.robot.replay.steered_signals import Driven
from laconic.scene import Scene

STEP_S = 0.01
DIVIDED = (1, 2, 5, 20)    # of the step, where the core finds no contact forces
HOLDING = 3e3              # inertia of a held wheel, in M R²
LIGHT = 1e-3               # of the carriage's mass, for what turns with a wheel: without any, the core refuses it
TURN = 2.0**64


class SteeredSlip(SteeredRolling):
    """Predicts paths by the core's step for vehicles with hinges on ground with friction."""

    def path(self, log: Log) -> np.ndarray:
        run = self.driven(log)
        return self.placed(log, run.time_s, self.slid(log, run))

    def slid(self, log: Log, run: Driven) -> np.ndarray:
        """The path of the body's frame at the run's instants, from the origin on."""
        angles, moved = self.hinge_angles(log, run.steering_rad), self.moved(log, run)
        if not len(moved):
            return path_of(moved, np.zeros(3))
        held = self._held(run)
        vehicle = self._vehicle(tuple(angles), held)
        speeds = self._speeds(log, run, moved)
        for divided in DIVIDED[:-1]:
            try:
                return self._slid(vehicle, run, angles, moved, speeds, held, STEP_S / divided)
            except Refused:
                continue
        return self._slid(vehicle, run, angles, moved, speeds, held, STEP_S / DIVIDED[-1])

    def _held(self, run: Driven) -> list[int]:
        """The wheels whose speeds are given: driven ones, as others only roll along; those, too, where no driven one is
        measured."""
        driven = [i for i, wheel in enumerate(self.scene.vehicle["wheel"]) if wheel.get("driven", True)]
        if run.way_m is not None:
            return driven
        measured = [int(i) for i in np.flatnonzero(~np.isnan(run.rotation_rad).any(axis=0))]
        return [i for i in measured if i in driven] or measured

    def _speeds(self, log: Log, run: Driven, moved: np.ndarray) -> np.ndarray:
        """Of each wheel between two instants; of commands as they roll without slip."""
        rotation = run.rotation_rad if run.way_m is None else self.rotations(log, run, moved)
        rotation = np.nan_to_num(rotation)
        if run.way_m is None:
            rotation = _even(run.time_s, rotation)
        found: np.ndarray = rotation / np.diff(run.time_s)[:, None]
        return found

    def _vehicle(self, names: tuple[str, ...], held: list[int]) -> SlippingVehicle:
        return SlippingVehicle(held_table(self.scene, names, held), self.scene.core().real)

    def _slid(self, vehicle: SlippingVehicle, run: Driven, angles: Mapping[str, np.ndarray], moved: np.ndarray,
              speeds: np.ndarray, held: list[int], step_s: float) -> np.ndarray:
        start, steps = moved[0] / (run.time_s[1] - run.time_s[0]), np.diff(run.time_s)
        centre = self._centre
        first = [float(angles[hinge.name][0]) if hinge.name in angles else hinge.start_angle_rad
                 for hinge in self.scene.hinges]
        plant = vehicle.plant(step_s=step_s, velocity_m_per_s=(start[0] - start[2] * centre.imag,
                                                               start[1] + start[2] * centre.real),
                              yaw_rate_rad_per_s=float(start[2]), hinge_angle_rad=first)
        core, state, why = vehicle.core, plant.c, vehicle.core.why()
        step, model = core.lib.laconic_tree_step, vehicle.model
        given = core.ffi.new("laconic_tree_input *")
        rates = [(vehicle.names.index(name), (np.diff(angles[name]) / steps).tolist()) for name in angles]
        rate_of = given.hinged.hinge_rate_rad_per_s
        shares = self._shares(held) if run.way_m is not None else []
        ways = [] if run.way_m is None else (run.way_m / steps).tolist()
        wheels, z, rows = state.wheel_speed_rad_per_s, state.z, speeds.tolist()
        found = np.empty((len(run.time_s), 3))
        found[0] = _pose(state)
        for index, (length, row) in enumerate(zip(steps.tolist(), rows, strict=True)):
            for body, of_hinge in rates:
                rate_of[body] = of_hinge[index]
            for wheel in held:
                wheels[wheel] = row[wheel]
            count = max(1, math.ceil(length / step_s - 1e-6))
            part = length / count
            for _ in range(count):
                for wheel, along, turning in shares:
                    wheels[wheel] = along * ways[index] + turning * z[2]
                if step(model, part, state, given, why) != 0:
                    raise core.refusal(why)
            found[index + 1] = _pose(state)
        cos, sin = np.cos(found[:, 2]), np.sin(found[:, 2])
        found[:, 0] -= cos * centre.real - sin * centre.imag
        found[:, 1] -= sin * centre.real + cos * centre.imag
        found[:, :2] -= found[0, :2].copy()
        return found

    def _shares(self, held: list[int]) -> list[tuple[int, float, float]]:
        """Of each held wheel on the carriage: its speed per speed of the axle's middle, and per yaw rate."""
        middle, ahead = self.driven_point()
        found = []
        for index in held:
            wheel = self.scene.vehicle["wheel"][index]
            if wheel.get("body", CARRIAGE) == CARRIAGE:
                rolls = 1j * complex(math.cos(wheel["axle_rad"]), math.sin(wheel["axle_rad"])) * self._radii[index]
                off = complex(wheel["x_m"], wheel["y_m"]) - middle
                size = abs(rolls) ** 2
                found.append((index, (rolls.conjugate() * ahead).real / size,
                              (rolls.conjugate() * 1j * off).real / size))
        return found


def _even(time_s: np.ndarray, rotation: np.ndarray) -> np.ndarray:
    """Rotations without the jitter of lines and ticks, which would make wheels slip at each of them: their speed is
    straight between the middles of intervals."""
    taken = intervals(time_s)
    if len(taken) < 3:
        return rotation
    summed = np.vstack([np.zeros(rotation.shape[1]), np.cumsum(rotation, axis=0)])
    at, known = time_s[taken], summed[taken]
    speeds, middles = np.diff(known, axis=0) / np.diff(at)[:, None], 0.5 * (at[1:] + at[:-1])
    mine = 0.5 * (time_s[1:] + time_s[:-1])
    found = np.column_stack([np.interp(mine, middles, column) for column in speeds.T]) * np.diff(time_s)[:, None]
    total = found.sum(axis=0)
    return found + (summed[-1] - total) * (np.diff(time_s) / (time_s[-1] - time_s[0]))[:, None]


def held_table(scene: Scene, names: tuple[str, ...], held: list[int]) -> dict[str, Any]:
    """The vehicle whose hinges of these names are prescribed, and whose wheels are held at speeds that are written."""
    table = copy.deepcopy({key: value for key, value in scene.vehicle.items() if key not in ("motor", "drive")})
    table["motor_gain_Nm_per_V"] = table["motor_damping_Nms"] = 0.0
    unknown = {*hinge_keys(scene.core())} - {"com_z_m", "hitch"}
    mass = table["mass_kg"]
    for body, hinge in zip(table["body"], scene.hinges, strict=True):
        if hinge.name in names:
            body["hinge"] = "prescribed"
        elif hinge.kind in STEERED:
            body["hinge"] = "prescribed"  # which nobody turns: it stays
        if body["hinge"] == "prescribed":
            for key in unknown:
                body.pop(key, None)
            body["gain_Nm_per_V"] = body["damping_Nms"] = 0.0
            body["mass_kg"] = body["mass_kg"] or LIGHT * mass
            body["yaw_inertia_kgm2"] = body["yaw_inertia_kgm2"] or LIGHT * mass * 0.01
    usual = table["wheel_inertia_kgm2"]
    for index, wheel in enumerate(table["wheel"]):
        own = wheel.get("inertia_kgm2", usual)
        for key in ("inertia_kgm2", "motor_gain_Nm_per_V", "motor_damping_Nms", "motor_circuit", "driven"):
            wheel.pop(key, None)
        radius = wheel.get("radius_m", table["wheel_radius_m"])
        wheel["inertia_kgm2"] = HOLDING * mass * radius**2 if index in held else own
    return table


def _pose(state: Any) -> tuple[float, float, float]:
    heading = state.heading
    turns = heading.turns + heading.fraction / TURN
    return state.x_m.value + state.x_m.rest, state.y_m.value + state.y_m.rest, 2.0 * math.pi * turns
