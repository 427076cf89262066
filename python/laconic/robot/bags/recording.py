"""A recording of topics, whatever its container: which topics there are, and their messages one after another.

Messages of topics that nobody asks for are skipped and never decoded, and no more than one chunk is in memory.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

ENDINGS = (".bag", ".db3", ".mcap", ".ulg", ".ulog", ".db3.zstd", ".mcap.zstd")
OF_ROSBAG2 = (".db3", ".mcap", ".db3.zstd", ".mcap.zstd")
MCAP_MAGIC = b"\x89MCAP0\r\n"
BAG_MAGIC = b"#ROSBAG V2.0"
SQLITE_MAGIC = b"SQLite format 3\0"
ULOG_MAGIC = b"ULog\x01\x12\x35"
ZSTD_MAGIC = b"\x28\xb5\x2f\xfd"
MAGICS = (MCAP_MAGIC, BAG_MAGIC, SQLITE_MAGIC, ULOG_MAGIC)
GIVE = "give a whole recording"

Decode = Callable[[bytes], Any]
"""Makes a message with fields of the bytes of one."""


@dataclass(frozen=True)
class Topic:
    """One topic; `count` is None where the container does not hold how many messages it has."""

    name: str
    type: str
    count: int | None
    decoder: Callable[[], Decode] = field(repr=False, compare=False)  # called where the topic is read, and only there


class Recording(Protocol):
    """An open container of one file."""

    path: Path
    topics: dict[str, Topic]
    remarks: list[str]

    def messages(self, names: set[str]) -> Iterator[tuple[str, int, bytes]]:
        """(topic, instant of arrival [ns], bytes) of these topics, in the order of the file."""
        ...

    def close(self) -> None:
        """Lets go of the file."""
        ...


def first_bytes(path: Path, count: int = 16) -> bytes:
    """How a file begins; empty where it cannot be read."""
    with suppress(OSError), path.open("rb") as file:
        return file.read(count)
    return b""


def is_bag(path: Path) -> bool:
    """Whether a file or folder is a recording of topics, by its ending or by how it begins."""
    if path.is_dir():
        return bool(parts_of(path))
    return path.name.lower().endswith(ENDINGS) or first_bytes(path).startswith(MAGICS)


def parts_of(path: Path) -> list[Path]:
    """The files of a recording: those of a rosbag2 folder, with metadata.yaml or, where its recorder was stopped before
    it wrote that, with files that are named after the folder."""
    if not path.is_dir():
        return [path]
    found = sorted((each for each in path.iterdir() if each.is_file() and each.name.lower().endswith(OF_ROSBAG2)),
                   key=_number_of)
    is_whole = (path / "metadata.yaml").is_file()
    return [each for each in found if is_whole or each.name.startswith(f"{path.resolve().name}_")]


def _number_of(path: Path) -> tuple[int, str]:
    """NAME_10.db3 comes after NAME_9.db3."""
    digits = path.name.split(".")[0].rpartition("_")[2]
    return (int(digits) if digits.isdigit() else 0, path.name)
