"""A text log as a table of numbers; whatever is no number is one line that names the file's line."""

from __future__ import annotations

import csv
import gzip
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from laconic.errors import BadInput, nearest_of, reason_of, shown
from laconic.logs.column_map import Column, ColumnMap

GZIP = b"\x1f\x8b"
LONGEST_SHOWN = 40
MOST_LISTED = 20
UTF_16 = (b"\xff\xfe", b"\xfe\xff")


@dataclass(frozen=True)
class TextTable:
    """The names of the columns (none: the log has no line of names) and the rows as text, each with its line."""

    path: Path
    names: list[str]
    rows: list[list[str]]
    lines: list[int]
    decimal: str = "."

    def index_of(self, column: Column, quantity: str) -> int:
        """Where a column stands, from 0; BadInput names the quantity that needs it."""
        if isinstance(column, int):
            if column > len(self.rows[0]):
                raise BadInput(f"{self.path}: line {self.lines[0]}: has {len(self.rows[0])} columns, no column "
                               f"{column} (for {quantity}); correct the column map with --map")
            return column - 1
        if column not in self.names:
            near = nearest_of(column, self.names, f"it has {_listed(self.names)}")
            raise BadInput(f"{self.path}: has no column {shown(column)} (for {quantity}); correct the column map with "
                           f"--map ({near})")
        return self.names.index(column)

    def numbers(self, indices: Sequence[int], quantity: str) -> np.ndarray:
        """Some columns as numbers, one row for each line."""
        out = np.empty((len(self.rows), len(indices)))
        for row, (line, texts) in enumerate(zip(self.lines, self.rows, strict=True)):
            try:
                out[row] = [number_of(texts[index], self.decimal) for index in indices]
            except (ValueError, IndexError):
                raise BadInput(f"{self.path}: line {line}: no number for {quantity} "
                               f"({self._wrong(texts, indices)}); remove the line or repair it") from None
        if not np.isfinite(out).all():
            line = self.lines[int(np.argmax(~np.isfinite(out).all(axis=1)))]
            raise BadInput(f"{self.path}: line {line}: {quantity} is not finite; remove the line or repair it")
        return out

    def _wrong(self, texts: Sequence[str], indices: Sequence[int]) -> str:
        for index in indices:
            if index >= len(texts):
                return f"the line has {len(texts)} columns"
            try:
                number_of(texts[index], self.decimal)
            except ValueError:
                return f"{shown(texts[index][:LONGEST_SHOWN])}{self._other_decimal(texts[index])}"
        return "overflow"

    def _other_decimal(self, text: str) -> str:
        """What to write in the map where the decimals are of the other kind."""
        other = "," if self.decimal == "." else "."
        try:
            number_of(text, other)
        except ValueError:
            return ""
        return f'; decimal = "{other}" in the map reads it'


def number_of(text: str, decimal: str) -> float:
    """ValueError for what is no number with this sign before its decimals."""
    if "_" in text or (decimal != "." and "." in text):
        raise ValueError(text)
    return float(text.replace(decimal, "."))


def _listed(names: Sequence[str]) -> str:
    """The names of columns, the first of them where there are many."""
    shown = [repr(name) for name in names if name]
    return ", ".join(shown[:MOST_LISTED]) + (" …" if len(shown) > MOST_LISTED else "") or "no names"


def text_of(path: Path) -> str:
    """The file's text; one packed by gzip is unpacked."""
    try:
        data = path.read_bytes()
        text = _decoded(gzip.decompress(data) if data.startswith(GZIP) else data)
    except (gzip.BadGzipFile, EOFError, OSError) as error:
        if isinstance(error, OSError) and error.strerror:
            raise BadInput(f"{path}: cannot be read ({reason_of(error)}); give the path of a recorded run") from None
        raise BadInput(f"{path}: is packed by gzip but broken or cut off; pack it again") from None
    except UnicodeDecodeError:
        raise BadInput(f"{path}: is no CSV text; give a recorded run as CSV") from None
    except Exception:  # zlib.error, which gzip does not wrap
        raise BadInput(f"{path}: is packed by gzip but broken or cut off; pack it again") from None
    if "\0" in text:
        raise BadInput(f"{path}: is no CSV text; give a recorded run as CSV")
    return text


def _decoded(data: bytes) -> str:
    """UTF-8, UTF-16 with its mark, or the 8 bits of Western Windows; UnicodeDecodeError for what is no text."""
    if data.startswith(UTF_16):
        return data.decode("utf-16")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        if any(byte < 32 and byte not in b"\t\n\r\f" for byte in data):
            raise
        return data.decode("cp1252")


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
    _refuse_surplus(path, numbered, "the line of names" if names else "the first line", len(names or numbered[0][1]))
    return TextTable(path, names, [row for _, row in numbered], [number for number, _ in numbered], columns.decimal)


def _refuse_surplus(path: Path, numbered: Sequence[tuple[int, list[str]]], first: str, width: int) -> None:
    """A line with more cells than there are columns: two lines in one, or a separator inside a number."""
    for number, row in numbered:
        if any(cell.strip() for cell in row[width:]):
            raise BadInput(f"{path}: line {number}: has {len(row)} columns, {first} {width}; repair the "
                           "line, or the separator in the map")


def metadata_of(path: Path) -> dict[str, list[str]]:
    """A file of rows, the name of each in its first column."""
    try:
        return {row[0].strip(): [cell.strip() for cell in row[1:]] for row in rows_of(path, ",") if row}
    except BadInput as error:
        raise BadInput(f"{error} (the column map takes gear or encoder from there)") from None


def metadata_number(path: Path, rows: dict[str, list[str]], name: str) -> float:
    """A number above zero from it."""
    if name not in rows:
        raise BadInput(f"{path}: has no row {shown(name)}; {nearest_of(name, rows) if rows else 'it is empty'}")
    text = rows[name][0] if rows[name] else ""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 < value < math.inf:
        raise BadInput(f"{path}: {name}: is {shown(text[:LONGEST_SHOWN])}; give a number above zero")
    return value
