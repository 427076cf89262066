"""Controllers for played vehicles in tests: stations on a virtual bus that are called in the loop's virtual time."""

from __future__ import annotations

import itertools
import struct
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import can
import cantools
from crccheck.crc import Crc8SaeJ1850

from laconic.can.play.options import PlayOptions
from laconic.can.play.session import play
from laconic.can.rig.buses import VirtualClock, open_bus
from laconic.can.rig.verdict import Judgement
from laconic.scene import Scene, read_scene

PLAY = Path(__file__).parents[1] / "can" / "play"
DBC = PLAY / "transporter.dbc"
PERIOD_US = 10_000
CURRENTS = 0x200          # a command of a C620 group
AMPERE = 16384 / 20.0     # of its currents
_channel_numbers = itertools.count()


def next_channel() -> str:
    """A channel name that no other virtual bus has."""
    return f"laconic-{next(_channel_numbers)}"


class Controller:
    """Sends what `commands` gives every 10 ms, and keeps all frames of the vehicle with their times."""

    def __init__(self, bus: can.BusABC, commands: Callable[[float], list[can.Message]]):
        self.bus, self.commands = bus, commands
        self.heard: list[tuple[float, can.Message]] = []
        self._next_us = 0

    def __call__(self, now_us: int) -> int:
        while (message := self.bus.recv(0)) is not None:
            self.heard.append((now_us / 1e6, message))
        if now_us >= self._next_us:
            self._next_us += PERIOD_US
            for message in self.commands(now_us / 1e6):
                self.bus.send(message)
        return self._next_us

    def of(self, identifier: int) -> list[tuple[float, can.Message]]:
        """The frames with an identifier."""
        return [each for each in self.heard if each[1].arbitration_id == identifier]


class Codec:
    """Messages of the test's DBC by cantools alone, with a checksum of crccheck."""

    def __init__(self, dbc: Path = DBC):
        self.database: Any = cantools.database.load_file(dbc)
        self._count = 0

    def command(self, left_V: float, right_V: float, *, step: int = 1, spoil: int = 0) -> can.Message:
        """WHEEL_COMMAND with its counter and SAE J1850 checksum."""
        self._count = (self._count + step) % 16
        values = {"VoltageLeft": left_V, "VoltageRight": right_V, "Counter": self._count, "Checksum": 0}
        message = self.database.get_message_by_name("WHEEL_COMMAND")
        data = bytearray(message.encode(values))
        data[7] = Crc8SaeJ1850.calc(bytes(data[:7])) ^ spoil
        return can.Message(arbitration_id=message.frame_id, is_extended_id=False, data=data)

    def encode(self, name: str, **values: float) -> can.Message:
        """Any message."""
        message = self.database.get_message_by_name(name)
        return can.Message(arbitration_id=message.frame_id, is_extended_id=message.is_extended_frame,
                           data=message.encode(values))

    def decode(self, message: can.Message) -> dict[str, float]:
        """The signals of a frame."""
        return dict(self.database.decode_message(message.arbitration_id, message.data))


def played(scene: str | Path | Scene, duration_s: float, commands: Callable[[float], list[can.Message]],
           made: Callable[[Controller], None] = lambda _: None, **options: Any) -> tuple[Judgement, Controller]:
    """Plays a scene in virtual time for a controller, which `made` gets before it begins."""
    channel = next_channel()
    settings = PlayOptions(interface="virtual", channel=channel, duration_s=duration_s, **options)
    with can.Bus(interface="virtual", channel=channel) as bus:
        controller = Controller(bus, commands)
        made(controller)
        given = scene if isinstance(scene, Scene) else read_scene(scene)
        judgement = play(given, settings, clock=VirtualClock(), others=[controller])
        controller(10**12)  # what is still on the bus
    return judgement, controller


def currents(*amperes: float) -> can.Message:
    """A command of a C620 group."""
    raw = [round(AMPERE * each) for each in (*amperes, 0.0, 0.0, 0.0, 0.0)][:4]
    return can.Message(arbitration_id=CURRENTS, is_extended_id=False, data=struct.pack(">4h", *raw))


def sdo(node_id: int, index: int, value: int, size: int, sub: int = 0) -> can.Message:
    """An expedited download to a CANopen drive."""
    head = {1: 0x2F, 2: 0x2B, 4: 0x23}[size]
    return can.Message(arbitration_id=0x600 + node_id, is_extended_id=False,
                       data=struct.pack("<BHBi", head, index, sub, value))


class Station(threading.Thread):
    """A controller in a thread of its own: commands currents, and keeps what the drives say, until `wanted` frames."""

    def __init__(self, interface: str, channel: Callable[[], str], wanted: int, last_command: int = 10**9):
        super().__init__()
        self.interface, self.channel, self.wanted = interface, channel, wanted
        self.last_command = last_command  # it only listens once it has heard so many frames
        self.heard: list[can.Message] = []
        self.longest_pause_s = 0.0  # of this thread
        self.may_begin, self.is_over = threading.Event(), threading.Event()

    def run(self) -> None:
        self.may_begin.wait(20.0)
        with open_bus(self.interface, self.channel()) as bus, suppress(can.CanError):  # the port ends before this does
            awake_s = time.monotonic()
            while not self.is_over.is_set() and len(self.heard) < self.wanted:
                slept_s, awake_s = awake_s, time.monotonic()
                self.longest_pause_s = max(self.longest_pause_s, awake_s - slept_s)
                if len(self.heard) < self.last_command:
                    bus.send(currents(0.2, 0.2, 0.2))
                if (message := bus.recv(0.001)) is not None:
                    self.heard.append(message)
            while len(self.heard) < self.wanted and (message := bus.recv(0.0)) is not None:
                self.heard.append(message)  # what a busy machine left waiting

    def __enter__(self) -> Station:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.may_begin.set()
        self.is_over.set()
        self.join()


def unhurried(run: Callable[[float], tuple[Judgement, Station]]) -> tuple[Judgement, Station, float]:
    """A run by the clock: its times are longer where a machine under load was late by much of them. Returns how much.

    `run` takes the factor of its times; of those of a second, neither end may be late by more than 50 ms.
    """
    for longer in (1.0, 4.0):
        judgement, station = run(longer)
        if max(station.longest_pause_s, judgement.figures.get("worst_lateness_ms", 0.0) / 1e3) < 0.05 * longer:
            break
    return judgement, station, longer
