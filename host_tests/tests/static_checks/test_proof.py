"""The proof's arguments belong to lines that are there, and an alarm without one is noticed."""

import shutil
from pathlib import Path

import pytest

from laconic.paths import SOURCE_DIR
from laconic.static_checks.discharged import DISCHARGED
from laconic.static_checks.frama_c import CORE, NODE, Program, alarms_of, prove

PAGE = SOURCE_DIR / "docs" / "proof.md"
PRINTED = """\
[eva:alarm] core_c/src/vector.h:17: Warning:
  accessing uninitialized left-value. assert \\initialized(v + 0);
[eva] Recording results for vec
[eva:alarm] core_c/src/vector.h:17: Warning:
  accessing out of bounds index. assert k < 3;
[eva:summary] ====== ANALYSIS SUMMARY ======
"""
UNSOUND = """\
static int numbers[3];
void prove_made_up(void);
void prove_made_up(void) { for (int k = 0; k <= 3; k++) numbers[k] = k; }
"""


def test_each_argument_is_about_a_line_that_is_there_and_stands_on_the_page():
    page = " ".join(PAGE.read_text(encoding="utf-8").split())
    for file, part, _, argument in DISCHARGED:
        assert part in (SOURCE_DIR / file).read_text(encoding="utf-8"), (file, part)
        assert argument in page, argument


def test_an_alarm_of_another_kind_at_the_same_line_is_open():
    unset, index = alarms_of("prove_rk4", PRINTED)
    assert unset.discharged and not index.discharged
    assert str(index).startswith("core_c/src/vector.h:17: accessing out of bounds index")


def test_every_entry_stands_on_the_page():
    page = PAGE.read_text(encoding="utf-8")
    entries = [entry.removeprefix("prove_") for program in (CORE, NODE) for entry in program.entries()]
    assert len(entries) >= 28 and all(f"`{entry}`" in page for entry in entries)


@pytest.mark.skipif(shutil.which("frama-c") is None, reason="Frama-C is not installed")
def test_an_index_beyond_its_array_is_an_open_alarm(tmp_path: Path):
    harness = tmp_path / "made_up.c"
    harness.write_text(UNSOUND, encoding="utf-8")
    found = prove(Program("made up", str(harness), (), ()), "prove_made_up", limit_s=120.0)
    assert [alarm.discharged for alarm in found] == [False] and "out of bounds index" in found[0].what
