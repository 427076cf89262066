"""Reads BLF, the binary log of Vector's tools: objects, most of them packed in containers. CAN frames and error frames
count.

An object begins with its mark, the sizes of its header and of all of it, and its kind. Frames outside of containers are
read, too. An object whose size cannot be right is a fault: nothing behind it can be found.
"""

from __future__ import annotations

import datetime
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from laconic.base.text_file import bytes_of
from laconic.robot.logs.formats.can_frames import WANTED, FaultyLog, LoggedFrame, Recorded

FILE_MARK, OBJECT_MARK = b"LOGG", b"LOBJ"
FILE_HEADER = struct.Struct("<4sL8xQQLL8H8H")
OBJECT_HEADER = struct.Struct("<4sHHLL")           # mark, size of the header, its version, size of all, kind
TIMES = struct.Struct("<LHHQ")                     # flags, two numbers that differ by version, time
CONTAINER = struct.Struct("<H6xL4x")               # kind of packing, size unpacked
FRAME = struct.Struct("<HBBL8s")                   # channel, flags, length, identifier, bytes
FD_FRAME = struct.Struct("<HBBLLBBB5x64s")         # …, of the wire, bits, FD flags, number of bytes
FD_FRAME_64 = struct.Struct("<BBBBLLLLLLLHBBL")    # channel, code, number of bytes, …, flags, …, direction, offset
ERROR_CHANNEL = struct.Struct("<H")

CAN_MESSAGE, CAN_ERROR, LOG_CONTAINER, CAN_ERROR_EXT, CAN_MESSAGE_2 = 1, 2, 10, 73, 86
CAN_FD_MESSAGE, CAN_FD_MESSAGE_64, CAN_FD_ERROR_64 = 100, 101, 104
UNPACKED, ZLIB = 0, 2
EXTENDED, IDENTIFIER = 1 << 31, 0x1FFFFFFF
SENT, REMOTE = 0x01, 0x80                          # flags of a frame
IS_FD, SWITCHED = 0x01, 0x02                       # FD flags
REMOTE_64, IS_FD_64, SWITCHED_64 = 0x10, 0x1000, 0x2000
TEN_MICROSECONDS = 1                               # flag of a time; else nanoseconds
MOST_UNPACKED = 1 << 27                            # bytes of one container
LONGEST_PADDING = 8


@dataclass(frozen=True)
class BlfHeader:
    """What the head of a file states."""

    size: int            # of the head
    file_size: int       # when it was closed; less where it never was
    begin_s: float       # since 1970


def is_blf(path: Path) -> bool:
    """Whether a file begins as a BLF."""
    try:
        with path.open("rb") as file:
            return file.read(4) == FILE_MARK
    except OSError:
        return False


def read_blf(path: Path) -> Recorded:
    """All frames; FaultyLog names the byte of an object that cannot be understood."""
    data = bytes_of(path, WANTED)
    header = header_of(data)
    if len(data) < header.file_size:
        raise FaultyLog(f"is cut off: {len(data)} of {header.file_size} bytes are there; copy it again")
    frames = [frame for each in _objects(data, header.size) for frame in _frames(each, header.begin_s)]
    for number, frame in enumerate(frames, start=1):
        frame.place = f"frame {number}"
    zeros = len(data) - len(data.rstrip(b"\0"))
    is_padded = zeros > LONGEST_PADDING and len(data) > header.file_size
    remark = f"ends in {zeros} zero bytes, as after a loss of power; they are left out"
    return Recorded(frames, (remark,) if is_padded else ())


def header_of(data: bytes) -> BlfHeader:
    """FaultyLog for a file that does not begin as a BLF."""
    if not data.startswith(FILE_MARK):
        raise FaultyLog("does not begin as a BLF; give the file as it was written")
    if len(data) < FILE_HEADER.size:
        raise FaultyLog(f"is cut off within its head, after {len(data)} bytes; copy it again")
    _, size, file_size, _, _, _, *times = FILE_HEADER.unpack_from(data)
    if not FILE_HEADER.size <= size <= len(data):
        raise FaultyLog(f"states a head of {size} bytes, which is not possible; give the file as it was written")
    return BlfHeader(size, file_size, _seconds(times[:8]))


def _seconds(parts: list[int]) -> float:
    """Since 1970; 0 where the file states no date."""
    year, month, _, day, hour, minute, second, millisecond = parts
    try:
        begin = datetime.datetime(year, month, day, hour, minute, second, 1000 * millisecond, datetime.timezone.utc)
    except ValueError:
        return 0.0
    return begin.timestamp()


# ------------------------------------------------------------------------------------------ objects


@dataclass(frozen=True)
class Found:
    """One object: its kind, the version of its header, and its bytes with the header."""

    kind: int
    header_size: int
    data: bytes
    place: str
    end: int             # where it ends in the bytes that were walked

    def unpacked(self, form: struct.Struct, begin: int) -> tuple[int, ...]:
        """Numbers at a place; FaultyLog where the object is too short for them."""
        if begin + form.size > len(self.data):
            raise FaultyLog(f"{self.place} has {len(self.data)} bytes, too few for an object of kind {self.kind}; "
                            "give the file as it was written")
        return form.unpack_from(self.data, begin)


def _objects(data: bytes, begin: int) -> Iterator[Found]:
    """The objects of a file, those in containers in their order; an object may go on in the next container."""
    rest, unpacked = b"", 0
    for each in _walk(data, begin, "the file", whole=True):
        if each.kind != LOG_CONTAINER:
            yield each
            continue
        part = _content(each)
        rest, unpacked = rest + part, unpacked + len(part)
        end = 0
        for inner in _walk(rest, 0, "the unpacked part", offset=unpacked - len(rest)):
            yield inner
            end = inner.end
        rest = rest[end:]
    if rest.strip(b"\0"):
        raise FaultyLog("is cut off within an object of its last container; copy it again")


def _walk(data: bytes, begin: int, where: str, *, whole: bool = False, offset: int = 0) -> Iterator[Found]:
    """Object after object. `whole`: the last one must be there to its end."""
    at = begin
    while True:
        found = data.find(OBJECT_MARK, at, at + LONGEST_PADDING + len(OBJECT_MARK))
        if found < 0:
            if not data[at:].strip(b"\0") or (not whole and len(data) - at < OBJECT_HEADER.size):
                return
            raise FaultyLog(f"byte {offset + at} of {where}: no object begins there; give the file as it was written")
        if found + OBJECT_HEADER.size > len(data):
            break
        _, header_size, _, size, kind = OBJECT_HEADER.unpack_from(data, found)
        if size < OBJECT_HEADER.size or header_size > size:
            raise FaultyLog(f"byte {offset + found} of {where}: an object states the size {size}, so nothing behind it "
                            "can be read; give the file as it was written")
        if found + size > len(data):
            break
        at = found + size
        yield Found(kind, header_size, data[found:at], f"byte {offset + found} of {where}", at)
    if whole:
        raise FaultyLog(f"byte {offset + at} of {where}: an object is cut off; copy the file again")


def _content(container: Found) -> bytes:
    kind, size = container.unpacked(CONTAINER, OBJECT_HEADER.size)
    packed = container.data[OBJECT_HEADER.size + CONTAINER.size:]
    if kind == UNPACKED:
        return packed
    if kind != ZLIB:
        raise FaultyLog(f"{container.place}: a container is packed in the way {kind}, which is not known")
    try:
        found = zlib.decompressobj().decompress(packed, MOST_UNPACKED)
    except zlib.error:
        raise FaultyLog(f"{container.place}: a container cannot be unpacked; copy the file again") from None
    if len(found) != size:
        raise FaultyLog(f"{container.place}: a container states {size} bytes and holds {len(found)}; copy the file "
                        "again")
    return found


# ------------------------------------------------------------------------------------------- frames


def _frames(each: Found, begin_s: float) -> Iterator[LoggedFrame]:
    """The frame of an object; none for an object of another kind."""
    if each.kind not in READERS:
        return
    flags, _, _, count = each.unpacked(TIMES, OBJECT_HEADER.size)
    time_s = begin_s + count * (1e-5 if flags == TEN_MICROSECONDS else 1e-9)
    yield READERS[each.kind](each, time_s, max(each.header_size, OBJECT_HEADER.size + TIMES.size))


def _classic(each: Found, time_s: float, begin: int) -> LoggedFrame:
    channel, flags, length, identifier, data = each.unpacked(FRAME, begin)
    return _frame(each, time_s, channel, identifier, bytes(data)[: min(length, 8)], remote=bool(flags & REMOTE),
                  sent=bool(flags & SENT), length=min(length, 8))


def _fd(each: Found, time_s: float, begin: int) -> LoggedFrame:
    channel, flags, _, identifier, _, _, fd_flags, count, data = each.unpacked(FD_FRAME, begin)
    return _frame(each, time_s, channel, identifier, bytes(data)[: min(count, 64)], remote=bool(flags & REMOTE),
                  sent=bool(flags & SENT), fd=bool(fd_flags & IS_FD), switched=bool(fd_flags & SWITCHED),
                  length=min(count, 64))


def _fd_64(each: Found, time_s: float, begin: int) -> LoggedFrame:
    """Bytes that are not there are zeros: some programs leave them out."""
    channel, _, count, _, identifier, _, flags, *_, direction, more_at, _ = each.unpacked(FD_FRAME_64, begin)
    count, first = min(count, 64), begin + FD_FRAME_64.size
    end = more_at if first < more_at <= len(each.data) else len(each.data)
    data = each.data[first:end][:count].ljust(count, b"\0")
    return _frame(each, time_s, channel, identifier, data, remote=bool(flags & REMOTE_64), sent=bool(direction),
                  fd=bool(flags & IS_FD_64), switched=bool(flags & SWITCHED_64), length=count)


def _error(each: Found, time_s: float, begin: int) -> LoggedFrame:
    channel, = each.unpacked(ERROR_CHANNEL, begin)
    return LoggedFrame(each.place, time_s, channel, error=True)


def _frame(each: Found, time_s: float, channel: int, identifier: int, data: bytes, *, remote: bool, sent: bool,
           length: int, fd: bool = False, switched: bool = False) -> LoggedFrame:
    return LoggedFrame(each.place, time_s, channel, identifier & IDENTIFIER, b"" if remote else data,
                       extended=bool(identifier & EXTENDED), remote=remote, fd=fd, sent=sent, switched=switched,
                       length=length)


READERS = {CAN_MESSAGE: _classic, CAN_MESSAGE_2: _classic, CAN_FD_MESSAGE: _fd, CAN_FD_MESSAGE_64: _fd_64,
           CAN_ERROR: _error, CAN_ERROR_EXT: _error, CAN_FD_ERROR_64: _error}
