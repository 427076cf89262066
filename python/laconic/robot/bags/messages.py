"""Recordings of topics: what a container has, and what makes messages with fields of its bytes (CDR, ROS 1, JSON)."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache, lru_cache
from operator import attrgetter
from pathlib import Path
from typing import Any, Protocol

import orjson

from laconic.errors import BadInput

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


PARTS = re.compile(r"\[[^\]]*\]|[^.\[\]]+")
STAMP_PARTS = (("sec", "secs"), ("nanosec", "nsec", "nsecs"))
IDL_LINE = "=" * 80 + "\n"


def decoder_of(path: Path, topic: str, type_name: str, encoding: str, form: str, definition: str) -> Decode:
    """What decodes the messages of a topic; BadInput where they are in an encoding or of a type that is unknown."""
    if encoding == "json":
        return orjson.loads
    if encoding not in ("cdr", "ros1"):
        raise BadInput(f"{path}: {topic} is encoded as {encoding or 'nothing'}, which is not read; record it as cdr, "
                       "ros1 or json")
    from rosbags.typesys.msg import normalize_msgtype

    try:
        name = normalize_msgtype(type_name)
        types = _store_of(name, form, definition)
        types.get_msgdef(name)
    except Exception:  # of the parser of a text that is no definition: it has many kinds
        raise BadInput(f"{path}: {topic} is of type {type_name}, whose definition "
                       f"{'is broken' if definition else 'is not in the recording'}; record it anew, with definitions, "
                       "or leave the topic out of the map") from None
    is_cdr = encoding == "cdr"
    decode = types.deserialize_cdr if is_cdr else types.deserialize_ros1
    return lambda data: decode(data, name)


@cache
def store() -> Any:
    """The types of ROS 2 itself."""
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS2_JAZZY)


@lru_cache(maxsize=256)
def _store_of(name: str, form: str, definition: str) -> Any:
    """The types that a definition names; without one those of ROS 2 itself."""
    from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore

    if not definition:
        return store()
    found = get_typestore(Stores.EMPTY)
    if form == "idl":
        parts = definition.split(IDL_LINE)[1:] if definition.startswith(IDL_LINE) else [f"\n{definition}"]
        types: dict[str, Any] = {}
        for part in parts:
            types.update(get_types_from_idl(part.split("\n", 1)[1]))
    else:
        types = get_types_from_msg(definition, name)
    found.register(types)
    return found


def field_of(column: str) -> Callable[[Any], Any]:
    """What takes a field out of a message: "pose.position.x", "axes[1]", "position[left_wheel_joint]" (by the message's
    own list `name`). It raises KeyError, IndexError or AttributeError where a message has none."""
    steps: list[Callable[[Any, Any], Any]] = []
    for part in PARTS.findall(column):
        steps.append(_item(part[1:-1]) if part.startswith("[") else _member(part))

    def take(message: Any) -> Any:
        found, before = message, message
        for step in steps:
            found, before = step(found, before), found
        return found

    if not steps or "[" in column:
        return take
    member = attrgetter(".".join(PARTS.findall(column)))  # of most fields, and far faster
    return lambda message: take(message) if isinstance(message, dict) else member(message)


def _member(name: str) -> Callable[[Any, Any], Any]:
    return lambda value, _: value[name] if isinstance(value, dict) else getattr(value, name)


def _item(index: str) -> Callable[[Any, Any], Any]:
    """By number from 0, or by the name that the message has for it beside the list."""
    if index.isdigit():
        return lambda value, _: value[int(index)]

    def by_name(value: Any, owner: Any) -> Any:
        names = owner["name"] if isinstance(owner, dict) else owner.name
        place = list(names).index(index)
        if not len(value):
            raise KeyError(index)  # a list that the message leaves empty, as the format allows
        return value[place]

    return by_name


def stamp_ns(message: Any) -> int | None:
    """The instant of a message's header; None where it has none, or one that nobody set."""
    header = message.get("header") if isinstance(message, dict) else getattr(message, "header", None)
    stamp = (header or {}).get("stamp") if isinstance(header, dict) else getattr(header, "stamp", None)
    if stamp is None and isinstance(message, dict):
        stamp = message.get("timestamp")  # of Foxglove's schemas
    if stamp is None or isinstance(stamp, (int, float, str)):
        return None
    if (seconds := getattr(stamp, "sec", None)) is not None and (rest := getattr(stamp, "nanosec", None)) is not None:
        return int(seconds) * 10**9 + int(rest)  # of nearly all messages, so first
    parts = [[stamp.get(name) if isinstance(stamp, dict) else getattr(stamp, name, None) for name in names]
             for names in STAMP_PARTS]
    seconds, rest = (next((value for value in found if value is not None), None) for found in parts)
    return None if seconds is None else int(seconds) * 10**9 + int(rest or 0)


def parts_of_message(value: Any, name: str = "", depth: int = 0) -> list[tuple[str, Any]]:
    """The numbers in a message by their paths, of lists the first ones, as an example."""
    if isinstance(value, (bool, int, float, str)):
        return [(name, value)]
    if depth > 8 or value is None:
        return []
    if isinstance(value, dict):
        members = list(value.items())
    elif hasattr(value, "__dataclass_fields__"):
        members = [(each, getattr(value, each)) for each in value.__dataclass_fields__ if each != "__msgtype__"]
    elif hasattr(value, "__len__"):
        return [each for index, item in enumerate(list(value[:12]))
                for each in parts_of_message(item.item() if hasattr(item, "item") else item, f"{name}[{index}]",
                                             depth + 1)]
    else:
        return [(name, value.item())] if hasattr(value, "item") else []
    return [each for key, item in members
            for each in parts_of_message(item, f"{name}.{key}" if name else str(key), depth + 1)]
