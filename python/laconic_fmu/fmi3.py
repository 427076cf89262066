"""FMI 3.0 descriptions with other start values than the source's, with arrays or without."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from copy import deepcopy

from .description import Description, Variable, element_reference, with_token
from .scalars import Scalar, scalars, unknowns

KINDS = ("Output", "ContinuousStateDerivative", "InitialUnknown")


def _text(root: ET.Element) -> str:
    ET.indent(root)
    return with_token(f'<?xml version="1.0" encoding="UTF-8"?>\n{ET.tostring(root, encoding="unicode")}\n')


def describe(description: Description) -> str:
    """With arrays, as the source has them."""
    root = deepcopy(description.root)
    starts = {variable.name: variable.start for variable in description.variables}
    for element in root.find("ModelVariables") or []:
        if starts[element.get("name", "")]:
            element.set("start", " ".join(starts[element.get("name", "")]))
    return _text(root)


def _attributes(variable: Variable, scalar: Scalar) -> dict[str, str]:
    attributes = {"name": scalar.name, "valueReference": str(scalar.reference), "description": scalar.text}
    attributes |= dict(variable.attributes)
    if variable.causality == "structuralParameter":
        attributes |= {"causality": "local", "variability": "constant", "initial": "exact"}
    if "derivative" in variable.attributes:
        attributes["derivative"] = str(element_reference(int(variable.attributes["derivative"]), scalar.element))
    if scalar.start is not None:
        attributes["start"] = scalar.start
    return attributes


def describe_scalar(description: Description) -> str:
    """Without arrays, for importers that handle them badly."""
    root = deepcopy(description.root)
    for tag in ("ModelVariables", "ModelStructure"):
        part = root.find(tag)
        assert part is not None
        part.clear()
    variables, structure = root.find("ModelVariables"), root.find("ModelStructure")
    assert variables is not None
    assert structure is not None
    for scalar in scalars(description):
        element = ET.SubElement(variables, scalar.variable.tag, _attributes(scalar.variable, scalar))
        if scalar.variable.tag == "Binary" and scalar.variable.causality == "input":
            ET.SubElement(element, "Start", {"value": ""})
    for kind in KINDS:
        for entry in unknowns(description, kind):
            attributes = {"valueReference": str(entry.scalar.reference)}
            if entry.dependencies is not None:
                attributes["dependencies"] = " ".join(str(known.reference) for known in entry.dependencies)
            if entry.kinds is not None:
                attributes["dependenciesKind"] = " ".join(entry.kinds)
            ET.SubElement(structure, kind, attributes)
    return _text(root)
