"""The core's list of methods (methods.h), and the enumeration of a description that must have the same methods."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from .description import Description

LIST = re.compile(r"^#define LACONIC_METHODS\(X\) *\\\n((?:.*\\\n)*.*)", re.MULTILINE)
ROW = re.compile(r'\bX\((\d+), *(\w+), *"([^"]+)", *(\d+), *(\w+), *(\w+), *(\w+), *((?:"[^"]*" *)+)\)')
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
    found = LIST.search(header)
    joined = re.sub(r"\s*\\\n\s*", " ", found[1]) if found else ""
    return tuple(Method(int(number), identifier, name, int(order), takes, keeps, needs,
                        "".join(re.findall(r'"([^"]*)"', title)))
                 for number, identifier, name, order, takes, keeps, needs, title in ROW.findall(joined))


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
