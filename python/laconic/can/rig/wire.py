"""The wire contract from laconic.dbc: packing and unpacking of whole payloads as integers.

cantools reads the file; the packers here are made from what it read, since its own encoder is too slow for ten thousand
frames a second. Protection (first two or three bytes) is put on by the link.

Frames of python-can as the node's C code has them, and back.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import can
import cantools.database
from cantools.database.can import Database, Message

from laconic.base.paths import SOURCE_DIR

DBC = SOURCE_DIR / "firmware_stub" / "laconic.dbc"
ID_BASE = 0x680
ID_STRIDE = 32
WHEELS_A_GROUP = 3


@dataclass(frozen=True)
class Field:
    """One signal: its bits, its scale and its value table."""

    name: str
    start: int
    bits: int
    signed: bool
    scale: float
    largest: int          # largest magnitude of the raw value that the contract allows
    choices: dict[int, str]
    real: bool = False    # its bits are an IEEE number of single precision

    @property
    def mask(self) -> int:
        """All its bits, shifted down."""
        return (1 << self.bits) - 1

    def value(self, raw: int) -> float:
        """The number in its unit."""
        return float(struct.unpack("<f", struct.pack("<I", raw & self.mask))[0]) if self.real else raw * self.scale

    def raw(self, value: float) -> tuple[int, bool]:
        """The nearest raw value, and whether it had to be cut off."""
        nearest = round(value / self.scale)
        cut = max(-self.largest, min(self.largest, nearest))
        return cut, cut != nearest


class Frame:
    """One message of the contract."""

    def __init__(self, message: Message, defaults: dict[str, Any]):
        self.name, self.length, self.fd = message.name, message.length, message.is_fd
        self.offset = message.frame_id - ID_BASE
        self.from_rig = "RIG" in message.senders
        self.comment = message.comment or ""
        found = {name: each.value for name, each in message.dbc.attributes.items()} if message.dbc else {}
        self.attributes = {**defaults, **found}
        self.max_delta = int(self.attributes["E2EMaxDeltaCounter"])
        self.key = str(self.attributes["E2EKey"])  # what its protection depends on: none, nonce, session, run
        self.fields = {signal.name: field_of(signal) for signal in message.signals}
        self._pages = {signal.name: signal.multiplexer_ids[0] for signal in message.signals if signal.multiplexer_ids}
        self._unpack = [(f.name, f.start, f.mask, f.mask // 2 + 1 if f.signed else 0) for f in self.fields.values()]

    def counter_of(self, data: bytes) -> int:
        """The counter in a payload."""
        return data[2] if self.fd else data[1] & 15

    def pack(self, **raw: int) -> bytearray:
        """Payload from raw values; what is not named is zero."""
        whole = 0
        for name, value in raw.items():
            each = self.fields[name]
            whole |= (value & each.mask) << each.start
        return bytearray(whole.to_bytes(self.length, "little"))

    def unpack(self, data: bytes) -> dict[str, int]:
        """Raw values of all signals; of multiplexed ones, those of this page."""
        whole = int.from_bytes(data, "little")
        values = {}
        for name, start, mask, sign in self._unpack:
            value = whole >> start & mask
            values[name] = value - 2 * sign if sign and value & sign else value
        if self._pages:
            return {name: value for name, value in values.items() if self._pages.get(name) in (None, values["page"])}
        return values

    def physical(self, data: bytes) -> dict[str, float]:
        """Values in their units."""
        return {name: self.fields[name].value(raw) for name, raw in self.unpack(data).items()}


def field_of(signal: Any) -> Field:
    """A Field from a cantools signal; every signal of the contract is little-endian."""
    if signal.byte_order != "little_endian":
        raise ValueError(f"{DBC}: {signal.name}: big-endian signals are not part of the contract")
    scale = float(signal.scale)
    largest = round(float(signal.maximum) / scale)
    choices = {int(number): str(name) for number, name in (signal.choices or {}).items()}
    return Field(signal.name, signal.start, signal.length, signal.is_signed and not signal.is_float, scale, largest,
                 choices, signal.is_float)


class Wire:
    """All messages between rig and node, by name and by identifier offset; `xcp`: those of an XCP master and slave."""

    def __init__(self, database: Database):
        definitions = database.dbc.attribute_definitions if database.dbc else {}
        defaults = {name: each.default_value for name, each in definitions.items()}
        self.database = database
        every = {message.name: Frame(message, defaults) for message in database.messages}
        self.frames = {name: each for name, each in every.items() if each.attributes["E2EProfile"] != "none"}
        self.xcp = {name: each for name, each in every.items() if name not in self.frames}
        self.by_offset = {frame.offset: frame for frame in self.frames.values()}

    def __getitem__(self, name: str) -> Frame:
        return self.frames[name]

    def number(self, name: str, field: str, choice: str) -> int:
        """The raw value of a name in a value table."""
        table = self.frames[name].fields[field].choices
        return next(number for number, text in table.items() if text == choice)

    def choice(self, name: str, field: str, number: int) -> str:
        """The name of a raw value in a value table, in lower case with spaces."""
        text = self.frames[name].fields[field].choices.get(number, str(number))
        return text.lower().replace("_", " ")


@lru_cache(maxsize=1)
def wire() -> Wire:
    """The contract, read once."""
    database = cantools.database.load_file(DBC)
    if not isinstance(database, Database):
        raise ValueError(f"{DBC}: is no database of CAN frames")
    return Wire(database)


class NodeMessage(can.Message):
    """A message that python-can's virtual bus copies in a fraction of the time; copies share no bytes either."""

    __slots__ = ()

    def __deepcopy__(self, memo: dict[int, Any] | None) -> can.Message:
        copied = self.__copy__()
        copied.data = bytearray(self.data)
        return copied


class FrameBox:
    """One laconic_frame, used again for every frame that passes."""

    def __init__(self, ffi: Any):
        self.c = ffi.new("laconic_frame *")
        self._bytes = ffi.buffer(self.c.data)

    def fill(self, identifier: int, data: bytes | bytearray, *, fd: bool = False, extended: bool = False,
             remote: bool = False, bit_rate_switch: bool = False) -> Any:
        """The frame with these contents."""
        frame = self.c
        frame.id, frame.length = identifier, len(data)
        frame.extended, frame.remote, frame.fd, frame.bit_rate_switch = extended, remote, fd, bit_rate_switch
        self._bytes[: len(data)] = data
        return frame

    def put(self, message: can.Message) -> Any:
        """The frame from a message; that of a remote frame has its length without data."""
        frame = self.fill(message.arbitration_id, message.data or b"", fd=message.is_fd,
                          extended=message.is_extended_id, remote=message.is_remote_frame,
                          bit_rate_switch=message.bitrate_switch)
        if message.is_remote_frame:
            frame.length = message.dlc
        return frame

    @property
    def data(self) -> bytes:
        """The payload."""
        return bytes(self._bytes[: self.c.length])

    def message(self, timestamp_s: float = 0.0) -> can.Message:
        """The frame as a message."""
        frame = self.c
        remote = bool(frame.remote)
        return NodeMessage(timestamp=timestamp_s, arbitration_id=frame.id, is_extended_id=bool(frame.extended),
                           is_remote_frame=remote, dlc=frame.length, data=None if remote else self.data,
                           is_fd=bool(frame.fd), bitrate_switch=bool(frame.bit_rate_switch))
