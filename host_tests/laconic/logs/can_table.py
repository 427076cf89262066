"""A CAN log (BLF, ASC) as a table: one row for each round of the frames that the map names, decoded by a DBC."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from cantools.database.can import Database, Message

from laconic.dbc_file import load_dbc
from laconic.errors import BadInput, nearest_of, shown
from laconic.logs.column_map import NUMBERED, ColumnMap, Quantity
from laconic.paths import SOURCE_DIR
from laconic.rig.logs import read_log

OWN_DBC = SOURCE_DIR / "firmware_stub" / "laconic.dbc"


@dataclass(frozen=True)
class CanTable:
    """Time and the values of each signal, by "MESSAGE.signal"."""

    time_s: np.ndarray
    values: dict[str, np.ndarray]


def database_of(columns: ColumnMap) -> Database:
    """The DBC that a map names: beside the map, or the project's own by its name."""
    beside = columns.path.parent / columns.dbc
    path = OWN_DBC if not beside.exists() and columns.dbc == OWN_DBC.name else beside
    return load_dbc(path, f"{columns.path}: dbc: {path}")


def signal_names(columns: ColumnMap, quantity: Quantity, database: Database) -> list[str]:
    """The signals of a quantity; a name with # stands for all that the message has."""
    names: list[str] = []
    for column in map(str, quantity.columns):
        message, signal = column.split(".")
        known = {each.name: each for each in database.messages}
        if message not in known:
            raise BadInput(f"{columns.path}: {quantity.name}.columns: the DBC has no message {shown(message)}; "
                           f"{nearest_of(message, known)}")
        signals = [each.name for each in known[message].signals]
        numbered = (signal.replace(NUMBERED, str(n)) for n in range(1, len(signals) + 1))
        there = [each for each in dict.fromkeys(numbered) if each in signals]
        if not there:
            raise BadInput(f"{columns.path}: {quantity.name}.columns: {message} has no signal {shown(signal)}; "
                           f"{nearest_of(signal, signals)}")
        names += [f"{message}.{each}" for each in there]
    return names


def read_can(path: Path, columns: ColumnMap) -> CanTable:
    """A row where each frame that must be there has come anew; what is optional is held from frame to frame."""
    database = database_of(columns)
    optional = {quantity.name: quantity.is_optional for quantity in columns.quantities.values()}
    wanted = {name.split(".")[0]: optional[quantity.name] for quantity in columns.quantities.values()
              for name in signal_names(columns, quantity, database)}
    by_id = {each.frame_id: each for each in database.messages if each.name in wanted}
    frames = [(frame.timestamp, *_decoded(path, number, by_id[frame.arbitration_id], frame.data, columns.group))
              for number, frame in enumerate(read_log(path), start=1) if frame.arbitration_id in by_id]
    needed = {key for _, key, _ in frames if not wanted[key[0]]}
    missing = {name for name, is_optional in wanted.items() if not is_optional} - {key[0] for key in needed}
    if missing:
        raise BadInput(f"{path}: holds no frame {sorted(missing)[0]}; record it, or correct the map's dbc")
    rows = list(_rounds(frames, needed))
    if not rows:
        raise BadInput(f"{path}: holds no whole round of its frames; give a longer log")
    names = sorted(set.intersection(*(set(row) for _, row in rows)))
    values = {name: np.array([row[name] for _, row in rows]) for name in names}
    return CanTable(np.array([time for time, _ in rows]), values)


Key = tuple[str, int]
"""A message and its group of wheels (0 where it has none)."""


def _decoded(path: Path, number: int, message: Message, data: Any, group: str) -> tuple[Key, dict[str, float]]:
    """The key of a frame and its signals, "MESSAGE.signal"; in a group the signals' numbers go on counting."""
    try:
        signals: Any = message.decode(bytes(data), decode_choices=False, scaling=True)
        decoded: dict[str, Any] = dict(signals)
    except Exception:  # a decoder may raise any exception on unexpected bytes
        raise BadInput(f"{path}: frame {number}: {message.name} cannot be decoded: it has {len(data)} "
                       f"bytes, and {message.length} by the map's dbc; correct that") from None
    values = {name: float(value) for name, value in decoded.items() if isinstance(value, (int, float))}
    which = int(values.get(group, 0.0))
    return (message.name, which), {_counted(message, name, which): value for name, value in values.items()}


def _counted(message: Message, signal: str, group: int) -> str:
    stem = signal.rstrip("0123456789")
    if stem == signal or not group:
        return f"{message.name}.{signal}"
    per_group = sum(each.name.rstrip("0123456789") == stem for each in message.signals)
    return f"{message.name}.{stem}{int(signal[len(stem):]) + group * per_group}"


def _rounds(frames: Iterable[tuple[float, Key, dict[str, float]]],
            needed: set[Key]) -> Iterator[tuple[float, dict[str, float]]]:
    """The values as they stand once every needed frame has come since the row before, and the time of the last."""
    held: dict[str, float] = {}
    fresh: set[Key] = set()
    for time, key, values in frames:
        held.update(values)
        fresh.add(key)
        if needed <= fresh:
            yield time, dict(held)
            fresh = set()
