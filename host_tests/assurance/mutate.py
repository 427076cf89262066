"""Mutants: each is the C sources with one small fault in it, which some Unity test should notice.

    mutate [--only PART|FILE] [--sample N] [--seed S] [--minutes M] [--least PERCENT]

Needs gcc and a build tree whose target laconic_unity_tests was built. All mutants of a file are compiled at once, each
behind a switch that a test program reads when it starts; what has no place for a switch is compiled alone. A program
runs only where it reaches the mutant's place. Prints a score and the survivors as file:line:column, operator."""

from __future__ import annotations

import argparse
import os
import queue
import random
import re
import shutil
import subprocess
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path

from assurance.common import CORES, PARTS, ROOT, Clock, Entry, Unusable, build, called, work
from assurance.linked import affected, links, objects_of, programs

KNOWN = Path(__file__).with_name("survivors.txt")  # at most 20 lines: FILE FUNCTION OPERATOR # reason
LEFT_OUT = {"tests", "bench", "ports", "cdef", "cortex_m", "batch", "library"}
USUAL_S, FACTOR = 1.0, 8.0  # how long a program may run: so many times its usual time, and so long

LEXER = re.compile(r"""(?P<space>\s+|/\*.*?\*/|//[^\n]*)|(?P<directive>^[ \t]*\#(?:\\\n|/\*.*?\*/|[^\n])*)|
    (?P<text>"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*')|(?P<number>\.?\d(?:[eEpP][+-]|[\w.])*)|(?P<name>[A-Za-z_]\w*)|
    (?P<sign><<=|>>=|\.\.\.|->|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||[-+*/%&|^]=|.)""", re.X | re.S | re.M)
DEFINE = re.compile(r"[ \t]*#[ \t]*define\s+\w+(?:\([^)]*\))?")


@dataclass(frozen=True)
class Token:
    """`at`: where it begins in the file."""

    kind: str
    text: str
    at: int

    @property
    def end(self) -> int:
        return self.at + len(self.text)

    @property
    def is_operand(self) -> bool:
        """Whether an operator behind it has it on its left side."""
        return self.kind in ("number", "text") or self.text in (")", "]") or (
            self.kind == "name" and self.text not in ("return", "sizeof", "case"))


@dataclass
class Region:
    """Tokens that may change together. `kind`: `expression` has a value, `condition` is true or false, `effect` is a
    statement, `jump` is break or continue, `macro` is the text of one, `alone` takes no switch. `mark`: the number of
    its first mutant."""

    kind: str
    tokens: list[Token]
    function: str
    mark: int = 0


def tokens_of(text: str, offset: int = 0) -> list[Token]:
    return [Token(str(m.lastgroup), m[0], m.start() + offset) for m in LEXER.finditer(text) if m.lastgroup != "space"]


class Places:
    """Finds the regions of a file by its statements; no types are known."""

    def __init__(self, text: str):
        self.t, self.found, self.function = tokens_of(text), list[Region](), ""
        at = 0
        while at < len(self.t):
            at = self._outside(at)

    def _outside(self, at: int) -> int:
        """One token outside of functions, or a whole function."""
        token = self.t[at]
        if token.kind == "directive":
            if (head := DEFINE.match(token.text)) is not None:
                self._put("macro", tokens_of(token.text[head.end():].replace("\\\n", " \n"), token.at + head.end()))
        elif token.text == "=":
            end = self._until(at, ";")
            self._put("alone", self.t[at + 1:end])
            return end + 1
        elif token.text == "{" and at and self.t[at - 1].text == ")":
            self.function = self.t[self._match(at - 1, -1) - 1].text
            return self._statement(at)
        elif token.text == "{" and at and self.t[at - 1].kind != "text":  # a struct, not extern "C"
            return self._match(at) + 1
        return at + 1

    def _put(self, kind: str, tokens: list[Token]) -> None:
        if tokens:
            has_directive = any(token.kind == "directive" for token in tokens)
            self.found.append(Region("alone" if has_directive else kind, tokens, self.function))

    def _match(self, at: int, way: int = 1) -> int:
        """The bracket that belongs to the one here."""
        opens, depth = ("([{", ")]}")[:: way], 0
        while 0 <= at < len(self.t):
            depth += (self.t[at].text in opens[0]) - (self.t[at].text in opens[1])
            if depth == 0:
                return at
            at += way
        return len(self.t) - 1

    def _until(self, at: int, stop: str) -> int:
        while at < len(self.t) and self.t[at].text not in (stop, "}"):
            at = self._match(at) + 1 if self.t[at].text in ("(", "[", "{") else at + 1
        return at

    def _statement(self, at: int) -> int:
        word = self.t[at].text
        if word == "{":
            end, at = self._match(at), at + 1
            while at < end:
                at = self._statement(at)
            return end + 1
        if word in ("if", "while", "switch"):
            end = self._match(at + 1)
            self._put("expression" if word == "switch" else "condition", self.t[at + 2:end])
            return self._statement(end + 1)
        if word == "for":
            return self._statement(self._for(at + 1) + 1)
        if word in ("else", "do"):
            return self._statement(at + 1)
        if word in ("case", "default"):
            return self._until(at, ":") + 1
        if word == ";" or self.t[at].kind == "directive":
            return at + 1
        end = self._until(at, ";")
        if word == "return":
            self._put("expression", self.t[at + 1:end])
        elif word in ("break", "continue"):
            self._put("jump", self.t[at:end])
        elif word != "goto":
            self._simple(self.t[at:end])
        return end + 1

    def _for(self, at: int) -> int:
        close = self._match(at)
        first = self._until(at + 1, ";")
        second = self._until(first + 1, ";")
        self._simple(self.t[at + 1:first])
        self._put("condition", self.t[first + 1:second])
        self._put("effect", self.t[second + 1:close])
        return close

    def _simple(self, tokens: list[Token]) -> None:
        """An expression, or a declaration with initial values."""
        names = [token.text for token in tokens[:2]]
        is_declaration = len(tokens) > 1 and tokens[0].kind == "name" and (
            tokens[1].kind == "name" or (names[1] == "*" and any(token.text == "=" for token in tokens[2:4])))
        if not is_declaration:
            self._put("effect", tokens)
            return
        kind = "alone" if names[0] == "static" else "expression"
        parts = split(tokens, ",")
        for part in parts:
            at = next((k for k, token in enumerate(part) if token.text == "="), len(part))
            self._initial(kind, part[at + 1:])

    def _initial(self, kind: str, tokens: list[Token]) -> None:
        """An initial value, or those of an aggregate one by one."""
        if not tokens or tokens[0].text != "{":
            self._put(kind, tokens)
            return
        for item in split(tokens[1:-1], ","):
            at = next((k for k, token in enumerate(item) if token.text == "="), -1) if item[:1] and item[
                0].text in (".", "[") else -1
            self._initial(kind, item[at + 1:])


def joined(tokens: Iterable[Token]) -> str:
    return " ".join(token.text for token in tokens)


def split(tokens: list[Token], sign: str) -> list[list[Token]]:
    """Parts between these signs, outside of brackets."""
    parts, depth = [list[Token]()], 0
    for token in tokens:
        depth += (token.text in "([{") - (token.text in ")]}")
        if token.text == sign and depth == 0:
            parts.append([])
        else:
            parts[-1].append(token)
    return [part for part in parts if part]


SIGNS = {"<": ("<=", ">="), ">": (">=", "<="), "<=": ("<", ">"), ">=": (">", "<"), "==": ("!=",), "!=": ("==",),
         "&&": ("||",), "||": ("&&",), "+": ("-",), "-": ("+",), "*": ("/",), "/": ("*",), "%": ("*",), "&": ("|",),
         "|": ("&",), "^": ("|",), "<<": (">>",), ">>": ("<<",), "+=": ("-=",), "-=": ("+=",), "*=": ("/=",),
         "/=": ("*=",), "|=": ("&=",), "&=": ("|=",), "<<=": (">>=",), ">>=": ("<<=",)}
ALWAYS = {"++": "--", "--": "++", "true": "false", "false": "true"}
RANK = {sign: rank for rank, signs in enumerate((", =", "? :", "||", "&&", "|", "^", "&", "== !=", "< > <= >=",
                                                 "<< >>", "+ -", "* / %")) for sign in signs.split()}
NAMES = {**dict.fromkeys(("<", ">", "<=", ">=", "==", "!="), "relational"),
         **dict.fromkeys(("&&", "||", "true", "false", "&", "|", "^", "<<", ">>"), "logical")}
WHOLE = re.compile(r"(0[xX][0-9a-fA-F]+|\d+)([uUlL]*)")
POINT = re.compile(r"((?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)([fF]?)")

Edit = tuple[int, int, str, str]
"""First token and the one behind the last, what stands there instead, and the operator's name."""


def edits_of(region: Region) -> Iterator[Edit]:
    """All small faults of a region."""
    tokens = region.tokens
    if region.kind == "jump":
        yield 0, len(tokens), "", f"dropped {tokens[0].text}"
        return
    for k, token in enumerate(tokens):
        yield from _edits_at(tokens, k, token)
    if region.kind == "condition":
        yield 0, len(tokens), f"!({joined(tokens)})", "negated condition"
    if region.kind == "effect":
        yield 0, len(tokens), "0", "dropped statement"


def _edits_at(tokens: list[Token], k: int, token: Token) -> Iterator[Edit]:
    text, is_binary = token.text, k > 0 and tokens[k - 1].is_operand
    behind = tokens[k + 1].text if k + 1 < len(tokens) else ""
    if text in ALWAYS:
        yield k, k + 1, ALWAYS[text], f"{NAMES.get(text, 'arithmetic')} {text} to {ALWAYS[text]}"
    elif text in SIGNS and is_binary and not (text in "*&" and behind in (")", "*", ",", "")):
        for other in SIGNS[text]:
            yield k, k + 1, other, f"{NAMES.get(text, 'arithmetic')} {text} to {other}"
        if text in RANK:
            end = _operand_end(tokens, k)
            yield k, end, "", f"dropped {text} term"
    elif text in ("!", "-") and not is_binary:
        yield k, k + 1, "", f"dropped {text}"
    elif token.kind == "number":
        for other in _numbers(text):
            yield k, k + 1, other, f"constant {text} to {other}"
    elif token.kind == "name" and behind == "(":
        yield from _swaps(tokens, k)


def _operand_end(tokens: list[Token], k: int) -> int:
    """Behind the right operand of a binary operator."""
    depth, rank = 0, RANK[tokens[k].text]
    for at in range(k + 1, len(tokens)):
        text = tokens[at].text
        depth += (text in "([{") - (text in ")]}")
        ends = depth == 0 and at > k + 1 and tokens[at - 1].is_operand and RANK.get(text, 99) <= rank
        if depth < 0 or ends or (depth == 0 and text.endswith("=") and text not in RANK):
            return at
    return len(tokens)


def _numbers(text: str) -> list[str]:
    if (whole := WHOLE.fullmatch(text)) is not None:
        value = int(whole[1], 16 if whole[1][:2] in ("0x", "0X") else 8 if whole[1][0] == "0" else 10)
        return [f"{value + 1}{whole[2]}"] + ([f"{value - 1}{whole[2]}"] if value else [])
    point = POINT.fullmatch(text)
    return [f"{float(point[1]) * 1.01 or 1.0!r}{point[2]}"] if point is not None else []


def _swaps(tokens: list[Token], k: int) -> Iterator[Edit]:
    depth = 0
    for end in range(k + 1, len(tokens)):
        depth += (tokens[end].text == "(") - (tokens[end].text == ")")
        if depth == 0:
            break
    at = k + 2
    arguments = []
    for part in split(tokens[k + 2:end], ","):
        arguments.append((at, at + len(part), joined(part)))
        at += len(part) + 1
    for (first, first_end, one), (second, second_end, other) in zip(arguments, arguments[1:], strict=False):
        if one != other and first_end + 1 == second:
            yield first, second_end, f"{other}, {one}", "swapped arguments"


@dataclass
class Mutant:
    """One fault. `number`: its switch, from 1."""

    file: str
    number: int
    region: Region
    edit: Edit
    where: str
    outcome: str = ""

    @property
    def text(self) -> str:
        """The region with the fault, in one line."""
        first, end, other, _ = self.edit
        tokens = self.region.tokens
        return f"{joined(tokens[:first])} {other} {joined(tokens[end:])}"

    def alone(self, text: str) -> str:
        """The whole file with the fault."""
        first, end, other, _ = self.edit
        tokens = self.region.tokens
        return text[: tokens[first].at] + f" {other} " + text[tokens[end - 1].end:]


def mutants_of(file: str) -> list[Mutant]:
    """All of a file."""
    text = (ROOT / file).read_text(encoding="utf-8")
    found = list[Mutant]()
    for region in Places(text).found:
        region.mark = len(found) + 1
        for edit in edits_of(region):
            at = region.tokens[edit[0]].at
            line, column = text.count("\n", 0, at) + 1, at - text.rfind("\n", 0, at)
            found.append(Mutant(file, len(found) + 1, region, edit, f"{file}:{line}:{column}"))
    return found


HELPER = """#include <stdio.h>
#include <stdlib.h>
int laconic_mutant;
unsigned char laconic_reached[1 << 16];
__attribute__((constructor)) static void laconic_choose(void) {
    const char *text = getenv("LACONIC_MUTANT");
    if (text != NULL) laconic_mutant = atoi(text);
}
__attribute__((destructor)) static void laconic_tell(void) {
    const char *name = getenv("LACONIC_REACHED");
    FILE *file = name != NULL ? fopen(name, "wb") : NULL;
    if (file == NULL) return;
    fwrite(laconic_reached, 1, sizeof laconic_reached, file);
    fclose(file);
}
"""
DECLARED = "extern int laconic_mutant; extern unsigned char laconic_reached[1 << 16];\n"


def switched(text: str, mutants: list[Mutant]) -> tuple[str, dict[int, list[Mutant]]]:
    """The file with these mutants behind switches, and the mutants of each line that has some."""
    by_region: dict[int, list[Mutant]] = defaultdict(list)
    for mutant in mutants:
        by_region[id(mutant.region)].append(mutant)
    parts, lines, at, line = [DECLARED], defaultdict[int, list[Mutant]](list), 0, 2
    for own in by_region.values():
        region = own[0].region
        begin, end = region.tokens[0].at, region.tokens[-1].end
        before = text[at:begin]
        line += before.count("\n")
        at, mark = end, f"laconic_reached[{region.mark}] = 1"
        if region.kind == "jump":
            parts += [before, f"if ({mark}, laconic_mutant != {own[0].number})\n {joined(region.tokens)}"]
            lines[line].append(own[0])
            line += 1
            continue
        cast, behind = "(void)" if region.kind == "effect" else "", " " if region.kind == "macro" else "\n"
        parts += [before, f" ({mark}, "]
        for mutant in own:
            parts.append(f"laconic_mutant == {mutant.number} ? {cast}({mutant.text}) :{behind}")
            lines[line].append(mutant)
            line += behind == "\n"
        parts.append(f"{cast}({joined(region.tokens)}))")
        lines[line] += own
    return "".join([*parts, text[at:]]), lines


class Complaint(Exception):
    """What a compiler prints."""


class Bench:
    """A copy of the sources in which faults are made, with the objects and programs of one fault, or of many."""

    def __init__(self, number: int):
        self.folder, self.own, self.made = work(f"mutate/{number}"), dict[Path, Entry](), dict[Path, Path]()
        for part in PARTS.values():
            shutil.copytree(ROOT / part, self.folder / part, dirs_exist_ok=True)
        called(["gcc", "-O1", "-c", "-x", "c", self.write("helper.c", HELPER), "-o", self.folder / "helper.o"])

    def write(self, name: str, text: str) -> Path:
        """A file of this copy."""
        (self.folder / name).write_text(text, encoding="utf-8")
        return self.folder / name

    def compile(self, entry: Entry, own: tuple[str, ...], suffix: str = "o") -> tuple[Path, str]:
        """An object of this copy, and the compiler's complaints."""
        words = [word for word in entry.command if not word.startswith("-W")]
        for part in PARTS.values():
            words = [word.replace(f"{ROOT}/{part}", f"{self.folder}/{part}") for word in words]
        out = self.folder / f"{abs(hash(entry.output))}.{suffix}"
        words[words.index("-o") + 1] = str(out)
        done = subprocess.run([*words, *own], cwd=build(), capture_output=True, text=True, check=False)
        return out, done.stderr if done.returncode else ""

    def take(self, own: list[Entry], text: str, file: str) -> None:
        """Another text of a file, of which objects are made when they are asked for."""
        self.write(file, text)
        self.own = {entry.output: entry for entry in own}
        self.made = dict[Path, Path]()

    def object(self, entry: Entry) -> Path:
        """An object of this text; raises the compiler's complaint."""
        out, complaint = self.compile(entry, ("-w", "-O1", "-DLACONIC_PLAIN_INLINE"))
        if complaint:
            raise Complaint(complaint)
        return out

    def link(self, program: Path) -> Path | None:
        """A test program with the faults; None where it cannot be linked."""
        link = links()[program]
        out = self.folder / program.name
        words = [str(self._replaced((link.folder / word).resolve())) if word.endswith((".o", ".a")) else word
                 for word in link.words]
        words[words.index("-o") + 1] = str(out)
        done = subprocess.run([*words, str(self.folder / "helper.o")], cwd=link.folder, capture_output=True,
                              check=False)
        return out if done.returncode == 0 else None

    def _replaced(self, path: Path) -> Path:
        """An object of this text, or an archive with some; else what the build has."""
        if path not in self.made and path in self.own:
            self.made[path] = self.object(self.own[path])
        elif path not in self.made and objects_of(path) & self.own.keys():
            inputs = [self._replaced(each) for each in links()[path].inputs]
            self.made[path] = self.folder / f"{len(self.made)}-{path.name}"
            self.made[path].unlink(missing_ok=True)
            called(["ar", "qcsT", self.made[path], *inputs])
        return self.made.get(path, path)


def ran(program: Path, limit_s: float, **environment: str) -> bool:
    """Whether a test passes within the time."""
    with suppress(subprocess.TimeoutExpired):
        done = subprocess.run([str(program)], env={**os.environ, **environment}, stdin=subprocess.DEVNULL,
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=limit_s, check=False)
        return done.returncode == 0
    return False


@dataclass
class Trial:
    """All mutants of one file."""

    file: str
    mutants: list[Mutant]
    benches: queue.Queue[Bench]
    kills: Counter[str] = field(default_factory=Counter)

    def __post_init__(self) -> None:
        self.text = (ROOT / self.file).read_text(encoding="utf-8")
        self.own = affected(self.file)
        outputs = {entry.output for entry in self.own}
        stem = Path(self.file).stem
        # lanes of a batch have a file's text once more, compiled as it was: their comparison would notice every fault
        near = [path for path in programs() if objects_of(path) & outputs and "batch" not in path.name]
        self.programs = sorted(near, key=lambda path: (stem not in path.name, "single" in path.name))

    @contextmanager
    def bench(self) -> Iterator[Bench]:
        one = self.benches.get()
        try:
            yield one
        finally:
            one.write(self.file, self.text)
            self.benches.put(one)

    def run(self) -> None:
        """Switched ones, then those alone, then which survivors change no code."""
        alone = [each for each in self.mutants if each.region.kind == "alone"]
        alone += self.switched([each for each in self.mutants if each.region.kind != "alone"])
        with ThreadPoolExecutor(CORES) as pool:
            list(pool.map(self.alone, alone))
            list(pool.map(self.compare, [each for each in self.mutants if each.outcome == "survived"]))

    def switched(self, mutants: list[Mutant]) -> list[Mutant]:
        """Tries those that compile behind switches; the others come back."""
        left: list[Mutant] = []
        with self.bench() as bench, ThreadPoolExecutor(CORES) as pool:
            while mutants:
                text, lines = switched(self.text, mutants)
                bench.take(self.own, text, self.file)
                try:
                    bench.made = dict(zip(bench.own, pool.map(bench.object, self.own), strict=True))
                    break
                except Complaint as complaint:
                    places = re.findall(rf"{re.escape(Path(self.file).name)}:(\d+):\d+: (?:error|note)", str(complaint))
                    bad = {mutant.number for place in places for mutant in lines.get(int(place), ())}
                    bad = bad or {each.number for each in mutants if each.region.kind == "macro"}
                    left += [each for each in mutants if each.number in bad or not bad]
                    mutants = [each for each in mutants if bad and each.number not in bad]
            linked = [path for path in map(bench.link, self.programs if mutants else ()) if path is not None]
            usual = [each for each in pool.map(lambda path: (path, *self._reach(path)), linked) if each[2]]
            list(pool.map(lambda mutant: self._by_switch(mutant, usual), mutants))
        return left

    def _reach(self, program: Path) -> tuple[float, bytes]:
        """How long a program may run, and the places that it comes to; none where it fails without a fault."""
        clock = os.times().elapsed
        told = program.with_suffix(".reached")
        is_sound = ran(program, 60.0, LACONIC_REACHED=str(told))
        return USUAL_S + FACTOR * (os.times().elapsed - clock), told.read_bytes() if is_sound else b""

    def _by_switch(self, mutant: Mutant, usual: list[tuple[Path, float, bytes]]) -> None:
        near = [(path, limit_s) for path, limit_s, reached in usual if reached[mutant.region.mark]]
        mutant.outcome = "survived"
        for path, limit_s in sorted(near, key=lambda each: -self.kills[each[0].name]):
            if not ran(path, limit_s, LACONIC_MUTANT=str(mutant.number)):
                self.kills[path.name] += 1
                mutant.outcome = "killed"
                return

    def alone(self, mutant: Mutant) -> None:
        """One that is compiled by itself."""
        with self.bench() as bench:
            bench.take(self.own, mutant.alone(self.text), self.file)
            mutant.outcome = "survived"
            for program in sorted(self.programs, key=lambda path: -self.kills[path.name]):
                try:
                    made = bench.link(program)
                except Complaint:
                    mutant.outcome = "does not compile"
                    return
                if made is not None and not ran(made, 30.0):
                    mutant.outcome = "killed"
                    self.kills[program.name] += 1
                    return

    def compare(self, mutant: Mutant) -> None:
        """Whether the compiler makes the same code of it."""
        with self.bench() as bench:
            for entry in self.own:
                bench.write(self.file, self.text)
                before, _ = bench.compile(entry, ("-w",), "before")
                bench.write(self.file, mutant.alone(self.text))
                after, complaint = bench.compile(entry, ("-w",), "after")
                if complaint or before.read_bytes() != after.read_bytes():
                    return
        mutant.outcome = "same code"


def sources(only: str | None) -> list[str]:
    """Files of the product: all, those of a part, or one file."""
    paths = (path for part in PARTS.values() for path in sorted((ROOT / part).rglob("*.[ch]")))
    found = [path.relative_to(ROOT).as_posix() for path in paths
             if not LEFT_OUT & {*path.stem.split("_"), *path.relative_to(ROOT).parts}]
    if only is None:
        return found
    if only in PARTS:
        return [path for path in found if path.startswith(PARTS[only] + "/")]
    if only not in found:
        raise Unusable(f"--only {only}: is neither a part ({', '.join(PARTS)}) nor a C file of one")
    return [only]


def known() -> set[tuple[str, str, str]]:
    """Survivors that the file lists: file, function and operator."""
    lines = KNOWN.read_text(encoding="utf-8").splitlines() if KNOWN.exists() else []
    rows = [line.partition("#")[0].split(None, 2) for line in lines if not line.startswith("#") and line.strip()]
    return {(file, function, operator.strip()) for file, function, operator in rows}


def arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--only", metavar="PART|FILE", help=f"{', '.join(PARTS)} or a C file")
    parser.add_argument("--sample", type=int, metavar="N", help="so many of all mutants")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--minutes", type=float, default=float("inf"), help="begins no further file behind this time")
    parser.add_argument("--least", type=float, default=0.0, metavar="PERCENT", help="fails below this score")


def run(options: argparse.Namespace) -> bool:
    """Tries them file by file; whether the score is high enough."""
    clock, source = Clock(options.minutes), random.Random(options.seed)
    by_file = {file: mutants_of(file) for file in sources(options.only)}
    chosen = [mutant for mutants in by_file.values() for mutant in mutants]
    if options.sample is not None:
        chosen = source.sample(chosen, min(options.sample, len(chosen)))
    files = sorted({mutant.file for mutant in chosen})
    source.shuffle(files)
    benches: queue.Queue[Bench] = queue.Queue()
    for number in range(CORES):
        benches.put(Bench(number))
    done = []
    for file in files:
        own = sorted((mutant for mutant in chosen if mutant.file == file), key=lambda each: each.number)
        if not clock:
            break
        trial = Trial(file, own, benches)
        if not trial.own:
            continue  # no C test has it
        trial.run()
        done += own
        counts = Counter(mutant.outcome for mutant in own)
        outcomes = ", ".join(f"{count} {outcome}" for outcome, count in sorted(counts.items()))
        print(f"{file}: {len(own)} mutants, {outcomes}", flush=True)
    return summary(done, options.least)


def summary(done: list[Mutant], least: float) -> bool:
    """Prints score and survivors."""
    counts = Counter(mutant.outcome for mutant in done)
    listed = known()
    survivors = sorted((mutant for mutant in done if mutant.outcome == "survived"), key=lambda each: each.where)
    for mutant in survivors:
        is_known = (mutant.file, mutant.region.function, mutant.edit[3]) in listed
        print(f"{mutant.where} {mutant.edit[3]} ({mutant.region.function}){', known' if is_known else ''}")
    judged = counts["killed"] + counts["survived"]
    score = 100.0 * counts["killed"] / judged if judged else 100.0
    outcomes = ", ".join(f"{count} {outcome}" for outcome, count in sorted(counts.items()))
    print(f"{len(done)} mutants: {outcomes}; score {score:.1f} % of {judged}")
    return score >= least
