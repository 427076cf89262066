"""Arrays that are only longer than they are, in a function, in a structure, or by themselves: of which as much is used
as before, where nothing asks their length. Of what no test has noticed alone: memory is more, and tests hold its size
where that matters."""

from __future__ import annotations

import re

from laconic.mutation.alike import Meaning, is_longer, within

NAME = r"\b[A-Za-z_]\w*\b"
MACRO = re.compile(rf"^[ \t]*#[ \t]*define[ \t]+({NAME})\(((?:[^\n\\]|\\.|\\\n)*)", re.MULTILINE)
OPERAND = r"\s*(?:\(((?:[^()]|\((?:[^()]|\([^()]*\))*\))*)\)|([\w.>\[\]-]+))"
"""Of `sizeof`, or the arguments of a macro: in parentheses, in which two more pairs may stand, or a name."""


class Asked:
    """The names of all arrays whose length some sources ask: whole ones in `sizeof`, or in a macro that says `sizeof`,
    and not an element."""

    def __init__(self, sources: dict[str, str]):
        """Sources by their names."""
        macros = {name: body for text in sources.values() for name, body in MACRO.findall(text)}
        asking = {"sizeof"}
        while more := {name for name, body in macros.items() if asking & set(re.findall(NAME, body))} - asking:
            asking |= more
        self._asked = re.compile(rf"\b(?:{'|'.join(sorted(asking))})\b{OPERAND}")
        self._of_file = {file: self._names(text) for file, text in sources.items()}

    def by(self, file: str) -> set[str] | None:
        """By those that may know an array of this file: itself, but of a header all of them. None: it is no source."""
        if file not in self._of_file:
            return None
        return self._of_file[file] if file.endswith(".c") else set().union(*self._of_file.values())

    def _names(self, text: str) -> set[str]:
        operands = (found[1] or found[2] or "" for found in self._asked.finditer(text))
        return {name for operand in operands for name in re.findall(rf"{NAME}(?!\s*\[)", operand)}


def grown(before: Meaning, after: Meaning) -> set[str] | None:
    """The names of what `after` has a longer array of, in any direction, if all else is the same."""
    if before == after:
        return set()
    if len(before) != len(after) or before[0] != after[0] or not before[1:]:
        return None
    if before[0] == "array_declarator" and before[1] == after[1] and is_longer(after[3], before[3]):
        names = [each[1] for each in within(before[1]) if each[0] in ("identifier", "field_identifier")]
        return {names[0]} if names else None
    found: set[str] = set()
    for one, other in zip(before[1:], after[1:], strict=True):
        more = grown(one, other) if isinstance(one, tuple) and isinstance(other, tuple) else None
        if more is None and one != other:
            return None
        found |= more or set()
    return found
