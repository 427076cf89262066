"""The frames of a network FMU are those of the host's node: the same C, the same times, the same bytes."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from bus_operations import FORMAT_ERROR, ByHand, fd_frame, frame, frames_in, operation

from laconic.can.play.settings import drive_settings
from laconic.can.rig.node_library import LibraryNode
from laconic.can.rig.session import Session
from laconic.can.rig.wire import ID_BASE, wire
from laconic.fmu.network import loading_frames, make_network_fmu
from laconic.scene import read_scene

EXCHANGES = pytest.mark.parametrize("exchanges", [3_000, pytest.param(10_000, marks=pytest.mark.nightly)])
PERIOD_US = 1000
Frame = tuple[int, bytes]


class HostNode:
    """The library's node, loaded by the same frames as the FMU's."""

    def __init__(self, scene: str, drives: str | None = None):
        given = read_scene(scene)
        settings = drive_settings(given, drives) if drives else None
        self.node = LibraryNode("double", can_fd=drives is None or drives == "moteus")
        self.now_us = 0
        self.late: list[Frame] = []   # answers to what came last: an FMU sends them after the next step
        self.early: list[Frame] = []  # of drives, such as a boot-up message
        for offset, data in loading_frames(given, settings):
            self.node.on_frame(ID_BASE + offset, data, 0)
            self.early += [each for each in self._frames() if not ID_BASE <= each[0] < ID_BASE + 32]

    def _frames(self) -> Iterator[Frame]:
        while (taken := self.node.take_frame()) is not None:
            yield taken[0], taken[1]

    def hear(self, frames: list[Frame]) -> list[Frame]:
        """Frames come at this instant."""
        sent = []
        for identifier, data in frames:
            self.node.on_frame(identifier, data, self.now_us, fd=len(data) > 8)
            sent += self._frames()
        return sent

    def advance(self, until_us: int) -> list[Frame]:
        """Time passes, with a tick at each instant that the node asks for."""
        sent: list[Frame] = []
        while True:
            self.node.tick(self.now_us)
            sent += self._frames()
            idle_us = self.node.idle_us(self.now_us)
            if idle_us > until_us - self.now_us:
                break
            self.now_us += idle_us
        self.now_us = until_us
        return sent


class Rig:
    """The rig's side of a session. `heard`: what the node has answered last."""

    def __init__(self, host: HostNode):
        self.session, self.heard = Session(host.node.library), list[Frame]()

    def open(self) -> Iterator[list[Frame]]:
        """HELLO and OPEN; the answers are read from the host's node."""
        hello = wire()["HELLO"].pack()
        self.session.library.protect_plain(wire()["HELLO"].offset, hello, 1)
        yield [(ID_BASE + wire()["HELLO"].offset, bytes(hello))]
        nonce = next(wire()["CHALLENGE"].unpack(data)["nonce"] for identifier, data in self.heard
                     if identifier == ID_BASE + wire()["CHALLENGE"].offset)
        opening = wire()["OPEN"].pack(nonce_echo=nonce & 0xFFFF, session=7)
        self.session.library.protect_keyed(wire()["OPEN"].offset, opening, nonce, 1)
        self.session.open(7, nonce)
        yield [(ID_BASE + wire()["OPEN"].offset, bytes(opening))]

    def make(self, name: str, **fields: int) -> Frame:
        """A protected frame of the session."""
        kind = wire()[name]
        data = kind.pack(**fields)
        self.session.protect(kind, data)
        return ID_BASE + kind.offset, bytes(data)

    def control(self, command: str) -> Frame:
        """A CONTROL."""
        return self.make("CONTROL", command=wire().number("CONTROL", "command", command), rate=0, watchdog=0)

    def exchanges(self, count: int) -> Iterator[list[Frame]]:
        """What the rig sends in each millisecond: a session, a choice of frames, and steps by voltages that change."""
        yield from self.open()
        yield [self.make("SELECT", send_pose=1, send_nu=1, send_wheel_speed=1)]
        yield [self.control("START_LOCKSTEP")]
        self.session.begin_run()
        for name in ("VOLTAGE", "SYNC"):  # the first of a kind is the reference of its counter
            yield [self.make(name)]
        for k in range(count):
            level = 200 * (k // 500 % 7 - 3)
            yield [self.make("VOLTAGE", voltage_1=level, voltage_2=-level, voltage_3=level // 2),
                   self.make("SYNC", step_count=1 + k % 3, input_frames=0)]


def as_operations(frames: list[Frame]) -> bytes:
    """Frames as they come from a bus."""
    return b"".join(fd_frame(*each) if len(each[1]) > 8 else frame(*each) for each in frames)


def of_any_build(frames: list[Frame]) -> list[tuple[int, Any]]:
    """Frames without what IDENTITY says of hinges and slip, which the library's node takes and the FMU's does not."""
    identity, of_build = wire()["IDENTITY"], ("hinges", "slip", "crc")
    return [(identifier, {key: value for key, value in identity.unpack(data).items() if key not in of_build}
             if identifier == ID_BASE + identity.offset else data) for identifier, data in frames]


def compare(host: HostNode, fmu: ByHand, script: Iterator[list[Frame]],
            rig: Rig | None = None) -> tuple[int, list[Frame]]:
    """Both hear the same; the numbers of exchanges, and all frames that were sent."""
    sent, count = [*host.early], 0
    assert frames_in(fmu.first["CAN"]) == host.early
    for frames in script:
        count += 1
        until_us = count * PERIOD_US
        answers = host.advance(until_us)
        heard = frames_in(fmu.step(until_us * 1e-6, CAN=as_operations(frames))["CAN"])
        assert of_any_build(heard) == of_any_build([*host.late, *answers])
        host.late = host.hear(frames)
        if rig is not None:
            rig.heard = host.late
        sent += answers + host.late
    return count, sent


@EXCHANGES
def test_the_nodes_own_frames_equal_those_of_the_host_over_thousands_of_exchanges(exchanges: int,
                                                                                  tmp_path: Path) -> None:
    host = HostNode("robotino2")
    rig = Rig(host)
    with ByHand(make_network_fmu(read_scene("robotino2"), tmp_path / "rig.fmu")) as fmu:
        count, sent = compare(host, fmu, rig.exchanges(exchanges), rig)
        assert count >= exchanges
        poses = [data for identifier, data in sent if identifier == ID_BASE + wire()["POSE"].offset]
        assert len(poses) > 0.99 * exchanges
        assert len({data[2:] for data in poses}) > 1000  # it moves
        assert fmu.fmu.get("x_m") == pytest.approx(
            wire()["POSE"].unpack(poses[-1])["x"] * wire()["POSE"].fields["x"].scale, abs=1e-3)


def canopen_script(count: int) -> Iterator[list[Frame]]:
    """A controller of two drives: NMT start, profile velocity, enabling, then a new target for each drive in each
    millisecond, and a SYNC."""
    yield [(0x000, b"\x01\x00")]
    for node in (4, 5):
        yield [(0x600 + node, struct.pack("<BHBI", 0x2F, 0x6060, 0, 3))]
        for word in (6, 7, 15):
            yield [(0x600 + node, struct.pack("<BHBI", 0x2B, 0x6040, 0, word))]
    for k in range(count):
        target = 400 * (k // 700 % 5 - 2)
        yield [*((0x600 + node, struct.pack("<BHBi", 0x23, 0x60FF, 0, target * (9 - 2 * node))) for node in (4, 5)),
               (0x080, b"")]


@EXCHANGES
def test_canopen_drives_answer_as_on_the_host_over_thousands_of_exchanges(exchanges: int, tmp_path: Path) -> None:
    host = HostNode("canopen_agv", "canopen")
    with ByHand(make_network_fmu(read_scene("canopen_agv"), tmp_path / "agv.fmu", drives="canopen")) as fmu:
        count, sent = compare(host, fmu, canopen_script(exchanges))
        assert count >= exchanges
        answers = [data for identifier, data in sent if identifier in (0x584, 0x585)]
        assert len(answers) > 1.99 * exchanges
        assert {data[0] for data in answers} == {0x60}  # none is an abort
        assert abs(fmu.fmu.get("wheel_angle_rad[1]")) > 1.0
        assert fmu.fmu.get("node_state") == 6.0


def test_wrong_operations_are_answered_by_their_own_bytes_and_the_right_ones_between_them_act(tmp_path: Path) -> None:
    nine = b"123456789"
    wrong = [operation(0x99, b""), operation(0x10, b"\0" * 7), frame(0x800, b""), frame(1, nine), fd_frame(1, nine),
             operation(0x20, b"123"), operation(0x31, struct.pack("<IBB?", 1, 7, 1, True)),
             operation(0x40, b"\x05\0\0\0\0"), operation(0x41, b"\x04")]
    with ByHand(make_network_fmu(read_scene("canopen_agv"), tmp_path / "agv.fmu", drives="canopen")) as fmu:
        between = frame(0x604, struct.pack("<BHBI", 0x2F, 0x6060, 0, 3))
        fmu.step(0.001, CAN=b"".join(each + between for each in wrong) + b"\x10\0\0\0\xff\xff\0\0tail")
        sent = fmu.step(0.002)["CAN"]
        errors = [arguments for code, arguments in sent if code == FORMAT_ERROR]
        assert [arguments[2:] for arguments in errors] == [*wrong, b"\x10\0\0\0\xff\xff\0\0tail"]
        assert [struct.unpack_from("<H", arguments)[0] for arguments in errors] == [len(each[2:]) for each in errors]
        assert len([each for each in frames_in(sent) if each[0] == 0x584]) == len(wrong)
        assert fmu.fmu.get("wrong_operations") == len(wrong) + 1
        fmu.step(0.003, CAN=operation(FORMAT_ERROR, b"\xff\xffx"))  # a wrong Format Error is not answered: no end
        assert FORMAT_ERROR not in [code for code, _ in fmu.step(0.004)["CAN"]]
