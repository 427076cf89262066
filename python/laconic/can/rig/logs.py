"""Logs of everything on the bus, complete up to the last frame: BLF, ASC or another format of python-can."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Protocol

import can

from laconic.base.outputs import make_folder
from laconic.base.text_file import text_of_file
from laconic.can.rig.link import Clock
from laconic.errors import BadInput, reason_of
from laconic.robot.logs.formats.blf_log import header_of
from laconic.robot.logs.formats.can_frames import LoggedFrame, needs_of, read_frames


class Heard(Protocol):
    """A place where frames pass: a link to a node, or the bus of a controller."""

    clock: Clock
    listeners: list[Callable[[can.Message], None]]


Lost = dict[Path, BadInput]
"""Why a log is not whole."""


@contextmanager
def logged(link: Heard, paths: tuple[Path, ...], lost: Lost | None = None) -> Iterator[None]:
    """Writes every frame that is sent or received; the files are closed even when the run dies. With `lost` the run
    goes on without a log that takes no more bytes, and the reason is there."""
    with ExitStack() as open_logs:
        for path in paths:
            writer = open_logs.enter_context(closed(path, open_log(path), lost))
            link.listeners.append(stamped(path, writer, link, lost))
        yield


@contextmanager
def writable(path: Path, lost: Lost | None = None) -> Iterator[None]:
    """BadInput, raised or in `lost`, that names the log where the system does not take its bytes, as on a full disk."""
    try:
        yield
    except OSError as error:
        refused = BadInput(f"--log {path}: cannot be written ({reason_of(error)}); choose another path")
        if lost is None:
            raise refused from None
        lost.setdefault(path, refused)


@contextmanager
def closed(path: Path, writer: can.io.generic.MessageWriter,
           lost: Lost | None = None) -> Iterator[can.io.generic.MessageWriter]:
    """A log that is complete at the end of the context."""
    try:
        yield writer
    finally:
        with writable(path, lost):
            writer.stop()


@contextmanager
def read_by_someone(path: Path) -> Iterator[None]:
    """BadInput for a pipe that no program reads: to open it would wait for one, through the first Ctrl-C."""
    if not path.is_fifo():
        yield
        return
    try:
        end = os.open(path, os.O_WRONLY | os.O_NONBLOCK)
    except OSError:
        raise BadInput(f"--log {path}: is a pipe that no program reads; start the one that does before") from None
    try:
        yield
    finally:
        os.close(end)


def open_log(path: Path) -> can.io.generic.MessageWriter:
    """A python-can log writer for this name."""
    needs_of(path)
    try:
        with writable(path), read_by_someone(path):
            make_folder(path.parent)
            return can.Logger(str(path))
    except ValueError:
        raise BadInput(f"--log {path}: no log has this ending; use a name that ends in .blf or .asc") from None


def stamped(path: Path, writer: can.io.generic.MessageWriter, link: Heard,
            lost: Lost | None = None) -> Callable[[can.Message], None]:
    """Stamps frames with the link's time: those sent, and those of a virtual clock, contain none. The calendar is asked
    once, so that a clock that is set during the run leaves no gap."""
    calendar_s = link.clock.calendar_s()

    def write(message: can.Message) -> None:
        if lost and path in lost:
            return
        is_received = message.timestamp > 0.0
        stamp = message.__copy__()
        stamp.timestamp = calendar_s + link.clock.now_us() / 1e6
        stamp.is_rx = is_received
        stamp.channel = 1
        with writable(path, lost):
            writer(stamp)

    return write


def read_log(path: Path) -> list[LoggedFrame]:
    """All frames of a log; BadInput for one that is broken or cut off."""
    return read_frames(path).frames


def was_closed(path: Path) -> bool:
    """Whether the program that wrote a log has closed it: one that was killed leaves out frames."""
    if path.suffix.lower() == ".blf":
        data = path.read_bytes()
        return header_of(data).file_size >= len(data)
    if path.suffix.lower() != ".asc":
        return True
    lines = [line.strip().lower() for line in text_of_file(path, "a log").lines if line.strip()]
    return not any(line.startswith("begin triggerblock") for line in lines) or lines[-1] == "end triggerblock"
