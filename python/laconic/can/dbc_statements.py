"""The statements of a DBC file, read one by one: messages with their signals, and what is wrong with them."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from cantools.database.can import Message
from cantools.database.can.signal import Signal
from cantools.database.conversion import BaseConversion

EXTENDED = 1 << 31                # in the identifier of a message that has 29 bits
MOST_BYTES = 64                   # of a frame
MOST_IDS = 1 << 16                # of a multiplexer, of one signal
FLOATS = {"1": 32, "2": 64}       # kinds of SIG_VALTYPE_
FORMATS = {14: "StandardCAN_FD", 15: "ExtendedCAN_FD"}  # of VFrameFormat, where it is a number
START, FORMAT = "GenSigStartValue", "VFrameFormat"
LONG_MESSAGE, LONG_SIGNAL = "SystemMessageLongSymbol", "SystemSignalLongSymbol"

NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
TEXT = r'"((?:\\.|[^"\\])*)"'
KEYWORD = re.compile(r"\s*([A-Z][A-Z_]*_)(?![A-Za-z0-9])")
OF_MESSAGE = re.compile(r"\s*BO_\s+(\d+)\s+([^\s:]+)\s*:\s*(\d+)(?!\d)")
NAME_OF_SIGNAL = re.compile(r"\s*SG_\s+([^\s:]+)")
OF_SIGNAL = re.compile(
    r"\s*SG_\s+(?P<name>[^\s:]+)(?:\s+(?P<page>M|m\d+M?))?\s*:\s*(?P<start>\d+)\s*\|\s*(?P<length>\d+)\s*@\s*"
    rf"(?P<order>[01])\s*(?P<sign>[+-])\s*\(\s*(?P<scale>{NUMBER})\s*,\s*(?P<offset>{NUMBER})\s*\)\s*"
    r"\[\s*(?P<low>[^|\]]*?)\s*\|\s*(?P<high>[^\]]*?)\s*\]")
OF_FLOAT = re.compile(r"\s*SIG_VALTYPE_\s+(\d+)\s+(\S+?)\s*:?\s*([0-3])\s*;")
OF_PAGES = re.compile(r"\s*SG_MUL_VAL_\s+(\d+)\s+(\S+)\s+(\S+)\s+([^;]*);")
RANGE = re.compile(r"(\d+)\s*-\s*(\d+)")
OF_ATTRIBUTE = re.compile(rf"\s*BA_\s+{TEXT}\s+(?:BO_\s+(\d+)|SG_\s+(\d+)\s+(\S+))\s+(?:{TEXT}|([^\s;\"]+))\s*;")
OF_DEFINITION = re.compile(rf"\s*BA_DEF_\s+(?:BO_|SG_)?\s*{TEXT}\s+ENUM\s+([^;]*);")
OF_DEFAULT = re.compile(rf"\s*BA_DEF_DEF_\s+{TEXT}\s+(?:{TEXT}|([^\s;\"]+))\s*;")


@dataclass(frozen=True)
class Statement:
    """A keyword with all that follows it, and its line."""

    keyword: str
    line: int
    text: str


@dataclass
class SignalText:
    """One SG_ statement."""

    line: int
    name: str
    start: int = 0
    length: int = 0
    is_big_endian: bool = False
    is_signed: bool = False
    scale: int | float = 1
    offset: int | float = 0
    low: int | float | None = None
    high: int | float | None = None
    is_multiplexer: bool = False
    page: int | None = None             # the value of the one multiplexer that selects it
    is_float: bool = False
    initial: int | float | None = None
    selector: str | None = None         # the multiplexer that selects it, and with which values
    ids: tuple[int, ...] = ()
    faults: list[str] = field(default_factory=list)

    def bits(self) -> list[int]:
        """The places of its bits, byte by byte from the lowest bit on."""
        if not self.is_big_endian:
            return list(range(self.start, self.start + self.length))
        first = 8 * (self.start // 8) + 7 - self.start % 8  # counted from the highest bit of byte 0 on
        return [8 * (place // 8) + 7 - place % 8 for place in range(first, first + self.length)]

    def made(self) -> Signal:
        """The library's signal."""
        conversion = BaseConversion.factory(self.scale, self.offset, None, self.is_float)
        return Signal(self.name, self.start, self.length, "big_endian" if self.is_big_endian else "little_endian",
                      self.is_signed, self.initial, conversion=conversion, minimum=self.low, maximum=self.high,
                      is_multiplexer=self.is_multiplexer, multiplexer_ids=list(self.ids) or None,
                      multiplexer_signal=self.selector)


@dataclass
class MessageText:
    """One BO_ statement with its signals."""

    line: int
    identifier: int                     # with bit 31 where it has 29 bits
    name: str
    length: int
    signals: list[SignalText] = field(default_factory=list)
    format: str = ""
    faults: list[str] = field(default_factory=list)

    @property
    def is_extended(self) -> bool:
        """Whether the identifier has 29 bits."""
        return bool(self.identifier & EXTENDED)

    @property
    def frame_id(self) -> int:
        """The identifier without the mark."""
        return self.identifier & ~EXTENDED

    @property
    def is_fd(self) -> bool:
        """Whether it is a message of CAN FD."""
        return self.format.endswith("CAN_FD")

    def signal(self, name: str) -> SignalText | None:
        """The first signal of this name."""
        return next((each for each in self.signals if each.name == name), None)

    def message(self) -> Message:
        """The library's message, without a further judgement."""
        return Message(self.frame_id, self.name, self.length, [each.made() for each in self.signals],
                       is_extended_frame=self.is_extended, is_fd=self.is_fd, strict=False)

    # ---- what is wrong

    def fault(self) -> str | None:
        """The first thing that is wrong; None for a message that can be used."""
        found = next(self._faults(), None)
        if found is not None:
            return found
        try:
            self.message()
        except Exception:  # the library may raise any exception on what it did not expect
            return f"its signals contradict each other (line {self.line})"
        return None

    def _faults(self) -> Iterator[str]:
        bits = 29 if self.is_extended else 11
        if self.frame_id >> bits:
            yield f"its identifier {self.frame_id} has more than {bits} bits (line {self.line})"
        if self.length > MOST_BYTES:
            yield f"it has {self.length} bytes, a frame at most {MOST_BYTES} (line {self.line})"
        yield from self.faults
        for each in self.signals:
            yield from each.faults
            if each.length == 0:
                yield f"signal {each.name} has no bits (line {each.line})"
            elif self.length <= MOST_BYTES and not self._has_room_for(each):
                yield f"signal {each.name} does not fit in {self.length} bytes (line {each.line})"
        yield from self._overlaps()

    def _has_room_for(self, signal: SignalText) -> bool:
        """Looks at the ends first: a signal may state any length."""
        most = 8 * self.length
        return signal.length <= most and signal.start < most and max(signal.bits()) < most

    def _overlaps(self) -> Iterator[str]:
        """Signals on the same bits of one frame."""
        if len({each.name for each in self.signals}) < len(self.signals):
            return  # the map's own check names two signals of one name
        pages = {each.name: self._pages(each) for each in self.signals}
        places = {each.name: set(each.bits()) for each in self.signals}
        for number, one in enumerate(self.signals):
            for other in self.signals[:number]:
                if places[one.name] & places[other.name] and not exclude(pages[one.name], pages[other.name]):
                    yield f"signals {other.name} and {one.name} are overlapping (line {one.line})"

    def _pages(self, signal: SignalText) -> dict[str, set[int]]:
        """The multiplexers that select a signal, with their values, from its own outwards."""
        found: dict[str, set[int]] = {}
        now: SignalText | None = signal
        while now is not None and now.selector is not None and now.selector not in found:
            found[now.selector] = set(now.ids)
            now = self.signal(now.selector)
        return found


def exclude(one: Mapping[str, set[int]], other: Mapping[str, set[int]]) -> bool:
    """Whether two signals are never in one frame, by the multiplexers that select them."""
    return any(name in other and not ids & other[name] for name, ids in one.items())


# ------------------------------------------------------------------------------------------- reading


def read_statements(lines: Sequence[str]) -> tuple[list[MessageText], tuple[str, ...]]:
    """(all messages, faults of the file that may hide a message)."""
    reader = _Reader()
    statements, open_line = _statements(lines)
    for statement in statements:
        reader.take(statement)
    reader.end()
    remarks = [f"line {number} begins a message that cannot be understood" for number in reader.unreadable]
    if open_line is not None:
        remarks.insert(0, f"line {open_line} begins a text in quotes that has no end")
    return reader.messages, tuple(remarks)


def _statements(lines: Sequence[str]) -> tuple[list[Statement], int | None]:
    """A statement goes from a keyword at the beginning of a line to the next one; texts in quotes may have keywords."""
    found: list[list[str]] = []
    heads: list[tuple[str, int]] = []
    is_open, open_line = False, None
    for number, line in enumerate(lines, start=1):
        keyword = None if is_open else KEYWORD.match(line)
        if keyword:
            heads.append((keyword[1], number))
            found.append([line])
        elif found:
            found[-1].append(line)
        if line.replace('\\"', "").count('"') % 2:
            is_open = not is_open
            open_line = number if is_open else None
    return [Statement(keyword, number, "\n".join(parts))
            for (keyword, number), parts in zip(heads, found, strict=True)], open_line


class _Reader:
    """Joins the statements of a file; those about other messages follow at its end."""

    def __init__(self) -> None:
        self.messages: list[MessageText] = []
        self.unreadable: list[int] = []
        self._now: MessageText | None = None
        self._later: list[Statement] = []

    def take(self, statement: Statement) -> None:
        """One statement in the file's order."""
        if statement.keyword == "BO_":
            self._message(statement)
        elif statement.keyword == "SG_" and self._now is not None:
            self._signal(self._now, statement)
        elif statement.keyword in ("SIG_VALTYPE_", "SG_MUL_VAL_", "BA_", "BA_DEF_", "BA_DEF_DEF_"):
            self._later.append(statement)

    def _message(self, statement: Statement) -> None:
        self._now = None
        if found := OF_MESSAGE.match(statement.text):
            self._now = MessageText(statement.line, _whole(found[1]), found[2], _whole(found[3]))
            self.messages.append(self._now)
        elif statement.text.strip() != "BO_":  # a line of the list after NS_
            self.unreadable.append(statement.line)

    def _signal(self, message: MessageText, statement: Statement) -> None:
        found = OF_SIGNAL.match(statement.text)
        if found is None:
            name = NAME_OF_SIGNAL.match(statement.text)
            message.faults.append(f"line {statement.line}, signal {name[1] if name else '?'}, cannot be understood")
            return
        page = found["page"] or ""
        signal = SignalText(
            statement.line, found["name"], _whole(found["start"]), _whole(found["length"]), found["order"] == "0",
            found["sign"] == "-", _number(found["scale"]), _number(found["offset"]),
            is_multiplexer=page.endswith("M"), page=_whole(page.strip("mM")) if page.startswith("m") else None)
        if not (math.isfinite(signal.scale) and math.isfinite(signal.offset)):
            signal.faults.append(f"signal {signal.name} has a factor that is not finite (line {statement.line})")
        for end in ("low", "high"):
            self._limit(signal, end, found[end])
        if signal.low == signal.high == 0:  # the file's way to state no limits
            signal.low = signal.high = None
        message.signals.append(signal)

    def _limit(self, signal: SignalText, end: str, text: str) -> None:
        """One end of a signal's range; an infinite one is none."""
        if re.fullmatch(NUMBER, text):
            value = _number(text)
            setattr(signal, end, value if math.isfinite(value) else None)
        elif text and not re.search("inf|nan", text, re.IGNORECASE):
            signal.faults.append(f"signal {signal.name} has the limit {text[:40]!r} (line {signal.line})")

    # ---- statements about messages that the file has

    def end(self) -> None:
        """All that follows the messages."""
        by_id: dict[int, list[MessageText]] = {}
        for each in self.messages:
            by_id.setdefault(each.identifier, []).append(each)
        formats, usual = _frame_formats(self._later)
        for message in self.messages:
            message.format = usual
        for statement in self._later:
            self._of_messages(statement, by_id, formats)
        for message in self.messages:
            _select(message)
        for statement in self._later:
            self._long_name(statement, by_id)

    def _of_messages(self, statement: Statement, by_id: Mapping[int, list[MessageText]],
                     formats: Sequence[str]) -> None:
        if statement.keyword == "SIG_VALTYPE_" and (found := OF_FLOAT.match(statement.text)):
            for signal in _signals(by_id, found[1], found[2]):
                signal.is_float = found[3] in FLOATS
        elif statement.keyword == "SG_MUL_VAL_" and (found := OF_PAGES.match(statement.text)):
            for signal in _signals(by_id, found[1], found[2]):
                _select_by(signal, found[3], found[4])
        elif statement.keyword == "BA_" and (found := OF_ATTRIBUTE.match(statement.text)):
            value = found[5] if found[5] is not None else found[6]
            if found[1] == FORMAT and found[2]:
                for message in by_id.get(_whole(found[2]), ()):
                    message.format = _format(value, formats)
            elif found[1] == START and found[3]:
                for signal in _signals(by_id, found[3], found[4]):
                    _start_with(signal, value, statement.line)

    def _long_name(self, statement: Statement, by_id: Mapping[int, list[MessageText]]) -> None:
        """Names of more than 32 letters are in attributes."""
        found = OF_ATTRIBUTE.match(statement.text) if statement.keyword == "BA_" else None
        if found is None or not found[5]:
            return
        if found[1] == LONG_MESSAGE and found[2]:
            for message in by_id.get(_whole(found[2]), ()):
                message.name = found[5]
        elif found[1] == LONG_SIGNAL and found[3]:
            for message in by_id.get(_whole(found[3]), ()):
                _rename(message, found[4], found[5])


def _rename(message: MessageText, old: str, new: str) -> None:
    for signal in message.signals:
        signal.name = new if signal.name == old else signal.name
        signal.selector = new if signal.selector == old else signal.selector


def _signals(by_id: Mapping[int, list[MessageText]], identifier: str, name: str) -> list[SignalText]:
    return [signal for message in by_id.get(_whole(identifier), ()) for signal in message.signals
            if signal.name == name]


def _select_by(signal: SignalText, selector: str, ranges: str) -> None:
    """The values of a multiplexer with which it selects a signal."""
    ids: list[int] = []
    for first, last in ((_whole(a), _whole(b)) for a, b in RANGE.findall(ranges)):
        if last - first >= MOST_IDS or len(ids) + last - first >= MOST_IDS:
            signal.faults.append(f"signal {signal.name} is on more than {MOST_IDS} pages (line {signal.line})")
            return
        ids += range(first, last + 1)
    signal.selector, signal.ids = selector, tuple(dict.fromkeys(ids))


def _select(message: MessageText) -> None:
    """Signals with a page and without SG_MUL_VAL_ are selected by the one multiplexer of their message."""
    multiplexers = [each for each in message.signals if each.is_multiplexer]
    outer = [each for each in multiplexers if each.page is None] or multiplexers
    for signal in message.signals:
        if signal.selector is None and signal.page is not None:
            if len(outer) == 1 and outer[0] is not signal:
                signal.selector, signal.ids = outer[0].name, (signal.page,)
            else:
                count = "no multiplexer" if not multiplexers else "several multiplexers and no SG_MUL_VAL_"
                signal.faults.append(f"signal {signal.name} is on a page, with {count} (line {signal.line})")
        elif signal.selector is not None and message.signal(signal.selector) is None:
            signal.faults.append(f"signal {signal.name} is selected by {signal.selector}, which is not there (line "
                                 f"{signal.line})")


def _start_with(signal: SignalText, value: str, line: int) -> None:
    if re.fullmatch(NUMBER, value) and math.isfinite(number := _number(value)):
        signal.initial = number if signal.is_float or number != int(number) else int(number)
    else:
        signal.faults.append(f"signal {signal.name} has the start value {value[:40]!r} (line {line})")


def _frame_formats(statements: Sequence[Statement]) -> tuple[list[str], str]:
    """(the frame formats by number, that of messages without one)."""
    formats, usual = [FORMATS.get(number, "") for number in range(16)], ""
    for statement in statements:
        found = OF_DEFINITION.match(statement.text) if statement.keyword == "BA_DEF_" else None
        if found and found[1] == FORMAT:
            formats = re.findall(TEXT, found[2])
    for statement in statements:
        found = OF_DEFAULT.match(statement.text) if statement.keyword == "BA_DEF_DEF_" else None
        if found and found[1] == FORMAT:
            usual = _format(found[2] if found[2] is not None else found[3], formats)
    return formats, usual


def _format(value: str, formats: Sequence[str]) -> str:
    """A frame format by its number or its name."""
    if not value.isdecimal():
        return value
    return formats[int(value)] if len(value) < 4 and int(value) < len(formats) else ""


def _whole(text: str) -> int:
    """A whole number; one of many digits is cut to a number that nothing can have."""
    return int(text) if len(text) <= 18 else 10**18


def _number(text: str) -> int | float:
    """As exact as it is written: a whole number stays one."""
    if re.fullmatch(r"[+-]?\d{1,30}", text):
        return int(text)
    found = float(text)
    return int(found) if found.is_integer() and abs(found) < 2**53 else found
