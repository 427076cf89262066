"""Writes recordings of topics: a folder as rosbag2 records it (SQLite), or one MCAP. What was written stays readable
when the program ends before its time."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, Protocol

from laconic.base.outputs import claims, make_folder
from laconic.errors import BadInput, reason_of

COMMITTED_AT_ONCE = 2000       # messages
BYTES_OF_CHUNK = 1 << 18
DISTRIBUTION = "jazzy"
TABLES = """
CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);
CREATE TABLE metadata(id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL, metadata TEXT NOT NULL);
CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT NOT NULL,
    offered_qos_profiles TEXT NOT NULL, type_description_hash TEXT NOT NULL);
CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, encoding TEXT NOT NULL,
    encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL);
CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL,
    data BLOB NOT NULL);
CREATE INDEX timestamp_idx ON messages (timestamp ASC);
"""


@cache
def store() -> Any:
    """The types of ROS 2."""
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS2_JAZZY)


def definition_of(kind: str) -> tuple[str, str]:
    """(text of the definition of a type and all that is in it, hash of the type)."""
    return store().generate_msgdef(kind, ros_version=2)[0], store().hash_rihs01(kind)


class BagWriter(Protocol):
    """An open recording."""

    def write(self, topic: str, kind: str, stamp_ns: int, message: Any) -> None:
        """A message of a topic, whose type is stated with its first one."""
        ...

    def close(self) -> None:
        """Completes the files."""
        ...


def check_bag(option: str, path: Path) -> None:
    """BadInput for a folder that holds something already; files are checked as all outputs are."""
    if path.suffix.lower() != ".mcap" and path.is_dir() and any(path.iterdir()):
        raise BadInput(f"{option} {path}: is a folder that holds files already; choose a new folder, or a name that "
                       "ends in .mcap")


@contextmanager
def open_bag(path: Path) -> Iterator[BagWriter]:
    """A new recording by its name; it is completed whatever happens on the way."""
    check_bag("--bag", path)
    claims().write(path)
    try:
        make_folder(path.parent if path.suffix.lower() == ".mcap" else path)
        writer: BagWriter = McapBag(path) if path.suffix.lower() == ".mcap" else Rosbag2(path)
    except (OSError, sqlite3.Error) as error:
        raise _refused(path, error) from None
    try:
        yield writer
    except (OSError, sqlite3.Error) as error:
        raise _refused(path, error) from None
    finally:
        try:
            writer.close()
        except (OSError, sqlite3.Error) as error:
            raise _refused(path, error) from None


def _refused(path: Path, error: OSError | sqlite3.Error) -> BadInput:
    reason = reason_of(error) if isinstance(error, OSError) else str(error)
    return BadInput(f"--bag {path}: cannot be written ({reason}); choose another path")


class McapBag:
    """One MCAP with the profile of ROS 2."""

    def __init__(self, path: Path):
        from mcap.writer import CompressionType, Writer

        self._file = path.open("wb")
        self._writer = Writer(self._file, chunk_size=BYTES_OF_CHUNK, compression=CompressionType.ZSTD)
        self._writer.start(profile="ros2", library="laconic")
        self._schemas: dict[str, int] = {}
        self._channels: dict[str, int] = {}

    def write(self, topic: str, kind: str, stamp_ns: int, message: Any) -> None:
        """A message of a topic."""
        if topic not in self._channels:
            if kind not in self._schemas:
                text, _ = definition_of(kind)
                self._schemas[kind] = self._writer.register_schema(kind, "ros2msg", text.encode())
            self._channels[topic] = self._writer.register_channel(topic, "cdr", self._schemas[kind],
                                                                  {"offered_qos_profiles": ""})
        self._writer.add_message(self._channels[topic], stamp_ns, bytes(store().serialize_cdr(message, kind)), stamp_ns)

    def close(self) -> None:
        """Writes the index and closes the file."""
        try:
            self._writer.finish()  # type: ignore[no-untyped-call]
        finally:
            self._file.close()


class Rosbag2:
    """A folder with one SQLite file and metadata.yaml."""

    def __init__(self, path: Path):
        self.path = path
        self._name = f"{path.resolve().name}_0.db3"
        self._base = sqlite3.connect(path / self._name)
        self._base.executescript(TABLES)
        self._base.execute("INSERT INTO schema VALUES (4, ?)", (DISTRIBUTION,))
        self._topics: dict[str, tuple[int, str]] = {}
        self._counts: dict[str, int] = {}
        self._first, self._last, self._pending = 2**63 - 1, 0, 0
        self._base.commit()

    def write(self, topic: str, kind: str, stamp_ns: int, message: Any) -> None:
        """A message of a topic."""
        if topic not in self._topics:
            self._add(topic, kind)
        self._base.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)",
                           (self._topics[topic][0], stamp_ns, bytes(store().serialize_cdr(message, kind))))
        self._counts[topic] += 1
        self._first, self._last = min(self._first, stamp_ns), max(self._last, stamp_ns)
        self._pending += 1
        if self._pending >= COMMITTED_AT_ONCE:
            self._base.commit()
            self._pending = 0

    def _add(self, topic: str, kind: str) -> None:
        text, digest = definition_of(kind)
        if kind not in {known for _, known in self._topics.values()}:
            self._base.execute("INSERT INTO message_definitions(topic_type, encoding, encoded_message_definition, "
                               "type_description_hash) VALUES (?, 'ros2msg', ?, ?)", (kind, text, digest))
        cursor = self._base.execute("INSERT INTO topics(name, type, serialization_format, offered_qos_profiles, "
                                    "type_description_hash) VALUES (?, ?, 'cdr', '', ?)", (topic, kind, digest))
        assert cursor.lastrowid is not None
        self._topics[topic], self._counts[topic] = (cursor.lastrowid, kind), 0

    def close(self) -> None:
        """Writes metadata.yaml and closes the file."""
        text = self._metadata()
        self._base.execute("INSERT INTO metadata(metadata_version, metadata) VALUES (8, ?)", (text,))
        self._base.commit()
        self._base.close()
        (self.path / "metadata.yaml").write_text(text, encoding="utf-8")

    def _metadata(self) -> str:
        total = sum(self._counts.values())
        first = self._first if total else 0
        head = ["rosbag2_bagfile_information:", "  version: 8", "  storage_identifier: sqlite3",
                *_span("  ", first, self._last - first), f"  message_count: {total}", "  topics_with_message_count:"]
        for topic, (_, kind) in self._topics.items():
            head += ["    - topic_metadata:", f"        name: {topic}", f"        type: {kind}",
                     "        serialization_format: cdr", "        offered_qos_profiles: []",
                     f"        type_description_hash: {definition_of(kind)[1]}",
                     f"      message_count: {self._counts[topic]}"]
        name = self._name.replace('"', '\\"')
        return "\n".join([
            *head, '  compression_format: ""', '  compression_mode: ""', "  relative_file_paths:", f'    - "{name}"',
            "  files:", f'    - path: "{name}"', *_span("      ", first, self._last - first),
            f"      message_count: {total}", "  custom_data: ~", f"  ros_distro: {DISTRIBUTION}", ""])


def _span(indent: str, first_ns: int, length_ns: int) -> list[str]:
    return [f"{indent}duration:", f"{indent}  nanoseconds: {length_ns}", f"{indent}starting_time:",
            f"{indent}  nanoseconds_since_epoch: {first_ns}"]
