"""Daily use: voltages and answers as scaled integers, judged against a twin in the core that gets the same integers."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from laconic.can.rig.client import NodeClient
from laconic.can.rig.errors import NodeSilent
from laconic.can.rig.hinged import (
    HINGED_ANSWERS,
    HINGED_FRAMES,
    HingedPlant,
    HingedTwin,
    Steering,
    check_hinged_frames,
    count_of_hinged_frames,
    follow,
    load_hinged,
    values_with_hinges,
)
from laconic.can.rig.lockstep import load_scene
from laconic.can.rig.sensed import (
    SENSED_FRAMES,
    Twin,
    check_frames,
    frames_of_sensors,
    moving,
    part_of,
    period_of,
    plant_of,
    twin_of,
    values_of_frame,
    wrap_of,
)
from laconic.can.rig.wire import Frame, wire
from laconic.errors import BadInput, nearest_of
from laconic.scene import Scene
from laconic.scene.inputs import InputsOnGrid

DEFAULT_FRAMES = ("NU", "POSE", "WHEEL_SPEED")
SELECT_BIT = {"NU": "send_nu", "POSE": "send_pose", "WHEEL_SPEED": "send_wheel_speed", "COUNTERS": "send_counters",
              "STATE_FD": "send_state_fd", "WHEEL_ANGLE": "send_wheel_angle", "IMU": "send_imu",
              "ENCODER": "send_encoder", "ERROR_ESTIMATE": "send_error_estimate", "VELOCITY": "send_velocity",
              "HINGE_ANGLE": "send_hinge_angle", "HINGE_RATE": "send_hinge_rate"}
ANSWERS = ("NU", "POSE", "WHEEL_SPEED", "STATE_FD", *SENSED_FRAMES, *HINGED_FRAMES)
OF_HINGES = ("hinge_voltage_V", "steering_rate_rad_per_s", "steering_angle_rad", "steering_twist",
             "steering_curvature_per_m")
"""Inputs of hinges that STEERING carries, itself or as the rates and the twist that follow from them."""
ALWAYS_SENT = ("HEARTBEAT",)


def select_bits(frames: Iterable[str]) -> dict[str, int]:
    """The bits of SELECT that make the node send these frames."""
    return {SELECT_BIT[name]: 1 for name in frames if name not in ALWAYS_SENT}


def wanted_frames(scene: Scene) -> tuple[str, ...]:
    """The frames that [rig] lists, or the default ones."""
    for name in scene.rig.frames:
        if name not in SELECT_BIT and name not in ALWAYS_SENT:
            known = ", ".join((*SELECT_BIT, *ALWAYS_SENT))
            raise BadInput(f"{scene.path}: rig.frames: there is no frame {name}; known are {known}")
    check_frames(scene, scene.rig.frames)
    check_hinged_frames(scene, scene.rig.frames)
    return scene.rig.frames or (HINGED_ANSWERS if scene.has_hinges else DEFAULT_FRAMES)


def check_voltages_only(scene: Scene) -> None:
    """BadInput for a scene with other inputs: scaled frames contain voltages, and commands of hinges, only."""
    for each in scene.inputs:
        if not each.signal.startswith(("voltage_V", *OF_HINGES)):
            raise BadInput(f"{scene.path}: {each.location}.signal: {each.signal} has no scaled frame; use --same-bits, "
                           "which sends every input")


def read_tolerances(given: Sequence[str], scene: Scene) -> dict[str, float]:
    """{"nu_1": 0.01} from ["nu_1=0.01"]; the name of the frame may stand before that of the signal."""
    signals = ["nu_1", "nu_2", "nu_3", "x", "y", "heading"]
    signals += [f"{stem}_{wheel}" for stem in ("wheel_speed", "wheel_angle", "count", "index_count")
                for wheel in range(1, scene.wheel_count + 1)]
    signals += ["acceleration_x", "acceleration_y", "yaw_rate", "ahead", "left"]
    signals += [f"hinge_{what}_{hinge}" for what in ("angle", "rate") for hinge in range(1, len(scene.hinges) + 1)]
    found = {}
    for text in given:
        name, equals, value = text.partition("=")
        try:
            found[name] = float(value)
        except ValueError:
            equals = ""
        if not equals or not 0.0 <= found[name] < float("inf"):
            raise BadInput(f"--tolerance {text}: give SIGNAL=VALUE, zero or more, such as nu_1=0.01")
        if name.rpartition(".")[2] not in signals:
            raise BadInput(f"--tolerance {text}: there is no signal {name}; {nearest_of(name, signals)}")
    return found


def groups_of(wheel_count: int) -> int:
    """Frames of three wheels each; at least one, which feeds the watchdog of a vehicle without wheels."""
    return max(1, math.ceil(wheel_count / 3))


class Held:
    """The inputs' values at the start of each step, evaluated only where they can change."""

    def __init__(self, inputs: InputsOnGrid):
        self.step_s = inputs.step_s
        self._inputs, self._changes = inputs, set(inputs.changes)
        self._values: dict[str, float] = {}

    def at(self, tick: int) -> dict[str, float]:
        """By signal; after their end, their last values."""
        if tick < self._inputs.steps and (tick in self._changes or not self._inputs.is_held or not self._values):
            self._values = self._inputs.held_at(tick)
        return self._values

    overranges = 0

    def send(self, voltages: Voltages, tick: int, *, sync: bool = True) -> np.ndarray:
        """Voltages and, with `sync`, the order to take one step; the row of input numbers that the node uses."""
        return voltages.send(self.at(tick), sync=sync)


class Hinged:
    """The commands of a scene with hinges, one step after the other; it loads the scene into the node."""

    def __init__(self, node: NodeClient, scene: Scene, steps: int):
        self.twin = HingedTwin(scene)
        load_hinged(node, self.twin)
        self._steering = Steering(node, self.twin)
        self._rows = self.twin.steps(steps, moves=False)
        self._tick, self._wanted = -1, np.array([self.twin.first, self.twin.first])

    @property
    def overranges(self) -> int:
        """Frames with a command beyond its range."""
        return self._steering.overranges

    def send(self, voltages: Voltages, tick: int, *, sync: bool = True) -> np.ndarray:
        """Voltages, commands of hinges and, with `sync`, the order to take one step. Inputs of the node at start and
        end of the step that takes them. Ticks come in order; after the scene's end its last commands stay."""
        while self._tick < tick:
            self._tick, self._wanted = self._tick + 1, next(self._rows, self._wanted)
        wanted = self._wanted
        volts = {f"voltage_V[{wheel + 1}]": float(wanted[0, self.twin.vehicle.slot(f"voltage_V[{wheel + 1}]")])
                 for wheel in range(self.twin.vehicle.wheel_count)}
        base = voltages.send(volts, sync=sync and not self._steering.pages)
        return self._steering.send(wanted, base, sync=sync)


class Voltages:
    """Sends scaled voltages; returns the same rounded numbers for the twin."""

    def __init__(self, node: NodeClient, scene: Scene):
        self.node, self.core = node, scene.core()
        self.count = scene.wheel_count
        self.frame = wire()["VOLTAGE"]
        self.overranges = 0
        self._fields = [self.frame.fields[f"voltage_{k}"] for k in (1, 2, 3)]
        self._per_unit = self.core.dtype.type(round(1 / self._fields[0].scale))

    def send(self, volts: dict[str, float], sync: bool = False) -> np.ndarray:
        """Sends all groups; the last carries the sync flag. Returns the row of input numbers that the node uses."""
        raws, row = [], np.zeros(self.core.input_length, self.core.dtype)
        start = self.core.input_fields["voltage_V"][0]
        for wheel in range(3 * groups_of(self.count)):
            raw, over = self._fields[wheel % 3].raw(volts.get(f"voltage_V[{wheel + 1}]", 0.0))
            raws.append((raw, over))
            if wheel < self.count:
                row[start + wheel] = self.core.dtype.type(raw) / self._per_unit
        for group in range(groups_of(self.count)):
            three = raws[3 * group : 3 * group + 3]
            overrange = any(over for _, over in three)
            self.overranges += overrange
            last = group == groups_of(self.count) - 1
            self.node.link.send(self.frame, self.frame.pack(
                sync=int(sync and last), group=group, overrange=int(overrange),
                **{f"voltage_{k + 1}": raw for k, (raw, _) in enumerate(three)}))
        return row


def expected_raw(twin: Twin, frame: Frame, group: int = 0) -> dict[str, float]:
    """The twin's values of a frame, in units of the raw values, before rounding."""
    values: Mapping[str, float]
    if isinstance(twin, HingedPlant):
        values = values_with_hinges(twin, frame, group)
        return {name: value / frame.fields[name].scale for name, value in values.items()}
    plant = plant_of(twin)
    pose = plant.pose
    if frame.name in SENSED_FRAMES:
        values = values_of_frame(twin, frame, group)
    elif frame.name == "NU":
        values = dict(zip(("nu_1", "nu_2", "nu_3"), plant.nu, strict=True))
    elif frame.name == "POSE":
        values = {"x": pose.x_m, "y": pose.y_m, "heading": pose.heading_wrapped_rad}
    elif frame.name == "WHEEL_SPEED":
        speeds = plant.wheel_speeds()[3 * group : 3 * group + 3]
        values = {f"wheel_speed_{k + 1}": speed for k, speed in enumerate(speeds)}
    else:
        speeds = plant.wheel_speeds()
        values = {f"nu_{k + 1}": v for k, v in enumerate(plant.nu)}
        values |= {"x": pose.x_m, "y": pose.y_m, "heading": pose.heading_wrapped_rad}
        values |= {f"wheel_speed_{k + 1}": v for k, v in enumerate(speeds)}
    return {name: float(value) / frame.fields[name].scale for name, value in values.items()}


def rounding_limit(raw: np.ndarray | float, dtype: np.dtype) -> np.ndarray | float:
    """Largest difference between a right raw value and the exact one, in units of the raw value: 0.5 from rounding to
    an integer, and two roundings of the node's scalar type when it scales and adds."""
    return 0.5 + 1e-6 + np.finfo(dtype).eps * np.abs(raw)


@dataclass
class SignalRecord:
    """One signal over a run, in its unit: the node's values and the twin's."""

    scale: float
    dtype: np.dtype
    ticks: list[int] = field(default_factory=list)
    measured: list[float] = field(default_factory=list)
    twin: list[float] = field(default_factory=list)


class Comparison:
    """Pairs of the node's answers and the twin's values."""

    def __init__(self, wheel_count: int):
        self.wheel_count = wheel_count
        self.signals: dict[str, SignalRecord] = {}
        self.overranges = 0

    def take(self, frame: Frame, data: bytes, twin: Twin) -> None:
        """One answer and the twin at the same step."""
        raw, plant = frame.unpack(data), moving(twin)
        group = part_of(frame, raw)
        self.overranges += raw.get("overrange", 0)
        for name, value in expected_raw(twin, frame, group).items():
            field_ = frame.fields[name]
            label = f"{frame.name}.{self._label(frame, name, group)}"
            record = self.signals.setdefault(label, SignalRecord(field_.scale, plant.core.dtype))
            difference = raw[name] - value
            if turn := period_of(frame, name, wrap_of(twin)):  # +π and −π are neighbours
                difference -= turn * round(difference / turn)
            cut = min(max(value, -field_.largest), field_.largest)
            record.ticks.append(plant.steps)
            record.measured.append((raw[name] if cut != value else value + difference) * field_.scale)
            record.twin.append(cut * field_.scale)

    def _label(self, frame: Frame, name: str, group: int) -> str:
        if frame.name == "ENCODER":
            return f"{name}_{group + 1}"
        if not group:
            return name
        base, _, k = name.rpartition("_")
        return f"{base}_{3 * group + int(k)}"


@dataclass
class ScaledRun:
    """A lockstep run with scaled frames, up to its end, early or not."""

    exchanges: list[tuple[np.ndarray, list[tuple[Frame, bytes]]]] = field(default_factory=list)
    """Inputs (with hinges those at the start and the end of the step) and answers."""
    latencies_s: list[float] = field(default_factory=list)
    seconds: float = 0.0
    frames_out: int = 0
    frames_in: int = 0
    voltage_overranges: int = 0
    twin: Twin = field(init=False)  # set when the scene is loaded; `comparison` steps it
    wheel_count: int = 0

    @property
    def steps(self) -> int:
        """Steps that were answered."""
        return len(self.exchanges)

    @cached_property
    def comparison(self) -> Comparison:
        """All answers paired with the twin's values."""
        twin = self.twin
        comparison = Comparison(self.wheel_count)
        for row, answer in self.exchanges:
            if isinstance(twin, HingedPlant):
                follow(twin, row)
            else:
                twin.run(plant_of(twin).core.input(row))
            for frame, data in answer:
                comparison.take(frame, data, self.twin)
        return comparison


def frames_per_answer(scene: Scene, frames: tuple[str, ...]) -> int:
    """How many frames follow a SYNC."""
    wheel_frames = math.ceil(scene.wheel_count / 3) if "WHEEL_SPEED" in frames else 0
    plain = sum(name in ("NU", "POSE", "STATE_FD") for name in frames)
    return wheel_frames + plain + frames_of_sensors(scene, frames) + count_of_hinged_frames(scene, frames)


def run_scaled(node: NodeClient, scene: Scene, steps: int | None = None,
               moved: Callable[[int], None] = lambda _: None, run: ScaledRun | None = None) -> ScaledRun:
    """Lockstep with scaled frames: voltages with sync flag out, the chosen frames in. The answers are put into
    `run`, where one is given, so that they are kept even if the run ends early."""
    check_voltages_only(scene)
    frames = wanted_frames(scene)
    awaited = frames_per_answer(scene, frames)
    if not awaited:
        raise BadInput(f"{scene.path}: rig.frames: the node never answers a step with {', '.join(frames)}; add NU")
    run, wanted = run or ScaledRun(), steps or scene.steps()
    run.wheel_count = scene.wheel_count
    commands: Held | Hinged
    if scene.has_hinges:
        if wanted > scene.steps():
            scene = scene.with_run(duration_s=wanted * scene.run.step_s)
        commands = Hinged(node, scene, wanted)
        run.twin = commands.twin.plant
    else:
        run.twin, commands = twin_of(scene, load_scene(node, scene), frames), Held(scene.inputs_on_grid())
    node.select(**select_bits(frames))
    node.start_lockstep()
    voltages, link = Voltages(node, scene), node.link
    frames_out, frames_in, began = link.frames_out, link.frames_in, time.perf_counter()
    try:
        for tick in range(wanted):
            sent = time.perf_counter()
            row = commands.send(voltages, tick)
            run.exchanges.append((row, await_answers(node, awaited)))
            run.latencies_s.append(time.perf_counter() - sent)
            moved(1)
    finally:
        run.seconds = time.perf_counter() - began
        run.voltage_overranges = voltages.overranges + commands.overranges
        run.frames_out, run.frames_in = link.frames_out - frames_out, link.frames_in - frames_in
    node.stop()
    return run


def await_answers(node: NodeClient, count: int) -> list[tuple[Frame, bytes]]:
    """The frames that answer one step."""
    answers: list[tuple[Frame, bytes]] = []
    deadline_us = node.link.deadline_us(node.timeout_s)
    while len(answers) < count:
        received = node.link.receive_until(deadline_us)
        if received is None:
            raise NodeSilent(f"{len(answers)} of {count} answers came within {node.timeout_s:g} s; "
                             f"{node.likely_cause()}")
        node.notice(*received)
        if received[0].name in ANSWERS:
            answers.append(received)
    return answers
