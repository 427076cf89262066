"""A scene from tables in a program instead of a file."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from laconic.errors import LONGEST_NAME, BadInput, cut, shown
from laconic.scene.scene import Scene, scene_of
from laconic.scene.table import Table, plain


def build_scene(tables: Mapping[str, Any]) -> Scene:
    """A scene from the tables that a scene file has (docs/scenes.md), as mappings and lists.

    `tables` needs "vehicle" and "run"; "name", "ground", "initial", "input", "outputs" … are as in a file, angles in
    rad or with `_deg` at the key's end; arrays stand for lists. Raises BadInput as `read_scene` does: it names the key.
    """
    if not isinstance(tables, Mapping):
        raise BadInput(f"scene: {shown(tables)} is no mapping; give the tables of a scene, such as {{\"vehicle\": …}}")
    given = tables.get("name")
    name = given[:LONGEST_NAME] if isinstance(given, str) and given else "scene"
    try:
        values = _values(tables)
    except RecursionError:
        raise BadInput(f"{cut(name)}: nests its tables too deeply, or one in itself; give those of a scene"
                       ) from None
    return scene_of(Table(Path(name.replace("/", "-")), "", values))


def _values(given: Any) -> Any:
    """What a TOML file could hold of it: dicts, lists, numbers, texts."""
    if isinstance(given, Mapping):
        return {str(key): _values(value) for key, value in given.items()}
    if isinstance(given, np.ndarray):
        return _values(given.tolist())
    if isinstance(given, list | tuple):
        return [_values(value) for value in given]
    return plain(given)
