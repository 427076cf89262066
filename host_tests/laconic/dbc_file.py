"""Reads a DBC file that somebody else wrote."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import cantools
from cantools.database.can import Database

from laconic.errors import BadInput, reason_of, words_of


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


def load_dbc(path: Path, said: str) -> Database:
    """The database. BadInput for a file that is none; `said` begins its message: the option or key, with the path."""
    try:
        with without_warnings():
            found = cantools.database.load_file(path)
    except OSError as error:
        raise BadInput(f"{said} cannot be read ({reason_of(error)}); give a DBC file") from None
    except Exception as error:  # a parser may raise any exception on unexpected text
        raise BadInput(f"{said} is no DBC file ({words_of(error, 'its parser gives no reason')}); give one") from None
    if not isinstance(found, Database):
        raise BadInput(f"{said} describes no CAN frames; give a DBC file")
    return found
