"""The FMI 2.0 description."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Sequence
from copy import deepcopy

from .description import Description, element_reference, with_token
from .scalars import Scalar, ScalarUnknown, scalars, unknowns

TYPES = {"Float64": "Real", "Int32": "Integer", "Int64": "Integer", "UInt64": "Integer",
         "Enumeration": "Enumeration", "Boolean": "Boolean"}
INTERPOLATES = {"true": {"canInterpolateInputs": "true"}, "false": {}}
"""FMI 2.0 sets derivatives of inputs where FMI 3.0 sets the inputs between internal steps."""
HEADER = ("modelName", "description", "author", "version", "copyright", "license", "generationTool",
          "variableNamingConvention")


def _interface(parent: ET.Element, tag: str, source: ET.Element, extra: dict[str, str],
               source_files: Sequence[str]) -> None:
    attributes = {"modelIdentifier": source.get("modelIdentifier", ""), "canGetAndSetFMUstate": "true",
                  "canSerializeFMUstate": "true", **extra}
    if source.get("providesDirectionalDerivatives") == "true":
        attributes["providesDirectionalDerivative"] = "true"
    element = ET.SubElement(parent, tag, attributes)
    if source_files:
        files = ET.SubElement(element, "SourceFiles")
        for name in source_files:
            ET.SubElement(files, "File", {"name": name})


def _types(parent: ET.Element, source: ET.Element) -> None:
    for kind in source:
        simple = ET.SubElement(parent, "SimpleType", {k: kind.get(k, "") for k in ("name", "description")})
        if kind.tag == "Float64Type":
            ET.SubElement(simple, "Real", {k: kind.attrib[k] for k in ("unit", "displayUnit") if k in kind.attrib})
            continue
        enumeration = ET.SubElement(simple, "Enumeration")
        for item in kind:
            ET.SubElement(enumeration, "Item", dict(item.attrib))


def _variable(parent: ET.Element, scalar: Scalar, index: dict[int, int]) -> None:
    variable = scalar.variable
    attributes = {"name": scalar.name, "valueReference": str(scalar.reference), "description": scalar.text}
    if variable.causality == "structuralParameter":
        attributes |= {"causality": "local", "variability": "constant", "initial": "exact"}
    else:
        own = variable.attributes
        attributes |= {k: own[k] for k in ("causality", "variability", "initial") if k in own}
    if attributes.get("causality") == "input":
        attributes.pop("initial", None)
    element = ET.SubElement(parent, "ScalarVariable", attributes)
    typed = {k: variable.attributes[k] for k in ("declaredType", "min", "max", "nominal") if k in variable.attributes}
    if "derivative" in variable.attributes:
        typed["derivative"] = str(index[element_reference(int(variable.attributes["derivative"]), scalar.element)])
    if scalar.start is not None:
        typed["start"] = scalar.start
    ET.SubElement(element, TYPES[variable.tag], typed)


def _structure(parent: ET.Element, tag: str, entries: Sequence[ScalarUnknown], index: dict[int, int]) -> None:
    if not entries:
        return
    group = ET.SubElement(parent, tag)
    for entry in sorted(entries, key=lambda e: index[e.scalar.reference]):
        attributes = {"index": str(index[entry.scalar.reference])}
        if entry.dependencies is not None:
            kinds = entry.kinds or ("dependent",) * len(entry.dependencies)
            pairs = sorted((index[k.reference], kind) for k, kind in zip(entry.dependencies, kinds, strict=True))
            attributes["dependencies"] = " ".join(str(number) for number, _ in pairs)
            allowed = tag != "InitialUnknowns"
            attributes["dependenciesKind"] = " ".join(kind if allowed else "dependent" for _, kind in pairs)
        ET.SubElement(group, "Unknown", attributes)


def describe(description: Description, source_files: Sequence[str] = ()) -> str:
    """The description as text, with its GUID."""
    source = description.root
    attributes = {"fmiVersion": "2.0", "guid": ""} | {k: source.attrib[k] for k in HEADER if k in source.attrib}
    root = ET.Element("fmiModelDescription", attributes | {"numberOfEventIndicators": "0"})
    exchange, simulation = source.find("ModelExchange"), source.find("CoSimulation")
    if exchange is not None:
        _interface(root, "ModelExchange", exchange, {}, source_files)
    if simulation is not None:
        interpolates = INTERPOLATES[simulation.get("providesIntermediateUpdate", "false")]
        extra = {"canHandleVariableCommunicationStepSize": "true", **interpolates,
                 "maxOutputDerivativeOrder": simulation.get("maxOutputDerivativeOrder", "0")}
        _interface(root, "CoSimulation", simulation, extra, source_files)
    for tag in ("UnitDefinitions", "TypeDefinitions", "LogCategories", "DefaultExperiment"):
        part = source.find(tag)
        if part is None:
            continue
        if tag == "TypeDefinitions":
            _types(ET.SubElement(root, tag), part)
        else:
            root.append(deepcopy(part))
    # FMI 2.0 does not require the time as a variable, and FMI Library, which several importers use, fails on it
    everything = [scalar for scalar in scalars(description) if scalar.variable.causality != "independent"]
    index = {scalar.reference: number for number, scalar in enumerate(everything, start=1)}
    variables = ET.SubElement(root, "ModelVariables")
    for scalar in everything:
        _variable(variables, scalar, index)
    structure = ET.SubElement(root, "ModelStructure")
    for tag, kind in (("Outputs", "Output"), ("Derivatives", "ContinuousStateDerivative"),
                      ("InitialUnknowns", "InitialUnknown")):
        _structure(structure, tag, unknowns(description, kind), index)
    ET.indent(root)
    return with_token(f'<?xml version="1.0" encoding="UTF-8"?>\n{ET.tostring(root, encoding="unicode")}\n')
