"""What C reads alike: a function as a tree in which spelling does not count, so that a fault that changes the text and
not the tree is none. Every law here holds for all numbers, to the bit and for NaN (but for its payload), in C99 with
IEEE 754, where names in capitals are what they look like: constants without a side effect, and counts none below 0:

* parentheses, spaces and comments say nothing; an empty statement does nothing, and braces around one statement;
* a sum, a product, `==`, `!=`, `&`, `|` and `^` of two do not hang on their order, unless both may do something, nor do
  the commutative functions of laws.toml; `a > b` is `b < a`;
* a comparison with -0 is one with 0;
* `!(a == b)` is `a != b`; in a condition `x != 0` is `x`, `!!x` is `x` and `-x` is `x`; `!c ? a : b` is `c ? b : a`;
* what a function returns that gives a truth is only asked whether it is 0;
* false, NULL and LACONIC_OK are 0, true is 1;
* a loop that counts by ones from a number up to a constant no lower, or from 0 up to one of the counts of laws.toml,
  and changes neither within, ends the same with `<` and with `!=`;
* `&` of two comparisons is `&&`, `|` is `||`, where the second may be asked though the first decides;
* `x = x + a` is `x += a`, and as a statement `x++`, `++x` and `x += 1` are one;
* an array of a function may be longer than it is, unless something asks its size or takes its address, or a text fills
  it, and so may an array parameter."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from decimal import Decimal
from typing import Any

from tree_sitter import Node

from laconic.mutation.equivalent import read_laws

Meaning = tuple[Any, ...]  # a name of a kind, and what it is made of

_LAWS = read_laws()
COMMUTATIVE_FUNCTIONS, COUNTS = _LAWS["commutative_functions"], _LAWS["counts"]
FREE = COMMUTATIVE_FUNCTIONS | {"R", "N"}  # they read their arguments alone
COMMUTATIVE = {"+", "*", "==", "!=", "&", "|", "^"}
MIRRORED = {">": "<", ">=": "<="}
COMPARISONS = {"<", "<=", "==", "!="}
TRUTHS = {"bool", "verdict"}
DECIDING = {"&": "&&", "|": "||"}
ZERO = ("number", "0")
ONE = ("number", "1")
REAL_ZERO = ("call", ("identifier", "R"), ZERO)
ZEROS = (ZERO, REAL_ZERO, ("number", "0e0"))
NUMBERS = {"false": ZERO, "NULL": ZERO, "LACONIC_OK": ZERO, "true": ("number", "1")}


def meaning(function: Node) -> Meaning:
    """Of a function's definition, or any other node."""
    made, of = _statement(function), function.child_by_field_name("type")
    return _with_truths(made) if of is not None and _text(of) in TRUTHS else made


def _with_truths(of: Meaning) -> Meaning:
    """The same where what is returned becomes a truth."""
    if of[0] == "return_statement" and len(of) == 4:
        return *of[:2], _truth_of(of[2]), of[3]
    return tuple(_with_truths(each) if isinstance(each, tuple) else each for each in of)


# -------------------------------------------------------------------------------------------------- statements

def _statement(node: Node) -> Meaning:
    if node.type == "compound_statement":
        lines = [each for each in map(_statement, _parts(node)) if each != ("empty",)]
        declares = any(each.type == "declaration" for each in _parts(node))
        return lines[0] if len(lines) == 1 and not declares else ("block", *lines)
    if node.type == "expression_statement":
        return _effect(_parts(node)[0]) if _parts(node) else ("empty",)
    if node.type == "if_statement":
        asked, then, other = (node.child_by_field_name(name) for name in ("condition", "consequence", "alternative"))
        assert asked is not None and then is not None
        return _chosen("if", _truth(asked), _statement(then), _statement(other) if other is not None else ("empty",))
    if node.type == "else_clause":
        return _statement(_parts(node)[0])
    if node.type in ("while_statement", "do_statement"):
        asked, body = node.child_by_field_name("condition"), node.child_by_field_name("body")
        assert asked is not None and body is not None
        return node.type, _truth(asked), _statement(body)
    if node.type == "for_statement":
        of = {"initializer": _statement, "condition": _truth, "update": _effect, "body": _statement}
        parts = [(make, node.child_by_field_name(name)) for name, make in of.items()]
        return _counted("for", *(make(each) if each is not None else ("empty",) for make, each in parts))
    if node.type == "parameter_declaration":
        return "parameter", *(_without_length(each) for each in _parts(node))
    return _value(node) if node.child_count == 0 or node.type in _VALUES else _tree(node, _statement)


def _counted(kind: str, start: Meaning, asked: Meaning, update: Meaning, body: Meaning) -> Meaning:
    """A loop over all numbers up to an end that it meets: with `<`."""
    if update[:2] != ("assign", "+=") or update[3] != ONE:
        return kind, start, asked, update, body
    counter = update[2]
    begun = [each[3] for each in within(start) if each[0] == "init_declarator" and each[1] == counter]
    changed = [place for each in within(body) for place in _changed_by(each)]

    def below(asked: Meaning) -> Meaning:
        if asked[0] == "&&":
            return "&&", below(asked[1]), below(asked[2])
        if asked[0] != "!=" or counter not in asked[1:]:
            return asked
        end = asked[2] if asked[1] == counter else asked[1]
        return ("<", counter, end) if _is_no_higher(begun[0], end) and end[-1] not in changed else asked

    return kind, start, below(asked) if len(begun) == 1 and counter not in changed else asked, update, body


def _changed_by(of: Meaning) -> Iterator[Meaning]:
    """What it sets or whose address it takes, and that of which this is a member, or the member."""
    if of[0] == "assign":
        yield from within(of[2])
    elif of[0] == "update_expression" or of[:2] == ("pointer_expression", ("&", "&")):
        yield from within(of)


def _is_no_higher(start: Meaning, end: Meaning) -> bool:
    """Both known: numbers, or 0 and a constant, or a count."""
    if start[0] == end[0] == "number":
        return 0 <= _count(start) <= _count(end)
    name = end[-1][1] if end[0] == "field_expression" else end[1]
    return start == ZERO and end[0] in ("identifier", "field_expression") and (name.isupper() or name in COUNTS)


def _effect(node: Node) -> Meaning:
    """Of an expression whose value nobody reads."""
    node = _inner(node)
    if node.type == "update_expression":
        changed = node.child_by_field_name("argument")
        assert changed is not None
        return "assign", _operator(node)[0] + "=", _value(changed), ("number", "1")
    return _value(node)


def _without_length(node: Node) -> Meaning:
    """An array parameter is a pointer: its first length tells readers alone."""
    if node.type == "array_declarator":
        name = node.child_by_field_name("declarator")
        assert name is not None
        return ("array", _statement(name)) if name.type == "identifier" else _tree(node, _without_length)
    return _statement(node)


# -------------------------------------------------------------------------------------------------- arrays

def without_growth(before: Meaning, after: Meaning) -> Meaning:
    """`after` with the lengths of `before` for every array of it that is only longer, and whose size nothing asks."""
    asked = repr([_without_elements(each) for each in within(before) if each[0] == "sizeof_expression"
                  or _is_macro(each) or each[:2] == ("pointer_expression", ("&", "&")) and each[2][0] == "identifier"
                  or each[0] == "init_declarator" and each[-1][0] == "string_literal"])

    def shortened(before: Meaning, after: Meaning) -> Meaning:
        if len(before) != len(after) or before[0] != after[0]:
            return after
        if before[0] == "array_declarator" and before[1] == after[1] and before[1][0] == "identifier":
            return before if repr(before[1]) not in asked and is_longer(after[3], before[3]) else after
        return after[0], *(shortened(one, other) if isinstance(one, tuple) and isinstance(other, tuple) else other
                           for one, other in zip(before[1:], after[1:], strict=True))

    return shortened(before, after)


def _without_elements(of: Meaning) -> Meaning:
    """The same where an element of an array is only where it is."""
    if of[0] == "subscript_expression" and of[1][0] == "identifier":
        return of[0], *map(_without_elements, of[2:])
    return tuple(_without_elements(each) if isinstance(each, tuple) else each for each in of)


def _is_macro(called: Meaning) -> bool:
    """It may ask a size, as COUNT(array) does."""
    return called[0] == "call" and called[1][0] == "identifier" and called[1][1].isupper()


def without_zero_signs(of: Meaning) -> Meaning:
    """The same where every zero has none."""
    if of[:2] == ("unary", "-") and of[2] in ZEROS:
        return of[2]
    return tuple(without_zero_signs(each) if isinstance(each, tuple) else each for each in of)


def within(of: Meaning) -> Iterator[Meaning]:
    yield of
    for each in of[1:]:
        if isinstance(each, tuple):
            yield from within(each)


def is_longer(length: Meaning, than: Meaning) -> bool:
    """By its text: a larger number, or the same and something more, or made so of what is longer."""
    if length[0] == than[0] == "number":
        return _count(length) > _count(than)
    if than[0] == "-" and than[1] == length and than[2][0] == "number":  # N - 1 becomes N
        return _count(than[2]) > 0
    if length[0] not in ("+", "*") or len(length) != 3:
        return False
    pairs = [(length[1], length[2]), (length[2], length[1])]
    if any(one == than and more[0] == "number" and _count(more) > 0 for one, more in pairs):
        return True
    return length[0] == than[0] and len(than) == 3 and any(  # N + 3 becomes N + 6
        one == there and is_longer(more, other) for one, more in pairs for there, other in (than[1:], than[:0:-1]))


def _count(number: Meaning) -> int:
    digits = number[1].rstrip("ul")
    return int(digits) if digits.isdigit() else -1


# -------------------------------------------------------------------------------------------------- values

def _value(node: Node) -> Meaning:
    made = _VALUES.get(node.type)
    if made is not None:
        return made(node)
    if node.child_count == 0 or node.type == "null":
        named = node.type in ("identifier", "true", "false", "null")
        return NUMBERS.get(_text(node) if named else "", (node.type, _text(node)))
    return _tree(node, _statement if node.type == "compound_statement" else _value)


def _number(node: Node) -> Meaning:
    text = _text(node).lower()
    return ("unary", "-", _digits(text[1:])) if text.startswith("-") else _digits(text)


def _digits(text: str) -> Meaning:
    if whole := re.fullmatch(r"(0x[0-9a-f]+|\d+)(u?l{0,2})", text):
        is_octal = re.fullmatch("0[0-7]+", whole[1])
        return "number", f"{int(whole[1], 8 if is_octal else 16 if 'x' in whole[1] else 10)}{whole[2]}"
    if real := re.fullmatch(r"((?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?)([fl]?)", text):
        return "number", f"{_plain(real[1])}{real[2]}"
    return "number", text


def _plain(text: str) -> str:
    """A number with a point or a power by its value: the same whatever its zeros."""
    number = Decimal(text).as_tuple()
    digits = "".join(map(str, number.digits))
    kept = digits.rstrip("0")
    return f"{int(kept)}e{int(number.exponent) + len(digits) - len(kept)}" if kept else "0e0"


def _binary(node: Node) -> Meaning:
    left, right = (node.child_by_field_name(name) for name in ("left", "right"))
    assert left is not None and right is not None
    operator = _operator(node)
    if operator in ("&&", "||"):
        return operator, _truth(left), _truth(right)
    one, other = _value(left), _value(right)
    if operator in DECIDING and _is_truth(left) and _is_truth(right) and not _may_fail(right):
        return DECIDING[operator], _truth(left), _truth(right)
    if operator in MIRRORED:
        operator, one, other = MIRRORED[operator], other, one
    if operator in COMPARISONS:
        one, other = _unsigned_zero(one), _unsigned_zero(other)
    is_free = operator in COMMUTATIVE and not (_may_change(left) and _may_change(right))
    return operator, *(sorted((one, other), key=repr) if is_free else (one, other))


def _unary(node: Node) -> Meaning:
    operand = node.child_by_field_name("argument")
    assert operand is not None
    return _not(_truth(operand)) if _operator(node) == "!" else ("unary", _operator(node), _value(operand))


def _assignment(node: Node) -> Meaning:
    left, right = (node.child_by_field_name(name) for name in ("left", "right"))
    assert left is not None and right is not None
    to, operator, given = _value(left), _operator(node), _value(right)
    if operator == "=" and len(given) == 3 and given[0] in ("+", "*", "-", "&", "|") and not _may_change(left):
        first = to == given[1] or given[0] != "-" and to == given[2]
        if first:
            return "assign", given[0] + "=", to, given[2] if to == given[1] else given[1]
    return "assign", operator, to, given


def _call(node: Node) -> Meaning:
    called, given = node.child_by_field_name("function"), node.child_by_field_name("arguments")
    assert called is not None and given is not None
    values = [_value(each) for each in _parts(given)]
    if _text(called) in COMMUTATIVE_FUNCTIONS:
        values.sort(key=repr)
    return "call", _value(called), *values


def _conditional(node: Node) -> Meaning:
    asked, then, other = (node.child_by_field_name(name) for name in ("condition", "consequence", "alternative"))
    assert asked is not None and then is not None and other is not None
    return _chosen("?:", _truth(asked), _value(then), _value(other))


_VALUES: dict[str, Callable[[Node], Meaning]] = {
    "binary_expression": _binary, "unary_expression": _unary, "number_literal": _number, "call_expression": _call,
    "assignment_expression": _assignment, "conditional_expression": _conditional,
    "parenthesized_expression": lambda node: _value(_inner(node))}


# -------------------------------------------------------------------------------------------------- conditions

def _truth(node: Node) -> Meaning:
    """Of what is only asked whether it is 0."""
    return _truth_of(_value(node))


def _truth_of(value: Meaning) -> Meaning:
    if value[0] in ("!=", "==") and (ZERO in value[1:] or REAL_ZERO in value[1:]):
        asked = _unsigned(value[2] if value[1] in (ZERO, REAL_ZERO) else value[1])
        return asked if value[0] == "!=" else ("!", asked)
    if value[0] == "!":
        within = _unsigned(value[1])
        return within[1] if within[0] == "!" else ("!", within)
    return _unsigned(value)


def _unsigned(truth: Meaning) -> Meaning:
    return _unsigned(truth[2]) if truth[:2] == ("unary", "-") else truth


def _not(truth: Meaning) -> Meaning:
    opposite = {"==": "!=", "!=": "=="}.get(truth[0])
    return (opposite, *truth[1:]) if opposite else ("!", truth)


def _chosen(kind: str, asked: Meaning, then: Meaning, other: Meaning) -> Meaning:
    return (kind, asked[1], other, then) if asked[0] == "!" and other != ("empty",) else (kind, asked, then, other)


def _is_truth(node: Node) -> bool:
    """Whether it is 0 or 1."""
    node = _inner(node)
    return (node.type == "binary_expression" and _operator(node) in COMPARISONS | set(MIRRORED) | {"&&", "||"}
            or node.type == "unary_expression" and _operator(node) == "!")


def _may_fail(node: Node) -> bool:
    """Whether it reads by an address, divides, or calls: what another condition may have to guard."""
    return (node.type in ("subscript_expression", "call_expression", "pointer_expression", "assignment_expression",
                          "update_expression", "field_expression")
            or node.type == "binary_expression" and _operator(node) in ("/", "%", "<<", ">>")
            or any(map(_may_fail, node.children)))


def _may_change(node: Node) -> bool:
    """Whether reading it may do something."""
    if node.type == "call_expression" and _text(node.children[0]) in FREE:
        return any(map(_may_change, node.children))
    return node.type in ("call_expression", "assignment_expression", "update_expression") or any(
        map(_may_change, node.children))


def _unsigned_zero(value: Meaning) -> Meaning:
    if value[:2] != ("unary", "-"):
        return value
    of = value[2]
    return of if of in ZEROS else value


# -------------------------------------------------------------------------------------------------- nodes

def _tree(node: Node, of: Callable[[Node], Meaning]) -> Meaning:
    return node.type, *(of(each) for each in node.children if each.type != "comment")


def _parts(node: Node) -> list[Node]:
    return [each for each in node.named_children if each.type != "comment"]


def _inner(node: Node) -> Node:
    while node.type == "parenthesized_expression":
        node = _parts(node)[0]
    return node


def _operator(node: Node) -> str:
    found = node.child_by_field_name("operator")
    assert found is not None
    return _text(found)


def _text(node: Node) -> str:
    return (node.text or b"").decode("utf-8")
