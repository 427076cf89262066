"""Signals of a message as a log needs them: some of them, each on its own pages, from one frame."""

from __future__ import annotations

import struct
from collections.abc import Iterable, Mapping

from cantools.database.can import Message
from cantools.database.can.signal import Signal

FLOATS = {16: "e", 32: "f", 64: "d"}


class Bits:
    """Where a signal is in a payload of so many bytes, and what it means."""

    def __init__(self, signal: Signal, length: int):
        self.signal = signal
        self.is_little = signal.byte_order == "little_endian"
        first = 8 * (signal.start // 8) + 7 - signal.start % 8  # counted from the highest bit of byte 0 on
        self._shift = signal.start if self.is_little else 8 * length - first - signal.length
        self._mask = (1 << signal.length) - 1
        self._half = 1 << signal.length - 1 if signal.is_signed else 0
        self._scale, self._offset = signal.scale, signal.offset
        self._float = struct.Struct(f">{FLOATS[signal.length]}") if signal.is_float else None

    def raw(self, word: int) -> int | float:
        """The raw value in a payload, which is one whole number in the signal's order of bytes."""
        found = word >> self._shift & self._mask
        if self._float is not None:
            value: float = self._float.unpack(found.to_bytes(self._float.size, "big"))[0]
            return value
        return found - 2 * self._half if self._half and found >= self._half else found

    def value(self, word: int) -> float:
        """The value in the signal's unit."""
        return float(self.raw(word) * self._scale + self._offset)


class Words:
    """A payload as one whole number, in either order of bytes."""

    __slots__ = ("_big", "_data", "_little")

    def __init__(self, data: bytes):
        self._data = data
        self._little: int | None = None
        self._big: int | None = None

    def of(self, bits: Bits) -> int:
        """In the order of a signal."""
        if bits.is_little:
            if self._little is None:
                self._little = int.from_bytes(self._data, "little")
            return self._little
        if self._big is None:
            self._big = int.from_bytes(self._data, "big")
        return self._big


class Wanted:
    """The signals of one message that a map takes, and the multiplexers that select them."""

    def __init__(self, message: Message, names: Iterable[str]):
        self.message = message
        self._bits = {each.name: Bits(each, message.length) for each in message.signals}
        self.names = tuple(names)
        self._taken = [(name, self._bits[name], self._pages(name)) for name in self.names]

    def _pages(self, name: str) -> list[tuple[Bits, frozenset[int]]]:
        """The multiplexers that select a signal, from its own outwards, with the values that do."""
        found: list[tuple[Bits, frozenset[int]]] = []
        signal, seen = self._bits[name].signal, {name}
        while (selector := signal.multiplexer_signal) is not None and selector not in seen:
            seen.add(selector)
            found.append((self._bits[selector], frozenset(signal.multiplexer_ids or ())))
            signal = self._bits[selector].signal
        return found

    def values(self, data: bytes) -> dict[str, float]:
        """The wanted signals that are on the page of this payload, which is as long as its message."""
        words = Words(data[: self.message.length])
        return {name: bits.value(words.of(bits)) for name, bits, pages in self._taken
                if not pages or all(each.raw(words.of(each)) in ids for each, ids in pages)}

    def one(self, name: str, data: bytes) -> float:
        """A signal that is in every frame."""
        bits = self._bits[name]
        return bits.value(Words(data[: self.message.length]).of(bits))

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
