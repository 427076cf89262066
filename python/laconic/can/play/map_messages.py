"""Messages of a map joined to a DBC: payloads from model values, model values from payloads."""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction

from cantools.database.can.signal import Signal

from laconic.can.play.checksums import COUNTS_TO_14, E2E_COUNTERS, E2E_WIDTHS, SUMS
from laconic.can.play.map_dbc import DbcMessage, Page, bit_range, byte_slice, exact, exact_raw, raw_range, start_value
from laconic.can.play.map_file import EXACT, Conversion, Joint, MessageMap, Received, Sent
from laconic.can.play.map_signals import OF_ANGLE

TURN_RAD = 2.0 * math.pi


def to_model(conversion: Conversion, model: str, value: float) -> float:
    """A signal's value as the model's input."""
    found = (conversion.factor * value + conversion.offset) / conversion.gear
    return found * TURN_RAD / conversion.counts_per_turn if conversion.counts_per_turn else found


def from_model(conversion: Conversion, value: float) -> float:
    """An output of the model as a signal's value, not yet rounded."""
    turned = value * conversion.gear
    if conversion.counts_per_turn:
        turned *= conversion.counts_per_turn / TURN_RAD
    return conversion.factor * turned + conversion.offset


class Protected:
    """What a message of either direction has: counter and checksum."""

    def __init__(self, given: MessageMap, message: DbcMessage):
        self.given, self.message = given, message
        self.counter_signal = self._counter()
        self.checksum_signal = self._checksum()
        self.modulo = 0
        if self.counter_signal is not None and given.counter is not None:
            self.modulo = given.counter.modulo or self._most_counts(self.counter_signal)
        self._check_protection()

    def _check_protection(self) -> None:
        """BadInput where counter, checksum and joined signals are in each other's way."""
        counter, checksum, given = self.counter_signal, self.checksum_signal, self.given
        if counter is not None and counter is checksum:
            self.message.fail("checksum.signal", f"has {counter.name} as counter and as checksum; give two signals")
        if given.counter is not None and (given.counter.max_delta or 0) >= self.modulo > 0:
            self.message.fail("counter.max_delta", f"takes steps of {given.counter.max_delta}, but its counter has "
                              f"{self.modulo} counts, so that every frame would pass; give less")
        for joint in given.joints:
            for signal, what in ((counter, "counter"), (checksum, "checksum")):
                if signal is not None and joint.signal == signal.name:
                    self.message.fail("name", f"has {joint.signal} as its {what}; take it out here", joint.where)
        if checksum is None or given.checksum is None or given.checksum.kind not in E2E_COUNTERS:
            return
        start, length = E2E_COUNTERS[given.checksum.kind]
        if counter is None:
            self.message.fail("counter", f"has no counter, which {given.checksum.kind} needs; give "
                              "counter = { signal = … }")
        if lowest_bit(counter) != start or counter.length != length:
            self.message.fail("counter.signal", f"has {counter.name} elsewhere than {given.checksum.kind}, whose "
                              f"counter has {length} bits from bit {start} on; name the signal that is there")

    def _counter(self) -> Signal | None:
        counter = self.given.counter
        if counter is None:
            return None
        signal = self.message.signal(counter.signal, "counter.signal")
        if signal.is_float or signal.multiplexer_signal is not None or signal.is_multiplexer:
            self.message.fail("counter.signal", f"has {signal.name} as a number with a fraction, on a page or as "
                              "multiplexer; a counter is a whole number that is in every frame")
        if counter.modulo is not None and counter.modulo > self._most_counts(signal):
            self.message.fail("counter.modulo", f"has {signal.length} bits for {signal.name}, too few to count up to "
                              f"{counter.modulo}; give {self._most_counts(signal)} or less")
        return signal

    def _most_counts(self, signal: Signal) -> int:
        """How many counts a counter has, by its bits and its profile."""
        checksum = self.given.checksum
        return min(1 << signal.length, 15 if checksum is not None and checksum.kind in COUNTS_TO_14 else 1 << 64)

    def _checksum(self) -> Signal | None:
        checksum = self.given.checksum
        if checksum is None:
            return None
        signal = self.message.signal(checksum.signal, "checksum.signal")
        if signal.is_float or signal.multiplexer_signal is not None or signal.is_multiplexer:
            self.message.fail("checksum.signal", f"has {signal.name} as a number with a fraction, on a page or as "
                              "multiplexer; a checksum is a whole number that is in every frame")
        bytes_of = byte_slice(self.message, signal)
        if checksum.kind not in SUMS and (signal.length != checksum.width or bytes_of is None):
            self.message.fail("checksum.kind", f"has {signal.length} bits for {signal.name}; {checksum.kind} needs "
                              f"{checksum.width} in whole bytes")
        if checksum.kind in E2E_WIDTHS and bytes_of is not None and bytes_of.start != 0:
            self.message.fail("checksum.kind", f"has {signal.name} in byte {bytes_of.start}; {checksum.kind} has its "
                              "checksum in byte 0")
        return signal

    def checksum_of(self, raw: Mapping[str, int | float], payload: bytes | None = None) -> int | None:
        """The checksum of raw values, or of a payload that came with them; None: there is none."""
        checksum, signal = self.given.checksum, self.checksum_signal
        if checksum is None or signal is None:
            return None
        plain = self.message.encode({**raw, signal.name: 0})
        at = byte_slice(self.message, signal)
        if payload is not None:
            plain = without(payload, bytes(plain), bytes(self.message.encode({**raw, signal.name: all_ones(signal)})))
        found = checksum.of(bytes(plain), self.message.c.frame_id, at or slice(0, 0))
        if signal.byte_order == "big_endian" and checksum.kind in E2E_WIDTHS and at is not None:
            found = int.from_bytes(found.to_bytes(at.stop - at.start, "little"), "big")
        found &= (1 << signal.length) - 1
        return found - (1 << signal.length) if signal.is_signed and found >> signal.length - 1 else found


def lowest_bit(signal: Signal) -> int:
    """The place of a signal's lowest bit, as a little-endian DBC counts; it may cross bytes only in that order."""
    if signal.byte_order == "little_endian" or signal.length > signal.start % 8 + 1:
        return int(signal.start)
    return int(signal.start - signal.length + 1)


def all_ones(signal: Signal) -> int:
    """The raw value whose bits are all set."""
    return -1 if signal.is_signed else (1 << signal.length) - 1


def without(payload: bytes, zeros: bytes, ones: bytes) -> bytearray:
    """A payload with the bits cleared in which two others differ."""
    return bytearray(p & ~(z ^ o) & 0xFF for p, z, o in zip(payload, zeros, ones, strict=True))


class Receiver(Protected):
    """A message of the controller: its payloads become inputs of the model."""

    def __init__(self, given: Received, message: DbcMessage):
        super().__init__(given, message)
        self.received = given
        for joint in given.joints:
            message.signal(joint.signal, "name", joint.where)
        self._last: int | None = None

    def take(self, payload: bytes) -> tuple[dict[str, float], str | None]:
        """Inputs by name; or the reason why the frame is refused."""
        try:
            values, raw = self.message.decode(payload), self.message.decode_raw(payload)
        except Exception:  # a decoder may raise any exception on unexpected bytes
            return {}, "wrong length or page"
        if self.checksum_signal and self.checksum_of(raw, payload) != raw[self.checksum_signal.name]:
            return {}, "wrong checksum"
        if self.counter_signal and (reason := self._counts(self.counter_signal, int(raw[self.counter_signal.name]))):
            return {}, reason
        found = {joint.model: to_model(joint.conversion, joint.model, values[joint.signal])
                 for joint in self.given.joints if joint.signal in values}
        return (found, None) if all(map(math.isfinite, found.values())) else ({}, "a value that is not finite")

    def _counts(self, signal: Signal, raw: int) -> str | None:
        """Why a frame with this count is refused; a count that the counter has is the reference for the next one in any
        case, and one that it never has is not."""
        count, counter = raw % (1 << signal.length), self.given.counter
        if count >= self.modulo:
            return "impossible count"
        last, self._last = self._last, count
        if last is None:
            return None
        delta = (count - last) % self.modulo
        if delta == 0:
            return "repeated"
        limit = counter.max_delta if counter else None
        return "wrong count" if limit is not None and delta > limit else None


@dataclass
class Cut:
    """How often a value did not fit its signal and was cut to its end."""

    count: int = 0


class Sender(Protected):
    """A message of the vehicle: its payloads are made of outputs of the model."""

    def __init__(self, given: Sent, message: DbcMessage):
        super().__init__(given, message)
        self.sent, self.cut = given, Cut()
        for joint in given.joints:
            message.signal(joint.signal, "name", joint.where)
            if joint.constant is not None:
                self._check_constant(joint, joint.constant)
            if joint.wrap:
                self._check_wrap(joint, message.signals[joint.signal])
        self.pages = self._pages()
        if given.pages is not None and not any(signal.is_multiplexer for signal in message.signals.values()):
            message.fail("pages", "has no effect on a message without a multiplexer; take it out")
        self._check_starts()
        self._next_page, self._count = 0, -1

    def _check_wrap(self, joint: Joint, signal: Signal) -> None:
        if signal.is_float:
            self.message.fail("wrap", f"has {joint.signal} as a number with a fraction, which does not wrap; take it "
                              "out", joint.where)
        counts = int(raw_range(signal)[1]) + 1
        if math.isfinite(joint.wrap) and joint.wrap > counts:
            self.message.fail("wrap", f"is {joint.wrap}, but {joint.signal} holds no more than {counts - 1}; "
                              f"give {counts} or less, or true for where its bits end", joint.where)

    def _check_constant(self, joint: Joint, value: int | float) -> None:
        """BadInput for a constant that its signal cannot hold as it is written."""
        signal = self.message.signals[joint.signal]
        if isinstance(value, float) and abs(value) >= EXACT and not signal.is_float:
            self.message.fail("value", f"has {value:.17g} as a decimal for {joint.signal}, which may have lost digits; "
                              "write it as a whole number, without a point", joint.where)
        if self.raw_of(joint, value) is None:
            self.message.fail("value", f"cannot hold {value} in {joint.signal}; give a value of its range", joint.where)
        near = nearest_constants(signal, value)
        if len(near) > 1:
            self.message.fail("value", f"cannot hold {value} in {joint.signal}, whose values are {plain(near[0])} and "
                              f"{plain(near[1])} there; give one of them", joint.where)

    def _check_starts(self) -> None:
        """BadInput for a start value of the DBC that the bits of its signal cannot hold."""
        for name, signal in self.message.signals.items():
            low, high = raw_range(signal) if signal.is_float else bit_range(signal)
            start = start_value(signal)
            if not low <= start <= high or (not signal.is_float and start != int(start)):
                self.message.fail("message", f"has the start value {start} for {name}, which its {signal.length} bits "
                                  "cannot hold; correct the DBC")

    def _pages(self) -> list[Page]:
        """The pages that carry the joined signals; a constant multiplexer chooses among them."""
        fixed = {joint.signal: self.raw_of(joint, joint.constant) for joint in self.given.joints
                 if joint.constant is not None and self.message.signals[joint.signal].is_multiplexer}
        for joint in self.given.joints:
            if joint.constant is None and self.message.signals[joint.signal].is_multiplexer:
                self.message.fail("from", f"has {joint.signal} as its multiplexer, which follows from the signals that "
                                  "are joined; give value, or take it out", joint.where)
        names = [joint.signal for joint in self.given.joints]
        pages = [page for page in self.message.pages(names)
                 if all(fixed.get(name, value) == value for name, value in page)]
        lone = [name for name in fixed if not any(name == each for page in pages for each, _ in page)]
        if not pages:
            self.message.fail("signal", "has no page with all of these signals and the multiplexer's value; correct "
                              "the value")
        if lone:  # its value alone chooses the page
            pages = [(*page, *((name, int(fixed[name] or 0)) for name in lone)) for page in pages]
        pages = [self.message.completed(page) for page in pages]
        for joint in self.given.joints:
            if not any(self.message.is_on(joint.signal, page) for page in pages):
                self.message.fail("name", f"has no {joint.signal} where its multiplexer has the value that is given; "
                                  "correct one of them", joint.where)
        return pages

    def raw_of(self, joint: Joint, value: int | float) -> int | float | None:
        """A value in the signal's unit as its nearest raw value; None where it does not fit."""
        signal = self.message.signals[joint.signal]
        low, high = raw_range(signal)
        raw = exact_raw(signal, value)
        if not low <= raw <= high:
            return None
        return float(raw) if signal.is_float else round(raw)

    def payloads(self, read: Callable[[str], float]) -> Iterator[bytes]:
        """The frames of one instant; `read` gives an output of the model by name."""
        pages = self.pages
        if self.sent.pages in (None, "in turn"):
            pages = [self.pages[self._next_page]]
            self._next_page = (self._next_page + 1) % len(self.pages)
        for page in pages:
            yield self._payload(page, read)

    def _payload(self, page: Page, read: Callable[[str], float]) -> bytes:
        raw = self.message.initial(page)
        for joint in self.given.joints:
            if joint.signal in raw and joint.signal not in dict(page):
                raw[joint.signal] = self._raw(joint, read)
        if self.counter_signal is not None:
            self._count = (self._count + 1) % self.modulo
            raw[self.counter_signal.name] = wrapped(self.counter_signal, self._count, math.inf)
        if (checksum := self.checksum_of(raw)) is not None and self.checksum_signal is not None:
            raw[self.checksum_signal.name] = checksum
        return bytes(self.message.encode(raw))

    def _raw(self, joint: Joint, read: Callable[[str], float]) -> int | float:
        """A joined signal's raw value: counts in whole ones, everything else rounded; cut where it does not fit."""
        signal = self.message.signals[joint.signal]
        if joint.constant is not None:
            return self.raw_of(joint, joint.constant) or 0
        unrounded = (from_model(joint.conversion, read(joint.model)) - signal.offset) / signal.scale
        low, high = raw_range(signal)
        if not math.isfinite(unrounded):  # beyond every number, by the map's own factors
            self.cut.count += 1
            return low if unrounded < 0.0 else high
        if signal.is_float:
            raw: int | float = unrounded
        else:
            is_count = bool(joint.conversion.counts_per_turn) and OF_ANGLE.match(joint.model) is not None
            raw = math.floor(unrounded) if is_count else round(unrounded)
        if joint.wrap:
            return wrapped(signal, int(raw), joint.wrap)
        if not low <= raw <= high:
            self.cut.count += 1
            raw = min(max(raw, low), high)
        return raw


FLOAT_CODES = {16: "<e", 32: "<f", 64: "<d"}


def nearest_constants(signal: Signal, value: int | float) -> list[Fraction]:
    """The value itself where the signal holds it, else those around it. Decimals of a floating-point signal are rounded
    as in every such number."""
    raw, scale, offset = exact_raw(signal, value), exact(signal.scale), exact(signal.offset)
    if not signal.is_float:
        rawest = {math.floor(raw), math.ceil(raw)}
        return [each * scale + offset for each in sorted(rawest)]
    if raw.denominator != 1:
        return [raw]
    code = FLOAT_CODES[signal.length]
    held = Fraction(struct.unpack(code, struct.pack(code, float(raw)))[0])
    return [raw] if held == raw else sorted({held, 2 * raw - held})


def plain(value: Fraction) -> str:
    """A number as a person writes it."""
    return str(value.numerator) if value.denominator == 1 else f"{float(value):.12g}"


def wrapped(signal: Signal, raw: int, modulo: float) -> int:
    """A raw value that begins again: at the modulo, else where its bits end."""
    if math.isfinite(modulo):
        return raw % int(modulo)
    raw &= (1 << signal.length) - 1
    return raw - (1 << signal.length) if signal.is_signed and raw >> signal.length - 1 else raw
