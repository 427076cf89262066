"""Logs of everything on the bus, complete up to the last frame: BLF, ASC or what else python-can writes."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import can

from laconic.errors import BadInput, reason_of
from laconic.rig.link import Link

LOGS = (".blf", ".asc", ".log", ".trc")


@contextmanager
def logged(link: Link, paths: tuple[Path, ...]) -> Iterator[None]:
    """Writes every frame that is sent or received; the files are closed even when the run dies."""
    with ExitStack() as open_logs:
        for path in paths:
            writer = open_logs.enter_context(open_log(path))
            link.listeners.append(stamped(writer, link))
        yield


def open_log(path: Path) -> can.io.generic.MessageWriter:
    """A python-can log writer for this name."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        return can.Logger(str(path))
    except ValueError as error:
        raise BadInput(f"--log {path}: {error}; use a name that ends in .blf or .asc") from None
    except OSError as error:
        raise BadInput(f"--log {path}: cannot be written ({reason_of(error)}); choose another place") from None


def stamped(writer: can.io.generic.MessageWriter, link: Link) -> Callable[[can.Message], None]:
    """Gives frames that carry no time (those we send, those of a virtual clock) the link's."""

    def write(message: can.Message) -> None:
        is_received = message.timestamp > 0.0
        stamp = message.__copy__()
        stamp.timestamp = link.clock.now_us() / 1e6
        stamp.is_rx = is_received
        stamp.channel = 1
        writer(stamp)

    return write


def read_log(path: Path) -> list[can.Message]:
    """All frames of a log; BadInput for one that is broken or cut off."""
    try:
        with doubts_are_errors(), can.LogReader(str(path)) as reader:
            check_whole(path, reader)
            return list(reader)
    except OSError as error:
        raise BadInput(f"{path}: {reason_of(error)}; give a .blf or .asc file") from None
    except BadInput:
        raise
    except Exception as error:  # a parser that meets what it did not expect raises anything
        raise BadInput(f"{path}: cannot be read as a log ({str(error) or type(error).__name__}); give a .blf or .asc "
                       "file as it was written") from None


class Doubts(logging.Handler):
    """What a reader would only have written to its own log: it leaves frames out."""

    def emit(self, record: logging.LogRecord) -> None:
        """A doubt is an error."""
        raise ValueError(record.getMessage())


@contextmanager
def doubts_are_errors() -> Iterator[None]:
    """No warning of python-can is passed over in here."""
    logger, handler = logging.getLogger("can"), Doubts(logging.WARNING)
    propagate, logger.propagate = logger.propagate, False
    logger.addHandler(handler)
    try:
        yield
    finally:
        logger.removeHandler(handler)
        logger.propagate = propagate


def check_whole(path: Path, reader: can.io.generic.MessageReader) -> None:
    """python-can reads a cut-off BLF up to the cut and says nothing."""
    said, there = getattr(reader, "file_size", 0), path.stat().st_size
    if isinstance(reader, can.BLFReader) and there < said:
        raise BadInput(f"{path}: is cut off: {there} of {said} bytes are there; copy it again")


def was_closed(path: Path) -> bool:
    """Whether whoever wrote a log has come to its end: what was killed leaves frames out."""
    if path.suffix.lower() == ".blf":
        with can.BLFReader(path) as reader:
            return reader.file_size >= path.stat().st_size
    if path.suffix.lower() != ".asc":
        return True
    text = path.read_bytes().rstrip().lower()
    return b"begin triggerblock" not in text or text.endswith(b"end triggerblock")
