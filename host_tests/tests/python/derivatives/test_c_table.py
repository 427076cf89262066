"""The table of exact steps for the core's C tests is the one that its maker gives."""

from __future__ import annotations

from laconic.base.paths import SOURCE_DIR
from laconic.core import load
from laconic.tools.verify.exact.trials import METHODS
from references.derivatives.c_table import cases, found_numbers, given_numbers

TABLE = SOURCE_DIR / "core_c/tests/support/exact_steps.h"
RECKONED = (0, 5, 13)  # cases whose results are computed once more


def words(text: str) -> str:
    return " ".join(text.split())


def test_the_committed_table_is_that_of_its_maker():
    table, core = words(TABLE.read_text(encoding="utf-8")), load("double")
    every = list(cases())
    for number, trial in enumerate(every):
        assert words(f"{{{', '.join(given_numbers(trial))}}}, /* {trial.kind} */") in table
        if number in RECKONED:
            rows = [f"{{{', '.join(found_numbers(core, trial, method))}}}" for method in METHODS]
            assert words(", ".join(rows)) in table
    assert f"#define EXACT_CASES {len(every)}" in table
