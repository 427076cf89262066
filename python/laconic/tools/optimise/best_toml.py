"""The scene with the values found: the file's own text, comments and order kept, with the numbers exchanged."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from laconic.scene.key_path import EVERY, KeyPath, key_path
from laconic.scene.scene_tables import SceneTables
from laconic.scene.scene_text import value_text
from laconic.scene.table import entries_of
from laconic.tools.optimise.candidates import values_of
from laconic.tools.optimise.study import Result

HEADER = re.compile(r"\s*\[(\[?)\s*([\w.]+)\s*\]?\]\s*(?:#.*)?$")
LINE = r"(\s*{key}\s*=\s*)([-+.\w]+)\s*(?:#\s*(.*))?$"


def best_text(tables: SceneTables, result: Result) -> str:
    """A complete scene. Where the text is laid out unusually, it is written anew, without the file's own comments."""
    values = values_of(result.problem.free, result.best.choice)
    before = values_of(result.problem.free, result.before.choice)
    wanted, head = tables.with_values(values), _head(tables, result)
    text = _exchanged(tables.path.read_text(encoding="utf-8-sig"), values, before)
    if text is None or not _holds(text, wanted):
        text = wanted.toml()
    return "\n".join(head) + "\n" + text


def _head(tables: SceneTables, result: Result) -> list[str]:
    """What this scene is, in comments."""
    lines = [f"# {tables.path.name}, with numbers chosen by `laconic optimise`:"]
    for each, old, new in zip(result.problem.free, result.before.choice, result.best.choice, strict=True):
        lines.append(f"#   {each.key}: {new:.9g}, was {old:.9g}, between {each.low:g} and {each.high:g}")
    texts = {goal.measure: goal.text for goal in result.problem.goals}
    for name, old, new in zip(result.problem.measures, result.before.values, result.best.values, strict=True):
        bounds = [each.text for each in result.problem.constraints if each.measure == name]
        lines.append(f"#   {', '.join([*([texts[name]] if name in texts else []), *bounds])}: {new:.6g}, was {old:.6g}")
    return lines


def _exchanged(text: str, values: Mapping[str, float], before: Mapping[str, float]) -> str | None:
    """The text with each key's number exchanged; None where a key's line is not found."""
    lines = text.split("\n")
    for name, value in values.items():
        key = key_path(name)
        places = _places(lines, key)
        if not places:
            return None
        for at in reversed(places):
            if not _exchange(lines, at, key.name, value, before[name]):
                return None
    return "\n".join(lines)


def _places(lines: Sequence[str], key: KeyPath) -> list[range]:
    """The lines of the tables that hold the key."""
    name = ".".join(table for table, _ in key.tables)
    items = [item for _, item in key.tables if item is not None]
    found: list[range] = []
    headers = [(at, match) for at, line in enumerate(lines) if (match := HEADER.match(line))]
    for (at, match), end in zip(headers, [*(at for at, _ in headers[1:]), len(lines)], strict=True):
        if match[2] == name:
            found.append(range(at + 1, end))
    if not items or items == [EVERY]:
        return found
    return [found[items[-1] - 1]] if len(items) == 1 and items[0] <= len(found) else []


def _exchange(lines: list[str], place: range, name: str, value: float, old: float) -> bool:
    """Writes a value into its line, or into a new one where the table has none."""
    for at in place:
        if match := re.match(LINE.format(key=re.escape(name)), lines[at]):
            comment = f"; {match[3]}" if match[3] else ""
            lines[at] = f"{match[1]}{value_text(value)}  # was {match[2]}{comment}"
            return True
    if any(re.match(rf"\s*{re.escape(name)}\b", lines[at]) for at in place):
        return False  # a list, or a dotted key
    lines.insert(place.start, f"{name} = {value_text(value)}  # was {old:g}")
    return True


def _holds(text: str, wanted: SceneTables) -> bool:
    """Whether a text reads as these tables."""
    try:
        return entries_of(text) == wanted.entries
    except ValueError:
        return False
