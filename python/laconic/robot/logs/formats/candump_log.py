"""Reads the logs of candump: those of `candump -l`, and what it prints with the time since 1970.

    (1764329083.000000) can0 101#B7B91A3DB7B91A3D
    (1764329083.000000)  can0  101   [8]  B7 B9 1A 3D B7 B9 1A 3D
"""

from __future__ import annotations

import re
from pathlib import Path

from laconic.robot.logs.formats.can_frames import (
    STANDARD,
    LoggedFrame,
    Recorded,
    bytes_in,
    fail,
    frames_of_lines,
    identifier_of,
    whole_in,
)

ERROR_FLAG, REMOTE_FLAG = 0x20000000, 0x40000000
BIT_RATE_SWITCH = 1
LINE = re.compile(r"\s*\((\d+(?:\.\d+)?)\)\s+(\S+)(?:\s+(.*?))?\s*")
COMPACT = re.compile(r"([0-9A-Fa-f]+)(##?)(\S*)(?:\s+([RT]))?")
PRINTED = re.compile(r"(?:([RT]X)\s+\S+\s+)?([0-9A-Fa-f]+)\s+\[(\d+)\]\s*(.*)")
MOST_CLASSIC, MOST_FD = 8, 64


def is_candump(beginning: str) -> bool:
    """Whether a text begins as a log of candump does."""
    first = next((line for line in beginning.splitlines() if line.strip()), "")
    found = LINE.fullmatch(first)
    return bool(found and (COMPACT.match(found[3] or "") or PRINTED.match(found[3] or "")))


def read_candump(path: Path) -> Recorded:
    """All frames; FaultyLog names the line of one that cannot be understood."""
    return frames_of_lines(path, frame_of)


def frame_of(number: int, line: str) -> LoggedFrame | None:
    """The frame of a line; None for a blank one."""
    if not line.strip() or line.lstrip().startswith("#"):
        return None
    found = LINE.fullmatch(line)
    if found is None:
        fail(number, "begins with no time such as (1764329083.000000); record with candump -l")
    time_s, channel, frame = float(found[1]), found[2], found[3] or ""
    if compact := COMPACT.fullmatch(frame):
        return _compact(number, time_s, channel, compact)
    printed = PRINTED.fullmatch(frame)
    if printed is None:
        fail(number, f"{frame[:60]!r} is not a frame of candump")
    return _printed(number, time_s, channel, printed)


def _identifier(number: int, text: str) -> tuple[int, bool, bool]:
    """(identifier, whether it has 29 bits, whether it is of an error frame); 8 digits mean 29 bits."""
    if len(text) > 8:
        fail(number, f"{text[:40]!r} is not an identifier of a CAN frame")
    value = int(text, 16)
    is_error = len(text) == 8 and bool(value & ERROR_FLAG)
    value &= ~ERROR_FLAG if len(text) == 8 else ~0
    return identifier_of(number, f"{value:X}"), len(text) > 3 or value > STANDARD, is_error


def _compact(number: int, time_s: float, channel: str, found: re.Match[str]) -> LoggedFrame:
    """identifier#bytes, identifier##flags and bytes, or identifier#R and length."""
    identifier, extended, error = _identifier(number, found[1])
    place, text, fd = f"line {number}", found[3], found[2] == "##"
    sent = found[4] == "T"
    if fd:
        flags = whole_in(number, text[:1], "the flags of a CAN FD frame", 15, 16)
        data = _bytes(number, text[1:], MOST_FD)
        return LoggedFrame(place, time_s, channel, identifier, data, extended=extended, fd=True, sent=sent,
                           switched=bool(flags & BIT_RATE_SWITCH))
    text = text.partition("_")[0]  # a raw length code may follow
    if text[:1].upper() == "R":
        length = whole_in(number, text[1:], "a length", 15, 16) if text[1:] else 0
        return LoggedFrame(place, time_s, channel, identifier, extended=extended, remote=True, sent=sent,
                           length=length)
    data = _bytes(number, text, MOST_CLASSIC)
    return LoggedFrame(place, time_s, channel, identifier, data, extended=extended, error=error, sent=sent)


def _bytes(number: int, text: str, most: int) -> bytes:
    digits = text.replace(".", "")
    if len(digits) % 2:
        fail(number, f"has half a byte at its end ({text[:40]!r})")
    if len(digits) > 2 * most:
        fail(number, f"has {len(digits) // 2} bytes, at most {most}")
    return bytes_in(number, [digits[at:at + 2] for at in range(0, len(digits), 2)], len(digits) // 2)


def _printed(number: int, time_s: float, channel: str, found: re.Match[str]) -> LoggedFrame:
    """identifier [length] bytes, as candump prints it."""
    identifier, extended, error = _identifier(number, found[2])
    length = whole_in(number, found[3], "a length", MOST_FD)
    place, sent = f"line {number}", found[1] == "TX"
    rest = found[4].split()
    if rest and rest[0].lower() == "remote":
        return LoggedFrame(place, time_s, channel, identifier, extended=extended, remote=True, sent=sent,
                           length=length)
    is_error = error or "ERRORFRAME" in rest
    data = bytes_in(number, rest, length)
    return LoggedFrame(place, time_s, channel, identifier, data, extended=extended, error=is_error, sent=sent,
                       fd=length > MOST_CLASSIC)
