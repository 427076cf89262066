"""--listen: a bus on a TCP port that python-can's slcan joins from another process, here from the same one."""

from __future__ import annotations

import types

import can
import pytest

from laconic.can.play import listener
from laconic.can.play.listener import ListeningBus
from laconic.can.rig.buses import open_bus
from laconic.errors import BadInput

FRAMES = [can.Message(arbitration_id=0x123, is_extended_id=False, data=[1, 2, 3]),
          can.Message(arbitration_id=0x18FF50E5, is_extended_id=True, data=b""),
          can.Message(arbitration_id=0x7FF, is_extended_id=False, is_remote_frame=True, dlc=8)]


def same(one: can.Message, other: can.Message) -> bool:
    """Whether two frames are the same on a bus."""
    return one.equals(other, timestamp_delta=None, check_channel=False, check_direction=False)


def test_every_kind_of_frame_passes_in_both_directions() -> None:
    with ListeningBus(0) as bus, open_bus("slcan", f"socket://127.0.0.1:{bus.port}") as client:
        assert bus.recv(0.05) is None  # the client opens its channel
        for frame in FRAMES:
            bus.send(frame)
            client.send(frame)
        assert all(same(bus.recv(1.0), frame) for frame in FRAMES)
        assert all(same(client.recv(1.0), frame) for frame in FRAMES)


def test_clients_of_one_port_hear_each_other_as_stations_of_a_bus_do() -> None:
    with ListeningBus(0) as bus, open_bus("slcan", f"socket://127.0.0.1:{bus.port}") as one, \
            open_bus("slcan", f"socket://127.0.0.1:{bus.port}") as other:
        assert bus.recv(0.05) is None
        one.send(FRAMES[0])
        assert same(bus.recv(1.0), FRAMES[0])
        assert same(other.recv(1.0), FRAMES[0])


def test_a_client_that_leaves_and_comes_back_finds_the_bus_as_before() -> None:
    with ListeningBus(0) as bus:
        for _ in range(2):
            with open_bus("slcan", f"socket://127.0.0.1:{bus.port}") as client:
                client.send(FRAMES[0])
                assert same(bus.recv(1.0), FRAMES[0])
            assert bus.recv(0.05) is None
            bus.send(FRAMES[0])  # nobody hears it
        assert bus.joined == 2


def test_a_client_too_many_that_has_gone_again_does_not_end_the_bus(monkeypatch: pytest.MonkeyPatch) -> None:
    class Gone:
        closed = False

        def send(self, _: bytes) -> int:
            raise ConnectionResetError

        def close(self) -> None:
            self.closed = True

    monkeypatch.setattr(listener, "MOST_CLIENTS", 0)
    with ListeningBus(0) as bus:
        gone = Gone()
        own = bus._listener
        bus._listener = types.SimpleNamespace(accept=lambda: (gone, None))  # type: ignore[assignment]
        bus._joins()
        bus._listener = own
        assert gone.closed and bus.joined == 0


def test_a_port_that_is_taken_or_none_is_refused_in_one_line() -> None:
    with ListeningBus(0) as bus, pytest.raises(BadInput, match=f"--listen {bus.port}: cannot listen there"):
        ListeningBus(bus.port)
    with pytest.raises(BadInput, match="--listen 70000: no TCP port"):
        ListeningBus(70000)


def test_a_program_that_does_not_read_gets_no_old_frames_and_its_lost_ones_are_counted() -> None:
    """Frames count up, so that each tells its age: what waits for a program is less than a second of a full bus."""
    count, a_second = 60_000, 9_000
    with ListeningBus(0) as bus, open_bus("slcan", f"socket://127.0.0.1:{bus.port}") as client:
        assert bus.recv(0.05) is None
        for number in range(count):
            bus.send(can.Message(arbitration_id=0x201, is_extended_id=False, data=number.to_bytes(8, "big")))
        lost, longest_s = bus.not_taken()
        assert lost >= count - a_second and 0.0 < longest_s < 60.0
        heard = [int.from_bytes(message.data, "big") for message in iter(lambda: client.recv(0.05), None)]
        assert 0 < len(heard) <= a_second
        bus.recv(0.0)
        bus.send(FRAMES[0])
        rest = list(iter(lambda: client.recv(0.05), None))
        assert len(heard) + lost + len(rest) == count + 1 and same(rest[-1], FRAMES[0])  # the way is free again
    assert bus.not_taken()[0] == lost
