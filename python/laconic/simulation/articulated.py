"""Runs scenes of vehicles with hinges, and keeps their outputs."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np

from laconic.base.progress import Advance
from laconic.core.articulated import (
    MOTION,
    REACTIONS,
    ArticulatedMotion,
    ArticulatedPlant,
    ArticulatedReactions,
    ArticulatedVehicle,
)
from laconic.core.articulated_input import row_length
from laconic.core.recording import Structs
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
from laconic.scene.standing import NO_LOAD
from laconic.scene.table import Table
from laconic.simulation.kept_rows import ROOM, Blocks, KeptRows, parts_of, refusal_of_run
from laconic.simulation.loads import Loads
from laconic.simulation.slipping import USUAL as USUAL_SLIPPING
from laconic.simulation.steering import Commands

CHUNK = 2048             # steps whose inputs are made ready at once
ALLOWED = 1e-9           # of the size of a start: what a projection may change of it by rounding
IN_SINGLE = 1e-4
SAME_RATE = 1e-6         # of a rate at the start that the wheels set, too
PARTS = 3                # of a step, for the estimate of its error
OF_DISTANCE = 2.0        # what a method of order 2 makes of a distance of parts of two thirds is 1.8
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


@dataclass(frozen=True)
class HingeErrorSizes:
    """Sizes of an error of the state; of hinges and wheels that of the one farthest off."""

    velocity_m_per_s: float
    yaw_rate_rad_per_s: float
    hinge_rate_rad_per_s: float
    place_m: float
    heading_rad: float
    hinge_angle_rad: float
    wheel_angle_rad: float


HINGE_ERRORS = tuple(HingeErrorSizes.__dataclass_fields__)


@dataclass(frozen=True)
class HingeErrors:
    """What is known of the error of a run with hinges."""

    now: HingeErrorSizes
    largest: HingeErrorSizes  # of the rows of the run
    unknown: int              # steps whose parts were refused: then the errors are infinite


class Parts(Blocks):
    """The same run in steps of a third, whose distance from it estimates its error.

    A third and no half, since `auto` divides steps by powers of two: halves could be the same steps again. What is off
    by a method of order 2 or more is at most twice the distance. Inputs are those of the whole steps, divided.
    """

    def __init__(self, plant: ArticulatedPlant):
        super().__init__(len(HINGE_ERRORS))
        self._plant, self._whole = plant.twin(plant.step_s / PARTS), plant
        self._motions, self._of_whole = (Structs(plant.core, MOTION, ROOM) for _ in range(2))
        self._unknown, self._is_unknown = 0, np.zeros(ROOM, bool)

    def follow(self, table: np.ndarray) -> None:
        """The parts of steps that the run itself takes along these inputs."""
        shares = np.arange(PARTS + 1) / PARTS
        points = table[:, :1] + shares[None, :, None] * (table[:, 1:] - table[:, :1])
        points[:, -1] = table[:, 1]
        pairs = np.stack([points[:, :-1], points[:, 1:]], axis=2)
        try:
            if not self._unknown:
                self._plant.follow(pairs.reshape(-1, 2, table.shape[2]))
                return
        except Refused:
            pass
        self._unknown += len(table)

    def take(self) -> None:
        """A row of what is known at this moment."""
        self._plant.see_motion(self._motions.c + self._count)
        self._whole.see_motion(self._of_whole.c + self._count)
        self._is_unknown[self._count] = bool(self._unknown)
        self._count_row()

    def _cut(self, count: int) -> np.ndarray:
        a, b = (self._plant.vehicle.motion_of(each.table[:count]) for each in (self._of_whole, self._motions))
        ways = np.subtract([b.x_m, b.y_m], [a.x_m, a.y_m]).tolist()
        found = {"velocity_m_per_s": np.hypot(*(a.velocity_m_per_s - b.velocity_m_per_s).T),
                 "place_m": np.array([*map(math.hypot, *ways)])}
        found |= {name: _farthest(np.subtract(getattr(a, name), getattr(b, name)))
                  for name in HINGE_ERRORS if name not in found}
        table = OF_DISTANCE * np.stack([found[name] for name in HINGE_ERRORS], axis=1, dtype=float)
        table[self._is_unknown[:count]] = math.inf
        return table

    def columns(self) -> dict[str, np.ndarray]:
        """By name of a further column of outputs."""
        return {f"estimated_error_{name}": column
                for name, column in zip(HINGE_ERRORS, self.table().T.copy(), strict=True)}

    def read(self) -> HingeErrors:
        """The errors of the last row, and the largest of all rows."""
        table = self.table()
        return HingeErrors(HingeErrorSizes(*table[-1].tolist()), HingeErrorSizes(*table.max(axis=0).tolist()),
                           self._unknown)


def _farthest(differences: np.ndarray) -> np.ndarray:
    """The largest size in each row."""
    return np.abs(differences).reshape(len(differences), -1).max(axis=1, initial=0.0)


def trailers_of(scene: Scene, vehicle: ArticulatedVehicle) -> list[tuple[int, Hinge]]:
    """Hinges whose bodies are drawn and that are no casters, by their numbers."""
    follows = vehicle.core.lib.LACONIC_MOTION_FOLLOWING
    return [(at, hinge) for at, (hinge, link) in enumerate(zip(scene.hinges, vehicle.model.link, strict=False))
            if hinge.form != "caster" and link.motion == follows]


class Rows(KeptRows):
    """The outputs of a run on ideal ground."""

    def __init__(self, scene: Scene, vehicle: ArticulatedVehicle, inputs: InputsOnGrid, kept: Sequence[str]):
        core, self._vehicle, self._loads = vehicle.core, vehicle, Loads(scene)
        super().__init__(kept, trailers_of(scene, vehicle), inputs, row_length(core))
        names = {signal.partition("[")[0] for signal in kept}
        self._friction = float(scene.vehicle["friction_coefficient"])
        self._of_load = scene.wheel_count > 0 and ("no_slip_margin_N" in names or bool(self._friction))
        self._accelerates = "acceleration_body_m_per_s2" in names or bool(self._of_load and self._loads.height_m)
        of_ground = bool(names & {*OF_REACTIONS, "hinge_force_along_N", "hinge_force_across_N"})
        self._motions, self._accelerations = Structs(core, MOTION, ROOM), np.zeros((ROOM, 2))
        self._reactions = Structs(core, REACTIONS, ROOM) if of_ground or self._of_load else None
        self.least_margin: tuple[float, float, int] | None = None  # N, s, number of the wheel
        self.slipping: set[int] = set()  # numbers of the wheels that would slip in some row
        of_hinge = {hinge.name: at for at, hinge in enumerate(scene.hinges)}
        self._parts = [(signal, *parts_of(signal, of_hinge)) for signal in kept]
        self._follows_commands = bool(names & {ANGLE, CURVATURE})
        acting = input_signals(scene.vehicle, scene.hinges).keys() - {ANGLE, CURVATURE}
        self._slots = {signal: vehicle.slot(signal) for signal, name, _ in self._parts if name in acting}

    def take(self, plant: ArticulatedPlant, row: np.ndarray, tick: int) -> None:
        """The outputs at the start of a step, in which `row` acts."""
        plant.see_motion(self._motions.c + self._count)
        if self._accelerates:
            self._accelerations[self._count] = plant.acceleration(row)
        if self._reactions:
            plant.see_reactions(self._reactions.c + self._count, row)
        self._keep(row, tick)

    def _cut(self, count: int) -> np.ndarray:
        motion, time_s = self._vehicle.motion_of(self._motions.table[:count]), self._times(count)
        self._folds.take(motion.hinge_angle_rad, time_s)
        reactions, margin_N = None, np.zeros(count)
        if self._reactions:
            reactions = self._vehicle.reactions_of(self._reactions.table[:count])
        if reactions and self._of_load:
            loads = self._loads.of(motion, self._accelerations[:count])
            self.see_lifted(loads < -NO_LOAD * loads.sum(axis=1, keepdims=True), time_s)
            self._judge(self._friction * loads, reactions, time_s)
            margin_N = self._margin_of(loads, reactions)
        given = self._inputs.starts(self._ticks[:count]) if self._follows_commands else {}
        table = np.empty((count, len(self.kept)))
        for at, part in enumerate(self._parts):
            table[:, at] = self._column(part, motion, reactions, margin_N, given)
        return table

    def _judge(self, available_N: np.ndarray, reactions: ArticulatedReactions, time_s: np.ndarray) -> None:
        """Notes wheels that would slip, and the least margin. A wheel that lifts slips only if it needs a reaction."""
        needed_N = np.hypot(reactions.along_N, reactions.lateral_N)
        rounding_N = NO_LOAD * np.abs(available_N).sum(axis=1, keepdims=True)
        margins = available_N - needed_N
        margins[(available_N < 0.0) & (needed_N <= rounding_N)] = 0.0
        if self._friction:
            self.slipping |= set((np.flatnonzero((margins < -rounding_N).any(axis=0)) + 1).tolist())
        first = int(np.argmin(margins.min(axis=1)))
        if self.least_margin is None or margins[first].min() < self.least_margin[0]:
            self.least_margin = (float(margins[first].min()), float(time_s[first]), int(np.argmin(margins[first])) + 1)

    def _margin_of(self, loads: np.ndarray, reactions: ArticulatedReactions) -> np.ndarray:
        """The no_slip_margin_N of each row, with the bits that the core gives where it knows the loads."""
        real = self._vehicle.core.dtype.type
        needed_N = np.sqrt(reactions.along_N * reactions.along_N + reactions.lateral_N * reactions.lateral_N)
        return (real(self._friction) * loads.astype(real) - needed_N).min(axis=1).astype(float)

    def _column(self, part: tuple[str, str, int], motion: ArticulatedMotion, reactions: ArticulatedReactions | None,
                margin_N: np.ndarray, given: Mapping[str, np.ndarray]) -> Any:
        """One signal of the last rows."""
        signal, name, item = part
        count = len(motion.velocity_m_per_s)
        if name in OF_MOTION:
            return getattr(motion, name)[:, item]
        if name == "velocity_body_m_per_s":
            return motion.velocity_m_per_s[:, item]
        if name == "acceleration_body_m_per_s2":
            return self._accelerations[:count, item]
        if reactions and name in OF_REACTIONS:
            return getattr(reactions, OF_REACTIONS[name])[:, item]
        if reactions and name in ("hinge_force_along_N", "hinge_force_across_N"):
            return reactions.hinge_force_N[:, item, int(name == "hinge_force_across_N")]
        if name == "no_slip_margin_N":
            return margin_N
        if name in ("origin_x_m", "origin_y_m"):
            return self._loads.origins_of(motion)[:, int(name == "origin_y_m")]
        if name == "heading_wrapped_rad":
            return wrapped(motion.heading_rad)
        if name in ("x_m", "y_m", "heading_rad", "yaw_rate_rad_per_s", "energy_J"):
            return getattr(motion, name)
        if name in (ANGLE, CURVATURE):
            return given.get(signal, 0.0)
        return self._given[:count, self._slots[signal]]


def given_start(scene: Scene, vehicle: ArticulatedVehicle) -> dict[str, Any]:
    """The numbers of a scene's start, as ArticulatedVehicle.plant takes them."""
    start = scene.initial
    angles = [hinge.start_angle_rad for hinge in scene.hinges]
    given = [hinge.start_rate_rad_per_s for hinge in scene.hinges]
    rates = rolling_rates(vehicle, start.velocity_body_m_per_s, start.yaw_rate_rad_per_s, angles, given)
    for hinge, own, rolling in zip(scene.hinges, given, rates, strict=True):
        if own and abs(own - rolling) > SAME_RATE * max(1.0, abs(own)):
            raise BadInput(f"{scene.path}: {hinge.place}.start_rate_rad_per_s: {own:g} has no effect, as the wheels "
                           f"behind the hinge roll and set its rate, here {round(rolling, 9) + 0.0:.6g} rad/s; take "
                           "it out")
    return {"velocity_m_per_s": start.velocity_body_m_per_s, "yaw_rate_rad_per_s": start.yaw_rate_rad_per_s,
            "x_m": start.x_m, "y_m": start.y_m, "heading_rad": start.heading_rad, "hinge_angle_rad": angles,
            "hinge_rate_rad_per_s": rates}


def start_plant(scene: Scene, vehicle: ArticulatedVehicle, row: np.ndarray) -> ArticulatedPlant:
    """The vehicle of a scene at its start; Refused for a motion that its wheels do not allow."""
    start, given = scene.initial, given_start(scene, vehicle)
    try:
        plant = vehicle.plant(scene.run.method, scene.run.step_s, inputs=row, **given)
    except Refused as refused:
        raise scene.refusal_in_file(refused, "at t = 0 s") from None
    rates = given["hinge_rate_rad_per_s"]
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


@dataclass
class HingedRun:
    """What a run of a scene with hinges leaves."""

    plant: ArticulatedPlant
    rows: Rows
    commands: Commands
    parts: Parts | None  # where the error was estimated
    seconds: float = 0.0
    refused: Refused | None = None

    def take(self, row: np.ndarray, tick: int) -> None:
        """A row of outputs, and of errors."""
        self.rows.take(self.plant, row, tick)
        if self.parts:
            self.parts.take()


def run_with_hinges(scene: Scene, kept: Sequence[str], every: int, moved: Advance, estimated: bool = False
                    ) -> HingedRun:
    """Steps a scene to its end, or to a step that is refused, with a row before each `every` steps and at the end."""
    core, inputs = scene.core(), scene.inputs_on_grid()
    vehicle = scene.articulated_vehicle(core)
    commands = Commands(scene, vehicle, inputs)
    plant = start_plant(scene, vehicle, commands.first_row())
    parts = Parts(plant) if estimated else None
    run, last = HingedRun(plant, Rows(scene, vehicle, inputs, kept), commands, parts), None
    began = time.perf_counter()
    watched = watched_hinges(scene)
    try:
        for first in range(0, inputs.steps, CHUNK):
            count = min(CHUNK, inputs.steps - first)
            table = commands.rows(first, count)
            last, count = table[-1, 1] if len(table) else last, len(table)
            _follow(run, table, every, watched)
            moved(count)
            if commands.refused:
                raise commands.refused
        run.take(commands.row_at(inputs.steps, last), inputs.steps)
    except Refused as why:
        if not plant.steps:
            raise refusal_of_run(scene, why, "at t = 0 s") from None
        run.refused = refusal_of_run(scene, why, f"at t = {plant.steps * scene.run.step_s:g} s")
        if len(run.rows) <= -(-plant.steps // every):
            with suppress(Refused):  # of reactions at a posture that has none
                run.take(commands.row_at(plant.steps, None), plant.steps)
    run.rows.finish()
    run.seconds = time.perf_counter() - began
    return run


def _follow(run: HingedRun, table: np.ndarray, every: int, watched: Sequence[tuple[int, Hinge]]) -> None:
    """As follow_rows(), with a row before each `every`-th step; what estimates errors follows, too, up to each row and
    as far as the run came."""
    plant, first, followed = run.plant, run.plant.steps, 0

    def catch_up() -> None:
        nonlocal followed
        if run.parts:
            run.parts.follow(table[followed : plant.steps - first])
            followed = plant.steps - first

    def take() -> None:
        if plant.steps % every == 0:
            catch_up()
            run.take(table[plant.steps - first, 0], plant.steps)

    try:
        follow_rows(plant, table, watched, take)
    finally:
        catch_up()


def watched_hinges(scene: Scene) -> list[tuple[int, Hinge]]:
    """Hinges that may come to a stop by themselves, with their numbers."""
    return [(at, hinge) for at, hinge in enumerate(scene.hinges) if hinge.has_stops and not hinge.is_commanded]


def follow_rows(plant: ArticulatedPlant, table: np.ndarray, watched: Sequence[tuple[int, Hinge]],
                before_each: Callable[[], None] = lambda: None) -> None:
    """Steps along inputs; a free or motor hinge that comes to its stop ends the run."""
    if not watched:
        plant.follow(table, before_each=before_each)
        return
    before = plant.save()
    for each in table:
        before[0] = plant.c[0]
        plant.follow(each[None], before_each=before_each)
        angles = plant.hinge_angles()
        for at, hinge in watched:
            if not hinge.low_rad <= angles[at] <= hinge.high_rad:
                plant.restore(before, plant.steps - 1)
                limit = hinge.low_rad if angles[at] < hinge.low_rad else hinge.high_rad
                raise Refused("hinge at stop", "hinge_angle_rad", at + 1, f"{hinge.place} ({hinge.name}): comes to its "
                              f"stop at {limit:.6g} rad, and the model has no stops that push back; steer or start so "
                              "that it stays between them, or take the stop out", value=angles[at], limit=limit)
