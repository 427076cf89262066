"""Reads the text of a file that somebody else wrote: logs, maps and DBC files share this reader of encodings."""

from __future__ import annotations

import gzip
import re
import zlib
from dataclasses import dataclass
from pathlib import Path

from laconic.errors import BadInput, reason_of

GZIP = b"\x1f\x8b"
UTF_16 = (b"\xff\xfe", b"\xfe\xff")
MOST_BYTES = 2**31      # of a file, packed or not
LOOKED_AT = 4096        # bytes that show an encoding without a mark
ZEROS_OF_UTF_16 = 0.8   # share of zeros in every other byte of European text in UTF-16
LINE_END = re.compile(r"\r\n|\n|\r")


@dataclass(frozen=True)
class TextOfFile:
    """A file's text."""

    text: str
    zero_bytes: int = 0   # zero bytes that followed it; a loss of power leaves such

    @property
    def lines(self) -> list[str]:
        """Its lines without their ends."""
        lines = LINE_END.split(self.text)
        return lines[:-1] if lines[-1] == "" else lines

    @property
    def is_cut(self) -> bool:
        """Whether the last line was lost in the middle: zero bytes follow it instead of a line's end."""
        return self.zero_bytes > 0 and self.text != "" and self.text[-1] not in "\r\n"

    def remark(self) -> str | None:
        """States what is left out; None where nothing is."""
        if not self.zero_bytes:
            return None
        cut = f" and line {len(self.lines)}, which they cut, are" if self.is_cut else " are"
        return f"ends in {self.zero_bytes} zero bytes, as after a loss of power; they{cut} left out"


class NotText(Exception):
    """Bytes that are not text; its words say where and why."""


def bytes_of(path: Path, what: str, said: str | None = None) -> bytes:
    """A file's bytes; one packed by gzip is unpacked. BadInput begins with `said` and ends with "give {what}"."""
    name = said or f"{path}:"
    try:
        with path.open("rb") as file:
            data = file.read(MOST_BYTES + 1)
    except OSError as error:
        raise BadInput(f"{name} cannot be read ({reason_of(error)}); give {what}") from None
    if len(data) > MOST_BYTES:
        raise BadInput(f"{name} has more than {MOST_BYTES >> 30} GiB; give a shorter file")
    return _unpacked(data, name) if data.startswith(GZIP) else data


def _unpacked(data: bytes, name: str) -> bytes:
    """All parts of a file that gzip packed."""
    found, rest = [], data
    size = 0
    while rest.startswith(GZIP):
        part = zlib.decompressobj(wbits=16 + zlib.MAX_WBITS)
        try:
            found.append(part.decompress(rest, MOST_BYTES - size + 1))
        except zlib.error:
            raise BadInput(f"{name} is packed by gzip but broken; pack it again") from None
        size += len(found[-1])
        if size > MOST_BYTES:
            raise BadInput(f"{name} unpacks to more than {MOST_BYTES >> 30} GiB; give a shorter file")
        if not part.eof:
            raise BadInput(f"{name} is packed by gzip but broken (its end is missing); pack it again")
        rest = part.unused_data.lstrip(b"\0")
    if rest:
        raise BadInput(f"{name} is packed by gzip but broken (other bytes follow); pack it again")
    return b"".join(found)


def beginning_of(path: Path, size: int = LOOKED_AT) -> str:
    """The first characters of a text file; an empty text where it cannot be read."""
    try:
        with path.open("rb") as packed:
            is_packed = packed.read(2) == GZIP
        with gzip.open(path) if is_packed else path.open("rb") as file:
            return decoded(file.read(size), is_lenient=True).text
    except (OSError, EOFError, zlib.error, NotText):
        return ""


def text_of_file(path: Path, what: str, said: str | None = None, *, is_lenient: bool = False,
                 so: str = "") -> TextOfFile:
    """A file's text; BadInput for what is not text begins with `said`, names the line and states `so`, what follows."""
    data = bytes_of(path, what, said)
    try:
        return decoded(data, is_lenient=is_lenient)
    except NotText as why:
        raise BadInput(f"{said or f'{path}:'} {why}{so}; give {what}") from None


def decoded(data: bytes, *, is_lenient: bool = False) -> TextOfFile:
    """Text in UTF-8, in UTF-16 with or without its mark, or in the 8 bits of Western Windows; NotText for other bytes.

    Zero bytes at the end are left out. `is_lenient`: bytes that stand for no letter become U+FFFD, as in comments of a
    DBC file that are in another language.
    """
    encoding = _utf_16_of(data)
    if encoding:
        whole = data[: len(data) // 2 * 2]
        text = whole.decode(encoding, errors="replace").removeprefix("\ufeff")
        kept = text.rstrip("\0")
        return _checked(kept, len(data) - len(whole) + 2 * (len(text) - len(kept)))
    kept_bytes = data.rstrip(b"\0")
    return _checked(_of_8_bits(kept_bytes, is_lenient), len(data) - len(kept_bytes))


def _checked(text: str, zero_bytes: int) -> TextOfFile:
    """NotText for zero bytes within the text."""
    if "\0" in text:
        line = len(LINE_END.split(text[: text.index("\0")]))
        raise NotText(f"line {line} holds a zero byte")
    return TextOfFile(text, zero_bytes)


def _utf_16_of(data: bytes) -> str | None:
    """The name of the encoding where bytes are UTF-16 by their mark, or by zeros in every other byte."""
    if data.startswith(UTF_16):
        return "utf-16-le" if data.startswith(UTF_16[0]) else "utf-16-be"
    shown = data[:LOOKED_AT].rstrip(b"\0")
    even, odd = shown[0::2], shown[1::2]
    for zeros, letters, name in ((odd, even, "utf-16-le"), (even, odd, "utf-16-be")):
        if len(shown) > 3 and zeros.count(0) > ZEROS_OF_UTF_16 * len(zeros) and 0 not in letters:
            return name
    return None


def _of_8_bits(data: bytes, is_lenient: bool) -> str:
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = len(re.split(rb"\r\n|\n|\r", data[: error.start]))
    if not is_lenient and any(byte < 32 and byte not in b"\t\n\r\f\0" for byte in data):
        raise NotText(f"line {line} holds bytes that are not text") from None
    try:
        return data.decode("cp1252", errors="replace" if is_lenient else "strict")
    except UnicodeDecodeError:
        raise NotText(f"line {line} holds bytes that are not text") from None
