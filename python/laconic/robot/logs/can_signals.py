"""Signals of a message as a log needs them: some of them, each on its own pages, from one frame."""

from __future__ import annotations

import struct
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from cantools.database.can import Message
from cantools.database.can.signal import Signal

FLOATS = {16: "e", 32: "f", 64: "d"}


@dataclass(frozen=True)
class Bits:
    """Where a signal is in a payload, and what it means."""

    signal: Signal

    def raw(self, data: bytes) -> int | float:
        """The raw value in a payload that has all of the signal's bits."""
        signal = self.signal
        if signal.byte_order == "little_endian":
            word = int.from_bytes(data, "little") >> signal.start
        else:
            first = 8 * (signal.start // 8) + 7 - signal.start % 8  # counted from the highest bit of byte 0 on
            word = int.from_bytes(data, "big") >> (8 * len(data) - first - signal.length)
        word &= (1 << signal.length) - 1
        if signal.is_float:
            value: float = struct.unpack(f">{FLOATS[signal.length]}", word.to_bytes(signal.length // 8, "big"))[0]
            return value
        return word - (1 << signal.length) if signal.is_signed and word >> signal.length - 1 else word

    def value(self, data: bytes) -> float:
        """The value in the signal's unit."""
        return float(self.raw(data) * self.signal.scale + self.signal.offset)


class Wanted:
    """The signals of one message that a map takes, and the multiplexers that select them."""

    def __init__(self, message: Message, names: Iterable[str]):
        self.message = message
        self._bits = {each.name: Bits(each) for each in message.signals}
        self.names = tuple(names)

    def values(self, data: bytes) -> dict[str, float]:
        """The wanted signals that are on the page of this payload."""
        whole = data[: self.message.length]
        return {name: self._bits[name].value(whole) for name in self.names if self._is_on(name, whole)}

    def one(self, name: str, data: bytes) -> float:
        """A signal that is in every frame."""
        return self._bits[name].value(data[: self.message.length])

    def _is_on(self, name: str, data: bytes) -> bool:
        """Whether the multiplexers of a signal, from its own outwards, have the values that select it."""
        signal, seen = self._bits[name].signal, {name}
        while (selector := signal.multiplexer_signal) is not None and selector not in seen:
            seen.add(selector)
            if self._bits[selector].raw(data) not in (signal.multiplexer_ids or ()):
                return False
            signal = self._bits[selector].signal
        return True

    def page_of(self, name: str) -> str:
        """The page of a signal in words; empty for one that is in every frame."""
        signal = self._bits[name].signal
        if signal.multiplexer_signal is None:
            return ""
        ids = signal.multiplexer_ids or []
        shown = ", ".join(map(str, ids[:4])) + (" …" if len(ids) > 4 else "")
        return f", the page with {signal.multiplexer_signal} = {shown}"


def float_fault(signals: Mapping[str, Signal]) -> str | None:
    """The name of a signal whose bits cannot be a floating-point number."""
    return next((name for name, each in signals.items() if each.is_float and each.length not in FLOATS), None)
