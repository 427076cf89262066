"""Reads CAN logs that somebody else recorded, whatever program wrote them: each frame with its channel and its place.

ASC, BLF, candump's and PCAN's TRC are read here, others by python-can. The reader is chosen by the file's ending, then
by its beginning.
"""

from __future__ import annotations

import gc
import importlib.util
import logging
import re
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

import can

from laconic.base.text_file import TextOfFile, beginning_of, text_of_file
from laconic.errors import BadInput, reason_of

CAN_ENDINGS = (".asc", ".blf", ".log", ".trc", ".mf4")
WANTED = "a CAN log: .asc, .blf, .log of candump, .trc, or .mf4"
MF4 = (".mf4", ".mdf")
STANDARD, EXTENDED = 0x7FF, 0x1FFFFFFF   # largest identifiers of 11 and of 29 bits
FD_LENGTHS = (0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64)  # by the data length code


PAIRS = re.compile(r"[0-9A-Fa-f]*")


class LoggedFrame(can.Message):
    """A frame of a log; `place` names where it is in the file, for messages."""

    __slots__ = ("place",)

    def __init__(self, place: str, timestamp: float, channel: int | str | None, identifier: int = 0,
                 data: bytes | bytearray = b"", *, extended: bool = False, remote: bool = False, error: bool = False,
                 fd: bool = False, sent: bool = False, switched: bool = False, length: int | None = None):
        super().__init__(timestamp=timestamp, arbitration_id=identifier, is_extended_id=extended,
                         is_remote_frame=remote, is_error_frame=error, channel=channel, data=data or None,
                         dlc=len(data) if length is None else length, is_fd=fd, is_rx=not sent,
                         bitrate_switch=switched)
        self.place = place


@dataclass(frozen=True)
class Recorded:
    """All frames of a log in its order, and what was left out of it."""

    frames: list[LoggedFrame]
    remarks: tuple[str, ...] = ()


class FaultyLog(Exception):
    """What is wrong with a log; its words begin with the place."""


def read_frames(path: Path) -> Recorded:
    """All frames of a log; BadInput names the file, the place in it and its fault."""
    reader = _reader_of(path)
    try:
        return reader(path)
    except FaultyLog as fault:
        raise BadInput(f"{path}: {fault}") from None


def _reader_of(path: Path) -> Callable[[Path], Recorded]:
    from laconic.robot.logs.formats.asc_log import read_asc
    from laconic.robot.logs.formats.blf_log import is_blf, read_blf
    from laconic.robot.logs.formats.candump_log import is_candump, read_candump
    from laconic.robot.logs.formats.trc_log import read_trc

    by_ending = {".asc": read_asc, ".blf": read_blf, ".log": read_candump, ".trc": read_trc}
    ending = Path(path.name.lower().removesuffix(".gz")).suffix
    if ending in by_ending:
        return by_ending[ending]
    if is_blf(path):
        return read_blf
    if is_candump(beginning_of(path)):
        return read_candump
    return _by_library


def frames_of_lines(path: Path, frame_of: Callable[[int, str], LoggedFrame | None]) -> Recorded:
    """The frames of a text log; `frame_of` makes one of a line and its number, or none of a line that has none."""
    text = text_of_file(path, WANTED)
    lines = text.lines[:-1] if text.is_cut else text.lines
    frames = [frame for number, line in enumerate(lines, start=1) if (frame := frame_of(number, line)) is not None]
    return Recorded(frames, remarks_of(text))


def remarks_of(text: TextOfFile) -> tuple[str, ...]:
    """What was left out of a text file."""
    remark = text.remark()
    return () if remark is None else (remark,)


# ------------------------------------------------------------------------------- parts of a line


def fail(number: int, why: str) -> NoReturn:
    """Raises FaultyLog for a line."""
    raise FaultyLog(f"line {number}: {why}; remove the line or repair it")


def identifier_of(number: int, text: str, base: int = 16) -> int:
    """The identifier of a frame."""
    try:
        found = int(text, base) if re.fullmatch(r"[0-9A-Fa-f]+", text) else -1
    except ValueError:
        found = -1
    if not 0 <= found <= EXTENDED:
        fail(number, f"{text[:40]!r} is not an identifier of a CAN frame")
    return found


def bytes_in(number: int, texts: Sequence[str], count: int, base: int = 16) -> bytes:
    """So many bytes at the beginning of some texts."""
    if len(texts) < count:
        fail(number, f"has {len(texts)} of the frame's {count} bytes")
    digits = "".join(texts[:count])
    if base == 16 and len(digits) == 2 * count and PAIRS.fullmatch(digits) and all(
            len(text) == 2 for text in texts[:count]):
        return bytes.fromhex(digits)
    try:
        values = [int(text, base) if text.isalnum() else 256 for text in texts[:count]]
        return bytes(values)
    except ValueError:
        fail(number, f"its bytes {' '.join(texts[:count])[:60]!r} cannot be understood")


def whole_in(number: int, text: str, what: str, most: int, base: int = 10) -> int:
    """A whole number from 0 on."""
    try:
        found = int(text, base) if text.isalnum() else -1
    except ValueError:
        found = -1
    if not 0 <= found <= most:
        fail(number, f"{text[:40]!r} is not {what}")
    return found


# -------------------------------------------------------------------- formats of python-can alone


class Doubts(logging.Handler):
    """Raises where a reader would leave out frames and only write a warning to its own log."""

    def emit(self, record: logging.LogRecord) -> None:
        """Raises the warning as an error."""
        raise ValueError(record.getMessage())


@contextmanager
def doubts_are_errors() -> Iterator[None]:
    """Every warning of python-can in this context is an error."""
    logger, handler = logging.getLogger("can"), Doubts(logging.WARNING)
    propagate, logger.propagate = logger.propagate, False
    logger.addHandler(handler)
    try:
        yield
    finally:
        logger.removeHandler(handler)
        logger.propagate = propagate


def needs_of(path: Path) -> None:
    """ModuleNotFoundError for a format whose package is not installed: python-can would only refuse the file."""
    if path.suffix.lower() in MF4 and importlib.util.find_spec("asammdf") is None:
        raise ModuleNotFoundError("no asammdf", name="asammdf")


def _by_library(path: Path) -> Recorded:
    """A log of another kind that python-can reads."""
    frames: list[LoggedFrame] = []
    needs_of(path)
    fault = ""
    with silent_ends():
        try:
            with doubts_are_errors(), can.LogReader(str(path)) as reader:
                for number, each in enumerate(reader, start=1):
                    channel = each.channel if isinstance(each.channel, int) else str(each.channel or "")
                    frames.append(LoggedFrame(
                        f"frame {number}", each.timestamp, channel, each.arbitration_id, bytes(each.data or b""),
                        extended=each.is_extended_id, remote=each.is_remote_frame, error=each.is_error_frame,
                        fd=each.is_fd, sent=not each.is_rx, switched=each.bitrate_switch, length=each.dlc))
        except OSError as error:
            fault = f"cannot be read ({reason_of(error)})"
        except Exception:  # a parser may raise any exception on unexpected bytes
            after = f"after frame {len(frames)}" if frames else "from its beginning"
            fault = f"cannot be understood as a CAN log {after}"
    if fault:
        raise BadInput(f"{path}: {fault}; give {WANTED}")
    return Recorded(frames)


@contextmanager
def silent_ends() -> Iterator[None]:
    """Objects of a reader that failed half way die within this context: their complaints are about nothing else."""
    before, sys.unraisablehook = sys.unraisablehook, lambda _: None
    try:
        yield
        gc.collect()
    finally:
        sys.unraisablehook = before
