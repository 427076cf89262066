"""A text log as a table of numbers; whatever is no number is one line that names the file's line."""

from __future__ import annotations

import csv
import gzip
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from laconic.errors import BadInput, nearest_of, reason_of
from laconic.logs.column_map import Column, ColumnMap

GZIP = b"\x1f\x8b"
LONGEST_SHOWN = 40


@dataclass(frozen=True)
class TextTable:
    """The names of the columns (none: the log has no line of names) and the rows as text, each with its line."""

    path: Path
    names: list[str]
    rows: list[list[str]]
    lines: list[int]

    def index_of(self, column: Column, quantity: str) -> int:
        """Where a column stands, from 0; BadInput names the quantity that needs it."""
        if isinstance(column, int):
            if column > len(self.rows[0]):
                raise BadInput(f"{self.path}: line {self.lines[0]}: has {len(self.rows[0])} columns, no column "
                               f"{column} (for {quantity}); correct the column map with --map")
            return column - 1
        if column not in self.names:
            near = nearest_of(column, self.names) if self.names and len(self.names) < 40 else ""
            raise BadInput(f"{self.path}: has no column {column!r} (for {quantity}); correct the column map with --map"
                           + (f" ({near})" if near.startswith("did") else ""))
        return self.names.index(column)

    def numbers(self, indices: Sequence[int], quantity: str) -> np.ndarray:
        """Some columns as numbers, one row for each line."""
        out = np.empty((len(self.rows), len(indices)))
        for row, (line, texts) in enumerate(zip(self.lines, self.rows, strict=True)):
            try:
                out[row] = [float(texts[index]) for index in indices]
            except (ValueError, IndexError):
                raise BadInput(f"{self.path}: line {line}: no number for {quantity} "
                               f"({_wrong(texts, indices)}); remove the line or repair it") from None
        if not np.isfinite(out).all():
            line = self.lines[int(np.argmax(~np.isfinite(out).all(axis=1)))]
            raise BadInput(f"{self.path}: line {line}: {quantity} is not finite; remove the line or repair it")
        return out


def _wrong(texts: Sequence[str], indices: Sequence[int]) -> str:
    for index in indices:
        if index >= len(texts):
            return f"the line has {len(texts)} columns"
        try:
            math.fsum([float(texts[index])])
        except ValueError:
            return repr(texts[index][:LONGEST_SHOWN])
    return "overflow"


def text_of(path: Path) -> str:
    """The file's text; one packed by gzip is unpacked."""
    try:
        data = path.read_bytes()
        text = (gzip.decompress(data) if data.startswith(GZIP) else data).decode("utf-8-sig")
    except (gzip.BadGzipFile, EOFError, OSError) as error:
        if isinstance(error, OSError) and error.strerror:
            raise BadInput(f"{path}: cannot be read ({reason_of(error)}); give the path of a recorded run") from None
        raise BadInput(f"{path}: is packed by gzip but broken ({error}); pack it again") from None
    except UnicodeDecodeError:
        raise BadInput(f"{path}: is no CSV text; give a recorded run as CSV") from None
    except Exception as error:  # zlib.error, which gzip does not wrap
        raise BadInput(f"{path}: is packed by gzip but broken ({error}); pack it again") from None
    if "\0" in text:
        raise BadInput(f"{path}: is no CSV text; give a recorded run as CSV")
    return text


def rows_of(path: Path, separator: str) -> list[list[str]]:
    """All lines, split."""
    try:
        return list(csv.reader(text_of(path).splitlines(), delimiter=separator))
    except csv.Error:
        raise BadInput(f"{path}: is no CSV text; give a recorded run as CSV") from None


def read_text(path: Path, columns: ColumnMap) -> TextTable:
    """The table of a log; BadInput where there are no samples."""
    lines = rows_of(path, columns.separator)
    head = columns.header_lines
    numbered = [(number, row) for number, row in enumerate(lines[head:], start=head + 1)
                if any(cell.strip() for cell in row)]
    if not numbered:
        raise BadInput(f"{path}: has no samples after {head} header lines; give a recorded run")
    names = [name.strip() for name in lines[columns.names_line - 1]] if columns.names_line else []
    return TextTable(path, names, [row for _, row in numbered], [number for number, _ in numbered])


def metadata_of(path: Path) -> dict[str, list[str]]:
    """A file of rows, the name of each in its first column."""
    try:
        return {row[0].strip(): [cell.strip() for cell in row[1:]] for row in rows_of(path, ",") if row}
    except BadInput as error:
        raise BadInput(f"{error} (the column map takes gear or encoder from there)") from None


def metadata_number(path: Path, rows: dict[str, list[str]], name: str) -> float:
    """A number above zero from it."""
    if name not in rows:
        raise BadInput(f"{path}: has no row {name!r}; {nearest_of(name, rows) if rows else 'it is empty'}")
    text = rows[name][0] if rows[name] else ""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 < value < math.inf:
        raise BadInput(f"{path}: {name}: is {text[:LONGEST_SHOWN]!r}; give a number above zero")
    return value
