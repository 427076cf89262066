"""laconic play --drives: a node, in this process or in another one, plays the vehicle behind its drives."""

from __future__ import annotations

import struct
from dataclasses import replace
from pathlib import Path

import can
import pytest

from laconic.can.play.node_in_process import InProcess
from laconic.can.play.node_vehicle import FAULT_WATCHDOG
from laconic.can.play.options import PlayOptions
from laconic.can.play.protocols import PROTOCOLS
from laconic.can.play.session import play
from laconic.can.play.settings import drive_settings
from laconic.can.rig.buses import connected, node_in_process, node_process, open_bus
from laconic.can.rig.logs import read_log
from laconic.can.rig.wire import ID_BASE, wire
from laconic.cli.main import run
from laconic.errors import BadInput
from laconic.scene import read_scene
from play_support import CURRENTS, Station, currents, next_channel, played

FIRST_FEEDBACK = 0x201


def rpm_of(message: can.Message) -> int:
    """The speed that a feedback reports."""
    return int(struct.unpack(">h", message.data[2:4])[0])


def test_drives_of_a_protocol_turn_the_wheels_and_the_bus_hears_nothing_of_the_node_itself() -> None:
    judgement, controller = played("robotino2", 1.0, lambda t: [currents(0.2, 0.2, 0.2)], drives="robomaster")
    assert judgement.exit_status == 0 and judgement.figures["periods"] == 1000
    assert judgement.figures["late_periods"] == 0
    assert {message.arbitration_id for _, message in controller.heard} == {0x201, 0x202, 0x203}
    assert len(controller.of(FIRST_FEEDBACK)) == 999
    speeds = [rpm_of(message) for _, message in controller.of(FIRST_FEEDBACK)]
    assert 0 <= speeds[0] < 10 and speeds[-1] > 100


def test_a_node_of_another_scalar_type_and_step_plays_as_well() -> None:
    scene = read_scene("robotino2").with_run(real="single", step_s=0.002)
    judgement, controller = played(scene, 0.5, lambda t: [currents(0.2, 0.2, 0.2)], drives="robomaster")
    assert judgement.exit_status == 0 and judgement.figures["periods"] == 250


def test_a_step_that_is_no_whole_rate_is_refused_with_the_remedy() -> None:
    with pytest.raises(BadInput, match="give another --step"):
        played(read_scene("robotino2").with_run(step_s=0.0007), 0.1, lambda t: [], drives="robomaster")


def test_late_periods_of_an_earlier_run_are_not_those_of_this_one() -> None:
    scene = read_scene("robotino2")
    with node_in_process("double") as (client, end):
        told = []
        for stall_us in (30_000, 0):
            vehicle = InProcess(client, end, scene, drive_settings(scene, "robomaster"))
            vehicle.start()
            client.link.clock.time_us += stall_us
            for _ in range(40):
                client.link.pump()
            vehicle.finish()
            told.append(vehicle.lateness.late_periods)
        assert told[0] > 10 and told[1] == 0


def test_heartbeat_tells_that_a_drive_has_heard_no_controller() -> None:
    """The only word of a drive's watchdog that a node in another process gives."""
    scene = read_scene("robotino2")
    with node_in_process("double") as (client, end):
        vehicle = InProcess(client, end, scene, drive_settings(scene, "robomaster"))
        vehicle.start()
        vehicle.choose_frames("COUNTERS")
        for faults in (0, FAULT_WATCHDOG):
            end.node.library.lib.laconic_library_drive_fail(end.node.c, 1, faults)
            deadline = client.link.deadline_us(0.3)
            deaf = None
            while (received := client.link.receive_until(deadline)) is not None:
                frame, data = received
                deaf = frame.unpack(data)["deaf"] if frame.name == "HEARTBEAT" else deaf
            assert deaf == bool(faults)


def test_stations_of_a_shared_process_hear_each_other_and_only_rigs_hear_the_node_itself() -> None:
    with node_process("double", ID_BASE, "--shared") as port, \
            open_bus("slcan", f"socket://127.0.0.1:{port}") as rig, \
            open_bus("slcan", f"socket://127.0.0.1:{port}") as one, \
            open_bus("slcan", f"socket://127.0.0.1:{port}") as other:
        assert rig.recv(2.0).arbitration_id == ID_BASE + wire()["HEARTBEAT"].offset
        own = can.Message(arbitration_id=ID_BASE, is_extended_id=False, data=bytes(8))
        rig.send(own)  # until then everybody may be one
        one.send(currents(0.5))
        while other.recv(2.0).arbitration_id != CURRENTS:
            pass
        one.send(currents(1.0))
        assert other.recv(2.0).arbitration_id == CURRENTS
        rig.send(own)
        one.send(currents(2.0))  # after it on the same line: had the own frame passed, it would come first
        assert other.recv(2.0).arbitration_id == CURRENTS
        other.send(own)  # from now on it counts as a rig
        assert {other.recv(2.0).arbitration_id for _ in range(2)} >= {ID_BASE + wire()["HEARTBEAT"].offset}


def test_a_process_serves_the_port_itself_and_its_lateness_is_told(tmp_path: Path) -> None:
    log = tmp_path / "run.blf"
    said: list[str] = []

    def say(line: str) -> None:
        said.append(line)
        if "listening" in line:
            station.may_begin.set()

    def channel() -> str:
        return "socket://" + said[-1].partition("socket://")[2]

    with Station("slcan", channel, 300) as station:
        options = PlayOptions(listen=0, board="process", drives="robomaster", duration_s=0.8, logs=(log,))
        judgement = play(read_scene("robotino2"), options, say=say)
    assert judgement.exit_status == 0, judgement
    assert len(station.heard) == 300 and {each.arbitration_id for each in station.heard} == {0x201, 0x202, 0x203}
    assert rpm_of(station.heard[-1]) > 0
    assert judgement.figures["periods"] >= 700 and "late_periods" in judgement.figures
    assert judgement.figures["worst_lateness_ms"] > 0.0
    assert {each.arbitration_id for each in read_log(log)} == {0x200, 0x201, 0x202, 0x203}


def test_a_process_behind_a_line_of_its_own_plays_on_any_interface() -> None:
    name = next_channel()
    with can.Bus(interface="virtual", channel=name), Station("virtual", lambda: name, 100) as station:
        station.may_begin.set()
        options = PlayOptions(interface="virtual", channel=name, board="process", drives="robomaster", duration_s=0.5)
        judgement = play(read_scene("robotino2"), options)
    assert judgement.exit_status == 0, judgement
    assert len(station.heard) == 100 and {each.arbitration_id for each in station.heard} == {0x201, 0x202, 0x203}


def test_a_node_that_is_on_the_bus_of_the_controller_is_loaded_started_and_stopped_there() -> None:
    with node_process("double", ID_BASE, "--shared") as port:
        channel = f"socket://127.0.0.1:{port}"
        with Station("slcan", lambda: channel, 100) as station:
            options = PlayOptions(interface="slcan", channel=channel, board="bus", drives="robomaster", duration_s=0.5)
            judgement = play(read_scene("robotino2"), options, say=lambda _: station.may_begin.set())
        assert judgement.exit_status == 0, judgement
        assert len([each for each in station.heard if each.arbitration_id == FIRST_FEEDBACK]) > 20
        with connected("slcan", channel) as client:
            client.open()
            assert client.state == "ready"


def test_a_frame_log_holds_both_sides_of_the_bus(tmp_path: Path) -> None:
    path = tmp_path / "run.asc"
    played("robotino2", 0.1, lambda t: [currents(0.2, 0.2, 0.2)], drives="robomaster", logs=(path,))
    with can.LogReader(path) as log:
        frames = list(log)
    assert {each.arbitration_id for each in frames} == {0x200, 0x201, 0x202, 0x203}
    assert frames[0].timestamp < frames[-1].timestamp


@pytest.mark.parametrize("arguments, words", [
    ([], ("--interface", "--listen 0")),
    (["--listen", "0", "--interface", "virtual"], ("--listen 0", "leave --interface out")),
    (["--listen", "70000", "--drives", "canopen"], ("--listen 70000", "0 (any free one) to 65535")),
    (["--listen", "0", "--channel", "x"], ("--channel x", "--interface")),
    (["--listen", "0", "--bus-option", "loss=1"], ("--bus-option loss=1", "--interface")),
    (["--listen", "0", "--bitrate", "0"], ("--bitrate 0",)),
    (["--listen", "0", "--dbc", "x.dbc"], ("--map: is missing",)),
    (["--listen", "0", "--map", "x.toml"], ("--dbc: is missing",)),
    (["--listen", "0", "--drives", "canopen", "--dbc", "x", "--map", "y"], ("--drives canopen", "one of them")),
    (["--listen", "0", "--board", "process", "--dbc", "x", "--map", "y"], ("--board process", "leave --board out")),
    (["--listen", "0", "--duration", "0"], ("--duration 0", "above 0")),
    (["--listen", "0", "--drives", "canopen", "--id-base", "5"], ("--id-base 5", "multiple of 32")),
    (["--interface", "nosuch", "--channel", "x", "--drives", "canopen"], ("--interface nosuch",)),
    (["--listen", "0"], ("rig.drives.protocol", "--drives"))])
def test_options_that_cannot_work_are_refused_in_one_line(arguments: list[str], words: tuple[str, ...],
                                                         capsys: pytest.CaptureFixture[str]) -> None:
    duration = [] if "--duration" in arguments else ["--duration", "0.01"]
    assert run(["play", "robotino2", *duration, *arguments]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and all(word in error for word in words), error


@pytest.mark.parametrize("name", PROTOCOLS)
def test_the_node_ids_that_the_host_takes_are_those_of_the_protocol_in_c(name: str) -> None:
    scene, protocol = read_scene("robotino2"), PROTOCOLS[name]
    settings = drive_settings(scene, name)

    def start(first: int, last: int) -> None:
        with node_in_process("double") as (client, end):
            InProcess(client, end, scene, replace(settings, node_ids=(first, first + 1, last))).start()

    start(protocol.smallest_id, protocol.largest_id)
    for wrong in {max(protocol.smallest_id - 1, 0), protocol.largest_id + 1} - {protocol.smallest_id}:
        with pytest.raises(BadInput):
            start(protocol.smallest_id + 1, wrong)
