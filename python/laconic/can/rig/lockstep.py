"""Lockstep with raw frames: a scene over a bus, bit for bit.

    with virtual_node(scene.run.real) as node:
        run = run_lockstep(node, scene, steps=10_000)
    run.states[k]    ν, x, y, heading, wheel speeds, wheel angles after the k-th exchange, in the core's scalar type,
                     in the order of Plant.row(); then what the scene's sensors show

Latency of answers: figures over all exchanges of a run.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from laconic.can.rig.client import Identity, NodeClient, is_estimated
from laconic.can.rig.errors import NodeSilent
from laconic.can.rig.hinged import RAW_OUTPUTS, HingedTwin, load_hinged, raw_columns, raw_groups
from laconic.can.rig.parameters import Parameter, method_number
from laconic.can.rig.sensed import RAW_OF_SENSORS, has_sensors, raw_row, sensor_parameters
from laconic.can.rig.wire import wire
from laconic.core.plant import Plant
from laconic.core.recording import Recorder
from laconic.errors import BadInput
from laconic.scene import Scene
from laconic.scene.ground import has_friction
from laconic.scene.inputs import InputsOnGrid
from laconic.simulation import advance_plant

INPUT_GROUPS = {  # bit of SELECT → numbers of one input, in the order of the stream
    "take_voltage": ("voltage_V",), "take_axle_torque": ("axle_torque_Nm",),
    "take_body_wrench": ("body_force_N", "body_moment_Nm"),
    "take_world_force": ("world_force_N", "world_force_point_m")}
OUTPUTS = ("raw_nu", "raw_pose", "raw_wheel_speed", "raw_wheel_angle")


@dataclass
class LockstepRun:
    """The node's answers, one row an exchange, up to the end of the run, early or not."""

    exchanges: list[tuple[int, np.ndarray]] = field(default_factory=list)  # steps taken, row
    latencies_s: list[float] = field(default_factory=list)
    seconds: float = 0.0
    frames_out: int = 0
    frames_in: int = 0
    twin: Plant = field(init=False)  # plant of the core, at the start; set when the scene is loaded
    hinged: HingedTwin | None = None  # instead of it, of a scene with hinges: it moves along …
    hinged_rows: list[np.ndarray] = field(default_factory=list)  # … and these are its outputs

    @cached_property
    def ticks(self) -> np.ndarray:
        """Steps taken when each row was sent."""
        return np.array([ticks for ticks, _ in self.exchanges], dtype=int)

    @cached_property
    def states(self) -> np.ndarray:
        """ν(3), x, y, heading, wheel speeds (N), wheel angles (N), one row an exchange; of a scene with sensors then
        acceleration_body_m_per_s2 (2), imu_acceleration_m_per_s2 (2), imu_yaw_rate_rad_per_s, encoder_count (N)."""
        return np.array([row for _, row in self.exchanges])

    @property
    def hinged_states(self) -> np.ndarray:
        """Of a vehicle with hinges, its rows at the same steps."""
        return np.array(self.hinged_rows[: len(self.exchanges)])

    @property
    def steps(self) -> int:
        """Steps taken."""
        return self.exchanges[-1][0] if self.exchanges else 0

    @property
    def nu(self) -> np.ndarray:
        """ν, one row an exchange."""
        return self.states[:, :3]

    @property
    def pose(self) -> np.ndarray:
        """x, y, heading."""
        return self.states[:, 3:6]


def start_of(scene: Scene) -> Any:
    """The scene's laconic_start, in the core's scalar type."""
    return scene.c_start(scene.core())


def load_scene(node: NodeClient, scene: Scene, more: Iterable[Parameter] = ()) -> Plant:
    """Sends a scene's vehicle, start and run to a node, and more parameters where there are more; returns its twin, a
    plant of the core at the same start."""
    identity = (node.identity if node.link.session.is_open else None) or node.open()
    twin = scene.plant(scene.core())
    check_run(identity, scene, twin)
    if identity.max_wheels < scene.wheel_count:
        raise BadInput(f"{scene.path}: vehicle.wheel: {scene.wheel_count} of them, the node has room for "
                       f"{identity.max_wheels}; use a build with more")
    node.load(twin, start_of(scene), (*sensor_parameters(scene, twin), *more))
    return twin


def check_run(identity: Identity, scene: Scene, twin: Plant) -> None:
    """BadInput for a scalar type or a method that the node does not have, with all options that it needs instead. Of a
    method without a bit in IDENTITY.methods the node says so itself, when it is loaded."""
    core, options, what = twin.core, [], []
    number = method_number(core, twin.c.integrator.method)
    if identity.real != scene.run.real:
        what.append(f"run.real is {scene.run.real}, the node computes in {identity.real}")
        options.append(f"--real {identity.real}")
    if number < wire()["IDENTITY"].fields["methods"].bits and not identity.methods >> number & 1:
        names = [name for bit, name in enumerate(core.method_names) if identity.methods >> bit & 1]
        if has_friction(scene.vehicle):  # no other method can step it, so none is advised
            raise BadInput(f"{scene.path}: ground friction or a drive's limits need {core.method_names[number]}, "
                           f"the node has {', '.join(names)} alone; use another node")
        what.append(f"its method is {core.method_names[number]}, the node has {', '.join(names)}")
        options.append(f"--method {names[0] if names else '…'}")
    if what:
        raise BadInput(f"{scene.path}: {'; '.join(what)}; give {' '.join(options)}, or another node")


class RawStream:
    """A scene's inputs and outputs as raw frames."""

    def __init__(self, node: NodeClient, scene: Scene, fd: bool = False):
        self.node, self.core = node, scene.core()
        self.inputs: InputsOnGrid = scene.inputs_on_grid()
        names = {signal.partition("[")[0] for signal in self.inputs.signals}
        self.groups = [bit for bit, fields in INPUT_GROUPS.items() if names & set(fields)]
        self.has_sensors = has_sensors(scene)
        self.row_length = 6 + 2 * scene.wheel_count + self.has_sensors * (5 + scene.wheel_count)
        self.sampled = not self.inputs.is_held
        self.columns = self._columns(scene.wheel_count)
        self.fd, self.estimated = fd, is_estimated(scene)
        self._in = wire()["RAW_INPUT_FD" if fd else "RAW_INPUT"]
        self._out = "RAW_OUTPUT_FD" if fd else "RAW_OUTPUT"
        self._chunk = 60 if fd else 6
        self._sync = wire()["SYNC"]
        self._sent = 0  # frames since the last SYNC

    def _columns(self, wheel_count: int) -> np.ndarray:
        """Indices of the stream's numbers in a row of laconic_input."""
        columns: list[int] = []
        for bit in self.groups:
            for name in INPUT_GROUPS[bit]:
                start, length = self.core.input_fields[name]
                per_wheel = name in ("voltage_V", "axle_torque_Nm")
                columns += range(start, start + (wheel_count if per_wheel else length))
        return np.array(columns, dtype=int)

    def select(self) -> None:
        """Selects the numbers that go over the bus; the node sends no frame of its own but ERROR_ESTIMATE, where the
        scene lists it."""
        bits = dict.fromkeys([*self.groups, *OUTPUTS, *(RAW_OF_SENSORS if self.has_sensors else ())], 1)
        self.node.select(**bits, take_sampled=int(self.sampled and bool(self.groups)), raw_fd=int(self.fd),
                         send_error_estimate=int(self.estimated))

    def send_inputs(self, rows: np.ndarray) -> None:
        """Sends one row of laconic_input numbers; three rows (start, middle, end of a step) for sampled inputs."""
        stream = np.ascontiguousarray(np.atleast_2d(rows)[:, self.columns]).tobytes()
        link, frame, chunk = self.node.link, self._in, self._chunk
        for segment, at in enumerate(range(0, len(stream), chunk)):
            self._sent += 1
            part = stream[at : at + chunk].ljust(chunk, b"\0")
            header = (0, 0, 0, segment & 255) if self.fd else (0, (segment & 15) << 4)
            data = bytearray(header) + part
            link.send(frame, data)

    def sync(self, steps: int) -> None:
        """Makes the node take so many steps."""
        self.node.link.send(self._sync, self._sync.pack(step_count=steps, input_frames=self._sent))
        self._sent = 0

    def receive_state(self) -> np.ndarray:
        """The node's answer to a SYNC."""
        needed = self.row_length * self.core.dtype.itemsize
        stream, expected = b"", 0
        deadline_us = self.node.link.deadline_us(self.node.timeout_s)
        while len(stream) < needed:
            received = self.node.link.receive_until(deadline_us)
            if received is None:
                raise NodeSilent(f"the node does not answer a SYNC within {self.node.timeout_s:g} s; "
                                 f"{self.node.likely_cause()}")
            frame, data = received
            self.node.notice(frame, data)
            if frame.name == self._out:
                segment = data[3] if self.fd else data[1] >> 4
                if segment != expected & (255 if self.fd else 15):
                    raise NodeSilent(f"part {expected} of the node's answer is missing")
                expected += 1
                stream += data[4:] if self.fd else data[2:]
        return np.frombuffer(stream[:needed], self.core.dtype)

    def exchanges(self, steps: int, every: int) -> Iterator[tuple[int, int, np.ndarray | None]]:
        """(first step, number of steps, input rows to send or None) for a whole run; at most `every` steps each."""
        if self.sampled:
            for first in range(0, steps, 1000):
                count = min(1000, steps - first)
                samples = self.inputs.samples(first, count)
                rows = np.zeros((count, 3, self.core.input_length), self.core.dtype)
                for column, signal in enumerate(self.inputs.signals):
                    rows[:, :, self.core.input_offset(signal)] = samples[:, :, column]
                yield from ((first + k, 1, rows[k]) for k in range(count))
            return
        edges = sorted({*range(0, steps, every), *(c for c in self.inputs.changes if c < steps), steps})
        changes = {0, *self.inputs.changes}
        for begin, end in itertools.pairwise(edges):
            row = self.core.input_row(self.inputs.held_at(begin)) if begin in changes else None
            yield begin, end - begin, row


class HingedStream(RawStream):
    """Those of a scene with hinges: inputs at the start and end of each step."""

    def __init__(self, node: NodeClient, scene: Scene, twin: HingedTwin, fd: bool = False):
        self.twin = twin
        super().__init__(node, scene, fd)
        self.groups = self.groups or ["take_voltage"]
        self.of_hinges = raw_groups(twin)
        self.columns = np.array([*self._columns(scene.wheel_count), *raw_columns(twin, self.of_hinges)], dtype=int)
        self.row_length, self.has_sensors, self.sampled = len(twin.raw_row()), False, not twin.slips

    def select(self) -> None:
        """Selects the numbers that go over the bus."""
        sampled = ["take_sampled"] if self.sampled else []
        self.node.select(**dict.fromkeys([*self.groups, *self.of_hinges, *RAW_OUTPUTS, *sampled], 1),
                         raw_fd=int(self.fd))

    def exchanges(self, steps: int, every: int) -> Iterator[tuple[int, int, np.ndarray | None]]:
        """One step each, with the rows of its start and end."""
        for at, rows in enumerate(self.twin.steps(steps)):
            yield at, 1, (rows if self.sampled else rows[1]).astype(self.core.dtype)


def run_lockstep(node: NodeClient, scene: Scene, steps: int | None = None, *, every: int = 1, fd: bool = False,
                 resend: bool = False, moved: Callable[[int], None] = lambda _: None,
                 run: LockstepRun | None = None) -> LockstepRun:
    """Loads a scene and runs it with raw frames. Held inputs are sent where they change (`resend`: every time). The
    answers are put into `run`, where one is given, so that they are kept even if the run ends early."""
    run = run or LockstepRun()
    if not scene.has_hinges:
        run.twin = load_scene(node, scene)
    if steps is not None and steps > scene.steps():
        scene = scene.with_run(duration_s=steps * scene.run.step_s)
    if scene.has_hinges:
        run.hinged = HingedTwin(scene)
        load_hinged(node, run.hinged)
    stream = HingedStream(node, scene, run.hinged, fd) if run.hinged else RawStream(node, scene, fd)
    stream.select()
    node.start_lockstep()
    link = node.link
    held: np.ndarray | None = None
    frames_out, frames_in, began = link.frames_out, link.frames_in, time.perf_counter()
    try:
        for first, count, row in stream.exchanges(steps or scene.steps(), every):
            held, sent = row if row is not None else held, time.perf_counter()
            if stream.groups and held is not None and (row is not None or resend):
                stream.send_inputs(held)
            stream.sync(count)
            run.exchanges.append((first + count, stream.receive_state()))
            run.latencies_s.append(time.perf_counter() - sent)
            if run.hinged:
                run.hinged_rows.append(run.hinged.raw_row())
            moved(count)
    finally:
        run.seconds = time.perf_counter() - began
        run.frames_out, run.frames_in = link.frames_out - frames_out, link.frames_in - frames_in
    node.stop()
    return run


def twin_states(scene: Scene, run: LockstepRun) -> np.ndarray:
    """The rows of the twin at the same steps."""
    if run.steps > scene.steps():
        scene = scene.with_run(duration_s=run.steps * scene.run.step_s)
    plant, inputs, rows, done = run.twin, scene.inputs_on_grid(), [], 0
    sensors = scene.sensors_of(plant) if has_sensors(scene) else None
    recorder = Recorder(plant, ("x_m",), 0, 1, sensors=sensors) if sensors else None  # lets them see every step
    for tick in run.ticks:
        advance_plant(plant, inputs, done, int(tick) - done, recorder)
        row = plant.row()
        if sensors:
            row = np.concatenate([row, raw_row(sensors, plant.core.input(inputs.held_at(int(tick) - 1)))])
        rows.append(row)
        done = int(tick)
    return np.array(rows)


def latency_figures(seconds: Sequence[float]) -> dict[str, float]:
    """Round trips in microseconds: least, median, 99th percentile, worst, and jitter (standard deviation)."""
    if not len(seconds):
        return {}
    micro = 1e6 * np.asarray(seconds, float)
    return {
        "latency_min_us": float(micro.min()), "latency_median_us": float(np.median(micro)),
        "latency_p99_us": float(np.percentile(micro, 99)), "latency_max_us": float(micro.max()),
        "latency_jitter_us": float(micro.std())}


def period_figures(instants_s: Sequence[float], period_s: float) -> dict[str, float]:
    """Deviation of the intervals between cyclic frames from their period, in microseconds."""
    if len(instants_s) < 2:
        return {}
    off = 1e6 * (np.diff(np.asarray(instants_s, float)) - period_s)
    return {"period_us": 1e6 * period_s, "period_jitter_us": float(off.std()), "period_late_max_us": float(off.max())}
