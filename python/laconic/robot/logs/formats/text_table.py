"""A text log as a table of numbers; whatever is no number is one line that names the file's line.

A blank cell is a value that was not recorded on that line, as in topics that were joined by their times; it becomes
NaN. So does NaN itself where all columns of a quantity have it.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from laconic.base.text_file import TextOfFile, text_of_file
from laconic.errors import BadInput, nearest_of, shown
from laconic.robot.logs.column_map import ColumnMap
from laconic.robot.logs.quantity import Column

LONGEST_SHOWN = 40
MOST_LISTED = 20
WANTED = "a recorded run as CSV"


@dataclass(frozen=True)
class TextTable:
    """The names of the columns (none: the log has no line of names) and the rows as text, each with its line."""

    path: Path
    names: list[str]
    rows: list[list[str]]
    lines: list[int]
    decimal: str = "."
    remarks: tuple[str, ...] = ()
    keyword_column: int = 0     # from 1; 0: no line has a word that says what it holds

    def indices_of(self, columns: Sequence[Column], quantity: str) -> list[int]:
        """Where columns stand, from 0; BadInput names the quantity that needs them."""
        found = [self.index_of(column, quantity) for column in columns]
        for number, index in enumerate(found):
            if index in found[:number]:
                raise BadInput(f"{self.path}: {quantity} takes column {index + 1} by its name and by its number; give "
                               "each column once in the map")
        return found

    def index_of(self, column: Column, quantity: str) -> int:
        """Where a column stands, from 0; BadInput names the quantity that needs it."""
        if isinstance(column, int):
            if column > max(map(len, self.rows[:1] if not self.keyword_column else self.rows)):
                raise BadInput(f"{self.path}: line {self.lines[0]}: has {len(self.rows[0])} columns, no column "
                               f"{column} (for {quantity}); correct the column map with --map")
            return column - 1
        if self.names.count(column) > 1:
            places = [str(number) for number, name in enumerate(self.names, start=1) if name == column]
            raise BadInput(f"{self.path}: has the name {column!r} (for {quantity}) on the columns "
                           f"{', '.join(places[:-1])} and {places[-1]}; give the number of the right one in the map "
                           "instead of the name")
        if column not in self.names:
            near = nearest_of(column, self.names, f"it has {_listed(self.names)}")
            raise BadInput(f"{self.path}: has no column {shown(column)} (for {quantity}); correct the column map with "
                           f"--map ({near})")
        return self.names.index(column)

    def label(self, index: int) -> str:
        """How messages name a column."""
        return repr(self.names[index]) if index < len(self.names) and self.names[index] else f"column {index + 1}"

    def cells(self, indices: Sequence[int]) -> list[list[str]]:
        """Some columns as text, one row for each line; empty where a line ends before."""
        return [[texts[index].strip() if index < len(texts) else "" for index in indices] for texts in self.rows]

    def numbers(self, indices: Sequence[int], quantity: str, *, may_be_blank: bool = False,
                keyword: str = "") -> np.ndarray:
        """Some columns as numbers, one row for each line; NaN for what is blank, where that is allowed, and for lines
        with another keyword."""
        out = np.full((len(self.rows), len(indices)), math.nan)
        for row, (line, texts) in enumerate(zip(self.lines, self.rows, strict=True)):
            if keyword and keyword_of(texts, self.keyword_column) != keyword:
                continue
            try:
                values = [number_of(texts[index], self.decimal) for index in indices]
            except (ValueError, IndexError):
                values = [math.nan]
            out[row] = values if math.isfinite(sum(values)) else self._line(line, texts, indices, quantity,
                                                                           may_be_blank)
        return out

    def _line(self, line: int, texts: Sequence[str], indices: Sequence[int], quantity: str,
              may_be_blank: bool) -> list[float]:
        """The numbers of a line that has something else; BadInput for what is neither a number nor blank."""
        try:
            values = [math.nan if may_be_blank and not texts[index].strip() else number_of(texts[index], self.decimal)
                      for index in indices]
        except (ValueError, IndexError):
            raise BadInput(f"{self.path}: line {line}: no number for {quantity} "
                           f"({self._wrong(texts, indices, may_be_blank)}); remove the line or repair it") from None
        if may_be_blank and all(map(math.isnan, values)):
            return values
        for index, value in zip(indices, values, strict=True):
            if not math.isfinite(value) and not (may_be_blank and not texts[index].strip()):
                blank = ", or leave its cell blank where nothing was recorded" if may_be_blank else ""
                raise BadInput(f"{self.path}: line {line}: {quantity} is not finite; remove the line or repair it"
                               f"{blank}")
        return values

    def _wrong(self, texts: Sequence[str], indices: Sequence[int], may_be_blank: bool) -> str:
        for index in indices:
            if index >= len(texts):
                return f"the line has {len(texts)} columns"
            if may_be_blank and not texts[index].strip():
                continue
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


def text_of(path: Path) -> TextOfFile:
    """The file's text; one packed by gzip is unpacked."""
    return text_of_file(path, WANTED, so=", so it is no CSV text")


def rows_of(path: Path, text: TextOfFile, separator: str) -> Iterator[tuple[int, list[str]]]:
    """All lines, split, each with its number."""
    reader = csv.reader(text.lines[:-1] if text.is_cut else text.lines, delimiter=separator)
    last = 0
    try:
        for row in reader:
            yield last + 1, row
            last = reader.line_num
    except csv.Error:
        raise BadInput(f"{path}: line {last + 1}: is no CSV text; give {WANTED}") from None


def read_text(path: Path, columns: ColumnMap) -> TextTable:
    """The table of a log; BadInput where there are no samples."""
    text = text_of(path)
    lines = list(rows_of(path, text, columns.separator))
    head = columns.header_lines
    numbered = [(number, row) for number, row in lines[head:] if any(cell.strip() for cell in row)]
    if not numbered:
        raise BadInput(f"{path}: has no samples after {head} header lines; give a recorded run")
    names = [name.strip() for name in lines[columns.names_line - 1][1]] if columns.names_line else []
    if columns.keyword_column:
        numbered = _with_keywords(path, columns, numbered)
    else:
        _refuse_surplus(path, numbered, "the line of names" if names else "the first line",
                        len(names or numbered[0][1]))
    remark = text.remark()
    return TextTable(path, names, [row for _, row in numbered], [number for number, _ in numbered], columns.decimal,
                     () if remark is None else (remark,), columns.keyword_column)


def keyword_of(row: Sequence[str], column: int) -> str:
    """The word that says what a line holds; empty where the line ends before it."""
    return row[column - 1].strip() if column <= len(row) else ""


def _with_keywords(path: Path, columns: ColumnMap,
                   numbered: Sequence[tuple[int, list[str]]]) -> list[tuple[int, list[str]]]:
    """The lines whose keyword a quantity names; BadInput for a keyword that no line has."""
    wanted = {each.keyword for each in columns.quantities.values() if each.keyword}
    there = dict.fromkeys(keyword_of(row, columns.keyword_column) for _, row in numbered)
    for word in sorted(wanted - set(there)):
        raise BadInput(f"{path}: no line has {shown(word)} in column {columns.keyword_column}; correct rows in the map "
                       f"({nearest_of(word, there, f'the lines have {_listed(list(there))}')})")
    return [(number, row) for number, row in numbered if keyword_of(row, columns.keyword_column) in wanted]


def _refuse_surplus(path: Path, numbered: Sequence[tuple[int, list[str]]], first: str, width: int) -> None:
    """A line with more cells than there are columns: two lines in one, or a separator inside a number."""
    for number, row in numbered:
        if any(cell.strip() for cell in row[width:]):
            raise BadInput(f"{path}: line {number}: has {len(row)} columns, {first} {width}; repair the "
                           "line, or the separator in the map")


def metadata_of(path: Path) -> dict[str, list[list[str]]]:
    """A file of rows, by the name of each in its first column."""
    found: dict[str, list[list[str]]] = {}
    try:
        for _, row in rows_of(path, text_of(path), ","):
            if row:
                found.setdefault(row[0].strip(), []).append([cell.strip() for cell in row[1:]])
    except BadInput as error:
        raise BadInput(f"{error} (the column map takes gear or encoder from there)") from None
    return found


def metadata_number(path: Path, rows: dict[str, list[list[str]]], name: str) -> float:
    """A number above zero from it."""
    if name not in rows:
        raise BadInput(f"{path}: has no row {name!r}; {nearest_of(name, rows) if rows else 'it is empty'}")
    if len(rows[name]) > 1:
        raise BadInput(f"{path}: has {len(rows[name])} rows {name!r}; keep one of them")
    text = rows[name][0][0] if rows[name][0] else ""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 < value < math.inf:
        raise BadInput(f"{path}: {name}: is {shown(text[:LONGEST_SHOWN])}; give a number above zero")
    return value
