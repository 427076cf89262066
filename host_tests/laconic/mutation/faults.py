"""Faults that another sampler made, as lines of JSON: {"file": "core_c/src/rk4.c", "start": 2097, "end": 2098, "text":
"<="}, each the bytes of a file from `start` to `end` and what it had there instead."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from laconic.errors import BadInput, reason_of
from laconic.mutation.operators import Change
from laconic.paths import SOURCE_DIR


@dataclass(frozen=True)
class Fault:
    """One change of one file."""

    file: str
    start: int
    end: int
    text: str

    @property
    def change(self) -> Change:
        """As the operators have it."""
        return self.start, self.end, self.text

    def __str__(self) -> str:
        source = (SOURCE_DIR / self.file).read_bytes()
        line, column = source.count(b"\n", 0, self.start) + 1, self.start - source.rfind(b"\n", 0, self.start)
        before = source[self.start:self.end].decode("utf-8", "replace")
        return f"{self.file}:{line}:{column}: {' '.join(before.split())}  →  {' '.join(self.text.split())}"


def read_faults(path: Path) -> list[Fault]:
    """One of each line; BadInput names the line that is none."""
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except OSError as error:
        raise BadInput(f"--faults {path}: cannot be read: {reason_of(error)}") from None
    except UnicodeError:
        raise BadInput(f"--faults {path}: is no text in UTF-8; give a line of JSON for each fault") from None
    return [_of(f"--faults {path}: line {number}", line) for number, line in enumerate(lines, 1) if line.strip()]


def _of(where: str, line: str) -> Fault:
    try:
        row: Any = json.loads(line)
        fault = Fault(row["file"], row["start"], row["end"], row["text"])
    except (ValueError, KeyError, TypeError):
        raise BadInput(f'{where}: is no fault; give {{"file": …, "start": …, "end": …, "text": …}}') from None
    kinds = (str, int, int, str)
    for name, value, kind in zip(("file", "start", "end", "text"), vars(fault).values(), kinds, strict=True):
        if type(value) is not kind:
            raise BadInput(f"{where}: {name}: {value!r} is {'no text' if kind is str else 'no whole number'}")
    path = SOURCE_DIR / fault.file
    if path.suffix not in (".c", ".h") or not path.resolve().is_relative_to(SOURCE_DIR.resolve()) or not path.is_file():
        raise BadInput(f"{where}: file: {fault.file} is no C file of the project")
    if not 0 <= fault.start <= fault.end <= path.stat().st_size:
        raise BadInput(f"{where}: start and end: {fault.start} and {fault.end} are no bytes of {fault.file}, in order")
    return fault
