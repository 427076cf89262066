"""Statements whose order says nothing: neighbours of which neither names what the other writes may change places, and
what is set from other things alone may be set twice, also by a function of laws.toml; and of a sum of two calls, either
may come first. Two names count as two places, which pointers to one place would make untrue, and calls as such that do
not hang on one another: so this is said only of what no test has noticed."""

from __future__ import annotations

from laconic.mutation.alike import COMMUTATIVE, FREE, Meaning, within
from laconic.mutation.equivalent import read_laws

Place = tuple[Meaning, ...]  # a name, and what leads on from there: members and indices
Named = tuple[set[Place], set[Place]]  # what a statement writes, and what it reads

_TYPES = {"type_identifier", "primitive_type", "sized_type_specifier", "type_qualifier", "storage_class_specifier"}
_SETTING = read_laws()["setting_functions"]


def without_order(of: Meaning) -> Meaning:
    """The same with the statements of a block, and the two of a sum, in one order of those that mean the same."""
    parts = tuple(without_order(each) if isinstance(each, tuple) else each for each in of)
    if parts[0] in COMMUTATIVE and len(parts) == 3:
        return parts[0], *sorted(parts[1:], key=repr)
    if parts[0] != "block":
        return parts
    statements = _in_order(list(parts[1:]))
    return statements[0] if len(statements) == 1 and statements[0][0] in ("assign", "call") else ("block", *statements)


def _in_order(statements: list[Meaning]) -> list[Meaning]:
    """The first by its text of those that wait for nothing, again and again."""
    named = [_named(each) for each in statements]
    left, ordered = list(range(len(statements))), list[Meaning]()
    while left:
        free = [k for k in left if not any(_depends(named[k], named[j]) for j in left if j < k)]
        first = min(free, key=lambda k: repr(statements[k]))
        left.remove(first)
        if not ordered or ordered[-1] != statements[first] or not _may_come_twice(statements[first], named[first]):
            ordered.append(statements[first])
    return ordered


def _depends(one: Named | None, other: Named | None) -> bool:
    if one is None or other is None:
        return True
    return any(_overlap(written, place) for a, b in ((one, other), (other, one)) for written in a[0]
               for place in b[0] | b[1])


def _may_come_twice(statement: Meaning, named: Named | None) -> bool:
    if statement[0] == "call":
        return statement[1][1] in _SETTING and not any(_does(each) for given in statement[2:] for each in within(given))
    return named is not None and not any(_overlap(written, read) for written in named[0] for read in named[1])


def _does(of: Meaning) -> bool:
    return of[0] in ("assign", "update_expression") or of[0] == "call" and of[1][1] not in FREE


def _named(statement: Meaning) -> Named | None:
    """None for what may do more than set numbers from others: calls, jumps, loops and branches."""
    writes, reads = set[Place](), set[Place]()
    return (writes, reads) if _collect(statement, writes, reads) else None


def _collect(of: Meaning, writes: set[Place], reads: set[Place]) -> bool:
    kind, parts = of[0], [each for each in of[1:] if isinstance(each, tuple)]
    if kind == "assign":
        writes.add(_place(of[2]))
        if of[1] != "=":
            reads.add(_place(of[2]))
        return _collect_indices(of[2], writes, reads) and _collect(of[3], writes, reads)
    if kind == "init_declarator":
        writes.add(_place(_declared(of[1])))
        return _collect(of[3], writes, reads)
    if kind == "declaration":
        if any(each[0] in ("identifier", "array_declarator", "pointer_declarator") for each in parts):
            return False
        return all(_collect(each, writes, reads) for each in parts if each[0] not in _TYPES)
    if kind == "call":
        return of[1][1] in FREE and all(_collect(each, writes, reads) for each in of[2:])
    if kind in ("identifier", "field_expression", "subscript_expression", "pointer_expression"):
        reads.add(_place(of))
        return _collect_indices(of, writes, reads)
    if kind in ("if", "block", "empty", "update_expression") or kind.endswith("_statement") or kind == "for":
        return False
    return all(_collect(each, writes, reads) for each in parts)


def _collect_indices(of: Meaning, writes: set[Place], reads: set[Place]) -> bool:
    """Of a place, what is read to find it."""
    if of[0] == "field_expression":
        return _collect_indices(of[1], writes, reads)
    if of[0] == "subscript_expression":
        return _collect_indices(of[1], writes, reads) and _collect(of[3], writes, reads)
    return of[0] == "identifier"  # what lies behind *p may be anything


def _declared(of: Meaning) -> Meaning:
    return _declared(of[1]) if of[0] == "array_declarator" else of[2] if of[0] == "pointer_declarator" else of


def _place(of: Meaning) -> Place:
    if of[0] == "field_expression":
        return *_place(of[1]), of[3]
    if of[0] == "subscript_expression":
        return *_place(of[1]), ("index", of[3])
    return (of,)


def _overlap(one: Place, other: Place) -> bool:
    """Whether one may be the other or a part of it."""
    return all(not _differ(a, b) for a, b in zip(one, other, strict=False))


def _differ(one: Meaning, other: Meaning) -> bool:
    """Names, members, or indices of which one is a number beside the other."""
    if one[0] != "index" or other[0] != "index":
        return one != other
    (a, above_a), (b, above_b) = _split(one[1]), _split(other[1])
    return a == b and above_a != above_b


def _split(index: Meaning) -> tuple[Meaning | None, str]:
    """What it begins with, and the number above that."""
    if index[0] == "number":
        return None, index[1]
    if index[0] == "+" and index[2][0] == "number":
        return index[1], index[2][1]
    return index, "0"
