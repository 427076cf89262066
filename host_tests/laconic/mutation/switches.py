"""Many mutants of a file in one object: each stands behind a switch that a program reads when it starts. So a mutant
costs the runs of the tests that come to its place, and no compiler. What a test notices so is noticed; what none
does is tried once more as it is (trial.py), and so is what cannot stand behind a switch: a constant, a macro."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from tree_sitter import Node

from laconic.errors import ResultFails
from laconic.mutation.operators import Mutant, parsed
from laconic.mutation.programs import Family, Program, Unit, link
from laconic.mutation.trial import Outcome

PLACES = 30000
"""That a file may have."""
PRELUDE = f"""\
#include <stdio.h>
#include <stdlib.h>
static int laconic_switch;
static unsigned char laconic_places[{PLACES}];
#define LACONIC_COMES_HERE(k) (laconic_places[k] = 1)
__attribute__((constructor)) static void laconic_read_switch(void) {{
    const char *text = getenv("LACONIC_SWITCH");
    laconic_switch = text ? atoi(text) : 0;
}}
__attribute__((destructor)) static void laconic_tell_places(void) {{
    const char *path = getenv("LACONIC_PLACES");
    FILE *file = path ? fopen(path, "ab") : NULL;
    if (file) {{
        (void)fwrite(laconic_places, 1, sizeof laconic_places, file);
        (void)fclose(file);
    }}
}}
"""
ROUNDS = 50  # of compiling without what did not compile
COMPILER_S = 60  # a long function with a thousand switches may take hours

_STATEMENTS = {"expression_statement", "break_statement", "continue_statement"}
_EXPRESSIONS = {"binary_expression", "unary_expression", "pointer_expression", "call_expression",
                "conditional_expression", "subscript_expression", "field_expression", "parenthesized_expression",
                "assignment_expression", "update_expression", "identifier", "number_literal", "cast_expression",
                "sizeof_expression", "true", "false"}
_CONSTANT = {"array_declarator", "enumerator", "field_declaration", "parameter_list", "type_descriptor", "ERROR"}
_CASTS = {"R", "N"}  # macros around a number


@dataclass(frozen=True, order=True)
class Place:
    """An expression or a statement of the text."""

    start: int
    end: int
    is_statement: bool


@dataclass
class Switched:
    """A file's text with switches: that of mutant k is k + 1."""

    source: bytes
    mutants: list[Mutant]
    places: dict[int, Place] = field(default_factory=dict)  # by mutant

    @classmethod
    def of(cls, source: bytes, mutants: list[Mutant]) -> Switched:
        """With a place for each mutant that can have one."""
        root, made = parsed(source).root_node, cls(source, mutants)
        for k, mutant in enumerate(mutants):
            place = _place_around(root.descendant_for_byte_range(mutant.start, mutant.end), mutant)
            if place is not None:
                made.places[k] = place
        return made

    def order(self) -> list[Place]:
        """The places, outer ones before those within."""
        return sorted(set(self.places.values()), key=lambda place: (place.start, -place.end))

    def text(self) -> bytes:
        """The file with all switches; every fault has a line of its own."""
        return _Writer(self).between(0, len(self.source), None)

    def without_what_fails(self, path: Path, said: str) -> bool:
        """Takes the mutants out in whose lines the compiler found errors; False where it found none of them."""
        lines = self.text().split(b"\n")
        wrong = set()
        for found in re.finditer(rf"{re.escape(str(path))}:(\d+):[^\n]* (?:error|in expansion of macro)", said):
            at = int(found[1]) - 1
            if switch := re.match(rb"(?:if \(laconic_switch == |laconic_switch == )(\d+)", lines[at]):
                wrong.add(int(switch[1]) - 1)
                continue
            while at >= 0 and not (here := re.findall(rb"LACONIC_COMES_HERE\((\d+)\)", lines[at])):
                at -= 1
            order = self.order()
            wrong |= {k for k, place in self.places.items() if at >= 0 and order.index(place) in map(int, here)}
        found_any = any(k in self.places for k in wrong)
        for k in wrong:
            self.places.pop(k, None)
        return found_any


class _Writer:
    """Writes the text: places stand within others, faults have none within."""

    def __init__(self, switched: Switched):
        self.source, self.mutants = switched.source, switched.mutants
        self.number = {place: number for number, place in enumerate(switched.order())}
        self.within: dict[Place | None, list[Place]] = defaultdict(list)
        self.faults: dict[Place, list[int]] = defaultdict(list)
        around: list[Place] = []
        for place in self.number:
            while around and around[-1].end < place.end:
                around.pop()
            self.within[around[-1] if around else None].append(place)
            around.append(place)
        for k, place in switched.places.items():
            self.faults[place].append(k)

    def between(self, start: int, end: int, around: Place | None) -> bytes:
        """What stands there, with the switches of the places within."""
        pieces = []
        for place in self.within[around]:
            pieces += [self.source[start:place.start], self._switch(place)]
            start = place.end
        return b"".join([*pieces, self.source[start:end]])

    def _switch(self, place: Place) -> bytes:
        plain = self.between(place.start, place.end, place)
        faults = [(k + 1, self._faulty(place, self.mutants[k])) for k in self.faults[place]]
        here = b"LACONIC_COMES_HERE(%d)" % self.number[place]
        if place.is_statement:
            cases = b"".join(b"\nif (laconic_switch == %d) {%s} else " % fault for fault in faults)
            return b"{%s; %s{%s}}" % (here, cases, plain)
        cases = b"".join(b"\nlaconic_switch == %d ? (%s) : " % fault for fault in faults)
        return b"(%s, %s\n(%s))" % (here, cases, plain)

    def _faulty(self, place: Place, mutant: Mutant) -> bytes:
        text = self.source[place.start:mutant.start] + mutant.text.encode() + self.source[mutant.end:place.end]
        return re.sub(rb"/\*.*?\*/", b" ", text, flags=re.DOTALL).replace(b"\n", b" ")


def _place_around(node: Node | None, mutant: Mutant) -> Place | None:
    """The smallest expression or statement around the change that may be one of two."""
    found = None
    while node is not None and node.type != "function_definition":
        if node.type in _CONSTANT or _is_label(node):
            return None
        if node.type == "declaration" and any(child.type == "storage_class_specifier" for child in node.children):
            return None  # static: its initialiser is a constant
        if found is None and node.start_byte <= mutant.start and mutant.end <= node.end_byte:
            if node.type in _STATEMENTS:
                found = Place(node.start_byte, node.end_byte, is_statement=True)
            elif node.type in _EXPRESSIONS and _is_a_value(node):
                found = Place(node.start_byte, node.end_byte, is_statement=False)
        node = node.parent
    return found if node is not None else None


def _is_label(node: Node) -> bool:
    around = node.parent
    return around is not None and around.type == "case_statement" and around.child_by_field_name("value") == node


def _is_a_value(node: Node) -> bool:
    """Not what is assigned to, named, called, or cast by a macro."""
    around = node.parent
    if around is None or _is_written(node):
        return False
    if around.type == "argument_list" and around.parent is not None:
        called = around.parent.child_by_field_name("function")
        return called is None or (called.text or b"").decode() not in _CASTS
    if node.type == "identifier" and around.type in ("init_declarator", "declaration", "sizeof_expression"):
        return around.type == "init_declarator" and around.child_by_field_name("value") == node
    return not (around.type == "call_expression" and around.child_by_field_name("function") == node)


def _is_written(node: Node) -> bool:
    around = node.parent
    if around is None:
        return False
    if around.type == "assignment_expression":
        return around.child_by_field_name("left") == node
    if around.type in ("field_expression", "subscript_expression"):
        return around.child_by_field_name("argument") == node
    if around.type == "pointer_expression":
        return (around.text or b"").startswith(b"&")
    return around.type == "update_expression" or around.type == "parenthesized_expression" and _is_written(around)


@dataclass
class Bench:
    """A file's switches in the libraries of some families, made in one copy of the sources."""

    switched: Switched
    tree: Path
    file: str
    comes: dict[int, list[tuple[Family, Program, Path]]] = field(default_factory=lambda: defaultdict(list))

    def build(self, of_family: list[tuple[Family, list[Unit]]]) -> bool:
        """Compiles the file, and finds which programs come to which places; False where it does not compile."""
        changed = self.tree / self.file
        (self.tree / "switches.h").write_text(PRELUDE, encoding="utf-8")
        try:
            if not all(self._leave_out_what_fails(unit, changed) for _, units in of_family for unit in units):
                return False
            changed.write_bytes(self.switched.text())
            for family, units in of_family:
                objects = [self.tree / f"switched_{unit.target}_{unit.source.name}.o" for unit in units]
                if any(self._said_of(unit, out) is not None for unit, out in zip(units, objects, strict=True)):
                    return False
                library = self.tree / f"switched_{family.name}.so"
                link([*family.compiler, "-shared"], objects, library)
                self._look(family, units, library)
        finally:
            changed.write_bytes(self.switched.source)
        return True

    def _leave_out_what_fails(self, unit: Unit, changed: Path) -> bool:
        for _ in range(ROUNDS):
            if len(self.switched.order()) > PLACES:
                return False
            changed.write_bytes(self.switched.text())
            said = self._said_of(unit, self.tree / "switched.o", "-fsyntax-only")
            if said is None or not self.switched.without_what_fails(changed, said):
                return said is None
        return False

    def _said_of(self, unit: Unit, out: Path, *more: str) -> str | None:
        """What the compiler said where it failed."""
        done = unit.compile(self.tree, out, "-include", str(self.tree / "switches.h"), "-w", *more, bound_s=COMPILER_S)
        return done.stderr.decode("utf-8", "replace") if done.returncode != 0 else None

    def _look(self, family: Family, units: list[Unit], library: Path) -> None:
        count = len(self.switched.order())
        told = self.tree / "places"
        for program in family.programs:
            if program.name not in set().union(*(family.reach[unit.object] for unit in units)):
                continue
            told.unlink(missing_ok=True)
            if program.run(family.library, [library, family.library], None, LACONIC_PLACES=str(told)) != 0:
                continue  # it asks what a switch changes, as the size of a function
            seen: set[int] = set()
            data = told.read_bytes() if told.exists() else b""
            for start in range(0, len(data), PLACES):
                seen.update(place for place in range(count) if data[start + place])
            for place in seen:
                self.comes[place].append((family, program, library))

    def noticed(self, is_over: Callable[[], bool]) -> Iterator[tuple[Mutant, Outcome]]:
        """Each mutant that a test notices, with that test."""
        kills: Counter[str] = Counter()
        numbers = {place: number for number, place in enumerate(self.switched.order())}

        def noticed_per_second(here: tuple[Family, Program, Path]) -> float:
            return (kills[here[1].name] + 0.1) / (here[1].seconds + 0.005)

        for k, place in self.switched.places.items():
            if is_over():
                return
            for family, program, library in sorted(self.comes[numbers[place]], key=noticed_per_second, reverse=True):
                status = program.run(family.library, [library, family.library], family.bound_s(program),
                                     LACONIC_SWITCH=str(k + 1))
                if status != 0:
                    kills[program.name] += 1
                    yield self.switched.mutants[k], Outcome("timeout" if status is None else "killed", program.name)
                    break


def bench_of(mutants: list[Mutant], of_family: list[tuple[Family, list[Unit]]], tree: Path) -> Bench | None:
    """The mutants of one file, behind switches in these units; None where the file cannot be made so."""
    file = mutants[0].file
    bench = Bench(Switched.of((tree / file).read_bytes(), mutants), tree, file)
    try:
        return bench if bench.build(of_family) else None
    except ResultFails:
        return None
