"""The containers of topics: rosbag2 in SQLite, MCAP, rosbag1; each is read to the end that it has."""

from __future__ import annotations

import io
import sqlite3
import struct
import tempfile
import zlib
from collections.abc import Callable, Iterator
from contextlib import ExitStack, suppress
from functools import partial
from pathlib import Path
from typing import Any

from laconic.errors import BadInput, reason_of
from laconic.robot.bags.messages import (
    BAG_MAGIC,
    GIVE,
    MCAP_MAGIC,
    SQLITE_MAGIC,
    ULOG_MAGIC,
    ZSTD_MAGIC,
    Recording,
    Topic,
    decoder_of,
    first_bytes,
)

MOST_BYTES_OF_CHUNK = 256 * 2**20   # unpacked: recorders make chunks of about one MB
MOST_BYTES_OF_MESSAGE = 64 * 2**20  # of a message that was packed by itself
MOST_GAPS, MOST_DOUBLINGS = 1000, 40  # in a broken file of SQLite: places that are stepped over, and how far
COPIED_AT_ONCE = 1 << 20
FOOTER = struct.Struct("<QQI")      # where the summary and its index begin, and its checksum
SIZE_OF_END = 9 + FOOTER.size + len(MCAP_MAGIC)
FORMS = {"ros2msg": "msg", "ros1msg": "msg", "ros2idl": "idl"}


def opened(path: Path) -> Recording:
    """A container by how its file begins; BadInput for what is none, or cannot be read."""
    begin = first_bytes(path)
    try:
        if begin.startswith(ZSTD_MAGIC):
            return _Unpacked(path)
        if begin.startswith(SQLITE_MAGIC):
            return SqliteFile(path)
        if begin.startswith(MCAP_MAGIC):
            return McapFile(path)
        if begin.startswith(BAG_MAGIC):
            return Rosbag1File(path)
        size = path.stat().st_size
    except OSError as error:
        raise BadInput(f"{path}: cannot be read ({reason_of(error)}); {GIVE}") from None
    if begin.startswith(b"#ROSBAG"):
        raise BadInput(f"{path}: is a rosbag of version {begin[9:12].decode(errors='replace')}, which is not read; "
                       "convert it by `rosbag fix` to version 2.0")
    assert not begin.startswith(ULOG_MAGIC)
    raise BadInput(f"{path}: {'is empty' if not size else 'is no rosbag, MCAP or ULog'}; {GIVE}")


class SqliteFile:
    """One file of a rosbag2 in SQLite."""

    def __init__(self, path: Path):
        self.path, self.remarks = path, list[str]()
        self.topics: dict[str, Topic] = {}
        self._ids: dict[int, str] = {}
        try:
            self._base = sqlite3.connect(f"{path.resolve().as_uri()}?mode=ro&immutable=1", uri=True)
            self._base.text_factory = lambda data: data.decode(errors="replace")
            try:
                self._read_topics()
            except sqlite3.DatabaseError:
                self._base.execute("PRAGMA writable_schema=ON")  # takes a file that is shorter than it states
                self._read_topics()
        except sqlite3.Error:
            raise BadInput(f"{path}: is no rosbag2 that can be read (its tables of topics are broken or missing); "
                           f"{GIVE}") from None

    def _read_topics(self) -> None:
        definitions: dict[str, tuple[str, str]] = {}
        with suppress(sqlite3.Error):  # there since ROS 2 Iron
            definitions = {name: (FORMS.get(str(form), ""), str(text)) for name, form, text in self._base.execute(
                "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions")}
        counts: dict[int, int] = {}
        with suppress(sqlite3.Error):
            counts = dict(self._base.execute("SELECT topic_id, count(*) FROM messages GROUP BY topic_id"))
        for key, name, kind, encoding in self._base.execute(
                "SELECT id, name, type, serialization_format FROM topics"):
            if not all(isinstance(each, str) for each in (name, kind, encoding)) or not isinstance(key, int):
                continue  # a broken row
            form, text = definitions.get(kind, ("", ""))
            self._ids[key] = name
            self.topics[name] = Topic(name, kind, counts.get(key, 0) if counts else None, partial(
                decoder_of, self.path, name, kind, encoding, form, text))

    def messages(self, names: set[str]) -> Iterator[tuple[str, int, bytes]]:
        """In the order in which they were written; what is on broken or missing pages is left out and reported."""
        wanted = [key for key, name in self._ids.items() if name in names]
        self.remarks[:] = self._besides()
        taken, gaps, after, missing = 0, 0, -1, 0
        while gaps < MOST_GAPS:
            try:
                for number, key, stamp, data in self._rows(wanted, after):
                    after = number
                    if not isinstance(stamp, int) or not isinstance(data, bytes):
                        continue
                    taken += 1
                    yield self._ids[key], stamp, _unpacked_message(data) if data.startswith(ZSTD_MAGIC) else data
                break
            except sqlite3.Error:
                gaps += 1
            following = self._next_whole(wanted, after)
            if following is None:
                break
            missing, after = missing + following - max(after, 0) - 1, following - 1  # numbers begin at 1
        if gaps:
            known = f"; {missing} between them are lost" if missing else ""
            self.remarks.append(f"{self.path.name} is cut off or broken: {taken} messages of the topics that are used "
                                f"can be read{known}")

    def _rows(self, wanted: list[int], after: int) -> sqlite3.Cursor:
        marks = ",".join("?" * len(wanted))
        return self._base.execute(
            f"SELECT id, topic_id, timestamp, data FROM messages WHERE topic_id IN ({marks}) AND id > ? ORDER BY id",
            (*wanted, after))  # marks are ? alone

    def _next_whole(self, wanted: list[int], after: int) -> int | None:
        """The number of a message behind broken pages from which on others can be read; None where there is none."""
        def found(number: int) -> bool:
            try:
                row = self._base.execute("SELECT id, data FROM messages WHERE id >= ? ORDER BY id LIMIT 1",
                                         (number,)).fetchone()
            except sqlite3.Error:
                return False
            return row is not None

        step = next((1 << power for power in range(MOST_DOUBLINGS) if found(after + 1 + (1 << power))), None)
        if step is None:
            return None
        low, high = after + 1 + step // 2, after + 1 + step  # the one is broken, the other whole
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (low, middle) if found(middle) else (middle, high)
        return high

    def _besides(self) -> list[str]:
        """A remark on messages that the recorder had not moved into the file yet."""
        log = self.path.with_name(f"{self.path.name}-wal")
        if not log.is_file() or not log.stat().st_size:
            return []
        return [f"{log.name} holds messages that are not in {self.path.name} yet and are not read; "
                f"`sqlite3 {self.path.name} 'PRAGMA wal_checkpoint'` moves them there"]

    def close(self) -> None:
        """Closes the file."""
        self._base.close()


class McapFile:
    """An MCAP: by its index the chunks with the topics; without one from the beginning to the end that is there."""

    def __init__(self, path: Path):
        self.path, self.remarks = path, list[str]()
        self.topics: dict[str, Topic] = {}
        self._file = path.open("rb")
        self._size = path.stat().st_size
        self._schemas: dict[int, Any] = {}
        self._channels: dict[int, Any] = {}
        self._counts: dict[int, int] = {}
        self._chunks: list[Any] | None = None
        self._lasting = list[str]()     # remarks on the file itself, whatever is read of it
        self._broken: dict[str, list[str]] = {}  # why chunks are left out, and which
        try:
            self._read_summary()
        except BaseException:
            self._file.close()
            raise
        self._name_topics()

    def _read_summary(self) -> None:
        """Of the file's end; without one the whole file is looked through for its channels."""
        from mcap.reader import SeekingReader

        summary = None
        with suppress(Exception):  # a file that was cut off has no end to read it from; the library has many errors
            summary = SeekingReader(self._file, record_size_limit=self._size).get_summary()
        if summary is not None and not self._is_summary_whole():
            self._lasting.append(f"the index at the end of {self.path.name} is broken (its checksum is wrong), so the "
                                 "whole file is read without it")
        elif summary is not None and summary.channels and summary.chunk_indexes:
            self._schemas, self._channels = dict(summary.schemas), dict(summary.channels)
            self._counts = dict(summary.statistics.channel_message_counts) if summary.statistics else {}
            self._chunks = summary.chunk_indexes
            return
        self._counts = {}
        for channel, _, _ in self._records(None):
            self._counts[channel] = self._counts.get(channel, 0) + 1

    def _is_summary_whole(self) -> bool:
        """Whether the summary has the checksum that the footer states; 0: none was written."""
        self._file.seek(-SIZE_OF_END, io.SEEK_END)
        start, _, stated = FOOTER.unpack_from(self._file.read(SIZE_OF_END), 9)
        self._file.seek(start)
        return not stated or zlib.crc32(self._file.read(self._size - start - len(MCAP_MAGIC) - 4)) == stated

    def _name_topics(self) -> None:
        for key, channel in self._channels.items():
            schema = self._schemas.get(channel.schema_id)
            kind, form = (schema.name, schema.encoding) if schema else ("", "")
            text = schema.data.decode(errors="replace") if schema and form in FORMS else ""
            before = self.topics.get(channel.topic)
            count = self._counts.get(key, 0) + ((before.count or 0) if before else 0)
            self.topics[channel.topic] = Topic(channel.topic, kind, count, partial(
                decoder_of, self.path, channel.topic, kind, channel.message_encoding, FORMS.get(form, ""), text))

    def messages(self, names: set[str]) -> Iterator[tuple[str, int, bytes]]:
        """In the order of the file."""
        wanted = {key for key, channel in self._channels.items() if channel.topic in names}
        for channel, stamp, data in self._records(wanted):
            yield self._channels[channel].topic, stamp, data

    def _records(self, wanted: set[int] | None) -> Iterator[tuple[int, int, bytes]]:
        """(channel, arrival [ns], bytes); without `wanted` all of them, as their channels are not known yet."""
        self.remarks[:] = self._lasting
        self._broken.clear()
        if self._chunks is None or wanted is None:
            yield from self._from_the_beginning(wanted)
            return
        for index in sorted(self._chunks, key=lambda each: each.chunk_start_offset):
            if not index.message_index_offsets or wanted & set(index.message_index_offsets):
                yield from self._of_chunk_at(index.chunk_start_offset, wanted)

    def _of_chunk_at(self, offset: int, wanted: set[int]) -> Iterator[tuple[int, int, bytes]]:
        from mcap.stream_reader import StreamReader

        def chunk() -> Any:
            self._file.seek(offset)
            return next(iter(StreamReader(self._file, skip_magic=True, emit_chunks=True,
                                          record_size_limit=self._size).records))

        yield from self._of_chunk(f"the chunk at byte {offset}", chunk, wanted)

    def _of_chunk(self, name: str, chunk: Callable[[], Any], wanted: set[int] | None
                  ) -> list[tuple[int, int, bytes]]:
        """The messages of one chunk; none, and a remark, where it is broken or its checksum is wrong."""
        try:
            return list(self._messages_in(chunk(), wanted))
        except BadInput:
            raise
        except ChecksumError:
            why = "has a wrong checksum, so a byte in it is not as it was recorded; it is left out"
        except Exception:  # of the library and the packers beneath: a broken chunk has many
            why = "is broken and is left out"
        self._broken.setdefault(why, []).append(name)
        self.remarks[:] = [*self._lasting, *(
            f"{names[0]} of {self.path.name} {reason}" + (f", and so are {len(names) - 1} others" * (len(names) > 1))
            for reason, names in self._broken.items())]
        return []

    def _from_the_beginning(self, wanted: set[int] | None) -> Iterator[tuple[int, int, bytes]]:
        from mcap.records import Channel, Chunk, Footer, Message, Schema
        from mcap.stream_reader import CRCValidationError, StreamReader

        self._file.seek(0)
        is_closed, count, chunks, before = False, 0, 0, len(self.remarks)
        try:
            for record in StreamReader(self._file, emit_chunks=True, validate_crcs=True,
                                       record_size_limit=self._size).records:
                if isinstance(record, Schema):
                    self._schemas.setdefault(record.id, record)
                elif isinstance(record, Channel):
                    self._channels.setdefault(record.id, record)
                elif isinstance(record, Message):
                    count += 1
                    if wanted is None or record.channel_id in wanted:
                        yield record.channel_id, record.log_time, record.data
                elif isinstance(record, Chunk):
                    chunks += 1
                    for found in self._of_chunk(f"chunk {chunks}", partial(_same, record), wanted):
                        count += 1
                        yield found
                elif isinstance(record, Footer):
                    is_closed = True
        except BadInput:
            raise
        except CRCValidationError:  # of the whole file, at its end; a chunk that is broken was named
            is_closed = True
            if len(self.remarks) == before:
                self.remarks.append(f"{self.path.name} has a wrong checksum, so a byte in it is not as it was "
                                    "recorded; record it anew, or do not trust it")
        except Exception:  # of the library: a file that ends or is broken anywhere
            pass
        if not is_closed:
            self.remarks.append(f"{self.path.name} was not closed or is broken; {count} messages up to there are read")

    def _messages_in(self, chunk: Any, wanted: set[int] | None) -> Iterator[tuple[int, int, bytes]]:
        """The messages of a chunk; schemas and channels in it are noted."""
        from mcap.data_stream import ReadDataStream
        from mcap.records import Channel, Schema

        data = _unpacked_chunk(self.path, chunk)
        if chunk.uncompressed_crc and zlib.crc32(data) != chunk.uncompressed_crc:
            raise ChecksumError
        at, size = 0, len(data)
        while at + 9 <= size:
            code, length = data[at], int.from_bytes(data[at + 1:at + 9], "little")
            body = data[at + 9:at + 9 + length]
            at += 9 + length
            if code == 5 and length >= 22:
                channel, _, stamp, _ = struct.unpack_from("<HIQQ", body)
                if wanted is None or channel in wanted:
                    yield channel, stamp, bytes(body[22:])
            elif code in (3, 4):
                stream = ReadDataStream(io.BytesIO(bytes(body)))
                if code == 3:
                    schema = Schema.read(stream)
                    self._schemas.setdefault(schema.id, schema)
                else:
                    found = Channel.read(stream)
                    self._channels.setdefault(found.id, found)

    def close(self) -> None:
        """Closes the file."""
        self._file.close()


class ChecksumError(Exception):
    """The bytes of a chunk are others than those that were recorded."""


def _same(record: Any) -> Any:
    return record


def _unpacked_chunk(path: Path, chunk: Any) -> memoryview:
    """What a chunk holds; BadInput for one that is far larger than any recorder makes."""
    size = chunk.uncompressed_size
    if size > MOST_BYTES_OF_CHUNK:
        raise BadInput(f"{path}: has a chunk of {size} bytes, more than {MOST_BYTES_OF_CHUNK >> 20} MiB; record it in "
                       "smaller chunks, or repair the file")
    if chunk.compression == "zstd":
        import zstandard

        with zstandard.ZstdDecompressor().stream_reader(chunk.data) as reader:
            return memoryview(reader.read(size))
    if chunk.compression == "lz4":
        import lz4.frame

        return memoryview(lz4.frame.LZ4FrameDecompressor().decompress(chunk.data, max_length=size))
    return memoryview(chunk.data)


def _unpacked_message(data: bytes) -> bytes:
    """Of a rosbag2 that packs each message; as it is where it cannot be unpacked, so that decoding reports it."""
    import zstandard

    with suppress(zstandard.ZstdError), zstandard.ZstdDecompressor().stream_reader(data) as reader:
        return bytes(reader.read(MOST_BYTES_OF_MESSAGE))
    return data


class Rosbag1File:
    """A rosbag of ROS 1."""

    def __init__(self, path: Path):
        from rosbags.rosbag1 import Reader

        self.path, self.remarks = path, list[str]()
        self.topics: dict[str, Topic] = {}
        try:
            self._reader = Reader(path)
            self._reader.open()
        except Exception:  # of the library: a broken index has many kinds of errors
            raise BadInput(f"{path}: is a rosbag whose index is broken or missing; repair it by `rosbag reindex`, or "
                           f"{GIVE}") from None
        for connection in self._reader.connections:
            before = self.topics.get(connection.topic)
            count = connection.msgcount + ((before.count or 0) if before else 0)
            self.topics[connection.topic] = Topic(connection.topic, connection.msgtype, count, partial(
                decoder_of, path, connection.topic, connection.msgtype, "ros1", "msg", connection.msgdef.data))

    def messages(self, names: set[str]) -> Iterator[tuple[str, int, bytes]]:
        """In the order of their arrival."""
        wanted = [each for each in self._reader.connections if each.topic in names]
        taken = 0
        try:
            for connection, stamp, data in self._reader.messages(connections=wanted) if wanted else ():
                taken += 1
                yield connection.topic, stamp, bytes(data)
        except BadInput:
            raise
        except Exception:  # of the library and the packers beneath
            self.remarks.append(f"{self.path.name} is broken after {taken} messages; what follows is left out")

    def close(self) -> None:
        """Closes the file."""
        with suppress(Exception):  # one that broke while it was read
            self._reader.close()


class _Unpacked:
    """A rosbag2 that was packed as a whole: its file, unpacked on the disk until it is closed."""

    def __init__(self, path: Path):
        import zstandard

        self.path = path
        self._folder = ExitStack()
        folder = self._folder.enter_context(tempfile.TemporaryDirectory(prefix="laconic-bag-"))
        plain = Path(folder) / (path.name[:-5] if path.name.lower().endswith(".zstd") else path.name)
        try:
            with path.open("rb") as packed, plain.open("wb") as file:
                zstandard.ZstdDecompressor().copy_stream(packed, file, write_size=COPIED_AT_ONCE)
            if first_bytes(plain).startswith(ZSTD_MAGIC):
                raise zstandard.ZstdError
            self._inner = opened(plain)
        except (zstandard.ZstdError, BadInput):
            self._folder.close()
            raise BadInput(f"{path}: is packed by zstd, but broken or no rosbag2; {GIVE}") from None
        self.topics, self.remarks = self._inner.topics, self._inner.remarks

    def messages(self, names: set[str]) -> Iterator[tuple[str, int, bytes]]:
        """Of the file inside."""
        return self._inner.messages(names)

    def close(self) -> None:
        """Removes the unpacked file."""
        self._inner.close()
        self._folder.close()
