"""Vehicles with hinges over the bus: parameters, commands, and the vehicle that moves along beside the node."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np

from laconic.can.rig.client import NodeClient
from laconic.can.rig.errors import RunEnds
from laconic.can.rig.parameters import Parameter, vehicle_parameters
from laconic.can.rig.wire import WHEELS_A_GROUP, Field, Frame, wire
from laconic.core.articulated import ArticulatedPlant, ArticulatedVehicle, max_bodies, method_names
from laconic.core.articulated_input import member_of
from laconic.core.slipping import SlippingPlant, SlippingVehicle, hinge_keys, wheel_keys
from laconic.errors import BadInput, Refused
from laconic.scene import Scene
from laconic.simulation.articulated import follow_rows, given_start, start_plant, watched_hinges
from laconic.simulation.slipping import SlippingCommands, slipping_start, start_slipping
from laconic.simulation.steering import Commands

HINGED_FRAMES = ("VELOCITY", "HINGE_ANGLE", "HINGE_RATE")
HINGED_ANSWERS = ("VELOCITY", "POSE", "WHEEL_SPEED", "HINGE_ANGLE")
"""The frames of a step where [rig] lists none."""
NOT_OF_HINGES = ("NU", "STATE_FD", "IMU", "ENCODER", "ERROR_ESTIMATE")
RAW_OUTPUTS = ("raw_pose", "raw_wheel_speed", "raw_wheel_angle", "raw_velocity", "raw_hinge_angle", "raw_hinge_rate")
RAW_INPUTS = {"take_hinge_voltage": "hinge_voltage_V", "take_hinge_torque": "hinge_torque_Nm",
              "take_hinge_rate": "hinge_rate_rad_per_s", "take_twist": "twist"}
"""Bit of SELECT → member of laconic_articulated_input, in the order of the stream."""
RAW_ANGLES = "take_hinge_angle"  # behind them, where wheels may slip
TREE_FIELDS = {"com_z_m": "BODY_COM_Z", "hitch": "HINGE_HITCH", "dry_friction_Nm": "HINGE_DRY_FRICTION",
               "stop_low_rad": "HINGE_STOP_LOW", "stop_high_rad": "HINGE_STOP_HIGH",
               "servo_gain_Nm_per_rad": "SERVO_GAIN", "servo_damping_Nms": "SERVO_DAMPING",
               "servo_limit_Nm": "SERVO_LIMIT", "viscous_friction_Nms": "HINGE_VISCOUS_FRICTION",
               "winding_resistance_ohm": "HINGE_RESISTANCE", "current_limit_A": "HINGE_CURRENT_LIMIT",
               "loop_V_per_rad": "LOOP_ANGLE_GAIN", "loop_Vs_per_rad": "LOOP_RATE_GAIN",
               "control_period_s": "CONTROL_PERIOD", "load_N": "WHEEL_LOAD", "scrub_radius_m": "SCRUB_RADIUS",
               "scrub_fade_m": "SCRUB_FADE", "creep": "CREEP"}
"""Member of laconic_tree_hinge or laconic_tree_wheel → field."""
BODY_FIELDS = {"BODY_PARENT": "parent", "BODY_HINGE": "hinge", "BODY_HINGE_X": "hinge_x_m", "BODY_HINGE_Y": "hinge_y_m",
               "BODY_MASS": "mass_kg", "BODY_COM_X": "com_x_m", "BODY_COM_Y": "com_y_m",
               "BODY_YAW_INERTIA": "yaw_inertia_kgm2", "HINGE_DAMPING": "damping_Nms",
               "HINGE_STIFFNESS": "stiffness_Nm", "HINGE_REST": "rest_rad", "HINGE_GAIN": "gain_Nm_per_V"}
REQUIRED = ("BODY_HINGE", "BODY_HINGE_X", "BODY_HINGE_Y", "BODY_MASS", "BODY_YAW_INERTIA")
TWIST_PAGE = 6
ROUNDING_OF_TWIST = 1e-3  # as in the node (node_hinges.c)
CHUNK = 512               # steps whose inputs are made ready at once


HingedPlant = ArticulatedPlant | SlippingPlant


class HingedTwin:
    """The vehicle of a scene, which takes the inputs of the scene as `laconic simulate` does."""

    vehicle: ArticulatedVehicle
    plant: HingedPlant
    commands: Commands

    def __init__(self, scene: Scene):
        self.scene, self.core = scene, scene.core()
        self.slips = scene.slips_on_hinges
        self._watched = watched_hinges(scene)
        if self.slips:
            self.vehicle = vehicle = scene.slipping_vehicle(self.core)
            self.commands = commands = SlippingCommands(scene, vehicle, scene.inputs_on_grid())
            self.first = vehicle.input_row({"steering_angle_rad": (angles := commands.start_angles())})
            self.plant = start_slipping(scene, vehicle, angles)
        else:
            self.vehicle = scene.articulated_vehicle(self.core)
            self.commands = Commands(scene, self.vehicle, scene.inputs_on_grid())
            self.first = self.commands.first_row()
            self.plant = start_plant(scene, self.vehicle, self.first)

    def start_angles(self) -> list[float]:
        """Of the hinges of a vehicle that slips, as commanded."""
        return [float(each) for each in self.first[len(self.first) - max_bodies(self.core):][: self.vehicle.body_count]]

    def steps(self, count: int, *, moves: bool = True) -> Iterator[np.ndarray]:
        """Inputs at the start and end of each step, (2, numbers of a row), after the vehicle has taken it (`moves`).

        RunEnds where a limit or a stop ends the run. A step that the core refuses is given all the same: the node must
        refuse it, too."""
        for first in range(0, count, CHUNK):
            for row in self._rows(first, min(CHUNK, count - first)):
                if moves:
                    self._take(row)
                yield row
            if self.commands.refused:
                raise RunEnds(self.commands.refused.message)

    def _rows(self, first: int, count: int) -> np.ndarray:
        """On ground with friction inputs are held: those of the start are those of the end."""
        if isinstance(self.commands, SlippingCommands):
            return np.repeat(self.commands.held_rows(first, count)[:, None], 2, axis=1)
        return self.commands.rows(first, count)

    def _take(self, row: np.ndarray) -> None:
        try:
            if isinstance(self.plant, SlippingPlant):
                follow(self.plant, row)
                return
            follow_rows(self.plant, row[None], self._watched)
        except Refused as refused:
            if refused.status == "hinge at stop":
                raise RunEnds(f"{self.scene.path}: at t = {self.plant.steps * self.scene.run.step_s:g} s: "
                              f"{refused.message}") from None

    def raw_row(self) -> np.ndarray:
        """The numbers of RAW_OUTPUTS at this moment."""
        now = self.plant.motion()
        return np.concatenate([[now.x_m, now.y_m, now.heading_rad], now.wheel_speed_rad_per_s, now.wheel_angle_rad,
                               now.velocity_m_per_s, [now.yaw_rate_rad_per_s], now.hinge_angle_rad,
                               now.hinge_rate_rad_per_s]).astype(self.core.dtype)

    def parts(self) -> dict[str, slice]:
        """Where each output stands in a raw row."""
        wheels, hinges = self.vehicle.wheel_count, self.vehicle.body_count
        sizes = {"pose": 3, "wheel_speed": wheels, "wheel_angle": wheels, "velocity": 3, "hinge_angle": hinges,
                 "hinge_rate": hinges}
        ends = np.cumsum(list(sizes.values())).tolist()
        return {name: slice(end - size, end) for (name, size), end in zip(sizes.items(), ends, strict=True)}


def follow(plant: HingedPlant, rows: np.ndarray) -> None:
    """One step along inputs at its start and end."""
    if isinstance(plant, SlippingPlant):
        plant.follow(rows[1:])
    else:
        plant.follow(rows[None])


# ---- parameters

def load_hinged(node: NodeClient, twin: HingedTwin, more: Iterable[Parameter] = ()) -> None:
    """Sends the vehicle, start and run to a node; BadInput for one that cannot take them."""
    identity = (node.identity if node.link.session.is_open else None) or node.open()
    scene = twin.scene
    if not identity.hinges:
        raise BadInput(f"{scene.path}: the node does not take vehicles with hinges; use one that is built with "
                       "LACONIC_NODE_WITH_HINGES=1, such as --board an386-hinges")
    if twin.slips and not identity.slip:
        raise BadInput(f"{scene.path}: ground.friction_coefficient: the node takes vehicles with hinges on "
                       "ideal ground alone; use one that is built with LACONIC_NODE_WITH_SLIP=1, such as --board "
                       "an386-slip, or take it out")
    if identity.real != scene.run.real:
        raise BadInput(f"{scene.path}: run.real is {scene.run.real}, the node computes in {identity.real}; "
                       f"give --real {identity.real}, or another node")
    if identity.max_wheels < scene.wheel_count:
        raise BadInput(f"{scene.path}: vehicle.wheel: {scene.wheel_count} of them, the node has room for "
                       f"{identity.max_wheels}; use a build with more")
    node.load_parameters((*hinged_parameters(twin), *more), twin.core.dtype)


def hinged_parameters(twin: HingedTwin) -> Iterator[Parameter]:
    """All parameters of a vehicle with hinges, its start and its run."""
    vehicle, core = twin.vehicle, twin.core
    given = given_slipping(twin) if twin.slips else given_start(twin.scene, vehicle)
    of_start = {name: given.get(name) for name in ("x_m", "y_m", "heading_rad", "wheel_speed_rad_per_s")}
    start = core.ffi.new("laconic_start *", {name: value for name, value in of_start.items() if value is not None})
    yield from vehicle_parameters(core, vehicle.c.base, start, with_drive=twin.slips)
    yield "METHOD", 0, method_names().index(twin.scene.run.method)
    yield "STEP", 0, twin.scene.run.step_s
    yield "BODY_COUNT", 0, vehicle.body_count
    for at in range(vehicle.body_count):
        for field, member in BODY_FIELDS.items():
            value = getattr(vehicle.c.body[at], member)
            if value != 0 or field in REQUIRED:
                yield field, at + 1, value
    for at in range(vehicle.wheel_count):
        if of_body := int(vehicle.c.wheel_body[at]):
            yield "WHEEL_BODY", at + 1, of_body
    rates, _ = member_of(core, "hinge_rate_rad_per_s")
    twist, _ = member_of(core, "twist")
    lists = {"HINGE_RATE": twin.first[rates : rates + vehicle.body_count], "TWIST": twin.first[twist : twist + 3],
             "START_VELOCITY": given["velocity_m_per_s"], "START_HINGE_ANGLE": given["hinge_angle_rad"],
             "START_HINGE_RATE": given["hinge_rate_rad_per_s"]}
    for field, values in lists.items():
        yield from ((field, item, float(value)) for item, value in enumerate(values, 1) if value)
    if given["yaw_rate_rad_per_s"]:
        yield "START_YAW_RATE", 0, float(given["yaw_rate_rad_per_s"])
    if isinstance(vehicle, SlippingVehicle):
        yield from _slipping_parameters(vehicle)


def _slipping_parameters(vehicle: SlippingVehicle) -> Iterator[Parameter]:
    """What ground with friction reads besides."""
    all_items = ((hinge_keys(vehicle.core), vehicle.tree.hinge, vehicle.body_count),
                 (wheel_keys(vehicle.core), vehicle.tree.wheel, vehicle.wheel_count))
    for keys, items, count in all_items:
        for at in range(count):
            for key, kind in keys.items():
                if value := getattr(items[at], key):
                    yield TREE_FIELDS[key], at + 1, int(value) if kind == "flag" else float(value)


def given_slipping(twin: HingedTwin) -> dict[str, Any]:
    """The numbers of the start of a scene on ground with friction; BadInput for one that has no parameter."""
    scene, start = twin.scene, twin.scene.initial
    moves = any((*start.velocity_body_m_per_s, start.yaw_rate_rad_per_s))
    if start.wheel_speed_rad_per_s and not any(start.wheel_speed_rad_per_s) and moves:
        raise BadInput(f"{scene.path}: initial.wheel_speed_rad_per_s: a node takes wheels that all stand on a vehicle "
                       "that moves as wheels that roll; give one of them a speed such as 1e-9, or run laconic simulate")
    return slipping_start(scene, twin.start_angles())


# ---- frames

def check_hinged_frames(scene: Scene, frames: Sequence[str]) -> None:
    """BadInput for frames that a vehicle with or without hinges does not have."""
    for name in frames:
        if scene.has_hinges and name in NOT_OF_HINGES:
            raise BadInput(f"{scene.path}: rig.frames: {name} is not of vehicles with hinges; "
                           f"give some of {', '.join((*HINGED_ANSWERS, 'HINGE_RATE', 'WHEEL_ANGLE'))}")
        if not scene.has_hinges and name in HINGED_FRAMES:
            raise BadInput(f"{scene.path}: rig.frames: {name} is of vehicles with hinges, and this one has none")


def count_of_hinged_frames(scene: Scene, frames: Sequence[str]) -> int:
    """How many of the frames of hinges follow a step."""
    groups = math.ceil(len(scene.hinges) / WHEELS_A_GROUP)
    each = {"VELOCITY": 1, "HINGE_ANGLE": groups, "HINGE_RATE": groups}
    return sum(each[name] for name in HINGED_FRAMES if name in frames)


def values_with_hinges(plant: HingedPlant, frame: Frame, group: int) -> dict[str, float]:
    """The values of a frame of a vehicle with hinges, in the units of its signals."""
    now, wrapped = plant.c_motion(), plant.core.lib.laconic_angle_wrapped
    if frame.name == "POSE":
        return {"x": now.x_m, "y": now.y_m, "heading": wrapped(now.heading_rad)}
    if frame.name == "VELOCITY":
        ahead, left = now.velocity_m_per_s
        return {"ahead": ahead, "left": left, "yaw_rate": now.yaw_rate_rad_per_s}
    stem, is_angle = frame.name.lower(), frame.name.endswith("ANGLE")
    of = getattr(now, f"{stem}_rad" if is_angle else f"{stem}_rad_per_s")
    first, count = WHEELS_A_GROUP * group, plant.vehicle.wheel_count if stem[0] == "w" else plant.vehicle.body_count
    return {f"{stem}_{k}": wrapped(of[at]) if is_angle else of[at]
            for k, at in enumerate(range(first, min(first + WHEELS_A_GROUP, count)), 1)}


def resting_row(twin: HingedTwin) -> np.ndarray:
    """The inputs of a node before the first command: rates and twist of the start."""
    row = np.asarray(twin.first.astype(twin.core.dtype))
    row[: member_of(twin.core, "base")[1]] = 0
    return row


class NodeInputs:
    """What a node makes of the scaled commands: its inputs at the start and end of the next step, as rows."""

    def __init__(self, twin: HingedTwin):
        self.core, self._vehicle = twin.core, twin.vehicle
        self.targets = targets_of(twin)
        self._start = resting_row(twin)
        self._end = self._start.copy()
        self._at = {name: member_of(twin.core, name)[0] for name in RAW_INPUTS.values()}

    def set_base(self, base: np.ndarray) -> None:
        """The inputs of wheels and carriage, of both ends."""
        self._start[: len(base)] = self._end[: len(base)] = base

    def set_page(self, page: int, raws: Sequence[int]) -> None:
        """The three raw numbers of one STEERING."""
        real = self.core.dtype.type
        per_unit = real(round(1.0 / signals_of_page(page)[0].scale))
        numbers = np.array([real(raw) / per_unit for raw in raws])
        if page == TWIST_PAGE:
            self._end[self._at["twist"] : self._at["twist"] + 3] = self._rolling(numbers)
            return
        first = WHEELS_A_GROUP * (page % 3)
        count = min(WHEELS_A_GROUP, self._vehicle.body_count - first)
        if self.targets is not None and page < 3:
            for slot, target in zip(self.targets[first : first + count], numbers, strict=False):
                if slot is not None:
                    self._start[slot] = self._end[slot] = target
            return
        for row in (self._start, self._end) if page >= 3 else (self._end,):
            at = self._at["hinge_voltage_V" if page >= 3 else "hinge_rate_rad_per_s"] + first
            row[at : at + count] = numbers[:count]

    def stepped(self) -> np.ndarray:
        """Those of the step that begins now, (2, numbers); later ones hold its end."""
        rows = np.array([self._start, self._end])
        self._start = self._end.copy()
        return rows

    def _rolling(self, twist: np.ndarray) -> np.ndarray:
        """The nearest twist that the carriage's own wheels allow, in the node's own steps."""
        model, real = self._vehicle.model, self.core.dtype.type
        com_x, com_y = real(model.com_x_m), real(model.com_y_m)
        at_com = np.array([twist[0] - twist[2] * com_y, twist[1] + twist[2] * com_x, twist[2]])
        for k in range(model.held_count):
            held = np.array([model.held[k].x, model.held[k].y, model.held[k].z], self.core.dtype)
            along, square = _dot(held, at_com), _dot(held, held)
            limit = real(ROUNDING_OF_TWIST)
            if along * along <= limit * limit * square * _dot(at_com, at_com):
                at_com = at_com - along / square * held
        return np.array([at_com[0] + at_com[2] * com_y, at_com[1] - at_com[2] * com_x, at_com[2]])


def signals_of_page(page: int) -> list[Field]:
    """The three signals of a page of STEERING."""
    stem = "twist" if page == TWIST_PAGE else "hinge_voltage" if page >= 3 else "hinge_rate"
    first = 0 if page == TWIST_PAGE else WHEELS_A_GROUP * (page % 3)
    return [wire()["STEERING"].fields[f"{stem}_{first + k}"] for k in (1, 2, 3)]


class Steering:
    """Sends the scaled commands of hinges behind the voltages of a step."""

    def __init__(self, node: NodeClient, twin: HingedTwin):
        self.node, self.overranges, self._inputs = node, 0, NodeInputs(twin)
        self._targets = self._inputs.targets
        self._vehicle, self._frame = twin.vehicle, wire()["STEERING"]
        self._at = {name: member_of(twin.core, name)[0] for name in RAW_INPUTS.values()}
        kinds = [hinge.kind for hinge in twin.scene.hinges]
        of_rates = [kind == "prescribed" for kind in kinds]
        if self._targets is not None:
            of_rates = [slot is not None for slot in self._targets]
        of_pages = ((0, of_rates), (3, [kind == "motor" for kind in kinds]))
        self.pages = [page + first for first, chosen in of_pages for page in range(3)
                      if any(chosen[WHEELS_A_GROUP * page : WHEELS_A_GROUP * (page + 1)])]
        self.pages += [TWIST_PAGE] if twin.vehicle.is_coordinated else []

    def send(self, wanted: np.ndarray, base: np.ndarray, *, sync: bool = True) -> np.ndarray:
        """Inputs that the node makes of all, at the start and end of the step. `wanted`: those of the scene; `base`:
        what the node makes of the voltages."""
        self._inputs.set_base(base)
        for page in self.pages:
            signals = signals_of_page(page)
            raws = [signal.raw(value) for signal, value in zip(signals, self._wanted(page, wanted), strict=True)]
            self.overranges += any(over for _, over in raws)
            packed = {signal.name: raw for signal, (raw, _) in zip(signals, raws, strict=True)}
            ends = int(sync and page == self.pages[-1])
            self.node.link.send(self._frame, self._frame.pack(page=page, sync=ends, **packed))
            self._inputs.set_page(page, [raw for raw, _ in raws])
        return self._inputs.stepped()

    def _wanted(self, page: int, wanted: np.ndarray) -> list[float]:
        """Three numbers: voltages of the step's start, rates and twist of its end."""
        first = WHEELS_A_GROUP * (page % 3)
        if page == TWIST_PAGE:
            twist = wanted[1, self._at["twist"] : self._at["twist"] + 3]
            largest = self._frame.fields["twist_1"]
            size = float(np.abs(twist).max()) or 1.0
            return [float(each) / size * largest.largest * largest.scale for each in twist]
        if self._targets is not None and page < 3:
            slots = [*self._targets, *[None] * WHEELS_A_GROUP][first : first + WHEELS_A_GROUP]
            return [0.0 if slot is None else float(wanted[1, slot]) for slot in slots]
        at = self._at["hinge_voltage_V" if page >= 3 else "hinge_rate_rad_per_s"] + first
        hinges = self._vehicle.body_count
        return [float(wanted[int(page < 3), at + k]) if first + k < hinges else 0.0 for k in range(WHEELS_A_GROUP)]


def targets_of(twin: HingedTwin) -> list[int | None] | None:
    """Where each hinge takes its command on ground with friction, as the node has it: the number of a prescribed rate,
    of the angle of a servo or loop, or else of its rate. None: on ideal ground."""
    vehicle = twin.vehicle
    if not isinstance(vehicle, SlippingVehicle):
        return None
    rates, angles = vehicle.slots("steering_rate_rad_per_s"), vehicle.slots("steering_angle_rad")
    return [angles[at] if hinge.follows == "angle" else rates[at] if hinge.follows or hinge.is_commanded else None
            for at, hinge in enumerate(twin.scene.hinges)]


def run_commanded(plant: HingedPlant, now: np.ndarray, command: np.ndarray | None, steps: int) -> np.ndarray:
    """So many steps as the node takes them; the inputs that act then. With a new command (inputs at start and end) the
    first goes from the present rates and twist to its own, and later ones hold them."""
    if isinstance(plant, SlippingPlant):
        row = np.atleast_2d(now if command is None else command)[-1]
        plant.run(row, steps)
        return np.asarray(row)
    if command is not None and steps > 0:
        start = command[1].copy()
        for name in ("hinge_rate_rad_per_s", "twist"):
            at, length = member_of(plant.core, name)
            start[at : at + length] = now[at : at + length]
        plant.follow(np.array([[start, command[1]]]))
        now, steps = command[1], steps - 1
    plant.run(now, steps)
    return now


def _dot(a: np.ndarray, b: np.ndarray) -> Any:
    """In the order of the node."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def raw_columns(twin: HingedTwin, groups: Sequence[str]) -> list[int]:
    """Indices of the chosen hinges' numbers in a row of laconic_articulated_input."""
    columns: list[int] = []
    for bit in (each for each in groups if each != RAW_ANGLES):
        start, _ = member_of(twin.core, RAW_INPUTS[bit])
        columns += range(start, start + (3 if bit == "take_twist" else twin.vehicle.body_count))
    if isinstance(twin.vehicle, SlippingVehicle) and RAW_ANGLES in groups:
        columns += twin.vehicle.slots("steering_angle_rad")
    return columns


def raw_groups(twin: HingedTwin) -> list[str]:
    """Which numbers of hinges a scene's inputs or commands may set."""
    names = {each.signal.partition("[")[0] for each in twin.scene.inputs}
    kinds = {hinge.kind for hinge in twin.scene.hinges}
    chosen = {"take_hinge_voltage": "hinge_voltage_V" in names, "take_hinge_torque": "hinge_torque_Nm" in names,
              "take_hinge_rate": "prescribed" in kinds or twin.slips,
              "take_twist": "coordinated" in kinds and not twin.slips, RAW_ANGLES: twin.slips}
    return [bit for bit, is_chosen in chosen.items() if is_chosen]
