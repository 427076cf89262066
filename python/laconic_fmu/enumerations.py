"""Descriptions for importers that know no enumerations: whole numbers, with what each stands for in the text."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

from .description import Description, Variable

NUMBER = "Int64"
"""The FMI 3 type whose functions get and set enumerations, too, so that the binary stays the same."""


def _plain(description: Description, variable: Variable) -> Variable:
    if variable.tag != "Enumeration":
        return variable
    items = description.items(variable)
    meaning = ", ".join(f"{value} {name}" for value, (name, _) in sorted(items.items()))
    attributes = {k: v for k, v in variable.attributes.items() if k != "declaredType"}
    return replace(variable, tag=NUMBER, description=f"{variable.description}: {meaning}",
                   attributes=attributes | {"min": str(min(items)), "max": str(max(items))})


def without_enumerations(description: Description) -> Description:
    """The same description with integers instead of enumerations."""
    variables = tuple(_plain(description, variable) for variable in description.variables)
    root = ET.fromstring(ET.tostring(description.root))
    types = root.find("TypeDefinitions")
    for kind in list(types if types is not None else ()):
        if kind.tag == "EnumerationType" and types is not None:
            types.remove(kind)
    for element, variable in zip(root.find("ModelVariables") or (), variables, strict=True):
        if element.tag != variable.tag:
            element.tag = variable.tag
            element.attrib.pop("declaredType")
            element.attrib |= {key: variable.attributes[key] for key in ("min", "max")}
            element.set("description", variable.description)
    return Description(root, variables, description.unknowns)


# ---- The core's lists of fields (vehicle.h, sensors.h), compared with a description's variables before FMUs are
# built.

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
