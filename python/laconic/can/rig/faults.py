"""Deliberate faults from a seed: what happens to each frame on the bus. No bus and no clock: frames and instants in
and out.

A model handles both directions of one bus. Its random numbers depend on the seed and on the order of the frames only.
"""

from __future__ import annotations

import heapq
import itertools
import random
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import can

OUT, IN = "out", "in"


@dataclass(frozen=True)
class Faults:
    """Faults and their frequency. Probabilities are per frame; times in seconds; all zero: no fault."""

    loss: float = 0.0                # the frame disappears
    duplication: float = 0.0         # it arrives twice
    reordering: float = 0.0          # it arrives after the next frame
    delay_s: float = 0.0             # it takes longer
    jitter_s: float = 0.0            # … by up to this much more
    corruption: float = 0.0          # bits of the payload are inverted, unnoticed by the controller's CRC
    corrupted_bits: int = 1          # how many
    stuck: float = 0.0               # from then on its identifier repeats the payload of that moment
    wrong_length: float = 0.0        # a byte is missing
    foreign: float = 0.0             # a random frame comes after it
    error_frames: float = 0.0        # the bus destroys it once: an error frame, then the frame again
    babble_per_s: float = 0.0        # a node that sends identifier 0 without pause, so many frames a second
    bus_off_after: int = 0           # so many frames, then nothing goes through …
    bus_off_s: float = 0.0           # … for this long; 0: for ever
    keep_queue: bool = False         # frames sent meanwhile are kept and sent on recovery, stale
    bitrate: int = 0                 # bits per second of the wire, with arbitration by identifier; 0: no limit
    direction: str = "both"          # out, in or both, seen from the user of the bus
    only_id: int = -1                # only this identifier; −1: all
    from_s: float = 0.0              # faults happen from here …
    until_s: float = float("inf")    # … to here
    seed: int = 1


MOST_BABBLE_PER_S = 1e4  # frames of eight bytes fill a bus of 1 Mbit/s before

LARGEST_ID = 0x1FFFFFFF

FIELD_TYPES: dict[str, type[Any]] = {field.name: type(field.default) for field in fields(Faults)}


def faults_from(options: Mapping[str, object]) -> Faults:
    """Faults from options that may be texts; ValueError names a wrong option."""
    faults = Faults(**{name: value_of(name, value) for name, value in options.items()})
    for name in ("loss", "duplication", "reordering", "corruption", "stuck", "wrong_length", "foreign", "error_frames"):
        if not 0.0 <= getattr(faults, name) <= 1.0:
            raise ValueError(f"{name}={getattr(faults, name):g}: a probability is from 0 to 1")
    for name in ("delay_s", "jitter_s", "corrupted_bits", "babble_per_s", "bus_off_after", "bus_off_s", "bitrate",
                 "from_s", "until_s"):
        if not 0 <= getattr(faults, name) < float("inf") and (name, getattr(faults, name)) != ("until_s", float("inf")):
            raise ValueError(f"{name}={getattr(faults, name):g}: give a finite number of zero or more")
    if faults.babble_per_s > MOST_BABBLE_PER_S:
        raise ValueError(f"babble_per_s={faults.babble_per_s:g}: no bus carries so many frames; give "
                         f"{MOST_BABBLE_PER_S:g} or less")
    if faults.only_id > LARGEST_ID:
        raise ValueError(f"only_id={faults.only_id:#x}: identifiers have 29 bits; give {LARGEST_ID:#x} or less")
    if faults.direction not in ("out", "in", "both"):
        raise ValueError(f"direction={faults.direction}: give out, in or both")
    return faults


TRUTHS = {"1": True, "true": True, "yes": True, "0": False, "false": False, "no": False}
WANTED = {float: "a number", int: "a whole number", bool: "true or false"}


def value_of(name: str, value: object) -> Any:
    """One option in its type; whole numbers may be hexadecimal, as identifiers are."""
    wanted = FIELD_TYPES[name]
    try:
        if wanted is bool:
            return TRUTHS[str(value).lower()]
        return int(value, 0) if wanted is int and isinstance(value, str) else wanted(value)
    except (KeyError, TypeError, ValueError):
        raise ValueError(f"{name}={value}: give {WANTED[wanted]}") from None


Delivery = tuple[float, int, str, can.Message]


class FaultModel:
    """Accepts frames and releases them, changed or not, at the time of their arrival."""

    def __init__(self, faults: Faults):
        self.faults = faults
        self.injected = 0            # number of faults so far
        self.first_injection_s: float | None = None
        self.active = True
        self._random = random.Random(faults.seed)
        self._order = itertools.count()
        self._due: list[Delivery] = []
        self._waiting: list[tuple[float, int, int, str, can.Message]] = []
        self._held: dict[str, can.Message] = {}
        self._stuck: dict[int, bytes] = {}
        self._passed = 0
        self._off_since: float | None = None
        self._queue: list[tuple[str, can.Message]] = []
        self._wire_free_s = 0.0
        self._next_babble_s: float | None = None

    # ---- in

    def put(self, message: can.Message, direction: str, now_s: float) -> None:
        """Accepts a frame at the start of its way."""
        if not self._applies(message, direction, now_s):
            self._travel(message, direction, now_s)
            return
        self._passed += 1
        if self._bus_is_off(message, direction, now_s):
            return
        for each in self._mangled(message, direction, now_s):
            self._travel(each, direction, now_s + self._extra_s(now_s))

    def _applies(self, message: can.Message, direction: str, now_s: float) -> bool:
        faults = self.faults
        return (self.active and faults.direction in (direction, "both") and faults.from_s <= now_s < faults.until_s
                and faults.only_id in (-1, message.arbitration_id))

    def _happens(self, probability: float, now_s: float) -> bool:
        happens = probability > 0.0 and self._random.random() < probability
        if happens:
            self._note(now_s)
        return happens

    def _note(self, now_s: float) -> None:
        self.injected += 1
        if self.first_injection_s is None:
            self.first_injection_s = now_s

    def _bus_is_off(self, message: can.Message, direction: str, now_s: float) -> bool:
        faults = self.faults
        if not faults.bus_off_after or self._passed <= faults.bus_off_after:
            return False
        if self._off_since is None:
            self._off_since = now_s
        if faults.bus_off_s and now_s - self._off_since >= faults.bus_off_s:
            return False
        self._note(now_s)
        if faults.keep_queue:
            self._queue.append((direction, message))
        return True

    def _mangled(self, message: can.Message, direction: str, now_s: float) -> list[can.Message]:
        """The frames that continue instead of this one."""
        faults = self.faults
        if self._happens(faults.loss, now_s):
            return []
        if self._happens(faults.corruption, now_s):
            message = self.corrupted(message)
        if self._happens(faults.wrong_length, now_s):
            message = self.of_wrong_length(message)
        message = self._maybe_stuck(message, now_s)
        frames = [message, message] if self._happens(faults.duplication, now_s) else [message]
        if self._happens(faults.foreign, now_s):
            frames.append(self.foreign())
        if self._happens(faults.error_frames, now_s):
            frames.insert(0, error_frame())
        held = self._held.pop(direction, None)
        if held is not None:
            return [*frames, held]
        if self._happens(faults.reordering, now_s):
            self._held[direction] = message
            return []
        return frames

    def corrupted(self, message: can.Message) -> can.Message:
        """The frame with some bits inverted."""
        bits = 8 * len(message.data)
        data = bytearray(message.data)
        for bit in self._random.sample(range(bits), min(self.faults.corrupted_bits, bits)):
            data[bit // 8] ^= 1 << bit % 8
        return replaced(message, data)

    def of_wrong_length(self, message: can.Message) -> can.Message:
        """A classic frame loses a byte; an FD frame gets the next shorter length of CAN FD."""
        shorter = {64: 48, 48: 32, 32: 24, 24: 20, 20: 16, 16: 12, 12: 8}.get(len(message.data))
        length = shorter if message.is_fd and shorter else max(0, len(message.data) - 1)
        return replaced(message, message.data[:length])

    def _maybe_stuck(self, message: can.Message, now_s: float) -> can.Message:
        identifier = message.arbitration_id
        if identifier in self._stuck:
            self._note(now_s)
            return replaced(message, bytearray(self._stuck[identifier]))
        if self.faults.stuck > 0.0 and self._random.random() < self.faults.stuck:
            self._stuck[identifier] = bytes(message.data)
        return message

    def foreign(self) -> can.Message:
        """A frame with random identifier, length and payload."""
        length = self._random.randrange(9)
        return can.Message(arbitration_id=self._random.randrange(0x800), is_extended_id=False,
                           data=self._random.randbytes(length))

    def _extra_s(self, now_s: float) -> float:
        faults = self.faults
        extra = faults.delay_s + (self._random.random() * faults.jitter_s if faults.jitter_s else 0.0)
        if extra:
            self._note(now_s)
        return extra

    # ---- the wire

    def _travel(self, message: can.Message, direction: str, at_s: float) -> None:
        order = next(self._order)
        if self.faults.bitrate:
            if at_s < self._wire_free_s:
                self._note(at_s)  # it has to wait
            self._waiting.append((at_s, message.arbitration_id, order, direction, message))
        else:
            heapq.heappush(self._due, (at_s, order, direction, message))

    def take(self, now_s: float) -> list[tuple[str, can.Message]]:
        """Frames that have arrived by now, in order."""
        if self._queue:
            self._recover(now_s)
        if self.faults.babble_per_s:
            self._babble(now_s)
        if self._waiting:
            self._arbitrate(now_s)
        arrived: list[tuple[str, can.Message]] = []
        while self._due and self._due[0][0] <= now_s:
            _, _, direction, message = heapq.heappop(self._due)
            arrived.append((direction, message))
        return arrived

    def _recover(self, now_s: float) -> None:
        """After bus-off: sends the frames of a kept queue now, all of them stale."""
        off_s = 0.0 if self._off_since is None else now_s - self._off_since
        over = self.faults.bus_off_s and off_s >= self.faults.bus_off_s
        if over or not self.active:
            queue, self._queue = self._queue, []
            for direction, message in queue:
                self._travel(message, direction, now_s)

    def _babble(self, now_s: float) -> None:
        faults = self.faults
        if not self.active or not faults.from_s <= now_s < faults.until_s:
            return
        if self._next_babble_s is None:
            self._next_babble_s = now_s
        while self._next_babble_s <= now_s:
            self._note(now_s)
            noise = can.Message(arbitration_id=0, is_extended_id=False, data=self._random.randbytes(8))
            self._travel(noise, OUT, self._next_babble_s)
            self._next_babble_s += 1.0 / faults.babble_per_s

    def _arbitrate(self, now_s: float) -> None:
        """One frame at a time; of those that wait when the bus becomes idle, the lowest identifier is first."""
        while self._waiting:
            begin = max(self._wire_free_s, min(each[0] for each in self._waiting))
            if begin > now_s:
                return
            chosen = min((each for each in self._waiting if each[0] <= begin), key=lambda each: (each[1], each[2]))
            self._waiting.remove(chosen)
            self._wire_free_s = begin + frame_seconds(chosen[4], self.faults.bitrate)
            heapq.heappush(self._due, (self._wire_free_s, chosen[2], chosen[3], chosen[4]))

    def next_s(self) -> float:
        """Instant at which the next frame arrives; infinite: none is on its way."""
        waiting = min((each[0] for each in self._waiting), default=float("inf"))
        return min(self._due[0][0] if self._due else float("inf"), max(waiting, self._wire_free_s))


ERROR_CLASS = 0x88                    # SocketCAN's: a violation of the protocol, an error on the bus
DISTURBED = (0, 0, 4, 0, 0, 0, 0, 0)  # ... and its payload: a stuff error


def error_frame() -> can.Message:
    """What a station hears of a frame that the bus has destroyed; its sender repeats it."""
    return can.Message(arbitration_id=ERROR_CLASS, is_extended_id=False, is_error_frame=True, data=DISTURBED)


def replaced(message: can.Message, data: bytearray) -> can.Message:
    """The same frame with another payload."""
    return can.Message(arbitration_id=message.arbitration_id, is_extended_id=message.is_extended_id, data=data,
                       is_fd=message.is_fd, bitrate_switch=message.bitrate_switch, timestamp=message.timestamp)


def frame_seconds(message: can.Message, bitrate: int) -> float:
    """Transmission time of a frame with the most stuff bits possible (FD frames as if at one rate)."""
    length = len(message.data)
    stuffed = (54 if message.is_extended_id else 34) + 8 * length
    return (stuffed + (stuffed - 1) // 4 + 13) / bitrate
