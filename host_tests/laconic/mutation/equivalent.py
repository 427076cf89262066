"""The list of equivalents: mutants that no test can notice, each with its reason. Each source file has its own,
equivalents/<path of the source>.toml, with a row for each line and reason: the function (empty outside of any), the
line `before` as it stands, without comments and with single spaces, and every line with a fault, `after`. A row is
found by its text, so that other lines may come and go; the lines of one statement may stand as one. In `after`, `…`
stands for any text: tests notice what would be a fault there, and what they do not is none, for the reason. Faults that
none of the operators makes, which another sampler has found, have rows as well. laws.toml has what holds anywhere."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from laconic.errors import BadInput
from laconic.scene.table import entries_of

EQUIVALENTS = Path(__file__).parent / "equivalents"
LAWS = Path(__file__).parent / "laws.toml"


@dataclass(frozen=True)
class Equivalent:
    """One line with one fault that changes nothing, and why."""

    file: str
    function: str
    before: str
    after: str
    reason: str


def read_equivalents(folder: Path = EQUIVALENTS) -> list[Equivalent]:
    """The rows of all files, one for each `after`; BadInput for a row that is not complete."""
    return [each for path in sorted(folder.rglob("*.toml")) for each in _of(path, folder)]


def read_laws() -> dict[str, frozenset[str]]:
    """Names of the sources about which the laws of alike.py speak, by what is said of them."""
    return {said: frozenset(names) for said, names in entries_of(LAWS.read_text(encoding="utf-8")).items()}


def _of(path: Path, folder: Path) -> Iterator[Equivalent]:
    file = path.relative_to(folder).with_suffix("").as_posix()
    rows: list[dict[str, Any]] = entries_of(path.read_text(encoding="utf-8")).get("equivalent", [])
    for number, row in enumerate(rows, 1):
        if not _is_complete(row):
            raise BadInput(f"{path.name}: row {number}: needs function, before and reason, each a text, and after, a "
                           "list of texts")
        for after in row["after"]:
            yield Equivalent(file, row["function"], row["before"], after, row["reason"])


def _is_complete(row: dict[str, Any]) -> bool:
    texts, after = [row.get(key) for key in ("function", "before", "reason")], row.get("after")
    return (len(row) == 4 and all(isinstance(text, str) for text in texts) and bool(row["reason"].strip())
            and isinstance(after, list) and bool(after) and all(isinstance(each, str) for each in after))
