"""Runs scenes of vehicles with hinges on ground with friction, and keeps their outputs.

Commands are those of ideal ground (laconic.simulation.steering), held over each step. A prescribed hinge, also a
coordinated one without a servo, gets rates; servos and loops get angles or rates as their target.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from laconic.base.progress import Advance
from laconic.core.articulated_input import input_slots
from laconic.core.grip import ROLLED, losing_wheels
from laconic.core.recording import Structs
from laconic.core.slipping import (
    OUTPUTS,
    TARGET,
    SlippingOutputs,
    SlippingPlant,
    SlippingVehicle,
    SlipWatch,
    tree_row_length,
)
from laconic.core.spelling import wrapped
from laconic.errors import Refused
from laconic.scene import Scene
from laconic.scene.hinge_signals import ANGLE, BOOK, CURVATURE, OF_SUPPLY, TWIST
from laconic.scene.inputs import InputsOnGrid
from laconic.simulation.kept_rows import ROOM, KeptRows, parts_of, refusal_of_run
from laconic.simulation.loads import Loads
from laconic.simulation.steering import Commands

CHUNK = 2048  # steps whose inputs are made ready at once
LIFTED = 2  # of a contact_state
MIDDLE, END = 1, 2  # of the samples of a step: start, middle, end
USUAL = ("x_m", "y_m", "heading_rad", "velocity_body_m_per_s", "yaw_rate_rad_per_s", "hinge_angle_rad",
         "hinge_rate_rad_per_s", "hinge_reaction_Nm", "wheel_speed_rad_per_s", "wheel_angle_rad", "slip_along_m_per_s",
         "slip_across_m_per_s", "contact_state", "wheel_load_N", "energy_J", *BOOK)
OF_MOTION = ("wheel_speed_rad_per_s", "wheel_angle_rad", "hinge_angle_rad", "hinge_rate_rad_per_s", "body_x_m",
             "body_y_m", "body_heading_rad")
OF_OUTPUTS = {"wheel_torque_Nm": "wheel_torque_Nm", "wheel_reaction_N": "along_N", "wheel_lateral_N": "lateral_N",
              "scrub_torque_Nm": "scrub_Nm", "wheel_load_N": "normal_N", "hinge_reaction_Nm": "hinge_torque_Nm",
              "hinge_friction_Nm": "friction_torque_Nm", "hinge_stop_Nm": "stop_torque_Nm",
              **{name: name for name in ("slip_along_m_per_s", "slip_across_m_per_s", "contact_state", "drive_limit",
                                         "motor_current_A")}}
BEHIND_WHEELS = {"hinge_current_A": "motor_current_A", "hinge_drive_limit": "drive_limit", "support_load_N": "normal_N"}
"""Outputs whose numbers follow those of the wheels in one array."""


class SlippingCommands(Commands):
    """The rows of inputs of a run on ground with friction: (steps, numbers)."""

    vehicle: SlippingVehicle

    def __post_init__(self) -> None:
        super().__post_init__()
        self._winding: dict[str, tuple[float, float]] = {}  # direction of each coordinated hinge, and whole turns
        self._coordinated = [hinge for hinge in self.scene.hinges if hinge.kind == "coordinated"]
        self._steering = self._steering_of() if self._coordinated else None
        names = self.vehicle.names
        rates = input_slots(self.vehicle.core, names, "steering_rate_rad_per_s")
        self._rates = dict(zip(names, rates, strict=True))
        self._targets = {name: self.vehicle.slot(f"{TARGET}[{name}]") for name in names}

    def start_angles(self) -> list[float]:
        """Angles of the hinges at the start: coordinated ones point as commanded."""
        if self._steering is not None:
            row = self.first_row()
            slot = self.vehicle.slot(TWIST)
            twist = row[slot : slot + 3]
            if not np.any(twist):
                raise self._no_direction(0)
            self._take_angles(self._steering, twist)
            for hinge in self._coordinated:
                raw = wrapped(self._angle[hinge.name])
                self._winding[hinge.name] = raw, float(np.rint((self._angle[hinge.name] - raw) / (2.0 * math.pi)))
        return [self._angle[hinge.name] for hinge in self.scene.hinges]

    def _no_direction(self, step: int) -> Refused:
        return Refused("twist zero", "twist", 0, f"{self.scene.path}: at t = {step * self.inputs.step_s:g} s: steering_"
                       "twist: is 0, which gives coordinated wheels no direction; stop by voltages, and keep the twist")

    def held_rows(self, first: int, count: int) -> np.ndarray:
        """The inputs of steps `first` …, held over each. Fewer where a limit ends the run: then `refused` is set."""
        before = dict(self._angle)
        ideal = self.rows(first, count)
        sampled = self.inputs.samples(first, count)
        held = np.zeros((len(ideal), tree_row_length(self.vehicle.core)))
        for signal, at in self._numbers.items():
            if signal.partition("[")[0] not in (ANGLE, CURVATURE, TWIST):
                held[:, self.vehicle.slot(signal)] = sampled[: len(ideal), MIDDLE, at]
        for hinge in self.scene.hinges:
            rate = self._rates[hinge.name]
            if hinge.kind == "prescribed":
                held[:, rate] = ideal[:, :, rate].mean(axis=1)
            elif hinge.follows == "angle" and hinge.kind != "coordinated":
                column = self._numbers.get(f"{ANGLE}[{hinge.name}]")
                targets = np.zeros(len(ideal)) if column is None else sampled[: len(ideal), END, column]
                reached = np.zeros(len(ideal))
                end = self._until(partial(self._go_to, hinge, np.zeros_like(ideal), targets, first, reached),
                                  first + len(ideal))
                if self.refused:
                    ideal, held, reached = (each[: end - first] for each in (ideal, held, reached))
                held[:, self._targets[hinge.name]] = reached
        if self._steering is not None:
            self._coordinate(held, ideal[:, 1], before, first)
        return held

    def _coordinate(self, held: np.ndarray, ideal: np.ndarray, before: dict[str, float], first: int) -> None:
        """Angles and rates of coordinated hinges along the twists at the ends of steps."""
        assert self._steering is not None
        slot, h = self.vehicle.slot(TWIST), self.inputs.step_s
        twists = ideal[:, slot : slot + 3]
        if len(none := np.flatnonzero(~twists.any(axis=1))):
            raise self._no_direction(first + int(none[0]))
        directions = self._steering.angles(twists)
        for column, hinge in enumerate(self._coordinated):
            raw, turns = self._winding[hinge.name]
            changes = np.diff(directions[:, column], prepend=raw)
            winding = turns - np.cumsum(np.where(np.abs(changes) > math.pi, np.sign(changes), 0.0))
            path = directions[:, column] + 2.0 * math.pi * winding
            if hinge.follows:
                held[:, self._targets[hinge.name]] = path
            else:
                held[:, self._rates[hinge.name]] = np.diff(path, prepend=before[hinge.name]) / h
            if len(path):
                self._winding[hinge.name] = (float(directions[-1, column]), float(winding[-1]))
                self._angle[hinge.name] = float(path[-1])


class SlippingRows(KeptRows):
    """The outputs of a run on ground with friction."""

    def __init__(self, scene: Scene, vehicle: SlippingVehicle, inputs: InputsOnGrid, kept: Sequence[str]):
        super().__init__(kept, [(at, hinge) for at, hinge in enumerate(scene.hinges)
                                if hinge.kind == "free" and hinge.form != "caster"], inputs,
                         tree_row_length(vehicle.core))
        self._vehicle, self._seen = vehicle, Structs(vehicle.core, OUTPUTS, ROOM)
        of_hinge = {hinge.name: at for at, hinge in enumerate(scene.hinges)}
        self._readers = [_reader(signal, of_hinge, vehicle, Loads(scene)) for signal in kept]
        self._of_commands = any(signal.partition("[")[0] in (ANGLE, CURVATURE, TWIST) for signal in kept)
        self.slipping: set[int] = set()  # numbers of the wheels that slipped in some step

    def take(self, plant: SlippingPlant, row: np.ndarray, tick: int) -> None:
        """The outputs at the start of a step, in which `row` acts; forces are those of the step before."""
        plant.see_outputs(self._seen.c + self._count)
        self._keep(row, tick)

    def _cut(self, count: int) -> np.ndarray:
        found, time_s = self._vehicle.outputs_of(self._seen.table[:count]), self._times(count)
        self._folds.take(found.motion.hinge_angle_rad, time_s)
        self.see_lifted(found.contact_state == LIFTED, time_s)
        given = self._inputs.starts(self._ticks[:count]) if self._of_commands else {}
        table = np.empty((count, len(self.kept)))
        for at, read in enumerate(self._readers):
            table[:, at] = read(found, self._given[:count], given)
        return table


Reader = Callable[[SlippingOutputs, np.ndarray, Mapping[str, np.ndarray]], Any]


def _reader(signal: str, of_hinge: dict[str, int], vehicle: SlippingVehicle, loads: Loads) -> Reader:
    """What reads one signal of many rows."""
    name, item = parts_of(signal, of_hinge)
    if name in OF_MOTION:
        return lambda found, rows, given: getattr(found.motion, name)[:, item]
    if name in OF_OUTPUTS:
        return lambda found, rows, given: getattr(found, OF_OUTPUTS[name])[:, item]
    if name in BEHIND_WHEELS:
        return lambda found, rows, given: getattr(found, BEHIND_WHEELS[name])[:, vehicle.wheel_count + item]
    if name == "velocity_body_m_per_s":
        return lambda found, rows, given: found.motion.velocity_m_per_s[:, item]
    if name in (*BOOK, *OF_SUPPLY):
        return lambda found, rows, given: getattr(found, name)
    if name == "heading_wrapped_rad":
        return lambda found, rows, given: wrapped(found.motion.heading_rad)
    if name in ("x_m", "y_m", "heading_rad", "yaw_rate_rad_per_s", "energy_J"):
        return lambda found, rows, given: getattr(found.motion, name)
    if name in ("origin_x_m", "origin_y_m"):
        return lambda found, rows, given: loads.origins_of(found.motion)[:, int(name == "origin_y_m")]
    if name in (ANGLE, CURVATURE, TWIST):
        return lambda found, rows, given: given.get(signal, 0.0)
    slot = vehicle.slot(signal)
    return lambda found, rows, given: rows[:, slot]


def slipping_start(scene: Scene, angles: Sequence[float]) -> dict[str, Any]:
    """The numbers of a scene's start, as SlippingVehicle.plant takes them."""
    start = scene.initial
    return {"velocity_m_per_s": start.velocity_body_m_per_s, "yaw_rate_rad_per_s": start.yaw_rate_rad_per_s,
            "x_m": start.x_m, "y_m": start.y_m, "heading_rad": start.heading_rad, "hinge_angle_rad": angles,
            "hinge_rate_rad_per_s": [hinge.start_rate_rad_per_s for hinge in scene.hinges],
            "wheel_speed_rad_per_s": start.wheel_speed_rad_per_s or None}


def start_slipping(scene: Scene, vehicle: SlippingVehicle, angles: Sequence[float]) -> SlippingPlant:
    """The vehicle of a scene at its start."""
    try:
        return vehicle.plant(scene.run.method, scene.run.step_s, **slipping_start(scene, angles))
    except Refused as refused:
        raise scene.refusal_in_file(refused, "at t = 0 s") from None


@dataclass
class SlippingRun:
    """What a run of a scene with hinges on ground with friction leaves."""

    plant: SlippingPlant
    rows: SlippingRows
    commands: SlippingCommands
    seconds: float
    refused: Refused | None
    wheel_loss_J: tuple[float, ...]  # what slip and scrub took at each wheel


def run_slipping(scene: Scene, kept: Sequence[str], every: int, moved: Advance) -> SlippingRun:
    """Steps a scene to its end, or to a step that is refused, with a row before each `every` steps and at the end."""
    vehicle, inputs = scene.slipping_vehicle(scene.core()), scene.inputs_on_grid()
    commands = SlippingCommands(scene, vehicle, inputs)
    plant = start_slipping(scene, vehicle, commands.start_angles())
    rows, watch, refused = SlippingRows(scene, vehicle, inputs, kept), SlipWatch(plant), None
    last, began = np.zeros(tree_row_length(vehicle.core)), time.perf_counter()
    try:
        for first in range(0, inputs.steps, CHUNK):
            table = commands.held_rows(first, min(CHUNK, inputs.steps - first))
            last = table[-1] if len(table) else last
            begin = first
            while begin < first + len(table):
                if begin % every == 0:
                    rows.take(plant, table[begin - first], begin)
                until = min(first + len(table), (begin // every + 1) * every)
                plant.follow(table[begin - first : until - first], watch)
                begin = until
            moved(len(table))
            if commands.refused:
                raise commands.refused
    except Refused as why:
        refused = refusal_of_run(scene, why, f"at t = {plant.steps * scene.run.step_s:g} s")
        if not plant.steps:
            raise refused from None
    if refused is None or len(rows) <= -(-plant.steps // every):
        rows.take(plant, last, plant.steps)
    rows.finish()
    body = scene.vehicle
    rows.slipping = set(losing_wheels(watch.slipped.tolist(), watch.loss_J.tolist(),
                                      ROLLED * body["mass_kg"] * body["wheel_radius_m"]))
    return SlippingRun(plant, rows, commands, time.perf_counter() - began, refused, tuple(watch.loss_J.tolist()))
