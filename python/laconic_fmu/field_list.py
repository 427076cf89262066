"""The core's lists of fields (vehicle.h, sensors.h) and methods (methods.h), compared with a description before FMUs
are built."""

from __future__ import annotations

import re
from dataclasses import dataclass
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


# ---- The core's list of methods (methods.h), and the enumeration of a description that must have the same methods.

METHOD_LIST = re.compile(r"^#define LACONIC_METHODS\(X\) *\\\n((?:.*\\\n)*.*)", re.MULTILINE)
METHOD_ROW = re.compile(r'\bX\((\d+), *(\w+), *"([^"]+)", *(\d+), *(\w+), *(\w+), *(\w+), *((?:"[^"]*" *)+)\)')
ITEMS = re.compile(r'(?<=\n)( *)(<EnumerationType name="Method"[^>]*>\n)(?: *<Item .*/>\n)*')


@dataclass(frozen=True)
class Method:
    """One row of the list; methods.h describes each member."""

    number: int
    identifier: str  # "exact_flow_4", of laconic_exact_flow_4
    name: str        # "exact-flow-4"
    order: int
    takes: str       # "SLOW_DAMPING", "ANY_DAMPING", "EVERY_STEP"
    keeps: str       # "NOTHING", "NEARLY", "EXACTLY"
    needs: str       # "NOTHING", or the end of a macro LACONIC_WITH_…
    title: str


def methods_in(header: str) -> tuple[Method, ...]:
    """The rows of methods.h in the order of their numbers; `header`: its text."""
    found = METHOD_LIST.search(header)
    joined = re.sub(r"\s*\\\n\s*", " ", found[1]) if found else ""
    return tuple(Method(int(number), identifier, name, int(order), takes, keeps, needs,
                        "".join(re.findall(r'"([^"]*)"', title)))
                 for number, identifier, name, order, takes, keeps, needs, title in METHOD_ROW.findall(joined))


def differing_item(header: Path, source: Path, description: Description) -> str:
    """One line for the first method that is not an item of the enumeration with its number, name and title, or for an
    item without a method, with the remedy; "" where both are the same."""
    methods = methods_in(header.read_text(encoding="utf-8"))
    if not methods:
        return f"{header}: holds no rows X(number, identifier, name, …); give the core's list of methods"
    remedy = f"run python -m laconic_fmu renew-methods {source} {header}"
    items = description.items(description.variable("method"))
    for method in methods:
        if items.get(method.number) != (method.name, method.title):
            return f"{header}: {source} has no item number {method.number}, {method.name}, with its title; {remedy}"
    if beyond := sorted(set(items) - {method.number for method in methods}):
        return f"{header}: has no method number {beyond[0]}, which is an item of {source}; {remedy}"
    return ""


def with_items(text: str, methods: tuple[Method, ...]) -> str:
    """The text of a description, its enumeration of methods made anew."""
    from xml.sax.saxutils import quoteattr  # brings what speaks HTTP, which a program that reads the list need not load

    def renewed(found: re.Match[str]) -> str:
        items = (f"{found[1]}  <Item name={quoteattr(method.name)} value=\"{method.number}\" "
                 f"description={quoteattr(method.title)}/>\n" for method in methods)
        return f"{found[1]}{found[2]}{''.join(items)}"
    return ITEMS.sub(renewed, text)
