"""Spoilt files: good ones with wrong tables, values, letters and parts of others, by coverage of the package's lines.

A spoilt file is read, or refused by one line that names the file and the remedy; nothing else may come of it."""

from __future__ import annotations

import copy
import random
import sys
import tempfile
import traceback
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

import laconic
from assurance.common import ROOT, Clock, work
from laconic.base.paths import SCENE_DIR
from laconic.can.play.map_file import read_map as read_joints
from laconic.can.play.map_join import join
from laconic.errors import BadInput, ResultFails
from laconic.robot.logs.column_map import MAPS
from laconic.robot.logs.column_map import read_map as read_columns
from laconic.scene.scene import read_scene
from laconic.scene.table import entries_of

PACKAGE = str(Path(laconic.__file__).parent)
OF_PLAY = next((ROOT / "host_tests/tests").rglob("transporter.dbc")).parent
LONGEST_LINE, STEPS = 2000, 3
REMEDIES = ("; ", "give ", "take ", "correct ", "did you mean", "save ", "use ", "name ", "put ", ", not ")
ODD: tuple[Any, ...] = (
    0, 1, -1, 2, 3, 16, 17, 255, 360, 0.1, 0.5, -0.0, 1e-300, 1e17, 1e300, -1e300, 5e-324, float("nan"), float("inf"),
    -float("inf"), 2**31, 2**63, -2**63, 10**30, 10**400, True, False, "", " ", "a", "nan", "1e999", "rk4", "auto",
    "\n", "\t", "\x7f", "\u202e", "ν", "x" * 300, "../..", "%s%n", [], [[]], {}, [1], [1, 2, 3], [0.0] * 3,
    ["a"], [{}], [None], {"a": 1})
LETTERS = "\"'[]{}=.,#-0123456789eE_ \n\r\t\0:;|@+()ξ\ufeff"
MOST_CHANGES = 4




@dataclass(frozen=True)
class Reader:
    """Good files to begin with, and what is done with a spoilt one: it raises BadInput, or nothing."""

    good: list[Path]
    use: Callable[[Path], None]


def _use_scene(path: Path) -> None:
    """Reads, prepares, takes steps; a motion that is accepted is one of numbers."""
    scene = read_scene(path)
    if scene.run.tolerance is not None:
        return  # its step was found by runs
    core = scene.core()
    plant = scene.plant(core)
    try:
        plant.run(core.input(), STEPS)
    except BadInput:
        return
    values = [plant.pose.x_m, plant.pose.y_m, plant.pose.heading_rad]
    if any(value != value or abs(value) == float("inf") for value in values):
        raise ResultFails(f"{path}: was accepted, and its motion is {values}")


def _use_columns(path: Path) -> None:
    read_columns(path)


def _use_joints(path: Path) -> None:
    join(read_joints(path, 2), OF_PLAY / "transporter.dbc")


def _use_dbc(path: Path) -> None:
    join(read_joints(OF_PLAY / "transporter.toml", 2), path)


READERS = {
    "scenes": Reader(sorted(SCENE_DIR.glob("*.toml")), _use_scene),
    "column maps": Reader(sorted(MAPS.glob("*.toml")), _use_columns),
    "DBC maps": Reader(sorted(OF_PLAY.glob("transporter*.toml")), _use_joints),
    "DBC": Reader(sorted(OF_PLAY.glob("*.dbc")), _use_dbc),
}


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


class Lines:
    """Lines of the package that ran."""

    def __init__(self) -> None:
        self.seen: set[tuple[CodeType, int]] = set()

    def _call(self, frame: FrameType, event: str, argument: Any) -> Any:
        return self._line if frame.f_code.co_filename.startswith(PACKAGE) else None

    def _line(self, frame: FrameType, event: str, argument: Any) -> Any:
        self.seen.add((frame.f_code, frame.f_lineno))
        return self._line

    def complaint(self, reader: Reader, path: Path) -> str:
        """What is wrong with how a file is taken; "" where it is read, or refused as it should be."""
        before = sys.gettrace()
        sys.settrace(self._call)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                reader.use(path)
        except BadInput as refusal:
            return unclear(str(refusal), path)
        except Exception:  # noqa: BLE001 - whatever it is, the user would see it
            return traceback.format_exc()
        finally:
            sys.settrace(before)
        return ""


def unclear(line: str, path: Path) -> str:
    """Why a refusal is no good line."""
    if "\n" in line or "\r" in line:
        return f"more than one line: {line!r}"
    if path.name not in line:
        return f"does not name the file: {line!r}"
    if not any(remedy in line for remedy in REMEDIES):
        return f"states no remedy: {line!r}"
    return f"longer than {LONGEST_LINE}: {line!r}" if len(line) > LONGEST_LINE else ""


def spoil(reader: Reader, seed: int, clock: Clock, most: float) -> tuple[int, int, str, str]:
    """Files until the time is over or one is taken wrongly: how many, the lines they reached, the complaint, and the
    text."""
    spoiler, lines, done = Spoiler(seed), Lines(), 0
    suffix, texts = reader.good[0].suffix, [path.read_text(encoding="utf-8") for path in reader.good]
    waiting = list(texts)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, f"spoilt{suffix}")
        while done < most and (clock or waiting):
            choice = spoiler.random.choice
            text = waiting.pop() if waiting else spoiler.spoilt(choice(texts), choice(texts))
            path.write_text(text, encoding="utf-8", errors="surrogatepass", newline="")
            before, complaint = len(lines.seen), lines.complaint(reader, path)
            done += 1
            if complaint:
                return done, len(lines.seen), complaint, text
            if len(lines.seen) > before and text not in texts:
                texts.append(text)
    return done, len(lines.seen), "", ""


def search(minutes: float, runs: int | None, seed: int) -> bool:
    """Each reader so long, or so many files; prints what was found."""
    found = True
    for name, reader in READERS.items():
        most = float("inf") if runs is None else float(runs)
        done, lines, complaint, text = spoil(reader, seed, Clock(minutes if runs is None else 1e6), most)
        print(f"{name}: {done} files, {lines} lines, {complaint or 'nothing found'}", flush=True)
        if complaint:
            kept = work("fuzz") / f"spoilt{reader.good[0].suffix}"
            kept.write_text(text, encoding="utf-8", errors="surrogatepass", newline="")
            print(f"kept as {kept}")
        found &= not complaint
    return found
