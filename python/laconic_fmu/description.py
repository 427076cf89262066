"""The FMI 3.0 description, read into rows: the one source of names, value references and start values."""

from __future__ import annotations

import hashlib
import re
import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path

ELEMENT_SHIFT = 10
"""Element i of the array with the value reference v has the reference (v << ELEMENT_SHIFT) + i."""


def element_reference(reference: int, element: int) -> int:
    """The value reference of an array's element from 1; of the whole, or a scalar, for element 0."""
    return (reference << ELEMENT_SHIFT) + element if element else reference


ELEMENTWISE = {("wheel_torque_Nm", "voltage_V"), ("wheel_torque_Nm", "axle_torque_Nm")} | {
    (unknown, known) for unknown in ("voltage_V", "der(angle_error_rad)")
    for known in ("setpoint_rad_per_s", "wheel_speed_rad_per_s", "angle_error_rad")} | {
    (unknown, "wheel_speed_rad_per_s")
    for unknown in ("der(wheel_angle_rad)", "slip_along_m_per_s", "slip_across_m_per_s")}
"""Outputs (first) of which each element depends on the same element of the other array only."""

INTERFACE_ATTRIBUTES = ("causality", "variability", "initial", "intermediateUpdate", "declaredType", "min", "max",
                        "nominal", "derivative", "intervalVariability", "clocks", "maxSize", "mimeType")


@dataclass(frozen=True)
class Variable:
    """One variable of the description."""

    tag: str
    name: str
    reference: int
    description: str
    attributes: Mapping[str, str]
    size: int | str | None
    """None: a scalar; a number: so many elements; otherwise the name of the structural parameter that sets it."""
    start: tuple[str, ...]

    @property
    def causality(self) -> str:
        """Its causality, with the standard's default."""
        return self.attributes.get("causality", "local")


@dataclass(frozen=True)
class Unknown:
    """One entry of ModelStructure; `dependencies` is None where it depends on everything."""

    tag: str
    reference: int
    dependencies: tuple[int, ...] | None
    kinds: tuple[str, ...] | None


@dataclass(frozen=True)
class Description:
    """A whole description."""

    root: ET.Element = field(repr=False)
    variables: tuple[Variable, ...]
    unknowns: tuple[Unknown, ...]

    def variable(self, name: str) -> Variable:
        """The variable of that name."""
        return next(v for v in self.variables if v.name == name)

    @property
    def array_parameters(self) -> tuple[Variable, ...]:
        """The structural parameters that set the sizes of arrays."""
        return tuple(v for v in self.variables if v.causality == "structuralParameter")

    @property
    def array_parameter(self) -> Variable | None:
        """The first of them."""
        return next(iter(self.array_parameters), None)

    @property
    def array_size(self) -> int:
        """Its start value; 0 without one."""
        parameter = self.array_parameter
        return int(parameter.start[0]) if parameter else 0

    def items(self, variable: Variable) -> dict[int, tuple[str, str]]:
        """An enumeration's values, with the name and the description of each."""
        kind = self.root.find(f"TypeDefinitions/EnumerationType[@name='{variable.attributes['declaredType']}']")
        return {int(item.get("value", "")): (item.get("name", ""), item.get("description", "")) for item in kind or []}

    def elements(self, variable: Variable) -> int | None:
        """How many elements the variable has in this description; None for a scalar."""
        return int(self.variable(variable.size).start[0]) if isinstance(variable.size, str) else variable.size


def _variable(element: ET.Element, names: Mapping[int, str]) -> Variable:
    dimensions = element.findall("Dimension")
    size: int | str | None = None
    if dimensions:
        (dimension,) = dimensions
        size = int(dimension.get("start", 0)) or names[int(dimension.get("valueReference", -1))]
    return Variable(element.tag, element.get("name", ""), int(element.get("valueReference", -1)),
                    element.get("description", ""),
                    {key: element.get(key, "") for key in INTERFACE_ATTRIBUTES if key in element.attrib}, size,
                    tuple(element.get("start", "").split()))


def _numbers(text: str | None) -> tuple[int, ...] | None:
    return None if text is None else tuple(int(word) for word in text.split())


@lru_cache(maxsize=8)
def parse(text: str) -> Description:
    """Reads a description; fails where the value references are not 0, 1, 2 … in order.

    Its root is shared with later calls: whoever changes it copies it first.
    """
    root = ET.fromstring(text)
    ET.indent(root)  # joins the pieces of what stands between elements, which is copied far faster then
    elements = list(root.find("ModelVariables") or [])
    names = {int(e.get("valueReference", -1)): e.get("name", "") for e in elements}
    variables = tuple(_variable(element, names) for element in elements)
    for number, variable in enumerate(variables):
        if number == 0 and variable.size is not None:
            raise ValueError(f"{variable.name}: the first variable is no array: its elements would have no references")
        if variable.reference != number:
            raise ValueError(f"{variable.name}: its value reference is {variable.reference}, but it is number {number} "
                             "in the list: new variables go to the end")
    unknowns = tuple(
        Unknown(e.tag, int(e.get("valueReference", -1)), _numbers(e.get("dependencies")),
                tuple(e.get("dependenciesKind", "").split()) if "dependenciesKind" in e.attrib else None)
        for e in root.find("ModelStructure") or [])
    return Description(root, variables, unknowns)


def read(path: Path) -> Description:
    """Reads the description in a file."""
    return parse(path.read_text(encoding="utf-8"))


def with_values(description: Description, values: Mapping[str, Sequence[float]], model_name: str,
                text: str) -> Description:
    """The same description with other start values: a scene's."""
    unknown = set(values) - {v.name for v in description.variables}
    if unknown:
        raise ValueError(f"no such variables: {', '.join(sorted(unknown))}")
    sizes = {v.name: int(values[v.name][0] if v.name in values else v.start[0]) for v in description.array_parameters}
    variables = []
    for variable in description.variables:
        start = variable.start
        if variable.name in values:
            start = tuple(number(value, variable.tag) for value in values[variable.name])
        elif isinstance(variable.size, str) and start:
            start = (start[0],) * sizes[variable.size]
        variables.append(replace(variable, start=start))
    root = deepcopy(description.root)
    root.set("modelName", model_name)
    root.set("description", text)
    return Description(root, tuple(variables), description.unknowns)


def identifier_in(root: ET.Element) -> str:
    """The model identifier that a description has."""
    return root.find("CoSimulation").get("modelIdentifier", "")  # type: ignore[union-attr]


def with_identifier(description: Description, identifier: str) -> Description:
    """The same description with another model identifier: each variant of an FMU has its own."""
    interfaces = ("ModelExchange", "CoSimulation")
    if all(each.get("modelIdentifier") == identifier for tag in interfaces for each in description.root.findall(tag)):
        return description
    root = deepcopy(description.root)
    for each in (found for tag in interfaces for found in root.findall(tag)):
        each.set("modelIdentifier", identifier)
    return replace(description, root=root)


def number(value: float, tag: str) -> str:
    """A value as a description writes it: the shortest text that gives the same double back."""
    if tag == "Boolean":
        return "true" if value else "false"
    return repr(float(value)) if tag.startswith("Float") else str(int(value))


def as_double(text: str) -> float:
    """A start value as the double that the FMU keeps it in."""
    truths = {"true": 1.0, "false": 0.0}
    return truths[text] if text in truths else float(text)


def start_values(description: Description) -> list[tuple[int, float]]:
    """Reference and value of every scalar and element that has a start value, the arrays' size first."""
    values: list[tuple[int, float]] = []
    for variable in sorted(description.variables, key=lambda v: v.causality != "structuralParameter"):
        for i, text in enumerate(variable.start):
            element = 0 if variable.size is None else i + 1
            values.append((element_reference(variable.reference, element), as_double(text)))
    return values


def token_of(text: str) -> str:
    """The token that belongs to a description's text: a hash of the text without the token."""
    blank = re.sub(r'(instantiationToken|guid)="[^"]*"', r'\1=""', text, count=1)
    digest = hashlib.sha256(blank.encode("utf-8")).hexdigest()
    return "{" + "-".join((digest[:8], digest[8:12], digest[12:16], digest[16:20], digest[20:32])) + "}"


def with_token(text: str) -> str:
    """The text with the token that belongs to it."""
    token = token_of(text)
    return re.sub(r'(instantiationToken|guid)="[^"]*"', rf'\1="{token}"', text, count=1)


def token_in(text: str) -> str:
    """The token that a description's text has."""
    found = re.search(r'(?:instantiationToken|guid)="([^"]*)"', text)
    if found is None:
        raise ValueError("the description has no token")
    return found.group(1)
