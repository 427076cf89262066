"""Commands are sent until they are answered, act once, and a node is found again in whatever state it is."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from random import Random

import can
import pytest

from laconic.can.rig.buses import NodeOnBus, VirtualClock, paired_buses
from laconic.can.rig.client import REPEAT_S, NodeClient
from laconic.can.rig.errors import CannotReach, NodeRefused, NodeSilent
from laconic.can.rig.link import Link
from laconic.can.rig.lockstep import load_scene, run_lockstep, twin_states
from laconic.can.rig.node_library import LibraryNode
from laconic.can.rig.wire import ID_BASE, wire
from laconic.scene import read_scene

SCENE = read_scene("turtlebot3_burger")
Lost = Callable[[str, int], bool]  # (frame, how many of it have come before) → it is lost


class LossyNode(NodeOnBus):
    """Loses chosen frames on their way to the node and from it, and counts all."""

    def __init__(self, node: LibraryNode, bus: can.BusABC, clock: VirtualClock):
        super().__init__(node, bus, clock)
        self.lost: Lost = lambda name, count: False
        self.seen: dict[str, int] = {}

    def passes(self, message: can.Message) -> bool:
        name = wire().by_offset[message.arbitration_id - ID_BASE].name
        count = self.seen[name] = self.seen.get(name, -1) + 1
        return not self.lost(name, count)

    def deliver(self, message: can.Message) -> None:
        if self.passes(message):
            super().deliver(message)

    def sent_frame(self, message: can.Message) -> None:
        if self.passes(message):
            super().sent_frame(message)


@contextmanager
def lossy(timeout_s: float = 1.0) -> Iterator[tuple[NodeClient, LossyNode]]:
    """A client and a node with a wire between them that may lose what a test chooses."""
    clock = VirtualClock()
    with paired_buses() as (ours, its):
        end = LossyNode(LibraryNode("double"), its, clock)
        yield NodeClient(Link(ours, clock=clock, pump=end.pump), timeout_s), end


def life(client: NodeClient) -> None:
    """Open, load, select, start, stop."""
    client.open()
    load_scene(client, SCENE)
    client.select(send_nu=1)
    client.start_lockstep()
    client.stop()


def frames_of_a_life() -> dict[str, int]:
    """How many of each kind go over the wire when nothing is lost."""
    with lossy() as (client, end):
        life(client)
    return {name: count + 1 for name, count in end.seen.items()}


ORDINARY = frames_of_a_life()


@pytest.mark.parametrize("name", ["HELLO", "OPEN", "CONTROL", "PARAMETER", "COMMIT", "SELECT", "RESULT", "CHALLENGE",
                                  "IDENTITY"])
def test_a_frame_lost_at_any_position_is_sent_again_and_acts_once(name: str) -> None:
    for position in range(ORDINARY[name]):
        with lossy() as (client, end):
            end.lost = lambda kind, count, position=position: (kind, count) == (name, position)
            life(client)
            assert end.seen[name] >= ORDINARY[name], position  # once more, whatever it was
            end.lost = lambda kind, count: False
            run = run_lockstep(client, SCENE, 3)
            assert run.states.tobytes() == twin_states(SCENE, run).tobytes(), position


def test_a_lost_answer_costs_one_repetition_and_no_more() -> None:
    with lossy() as (client, end):
        life(client)
        position = end.seen["RESULT"] + 1
        end.lost = lambda kind, count: (kind, count) == ("RESULT", position)
        began_us = client.link.clock.now_us()
        client.start_lockstep()
        assert REPEAT_S * 1e6 <= client.link.clock.now_us() - began_us < 1.5 * REPEAT_S * 1e6


def test_every_third_frame_lost_costs_time_and_nothing_else() -> None:
    with lossy(timeout_s=10.0) as (client, end):
        chance = Random(5)  # not hash(), which Python seeds anew in each process
        end.lost = lambda kind, count: kind != "HEARTBEAT" and chance.random() < 1 / 3
        life(client)
        assert client.state == "ready" and end.node.inspect()["repeated"] > 10


def test_a_command_that_is_never_answered_ends_in_one_line_and_the_next_one_begins_anew() -> None:
    with lossy() as (client, end):
        life(client)
        began_us = client.link.clock.now_us()
        end.lost = lambda kind, count: kind == "RESULT"
        with pytest.raises(NodeSilent, match="does not answer start lockstep within 1 s"):
            client.start_lockstep()
        assert client.link.clock.now_us() - began_us < 1.2e6
        assert end.node.inspect()["state"] == "lockstep"  # it was heard
        end.lost = lambda kind, count: False
        client.stop()
        assert end.node.inspect()["state"] == "ready"
        run = run_lockstep(client, SCENE, 3)
        assert run.states.tobytes() == twin_states(SCENE, run).tobytes()


@pytest.mark.parametrize("state", ["empty", "ready", "lockstep", "free run", "timeout"])
def test_a_fresh_rig_finds_the_node_in_any_state_and_stops_it(state: str) -> None:
    with lossy() as (client, end):
        if state != "empty":
            life(client)
        if state == "lockstep":
            client.start_lockstep()
        elif state in ("free run", "timeout"):
            client.start_free_run(watchdog_ms=50 if state == "timeout" else 0)
            client.link.receive(0.2)
            while client.link.receive(0.2) is not None and end.node.inspect()["state"] != state:
                pass
        fresh = NodeClient(Link(client.link.bus, clock=client.link.clock, pump=client.link.pump))
        fresh.stop()
        assert fresh.found == state and end.node.inspect()["state"] == ("empty" if state == "empty" else "ready")
        fresh.stop()
        run = run_lockstep(fresh, SCENE, 3)
        assert run.states.tobytes() == twin_states(SCENE, run).tobytes()


def test_a_rig_of_before_is_not_heard_any_more() -> None:
    with lossy() as (first, end):
        numbers = Random(3).getrandbits  # of sessions: of some pairs the check sums are the same
        link = first.link
        old, fresh = (NodeClient(Link(link.bus, clock=link.clock, pump=link.pump), random_bits=numbers)
                      for _ in range(2))
        life(old)
        life(fresh)
        fresh.start_free_run(watchdog_ms=0)
        number = wire().number("CONTROL", "command", "STOP")
        data = wire()["CONTROL"].pack(command=number)
        old.link.session.protect(wire()["CONTROL"], data)
        old.link.send_message(old.link.message(wire()["CONTROL"], data))
        old.link.receive(0.01)
        assert end.node.inspect()["state"] == "free run" and end.node.inspect()["crc_errors"] == 1


def test_the_rig_speaks_only_after_a_sign_of_life() -> None:
    with lossy() as (client, end):
        end.lost = lambda kind, count: kind == "HEARTBEAT"
        with pytest.raises(CannotReach, match="no frame of a node comes at ID base 0x680 within 1 s"):
            client.open()
        assert "HELLO" not in end.seen
        end.lost = lambda kind, count: False
        client.open()
        assert client.state == "empty"


class SlowNode(LossyNode):
    """Its answers take longer than the rig waits before it repeats."""

    delay_us = 0

    def __init__(self, node: LibraryNode, bus: can.BusABC, clock: VirtualClock):
        super().__init__(node, bus, clock)
        self.held: list[tuple[int, can.Message]] = []

    def sent_frame(self, message: can.Message) -> None:
        self.held.append((self.clock.time_us + self.delay_us, message))

    def pump(self) -> bool:
        while self.held and self.held[0][0] <= self.clock.time_us:
            super().sent_frame(self.held.pop(0)[1])
        return super().pump()


def test_a_late_answer_is_not_taken_for_that_to_the_next_command() -> None:
    clock = VirtualClock()
    with paired_buses() as (ours, its):
        end = SlowNode(LibraryNode("double"), its, clock)
        client = NodeClient(Link(ours, clock=clock, pump=end.pump))
        client.open()
        end.delay_us = int(2.5e6 * REPEAT_S)
        for _ in range(20):  # each answer comes three times
            assert client.control("BEGIN")["status"] == 0
            with pytest.raises(NodeRefused, match="refuses reset: wrong state"):
                client.reset()
        assert end.node.inspect()["repeated"] >= 60
