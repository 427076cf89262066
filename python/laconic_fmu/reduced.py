"""A description without the variables that a vehicle does not need, and with the dependencies that it has."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Callable, Mapping
from copy import deepcopy
from dataclasses import replace

from .description import Description, Unknown, Variable, as_double

EVERYTHING = None
Dependencies = Mapping[str, tuple[str, ...] | None]
"""By an unknown's name what it depends on; EVERYTHING where all known variables act on it."""


def is_above_0(description: Description, names: tuple[str, ...]) -> bool:
    """Whether a start value of one of these variables is above 0."""
    given = [v for v in description.variables if v.name in names]
    return any(as_double(text) > 0.0 for v in given for text in v.start)


def reduced(description: Description, kept: Callable[[Variable], bool],
            depends: Dependencies | None = None) -> Description:
    """The description with the variables that are `kept`. `depends`: what differs from its own dependencies."""
    names = {v.reference: v.name for v in description.variables}
    variables = tuple(v for v in description.variables if kept(v))
    left = {v.reference for v in variables}
    unknowns = tuple(_depending(description, u, names[u.reference], depends or {})
                     for u in description.unknowns if u.reference in left)
    root = deepcopy(description.root)
    _shorten(root, {v.name for v in variables}, unknowns)
    return replace(description, root=root, variables=variables, unknowns=unknowns)


def without_model_exchange(description: Description) -> Description:
    """The description for Co-Simulation alone."""
    root = deepcopy(description.root)
    for interface in root.findall("ModelExchange"):
        root.remove(interface)
    return replace(description, root=root)


def _depending(description: Description, unknown: Unknown, name: str, depends: Dependencies) -> Unknown:
    if name not in depends:
        return unknown
    names = depends[name]
    if unknown.tag == "InitialUnknown" or names is EVERYTHING:
        return replace(unknown, dependencies=None, kinds=None)
    references = tuple(description.variable(each).reference for each in names)
    kind = "constant" if len(names) == 1 else "dependent"
    return replace(unknown, dependencies=references, kinds=(kind,) * len(names))


def _shorten(root: ET.Element, names: set[str], unknowns: tuple[Unknown, ...]) -> None:
    """Takes the other variables out, and writes the structure anew."""
    variables, structure = root.find("ModelVariables"), root.find("ModelStructure")
    assert variables is not None
    assert structure is not None
    for element in list(variables):
        if element.get("name") not in names:
            variables.remove(element)
    structure.clear()
    for unknown in unknowns:
        attributes = {"valueReference": str(unknown.reference)}
        if unknown.dependencies is not None:
            attributes["dependencies"] = " ".join(map(str, unknown.dependencies))
        if unknown.kinds is not None:
            attributes["dependenciesKind"] = " ".join(unknown.kinds)
        ET.SubElement(structure, unknown.tag, attributes)
