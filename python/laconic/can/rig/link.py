"""Protected frames over any python-can bus: protects what is sent, checks what is received, counts faults."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable

import can
from can.interfaces.slcan import slcanBus

from laconic.can.rig.errors import BusDied, in_words
from laconic.can.rig.node_library import E2E_STATUS, node_library
from laconic.can.rig.session import Codes, Session
from laconic.can.rig.wire import ID_BASE, Frame, wire

Received = tuple[Frame, bytes]
LONGEST_WAIT_S = 0.1  # then a wait calls may_go_on


class Clock:
    """The clock of a real bus. A virtual clock (laconic.can.rig.buses) advances only while the rig waits."""

    def now_us(self) -> int:
        """Microseconds since some start."""
        return time.perf_counter_ns() // 1000

    def calendar_s(self) -> float:
        """What to add to its seconds to have those since 1970, which logs have."""
        return time.time() - self.now_us() / 1e6

    def pass_time(self, microseconds: int) -> None:
        """Waits so long."""
        time.sleep(microseconds / 1e6)


def send_on(bus: can.BusABC, message: can.Message) -> None:
    """Sends a frame; BusDied where the interface cannot."""
    try:
        bus.send(message)
    except (can.CanError, OSError, ValueError) as error:
        raise BusDied(f"the bus died while sending: {in_words(error)}") from None


def receive_on(bus: can.BusABC, timeout_s: float) -> can.Message | None:
    """The next frame; None when none comes in time. BusDied where the interface fails, by any error that one raises."""
    try:
        return bus.recv(timeout_s)
    except (can.CanError, OSError, ValueError, IndexError) as error:
        raise BusDied(f"the bus died while receiving: {in_words(error)}") from None


class Link:
    """One end of the wire. `pump`, where given, runs a node in this process; it returns False when idle."""

    def __init__(self, bus: can.BusABC, id_base: int = ID_BASE, *, clock: Clock | None = None,
                 pump: Callable[[], bool] | None = None, key: bytes | None = None):
        self.codes = Codes(key, id_base) if key is not None else None
        self.bus, self.id_base, self.clock, self.pump = bus, id_base, clock or Clock(), pump
        self.library = node_library("double")
        self.session = Session(self.library)
        self.frames_out = self.frames_in = 0
        self.faults: Counter[str] = Counter()
        self.listeners: list[Callable[[can.Message], None]] = []
        self.may_go_on: Callable[[], None] = lambda: None  # called before each wait; raises what ends it
        self._receivers = {offset: self.library.receiver() for offset in wire().by_offset}
        self._counters: dict[int, int] = {}  # of the last frame taken of each kind
        self._lost: dict[int, int] = {}      # frames of each kind that are missing before that one
        self._by_offset = wire().by_offset
        self._check = self.library.lib.laconic_e2e_check

    def forget_counters(self) -> None:
        """Accepts any counter next: the node may have restarted, or be another one."""
        self._receivers = {offset: self.library.receiver() for offset in self._by_offset}
        self._counters.clear()

    def send(self, frame: Frame, data: bytearray) -> int:
        """Protects a payload for the open session and sends it; returns its count. The first of its kind after START
        serves the node only as reference for the counter, so it is sent twice."""
        count = self.session.protect(frame, data)
        self.send_message(self.message(frame, data))
        return self.send(frame, data) if frame.key == "run" and count == 1 else count

    def message(self, frame: Frame, data: bytearray) -> can.Message:
        """A protected payload as a frame of the bus."""
        return can.Message(arbitration_id=self.id_base + frame.offset, is_extended_id=False, data=bytearray(data),
                           is_fd=frame.fd, bitrate_switch=frame.fd)

    def reopen_channel(self) -> None:
        """Opens a serial line's channel once more, for a board that was not up yet when the bus was opened."""
        if isinstance(self.bus, slcanBus):
            self.bus.open()

    def send_message(self, message: can.Message) -> None:
        """Sends a frame as it is, and with a key its code behind it."""
        code = self.codes.behind(message) if self.codes is not None else None
        for each in (message, code) if code is not None else (message,):
            send_on(self.bus, each)
            self.frames_out += 1
            for listener in self.listeners:
                listener(each)

    def receive(self, timeout_s: float = 1.0) -> Received | None:
        """The next right frame from the node; None when none comes in time. Wrong ones are counted and dropped."""
        return self.receive_until(self.deadline_us(timeout_s))

    def deadline_us(self, timeout_s: float) -> int:
        """The instant so long from now, on the link's clock."""
        return self.clock.now_us() + int(1e6 * timeout_s)

    def receive_until(self, deadline_us: int) -> Received | None:
        """As receive, for callers that skip frames: a HEARTBEAT must not extend their wait."""
        while True:
            message = self._next_message(deadline_us)
            if message is None:
                return None
            if (received := self.take(message)) is not None:
                return received

    def _next_message(self, deadline_us: int) -> can.Message | None:
        self.may_go_on()
        if self.pump is None:
            return self._wait(deadline_us)
        message = receive_on(self.bus, 0.0)
        while message is None and (self.pump() or self.clock.now_us() < deadline_us):
            message = receive_on(self.bus, 0.0)
        return message

    def _wait(self, deadline_us: int) -> can.Message | None:
        while True:
            left_s = max(0.0, (deadline_us - self.clock.now_us()) / 1e6)
            message = receive_on(self.bus, min(left_s, LONGEST_WAIT_S))
            if message is not None or left_s <= LONGEST_WAIT_S:
                return message
            self.may_go_on()

    def lost_before(self, frame: Frame) -> int:
        """How many of its kind are missing before the last one taken, as far as its counter reaches: also those that
        were refused until the receiver had found a new reference."""
        return self._lost[frame.offset]

    def take(self, message: can.Message) -> Received | None:
        """Checks one frame: ours, well-formed, fresh and right."""
        for listener in self.listeners:
            listener(message)
        if self.codes is not None:
            self.codes.heard(message)
        frame = self._by_offset.get(message.arbitration_id - self.id_base)
        if frame is None or message.is_extended_id or message.is_error_frame:
            return None
        self.frames_in += 1
        if frame.from_rig or message.is_remote_frame or message.is_fd != frame.fd or len(message.data) != frame.length:
            self.faults["malformed"] += 1
            return None
        data, offset = message.data, frame.offset
        right = self.library.plain_is_right(offset, data)
        counter, mask = frame.counter_of(data), 255 if frame.fd else 15
        receiver = self._receivers[offset]
        status = self._check(receiver, right, counter, mask, frame.max_delta)
        if status > 1:
            self.faults[E2E_STATUS[status]] += 1
            return None
        self._lost[offset] = (counter - self._counters.get(offset, counter - 1) - 1) & mask
        self._counters[offset] = counter
        if status == 1:
            self.faults[E2E_STATUS[1]] += receiver.lost
        return frame, data
