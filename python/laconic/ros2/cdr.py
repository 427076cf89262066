"""Messages without cyclonedds: plain classes, and XCDR1 to and from bytes. Zenoh needs no more."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING, Any, ClassVar

if TYPE_CHECKING:
    from laconic.ros2.messages import Fields, FieldType

HEADER = b"\x00\x01\x00\x00"  # XCDR1, little endian
ONE = {"int8": "b", "uint8": "B", "byte": "B", "bool": "?", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I",
       "int64": "q", "uint64": "Q", "float32": "f", "float64": "d"}
MOST_ITEMS = 1 << 24  # of one sequence: no robot has more, and broken lengths end here


class Plain:
    """A message that writes and reads itself."""

    __idl__: ClassVar[Any] = None
    _fields: ClassVar[Fields]
    sample_info: Any

    def serialize(self, use_version_2: bool = False) -> bytes:
        """With its header."""
        out = bytearray()
        _write(self, out)
        return HEADER + bytes(out)

    @classmethod
    def deserialize(cls, data: bytes, has_header: bool = True) -> Any:
        """A message of bytes; ValueError for what is not one of this type."""
        start = len(HEADER) if has_header else 0
        order = "<" if not has_header or data[1:2] == b"\x01" else ">"
        try:
            return _read(cls, Source(bytes(data[start:]), order))
        except (struct.error, UnicodeDecodeError, IndexError) as error:
            raise ValueError(f"these bytes are no {cls.__name__}") from error


class Source:
    """Bytes that are read one after the other."""

    def __init__(self, data: bytes, order: str):
        self.data, self.order, self.at = data, order, 0

    def numbers(self, item: str, count: int) -> tuple[Any, ...]:
        """Numbers of one kind, aligned to their size."""
        form = ONE[item]
        size = struct.calcsize(form)
        self.at += -self.at % size
        if count > MOST_ITEMS or self.at + count * size > len(self.data):
            raise struct.error("the bytes end")
        found = struct.unpack_from(f"{self.order}{count}{form}", self.data, self.at)
        self.at += count * size
        return found

    def text(self) -> str:
        """A string."""
        length = self.numbers("uint32", 1)[0]
        if not 0 < length <= len(self.data) - self.at:
            raise struct.error("a text ends beyond the bytes")
        self.at += length
        return self.data[self.at - length : self.at - 1].decode()


def _write(message: Any, out: bytearray) -> None:
    for name, kind in message._fields:
        value = getattr(message, name)
        if not kind.many:
            _write_items(kind, [value], out)
            continue
        if kind.is_sequence:
            _pad(out, 4)
            out += struct.pack("<I", len(value))
        _write_items(kind, value, out)


def _write_items(kind: FieldType, items: Any, out: bytearray) -> None:
    if kind.is_nested:
        for each in items:
            _write(each, out)
    elif kind.item == "string":
        for each in items:
            data = each.encode() + b"\0"
            _pad(out, 4)
            out += struct.pack("<I", len(data)) + data
    elif len(items):
        form = ONE[kind.item]
        _pad(out, struct.calcsize(form))
        out += struct.pack(f"<{len(items)}{form}", *items)


def _pad(out: bytearray, size: int) -> None:
    out += bytes(-len(out) % size)


def _read(cls: Any, source: Source) -> Any:
    made = cls()
    for name, kind in cls._fields:
        if not kind.many:
            setattr(made, name, _read_items(kind, source, 1, getattr(made, name).__class__)[0])
            continue
        count = source.numbers("uint32", 1)[0] if kind.is_sequence else kind.count
        if kind.is_sequence and (count > MOST_ITEMS or (kind.count and count > kind.count) or count > len(source.data)):
            raise struct.error("a sequence is too long")
        setattr(made, name, _read_items(kind, source, count, cls._items[name]))
    return made


def _read_items(kind: FieldType, source: Source, count: int, item: Any) -> list[Any]:
    if kind.is_nested:
        return [_read(item, source) for _ in range(count)]
    if kind.item == "string":
        return [source.text() for _ in range(count)]
    return [*source.numbers(kind.item, count)]
