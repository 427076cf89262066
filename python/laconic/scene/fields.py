"""One key of a scene by its row in the core's list of fields."""

from __future__ import annotations

from typing import Any

from laconic.core import Field
from laconic.scene.table import Table


def read_field(table: Table, field: Field, default: Any = ..., *, finite: bool = False) -> Any:
    """One key of a table by its row in the core's list of fields; the core checks its value."""
    if field.kind in ("FLAG", "ABSENCE"):
        return table.flag(field.key, default if default is ... else bool(default))
    if field.key.endswith("_rad"):
        return table.angle(field.key.removesuffix("_rad"), default, finite=finite)
    return table.number(field.key, default, finite=finite)
