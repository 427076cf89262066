"""What libraries such as Cyclone DDS and Zenoh print on stderr, as lines of this program: limited and counted.

Cyclone DDS gives programs no way to take its log. So descriptor 2 goes to a file while the command runs, and Python's
own stderr keeps the terminal.
"""

from __future__ import annotations

import os
import re
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

HEAD = re.compile(r"^[\d.]+ \[\S*\]\s+\S+?: |^\d{4}-\d\d-\d\dT\S+\s+")  # time, domain and thread; or time
OF_ONE = re.compile(r"\b[0-9a-f]+(:[0-9a-f]+)+\b|#?\b\d+\b")             # GUIDs and numbers, which differ line by line
UNREADABLE = re.compile(r"deserialization r[tq](\S+?)/(\w+(?:::\w+)+) failed")
LONGEST = 160  # letters of a line that are shown
OF_KIND = 5    # words that say what happened; then come bytes and states of one message
MOST_BYTES = 2**20  # that are read at once


class LibraryLines:
    """Lines since the last look, from a file that libraries write to."""

    def __init__(self, path: Path):
        self.path = path

    def take(self) -> list[str]:
        """Those that have come, without their heads."""
        with suppress(OSError), self.path.open("r+b") as file:
            found = file.read(MOST_BYTES)
            if found:
                file.truncate(0)  # writers append
            return [HEAD.sub("", line).strip()[:LONGEST] for line in found.decode(errors="replace").splitlines()
                    if line.strip()]
        return []


def kind_of(line: str) -> str:
    """The same for lines that differ by numbers, addresses and what follows the first words."""
    return " ".join(OF_ONE.sub("…", line).split()[:OF_KIND])


def unreadable_of(line: str) -> tuple[str, str] | None:
    """Topic, and type on the wire, of a line that says that a message could not be read."""
    found = UNREADABLE.search(line)
    return (found[1], found[2]) if found else None


@contextmanager
def library_lines(say: Callable[[str], None]) -> Iterator[LibraryLines | None]:
    """Takes what libraries print in this process until the end, and says what is left then; None: stderr is closed."""
    try:
        ours = os.dup(2)
    except OSError:
        yield None
        return
    handle, path = tempfile.mkstemp(prefix="laconic-", suffix=".log")
    os.close(handle)
    taken, before = LibraryLines(Path(path)), sys.stderr
    file = os.open(path, os.O_WRONLY | os.O_APPEND)
    own = os.fdopen(ours, "w", buffering=1, encoding="utf-8", errors="backslashreplace", closefd=False)
    try:
        os.dup2(file, 2)
        if before is sys.__stderr__:
            sys.stderr = own
        yield taken
    finally:
        sys.stderr = before
        os.dup2(ours, 2)
        own.close()
        for each in (ours, file):
            os.close(each)
        for line in dict.fromkeys(map(kind_of, taken.take())):
            say(line)
        taken.path.unlink()
