"""A TOML table that is read key by key: what is missing, of the wrong kind or unknown becomes one clear line.

Reads the TOML of a map, in any of the encodings that logs may have.
"""

from __future__ import annotations

import copy
import difflib
import math
import re
import sys
import unicodedata
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from datetime import date, time
from pathlib import Path
from typing import Any, NoReturn

from laconic.base.text_file import NotText, decoded
from laconic.core import Field
from laconic.core.given import is_masked
from laconic.core.spelling import is_in_degrees
from laconic.errors import BadInput, cut, nearest_of, reason_of, shown
from laconic.scene.not_modelled import instead_of
from laconic.scene.toml_bounds import BeyondBounds, check_bounds

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

MOST_BYTES = 16 * 2**20  # of a file: thousands of usual scenes, and a wait that people bear
NO_HINTS: Mapping[str, str] = {}


def read_toml(path: Path, decode: Callable[[bytes], str] | None = None,
              hints: Mapping[str, str] | None = None) -> Table:
    """The file's top table; `decode` makes text of its bytes, UTF-8 if not given; `hints`: what to do about a key that
    is given twice."""
    try:
        with path.open("rb") as file:
            given = file.read(MOST_BYTES + 1)
        if len(given) > MOST_BYTES:
            raise BadInput(f"{path}: has more than {MOST_BYTES >> 20} MiB, which no scene needs; give the path of a "
                           "scene")
        text = given.decode("utf-8-sig") if decode is None else decode(given)
        return Table(path, "", entries_of(text))
    except OSError as error:
        raise BadInput(f"{path}: cannot be read ({reason_of(error)}); give the path of a readable TOML file") from None
    except UnicodeDecodeError:
        raise BadInput(f"{path}: is no text in UTF-8; save it as UTF-8") from None
    except BeyondBounds as error:
        raise BadInput(f"{path}: {error}; give the path of another file") from None
    except tomllib.TOMLDecodeError as error:
        if twice := _twice(text, error):
            key, first, line = twice
            remedy = (hints or NO_HINTS).get(key, "keep one of them")
            raise BadInput(f"{path}: {key}: is given twice, on lines {first} and {line}; {remedy}") from None
        raise BadInput(f"{path}: is no valid TOML: {error}{_line_of(text, error)}; correct that line") from None
    except ValueError:  # of Python, which reads no number of thousands of digits
        raise BadInput(f"{path}: holds a number of thousands of digits; give numbers as people write them") from None


def entries_of(text: str, number: Callable[[str], Any] = float) -> dict[str, Any]:
    """What a TOML text holds, its decimals made by `number`; ValueError where it is none, or beyond all bounds."""
    check_bounds(text)
    return tomllib.loads(text, parse_float=number)


NEAR = 0.65  # of letters that two keys share: one may be the other, mistyped


class Table:
    """One table of a file; keeps which keys were read, so that `done` finds unknown ones."""

    def __init__(self, path: Path, location: str, entries: dict[str, Any], in_degrees: set[str] | None = None):
        self.path, self.location, self._entries = path, location, entries
        self.in_degrees = set() if in_degrees is None else in_degrees  # names of the angles that are given so
        self._known: set[str] = set()
        self._expected: set[str] = set()

    def name(self, key: str) -> str:
        """The key with the tables around it."""
        return f"{self.location}.{key}" if self.location else key

    def fail(self, key: str, message: str) -> NoReturn:
        """Raises BadInput for a key of this table."""
        raise BadInput(f"{self.path}: {self.name(key)}: {message}")

    def has(self, key: str) -> bool:
        """Whether the key is there; it counts as known from now on."""
        self._known.add(key)
        return key in self._entries

    def expect(self, keys: Iterable[str]) -> None:
        """Keys that will be read: where one is missing, none of the others counts as its misspelling."""
        self._expected.update(keys)

    def peek(self, key: str) -> Any:
        """What the key holds, None where it is missing; it counts as unread still."""
        return self._entries.get(key)

    def plain(self) -> dict[str, Any]:
        """A copy of all that the table holds, as it was read."""
        return copy.deepcopy(self._entries)

    def done(self, hints: Mapping[str, str] = NO_HINTS) -> None:
        """Raises BadInput for the first key that was not read; hints as in laconic.scene.not_modelled."""
        for key in self._entries:
            if key not in self._known:
                self.fail(key, f"is no known key here; {nearest_of(key, self._known, instead_of(key, hints))}")

    def _get(self, key: str, default: Any, kinds: tuple[type, ...], what: str) -> Any:
        if not self.has(key):
            if default is REQUIRED:
                self.fail(key, f"is missing; give it as {what}{self._mistyped(key)}")
            return default
        value = self._entries[key]
        if not isinstance(value, kinds) or (isinstance(value, bool) and bool not in kinds):
            self.fail(key, f"is {_shown(value)}, not {what}")
        return value

    def _mistyped(self, key: str) -> str:
        """The key that was probably meant to be this one, in words."""
        typed = self.mistyped(key)
        return f" (you wrote {typed}, which is no known key here)" if typed else ""

    def mistyped(self, key: str) -> str:
        """The unread key that was probably meant to be this one; "" for none."""
        unread = [entry for entry in self._entries if entry not in self._known | self._expected]
        return next(iter(difflib.get_close_matches(key, unread, n=1, cutoff=NEAR)), "")

    def value(self, key: str, default: Any, kinds: tuple[type, ...], what: str) -> Any:
        """A value of one of some kinds, which `what` names in the message."""
        return self._get(key, default, kinds, what)

    def number(self, key: str, default: Any = ..., *, finite: bool = True) -> Any:
        """A number; what the core checks itself may be anything a float can be."""
        value = self._get(key, default, (int, float), "a number")
        return self._finite(key, value) if finite and value is not None else _float(value)

    def _finite(self, key: str, value: float) -> float:
        number = _float(value)
        if not math.isfinite(number):
            self.fail(key, f"is {_shown(value)}; give a finite number")
        return number

    def angle(self, stem: str, default: Any = ..., *, finite: bool = True) -> Any:
        """An angle in rad: from stem_rad, or from stem_deg in degrees."""
        in_radians, in_degrees = f"{stem}_rad", f"{stem}_deg"
        if is_in_degrees(self, stem):
            self.in_degrees.add(self.name(in_radians))
            return math.radians(self.number(in_degrees, finite=finite))
        if default is REQUIRED and not self.has(in_radians):
            self.fail(in_radians, f"is missing; give it, or {in_degrees}, as a number{self._mistyped(in_radians)}")
        return self.number(in_radians, default, finite=finite)

    def text(self, key: str, default: Any = ..., *, allowed: str = "") -> str:
        """A string without characters (but the allowed ones) that steer a terminal or that XML has not: one line."""
        text = self._get(key, default, (str,), "text in quotes")
        hidden = [letter for letter in text or "" if _is_hidden(letter) and letter not in allowed]
        if hidden:
            kind = "control" if unicodedata.category(hidden[0]).startswith(("Cc", "Z")) else "unprintable"
            self.fail(key, f"holds the {kind} character {hidden[0]!a}; give plain text")
        return text

    def flag(self, key: str, default: Any = ...) -> bool:
        """true or false."""
        return self._get(key, default, (bool,), "true or false")

    def whole(self, key: str, default: Any = ...) -> int:
        """A whole number of at most 64 bits."""
        found: int = self._get(key, default, (int,), "a whole number")
        if found is not None and found.bit_length() > 64:
            self.fail(key, f"is {_shown(found)}; give a whole number of at most 64 bits")
        return found

    def choice(self, key: str, choices: Sequence[str], default: Any = ..., *,
               hints: Mapping[str, str] = NO_HINTS) -> str:
        """One of some words; hints as in laconic.scene.not_modelled."""
        word = self.text(key, default)
        if word is not None and word not in choices:
            self.fail(key, f"there is no {shown(word)}; {nearest_of(word, choices, instead_of(word, hints))}")
        return word

    def numbers(self, key: str, length: int | None = None, *, finite: bool = True) -> tuple[float, ...]:
        """A list of numbers, of the given length."""
        what = "a list of numbers" if length is None else f"a list of {length} numbers"
        values = self._get(key, ..., (list,), what)
        if length is not None and len(values) != length:
            self.fail(key, f"has {len(values)} entries, not {length}")
        for value in values:
            if isinstance(value, bool) or not isinstance(value, (int, float)):
                self.fail(key, f"holds {_shown(value)}; give {what}")
        return tuple(self._finite(key, v) if finite else _float(v) for v in values)

    def texts(self, key: str, default: Any = ...) -> tuple[str, ...]:
        """A list of strings."""
        values = self._get(key, default, (list, tuple), "a list of texts in quotes")
        for value in values:
            if not isinstance(value, str):
                self.fail(key, f"holds {_shown(value)}; give a list of texts in quotes")
        return tuple(values)

    def table(self, key: str, *, required: bool = False) -> Table:
        """A table inside; an empty one where it may be left out."""
        entries = self._get(key, REQUIRED if required else {}, (dict,), f"a table [{self.name(key)}]")
        return Table(self.path, self.name(key), entries, self.in_degrees)

    def tables(self, key: str) -> Iterator[Table]:
        """The tables of an array of tables, numbered from 1."""
        entries = self._get(key, [], (list,), f"tables [[{self.name(key)}]]")
        for number, entry in enumerate(entries, start=1):
            if not isinstance(entry, dict):
                self.fail(key, f"is a list of values, not tables [[{self.name(key)}]]")
            yield Table(self.path, f"{self.name(key)}[{number}]", entry, self.in_degrees)


REQUIRED = ...


def _is_hidden(letter: str) -> bool:
    """Controls, line ends, halves of pairs, and the two last of each plane, which stand for no character."""
    return unicodedata.category(letter) in ("Cc", "Cs", "Zl", "Zp") or ord(letter) & 0xFFFE == 0xFFFE


def _line_of(text: str, error: Exception) -> str:
    """The line that an error of the TOML reader speaks of, which names no key."""
    found = re.search(r"at line (\d+)", str(error))
    lines = text.splitlines()
    if not found or int(found[1]) > len(lines):
        return ""
    return f", {shown(lines[int(found[1]) - 1].strip())}"


HEADER = re.compile(r"\s*\[\[?\s*([^\[\]#]+?)\s*\]")
ENTRY = re.compile(r"\s*([\w\"'.-]+)\s*=")


def _twice(text: str, error: Exception) -> tuple[str, int, int] | None:
    """(key, its first line, the line at which it comes again) of an error of the TOML reader; None for others."""
    where = re.search(r"at line (\d+)", str(error))
    if not where or not str(error).startswith(("Cannot overwrite", "Cannot declare", "Cannot mutate")):
        return None
    seen, table = dict[str, int](), ""
    for number, line in enumerate(text.splitlines(), start=1):
        if header := HEADER.match(line):
            table = key = header[1]
        elif entry := ENTRY.match(line):
            key = f"{table}.{entry[1]}" if table else entry[1]
        else:
            continue
        if number == int(where[1]):
            parts = key.split(".")
            above = (".".join(parts[:count]) for count in range(len(parts), 0, -1))
            found = next((name for name in above if name in seen), None)
            return None if found is None else (found, seen[found], number)
        seen.setdefault(key, number)
    return None


def plain(value: Any) -> Any:
    """A value as TOML would give it: numpy's scalars as Python's, but for one that is masked."""
    if is_masked(value):
        return value
    return value.item() if hasattr(value, "item") and not getattr(value, "shape", ()) else value


def _float(value: Any) -> Any:
    if value is None:
        return None
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf


def _shown(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return f'the text "{cut(value)}"'
    if isinstance(value, (list, dict)):
        return "a list" if isinstance(value, list) else "a table"
    if is_masked(value):
        return "masked"
    return str(value) if isinstance(value, date | time) else shown(value)  # dates as they are written


TWICE = {"pose": 'keep the table, and write the topic there: topic = "/odom"',
         "imu": "keep one of them; a gyro with more keys is [yaw_rate]",
         "joints": "keep one of them; more about the wheels is said under [wheel_angle]"}
"""What to do about keys that are a topic, or a table that says more."""


def read_map_toml(path: Path) -> Table:
    """The top table of a map; BadInput names the line that is wrong."""
    try:
        return read_toml(path, lambda data: decoded(data).text, TWICE)
    except NotText as why:
        raise BadInput(f"{path}: {why}; give a map as TOML text") from None


def read_field(table: Table, field: Field, default: Any = ..., *, finite: bool = False) -> Any:
    """One key of a table by its row in the core's list of fields; the core checks its value."""
    if field.kind in ("FLAG", "ABSENCE"):
        return table.flag(field.key, default if default is ... else bool(default))
    if field.key.endswith("_rad"):
        return table.angle(field.key.removesuffix("_rad"), default, finite=finite)
    return table.number(field.key, default, finite=finite)
