"""Tables of scene files for tests, as TOML text."""

from __future__ import annotations

import json

from laconic.scene import read_scene, rigid_scene_names
from laconic.scene.ground import has_friction


def ideal_scene_names() -> list[str]:
    """Names of the project's scenes on ideal ground, whose equation is (4.7)."""
    return [name for name in rigid_scene_names() if not has_friction(read_scene(name).vehicle)]


def table(head: str, **entries: object) -> str:
    """A table such as "[vehicle]"; values are numbers, texts, flags or lists."""
    return "".join([f"{head}\n", *(f"{key} = {json.dumps(value)}\n" for key, value in entries.items())])


def wheel(kind: str, x_m: float, y_m: float, **entries: object) -> str:
    """One `[[vehicle.wheel]]`."""
    return table("[[vehicle.wheel]]", kind=kind, x_m=x_m, y_m=y_m, **entries)


def constant(signal: str, value: float) -> str:
    """An `[[input]]` that holds one value."""
    return table("[[input]]", signal=signal, kind="steps", t_s=[0.0], value=[value])
