"""The fault matrix: every fault × every frame, in virtual time, with what the node and the rig did then.

Each case runs one script (open, load, scaled lockstep, raw lockstep, free run, stop) over a `faulty` bus whose
fault hits one kind of frame; then the rig falls silent for a while, the fault ends, and a fresh rig takes over. Watched
all the time: that no changed frame is accepted on either side, that the node's voltages are some that were sent or
zero, that it moves only while it runs. What remains undetected is counted.
"""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import can
import numpy as np

from laconic.can.rig.buses import NodeOnBus, VirtualClock, paired_buses
from laconic.can.rig.client import NodeClient
from laconic.can.rig.faults import Faults
from laconic.can.rig.faulty import FaultyBus
from laconic.can.rig.link import Link, Received
from laconic.can.rig.lockstep import RawStream, load_scene, run_lockstep, twin_states
from laconic.can.rig.node_library import LibraryNode
from laconic.can.rig.scaled import Voltages, await_answers, groups_of
from laconic.can.rig.wire import ID_BASE, wire
from laconic.errors import LaconicError
from laconic.scene import Scene, read_scene


@dataclass
class Row:
    """One case."""

    fault: str
    frame: str
    injected: int = 0
    undetected: int = 0                     # changed or doubled frames that were accepted
    detected_by: Counter[str] = field(default_factory=Counter)
    detection_ms: float | None = None       # from the first fault to the first sign of it
    stage: str = "open"
    state: str = ""
    problems: list[str] = field(default_factory=list)

    @property
    def good(self) -> bool:
        """Nothing that must not happen has happened."""
        return not self.problems


Multiset = Counter[tuple[int, bytes]]  # frames, with how often they were sent and not yet taken


class WatchedLink(Link):
    """A link that records the frames of the node and its own."""

    def __init__(self, *arguments: Any, row: Row, sent: Multiset, node_sent: Multiset, **options: Any):
        super().__init__(*arguments, **options)
        self.sent, self.node_sent = sent, node_sent
        self.row = row

    def send_message(self, message: can.Message) -> None:
        self.sent[message.arbitration_id, bytes(message.data)] += 1
        super().send_message(message)

    def take(self, message: can.Message) -> Received | None:
        before = sum(self.faults.values())
        received = super().take(message)
        key = (message.arbitration_id, bytes(message.data))
        if received is not None:
            self.row.undetected += self.node_sent[key] <= 0
            self.node_sent[key] -= 1
        if sum(self.faults.values()) > before:
            self.row.detected_by["rig"] += 1
        return received


class WatchedNode(NodeOnBus):
    """The node's end; checks the invariants after every frame."""

    def __init__(self, node: LibraryNode, bus: can.BusABC, clock: VirtualClock, row: Row):
        super().__init__(node, bus, clock)
        self.row = row
        self.rig_sent: Multiset = Counter()
        self.sent: Multiset = Counter()
        self.allowed_V: set[float] = {0.0}
        self.view = node.inspect()
        self.snapshot = node.snapshot()  # of that view

    def deliver(self, message: can.Message) -> None:
        before = self.node.inspect()
        super().deliver(message)
        after = self.node.inspect()
        key = (message.arbitration_id, bytes(message.data))
        if after["accepted"] > before["accepted"]:
            self.row.undetected += self.rig_sent[key] <= 0
            self.rig_sent[key] -= self.takes_once(message)
        for name in ("crc_errors", "sequence_errors", "repeated", "lost", "malformed", "refused"):
            if after[name] > before[name]:
                self.row.detected_by[name] += after[name] - before[name]
        self.refresh()

    @staticmethod
    def takes_once(message: can.Message) -> bool:
        """HELLO changes no state, so the contract allows duplicates; a corrupted HELLO is refused as any frame."""
        return message.arbitration_id != ID_BASE + wire()["HELLO"].offset

    def sent_frame(self, message: can.Message) -> None:
        self.sent[message.arbitration_id, bytes(message.data)] += 1
        super().sent_frame(message)

    def pump(self) -> bool:
        busy = super().pump()
        self.refresh()
        return busy

    def refresh(self) -> None:
        """The invariants, where anything differs from the last time."""
        snapshot = self.node.snapshot()
        if snapshot == self.snapshot:
            return
        self.snapshot = snapshot
        view, before = self.node.inspect(), self.view
        strange = [v for v in view["voltage_V"] if v not in self.allowed_V]
        if strange:
            self.row.problems.append(f"voltage {strange[0]} was never sent")
        if view["state"] in ("empty", "ready", "timeout", "fault") and any(view["voltage_V"]):
            self.row.problems.append(f"voltage in state {view['state']}")
        stands = view["state"] == before["state"] and view["state"] in ("empty", "ready", "fault")
        if stands and view["steps"] > before["steps"]:
            self.row.problems.append(f"stepped in state {view['state']}")
        if view["state"] == "timeout" and before["state"] == "free run":
            self.row.detected_by["timeout"] += 1
        self.view = view


SCENE = "s1"
WATCHDOG_MS = 50
SILENCE_S = 0.3
PATIENCE_S = 0.6
PERIODS = 40  # of 10 ms in free run

FAULTS: dict[str, dict[str, Any]] = {
    "loss": {"loss": 0.3}, "duplication": {"duplication": 0.3}, "reordering": {"reordering": 0.3},
    "delay": {"delay_s": 0.03}, "jitter": {"jitter_s": 0.03}, "one bit": {"corruption": 0.3, "corrupted_bits": 1},
    "two bits": {"corruption": 0.3, "corrupted_bits": 2}, "three bits": {"corruption": 0.3, "corrupted_bits": 3},
    "stuck payload": {"stuck": 0.2}, "wrong length": {"wrong_length": 0.3}, "foreign frames": {"foreign": 0.5},
    "babbling node": {"babble_per_s": 3000.0, "bitrate": 500_000},
    "bus-off": {"bus_off_after": 3, "bus_off_s": 0.2}, "bus-off for ever": {"bus_off_after": 3},
    "stale queue": {"bus_off_after": 3, "bus_off_s": 0.2, "keep_queue": True}, "slow bus": {"bitrate": 10_000}}

WHOLE_BUS = ("babbling node", "slow bus")
ALL_CLASSIC, ALL_FD = "all classic", "all FD"

# Where the script broke off → the states that the node may be in after the silence. A command whose answer got lost
# may have been carried out or not; a free run without commands must have timed out.
EXPECTED = {
    "open": {"empty"}, "load": {"empty", "ready"}, "select": {"ready"}, "start": {"ready", "lockstep"},
    "lockstep": {"lockstep"}, "stop": {"lockstep", "ready"}, "start free run": {"ready", "timeout"},
    "free run": {"timeout"}, "stop free run": {"timeout", "ready"}, "done": {"ready"}}


@dataclass
class Case:
    """Everything of one run."""

    row: Row
    clock: VirtualClock
    bus: FaultyBus
    node: WatchedNode
    scene: Scene
    random: random.Random  # for session numbers

    def client(self) -> NodeClient:
        """A fresh rig."""
        link = WatchedLink(self.bus, clock=self.clock, pump=self.pump, row=self.row, sent=self.node.rig_sent,
                           node_sent=self.node.sent)
        return NodeClient(link, PATIENCE_S, random_bits=self.random.getrandbits)

    def pump(self) -> bool:
        """The node works; the time of the first sign of the fault is noted."""
        busy = self.node.pump()
        row, first = self.row, self.bus.model.first_injection_s
        if row.detection_ms is None and first is not None and row.detected_by:
            row.detection_ms = 1e3 * (self.bus.now_s() - first)
        return busy


@contextmanager
def faulty_node(faults: Faults, row: Row, scene: Scene) -> Iterator[Case]:
    """A node behind a faulty bus, in virtual time."""
    clock = VirtualClock()
    with paired_buses() as (inner, its), FaultyBus(inner=inner, clock=lambda: clock.time_us / 1e6,
                                                   **vars(faults)) as bus:
        node = WatchedNode(LibraryNode(scene.run.real), its, clock, row)
        node.allowed_V |= {float(v) for v in marker_voltages(scene).values()}
        yield Case(row, clock, bus, node, scene, random.Random(faults.seed))


def marker_voltages(scene: Scene) -> dict[str, float]:
    """A different one for each wheel, none of which any other frame holds by chance."""
    return {f"voltage_V[{i}]": 0.5 * i for i in range(1, scene.wheel_count + 1)}


def frames_of(fd: bool) -> list[str]:
    """The frames of the contract that a script uses."""
    classic = [frame.name for frame in wire().frames.values() if not frame.fd]
    return [frame.name for frame in wire().frames.values() if frame.fd] if fd else classic


def frames_for(fault: str) -> list[str]:
    """What a fault is tried on: each frame by itself, or all at once where it is the bus that fails."""
    return [ALL_CLASSIC, ALL_FD] if fault in WHOLE_BUS else [*frames_of(False), *frames_of(True)]


def run_case(fault: str, frame: str, seed: int) -> Row:
    """One fault on one frame."""
    scene, row = read_scene(SCENE), Row(fault, frame)
    whole_bus = frame not in wire().frames
    only_id = -1 if whole_bus else ID_BASE + wire()[frame].offset
    fd = frame == ALL_FD if whole_bus else wire()[frame].fd
    faults = Faults(**FAULTS[fault], only_id=only_id, seed=seed)
    with faulty_node(faults, row, scene) as case:
        client = case.client()
        try:
            script(client, case, fd)
        except LaconicError as error:
            row.detected_by["rig"] += 1
            row.problems += [] if case.bus.model.injected else [f"without a fault: {error}"]
            case.pump()
        listen(case, client, SILENCE_S)
        row.injected, row.state = case.bus.model.injected, case.node.node.inspect()["state"]
        if row.state not in EXPECTED[row.stage]:
            row.problems.append(f"state {row.state} after {row.stage}")
        case.bus.model.active = False
        recover(case)
    return row


def script(client: NodeClient, case: Case, fd: bool) -> None:
    """The whole script of one rig."""
    row, scene = case.row, case.scene
    volts = marker_voltages(scene)
    client.open()
    row.stage = "load"
    load_scene(client, scene)
    row.stage = "select"
    client.select(send_nu=1, send_pose=1, send_wheel_speed=1, send_counters=1, send_state_fd=int(fd))
    row.stage = "start"
    client.start_lockstep()
    row.stage = "lockstep"
    voltages = Voltages(client, scene)
    for _ in range(12):
        voltages.send(volts, sync=True)
        await_answers(client, 2 + groups_of(scene.wheel_count) + fd)
    row.stage = "stop"
    client.stop()
    raw_part(client, case, fd)
    row.stage = "select"
    client.select(send_nu=1, send_pose=1, send_wheel_speed=1, send_counters=1, send_state_fd=int(fd))
    row.stage = "start free run"
    client.start_free_run(100, WATCHDOG_MS)
    row.stage = "free run"
    free_run_part(client, case, fd)
    row.stage = "stop free run"
    client.stop()
    row.stage = "done"


def raw_part(client: NodeClient, case: Case, fd: bool) -> None:
    """Some exchanges with raw frames."""
    row = case.row
    stream = RawStream(client, case.scene, fd)
    row.stage = "select"
    stream.select()
    row.stage = "start"
    client.start_lockstep()
    row.stage = "lockstep"
    inputs = stream.core.input_row(marker_voltages(case.scene))
    for _ in range(8):
        stream.send_inputs(inputs)
        stream.sync(2)
        stream.receive_state()
    row.stage = "stop"
    client.stop()


def free_run_part(client: NodeClient, case: Case, fd: bool) -> None:
    """Voltages every 10 ms while the node runs by its own clock."""
    voltages, frame = Voltages(client, case.scene), wire()["VOLTAGE_FD"]
    volts = marker_voltages(case.scene)
    for _ in range(PERIODS):
        if fd:
            raws = {f"voltage_{i}": round(500 * i) for i in range(1, case.scene.wheel_count + 1)}
            client.link.send(frame, frame.pack(**raws))
        else:
            voltages.send(volts)
        listen(case, client, 0.01)


def listen(case: Case, client: NodeClient, seconds: float) -> None:
    """Receives all frames for a given time."""
    end_us = case.clock.time_us + int(1e6 * seconds)
    while case.clock.time_us < end_us:
        client.link.receive((end_us - case.clock.time_us) / 1e6)


def recover(case: Case) -> None:
    """A fresh rig on a healthy bus: open, load, and the bits of the core again."""
    try:
        client = case.client()
        client.timeout_s = 1.0
        listen(case, client, 0.05)
        client.open()
        case.node.allowed_V |= {float(v) for each in case.scene.inputs for v in each.value}
        case.node.allowed_V |= {-v for v in case.node.allowed_V}
        run = run_lockstep(client, case.scene, 10)
        if run.states.tobytes() != twin_states(case.scene, run).tobytes():
            case.row.problems.append("other bits after recovery")
    except LaconicError as error:
        case.row.problems.append(f"no recovery: {error}")


def run_matrix(seed: int, faults: tuple[str, ...] = tuple(FAULTS)) -> Iterator[Row]:
    """All cases; each has a seed of its own, drawn from this one."""
    source = random.Random(seed)
    for fault in faults:
        for frame in frames_for(fault):
            yield run_case(fault, frame, source.randrange(2**31))


def summary(rows: list[Row]) -> list[tuple[str, int, int, int, float, float]]:
    """Per fault: cases, faults injected, undetected, and detection latency in ms (median, worst)."""
    lines = []
    for fault in dict.fromkeys(row.fault for row in rows):
        mine = [row for row in rows if row.fault == fault]
        latencies = [row.detection_ms for row in mine if row.detection_ms is not None] or [float("nan")]
        lines.append((fault, len(mine), sum(row.injected for row in mine), sum(row.undetected for row in mine),
                      float(np.median(latencies)), float(np.max(latencies))))
    return lines
