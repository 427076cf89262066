"""A DBC behind a map: its messages and signals by name, raw values, and the pages of multiplexed messages."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from pathlib import Path
from typing import Any, NoReturn

from cantools.database.can import Message
from cantools.database.can.signal import Signal

from laconic.can.dbc_file import Dbc
from laconic.errors import BadInput, nearest_of, shown

FLOAT_BITS = (16, 32, 64)
LARGEST_FLOATS = {16: 65504.0, 32: 3.4028234663852886e38}
FD_LENGTHS = (12, 16, 20, 24, 32, 48, 64)

Page = tuple[tuple[str, int], ...]
"""The multiplexers that select a part of a message, outer ones first, with their values."""


class DbcMessage:
    """One message of a DBC as a map uses it; `where` names the map's entry in messages."""

    def __init__(self, dbc: Path, database: Dbc, where: str, name: str, key: str = "message"):
        self.dbc, self.where = dbc, where
        self.name = name
        entry = database.named(name, f"{where}.{key}: {dbc.name}")
        if sum(each.name == name for each in database.messages) > 1:
            self.fail("message", "is in the DBC twice; rename one of them there")
        same = [each.name for each in database.messages if each is not entry and each.frame_id == entry.frame_id
                and each.is_extended_frame == entry.is_extended_frame]
        if same:
            self.fail("message", f"has the identifier of {same[0]}, too, so that a frame could be either; correct the "
                      "DBC")
        database.check(entry)
        self.c: Message = entry.c
        self._check()
        if self.c.is_container:
            self.fail("message", "is a container, which a map cannot join; name a message that carries signals")
        self.signals: dict[str, Signal] = {each.name: each for each in self.c.signals}

    def _check(self) -> None:
        """BadInput for a message that no bus can carry."""
        length = self.c.length
        if length > 8 and length not in FD_LENGTHS or length > 8 and not self.c.is_fd:
            self.fail("message", f"has {length} bytes, which {'CAN FD' if self.c.is_fd else 'classic CAN'} cannot "
                      "send; correct the DBC" + ("" if self.c.is_fd else ", or its VFrameFormat for CAN FD"))
        names = [each.name for each in self.c.signals]
        if twice := [each for each in names if names.count(each) > 1]:
            self.fail("message", f"has two signals {twice[0]} in the DBC; rename one of them there")
        if odd := [each for each in self.c.signals if each.is_float and each.length not in FLOAT_BITS]:
            self.fail("message", f"has {odd[0].name} as a float of {odd[0].length} bits; correct the DBC to 16, 32 or "
                      "64")
        self._check_multiplexers({each.name: each.multiplexer_signal for each in self.c.signals})

    def _check_multiplexers(self, outer: Mapping[str, str | None]) -> None:
        for name in outer:
            seen = {name}
            above = outer[name]
            while above is not None:
                if above in seen:
                    self.fail("message", f"has multiplexers that select each other, such as {name}; correct the DBC")
                seen.add(above)
                above = outer[above]

    @property
    def key(self) -> tuple[int, bool]:
        """Identifier, and whether it has 29 bits."""
        return self.c.frame_id, self.c.is_extended_frame

    def fail(self, key: str, text: str, where: str | None = None) -> NoReturn:
        """BadInput that names map, DBC and message; a text that begins with a dot goes on with a signal."""
        space = "" if text.startswith(".") else " "
        raise BadInput(f"{where or self.where}.{key}: {self.dbc.name}: {self.name}{space}{text}")

    def signal(self, name: str, key: str = "name", where: str | None = None) -> Signal:
        """A signal by its name."""
        if name not in self.signals:
            self.fail(key, f"has no signal {shown(name)}; {nearest_of(name, self.signals)}", where)
        if not self.signals[name].scale:
            self.fail(key, f"has the scale 0 for {name}, so that it says nothing; correct the DBC", where)
        return self.signals[name]

    # ---- multiplexers

    def pages_of(self, name: str) -> set[Page]:
        """The pages that carry a signal; the empty one: it is in every frame."""
        signal = self.signals[name]
        if signal.multiplexer_signal is None:
            return {()}
        outer = self.pages_of(signal.multiplexer_signal)
        return {(*page, (signal.multiplexer_signal, value)) for page in outer for value in signal.multiplexer_ids or ()}

    def pages(self, names: Iterable[str]) -> list[Page]:
        """The pages that together carry these signals, in ascending order; a page within another stands for both."""
        found = set().union(*(self.pages_of(name) for name in names))
        whole = [page for page in found if not any(page != other and page == other[: len(page)] for other in found)]
        return sorted(whole, key=lambda page: [value for _, value in page])

    def is_on(self, name: str, page: Page) -> bool:
        """Whether a signal is part of a page."""
        return any(set(each) <= set(page) for each in self.pages_of(name))

    def completed(self, page: Page) -> Page:
        """The page with a value for each multiplexer that it leaves open: the DBC's start value where that is one of
        its pages, else its first one."""
        found = dict(page)
        while (open_one := next((name for name, signal in self.signals.items() if signal.is_multiplexer
                                 and name not in found and self.is_on(name, tuple(found.items()))), None)) is not None:
            ids, start = self._ids(open_one), start_value(self.signals[open_one])
            found[open_one] = int(start) if start in ids or not ids else min(ids)
        return tuple(found.items())

    def _ids(self, multiplexer: str) -> set[int]:
        """The values of a multiplexer that select signals."""
        return {each for signal in self.signals.values() if signal.multiplexer_signal == multiplexer
                for each in signal.multiplexer_ids or ()}

    # ---- raw values

    def initial(self, page: Page) -> dict[str, int | float]:
        """Raw start values of all signals on a page: those of the DBC, else 0."""
        fixed = dict(page)
        return {name: fixed.get(name, start_value(signal)) for name, signal in self.signals.items()
                if self.is_on(name, page)}

    def encode(self, raw: Mapping[str, int | float]) -> bytearray:
        """The payload of raw values, which fit their signals."""
        return bytearray(self.c.encode(dict(raw), scaling=False, strict=False, padding=False))

    def decode(self, data: bytes) -> dict[str, float]:
        """Scaled values of the signals on the page that came."""
        values: Any = self.c.decode(data, decode_choices=False, scaling=True, allow_excess=False)
        return {name: float(value) for name, value in values.items()}

    def decode_raw(self, data: bytes) -> dict[str, Any]:
        """Raw values."""
        values: Any = self.c.decode(data, decode_choices=False, scaling=False)
        return dict(values)


def start_value(signal: Signal) -> int | float:
    """The DBC's raw start value, else 0."""
    value = signal.raw_initial
    return 0 if value is None else value if isinstance(value, (int, float)) else 0


def raw_range(signal: Signal) -> tuple[int | float, int | float]:
    """The least and largest raw value: what the bits can hold, less where the DBC says less; whole for integers."""
    if signal.is_float:
        largest = LARGEST_FLOATS.get(signal.length, 1.7976931348623157e308)
        return -largest, largest
    low, high = bit_range(signal)
    if signal.minimum is not None and signal.maximum is not None and signal.minimum < signal.maximum:
        ends = sorted(exact_raw(signal, limit) for limit in (signal.minimum, signal.maximum))
        low, high = max(low, round(ends[0])), min(high, round(ends[1]))
    return low, high


def bit_range(signal: Signal) -> tuple[int, int]:
    """What the bits of a whole number can hold."""
    half = 1 << signal.length - 1
    return (-half, half - 1) if signal.is_signed else (0, 2 * half - 1)


def exact_raw(signal: Signal, value: float) -> Fraction:
    """The raw value of a value in the signal's unit, with all digits that are written."""
    scale, offset = exact(signal.scale), exact(signal.offset)
    return (exact(value) - offset) / scale


def exact(value: float) -> Fraction:
    """A number as its decimals are written: 0.1 is a tenth."""
    return Fraction(value) if isinstance(value, int) else Fraction(repr(float(value)))


def byte_slice(message: DbcMessage, signal: Signal) -> slice | None:
    """The whole bytes that a signal fills; None where it fills none exactly."""
    if signal.length % 8:
        return None
    count = signal.length // 8
    if signal.byte_order == "little_endian":
        return slice(signal.start // 8, signal.start // 8 + count) if signal.start % 8 == 0 else None
    return slice(signal.start // 8, signal.start // 8 + count) if signal.start % 8 == 7 else None
