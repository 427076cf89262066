"""Where samples come from: a text log, frames of a bus, topics of a recording, variables of a MATLAB file."""

from __future__ import annotations

import re
from collections.abc import Callable, Container, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta, timezone
from fractions import Fraction
from pathlib import Path

import numpy as np

from laconic.errors import BadInput, shown
from laconic.robot.logs.column_map import ColumnMap
from laconic.robot.logs.formats.text_table import TextTable, read_text
from laconic.robot.logs.log import LEAST_SAMPLES
from laconic.robot.logs.quantity import NUMBERED, Column, Quantity, is_numbered
from laconic.robot.logs.units import ISO, TIME

DATE = re.compile(r"(\d{4})[-/](\d\d?)[-/](\d\d?)[T ]+(\d\d?):(\d\d):(\d\d)(?:[.,](\d+))?\s*(Z|[+-]\d\d:?\d\d)?")
EPOCH = datetime(1970, 1, 1, tzinfo=timezone.utc)
MOST_OF_SECOND = 0.6   # a rest that goes so far before the second changes has its unit's border there
EXACT = {"ms": 10**3, "us": 10**6, "ns": 10**9, "s": 1}


def needs_texts(quantity: Quantity) -> bool:
    """Whether the text of its cells has more digits than a floating-point number keeps."""
    return len(quantity.columns) > 1 or quantity.units[0] in (ISO, "ns", "us")


def seconds_of(path: Path, quantity: Quantity, cells: Sequence[Sequence[str]], lines: Sequence[int]) -> np.ndarray:
    """Seconds since the first line, with all digits; BadInput names the line that holds no instant."""
    if quantity.units[0] != ISO and isinstance(quantity.wrap, float):
        return _wrapped(path, quantity, cells, lines)
    found = [_instant(path, quantity, row, line) for row, line in zip(cells, lines, strict=True)]
    return np.array([float(each - found[0]) for each in found]) * quantity.scales[0]


def _wrapped(path: Path, quantity: Quantity, cells: Sequence[Sequence[str]], lines: Sequence[int]) -> np.ndarray:
    """Of a clock that begins again."""
    unit = Fraction(1, EXACT.get(quantity.units[0], 1))
    values = np.array([float(_instant(path, quantity, row, line) / unit)
                       for row, line in zip(cells, lines, strict=True)])
    assert quantity.wrap
    return _since_first(values, float(quantity.wrap)) * float(unit) * quantity.scales[0]


def _since_first(values: np.ndarray, wrap: float) -> np.ndarray:
    """What a clock that begins again after `wrap` counted since its first value."""
    return np.concatenate([[0.0], np.cumsum(np.mod(np.diff(values), wrap))])


def doubt_of_rest(quantity: Quantity, parts: Sequence[np.ndarray]) -> list[str]:
    """A remark where seconds and their rest show another unit of the rest: it begins again with each second at the
    border of that unit."""
    seconds, rest = parts if quantity.units[0] == "s" else parts[::-1]
    unit = quantity.units[1 if quantity.units[0] == "s" else 0]
    changes = np.flatnonzero(np.diff(seconds) == 1.0)
    border = next((name for name in ("ms", "us", "ns") if np.abs(rest).max() < EXACT[name]), None)
    if border in (None, unit) or unit not in EXACT or not len(changes):
        return []
    high, low = rest[changes] / EXACT[border], rest[changes + 1] / EXACT[border]
    if not (np.median(high) > MOST_OF_SECOND and np.median(low) < 1.0 - MOST_OF_SECOND):
        return []
    column = quantity.columns[list(quantity.units).index(unit)]
    return [f"time: {shown(column)} is given in {unit}, but begins again with each second before {EXACT[border]}, as "
            f"{border} do; give {border} in its place under [time] in the map"]


def _instant(path: Path, quantity: Quantity, texts: Sequence[str], line: int) -> Fraction:
    try:
        if quantity.units[0] == ISO:
            return of_date(" ".join(texts))
        return sum((_exact(text, unit) for text, unit in zip(texts, quantity.units, strict=True)), Fraction(0))
    except (ValueError, OverflowError):
        what = "no date and time of day" if quantity.units[0] == ISO else "no number for time"
        like = ", such as 2024-05-31T12:00:00.25Z" if quantity.units[0] == ISO else ""
        raise BadInput(f"{path}: line {line}: {what} ({shown(' '.join(texts)[:40])}){like}; remove the line or repair "
                       "it") from None


def _exact(text: str, unit: str) -> Fraction:
    """A decimal number without rounding; ValueError for what is none."""
    if not re.fullmatch(r"[+-]?(\d{1,25}\.?\d{0,30}|\.\d{1,30})([eE][+-]?\d{1,2})?", text):
        raise ValueError(text)
    return Fraction(text) / EXACT[unit] if unit in EXACT else Fraction(text) * Fraction(TIME[unit])


def of_date(text: str) -> Fraction:
    """Seconds since 1970 in UTC; a text without an offset is taken for UTC. ValueError for what is no date."""
    found = DATE.fullmatch(text.strip().strip('"'))
    if found is None:
        raise ValueError(text)
    year, month, day, hour, minute, second = map(int, found.groups()[:6])
    offset = timedelta(0)
    if found[8] and found[8] != "Z":
        digits = found[8][1:].replace(":", "")
        offset = timedelta(hours=int(digits[:2]), minutes=int(digits[2:])) * (-1 if found[8][0] == "-" else 1)
    whole = datetime(year, month, day, hour, minute, min(second, 59), tzinfo=timezone.utc) - offset
    rest = Fraction(int(found[7]), 10 ** len(found[7])) if found[7] else Fraction(0)
    return Fraction(round((whole - EPOCH).total_seconds())) + max(0, second - 59) + rest


def is_date(text: str) -> bool:
    """Whether a text is an instant as a date and a time of day."""
    try:
        of_date(text)
    except ValueError:
        return False
    return True


Raw = tuple[np.ndarray, list[str]]
"""The columns of a quantity as they are recorded, NaN where nothing is, and their names for messages."""


@dataclass(frozen=True)
class Source:
    """A table of samples, each at its instant; quantities of one table may be recorded at different ones."""

    path: Path
    time_s: np.ndarray
    columns: Callable[[Quantity], Raw | None]
    place: Callable[[int], str]                 # names a sample
    is_row: np.ndarray | None = None            # which samples become rows; None: all
    hold_s: float = 0.0                         # a younger sample is taken as it is
    lines: Callable[[np.ndarray], str] | None = None   # names samples for remarks
    remarks: tuple[str, ...] = ()
    wheel_names: tuple[str, ...] = ()           # of the columns of wheels, where their order was guessed
    column_names: tuple[str, ...] = ()          # of the wheels' joints, in the order of the map
    is_geodetic: bool = False                   # positions are latitude and longitude
    tells_gaps: bool = True                     # a blank sample is worth a remark


def source_of(path: Path, columns: ColumnMap) -> Source:
    """The samples of a log, in the format of its map."""
    if columns.format == "bag":
        from laconic.robot.logs.formats.bag_source import bag_source

        return bag_source(path, columns)
    if columns.format == "mat":
        from laconic.robot.logs.formats.bag_source import mat_source

        return mat_source(path, columns)
    return _can_source(path, columns) if columns.format == "can" else _text_source(path, columns)


def _text_source(path: Path, columns: ColumnMap) -> Source:
    table = read_text(path, columns)

    def raw(quantity: Quantity) -> Raw | None:
        wanted = numbered(quantity, table.names)
        if quantity.first:
            wanted = tuple(range(quantity.first, len(table.rows[0]) + 1))
            if not wanted:
                raise BadInput(f"{table.path}: line {table.lines[0]}: has {len(table.rows[0])} columns, none from "
                               f"{quantity.first} on for {quantity.name}; correct the column map with --map")
            _check_even(table)
        if quantity.is_optional and (not wanted or any(isinstance(c, str) and c not in table.names for c in wanted)):
            return None
        indices = table.indices_of(wanted, quantity.name)
        return (table.numbers(indices, quantity.name, may_be_blank=quantity.name != "time", keyword=quantity.keyword),
                [table.label(index) for index in indices])

    of_time, remarks = columns.quantities["time"], list(table.remarks)
    if needs_texts(of_time):
        indices = table.indices_of(of_time.columns, "time")
        cells = table.cells(indices)
        seconds = seconds_of(path, of_time, cells, table.lines)
        if len(indices) == 2 and of_time.units[0] != ISO:
            remarks += doubt_of_rest(of_time, list(np.array(cells, dtype=float).T))
        try:
            time = checked_time(path, of_time, seconds, table.lines)
        except BadInput as why:
            raise BadInput("; ".join(map(str, (why, *remarks)))) from None
    else:
        found = raw(of_time)
        assert found is not None
        time = _time(path, of_time, found[0][:, 0], table.lines)
    return Source(path, time, raw, lambda row: f"line {table.lines[row]}",
                  lines=lambda rows: _lines(table, rows), remarks=tuple(remarks))


def _time(path: Path, quantity: Quantity, values: np.ndarray, lines: Sequence[int]) -> np.ndarray:
    """In seconds; BadInput for a line whose time does not grow."""
    factor = quantity.scales[0] * TIME[quantity.units[0]]
    if isinstance(quantity.wrap, float):
        values = values[:1] + _since_first(values, quantity.wrap)
    return checked_time(path, quantity, values * factor, lines)


def checked_time(path: Path, quantity: Quantity, time: np.ndarray, lines: Sequence[int]) -> np.ndarray:
    """Instants that grow; BadInput for a line that does not."""
    grows = np.diff(time) > 0.0
    if not grows.all():
        row = int(np.argmin(grows)) + 1
        begins_again = quantity.wrap is None and time[row - 1] - time[row] > 0.5 * np.ptp(time)
        wrap = "; a clock that begins again needs wrap under [time] in the map" if begins_again else ""
        raise BadInput(f"{path}: line {lines[row]}: time does not grow ({time[row - 1]:.9g} s, then {time[row]:.9g} "
                       f"s); needs at least {LEAST_SAMPLES} samples with increasing time, so remove the line or repair "
                       f"it{wrap}")
    return time


def _lines(table: TextTable, rows: np.ndarray) -> str:
    """Lines in words: "line 2 is", "lines 2 to 5 and 9 are"."""
    runs = np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1)
    words = [str(table.lines[run[0]]) if len(run) == 1 else f"{table.lines[run[0]]} to {table.lines[run[-1]]}"
             for run in runs]
    parts = words if len(words) < 4 else [*words[:2], f"{len(words) - 2} other stretches"]
    if len(rows) == 1:
        return f"line {words[0]} is"
    return f"lines {' and '.join([', '.join(parts[:-1]), parts[-1]] if len(parts) > 1 else parts)} are"


def _check_even(table: TextTable) -> None:
    width = len(table.rows[0])
    for line, row in zip(table.lines, table.rows, strict=True):
        if len(row) != width:
            raise BadInput(f"{table.path}: line {line}: has {len(row)} columns, the first line {width}; remove the "
                           "line or repair it")


def numbered(quantity: Quantity, names: Container[str]) -> tuple[Column, ...]:
    """The columns; a name with # stands for those of wheel 1, 2 … as far as they are there."""
    if not is_numbered(quantity.columns):
        return quantity.columns
    column, found = str(quantity.columns[0]), list[Column]()
    while (name := column.replace(NUMBERED, str(len(found) + 1))) in names:
        found.append(name)
    if not found and not quantity.is_optional:
        return (column.replace(NUMBERED, "1"),)
    return tuple(found)


def _can_source(path: Path, columns: ColumnMap) -> Source:
    from laconic.robot.logs.can_table import read_can  # brings cantools, which takes a while

    table = read_can(path, columns)

    def raw(quantity: Quantity) -> Raw | None:
        names = [str(name) for name in numbered(quantity, table.names_on(quantity.channel_of(0, table.channel)))]
        found = [(name, column) for index, name in enumerate(names)
                 if (column := table.column(quantity, index, name)) is not None]
        if not found or len(found) < len(names):
            if quantity.is_optional:
                return None
            raise BadInput(f"{path}: has no signal {quantity.columns[0]!r} (for {quantity.name}); correct the map")
        return np.column_stack([column for _, column in found]), _labels(quantity, names)

    return Source(path, table.time_s, raw, lambda row: table.places[row], table.is_row, table.hold_s,
                  remarks=table.remarks)


def _labels(quantity: Quantity, names: Sequence[str]) -> list[str]:
    """The signals, with their channels where these differ."""
    if len(quantity.channels) < 2:
        return list(names)
    return [f"{name} on channel {channel}" for name, channel in zip(names, quantity.channels, strict=True)]
