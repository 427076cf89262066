"""MISRA C:2012: no rule is violated that no deviation explains, and a new violation is noticed."""

import shutil
from pathlib import Path

import pytest

from laconic.static_checks.deviations import DEVIATIONS
from laconic.static_checks.misra import counted, findings_of, places, unexplained
from laconic.static_checks.misra_page import shown, stale_rules, table
from laconic.static_checks.parts import PARTS

MANDATORY = {"9.1", "12.5", "13.6", "17.3", "17.4", "17.6", "19.1", "21.13", "21.17", "21.18", "21.19", "21.20",
             "22.2", "22.4", "22.5", "22.6"}
NEW = """\
int laconic_made_up(void);
int laconic_made_up(void) { return 010; } /* an octal number */
"""
needs_cppcheck = pytest.mark.skipif(shutil.which("cppcheck") is None, reason="cppcheck is not installed")


def test_no_mandatory_rule_is_deviated_from():
    assert not MANDATORY & set(DEVIATIONS)
    assert {deviation.category for deviation in DEVIATIONS.values()} == {"Advisory", "Required"}


def test_every_deviation_is_needed_and_the_page_is_within_their_limits():
    assert stale_rules() == []


def test_the_page_shows_what_its_table_is_made_of():
    text = table(shown())
    for rule in shown():
        assert DEVIATIONS[rule].reason in text
    assert sum(map(len, shown().values())) > 50


@needs_cppcheck
def test_a_new_violation_is_named_with_its_place(tmp_path: Path):
    made_up = tmp_path / "made_up.c"
    made_up.write_text(NEW, encoding="utf-8")
    core = next(part for part in PARTS if part.name == "core")
    found = findings_of(core, [made_up])
    lines = unexplained({rule: by for rule, by in counted(found).items() if rule == "7.1"})
    assert [line.split(",")[0] for line in lines] == ["rule 7.1"]
    assert places(found, lines) == [f"7.1 {made_up}:2"]


@needs_cppcheck
def test_a_limit_counts_places():
    one = {"20.4": counted([("20.4", "core_c/src/common.h", 51)])["20.4"]}
    two = counted([("20.4", "core_c/src/common.h", line) for line in (51, 52)])
    assert unexplained(one) == []
    assert unexplained(two) == ["rule 20.4, core: 2 places, the deviation allows 1"]


@needs_cppcheck
def test_the_shortest_method_has_no_unexplained_violation():
    core = next(part for part in PARTS if part.name == "core")
    found = findings_of(core, [Path("core_c/src/rk4.c")])
    assert len(found) > 20
    assert unexplained(counted(found)) == []
