"""A fault is known by what a compiler makes of it: of the source, or of a row of the list."""

from __future__ import annotations

import pytest

from laconic.mutation.compiled import Compiled
from laconic.mutation.equivalent import Equivalent
from laconic.mutation.listed import Listed
from laconic.mutation.same_code import SAME, SAME_AS_A_ROW, SameCode

LIMIT = "static inline int limited(int a) { /* to five */\n    if (a > 5) a = 5;\n    return a;\n}\n"
LIBRARY = {"limit.h": LIMIT, "first.c": '#include "limit.h"\nint first(int a) { return limited(a); }\n',
           "second.c": '#include "limit.h"\nint second(int a) { return limited(a & 3); }\n'}
TEST = "int first(int a);\nint main(void) { return first(7) != 5; }\n"
ROWS = [Equivalent("core_c/limit.h", "limited", "if (a > 5) a = 5;", "if (a >= 4) a = 5;", "Nobody gives a 4."),
        Equivalent("core_c/limit.h", "limited", "if (a > 5) a = 5;", "if (a >= 9) …", "Any text."),
        Equivalent("core_c/limit.h", "limited", "return a;", "return a + 0;", "Another line.")]
OF_THE_ROW = f"{SAME_AS_A_ROW}: {ROWS[0].reason}"


@pytest.fixture
def asked(trials_of):
    trials, sources = trials_of(LIBRARY, {"test_first.c": TEST})
    by_code = SameCode(Listed(ROWS, sources), trials.compiled)

    def reason(before: str, after: str) -> str | None:
        at = len(LIMIT[:LIMIT.index(before)].encode())
        return by_code.reason("core_c/limit.h", (at, at + len(before), after))

    yield reason
    for root in (sources, trials.compiled.tree(0)):
        assert (root / "core_c/limit.h").read_text() == LIMIT


@pytest.mark.parametrize(("before", "after", "why"), [
    ("a > 5", "a >= 5 + 1", SAME), ("a > 5", "a > 3", OF_THE_ROW), ("a > 5", "!(a < 4)", OF_THE_ROW),
    ("a > 5", "a > 4", SAME), ("a = 5", "a = 4", None), ("a > 5", "a >= 9", None),
    ("return a", "return a * 1", SAME), ("return a", "return a + 1", None), ("return a;", "return (a;", None)])
def test_a_fault_is_what_is_compiled_to_the_same_bytes(asked, before, after, why):
    assert asked(before, after) == why


def test_where_one_of_the_places_that_include_it_has_other_bytes_it_is_another(asked):
    assert asked("a = 5", "a = 6") is None  # the second never comes to it


def test_a_file_that_nothing_is_made_of_is_not_known(tmp_path, trials_of):
    trials, sources = trials_of({**LIBRARY, "lonely.h": "enum { ONE = 1 };\n"}, {"test_first.c": TEST})
    listed = Listed([], sources)
    assert SameCode(listed, trials.compiled).reason("core_c/lonely.h", (13, 14, "2")) is None


def test_families_are_those_whose_tests_are_of_the_files(tmp_path, monkeypatch):
    asked_for: list[list[str]] = []
    monkeypatch.setattr("laconic.mutation.compiled.families", lambda _, wanted: asked_for.append(wanted) or [])
    monkeypatch.setattr("laconic.mutation.compiled.FOLDERS", ())
    Compiled.of(["core_c/a.c"], tmp_path)
    Compiled.of(["fmu/a.c"], tmp_path)
    assert asked_for[0] == ["double", "single", "secure"] and "fmu_bus" in asked_for[1] and len(asked_for[1]) == 7
