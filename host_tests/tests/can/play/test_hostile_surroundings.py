"""What surrounds a run goes wrong: full disks, faults that no bus has, clients that die. One line, or it goes on."""

from __future__ import annotations

import gc
import json
import os
import socket
import struct
import types
from pathlib import Path

import can
import pytest

from laconic.can.play import listener
from laconic.can.play.listener import ListeningBus
from laconic.can.rig.buses import open_bus
from laconic.can.rig.logs import open_log
from laconic.cli.main import run
from laconic.errors import BadInput, LaconicError
from play_support import DBC, PLAY, currents, played


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="only Linux has a device that is always full")
@pytest.mark.parametrize("kind", ["asc", "blf"])
def test_a_log_on_a_full_disk_is_named(kind: str, tmp_path: Path) -> None:
    path = tmp_path / f"full.{kind}"
    path.symlink_to("/dev/full")
    try:
        errors = played("robotino2", 0.2, lambda _: [currents(0.2, 0.2, 0.2)], drives="robomaster",
                        logs=(path,))[0].unwritten
    except BadInput as error:  # when it is opened
        errors = [error]
    line, = map(str, errors)
    assert f"full.{kind}: cannot be written (no space left on device)" in line


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="only Linux has a device that is always full")
def test_a_run_whose_files_could_not_be_written_prints_its_verdicts_all_the_same(
        tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = tmp_path / "full.blf"
    log.symlink_to("/dev/full")
    assert run(["play", "canopen_agv", "--listen", "0", "--duration", "0.05", "--junit", "/dev/full",
                "--log", str(log), "--json"]) == 2
    printed = capsys.readouterr()
    assert {each["name"]: each["passed"] for each in json.loads(printed.out)["verdicts"]} == {
        "bus": True, "watchdog": True}
    line = printed.err.splitlines()[-1]
    assert f"--log {log}: cannot be written (no space left" in line and "/dev/full: cannot be written" in line


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="Windows has no such pipes")
def test_a_log_into_a_pipe_that_nobody_reads_is_refused_and_one_that_is_read_is_not(tmp_path: Path) -> None:
    pipe = tmp_path / "p.log"
    os.mkfifo(pipe)
    with pytest.raises(BadInput, match="p.log: is a pipe that no program reads; start"):
        open_log(pipe)
    end = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    try:
        writer = open_log(pipe)
        writer(can.Message(arbitration_id=0x123, data=b"x"))
        writer.stop()
        assert b"123#78" in os.read(end, 1000)
    finally:
        os.close(end)


def test_a_bus_that_cannot_be_opened_leaves_one_line_alone(caplog: pytest.LogCaptureFixture) -> None:
    with pytest.raises(LaconicError, match="--channel abc: cannot open the bus"):
        open_bus("udp_multicast", "abc")
    gc.collect()
    assert caplog.text == ""


@pytest.mark.parametrize("option", ["--fault", "--bus-fault", "--id-base", "--drives"])
def test_a_line_echoes_no_more_of_what_was_given_than_one_can_read(
        option: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["play", "canopen_agv", "--listen", "0", "--duration", "0.1", option, "nonsense" * 500]) == 2
    error = capsys.readouterr().err
    assert "nonsense…" not in error and "nonsensenon" in error and "…" in error
    assert len(error) < 600


def test_a_vehicle_of_a_dbc_has_no_base_of_a_node(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["play", "canopen_agv", "--listen", "0", "--duration", "0.1", "--dbc", str(DBC), "--map",
                str(PLAY / "transporter.toml"), "--id-base", "0x700"]) == 2
    assert "--id-base 0x700: a vehicle with --dbc has the identifiers of its messages" in capsys.readouterr().err


def test_a_fault_of_a_wheel_names_it(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["play", "canopen_agv", "--listen", "0", "--duration", "0.1", "--fault", "stall@0.01"]) == 2
    assert "--fault stall@0.01: names no wheel; give stall:WHEEL@SECONDS with one of 1, 2" in capsys.readouterr().err


@pytest.mark.parametrize("fault, words", [
    ("babble_per_s=inf", "finite"), ("babble_per_s=20000", "no bus carries so many"), ("delay_s=inf", "finite"),
    ("jitter_s=nan", "finite"), ("error_frames=2", "from 0 to 1")])
def test_a_fault_that_no_bus_has_is_refused(fault: str, words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["play", "canopen_agv", "--listen", "0", "--duration", "0.1", "--bus-fault", fault]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and f"--bus-fault {fault.partition('=')[0]}" in error and words in error


@pytest.mark.parametrize("faults, words", [
    (("loss",), "loss: has no value; give loss=VALUE"), (("loss=1", "loss=0"), "loss=0: loss is given twice"),
    (("only_id=0x20000000", "loss=1"), "29 bits")])
def test_faults_of_the_bus_that_say_nothing_or_two_things_are_refused(faults: tuple[str, ...], words: str) -> None:
    with pytest.raises(BadInput, match=words):
        played("robotino2", 0.05, lambda _: [], drives="robomaster", bus_faults=faults)


def test_a_bus_with_faults_ends_without_a_warning(caplog: pytest.LogCaptureFixture) -> None:
    played("robotino2", 0.05, lambda _: [currents(0.2)], drives="robomaster", bus_faults=("loss=0.1",))
    assert "not properly shut down" not in caplog.text


def heard_by(bus: ListeningBus) -> list[can.Message]:
    """All frames that are there."""
    found = []
    while (message := bus.recv(0.02)) is not None:
        found.append(message)
    return found


def joined(bus: ListeningBus) -> socket.socket:
    """A client that has opened its channel."""
    line = socket.create_connection(("127.0.0.1", bus.port))
    line.settimeout(2.0)
    line.sendall(b"O\r")
    heard_by(bus)
    assert line.recv(10) == b"\r"
    return line


def test_a_client_that_dies_in_a_frame_or_talks_nonsense_takes_nobody_with_it() -> None:
    bus = ListeningBus(0)
    good = joined(bus)
    for ending, text in ((False, b"t2008010203"), (True, b"t2008010203"), (False, b"\xff\x00zz\rt2009aa\rT9\r" * 50),
                         (False, b"A" * 100_000)):
        bad = joined(bus)
        if ending:  # the connection is reset, not closed
            bad.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        bad.sendall(text)
        bad.close()
        assert heard_by(bus) == []
    good.sendall(b"t20080102030405060708\r")
    message, = heard_by(bus)
    assert bytes(message.data) == bytes(range(1, 9))
    good.close()
    bus.shutdown()


def test_a_ninth_client_is_told_that_the_bus_is_full() -> None:
    bus = ListeningBus(0)
    clients = [joined(bus) for _ in range(8)]
    ninth = socket.create_connection(("127.0.0.1", bus.port))
    heard_by(bus)
    assert b"occupied" in ninth.recv(100)
    for client in (*clients, ninth):
        client.close()
    bus.shutdown()


# ---- --listen: a bus on a TCP port that python-can's slcan joins from another process, here from the same one.

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


def test_every_line_of_a_client_is_answered_also_that_of_a_frame() -> None:
    with ListeningBus(0) as bus, socket.create_connection(("127.0.0.1", bus.port), timeout=5.0) as client:
        for line, answer in ((b"S6", b"\r"), (b"O", b"\r"), (b"t1231AB", b"\r"), (b"T18FF50E50", b"\r"),
                             (b"t1239", b"\a"), (b"r7FF8", b"\r"), (b"V", b"V1010\r")):
            client.sendall(line + b"\r")
            while (bus.recv(0.01)) is not None:
                pass
            assert client.recv(16) == answer


def test_a_client_that_sends_and_never_reads_takes_no_memory() -> None:
    with ListeningBus(0) as bus, socket.create_connection(("127.0.0.1", bus.port)) as client:
        client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1024)
        client.sendall(b"O\r")
        line = b"t1230\r" * 1000
        for _ in range(200):
            client.sendall(line)
            while bus.recv(0.0) is not None:
                pass
        assert all(len(each.waiting) <= listener.MOST_WAITING + 8 for each in bus._clients.values())


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
