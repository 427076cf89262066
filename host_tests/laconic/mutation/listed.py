"""Whether a fault is in the list of equivalents, however it is spelled: the text is what a row makes of it, or the
function is, by the laws of alike.py, as it was or as a row makes it. Such a fault no test can notice. Four more things
are said of what no test has noticed, where tests notice the other faults of the place: a row with `…`, which stands for
any text, that a zero may have either sign, that the order of some statements says nothing (order.py), and that an array
may be longer (lengths.py)."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from functools import cached_property
from pathlib import Path

from tree_sitter import Node

from laconic.mutation.alike import Meaning, meaning, without_growth, without_zero_signs
from laconic.mutation.equivalent import Equivalent
from laconic.mutation.lengths import Asked, grown
from laconic.mutation.operators import Change, name_of, parsed
from laconic.mutation.order import without_order
from laconic.mutation.programs import FOLDERS

NO_CODE = "It changes no code: its bytes are of a comment or of spaces."
BY_LAW = "C reads both alike: a law of laconic/mutation/alike.py."
BY_SIGN = "Only a zero has another sign, and of that nothing is promised."
BY_LENGTH = "Only an array is longer, and nothing asks its length: as much of it is used as before."
BY_ORDER = "Only the order of statements is another, of which none names what the other writes, or one is there twice."
ANYTHING = "…"
LINES = 6
"""That a row may be of."""
NO_PRODUCT = {"tests", "fuzz", "proof", "campaign"}
"""Folders of what asks about the product."""


class Listed:
    """The list, over the sources as they stand."""

    def __init__(self, rows: Iterable[Equivalent], root: Path):
        self._rows: dict[str, list[Equivalent]] = defaultdict(list)
        self._root = root
        self._files: dict[str, _File] = {}
        for row in rows:
            self._rows[row.file].append(row)

    def reason(self, file: str, change: Change) -> str | None:
        """Why a change of a file that no test has noticed is no fault; None where the list does not say it."""
        of = self._of(file)
        return of.reason(change) or of.reason_of_survivor(change) or self._by_length(file, change)

    def beside(self, file: str, change: Change) -> tuple[str, str, dict[str, str]]:
        """The file without comments as it stands and with the change; what the rows make of the same lines, each with
        its reason."""
        return self._of(file).beside(change)

    def no_test_can_notice(self, file: str, change: Change) -> bool:
        """Whether the list says so, whatever tests there are."""
        return self._of(file).reason(change) is not None

    def _by_length(self, file: str, change: Change) -> str | None:
        names, asked = self._of(file).longer_arrays(change), self._lengths.by(file)
        return BY_LENGTH if names and asked is not None and not names & asked else None

    @cached_property
    def _lengths(self) -> Asked:
        paths = (path for folder in FOLDERS for path in (self._root / folder).rglob("*.[ch]"))
        product = (path for path in paths if not NO_PRODUCT.intersection(path.relative_to(self._root).parts))
        return Asked({path.relative_to(self._root).as_posix(): path.read_text(encoding="utf-8") for path in product})

    def _of(self, file: str) -> _File:
        if file not in self._files:
            self._files[file] = _File((self._root / file).read_bytes(), self._rows[file])
        return self._files[file]


class _Text:
    """A source by its lines, without comments and with single spaces."""

    def __init__(self, lines: list[str]):
        self.lines = lines
        self.words = " ".join(lines)

    @classmethod
    def of(cls, source: bytes) -> _Text:
        blank = re.sub(rb"/\*.*?\*/", lambda found: b"\n" * found[0].count(b"\n") or b" ", source, flags=re.DOTALL)
        squeezed = (" ".join(line.split()) for line in blank.decode("utf-8").splitlines())
        return cls([line for line in squeezed if line])

    @property
    def source(self) -> str:
        """What a compiler takes."""
        return "\n".join(self.lines) + "\n"

    def differs_in(self, other: _Text) -> range:
        """The lines that the other has not or has otherwise; at least one."""
        here, there = self.lines, other.lines
        shorter = min(len(here), len(there))
        first = next((k for k in range(shorter) if here[k] != there[k]), shorter)
        last = next((k for k in range(shorter - first) if here[-1 - k] != there[-1 - k]), shorter - first)
        return range(first, max(len(here) - last, first + 1))

    @cached_property
    def functions(self) -> dict[str, Node]:
        """By name; those that stand once more, in another branch of an #if, with a number."""
        seen: Counter[str] = Counter()
        found = {}
        for node in _definitions(parsed("\n".join(self.lines).encode()).root_node):
            name = name_of(node)
            seen[name] += 1
            found[name if seen[name] == 1 else f"{name} {seen[name]}"] = node
        return found

    @cached_property
    def outside(self) -> str:
        """What stands between the functions."""
        within = {number for node in self.functions.values() for number in _lines_of(node)}
        return "\n".join(line for number, line in enumerate(self.lines) if number not in within)


class _File:
    """A source with the rows of its list."""

    def __init__(self, source: bytes, rows: list[Equivalent]):
        self._source, self._text = source, _Text.of(source)
        self._variants = [(variant, row) for row in rows if ANYTHING not in row.after for variant in self._made_by(row)]
        self._places = [(*variant.words.split(ANYTHING, 1), row.reason)
                        for row in rows if ANYTHING in row.after for variant in self._made_by(row)]
        self._reasons = {variant.words: row.reason for variant, row in self._variants}
        self._made: dict[str, dict[Meaning, str]] = {}

    def reason(self, change: Change) -> str | None:
        """Why no test can notice it."""
        now = self._changed(change)
        if now.words in self._reasons:
            return self._reasons[now.words]
        if now.words == self._text.words:
            return NO_CODE
        if (name := self._changed_function(now)) is None:
            return None
        if name not in self._made:
            self._made[name] = self._meanings(name)
        own = meaning(self._text.functions[name])
        return self._made[name].get(without_growth(own, meaning(now.functions[name])))

    def reason_of_survivor(self, change: Change) -> str | None:
        """Why it is no fault if no test has noticed it."""
        now = self._changed(change)
        for before, behind, reason in self._places:
            is_longer = len(now.words) >= len(before) + len(behind)
            if is_longer and now.words.startswith(before) and now.words.endswith(behind):
                return reason
        if (name := self._changed_function(now)) is None:
            return None
        own, changed = meaning(self._text.functions[name]), meaning(now.functions[name])
        said = {BY_SIGN: without_zero_signs, BY_ORDER: without_order}
        return next((reason for reason, of in said.items() if of(own) == of(changed)), None)

    def longer_arrays(self, change: Change) -> set[str] | None:
        """Of what alone it changes the length, if it does nothing else."""
        own, now = (meaning(parsed(text.source.encode()).root_node) for text in (self._text, self._changed(change)))
        return grown(own, now)

    def beside(self, change: Change) -> tuple[str, str, dict[str, str]]:
        """As Listed has it."""
        now = self._changed(change)
        lines = set(self._text.differs_in(now))
        of_rows = {variant.source: row.reason for variant, row in self._variants
                   if lines.intersection(self._text.differs_in(variant))}
        return self._text.source, now.source, of_rows

    def _changed(self, change: Change) -> _Text:
        start, end, text = change
        return _Text.of(self._source[:start] + text.encode() + self._source[end:])

    def _changed_function(self, now: _Text) -> str | None:
        """The one that differs, which can be read; what stands outside of functions has rows of the very text alone."""
        before, after = self._text.functions, now.functions
        if before.keys() != after.keys() or self._text.outside != now.outside:
            return None
        changed = [name for name, node in after.items() if node.text != before[name].text]
        return changed[0] if len(changed) == 1 and not after[changed[0]].has_error else None

    def _meanings(self, name: str) -> dict[Meaning, str]:
        """Of the function itself and of what the rows make of it, each with its reason."""
        made = {}
        for variant, row in self._variants:
            node = variant.functions.get(name)
            if row.function == name.split()[0] and node is not None and not node.has_error:
                made[meaning(node)] = row.reason
        return made | {meaning(self._text.functions[name]): BY_LAW}

    def _made_by(self, row: Equivalent) -> Iterator[_Text]:
        home = [_lines_of(node) for name, node in self._text.functions.items() if name.split()[0] == row.function]
        lines = self._text.lines
        for first in range(len(lines)):
            for behind in range(first + 1, min(first + LINES, len(lines)) + 1):
                if " ".join(lines[first:behind]) == row.before and (not home or any(first in each for each in home)):
                    yield _Text([*lines[:first], row.after, *lines[behind:]])


def _lines_of(node: Node) -> range:
    return range(node.start_point[0], node.end_point[0] + 1)


def _definitions(node: Node) -> Iterator[Node]:
    if node.type == "function_definition":
        yield node
    else:
        for child in node.children:
            yield from _definitions(child)
