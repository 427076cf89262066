"""What makes messages with fields of bytes: CDR and ROS 1 by their definitions, JSON by itself."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any

import orjson

from laconic.errors import BadInput
from laconic.robot.bags.recording import Decode

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
        store = _store_of(name, form, definition)
        store.get_msgdef(name)
    except Exception:  # of the parser of a text that is no definition: it has many kinds
        raise BadInput(f"{path}: {topic} is of type {type_name}, whose definition "
                       f"{'is broken' if definition else 'is not in the recording'}; record it anew, with definitions, "
                       "or leave the topic out of the map") from None
    is_cdr = encoding == "cdr"
    decode = store.deserialize_cdr if is_cdr else store.deserialize_ros1
    return lambda data: decode(data, name)


@lru_cache(maxsize=256)
def _store_of(name: str, form: str, definition: str) -> Any:
    """The types that a definition names; without one those of ROS 2 itself."""
    from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore

    if not definition:
        return get_typestore(Stores.ROS2_JAZZY)
    store = get_typestore(Stores.EMPTY)
    if form == "idl":
        parts = definition.split(IDL_LINE)[1:] if definition.startswith(IDL_LINE) else [f"\n{definition}"]
        types: dict[str, Any] = {}
        for part in parts:
            types.update(get_types_from_idl(part.split("\n", 1)[1]))
    else:
        types = get_types_from_msg(definition, name)
    store.register(types)
    return store


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

    return take


def _member(name: str) -> Callable[[Any, Any], Any]:
    return lambda value, _: value[name] if isinstance(value, dict) else getattr(value, name)


def _item(index: str) -> Callable[[Any, Any], Any]:
    """By number from 0, or by the name that the message has for it beside the list."""
    if index.isdigit():
        return lambda value, _: value[int(index)]

    def by_name(value: Any, owner: Any) -> Any:
        names = owner["name"] if isinstance(owner, dict) else owner.name
        return value[list(names).index(index)]

    return by_name


def stamp_ns(message: Any) -> int | None:
    """The instant of a message's header; None where it has none, or one that nobody set."""
    header = message.get("header") if isinstance(message, dict) else getattr(message, "header", None)
    stamp = (header or {}).get("stamp") if isinstance(header, dict) else getattr(header, "stamp", None)
    if stamp is None and isinstance(message, dict):
        stamp = message.get("timestamp")  # of Foxglove's schemas
    if stamp is None or isinstance(stamp, (int, float, str)):
        return None
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
