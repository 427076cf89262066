"""Reads the wire contract: the database, the attributes of its messages, limits and value tables of its signals."""

from __future__ import annotations

from pathlib import Path

import cantools.database
from cantools.database.can import Database, Message, Signal


def load(path: Path) -> Database:
    """The database in a DBC file."""
    found = cantools.database.load_file(path)
    if not isinstance(found, Database):
        raise SystemExit(f"{path}: is no database of CAN frames")
    return found


def attribute(message: Message, name: str) -> str:
    """The message's attribute, or the database's default for it."""
    if message.dbc is None:
        raise SystemExit(f"laconic.dbc: {message.name}: has no attributes")
    found = message.dbc.attributes.get(name)
    return str(found.value if found else message.dbc.attribute_definitions[name].default_value)


def is_protected(message: Message) -> bool:
    """Whether the message has CRC and counter; those of XCP have neither."""
    return attribute(message, "E2EProfile") != "none"


def protected(database: Database) -> list[Message]:
    """The messages between rig and node, in the order of the file."""
    return [message for message in database.messages if is_protected(message)]


def limits(signal: Signal) -> tuple[float, float]:
    """Least and largest value, in the signal's unit."""
    if signal.minimum is None or signal.maximum is None:
        raise SystemExit(f"laconic.dbc: {signal.name}: has no range")
    return float(signal.minimum), float(signal.maximum)


def choices(signal: Signal) -> dict[int, str]:
    """The signal's value table, in the order of its numbers; empty where it has none."""
    return {number: str(text) for number, text in sorted((signal.choices or {}).items())}
