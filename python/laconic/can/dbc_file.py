"""Reads a DBC file that somebody else wrote. Only messages that are used are judged: the rest may be faulty.

A map needs messages, signals, multiplexers, start values and the frame format. Everything else in the file is skipped,
as are statements about messages that it does not have.
"""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import cantools
from cantools.database.can import Database, Message

from laconic.base.text_file import text_of_file
from laconic.can.dbc_statements import MessageText, read_statements
from laconic.errors import BadInput, nearest_of

OTHER_FORMATS = (".arxml", ".kcd", ".sym", ".xls", ".xlsx")  # of the library that reads them
WANTED = "a DBC file"


@dataclass(frozen=True)
class DbcEntry:
    """One message of a DBC file; `c` is the library's message, whose fault is known before it is made."""

    name: str
    frame_id: int
    is_extended_frame: bool
    text: MessageText | None = None
    made: Message | None = None

    @cached_property
    def fault(self) -> str | None:
        """What is wrong with this message, with the line; None for a message that can be used."""
        return None if self.text is None else self.text.fault()

    @cached_property
    def c(self) -> Message:
        """The message with its signals, which has no fault."""
        if self.made is not None:
            return self.made
        assert self.text is not None and self.fault is None
        return self.text.message()


@dataclass(frozen=True)
class Dbc:
    """The messages of a DBC file; `said` begins its errors: the option or key, with the path."""

    said: str
    messages: list[DbcEntry] = field(default_factory=list)
    remarks: tuple[str, ...] = ()   # faults of the file that may hide a message

    def named(self, name: str, where: str) -> DbcEntry:
        """A message by its name; BadInput where there is none, or it has a fault. `where` names the map's key."""
        by_name = {each.name: each for each in self.messages}
        if name not in by_name:
            more = f" ({self.remarks[0]})" if self.remarks else ""
            raise BadInput(f"{where} has no message {name!r}{more}; {nearest_of(name, by_name)}")
        return by_name[name]

    def check(self, entry: DbcEntry) -> None:
        """BadInput for a message with a fault."""
        if entry.fault is not None:
            raise BadInput(f"{self.said} message {entry.name} has a fault: {entry.fault}; correct the DBC")


@contextmanager
def without_warnings() -> Iterator[None]:
    """cantools warns on stderr of messages with one name or identifier; who uses one of them is told by name."""
    logger = logging.getLogger("cantools")
    before = logger.level
    logger.setLevel(logging.ERROR)
    try:
        yield
    finally:
        logger.setLevel(before)


def load_dbc(path: Path, said: str) -> Dbc:
    """The messages of a file. BadInput for a file that has none; `said` begins its message."""
    if path.suffix.lower() in OTHER_FORMATS:
        return _by_library(path, said)
    text = text_of_file(path, WANTED, said, is_lenient=True)
    messages, remarks = read_statements(text.lines)
    if not messages:
        raise BadInput(f"{said} is no DBC file (it describes no message, BO_); give one")
    found = [DbcEntry(each.name, each.frame_id & 0x1FFFFFFF if each.is_extended else each.frame_id, each.is_extended,
                      text=each) for each in messages]
    return Dbc(said, found, remarks)


def _by_library(path: Path, said: str) -> Dbc:
    """A file of another format that the library knows."""
    text_of_file(path, WANTED, said, is_lenient=True)
    try:
        with without_warnings():
            found = cantools.database.load_file(path)
    except Exception:  # a parser may raise any exception on unexpected text
        raise BadInput(f"{said} cannot be understood as {path.suffix.lower()}; give {WANTED}") from None
    if not isinstance(found, Database):
        raise BadInput(f"{said} describes no CAN frames; give {WANTED}")
    return Dbc(said, [DbcEntry(each.name, each.frame_id, each.is_extended_frame, made=each)
                      for each in found.messages])
