"""Bounds of a TOML text, checked before it is parsed: its parser takes memory by the square of a key's parts.

The scan knows strings, comments and brackets and nothing else; whether the text is TOML is for the parser to say.
"""

from __future__ import annotations

import re

MOST_PARTS = 16         # of a dotted key
MOST_NESTED = 8         # lists and tables in each other
MOST_KEYS = 50_000      # of a file, tables counted: hundreds of usual scenes

SPECIAL = re.compile(r"""["'#.=,\n\[\]{}]""")
END_OF_BASIC = re.compile(r'["\\\n]')
END_OF_LITERAL = re.compile(r"['\n]")
OPENING, CLOSING = "[{", "]}"


class BeyondBounds(ValueError):
    """A text that no scene or map needs, in words with its line."""


def check_bounds(text: str) -> None:
    """Raises BeyondBounds for keys of too many parts, lists too deep in each other, and too many keys.

    O(length); nothing of the text is copied.
    """
    parts, nested, keys, place = 1, 0, 0, 0
    while found := SPECIAL.search(text, place):
        letter, place = found[0], found.end()
        if letter == ".":
            parts += 1
            if parts > MOST_PARTS:
                _fail(text, place, f"has a key of more than {MOST_PARTS} parts")
            continue
        if letter in "\"'":  # part of a key, or a value
            place = _after_string(text, found.start(), letter)
            continue
        parts = 1
        if letter == "#":
            end = text.find("\n", place)
            place = len(text) if end < 0 else end
        elif letter in OPENING:
            nested += 1
            keys += nested == 1
            if nested > MOST_NESTED:
                _fail(text, place, f"nests lists or tables too deeply, more than {MOST_NESTED} in each other")
        elif letter in CLOSING:
            nested = max(0, nested - 1)
        elif letter == "=":
            keys += 1
        if keys > MOST_KEYS:
            _fail(text, place, f"begins key or table {keys}, and {MOST_KEYS} are the most")


def _fail(text: str, place: int, what: str) -> None:
    line = text.count("\n", 0, place) + 1
    raise BeyondBounds(f"line {line} {what}; no scene or map needs that")


def _after_string(text: str, start: int, quote: str) -> int:
    """Behind the string that begins there, or behind its line where it has no end."""
    is_long = text.startswith(quote * 3, start)
    if quote == "'":
        if is_long:
            end = text.find("'''", start + 3)
            return len(text) if end < 0 else end + 3
        found = END_OF_LITERAL.search(text, start + 1)
        return found.end() if found else len(text)
    place = start + (3 if is_long else 1)
    while found := END_OF_BASIC.search(text, place):
        place = found.end()
        if found[0] == "\\":
            place += 1
        elif not is_long:
            return place
        elif found[0] == '"' and text.startswith('""', place):
            return place + 2
    return len(text)
