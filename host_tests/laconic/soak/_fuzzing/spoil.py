"""Spoils a text file: a TOML file by its tables and values, any other by its lines and letters."""

from __future__ import annotations

import copy
import random
from typing import Any

from laconic.scene.table import entries_of

ODD: tuple[Any, ...] = (
    0, 1, -1, 2, 3, 16, 17, 255, 360, 0.1, 0.5, -0.0, 1e-300, 1e17, 1e300, -1e300, 5e-324, float("nan"), float("inf"),
    -float("inf"), 2**31, 2**63, -2**63, 10**30, 10**400, True, False, "", " ", "a", "nan", "1e999", "rk4", "auto",
    "\n", "\t", "\x7f", "\u202e", "ν", "x" * 300, "../..", "%s%n", [], [[]], {}, [1], [1, 2, 3], [0.0] * 3,
    ["a"], [{}], [None], {"a": 1})
LETTERS = "\"'[]{}=.,#-0123456789eE_ \n\r\t\0:;|@+()ξ\ufeff"
MOST_CHANGES = 4


class Spoiler:
    """Makes files out of good ones; the same seed makes the same ones."""

    def __init__(self, seed: int):
        self.random = random.Random(seed)

    def spoilt(self, text: str, other: str) -> str:
        """One of a text; parts of another text may come into it."""
        try:
            tables, from_other = entries_of(text), entries_of(other)
        except (ValueError, RecursionError):
            return self._letters(text, other)
        if self.random.random() < 0.15:
            return self._letters(text, other)
        for _ in range(self.random.randint(1, MOST_CHANGES)):
            self._change(tables, from_other)
        return "\n".join(lines_of(tables))

    def _change(self, tables: dict[str, Any], other: dict[str, Any]) -> None:
        """One change at a random place of the tables."""
        holder, key = self._place(tables)
        if holder is None:
            return
        donor, of_donor = self._place(other)
        what = self.random.randrange(8)
        if what == 0:
            del holder[key]
        elif what == 1 and isinstance(holder, dict):
            holder[self._renamed(str(key))] = holder.pop(key)
        elif what == 2 and isinstance(holder, list):
            holder.append(copy.deepcopy(holder[key]))
        elif what == 3 and donor is not None:
            holder[key] = copy.deepcopy(donor[of_donor])
        elif what == 4 and donor is not None and isinstance(holder, dict):
            holder[str(of_donor)] = copy.deepcopy(donor[of_donor])
        elif what == 5 and isinstance(holder[key], (int, float)):
            holder[key] = self._near(holder[key])
        else:
            holder[key] = copy.deepcopy(self.random.choice(ODD))

    def _place(self, top: Any) -> tuple[Any, Any]:
        """A container in the tables and one of its keys; (None, None) where there is none."""
        places: list[tuple[Any, Any]] = []
        waiting = [top]
        while waiting:
            each = waiting.pop()
            keys = list(each) if isinstance(each, dict) else range(len(each))
            places += [(each, key) for key in keys]
            waiting += [each[key] for key in keys if isinstance(each[key], (dict, list))]
        return self.random.choice(places) if places else (None, None)

    def _near(self, value: float) -> float:
        try:
            return self.random.choice((value + 1, value - 1, -value, value * 2, value * 1e6, value * 1e-6, value + 0.5))
        except OverflowError:
            return 0

    def _renamed(self, key: str) -> str:
        at = self.random.randrange(len(key) + 1)
        return self.random.choice((key[:at] + key[at + 1:], key[:at] + "x" + key[at:], key.upper(), key + "_m", ""))

    def _letters(self, text: str, other: str) -> str:
        """Letters and lines that are lost, doubled, changed, or come from the other text."""
        for _ in range(self.random.randint(1, MOST_CHANGES)):
            at, end = sorted(self.random.randrange(len(text) + 1) for _ in range(2))
            end = min(end, at + 40)
            what = self.random.randrange(6)
            if what == 0:
                text = text[:at] + text[end:]
            elif what == 1:
                text = text[:end] + text[at:end] + text[end:]
            elif what == 2:
                text = text[:at] + self.random.choice(LETTERS) + text[at + 1:]
            elif what == 3:
                text = text[:at] + str(self.random.choice(ODD)) + text[end:]
            else:
                lines, others = text.splitlines() or [""], other.splitlines() or [""]
                lines[self.random.randrange(len(lines))] = self.random.choice(others if what == 4 else lines)
                text = "\n".join(lines)
        return text


def lines_of(tables: dict[str, Any], location: tuple[str, ...] = ()) -> list[str]:
    """The tables as TOML, by inline tables where they stand in a list of something else."""
    inner = [key for key, value in tables.items() if isinstance(value, dict)]
    lists = [key for key, value in tables.items()
             if isinstance(value, list) and value and all(isinstance(each, dict) for each in value)]
    lines = [f"{_key(key)} = {_value(value)}" for key, value in tables.items() if key not in inner and key not in lists]
    for key in inner:
        lines += [f"[{'.'.join(map(_key, (*location, key)))}]", *lines_of(tables[key], (*location, key))]
    for key in lists:
        for each in tables[key]:
            lines += [f"[[{'.'.join(map(_key, (*location, key)))}]]", *lines_of(each, (*location, key))]
    return lines


def _key(key: str) -> str:
    is_bare = all(letter.isascii() and (letter.isalnum() or letter in "_-") for letter in key)
    return key if key and is_bare else _text(key)


def _text(value: str) -> str:
    return '"' + "".join(letter if letter.isprintable() and letter not in '"\\' else f"\\U{ord(letter):08X}"
                         for letter in value) + '"'


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_key(key)} = {_value(each)}" for key, each in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_value, value)) + "]"
    return "0" if value is None else str(value)
