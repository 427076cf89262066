"""Deliberate faults: the plug-in makes the faults it is given, the whole matrix holds, known field bugs stay out."""

from __future__ import annotations

import random
from collections.abc import Iterator
from contextlib import contextmanager

import can
import pytest

from fault_matrix import FAULTS, WHOLE_BUS, Row, frames_for, run_case, run_matrix, summary
from laconic.can.rig.buses import NodeOnBus, VirtualClock
from laconic.can.rig.client import NodeClient
from laconic.can.rig.faulty import FaultyBus
from laconic.can.rig.link import Link
from laconic.can.rig.lockstep import load_scene, run_lockstep, twin_states
from laconic.can.rig.node_library import LibraryNode
from laconic.can.rig.scaled import Voltages
from laconic.can.rig.wire import ID_BASE, wire
from laconic.scene import read_scene
from play_support import next_channel

FIXED_SEED = 20111125


def some_cases(share: int) -> Iterator[Row]:
    """One case in so many of the matrix, at least one of each fault, and all of the faults of a whole bus."""
    source = random.Random(FIXED_SEED)
    for number, fault in enumerate(FAULTS):
        frames = list(frames_for(fault))
        for frame in frames if fault in WHOLE_BUS else frames[number % share::share]:
            yield run_case(fault, frame, source.randrange(2**31))


@pytest.mark.parametrize("seed, share", [(FIXED_SEED, 7), *(pytest.param(seed, 1, marks=pytest.mark.nightly)
                                                            for seed in (FIXED_SEED, None))],
                         ids=["one case in seven", "all cases", "random seed"])
def test_the_fault_matrix_holds(seed: int | None, share: int, capsys: pytest.CaptureFixture[str]) -> None:
    seed = random.SystemRandom().randrange(2**31) if seed is None else seed
    rows = list(run_matrix(seed) if share == 1 else some_cases(share))
    with capsys.disabled():
        print(f"\n  fault matrix, seed {seed}: {len(rows)} cases")
        for fault, cases, injected, undetected, median, worst in summary(rows):
            print(f"  {fault:17s} {cases:3d} cases {injected:5d} faults {undetected} undetected, "
                  f"first sign after {median:.0f} ms (worst {worst:.0f} ms)")
    assert [row for row in rows if not row.good] == []
    assert sum(row.undetected for row in rows) == 0
    assert {row.fault for row in rows if row.injected} == set(FAULTS)


def test_a_case_is_the_same_every_time_with_the_same_seed() -> None:
    first, second = (run_case("jitter", "VOLTAGE", 5) for _ in range(2))
    assert first == second and first.injected > 0


def bus_pair(**faults: object) -> tuple[FaultyBus, can.BusABC, VirtualClock]:
    """A faulty bus, a healthy one at the other end, and their clock."""
    clock, channel = VirtualClock(), next_channel()
    far = can.Bus(interface="virtual", channel=channel)
    near = can.Bus(interface="faulty", channel=channel, under="virtual", clock=lambda: clock.time_us / 1e6, **faults)
    return near, far, clock


def arrivals(near: FaultyBus, far: can.BusABC, clock: VirtualClock, count: int = 200) -> list[can.Message]:
    """What comes out when frames 0, 1, 2 … go in, one a millisecond."""
    found = []
    for k in range(count):
        near.send(can.Message(arbitration_id=0x100 + k % 3, is_extended_id=False, data=[k, k, k, k]))
        clock.time_us += 1000
        near.move()
        while (message := far.recv(0)) is not None:
            found.append(message)
    near.shutdown()
    far.shutdown()
    return found


def test_faulty_is_a_plug_in_that_python_can_finds_by_name() -> None:
    near, far, clock = bus_pair()
    assert isinstance(near, FaultyBus)
    assert [m.data[0] for m in arrivals(near, far, clock)] == list(range(200))


@pytest.mark.parametrize("fault, holds", [
    ({"loss": 0.5}, lambda got: 50 < len(got) < 150),
    ({"duplication": 1.0}, lambda got: len(got) == 400),
    ({"reordering": 1.0}, lambda got: [m.data[0] for m in got[:4]] == [1, 0, 3, 2]),
    ({"delay_s": 0.0105}, lambda got: len(got) == 190),
    ({"corruption": 1.0, "corrupted_bits": 2}, lambda got: all(
        sum(bin(a ^ b).count("1") for a, b in zip(m.data, [k] * 4, strict=True)) == 2 for k, m in enumerate(got))),
    ({"stuck": 1.0}, lambda got: {m.data[0] for m in got} == {0, 1, 2}),
    ({"wrong_length": 1.0}, lambda got: all(len(m.data) == 3 for m in got)),
    ({"foreign": 1.0}, lambda got: len(got) == 400),
    ({"babble_per_s": 2000.0}, lambda got: sum(m.arbitration_id == 0 for m in got) > 350),
    ({"bus_off_after": 10, "bus_off_s": 0.05}, lambda got: 145 < len(got) < 155),
    ({"bus_off_after": 10}, lambda got: len(got) == 10),
    ({"bus_off_after": 10, "bus_off_s": 0.05, "keep_queue": True}, lambda got: len(got) == 200),
    ({"bitrate": 50_000}, lambda got: 70 < len(got) < 110),
    ({"loss": 1.0, "only_id": 0x101}, lambda got: {m.arbitration_id for m in got} == {0x100, 0x102}),
    ({"loss": 1.0, "direction": "in"}, lambda got: len(got) == 200)])
def test_each_fault_does_what_its_name_states(fault: dict[str, object], holds: object) -> None:
    assert holds(arrivals(*bus_pair(seed=3, **fault)))


def test_on_a_busy_wire_the_lowest_identifier_goes_first() -> None:
    near, far, clock = bus_pair(bitrate=100_000)
    for identifier in (0x300, 0x200, 0x100):
        near.send(can.Message(arbitration_id=identifier, is_extended_id=False, data=bytes(8)))
    clock.time_us += 10_000
    near.move()
    # the first finds the wire free; of the two that wait, the lower one is next
    assert [far.recv(0).arbitration_id for _ in range(3)] == [0x300, 0x100, 0x200]
    near.shutdown()
    far.shutdown()


def test_an_option_of_no_use_is_refused_by_name() -> None:
    with pytest.raises(can.CanInitializationError, match="loss=often"):
        can.Bus(interface="faulty", channel="x", under="virtual", loss="often")
    with pytest.raises(can.CanInitializationError, match="probability"):
        can.Bus(interface="faulty", channel="x", under="virtual", loss=2)


# ---- field bugs


@contextmanager
def free_running(watchdog_ms: int = 50, **faults: object) -> Iterator[tuple[NodeClient, NodeOnBus, FaultyBus]]:
    """A node in free run at 100 Hz behind a bus whose faults begin later."""
    near, far, clock = bus_pair(**faults)
    end = NodeOnBus(LibraryNode("double"), far, clock)
    client = NodeClient(Link(near, clock=clock, pump=end.pump), timeout_s=0.3)
    near.model.active = False
    load_scene(client, read_scene("s1"))
    client.select(send_counters=1)
    client.start_free_run(100, watchdog_ms)
    near.model.active = True
    yield client, end, near
    near.shutdown()
    far.shutdown()


def drive(client: NodeClient, volts: float, seconds: float) -> None:
    """Voltages every 10 ms."""
    voltages = Voltages(client, read_scene("s1"))
    end_us = client.link.clock.now_us() + int(1e6 * seconds)
    while client.link.clock.now_us() < end_us:
        voltages.send({f"voltage_V[{i}]": volts for i in (1, 2, 3)})
        next_us = client.link.deadline_us(0.01)
        while client.link.receive_until(next_us) is not None:
            pass


def test_stale_queue_voltages_that_waited_through_an_emergency_stop_do_not_move_the_vehicle() -> None:
    with free_running(watchdog_ms=0) as (client, end, near):
        drive(client, 2.0, 0.1)
        stale = []
        send, client.link.send_message = client.link.send_message, stale.append
        Voltages(client, read_scene("s1")).send({"voltage_V[1]": 9.0})  # stuck in the adapter's queue
        client.link.send_message = send
        client.stop()
        for message in stale:
            near.send(message)
        drive_nothing(client, 0.05)
        assert end.node.inspect()["voltage_V"] == [0.0, 0.0, 0.0] and end.node.inspect()["state"] == "ready"
        client.start_free_run(100, 0)
        before = end.node.inspect()["crc_errors"]
        for message in stale:
            near.send(message)
        drive_nothing(client, 0.05)
        assert end.node.inspect()["voltage_V"] == [0.0, 0.0, 0.0]
        assert end.node.inspect()["crc_errors"] == before + len(stale)


def drive_nothing(client: NodeClient, seconds: float) -> None:
    """Time passes, frames of the node are taken."""
    end_us = client.link.deadline_us(seconds)
    while client.link.receive_until(end_us) is not None:
        pass


def test_a_stale_start_does_not_start_the_vehicle_again() -> None:
    with free_running() as (client, end, near):
        recorded: list[can.Message] = []
        client.link.listeners.append(recorded.append)
        client.stop()
        client.start_free_run(100, 50)
        client.stop()
        for message in recorded:  # STOP, START and STOP of before
            near.send(message)
            drive_nothing(client, 0.01)
            assert end.node.inspect()["state"] == "ready"


def test_counter_rewind_a_rejected_burst_does_not_open_the_door_for_what_follows_it() -> None:
    with free_running(watchdog_ms=0) as (client, end, near):
        recorded: list[can.Message] = []
        client.link.listeners.append(lambda m: recorded.append(m) if m.arbitration_id == ID_BASE + VOLTAGE else None)
        drive(client, 2.0, 0.08)
        drive(client, 1.0, 0.05)
        for message in recorded[1:5]:
            near.send(message)
        drive_nothing(client, 0.001)
        assert end.node.inspect()["voltage_V"] == [1.0, 1.0, 1.0]
        before = end.node.inspect()
        drive(client, 1.5, 0.02)  # the first is for reference
        assert end.node.inspect()["voltage_V"] == [1.5, 1.5, 1.5]
        assert end.node.inspect()["sequence_errors"] == before["sequence_errors"]


VOLTAGE = wire()["VOLTAGE"].offset


def test_invalid_frames_do_not_feed_the_watchdog() -> None:
    for fault in ({"corruption": 1.0}, {"stuck": 1.0}, {"wrong_length": 1.0}):
        with free_running(only_id=ID_BASE + VOLTAGE, direction="out", **fault) as (client, end, near):
            drive(client, 2.0, 0.2)
            view = end.node.inspect()
            assert view["state"] == "timeout" and view["voltage_V"] == [0.0, 0.0, 0.0], fault


def test_timeout_is_latched_until_stop_and_start() -> None:
    with free_running() as (client, end, near):
        drive(client, 2.0, 0.1)
        drive_nothing(client, 0.1)
        assert end.node.inspect()["state"] == "timeout"
        drive(client, 2.0, 0.1)
        assert end.node.inspect()["state"] == "timeout" and end.node.inspect()["voltage_V"] == [0.0, 0.0, 0.0]
        client.stop()
        client.start_free_run(100, 50)
        drive(client, 2.0, 0.1)
        assert end.node.inspect()["state"] == "free run" and end.node.inspect()["voltage_V"] == [2.0, 2.0, 2.0]


def test_bus_off_stops_the_vehicle_and_recovers() -> None:
    with free_running(bus_off_after=30, bus_off_s=0.3) as (client, end, near):
        drive(client, 2.0, 0.5)
        assert end.node.inspect()["state"] == "timeout"
        client.stop()
        scene = read_scene("s1")
        run = run_lockstep(client, scene, 20)
        assert run.states.tobytes() == twin_states(scene, run).tobytes()
