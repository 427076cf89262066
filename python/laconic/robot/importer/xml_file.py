"""The XML of a robot's file, in the encoding that its first line names, as XML parsers read it."""

from __future__ import annotations

import stat
from pathlib import Path
from xml.etree import ElementTree

from laconic.errors import BadInput, reason_of
from laconic.robot.importer.checked import words_of

Element = ElementTree.Element
MOST_BYTES = 64 * 2**20  # of a file: a thousand times a usual robot


def xml_root(path: Path, why_not: str) -> Element:
    """The outermost element; BadInput begins with `why_not` for a file that is no XML."""
    return root_of(path, bytes_of(path), why_not)


def bytes_of(path: Path) -> bytes:
    """All of a file; BadInput for a folder, a device or a pipe, which have no end, and for one beyond all robots."""
    try:
        found = path.stat()
        if not stat.S_ISREG(found.st_mode):
            what = "is a directory" if stat.S_ISDIR(found.st_mode) else "is no regular file"
            raise BadInput(f"{path}: {what}; give the file of a robot")
        if found.st_size > MOST_BYTES:
            raise BadInput(f"{path}: has {found.st_size / 2**20:.0f} MiB, more than the {MOST_BYTES / 2**20:g} that "
                           "are read; give the file of a robot, with its meshes in files of their own")
        return path.read_bytes()
    except OSError as error:
        raise BadInput(f"{path}: {reason_of(error)}") from None


def root_of(path: Path, text: bytes | str, why_not: str) -> Element:
    """The same of a text that is there."""
    try:
        return ElementTree.fromstring(text)
    except (ElementTree.ParseError, LookupError, ValueError) as error:  # the last two: of encodings
        if isinstance(text, bytes) and _lacks_encoding(text):
            raise BadInput(f"{path}: is no text in UTF-8, and its first line names no other encoding; save it as "
                           'UTF-8, or begin it with <?xml version="1.0" encoding="ISO-8859-1"?>') from None
        raise BadInput(f"{path}: {why_not}: {words_of(error)}") from None


def _lacks_encoding(text: bytes) -> bool:
    """XML by its beginning, not in UTF-8, without a word of what else it is in."""
    try:
        text.decode("utf-8")
    except UnicodeDecodeError:
        return text.lstrip().startswith(b"<") and b"encoding" not in text[:100]
    return False
