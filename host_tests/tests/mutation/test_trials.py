"""A mutant is tried on a program of one function: killed, survived, the same code, or past its time."""

from __future__ import annotations

from pathlib import Path

import pytest

from laconic.mutation import mutants_of
from laconic.mutation.campaign import place_of
from laconic.mutation.results import Results
from laconic.mutation.trial import Outcome, Trials

SOURCE = """\
const char *const where = __FILE__;
int limited(int a) {
    volatile int k = 0;
    while (k < 10) k += 5;
    if (a > 5) return 5;
    return a * 1 + (0 && a);
}
"""
TEST = """\
int limited(int a);
int main(void) { return limited(9) != 5 || limited(2) != 2; }
"""


@pytest.fixture
def trials(trials_of):
    return trials_of({"limited.c": SOURCE}, {"test_limited.c": TEST})


def verdicts(trials: Trials, sources: Path) -> dict[str, str]:
    tree = trials.compiled.tree(0)
    return {f"{mutant.before} → {mutant.after}": trials.outcome(mutant, tree).verdict
            for mutant in mutants_of(sources, "core_c/limited.c")}


def test_what_a_test_notices_is_killed_and_what_none_does_survives(trials):
    found = verdicts(*trials)
    assert found["if (a > 5) return 5; → if (a > 5) return 6;"] == "killed"
    assert found["if (a > 5) return 5; → if (a > 6) return 5;"] == "survived"
    assert found["while (k < 10) k += 5; → while (k < 10) ;"] == "timeout"
    assert found["return a * 1 + (0 && a); → return a / 1 + (0 && a);"] == "same code"
    assert found["return a * 1 + (0 && a); → return a * 1 - (0 && a);"] == "same code"


def test_a_program_that_needs_nothing_of_the_library_runs_beside_a_fault_that_does(trials_of):
    library = {
        "limit.h": "static inline int limit(int a) { return a > 5 ? 5 : a; }\n",
        "limited.c": """#include "limit.h"\nextern const int size;\nconst int *const address = &size;
            int limited(int a) { return limit(a); }\n""",
        "size.c": "const int size = 3;\n",
    }
    test = """#include "limit.h"\nint main(int count, char **words) { (void)words; return limit(count + 8) != 5; }\n"""
    tried, sources = trials_of(library, {"test_limit.c": test})
    fault = next(each for each in mutants_of(sources, "core_c/limit.h") if "a > 6" in each.after)
    assert tried.outcome(fault, tried.compiled.tree(0)).verdict == "survived"


def test_what_only_the_sanitizers_notice_is_told_apart(trials_of):
    source = """int volatile table[2];\nint filled(int with) {
        for (int k = 0; k < 2; k++) table[k] = with;
        return table[0] + table[1];\n}\n"""
    test = """int filled(int with);\nint main(void) { return filled(2) != 4; }\n"""
    tried, sources = trials_of({"filled.c": source}, {"test_filled.c": test})
    longer = next(each for each in mutants_of(sources, "core_c/filled.c") if "k <= 2" in each.after)
    found = tried.outcome(longer, tried.compiled.tree(0))
    assert (found.verdict, found.by) == ("sanitizers", "test_filled_double")


def test_the_sources_are_as_before(trials):
    verdicts(*trials)
    assert (trials[1] / "core_c/limited.c").read_text() == SOURCE
    assert (trials[0].compiled.folder / "tree0/core_c/limited.c").read_text() == SOURCE


def test_the_same_code_is_the_same_in_any_copy_of_the_sources(trials):
    tried, sources = trials
    alike = next(each for each in mutants_of(sources, "core_c/limited.c") if "a / 1" in each.after)
    trees = map(tried.compiled.tree, range(2))
    assert [tried.outcome(alike, tree).verdict for tree in trees] == ["same code", "same code"]


def test_a_result_holds_until_its_file_changes_and_a_survivor_until_the_tests_do(tmp_path, monkeypatch):
    for folder in ("core_c/tests", "firmware_stub/tests", "fmu/tests"):
        (tmp_path / folder).mkdir(parents=True)
    (tmp_path / "core_c/a.c").write_text("int f(int a, int b) { return a - b * 3; }\n")
    monkeypatch.setattr("laconic.mutation.results.SOURCE_DIR", tmp_path)
    one, other = mutants_of(tmp_path, "core_c/a.c")[0], mutants_of(tmp_path, "core_c/a.c")[-1]
    kept = Results(tmp_path / "results.jsonl", ["core_c/a.c"])
    kept.keep(one, Outcome("killed", "test_a"))
    assert Results(tmp_path / "results.jsonl", ["core_c/a.c"]).known(one) == Outcome("killed", "test_a")
    kept.keep(other, Outcome("survived"))
    (tmp_path / "core_c/tests/test_a.c").write_text("/* a new test */\n")
    again = Results(tmp_path / "results.jsonl", ["core_c/a.c"])
    assert again.known(one) == Outcome("killed", "test_a")
    assert again.known(other) is None
    (tmp_path / "core_c/a.c").write_text("int f(int a, int b) { return a - b * 3; } /* new */\n")
    assert Results(tmp_path / "results.jsonl", ["core_c/a.c"]).known(one) is None


def test_a_sample_stays_where_it_is_when_other_mutants_come(trials):
    there = mutants_of(trials[1], "core_c/limited.c")
    order = sorted(there, key=lambda mutant: place_of(1, mutant))
    fewer = sorted(there[::2], key=lambda mutant: place_of(1, mutant))
    assert fewer == [mutant for mutant in order if mutant in fewer]
    assert order != sorted(there, key=lambda mutant: place_of(2, mutant))
