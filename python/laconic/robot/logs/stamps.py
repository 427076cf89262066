"""Instants that are no plain seconds: on two columns, in whole nanoseconds, or as a date and a time of day."""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import datetime, timedelta, timezone
from fractions import Fraction
from pathlib import Path

import numpy as np

from laconic.errors import BadInput, shown
from laconic.robot.logs.quantity import Quantity
from laconic.robot.logs.units import ISO, TIME

DATE = re.compile(r"(\d{4})[-/](\d\d?)[-/](\d\d?)[T ]+(\d\d?):(\d\d):(\d\d)(?:[.,](\d+))?\s*(Z|[+-]\d\d:?\d\d)?")
EPOCH = datetime(1970, 1, 1, tzinfo=timezone.utc)
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
    steps = np.mod(np.diff(values), float(quantity.wrap))
    return np.concatenate([[0.0], np.cumsum(steps)]) * float(unit) * quantity.scales[0]


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
