"""Descriptions for importers that know no enumerations: whole numbers, with what each stands for in the text."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import replace

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
