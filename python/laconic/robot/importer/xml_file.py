"""The XML of a robot's file, in the encoding that its first line names, as XML parsers read it.

Elements of which a robot's file may have one at a place: of two a reader would take either and drop the other.
"""

from __future__ import annotations

import re
import stat
from collections import Counter
from pathlib import Path
from xml.etree import ElementTree
from xml.parsers import expat

from laconic.errors import BadInput, reason_of

Element = ElementTree.Element
MOST_BYTES = 64 * 2**20  # of a file: a thousand times a usual robot
MOST_TAGS = 1_000_000  # that open or close an element
COMMENT = re.compile(rb"<!--.*?-->", re.DOTALL)
DECLARATION = re.compile(rb"<\?xml\b[^>]*\?>")


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
    """The same of a text that is there. Prefixes stay parts of names, since many files use some that they do not
    declare."""
    if (tags := text.count(b"<") if isinstance(text, bytes) else text.count("<")) > MOST_TAGS:
        raise BadInput(f"{path}: has {tags} tags, more than the {MOST_TAGS} that are read; give the file of a robot")
    try:
        try:
            return _parsed(text)
        except expat.ExpatError:
            if (mended := _mended(text)) == text:
                raise
            return _parsed(mended)
    except expat.ExpatError as error:
        if isinstance(text, bytes) and _lacks_encoding(text):
            raise BadInput(f"{path}: is no text in UTF-8, and its first line names no other encoding; save it as "
                           'UTF-8, or begin it with <?xml version="1.0" encoding="ISO-8859-1"?>') from None
        raise BadInput(f"{path}: {why_not}: {_where(error)}") from None
    except (LookupError, ValueError):
        raise BadInput(f"{path}: {why_not}: unknown encoding in its first line; save it as UTF-8") from None


def _parsed(text: bytes | str) -> Element:
    builder = ElementTree.TreeBuilder()
    parser = expat.ParserCreate()
    parser.buffer_text = True
    parser.StartElementHandler = builder.start
    parser.EndElementHandler = builder.end
    parser.CharacterDataHandler = builder.data
    parser.Parse(text, True)
    root: Element = builder.close()
    return root


def _mended(text: bytes | str) -> bytes | str:
    """Without comments, and with its first line first: simulators read files that have -- in comments, or comments
    ahead of the first line. Lines keep their numbers."""
    if isinstance(text, str):
        return _mended(text.encode("utf-8")).decode("utf-8")  # type: ignore[union-attr]  # bytes give bytes
    blank = COMMENT.sub(lambda found: b"\n" * found[0].count(b"\n"), text)
    first = DECLARATION.search(blank)
    if first is None or blank[: first.start()].strip():
        return blank
    return first[0] + blank[: first.start()] + blank[first.end():]


PLACED = "line {0}, column {1}"
FAULTS = {  # by names of expat's errors
    "XML_ERROR_NO_ELEMENTS": "it has no element",
    "XML_ERROR_TAG_MISMATCH": f"{PLACED}: the element that is closed is not the one that was opened last",
    "XML_ERROR_DUPLICATE_ATTRIBUTE": f"{PLACED}: an attribute is given twice",
    "XML_ERROR_JUNK_AFTER_DOC_ELEMENT": f"{PLACED}: something follows the end of the outermost element",
    "XML_ERROR_UNCLOSED_TOKEN": f"{PLACED}: a tag is not closed",
    "XML_ERROR_UNDEFINED_ENTITY": f"{PLACED}: an entity (&…;) that is not defined",
    "XML_ERROR_UNKNOWN_ENCODING": "unknown encoding in its first line; save it as UTF-8",
    "XML_ERROR_INCORRECT_ENCODING": f"{PLACED}: it is not in the encoding that its first line names",
    "XML_ERROR_AMPLIFICATION_LIMIT_BREACH": "its entities stand for far more text than it has"}


def _where(error: expat.ExpatError) -> str:
    """What is wrong, and where."""
    codes = {name: getattr(expat.errors, name, None) for name in FAULTS}
    texts = {expat.errors.codes[text]: FAULTS[name] for name, text in codes.items() if text in expat.errors.codes}
    return texts.get(error.code, f"{PLACED}: no well-formed XML").format(error.lineno, error.offset + 1)


def _lacks_encoding(text: bytes) -> bool:
    """XML by its beginning, not in UTF-8, without a word of what else it is in."""
    try:
        text.decode("utf-8")
    except UnicodeDecodeError:
        return text.lstrip().startswith(b"<") and b"encoding" not in text[:100]
    return False


SHAPES = ("box", "cylinder", "capsule", "sphere", "mesh")  # of one <geometry>
ONCE = frozenset({"inertial", "mass", "inertia", "origin", "pose", "geometry", "parent", "child", "axis", "xyz",
                  "limit", "dynamics", "damping", "friction", "mimic", "lower", "upper", "radius", "length", "size",
                  "ixx", "ixy", "ixz", "iyy", "iyz", "izz", *SHAPES})


FOREIGN = ("gazebo", "sensor", "plugin", "visual")  # what others read, or what is left out where it is doubled


def refuse_doubled(path: Path, part: Element) -> None:
    """BadInput with the name of a link or joint in which one of these stands twice."""
    if doubled := what_is_doubled(part):
        raise BadInput(f"{path}: {part.tag} {part.get('name', '')}: {doubled}")


def what_is_doubled(part: Element) -> str:
    """What stands twice in an element, and what to do; empty where nothing does."""
    waiting = [part]
    while waiting:
        element = waiting.pop()
        tags = Counter(child.tag for child in element)
        for tag, count in tags.items():
            if count > 1 and tag in ONCE:
                return f"<{element.tag}> has {count} <{tag}>; keep the one that holds"
        shapes = [tag for tag in tags if tag in SHAPES] if element.tag == "geometry" else []
        if len(shapes) > 1:
            return (f"one <geometry> has <{shapes[0]}> and <{shapes[1]}>; give each shape a <collision> or <visual> of "
                    "its own")
        waiting += [child for child in element if child.tag not in FOREIGN]
    return ""
