"""Reads ASC, the text log of Vector's tools: one event a line, of which CAN frames and error frames count.

    0.010000 1  101             Rx   d 8 B7 B9 1A 3D B7 B9 1A 3D
    0.020000 CANFD   1 Rx        101                                   1 0 9 12 00 …

A header line may be absent. With `timestamps relative` each time counts from the event before.
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

TIME = re.compile(r"\d+(?:[.,]\d+)?")
HEADER = re.compile(r"base\s+(hex|dec)(?:\s+timestamps\s+(absolute|relative))?", re.IGNORECASE)
DIRECTIONS = ("rx", "tx")
USUAL = ("Rx", "Tx")
DATA, REMOTE = "d", "r"
CLASSIC_BYTES = 8
MOST_CHANNELS = 255


def read_asc(path: Path) -> Recorded:
    """All frames; FaultyLog names the line of one that cannot be understood."""
    return frames_of_lines(path, _Lines().frame_of)


class _Lines:
    """Goes through the lines; the header's base and kind of times hold from its line on."""

    def __init__(self) -> None:
        self._base, self._is_relative, self._time_s = 16, False, 0.0

    def frame_of(self, number: int, line: str) -> LoggedFrame | None:
        """The frame of a line; None for one with another event or without any."""
        parts = line.split()
        if not parts or parts[0].startswith("//"):
            return None
        if header := HEADER.match(line.strip()):
            self._base = 16 if header[1].lower() == "hex" else 10
            self._is_relative = (header[2] or "").lower() == "relative"
            return None
        if not TIME.fullmatch(parts[0]):
            if _is_like_a_frame(parts):
                fail(number, f"{parts[0][:40]!r} is not a time")
            return None
        time_s = float(parts[0].replace(",", "."))
        self._time_s = self._time_s + time_s if self._is_relative else time_s
        return self._event(number, parts)

    def _event(self, number: int, parts: list[str]) -> LoggedFrame | None:
        kind = parts[1] if len(parts) > 1 else ""
        if len(parts) > 5 and parts[3] in USUAL and kind.isdecimal():
            return self._classic(number, parts)
        if kind.upper() == "CANFD":
            return self._fd(number, parts)
        if kind.isdecimal() and len(parts) > 2 and parts[2].lower() == "errorframe":
            return LoggedFrame(f"line {number}", self._time_s, self._channel(number, kind), error=True)
        if not _is_like_a_frame(parts):
            return None
        if not kind.isdecimal():
            fail(number, f"{kind[:40]!r} is not a channel")
        return self._classic(number, parts)

    def _channel(self, number: int, text: str) -> int:
        return whole_in(number, text, "a channel", MOST_CHANNELS)

    def _identifier(self, number: int, text: str) -> tuple[int, bool]:
        is_marked = text.lower().endswith("x")
        found = identifier_of(number, text[:-1] if is_marked else text, self._base)
        return found, is_marked or found > STANDARD

    def _classic(self, number: int, parts: list[str]) -> LoggedFrame:
        """time channel identifier direction d length bytes …"""
        channel, direction = self._channel(number, parts[1]), parts[3].lower()
        identifier, extended = self._identifier(number, parts[2])
        place, sent = f"line {number}", direction == "tx"
        if len(parts) < 5 or parts[4].lower() not in (DATA, REMOTE):
            fail(number, f"{(parts[4:] or [''])[0][:40]!r} is neither d nor r, for data or remote frames")
        if parts[4].lower() == REMOTE:
            length = whole_in(number, parts[5], "a length", 15, 16) if parts[5:] and len(parts[5]) == 1 else 0
            return LoggedFrame(place, self._time_s, channel, identifier, extended=extended, remote=True, sent=sent,
                               length=length)
        length = whole_in(number, (parts[5:] or [""])[0], "a length", 15, 16)
        data = bytes_in(number, parts[6:], min(length, CLASSIC_BYTES), self._base)
        return LoggedFrame(place, self._time_s, channel, identifier, data, extended=extended, sent=sent)

    def _fd(self, number: int, parts: list[str]) -> LoggedFrame:
        """time CANFD channel direction identifier [name] rate state code length bytes …"""
        if len(parts) < 5:
            fail(number, "is cut off")
        channel = self._channel(number, parts[2])
        if parts[4].lower() == "errorframe":
            return LoggedFrame(f"line {number}", self._time_s, channel, error=True, fd=True)
        if parts[3].lower() not in DIRECTIONS:
            fail(number, f"{parts[3][:40]!r} is neither Rx nor Tx")
        identifier, extended = self._identifier(number, parts[4])
        rest = parts[5:] if parts[5:] and parts[5] in ("0", "1") else parts[6:]
        if len(rest) < 4:
            fail(number, "is cut off")
        code = whole_in(number, rest[2], "a length", 15, 16)
        length = whole_in(number, rest[3], "a number of bytes", 64)
        is_remote = length == 0 and code > 0
        if not is_remote and FD_LENGTHS[code] != length:
            fail(number, f"states {length} bytes and the code of {FD_LENGTHS[code]}")
        data = bytes_in(number, rest[4:], length, self._base)
        return LoggedFrame(f"line {number}", self._time_s, channel, identifier, data, extended=extended, fd=True,
                           remote=is_remote, sent=parts[3].lower() == "tx", switched=rest[0] == "1",
                           length=FD_LENGTHS[code] if is_remote else None)


def _is_like_a_frame(parts: list[str]) -> bool:
    """Whether a line is a classic frame, perhaps with a fault: a direction, or what follows one, is in its place."""
    direction = len(parts) > 3 and parts[3].lower() in DIRECTIONS
    follows = len(parts) > 5 and parts[4].lower() in (DATA, REMOTE) and parts[5].isalnum() and len(parts[5]) == 1
    is_request = len(parts) > 3 and parts[3].lower() == "txrq"  # an order to send, no frame on the bus
    if is_request:
        return False
    return (direction and (parts[1].isdecimal() or follows)) or (follows and parts[1].isdecimal())
