"""The scene with the values found: the file's own text, comments and order kept, with the numbers exchanged."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from laconic.scene.key_path import EVERY, KeyPath, key_path
from laconic.scene.scene_tables import SceneTables
from laconic.scene.scene_text import Comments, rewritten, value_text
from laconic.tools.optimise.candidates import values_of
from laconic.tools.optimise.study import Result


def best_text(tables: SceneTables, result: Result) -> str:
    """A complete scene. Where the text is laid out unusually, it is written anew, without the file's own comments."""
    wanted = tables.with_values(values_of(result.problem.free, result.best.choice))
    old = _old_values(tables, values_of(result.problem.free, result.before.choice))
    text = rewritten(tables.path.read_text(encoding="utf-8-sig"), wanted.entries, old)
    return "\n".join(_head(tables, result)) + "\n" + text


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


def _old_values(tables: SceneTables, before: Mapping[str, float]) -> Comments:
    """What the file says at each key that is free, or what stood for it where the file leaves it out."""
    found: Comments = {}
    for name, value in before.items():
        key = key_path(name)
        for location, table in _tables(tables.entries, key):
            old = table.get(key.name, value)
            found[(*location, key.name)] = f"was {value_text(old)}"
    return found


def _tables(entries: Mapping[str, Any], key: KeyPath) -> list[tuple[tuple[str, ...], Any]]:
    """The tables that hold a key, each with its location."""
    found: list[tuple[tuple[str, ...], Any]] = [((), entries)]
    for name, item in key.tables:
        found = [((*location, name), table.get(name, {})) for location, table in found]
        if item is not None:
            found = [((*location, str(at)), each) for location, rows in found for at, each in enumerate(rows)
                     if item in (EVERY, at + 1)]
    return found
