"""The time of a played vehicle: frames in, steps that are due, frames out, until somebody ends it.

The same loop runs by the wall clock and in virtual time, where the next event comes as soon as nobody is busy.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import can

from laconic.can.rig.buses import VirtualClock
from laconic.can.rig.errors import BusDied, Interrupted
from laconic.can.rig.link import Clock, receive_on, send_on
from laconic.errors import LaconicError

LONGEST_WAIT_US = 20_000   # then a wait looks whether a signal has come
MOST_AT_ONCE = 256         # frames that are read before the vehicle steps again
FOR_EVER_US = 2**62


class Vehicle(Protocol):
    """What stands at the vehicle's end of the controller's bus."""

    def on_message(self, message: can.Message, now_us: int) -> None:
        """A frame has come from the bus."""

    def advance(self, now_us: int) -> Iterable[can.Message]:
        """Takes the steps that are due; the frames to send."""

    def idle_us(self, now_us: int) -> int:
        """Microseconds until something is due."""

    def is_private(self, message: can.Message) -> bool:
        """Whether a frame that came is between play and the vehicle's node alone: the controller does not get it."""

    def has_sent(self, message: can.Message) -> bool:
        """Whether a frame that came is the vehicle's own, of a node that is on the controller's bus."""

    def ending(self) -> LaconicError | None:
        """Why the vehicle ends the run: a watchdog, a refused step; None: it goes on."""


@dataclass
class Traffic:
    """What passes on the controller's bus. `listeners` get every frame; `may_go_on` raises what ends the run."""

    clock: Clock
    listeners: list[Callable[[can.Message], None]] = field(default_factory=list)
    of_controller: list[Callable[[can.Message], None]] = field(default_factory=list)  # get the controller's alone
    may_go_on: Callable[[], None] = lambda: None
    frames_in: int = 0
    frames_out: int = 0

    def heard(self, message: can.Message) -> None:
        """A frame of the controller."""
        self.frames_in += 1
        for listener in (*self.of_controller, *self.listeners):
            listener(message)

    def sent(self, message: can.Message) -> None:
        """A frame of the vehicle."""
        self.frames_out += 1
        for listener in self.listeners:
            listener(message)


class Loop:
    """A vehicle on a bus. `others` are called in each round with the time: scripts and, in tests, controllers; each
    returns the instant at which it wants to be called again, None: whenever something happens."""

    def __init__(self, vehicle: Vehicle, bus: can.BusABC, traffic: Traffic,
                 others: Sequence[Callable[[int], int | None]] = ()):
        self.vehicle, self.bus, self.traffic, self.others = vehicle, bus, traffic, list(others)
        self.clock = traffic.clock
        self.is_virtual = isinstance(self.clock, VirtualClock)

    def run(self, duration_s: float | None, moved: Callable[[float], None] = lambda _: None) -> LaconicError | None:
        """Until the duration is over, the vehicle ends it, the bus dies or a signal comes; what ended it early."""
        began = last = self.clock.now_us()
        until_us = began + (FOR_EVER_US if duration_s is None else round(1e6 * duration_s))
        try:
            while (now := self.clock.now_us()) < until_us:
                self.traffic.may_go_on()
                due_us = self._call_others(now)
                if self._round(now):  # they hear it now
                    due_us = self._call_others(now)
                if (ending := self.vehicle.ending()) is not None:
                    return ending
                moved((now - last) / 1e6)
                last = now
                self._wait(min(until_us, due_us, self.clock.now_us() + LONGEST_WAIT_US))
        except (Interrupted, BusDied) as ending:
            return ending
        return None

    def _call_others(self, now_us: int) -> int:
        wanted = [each(now_us) for each in self.others]
        return min((each for each in wanted if each is not None), default=FOR_EVER_US)

    def _round(self, now_us: int) -> bool:
        """Frames that are there, then steps that are due, then their frames; whether there were any."""
        before = self.traffic.frames_out
        for _ in range(MOST_AT_ONCE):
            message = receive_on(self.bus, 0.0)
            if message is None:
                break
            self._take(message, now_us)
        for message in self.vehicle.advance(now_us):
            send_on(self.bus, message)
            self.traffic.sent(message)
        return self.traffic.frames_out > before

    def _take(self, message: can.Message, now_us: int) -> None:
        if not self.vehicle.is_private(message):
            (self.traffic.sent if self.vehicle.has_sent(message) else self.traffic.heard)(message)
        if not message.is_error_frame:
            self.vehicle.on_message(message, now_us)

    def _wait(self, until_us: int) -> None:
        """Until a frame comes or something is due; in virtual time that is at once."""
        now = self.clock.now_us()
        left_us = min(until_us - now, self.vehicle.idle_us(now))
        if left_us <= 0:
            return
        if self.is_virtual:
            self.clock.time_us += left_us  # type: ignore[attr-defined]
            return
        message = receive_on(self.bus, left_us / 1e6)
        if message is not None:
            self._take(message, self.clock.now_us())


@dataclass
class Lateness:
    """Periods that began late: by a period or more, and the worst by how much."""

    periods: int = 0
    late_periods: int = 0
    worst_us: int = 0

    def begins(self, late_us: int, period_us: float) -> None:
        """A period begins so late."""
        self.periods += 1
        self.worst_us = max(self.worst_us, late_us)
        self.late_periods += late_us >= period_us


class Seconds:
    """Wall time of a run."""

    def __init__(self) -> None:
        self._began = time.perf_counter()

    def passed(self) -> float:
        """So far."""
        return time.perf_counter() - self._began
