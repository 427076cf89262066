"""Drives that fail in a node of another process, error frames, and stops judged where a node serves the bus."""

from __future__ import annotations

import socket
import struct
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import can
import pytest

from laconic.can.play.listener import ListeningBus
from laconic.can.play.options import PlayOptions
from laconic.can.play.orders import Orders
from laconic.can.play.protocols import ORDERS
from laconic.can.play.senders import Senders
from laconic.can.play.session import play
from laconic.can.play.settings import drive_settings
from laconic.can.rig.buses import node_process
from laconic.can.rig.faults import error_frame
from laconic.can.rig.logs import read_log
from laconic.can.rig.verdict import Judgement
from laconic.can.rig.wire import ID_BASE, wire
from laconic.scene import read_scene
from play_support import DBC, PLAY, Codec, Controller, Station, currents, next_channel, played, unhurried

FOR_EVER = 10**6


def current_of(message: can.Message) -> int:
    """The torque current that a feedback reports."""
    return int(struct.unpack(">h", message.data[4:6])[0])


def on_a_served_port(duration_s: float, last_command: int = FOR_EVER, **options: object) -> tuple[Judgement, Station]:
    """A controller that pushes all wheels, and a process that serves its port."""
    said: list[str] = []

    def say(line: str) -> None:
        said.append(line)
        if "listening" in line:
            station.may_begin.set()

    with Station("slcan", lambda: "socket://" + said[-1].partition("socket://")[2], FOR_EVER,
                 last_command) as station:
        judgement = play(read_scene("robotino2"), PlayOptions(
            listen=0, board="process", drives="robomaster", duration_s=duration_s, **options), say=say)
    return judgement, station


def judged_stop(judgement: Judgement) -> str:
    """What the verdict on the stop says."""
    return next(each.detail for each in judgement.verdicts if each.name == "stopped")


def test_drives_of_a_process_that_serves_its_port_fail_and_its_own_motion_is_judged() -> None:
    judgement, station, longer = unhurried(lambda longer: on_a_served_port(
        longer, faults=tuple(f"{kind}@{0.4 * longer:g}{more}" for kind, more in (
            ("temperature:1", ""), ("bus-off:2", ""), ("silent:3", f"+{0.2 * longer:g}"))), stop_within_s=0.2))
    feedback = {number: [each for each in station.heard if each.arbitration_id == number] for number in (513, 514, 515)}
    assert current_of(feedback[513][-1]) == 0 and current_of(feedback[515][-1]) != 0
    assert len(feedback[514]) < 0.7 * len(feedback[513])
    assert len(feedback[514]) < len(feedback[515]) < 0.95 * len(feedback[513])
    assert judgement.exit_status == 1 and "still moving at the end" in judged_stop(judgement)
    assert f"the first fault at {0.4 * longer:g}" in judged_stop(judgement)
    assert judgement.figures["frames_in"] > 20 and judgement.figures["frames_out"] > 1000


def test_the_last_frame_of_the_controller_is_told_from_those_of_the_drives_on_one_bus() -> None:
    judgement, _, longer = unhurried(lambda longer: on_a_served_port(0.8 * longer, last_command=300,
                                                                     stop_distance_m=5.0))
    assert judgement.figures["frames_out"] > 1000 * longer
    assert 50 < judgement.figures["frames_in"] < 1000
    _, _, mark_s = judged_stop(judgement).partition("controller's last frame at ")
    assert 0.0 < float(mark_s.partition(" s")[0]) < 0.7 * longer


@pytest.mark.parametrize("kind, seen", [("encoder", "no current"), ("error-frames", "error frames")])
def test_drives_of_a_process_behind_a_line_of_its_own_fail_on_any_interface(kind: str, seen: str,
                                                                         tmp_path: Path) -> None:
    log = tmp_path / "run.asc"

    def run(longer: float) -> tuple[Judgement, Station]:
        name = next_channel()
        with can.Bus(interface="virtual", channel=name), Station("virtual", lambda: name, FOR_EVER) as station:
            station.may_begin.set()
            judgement = play(read_scene("robotino2"), PlayOptions(
                interface="virtual", channel=name, board="process", drives="robomaster", duration_s=0.9 * longer,
                faults=(f"{kind}:2@{0.3 * longer:g}",), logs=(log,)))  # where a machine is busy, orders come late
        return judgement, station

    judgement, station, _ = unhurried(run)
    assert judgement.exit_status == 0, judgement
    errors = [each for each in station.heard if each.is_error_frame]
    of_second = [each for each in station.heard if each.arbitration_id == 0x202]
    assert len(of_second) > 100 and any(map(current_of, of_second))
    if seen == "no current":
        assert current_of(of_second[-1]) == 0 and not errors
    else:  # the drives go on
        later = station.heard[station.heard.index(errors[0]):]
        assert any(current_of(each) for each in later if each.arbitration_id == 0x202) and len(errors) > 20
    assert sum(each.is_error_frame for each in can.LogReader(log)) == len(errors)


def test_drives_of_a_node_that_is_on_the_bus_fail_and_its_motion_is_judged() -> None:
    def run(longer: float) -> tuple[Judgement, Station]:
        with node_process("double", ID_BASE, "--shared") as port:
            channel = f"socket://127.0.0.1:{port}"
            with Station("slcan", lambda: channel, FOR_EVER) as station:
                judgement = play(read_scene("robotino2"), PlayOptions(
                    interface="slcan", channel=channel, board="bus", drives="robomaster", duration_s=0.6 * longer,
                    faults=(f"supply:3@{0.3 * longer:g}",), stop_within_s=0.1), say=lambda _: station.may_begin.set())
        return judgement, station

    judgement, station, longer = unhurried(run)
    last = [each for each in station.heard if each.arbitration_id == 0x203][-1]
    assert current_of(last) == 0 and f"the first fault at {0.3 * longer:g}" in judged_stop(judgement)


class Line:
    """A node's end that never answers, for Orders."""

    def __init__(self) -> None:
        self.sent: list[can.Message] = []
        self.link = self
        self.session = self

    def protect(self, frame: object, data: bytearray) -> int:
        return 17

    def message(self, frame: object, data: bytearray) -> can.Message:
        return can.Message(arbitration_id=0x688, is_extended_id=False, data=data)

    def send_message(self, message: can.Message) -> None:
        self.sent.append(message)


def test_an_order_is_repeated_until_it_is_answered_and_its_failure_ends_the_run() -> None:
    line = Line()
    orders = Orders(line)  # type: ignore[arg-type]
    orders.give(2, ORDERS["encoder"])
    for now_us in range(0, 1_000_001, 10_000):
        orders.go_on(now_us)
    assert len(line.sent) == 11 and len({bytes(each.data) for each in line.sent}) == 1
    orders.take({"request": 1, "command": wire().number("RESULT", "command", "PARAMETER"), "status": 0})
    orders.go_on(9_000_000)
    assert len(line.sent) == 11 and orders.failure is None
    orders.give(1, 0)
    for now_us in range(10_000_000, 13_000_001, 10_000):
        orders.go_on(now_us)
    assert "does not answer" in str(orders.failure)


def test_a_program_on_slcan_learns_of_error_frames_by_the_status_flags_alone() -> None:
    bus = ListeningBus(0)
    with socket.create_connection(("127.0.0.1", bus.port)) as line:
        line.settimeout(0.01)

        def answer(command: bytes) -> bytes:
            line.sendall(command)
            for _ in range(500):
                bus.recv(0.01)
                with suppress(TimeoutError):
                    return line.recv(100)
            return b""

        assert answer(b"O\r") == b"\r" and answer(b"F\r") == b"F00\r"
        bus.send(error_frame())
        assert answer(b"F\r") == b"F80\r" and answer(b"F\r") == b"F00\r"
    bus.shutdown()


# ---- a map's vehicle, as a station


def heard_of_map(fault: str) -> tuple[Judgement, Controller]:
    """One second with WHEEL_STATE every 10 ms."""
    codec = Codec()
    return played("turtlebot3_burger", 1.0, lambda _: [codec.command(6.0, -6.0)], dbc=DBC,
                  map_path=PLAY / "transporter.toml", faults=(fault,))


@pytest.mark.parametrize("fault, is_heard, hears", [
    ("bus-off@0.3+0.4", False, False), ("silent@0.3+0.4", False, True), ("error-frames@0.3+0.4", True, True)])
def test_the_station_of_a_map_leaves_the_bus_is_silent_or_meets_errors(fault: str, is_heard: bool, hears: bool) -> None:
    judgement, controller = heard_of_map(fault)
    between = [message for at_s, message in controller.heard if 0.32 < at_s < 0.68]
    assert bool(between) == is_heard and any(at_s > 0.75 for at_s, _ in controller.heard)
    errors = [message for message in between if message.is_error_frame]
    assert 2 * len(errors) == len(between)
    watchdog = next(each for each in judgement.verdicts if each.name == "watchdog")
    assert watchdog.passed == hears and ("WHEEL_COMMAND did not come in time" in watchdog.detail) != hears


# ---- who has sent a frame


def frame(identifier: int, data: bytes = b"", **flags: bool) -> can.Message:
    """Any frame."""
    return can.Message(arbitration_id=identifier, is_extended_id=identifier > 0x7FF, data=data, **flags)


SENT: dict[str, tuple[dict[int, can.Message], Callable[[], list[can.Message]]]] = {
    "canopen": ({1: frame(0x181), 2: frame(0x702), 3: frame(0x583)},
                lambda: [frame(0x201), frame(0x601), frame(0), frame(0x80), frame(0x77F)]),
    "odrive": ({0: frame(0x009), 1: frame(0x021), 2: frame(0x041)},
               lambda: [frame(0x00C), frame(0x023, is_remote_frame=True), frame(0x047)]),
    "robomaster": ({1: frame(0x201), 2: frame(0x202), 3: frame(0x203)}, lambda: [frame(0x200), frame(0x1FF)]),
    "moteus": ({1: frame(0x100), 2: frame(0x200), 3: frame(0x305)}, lambda: [frame(0x8001), frame(2)])}


@pytest.mark.parametrize("name", SENT)
def test_the_drive_that_sent_a_frame_follows_from_the_protocol(name: str) -> None:
    senders = Senders(drive_settings(read_scene("robotino2"), name))
    of_drives, of_others = SENT[name]
    assert {node_id: senders.node_of(message) for node_id, message in of_drives.items()} == {
        node_id: node_id for node_id in of_drives}
    assert [senders.node_of(message) for message in of_others()] == [None] * len(of_others())


def test_a_pdo_that_the_controller_has_moved_is_still_the_drives() -> None:
    senders = Senders(drive_settings(read_scene("robotino2"), "canopen"))
    assert senders.node_of(frame(0x1A5)) is None
    senders.node_of(frame(0x602, bytes((0x23, 0x01, 0x18, 1, 0xA5, 1, 0, 0))))  # 0x1801:01 of node 2
    assert senders.node_of(frame(0x1A5)) == 2 and senders.node_of(frame(0x282)) is None


def test_a_log_of_error_frames_is_read_back(tmp_path: Path) -> None:
    path = tmp_path / "run.blf"
    command = currents(0.2, 0.2, 0.2)
    played("robotino2", 0.2, lambda _: [command], drives="robomaster", faults=("error-frames:1@0.1",), logs=(path,))
    with can.LogReader(path) as log:
        assert sum(each.is_error_frame for each in log) > 50
    assert read_log(path)
