"""Reads TRC, the text log of PEAK's tools, versions 1.0 to 2.1; times are milliseconds.

    ;$FILEVERSION=2.1
    ;$COLUMNS=N,O,T,B,I,d,R,L,D
          1      1059.900 DT 1      0300 Rx -  7    00 00 00 00 04 00 00
"""

from __future__ import annotations

import re
from pathlib import Path

from laconic.robot.logs.formats.can_frames import (
    FD_LENGTHS,
    STANDARD,
    LoggedFrame,
    Recorded,
    bytes_in,
    fail,
    frames_of_lines,
    identifier_of,
    whole_in,
)

COLUMNS = {"1.0": "NOILD", "1.1": "NOTILD", "1.2": "NOBTILD", "1.3": "NOBTIRLD", "2.0": "NOTIdlD",
           "2.1": "NOTBIdRLD"}
"""N number, O time, T type, B bus, I identifier, d direction, R reserved, L length code, l length, D bytes."""
HEAD = re.compile(r";\$(FILEVERSION|COLUMNS)=\s*([\w.,]+)", re.IGNORECASE)
TIME = re.compile(r"\d+(?:\.\d+)?")
DATA_TYPES = ("DT", "RX", "TX", "RR")
FD_TYPES = ("FD", "FB", "FE", "BI")
SWITCHED = ("FB", "FE")
OTHER_TYPES = ("ST", "EC", "EV", "WARNG", "ERROR", "NT")
NO_FRAME = "FFFFFFFF"     # the identifier of a line of version 1.0 about the bus
REMOTE = "RTR"


def read_trc(path: Path) -> Recorded:
    """All frames; FaultyLog names the line of one that cannot be understood."""
    return frames_of_lines(path, _Lines().frame_of)


class _Lines:
    """Goes through the lines; the header states the columns."""

    def __init__(self) -> None:
        self._columns = COLUMNS["1.0"]

    def frame_of(self, number: int, line: str) -> LoggedFrame | None:
        """The frame of a line; None for a comment or another event."""
        if head := HEAD.match(line.strip()):
            self._head(number, head[1].upper(), head[2])
        parts = line.split()
        if not parts or parts[0].startswith(";"):
            return None
        values = dict(zip(self._columns, parts, strict=False))
        kind = values.get("T", "DT").upper()
        if kind in OTHER_TYPES or values.get("I") == NO_FRAME:
            return None
        if len(values) < len(self._columns) - 1:
            fail(number, "is cut off")
        if not TIME.fullmatch(values["O"]):
            fail(number, f"{values['O'][:40]!r} is not a time")
        time_s = float(values["O"]) / 1000.0
        channel = whole_in(number, values.get("B", "1"), "a bus", 255)
        if kind == "ER":
            return LoggedFrame(f"line {number}", time_s, channel, error=True)
        if kind not in (*DATA_TYPES, *FD_TYPES):
            fail(number, f"{kind[:40]!r} is not a type of a frame")
        return self._frame(number, time_s, channel, values, parts[self._columns.index("D"):], kind)

    def _head(self, number: int, key: str, value: str) -> None:
        columns = COLUMNS.get(value) if key == "FILEVERSION" else value.replace(",", "")
        if columns is None:
            fail(number, f"version {value} is not known (known are {', '.join(COLUMNS)})")
        if not ({"O", "I", "D"} <= set(columns) and {"L", "l"} & set(columns) and columns.endswith("D")):
            fail(number, "lacks a column that a frame needs (O, I, L or l, and D at the end)")
        self._columns = columns

    def _frame(self, number: int, time_s: float, channel: int, values: dict[str, str], rest: list[str],
               kind: str) -> LoggedFrame:
        identifier = identifier_of(number, values["I"])
        extended = len(values["I"]) > 4 or identifier > STANDARD
        fd, place = kind in FD_TYPES, f"line {number}"
        sent = values.get("d", kind).upper() == "TX"
        code = whole_in(number, values.get("l", values.get("L", "")), "a length", 64)
        length = code if "l" in values else FD_LENGTHS[min(code, 15)] if fd else min(code, 8)
        if kind == "RR" or (rest and rest[0].upper() == REMOTE):
            return LoggedFrame(place, time_s, channel, identifier, extended=extended, remote=True, sent=sent,
                               length=length)
        data = bytes_in(number, rest, length)
        return LoggedFrame(place, time_s, channel, identifier, data, extended=extended, fd=fd, sent=sent,
                           switched=kind in SWITCHED)
