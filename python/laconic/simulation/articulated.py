"""Runs scenes of vehicles with hinges, and keeps their outputs."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from contextlib import suppress
from typing import Any

import numpy as np

from laconic.base.progress import Advance
from laconic.core.articulated import ArticulatedMotion, ArticulatedPlant, ArticulatedReactions, ArticulatedVehicle
from laconic.core.spelling import wrapped
from laconic.errors import BadInput, Refused
from laconic.scene import Scene
from laconic.scene.hinge_signals import (
    ANGLE,
    CURVATURE,
    input_signals,
    output_signals_of,
    read_hinge_signals,
)
from laconic.scene.hinges import Hinge
from laconic.scene.inputs import InputsOnGrid
from laconic.scene.table import Table
from laconic.simulation.loads import Loads
from laconic.simulation.slipping import USUAL as USUAL_SLIPPING
from laconic.simulation.steering import Commands

CHUNK = 2048             # steps whose inputs are made ready at once
ALLOWED = 1e-9           # of the size of a start: what a projection may change of it by rounding
IN_SINGLE = 1e-4
USUAL = ("x_m", "y_m", "heading_rad", "velocity_body_m_per_s", "yaw_rate_rad_per_s", "hinge_angle_rad",
         "hinge_rate_rad_per_s", "wheel_speed_rad_per_s", "wheel_angle_rad", "energy_J")
OF_MOTION = {"wheel_speed_rad_per_s", "wheel_angle_rad", "hinge_angle_rad", "hinge_rate_rad_per_s", "body_x_m",
             "body_y_m", "body_heading_rad"}
OF_REACTIONS = {"wheel_torque_Nm": "wheel_torque_Nm", "wheel_reaction_N": "along_N", "wheel_lateral_N": "lateral_N",
                "hinge_reaction_Nm": "hinge_torque_Nm"}


def usual_signals_with_hinges(scene: Scene) -> tuple[str, ...]:
    """Pose, velocities, hinges, wheels and energy."""
    known = output_signals_of(scene.vehicle, scene.hinges)
    return tuple(signal for name in (USUAL_SLIPPING if scene.slips_on_hinges else USUAL) for signal in known[name])


def input_signals_with_hinges(scene: Scene) -> tuple[str, ...]:
    """Every element of the inputs that the scene uses."""
    used = {each.signal.partition("[")[0] for each in scene.inputs}
    return tuple(signal for name, signals in input_signals(scene.vehicle, scene.hinges).items() if name in used
                 for signal in signals)


def kept_signals_with_hinges(scene: Scene, given: Sequence[str]) -> tuple[str, ...]:
    """Those of a run: the given outputs and inputs, else the scene's, else the usual ones. Names that are both, as
    none is, would be outputs."""
    known = input_signals(scene.vehicle, scene.hinges) | output_signals_of(scene.vehicle, scene.hinges)
    kept = read_hinge_signals(Table(scene.path, "", {"signals": list(given)}), known)
    return kept or scene.outputs.signals or usual_signals_with_hinges(scene)


class Rows:
    """The outputs of a run, row by row."""

    def __init__(self, scene: Scene, vehicle: ArticulatedVehicle, inputs: InputsOnGrid, kept: Sequence[str]):
        self.kept, self._inputs = kept, inputs
        self._loads, self._rows = Loads(scene), list[list[float]]()
        names = {signal.partition("[")[0] for signal in kept}
        self._of_ground = bool(names & {*OF_REACTIONS, "hinge_force_along_N", "hinge_force_across_N"})
        self._of_load = "no_slip_margin_N" in names or bool(scene.vehicle["friction_coefficient"])
        self._accelerates = "acceleration_body_m_per_s2" in names
        self.least_margin: tuple[float, float] | None = None  # N, s
        of_hinge = {hinge.name: at for at, hinge in enumerate(scene.hinges)}
        self._parts = [(signal, *_split(signal, of_hinge)) for signal in kept]
        self._follows_commands = bool(names & {ANGLE, CURVATURE})
        acting = input_signals(scene.vehicle, scene.hinges).keys() - {ANGLE, CURVATURE}
        self._slots = {signal: vehicle.slot(signal) for signal, name, _ in self._parts if name in acting}

    def __len__(self) -> int:
        return len(self._rows)

    def take(self, plant: ArticulatedPlant, row: np.ndarray, tick: int) -> None:
        """The outputs at the start of a step, in which `row` acts."""
        motion, given = plant.motion(), self._inputs.held_at(tick) if self._follows_commands else {}
        reactions = None
        if self._of_ground or self._of_load:
            loads = self._loads.of(motion) if self._of_load else None
            reactions = plant.reactions(row, loads)
        if self._of_load and reactions and (self.least_margin is None
                                            or reactions.no_slip_margin_N < self.least_margin[0]):
            self.least_margin = reactions.no_slip_margin_N, tick * self._inputs.step_s
        acceleration = plant.acceleration(row) if self._accelerates else np.zeros(2)
        self._rows.append([self._value(each, motion, reactions, acceleration, row, given) for each in self._parts])

    def _value(self, part: tuple[str, str, int], motion: ArticulatedMotion, reactions: ArticulatedReactions | None,
               acceleration: np.ndarray, row: np.ndarray, given: dict[str, float]) -> float:
        signal, name, item = part
        if name in OF_MOTION:
            return float(getattr(motion, name)[item])
        if name == "velocity_body_m_per_s":
            return float(motion.velocity_m_per_s[item])
        if name == "acceleration_body_m_per_s2":
            return float(acceleration[item])
        if reactions and name in OF_REACTIONS:
            return float(getattr(reactions, OF_REACTIONS[name])[item])
        if reactions and name in ("hinge_force_along_N", "hinge_force_across_N"):
            return float(reactions.hinge_force_N[item, int(name == "hinge_force_across_N")])
        if reactions and name == "no_slip_margin_N":
            return reactions.no_slip_margin_N
        if name in ("origin_x_m", "origin_y_m"):
            return self._loads.origin_of(motion)[int(name == "origin_y_m")]
        if name == "heading_wrapped_rad":
            return wrapped(motion.heading_rad)
        if name in ("x_m", "y_m", "heading_rad", "yaw_rate_rad_per_s", "energy_J"):
            return float(getattr(motion, name))
        if name in (ANGLE, CURVATURE):
            return given.get(signal, 0.0)
        return float(row[self._slots[signal]])

    def columns(self) -> dict[str, np.ndarray]:
        """By signal name."""
        table = np.array(self._rows, float).reshape(len(self._rows), len(self.kept))
        return dict(zip(self.kept, table.T.copy(), strict=True))


def _split(signal: str, of_hinge: dict[str, int]) -> tuple[str, int]:
    name, _, inside = signal.partition("[")
    item = inside.removesuffix("]")
    return name, of_hinge[item] if item in of_hinge else int(item) - 1 if item else 0


def start_plant(scene: Scene, vehicle: ArticulatedVehicle, row: np.ndarray) -> ArticulatedPlant:
    """The vehicle of a scene at its start; Refused for a motion that its wheels do not allow."""
    start = scene.initial
    angles = [hinge.start_angle_rad for hinge in scene.hinges]
    rates = [hinge.start_rate_rad_per_s for hinge in scene.hinges]
    given: dict[str, Any] = {"velocity_m_per_s": start.velocity_body_m_per_s,
                             "yaw_rate_rad_per_s": start.yaw_rate_rad_per_s, "x_m": start.x_m, "y_m": start.y_m,
                             "heading_rad": start.heading_rad, "hinge_angle_rad": angles, "inputs": row}
    try:
        rates = rolling_rates(vehicle, given["velocity_m_per_s"], start.yaw_rate_rad_per_s, angles, rates)
        plant = vehicle.plant(scene.run.method, scene.run.step_s, hinge_rate_rad_per_s=rates, **given)
    except Refused as refused:
        raise scene.refusal_in_file(refused, "at t = 0 s") from None
    size = max(map(abs, (*start.velocity_body_m_per_s, start.yaw_rate_rad_per_s, *rates)))
    if plant.changed_m_per_s > (ALLOWED if vehicle.core.real == "double" else IN_SINGLE) * max(1.0, size):
        near = plant.motion()
        x, y = near.velocity_m_per_s
        raise BadInput(f"{scene.path}: initial.velocity_body_m_per_s: this start makes a fixed wheel slide; the "
                       f"nearest motion that all wheels allow is [{x:.6g}, {y:.6g}] m/s with a yaw rate of "
                       f"{near.yaw_rate_rad_per_s:.6g} rad/s")
    return plant


def rolling_rates(vehicle: ArticulatedVehicle, velocity: Sequence[float], yaw_rate: float, angles: Sequence[float],
                  rates: Sequence[float]) -> list[float]:
    """Rates of the hinges at a start: as the wheels behind them roll, else as they are given."""
    v, c = complex(*velocity), vehicle.core.lib
    twists, found = [(v, yaw_rate)], list[float]()
    for link, angle, given in zip(vehicle.model.link, angles, rates, strict=False):
        above, turn = twists[link.parent]
        v = (above + 1j * turn * complex(link.hinge.x, link.hinge.y)) * complex(math.cos(angle), -math.sin(angle))
        if link.motion == c.LACONIC_MOTION_FOLLOWING:
            omega = -(link.axle_per_lever.x * v.real + link.axle_per_lever.y * v.imag)
        else:
            omega = turn + given
        found.append(omega - turn)
        twists.append((v, omega))
    return found


def run_with_hinges(scene: Scene, kept: Sequence[str], every: int, moved: Advance
                    ) -> tuple[ArticulatedPlant, Rows, Commands, float, Refused | None]:
    """Steps a scene to its end, or to a step that is refused, with a row before each `every` steps and at the end."""
    core, inputs = scene.core(), scene.inputs_on_grid()
    vehicle = scene.articulated_vehicle(core)
    commands = Commands(scene, vehicle, inputs)
    plant = start_plant(scene, vehicle, commands.first_row())
    rows, refused, last = Rows(scene, vehicle, inputs, kept), None, None
    began = time.perf_counter()
    watched = [(at, hinge) for at, hinge in enumerate(scene.hinges) if hinge.has_stops and not hinge.is_commanded]
    try:
        for first in range(0, inputs.steps, CHUNK):
            count = min(CHUNK, inputs.steps - first)
            table = commands.rows(first, count)
            last, count = table[-1, 1] if len(table) else last, len(table)
            for at in _stretches(first, count, every):
                if at % every == 0:
                    rows.take(plant, table[at - first, 0], at)
                until = min(first + count, (at // every + 1) * every)
                _follow(scene, plant, table[at - first : until - first], watched)
            moved(count)
            if commands.refused:
                raise commands.refused
        rows.take(plant, commands.row_at(inputs.steps, last), inputs.steps)
    except Refused as why:
        if not plant.steps:
            raise why if str(scene.path) in why.message else scene.refusal_in_file(why, "at t = 0 s") from None
        at_s = f"at t = {plant.steps * scene.run.step_s:g} s"
        refused = why if str(scene.path) in why.message else scene.refusal_in_file(why, at_s)
        if len(rows) <= -(-plant.steps // every):
            with suppress(Refused):  # of reactions at a posture that has none
                rows.take(plant, commands.row_at(plant.steps, None), plant.steps)
    return plant, rows, commands, time.perf_counter() - began, refused


def _stretches(first: int, count: int, every: int) -> list[int]:
    """Where stretches of steps without a row in between begin."""
    inside = range(-(-first // every) * every, first + count, every)
    return sorted({first, *inside})


def _follow(scene: Scene, plant: ArticulatedPlant, table: np.ndarray, watched: Sequence[tuple[int, Hinge]]) -> None:
    """Steps along inputs; a free or motor hinge that comes to its stop ends the run."""
    if not watched:
        plant.follow(table)
        return
    for each in table:
        before = plant.save()
        plant.follow(each[None])
        angles = plant.motion().hinge_angle_rad
        for at, hinge in watched:
            if not hinge.low_rad <= angles[at] <= hinge.high_rad:
                plant.restore(before, plant.steps - 1)
                limit = hinge.low_rad if angles[at] < hinge.low_rad else hinge.high_rad
                raise Refused("hinge at stop", "hinge_angle_rad", at + 1, f"{hinge.place} ({hinge.name}): comes to its "
                              f"stop at {limit:.6g} rad, and the model has no stops that push back; steer or start so "
                              "that it stays between them, or take the stop out", value=float(angles[at]), limit=limit)
