"""What can go wrong, as two kinds: input that cannot be used (exit status 2) and results that fail (exit status 1)."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import Any

LONGEST_SHOWN = 60   # of a value, or of a name of the user's, in a message
LONGEST_WORD = 100   # of a message, if it is no name of a file
LONGEST_NAME = 255   # of a file or folder
LONGEST_PATH = 1000
LONGEST_LINE = 2000  # a message as a whole


class LaconicError(Exception):
    """One line for the user; `exit_status` is the command's."""

    exit_status = 1

    def __reduce__(self) -> tuple[Any, ...]:
        """Copies and unpickles without the constructor, whose arguments each class chooses for itself."""
        return _remade, (type(self), self.args, self.__dict__.copy())

    def __str__(self) -> str:
        return bounded_line(super().__str__())


def _remade(kind: type[LaconicError], arguments: tuple[Any, ...], attributes: dict[str, Any]) -> LaconicError:
    """An error with the message and attributes of another one, possibly of another process."""
    made = kind.__new__(kind, *arguments)
    made.__dict__.update(attributes)
    return made


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


def shown(value: Any) -> str:
    """A value in a message: as Python writes it, cut where it is long."""
    try:
        is_cut = type(value) in (str, bytes, bytearray, list, tuple)
        text = repr(value[:LONGEST_SHOWN + 1] if is_cut else value)
    except Exception:  # a number of thousands of digits inside, a list in itself, another's faulty class
        text = "<>"
        if isinstance(value, int):
            return f"a whole number of about {int(value.bit_length() * math.log10(2)) + 1} digits"
    is_no_value = text == "<>" or re.match(r"<.* at 0x", text)
    return f"an object of type {type(value).__name__}" if is_no_value else cut(text)


def cut(text: str, longest: int = LONGEST_SHOWN) -> str:
    """A text, or its beginning where it is long."""
    return text if len(text) <= longest else f"{text[:longest]}…"


def bounded_line(message: str) -> str:
    """A message in one line, however long the names are that it holds."""
    line = re.sub(rf"\S{{{LONGEST_WORD + 1},}}", _bounded_word, " ".join(message.split()))
    return line if len(line) <= LONGEST_LINE else f"{line[:3 * LONGEST_LINE // 4]} … {line[-LONGEST_LINE // 8:]}"


def _bounded_word(found: re.Match[str]) -> str:
    """The beginning of a long word; names of files stay whole, as the user must find them."""
    word, end = found[0], re.search(r"\W{0,2}$", found[0])
    name = word[:end.start()] if end else word
    if "/" in word or "\\" in word:
        return cut(re.sub(rf"[^/\\]{{{LONGEST_NAME + 1},}}", lambda part: cut(part[0]), word), LONGEST_PATH)
    with suppress(OSError, ValueError):
        if len(name) <= LONGEST_NAME and Path(name).exists():
            return word
    return cut(name) + word[len(name):]


def words_of(error: BaseException, otherwise: str) -> str:
    """What a library says of its failure, without the number of a system error; `otherwise` where it says nothing."""
    if isinstance(error, OSError) and error.strerror:
        return reason_of(error)
    return " ".join(str(error).split()).rstrip(".") or otherwise


def nearest_of(word: str, known: Iterable[str], instead: str | None = None) -> str:
    """The remedy for a word that is not known: "did you mean …?", what to do instead, or the list of known ones."""
    from difflib import get_close_matches  # not in the start of every command

    names, word = sorted(known), word[:LONGEST_NAME]
    close = get_close_matches(word, names, n=1, cutoff=0.8 if instead else 0.6)
    return f"did you mean {close[0]}?" if close else instead or f"known are {', '.join(names)}"


def reason_of(error: OSError) -> str:
    """Why a file could not be read or written, in the system's words."""
    return (error.strerror or str(error)).lower()
