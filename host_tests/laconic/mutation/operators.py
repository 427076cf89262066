"""The mutants of a C file: where the text changes, and how. tree-sitter parses it before the preprocessor does, so
that both branches of an #if have their mutants."""

from __future__ import annotations

import hashlib
import re
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import tree_sitter_c
from tree_sitter import Language, Node, Parser, Tree

from laconic.mutation.equivalent import read_laws

_PARSER = Parser(Language(tree_sitter_c.language()))

RELATIONAL = {"<": ("<=", ">="), "<=": ("<", ">"), ">": (">=", "<="), ">=": (">", "<"), "==": ("!=",), "!=": ("==",)}
ARITHMETIC = {"+": "-", "-": "+", "*": "/", "/": "*", "%": "*"}
ASSIGNING = {"+=": "-=", "-=": "+=", "*=": "/=", "/=": "*=", "|=": "&=", "&=": "|=", "<<=": ">>=", ">>=": "<<="}
LOGICAL = {"&&": "||", "||": "&&"}
BITWISE = {"&": "|", "|": "&", "^": "|", "<<": ">>", ">>": "<<"}
COUNTING = {"++": "--", "--": "++"}

# Words of the project before a function, which no C grammar knows: blanked before parsing, at the same length.
_WORDS = re.compile(rb"^(INLINE|RARE_AND_OPAQUE|RARE|LACONIC_API)\b", re.MULTILINE)


Change = tuple[int, int, str]
"""From which byte to which, and what stands there then."""


@dataclass(frozen=True)
class Mutant:
    """One change of one file: the text from `start` to `end` (bytes) becomes `text`."""

    file: str
    function: str  # "" outside of functions
    line: int
    operator: str
    before: str    # the lines that change, as one line with single spaces
    after: str
    start: int
    end: int
    text: str
    key: str       # of file, function and change, not of line numbers

    @property
    def change(self) -> Change:
        """What it does to its file."""
        return self.start, self.end, self.text

    def applied_to(self, source: bytes) -> bytes:
        """The file with the fault in it."""
        return source[:self.start] + self.text.encode() + source[self.end:]


def relational(node: Node) -> Iterator[Change]:
    """A comparison whose boundary moves, or that holds where it did not: < becomes <= and >=, == becomes !=."""
    if node.type == "binary_expression":
        yield from _each(node, RELATIONAL)


def arithmetic(node: Node) -> Iterator[Change]:
    """+ and - change places, * and /, also in assignments and countings; a sign is lost."""
    if node.type == "binary_expression":
        yield from _each(node, ARITHMETIC)
    elif node.type == "assignment_expression":
        yield from _each(node, ASSIGNING)
    elif node.type == "update_expression":
        yield from _each(node, COUNTING)
    elif node.type == "unary_expression" and _text(_operator(node)) == "-":
        yield _operator(node).start_byte, _operator(node).end_byte, ""


def logical(node: Node) -> Iterator[Change]:
    """&& and || change places, & and |, << and >>; true becomes false; a "not" is lost."""
    if node.type == "binary_expression":
        yield from _each(node, LOGICAL)
        yield from _each(node, BITWISE)
    elif node.type in ("true", "false"):
        yield node.start_byte, node.end_byte, "false" if node.type == "true" else "true"
    elif node.type == "unary_expression" and _text(_operator(node)) in ("!", "~"):
        yield _operator(node).start_byte, _operator(node).end_byte, ""


def constants(node: Node) -> Iterator[Change]:
    """A whole number is one more, and one less; a number with a point is a hundredth more, a power of ten ten times
    more, and 0 is 1. An array is not made longer, which no program could notice."""
    if node.type == "number_literal":
        grows = not _is_length(node)
        for number, text in enumerate(other_numbers(_text(node))):
            if grows or number > 0:
                yield node.start_byte, node.end_byte, text
    elif node.type == "preproc_arg":
        told = re.sub(r"/\*.*?\*/", _blank, (node.text or b"").decode("latin-1"))  # a byte is a letter
        for found in re.finditer(r"(?<![\w.])\d[\w.]*(?:(?<=e)[+-]\d+)?", told):
            for text in other_numbers(found[0]):
                yield node.start_byte + found.start(), node.start_byte + found.end(), text


def _is_length(node: Node) -> bool:
    around = node.parent
    while around is not None and around.type in ("binary_expression", "parenthesized_expression"):
        around = around.parent
    return around is not None and around.type == "array_declarator"


def other_numbers(literal: str) -> Iterator[str]:
    """What a constant becomes."""
    whole = re.fullmatch(r"(0[xX][0-9a-fA-F]+|\d+)([uUlL]*)", literal)
    if whole:
        value = int(whole[1], 0) if whole[1].lower().startswith("0x") or whole[1] == "0" else int(whole[1])
        yield f"{value + 1}{whole[2]}"
        if value > 0:
            yield f"{value - 1}{whole[2]}"
        return
    real = re.fullmatch(r"(\d+\.?\d*(?:[eE][+-]?\d+)?)([fFlL]?)", literal)
    if real:
        size = float(real[1])
        more = 10.0 if re.fullmatch("1[eE].*", real[1]) else 1.01
        yield f"{size * more if size else 1.0!r}{real[2]}"


def conditions(node: Node) -> Iterator[Change]:
    """A condition is negated."""
    if node.type in ("if_statement", "conditional_expression"):
        asked = node.child_by_field_name("condition")
        if asked is not None:
            yield asked.start_byte, asked.end_byte, f"(!({_text(asked)}))"


def statements(node: Node) -> Iterator[Change]:
    """A statement is left out: an assignment, a call, break, continue, or a member of an initialiser. What stands
    outside of functions is a macro that makes some: without them nothing links."""
    if node.type in ("expression_statement", "break_statement", "continue_statement") and _text(node) != ";":
        if _is_in_function(node) and not _text(node).startswith("(void)"):
            yield node.start_byte, node.end_byte, ";"
    elif node.type == "initializer_pair":
        after = node.next_sibling
        if after is not None and after.type == "," or node.prev_sibling is not None and node.prev_sibling.type == ",":
            first = after is not None and after.type == ","
            begin, end = (node, after) if first else (node.prev_sibling, node)
            assert begin is not None and end is not None
            yield begin.start_byte, end.end_byte, ""


def _is_in_function(node: Node) -> bool:
    around = node.parent
    while around is not None and around.type != "function_definition":
        around = around.parent
    return around is not None


_COMMUTATIVE = read_laws()["commutative_functions"]


def arguments(node: Node) -> Iterator[Change]:
    """Two neighbouring arguments of a call change places, where that is not the same."""
    if node.type == "argument_list" and _text(node.parent.children[0] if node.parent else node) not in _COMMUTATIVE:
        given = [child for child in node.named_children if child.type != "comment"]
        for one, other in zip(given, given[1:], strict=False):
            if _text(one) != _text(other):
                yield one.start_byte, other.end_byte, f"{_text(other)}, {_text(one)}"


OPERATORS: dict[str, Callable[[Node], Iterator[Change]]] = {
    "relational": relational, "arithmetic": arithmetic, "logical": logical, "constants": constants,
    "conditions": conditions, "statements": statements, "arguments": arguments}
"""Their names; what each does, its first line says."""

_SKIPPED = {"preproc_if": "condition", "preproc_elif": "condition", "preproc_include": "path"}


def parsed(source: bytes) -> Tree:
    """A file's tree; its places are those of the text."""
    return _PARSER.parse(_WORDS.sub(lambda found: b" " * len(found[0]), source))


def mutants_of(root: Path, file: str) -> list[Mutant]:
    """All mutants of a file, in the order of its text."""
    source = (root / file).read_bytes()
    tree = parsed(source)
    seen: Counter[str] = Counter()
    found = []
    for node, function in _walk(tree.root_node, ""):
        for operator, changes in OPERATORS.items():
            for change in changes(node):
                found.append(_mutant(file, function, operator, source, change, seen))
    return sorted(found, key=lambda each: (each.start, each.end, each.text))


def _mutant(file: str, function: str, operator: str, source: bytes, change: Change, seen: Counter[str]) -> Mutant:
    start, end, text = change
    first = source.rfind(b"\n", 0, start) + 1
    last = source.find(b"\n", end)
    last = len(source) if last < 0 else last
    before = squeezed(source[first:last])
    after = squeezed(source[first:start] + text.encode() + source[end:last])
    told = "\0".join((file, function, operator, before, after))
    seen[told] += 1  # the same change of the same line twice in a function
    key = hashlib.sha256(f"{told}\0{seen[told]}".encode()).hexdigest()[:16]
    return Mutant(file, function, source.count(b"\n", 0, start) + 1, operator, before, after, start, end, text, key)


def squeezed(text: bytes) -> str:
    """Text without its comments and with single spaces, as a list of equivalents has it."""
    return " ".join(re.sub(r"/\*.*?\*/", "", text.decode("utf-8"), flags=re.DOTALL).split())


def _walk(node: Node, function: str) -> Iterator[tuple[Node, str]]:
    if node.type == "function_definition":
        function = name_of(node) or function
    if node.type in ("comment", "string_literal", "char_literal", "system_lib_string", "static_assert_declaration"):
        return
    yield node, function
    skipped = node.child_by_field_name(_SKIPPED[node.type]) if node.type in _SKIPPED else None
    for child in node.children:
        if skipped is None or child != skipped:
            yield from _walk(child, function)


def name_of(definition: Node) -> str:
    """A function's."""
    inner = definition.child_by_field_name("declarator")
    while inner is not None and inner.type != "identifier":
        inner = inner.child_by_field_name("declarator")
    return _text(inner) if inner is not None else ""


def _operator(node: Node) -> Node:
    found = node.child_by_field_name("operator")
    assert found is not None
    return found


def _each(node: Node, others: dict[str, str] | dict[str, tuple[str, ...]]) -> Iterator[Change]:
    operator = _operator(node)
    new = others.get(_text(operator), ())
    for text in (new,) if isinstance(new, str) else new:
        yield operator.start_byte, operator.end_byte, text


def _text(node: Node) -> str:
    return (node.text or b"").decode("utf-8")


def _blank(found: re.Match[str]) -> str:
    return " " * len(found[0])
