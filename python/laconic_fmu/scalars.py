"""Arrays as scalar variables, for the FMI 2.0 and the scalar FMI 3.0 description.

Descriptions for importers that know no enumerations: whole numbers, with what each stands for in the text.
"""

from __future__ import annotations

from copy import deepcopy
from dataclasses import dataclass, replace

from .description import ELEMENTWISE, Description, Variable, element_reference


@dataclass(frozen=True)
class Scalar:
    """A scalar variable or one element of an array."""

    variable: Variable
    element: int
    """0 for a scalar, else from 1."""
    start: str | None

    @property
    def reference(self) -> int:
        """Its value reference."""
        return element_reference(self.variable.reference, self.element)

    @property
    def name(self) -> str:
        """voltage_V[1], der(nu_rad_per_s[1])."""
        if not self.element:
            return self.variable.name
        if self.variable.name.endswith(")"):
            return f"{self.variable.name[:-1]}[{self.element}])"
        return f"{self.variable.name}[{self.element}]"

    @property
    def text(self) -> str:
        """Its description."""
        return f"{self.variable.description} ({self.element})" if self.element else self.variable.description


def elements_of(description: Description, variable: Variable) -> list[Scalar]:
    """The variable's scalars, in order."""
    count = description.elements(variable)
    if count is None:
        return [Scalar(variable, 0, variable.start[0] if variable.start else None)]
    return [Scalar(variable, i + 1, variable.start[i] if variable.start else None) for i in range(count)]


def scalars(description: Description) -> list[Scalar]:
    """All scalars of a description."""
    return [scalar for variable in description.variables for scalar in elements_of(description, variable)]


@dataclass(frozen=True)
class ScalarUnknown:
    """An entry of a scalar ModelStructure."""

    tag: str
    scalar: Scalar
    dependencies: tuple[Scalar, ...] | None
    kinds: tuple[str, ...] | None


def _only_own(unknown: Variable, known: Variable) -> bool:
    same_array = known.name in (unknown.name, f"start_{unknown.name}")
    return same_array or (unknown.name, known.name) in ELEMENTWISE


def unknowns(description: Description, tag: str) -> list[ScalarUnknown]:
    """The entries of one kind, with their dependencies, element by element."""
    rows = {v.reference: v for v in description.variables}
    out = []
    for entry in (u for u in description.unknowns if u.tag == tag):
        for scalar in elements_of(description, rows[entry.reference]):
            pairs = None
            if entry.dependencies is not None:
                kinds = entry.kinds or ("dependent",) * len(entry.dependencies)
                pairs = [(known, kind) for reference, kind in zip(entry.dependencies, kinds, strict=True)
                         for known in elements_of(description, rows[reference])
                         if not _only_own(scalar.variable, rows[reference]) or known.element == scalar.element]
            out.append(ScalarUnknown(tag, scalar, None if pairs is None else tuple(k for k, _ in pairs),
                                     tuple(kind for _, kind in pairs) if pairs is not None and entry.kinds else None))
    return out


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
    root = deepcopy(description.root)
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
