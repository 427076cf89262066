"""Tables of scene files for tests, as TOML text."""

from __future__ import annotations

import json


def table(head: str, **entries: object) -> str:
    """A table such as "[vehicle]"; values are numbers, texts, flags or lists."""
    return "".join([f"{head}\n", *(f"{key} = {json.dumps(value)}\n" for key, value in entries.items())])


def wheel(kind: str, x_m: float, y_m: float, **entries: object) -> str:
    """One `[[vehicle.wheel]]`."""
    return table("[[vehicle.wheel]]", kind=kind, x_m=x_m, y_m=y_m, **entries)


def constant(signal: str, value: float) -> str:
    """An `[[input]]` that holds one value."""
    return table("[[input]]", signal=signal, kind="steps", t_s=[0.0], value=[value])
