"""A scene as TOML text: values with all their digits, a comment behind each that has one."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Mapping
from typing import Any

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

Comments = dict[tuple[str, ...], str]
"""By location: ("vehicle", "wheel", "0", "x_m")."""


def lines_of(table: Mapping[str, Any], comments: Comments, location: tuple[str, ...] = ()) -> Iterator[str]:
    """A table's own keys, then its tables."""
    inner = {key: value for key, value in table.items() if _is_table(value) or _is_tables(value)}
    for key, value in table.items():
        if key not in inner:
            comment = comments.get((*location, key), "")
            yield f"{key} = {value_text(value)}" + (f"  # {comment}" if comment else "")
    for key, value in inner.items():
        name = ".".join(part for part in (*location, key) if not part.isdigit())
        for number, each in enumerate(value if _is_tables(value) else [value]):
            yield ""
            yield f"[[{name}]]" if _is_tables(value) else f"[{name}]"
            deeper = (*location, key, str(number)) if _is_tables(value) else (*location, key)
            yield from lines_of(each, comments, deeper)


def _is_table(value: Any) -> bool:
    return isinstance(value, dict)


def _is_tables(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(each, dict) for each in value)


def value_text(value: Any) -> str:
    """One value as TOML writes it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        escaped = "".join(c if c >= " " and c not in '"\\\x7f' else f"\\u{ord(c):04x}" for c in value)
        return f'"{escaped}"'
    if isinstance(value, list):
        return f"[{', '.join(value_text(each) for each in value)}]"
    if isinstance(value, dict):
        return f"{{ {', '.join(f'{key} = {value_text(each)}' for key, each in value.items())} }}"
    return repr(value) if isinstance(value, (int, float)) else str(value)


def rewritten(text: str, after: Mapping[str, Any], comments: Comments) -> str:
    """A file with the values of another table: what is the same stays as it was written, comments too. A file in a form
    that this does not follow is written anew, without its comments."""
    try:
        found = _Rewriting(text, after, comments).text()
        if tomllib.loads(found) == after:
            return found
    except (tomllib.TOMLDecodeError, LookupError):
        pass
    return "\n".join(lines_of(after, comments)) + "\n"


class _Rewriting:
    """Goes through a file line by line."""

    def __init__(self, text: str, after: Mapping[str, Any], comments: Comments):
        plain = text.removeprefix("\ufeff").replace("\r\n", "\n")
        self._lines, self._before = plain.rstrip("\n").split("\n"), tomllib.loads(plain)
        self._after, self._comments = after, comments
        self._counts: dict[tuple[str, ...], int] = {}
        self._out: list[str] = []

    def text(self) -> str:
        """The new file."""
        location: tuple[str, ...] = ()
        index = end = 0
        while index < len(self._lines):
            header, key = HEADER.match(self._lines[index]), KEY.match(self._lines[index])
            size = 1
            if header:
                self._out[end:end] = self._new(location)
                location = self._entered(header)
            elif key:
                size = self._size(index)
                self._out += self._entry(location, key[1], self._lines[index:index + size])
            if not key:
                self._out.append(self._lines[index])
            end = len(self._out) if header or key else end
            index += size
        self._out[end:end] = self._new(location)
        more = {key: value for key, value in self._after.items() if key not in self._before
                and (_is_table(value) or _is_tables(value))}
        return "\n".join([*self._out, *lines_of(more, self._comments)]) + "\n"

    def _entered(self, header: re.Match[str]) -> tuple[str, ...]:
        """The location of a table."""
        location: tuple[str, ...] = ()
        *above, last = [part.strip() for part in header[2].split(".")]
        for part in above:
            location += (part,)
            location += (str(self._counts[location]),) if location in self._counts else ()
        location += (last,)
        if header[1]:
            self._counts[location] = self._counts.get(location, -1) + 1
            location += (str(self._counts[location]),)
        return location

    def _size(self, index: int) -> int:
        """How many lines an entry has."""
        for end in range(index + 1, len(self._lines) + 1):
            if _loads("\n".join(self._lines[index:end])) is not None:
                return end - index
        raise LookupError(index)

    def _entry(self, location: tuple[str, ...], key: str, lines: list[str]) -> list[str]:
        before, after = (_at(table, location) for table in (self._before, self._after))
        if key not in after:
            return []
        if before[key] == after[key]:
            return lines
        return [_line(key, after[key], [*self._said_of((*location, key)), _comment(lines)])]

    def _new(self, location: tuple[str, ...]) -> list[str]:
        """Keys that the file does not have; tables within a table in one line."""
        before, after = (_at(table, location) for table in (self._before, self._after))
        return [_line(key, value, self._said_of((*location, key))) for key, value in after.items()
                if key not in before and (location or not (_is_table(value) or _is_tables(value)))]

    def _said_of(self, location: tuple[str, ...]) -> list[str]:
        """The comments of a key, and of what is within it."""
        return [text for at, text in self._comments.items() if at[:len(location)] == location]


HEADER = re.compile(r"\s*\[(\[)?([A-Za-z0-9_. -]+)\]\]?\s*(?:#.*)?$")
KEY = re.compile(r"\s*([A-Za-z0-9_-]+)\s*=")


def _loads(text: str) -> dict[str, Any] | None:
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        return None


def _at(table: Mapping[str, Any], location: tuple[str, ...]) -> Mapping[str, Any]:
    found: Any = table
    for part in location:
        found = found[int(part)] if isinstance(found, list) else found[part]
    assert isinstance(found, dict)
    return found


def _comment(lines: list[str]) -> str:
    """What is written behind a value of one line."""
    if len(lines) == 1:
        whole = _loads(lines[0])
        for sign in re.finditer("#", lines[0]):
            if _loads(lines[0][:sign.start()]) == whole:
                return lines[0][sign.end():].strip()
    return ""


def _line(key: str, value: Any, comments: list[str]) -> str:
    told = "; ".join(filter(None, comments))
    return f"{key} = {value_text(value)}" + (f"  # {told}" if told else "")
