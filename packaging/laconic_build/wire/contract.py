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


def limits(signal: Signal) -> tuple[float, float]:
    """Least and largest value, in the signal's unit."""
    if signal.minimum is None or signal.maximum is None:
        raise SystemExit(f"laconic.dbc: {signal.name}: has no range")
    return float(signal.minimum), float(signal.maximum)


def choices(signal: Signal) -> dict[int, str]:
    """The signal's value table, in the order of its numbers; empty where it has none."""
    return {number: str(text) for number, text in sorted((signal.choices or {}).items())}
