"""The keys of a scene file, from where the program itself knows them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from xml.etree import ElementTree

from laconic.scene.keys import TABLES
from laconic.scene.reference import Row, rows

HEAD = ("# Scene keys\n\nMade from the lists by which the program reads a scene. [Scenes](scenes.md) has an example "
        "with most of them. An angle may be given in degrees, its key then ends in `_deg`. A key that is not here is "
        "refused. What inputs may set and outputs may list: [signals](signals.md).")


def scene_page(source: Path) -> str:
    """A part for each table of a scene."""
    words, methods = descriptions(source)
    found = list(rows(words, methods))
    parts = [HEAD]
    for table, what in TABLES.items():
        of_table = [row for row in found if row.table == table]
        parts.append(f"## {_head(table)}\n\n{what}" + (f"\n\n{_table(of_table)}" if of_table else ""))
        parts += [_choices(row) for row in of_table if row.choices]
    return "\n\n".join(parts) + "\n"


def descriptions(source: Path) -> tuple[Mapping[str, str], Mapping[str, str]]:
    """The words of each variable of the FMU, and of each method."""
    root = ElementTree.parse(source / "modelDescription.xml").getroot()
    variables = {each.get("name", ""): each.get("description", "") for each in root.iterfind(".//ModelVariables/*")}
    items = root.iterfind(".//EnumerationType[@name='Method']/Item")
    return variables, {each.get("name", ""): each.get("description", "") for each in items}


def _head(table: str) -> str:
    if not table:
        return "Top"
    return f"`[[{table.removesuffix('[#]')}]]`" if table.endswith("[#]") else f"`[{table.replace('[#]', '')}]`"


def _table(of_table: Iterable[Row]) -> str:
    lines = ["| key | value | unit | range | if not given | meaning |", "| --- | --- | --- | --- | --- | --- |"]
    for row in of_table:
        key = f"`{row.key}`" + (f" or `{row.key.removesuffix('_rad')}_deg`" if row.unit == "rad" else "")
        cells = (key, row.kind, row.unit, row.range, row.default, row.meaning)
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(lines)


def _choices(row: Row) -> str:
    words = "\n".join(f"* `{word}`: {meaning[:1].lower() + meaning[1:] if row.key == 'method' else meaning}"
                      for word, meaning in row.choices.items())
    return f"`{row.key}` is one of\n\n{words}"
