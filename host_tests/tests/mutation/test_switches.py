"""Mutants behind switches: those that a test notices so are those that it notices one by one."""

from __future__ import annotations

import pytest

from laconic.mutation import mutants_of
from laconic.mutation.operators import Mutant
from laconic.mutation.switches import Switched, bench_of

SOURCE = """\
#define R(x) ((double)(x))
typedef struct pair { int first, second; } pair;
static const int steps[2 + 1] = {1, 2, 3};
static int less(int a, int b) { return a < b; }
int sum_of(const int *numbers, int count, pair *at) {
    int sum = 0; /* of those
                    that are small */
    for (int k = 0; k < count; k++) {
        if (numbers[k] == 99) break;
        if (numbers[k] < 0) continue;
        sum += less(numbers[k], 50) ? numbers[k] : steps[k % 3];
    }
    at->first = sum;
    at->second = -sum + (int)(R(2.5) * 2);
    switch (sum) {
    case 3: return 7;
    default: return count > 1 &&
                    sum > 0;
    }
}
"""
TEST = """\
typedef struct pair { int first, second; } pair;
int sum_of(const int *numbers, int count, pair *at);
int main(void) {
    pair at;
    const int numbers[6] = {1, -5, 60, 7, 99, 1000};
    if (sum_of(numbers, 6, &at) != 1 || at.first != 11 || at.second != -6) return 1;
    if (sum_of(numbers, 0, &at) != 0 || at.first != 0 || at.second != 5) return 2;
    return 0;
}
"""
FILE = "core_c/sum.c"


@pytest.fixture
def small(trials_of):
    trials, sources = trials_of({"sum.c": SOURCE}, {"test_sum.c": TEST})
    return trials, mutants_of(sources, FILE)


def noticed(trials, mutants: list[Mutant], is_over=lambda: False) -> dict[Mutant, str]:
    bench = bench_of(mutants, trials.libraries_of(mutants[0]), trials.compiled.tree(0))
    assert bench is not None
    return {mutant: outcome.verdict for mutant, outcome in bench.noticed(is_over)}


def test_what_is_noticed_behind_switches_is_noticed_alone_and_nothing_else_there(small):
    trials, mutants = small
    found, tree = noticed(trials, mutants), trials.compiled.tree(1)
    placed = Switched.of(SOURCE.encode(), mutants).places
    alone = {mutant: trials.outcome(mutant, tree).verdict for mutant in mutants}
    assert {mutant: alone[mutant] for mutant in found} == found
    switched = {mutant for k, mutant in enumerate(mutants) if k in placed}
    assert {mutant for mutant in switched if alone[mutant] in ("killed", "timeout")} == set(found)


def test_constants_tables_and_labels_have_no_switch(small):
    _, mutants = small
    placed = Switched.of(SOURCE.encode(), mutants).places
    without = {mutant.before for k, mutant in enumerate(mutants) if k not in placed}
    assert without == {"static const int steps[2 + 1] = {1, 2, 3};", "case 3: return 7;"}


def test_a_fault_that_does_not_compile_is_left_out_and_the_others_stay(trials_of):
    source = """typedef struct one { int a; } one;
        int of(const one *it, int k) { return it == (void *)0 ? -k : it->a * k; }\n"""
    test = """typedef struct one { int a; } one;\nint of(const one *it, int k);
        int main(void) { one it = {3}; return of(&it, 2) != 6; }\n"""
    trials, sources = trials_of({"sum.c": source}, {"test_sum.c": test})
    wrong = [Mutant(FILE, "of", 2, "by hand", "", "", source.index("it->a"), source.index("it->a") + 5, text, text)
             for text in ("*it", "it->b", "it->a + 1")]
    found = noticed(trials, wrong)
    assert {mutant.text for mutant in found} == {"it->a + 1"}
    assert (trials.compiled.folder / "tree0" / FILE).read_text() == (sources / FILE).read_text()


def test_a_file_that_takes_the_compiler_too_long_has_no_bench(small, monkeypatch):
    trials, mutants = small
    monkeypatch.setattr("laconic.mutation.switches.COMPILER_S", 0)
    assert bench_of(mutants, trials.libraries_of(mutants[0]), trials.compiled.tree(0)) is None
    assert (trials.compiled.folder / "tree0" / FILE).read_text() == SOURCE


def test_a_bench_ends_when_it_is_over(small):
    trials, mutants = small
    assert noticed(trials, mutants, is_over=lambda: True) == {}
