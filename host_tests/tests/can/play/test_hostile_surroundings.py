"""What surrounds a run goes wrong: full disks, faults that no bus has, clients that die. One line, or it goes on."""

from __future__ import annotations

import gc
import json
import os
import socket
import struct
from pathlib import Path

import can
import pytest

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
