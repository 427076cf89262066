"""What can go wrong, as two kinds: input that cannot be used (exit status 2) and results that fail (exit status 1)."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class LaconicError(Exception):
    """One line for the user; `exit_status` is the command's."""

    exit_status = 1

    def __str__(self) -> str:
        return " ".join(super().__str__().split())


class ResultFails(LaconicError):
    """The run was done and its result is not good enough."""


class BadInput(LaconicError):
    """Something the user gave cannot be used: the message names the file, the field and the remedy."""

    exit_status = 2


class Refused(BadInput):
    """The core refused: with its status, the field and item (wheel, component; from 1), and its message."""

    def __init__(self, status: str, field: str, item: int, message: str, *, value: float = 0.0, limit: float = 0.0):
        super().__init__(message)
        self.status, self.field, self.item, self.message = status, field, item, message
        self.value, self.limit = value, limit

    def at(self, location: object) -> Refused:
        """The same refusal with the file it comes from in front."""
        text = f"{location}: {self.message}"
        return Refused(self.status, self.field, self.item, text, value=self.value, limit=self.limit)


def nearest_of(word: str, known: Iterable[str], instead: str | None = None) -> str:
    """The remedy for a word that is not known: "did you mean …?", what to do instead, or the list of known ones."""
    names = sorted(known)
    close = difflib.get_close_matches(word, names, n=1, cutoff=0.8 if instead else 0.6)
    return f"did you mean {close[0]}?" if close else instead or f"known are {', '.join(names)}"


def reason_of(error: OSError) -> str:
    """Why a file could not be read or written, in the system's words."""
    return (error.strerror or str(error)).lower()
