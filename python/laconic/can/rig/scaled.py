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
from laconic.can.rig.lockstep import load_scene
from laconic.can.rig.sensed import (
    SENSED_FRAMES,
    Twin,
    check_frames,
    frames_of_sensors,
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
              "ENCODER": "send_encoder", "ERROR_ESTIMATE": "send_error_estimate"}
ANSWERS = ("NU", "POSE", "WHEEL_SPEED", "STATE_FD", *SENSED_FRAMES)
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
    return scene.rig.frames or DEFAULT_FRAMES


def check_voltages_only(scene: Scene) -> None:
    """BadInput for a scene with other inputs: scaled frames contain voltages only."""
    for each in scene.inputs:
        if not each.signal.startswith("voltage_V"):
            raise BadInput(f"{scene.path}: {each.location}.signal: {each.signal} has no scaled frame; use --same-bits, "
                           "which sends every input")


def read_tolerances(given: Sequence[str], scene: Scene) -> dict[str, float]:
    """{"nu_1": 0.01} from ["nu_1=0.01"]; the name of the frame may stand before that of the signal."""
    signals = ["nu_1", "nu_2", "nu_3", "x", "y", "heading"]
    signals += [f"{stem}_{wheel}" for stem in ("wheel_speed", "wheel_angle", "count", "index_count")
                for wheel in range(1, scene.wheel_count + 1)]
    signals += ["acceleration_x", "acceleration_y", "yaw_rate"]
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
    plant = plant_of(twin)
    pose = plant.pose
    values: Mapping[str, float]
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
        raw, plant = frame.unpack(data), plant_of(twin)
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

    exchanges: list[tuple[np.ndarray, list[tuple[Frame, bytes]]]] = field(default_factory=list)  # inputs, answers
    latencies_s: list[float] = field(default_factory=list)
    seconds: float = 0.0
    frames_out: int = 0
    frames_in: int = 0
    voltage_overranges: int = 0
    twin: Twin = field(init=False)  # set when the scene is loaded; `comparison` steps it

    @property
    def steps(self) -> int:
        """Steps that were answered."""
        return len(self.exchanges)

    @cached_property
    def comparison(self) -> Comparison:
        """All answers paired with the twin's values."""
        plant = plant_of(self.twin)
        comparison = Comparison(plant.wheel_count)
        for row, answer in self.exchanges:
            self.twin.run(plant.core.input(row))
            for frame, data in answer:
                comparison.take(frame, data, self.twin)
        return comparison


def frames_per_answer(scene: Scene, frames: tuple[str, ...]) -> int:
    """How many frames follow a SYNC."""
    wheel_frames = math.ceil(scene.wheel_count / 3) if "WHEEL_SPEED" in frames else 0
    return wheel_frames + sum(name in ("NU", "POSE", "STATE_FD") for name in frames) + frames_of_sensors(scene, frames)


def run_scaled(node: NodeClient, scene: Scene, steps: int | None = None,
               moved: Callable[[int], None] = lambda _: None, run: ScaledRun | None = None) -> ScaledRun:
    """Lockstep with scaled frames: voltages with sync flag out, the chosen frames in. The answers are put into
    `run`, where one is given, so that they are kept even if the run ends early."""
    check_voltages_only(scene)
    frames = wanted_frames(scene)
    awaited = frames_per_answer(scene, frames)
    if not awaited:
        raise BadInput(f"{scene.path}: rig.frames: the node never answers a step with {', '.join(frames)}; add NU")
    run = run or ScaledRun()
    run.twin = twin_of(scene, load_scene(node, scene), frames)
    node.select(**select_bits(frames))
    node.start_lockstep()
    held, voltages, link = Held(scene.inputs_on_grid()), Voltages(node, scene), node.link
    frames_out, frames_in, began = link.frames_out, link.frames_in, time.perf_counter()
    try:
        for tick in range(steps or scene.steps()):
            sent = time.perf_counter()
            row = voltages.send(held.at(tick), sync=True)
            run.exchanges.append((row, await_answers(node, awaited)))
            run.latencies_s.append(time.perf_counter() - sent)
            moved(1)
    finally:
        run.seconds, run.voltage_overranges = time.perf_counter() - began, voltages.overranges
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
