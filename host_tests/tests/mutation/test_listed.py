"""What the list of equivalents says of a fault, however it is spelled; and of the faults of another sampler."""

from __future__ import annotations

import json
import re

import pytest

from laconic.errors import BadInput
from laconic.mutation.equivalent import Equivalent, read_equivalents
from laconic.mutation.faults import read_faults
from laconic.mutation.listed import BY_LAW, BY_SIGN, NO_CODE, Listed
from laconic.paths import SOURCE_DIR
from laconic.soak.mutants import length, soak

SOURCE = """\
#define HALF 2 /* of all */
typedef struct pair { int first, second; } pair;
static int half(int a, int b) { return a / HALF + b; }
int sum(int a, int b) { /* of both */
    int held[3] = {0};
    if (a > 7) a = 7;
    held[0] = a +
              b;
    held[1] = held[2] = 0;
    return held[0] - b;
}
"""
ROWS = [Equivalent("a.c", "sum", "if (a > 7) a = 7;", "if (a >= 7) a = 7;", "At 7 it is 7."),
        Equivalent("a.c", "sum", "held[0] = a + b;", "held[0] = b;", "Nobody reads a."),
        Equivalent("a.c", "", "#define HALF 2", "#define HALF 3", "Half or third."),
        Equivalent("a.c", "half", "static int half(int a, int b) { return a / HALF + b; }",
                   "static int half(int a, int b) { return … + b; }", "Any half will do.")]


@pytest.fixture
def listed(tmp_path):
    (tmp_path / "a.c").write_text(SOURCE)
    return Listed(ROWS, tmp_path)


def change(before: str, after: str) -> tuple[int, int, str]:
    at = SOURCE.index(before)
    return at, at + len(before), after


@pytest.mark.parametrize(("before", "after", "why"), [
    (">", ">=", "At 7 it is 7."), ("(a > 7)", "(7 <= a)", "At 7 it is 7."), (">", "> 1 +", None),
    ("a +\n              b", "b", "Nobody reads a."), ("a +", "", "Nobody reads a."), ("a +", "a -", None),
    ("a +\n              b", "b + a", BY_LAW), ("held[3]", "held[9]", BY_LAW), ("held[3]", "held[2]", None),
    (" /* of both */", "", NO_CODE), ("HALF 2", "HALF  3", "Half or third."), ("HALF 2", "HALF 4", None),
    ("first, second", "second, first", None), ("a / HALF + b", "b + a / HALF", BY_LAW), ("> 7", "= 7 +", None),
    ("held[0] - b;\n}\n", "held[0] - b;\n", None)])
def test_a_fault_is_found_by_its_text_or_by_what_it_means(listed, before, after, why):
    assert listed.reason("a.c", change(before, after)) == why
    assert listed.no_test_can_notice("a.c", change(before, after)) is (why is not None)


@pytest.mark.parametrize(("before", "after", "why"), [
    ("a / HALF", "a", "Any half will do."), ("HALF +", "(HALF + 2) +", "Any half will do."), ("+ b; }", "- b; }", None),
    ("return a / HALF", "a / HALF", None), ("2] = 0", "2] = -0", BY_SIGN),
    ("2] = 0", "2] = -1", None), ("a / HALF", "-(a / HALF)", "Any half will do.")])
def test_of_what_no_test_has_noticed_more_is_said_than_of_what_none_can(listed, before, after, why):
    assert listed.reason("a.c", change(before, after)) == why
    assert not listed.no_test_can_notice("a.c", change(before, after))


def test_a_row_of_one_function_says_nothing_of_another(tmp_path):
    (tmp_path / "a.c").write_text("int one(int a) { if (a > 7) a = 7; return a; }\nint other(int a) { return a; }\n")
    text = (tmp_path / "a.c").read_text()
    row = Equivalent("a.c", "other", "if (a > 7) a = 7;", "if (a >= 7) a = 7;", "At 7 it is 7.")
    at = text.index(">")
    assert Listed([row], tmp_path).reason("a.c", (at, at + 1, ">=")) is None


@pytest.fixture
def project(tmp_path, monkeypatch):
    (tmp_path / "a.c").write_text(SOURCE)
    for module in ("faults", "compiled"):
        monkeypatch.setattr(f"laconic.mutation.{module}.SOURCE_DIR", tmp_path)
    monkeypatch.setattr("laconic.mutation.compiled.FOLDERS", ())
    monkeypatch.setattr("laconic.mutation.compiled.families", lambda *_: [])
    monkeypatch.setattr("laconic.soak.mutants.SOURCE_DIR", tmp_path)
    monkeypatch.setattr("laconic.soak.mutants.read_equivalents", lambda: ROWS)
    return tmp_path


def test_another_samplers_faults_are_told_with_their_reason_or_as_outside(project):
    more, minus = SOURCE.index("> 7"), SOURCE.index("- b")
    rows = [{"file": "a.c", "start": more, "end": more + 1, "text": ">="},
            {"file": "a.c", "start": minus, "end": minus + 1, "text": "*"}]
    path = project / "faults.jsonl"
    path.write_text("\n".join(map(json.dumps, rows)) + "\n\n")
    came: list[float] = []
    said = soak(1.0, 1, came.append, faults=path)
    assert not said["passed"] and said["faults"] == 2 and came == [1.0, 1.0] and length(faults=path) == 2.0
    assert said["outside the list"] == ["a.c:10:20: -  →  *"]
    assert said["in the list"] == ["a.c:6:11: >  →  >=: At 7 it is 7."]
    assert soak(1.0, 1, lambda _: None, survivors=1, faults=path)["passed"]


@pytest.mark.parametrize(("line", "said"), [
    ("[1]", "line 1: is no fault; give"), ('{"file": "a.c", "start": 1, "end": 2}', "is no fault"),
    ("{", "is no fault"),
    ('{"file": "b.c", "start": 1, "end": 2, "text": ""}', "file: b.c is no C file of the project"),
    ('{"file": "../a.c", "start": 1, "end": 2, "text": ""}', "is no C file of the project"),
    ('{"file": "a.c", "start": "1", "end": 2, "text": ""}', "start: '1' is no whole number"),
    ('{"file": "a.c", "start": true, "end": 2, "text": ""}', "start: True is no whole number"),
    ('{"file": "a.c", "start": 1, "end": 2, "text": 3}', "text: 3 is no text"),
    ('{"file": "a.c", "start": 2, "end": 1, "text": ""}', "2 and 1 are no bytes of a.c, in order"),
    ('{"file": "a.c", "start": 0, "end": 100000, "text": ""}', "0 and 100000 are no bytes of a.c")])
def test_a_line_that_is_no_fault_is_refused_by_its_number(project, line, said):
    path = project / "faults.jsonl"
    path.write_text(line + "\n")
    with pytest.raises(BadInput) as refused:
        read_faults(path)
    assert said in str(refused.value) and "faults.jsonl: line 1: " in str(refused.value)


def test_without_a_file_or_with_another_samples_options_it_says_so(project):
    with pytest.raises(BadInput, match="cannot be read"):
        read_faults(project / "none.jsonl")
    assert length(sample=3) is None
    with pytest.raises(BadInput, match="leave out --sample and --only"):
        length(sample=3, faults=project / "a.c")


def test_the_row_that_the_page_shows_is_a_row_of_the_list(tmp_path):
    page = (SOURCE_DIR / "docs" / "assurance.md").read_text(encoding="utf-8")
    row, = re.findall(r"```toml\n(\[\[equivalent\]\]\n.*?)```", page, re.DOTALL)
    (tmp_path / "a.c.toml").write_text(row)
    shown, = read_equivalents(tmp_path)
    parts = (shown.function, shown.before, shown.after, shown.reason)
    assert parts in [(each.function, each.before, each.after, each.reason) for each in read_equivalents()]
