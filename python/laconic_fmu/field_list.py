"""The core's lists of fields (vehicle.h, sensors.h), compared with a description's variables before FMUs are built."""

from __future__ import annotations

import re
from pathlib import Path

from .description import Description

LIST = re.compile(r"^#define LACONIC_(\w+)_FIELDS?\(X, of\) *\\\n((?:.*\\\n)*.*)", re.MULTILINE)
ROW = re.compile(r"\bX\(of, *\d+, *(\w+), *\w+,[\s\\]*(\w+),")
NO_VARIABLES = ("MOTOR",)  # a scene's motor at its shaft, which laconic_motor_fit() turns into gain and damping


def rows_in(header: str) -> list[tuple[str, str]]:
    """Identifier and variable of each row of the lists; `header` is the text of such a header."""
    lists = [rows for name, rows in LIST.findall(header) if name not in NO_VARIABLES]
    return [row for rows in lists for row in ROW.findall(rows)]


def missing_variable(header: Path, source: Path, description: Description) -> str:
    """One line for the first row of the list that has no variable, with the remedy; "" where every row has one."""
    rows = rows_in(header.read_text(encoding="utf-8"))
    if not rows:
        return f"{header}: holds no rows X(of, number, IDENTIFIER, member, name, …); give the core's list of fields"
    names = {variable.name for variable in description.variables}
    for identifier, name in rows:
        if name not in names:
            return (f"{header}: the row {identifier} has no variable {name} in {source}; add one there, with its "
                    f"description and unit, and run python -m laconic_fmu renew-token {source}")
    return ""
