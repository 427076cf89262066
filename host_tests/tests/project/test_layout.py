"""The tree keeps the shape that its documents promise."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]


def test_every_source_file_of_the_core_has_its_test_file():
    sources = {path.stem for path in (ROOT / "core_c/src").glob("*.c")}
    tests = {path.stem.removeprefix("test_") for path in (ROOT / "core_c/tests").glob("test_*.c")}
    assert sources - tests == set()


@pytest.mark.parametrize("path", sorted((ROOT / "core_c/tests").glob("test_*.c")), ids=lambda path: path.stem)
def test_every_test_that_is_written_is_run(path):
    text = path.read_text(encoding="utf-8")
    written = set(re.findall(r"^static void (\w+)\(void\) \{", text, re.MULTILINE))
    called = set(re.findall(r"\b(\w+)\(", re.sub(r"^static void \w+\(void\) \{", "", text, flags=re.MULTILINE)))
    run = set(re.findall(r"RUN_TEST\((\w+)\)", text))
    assert written - called - run == set()
    assert run


def test_adapters_hold_no_python_and_do_not_see_each_other():
    for part, other in (("fmu", "firmware_stub"), ("firmware_stub", "fmu")):
        for path in (ROOT / part).rglob("*.[ch]"):
            includes = re.findall(r'#\s*include\s+[<"]([^>"]+)', path.read_text(encoding="utf-8"))
            assert not [name for name in includes if name.startswith(f"{other}/") or name == "Python.h"], path


def test_cortex_m_images_start_in_one_place():
    parts = [ROOT / "core_c", ROOT / "firmware_stub"]
    starts = [path for part in parts for path in part.rglob("*.c") if "void board_reset(void) {" in path.read_text()]
    scripts = [path.name for part in parts for path in part.rglob("*.ld")]
    assert len(starts) == 1, starts
    assert sorted(scripts) == sorted(set(scripts))


def test_the_fmu_decides_in_one_place_whether_a_number_is_finite():
    judging = re.compile(r"\b(\w+) - \1 == 0\.0|<= DBL_MAX && \w+ >= -DBL_MAX")
    places = {path.name for path in (ROOT / "fmu").rglob("*.[ch]") if judging.search(path.read_text(encoding="utf-8"))}
    assert places == {"instance.h"}


def test_nothing_generated_is_committed():
    if not (ROOT / ".git").exists() or shutil.which("git") is None:
        pytest.skip("no checkout, or no git")
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split()
    made = (".fmu", ".o", ".so", ".a", ".pyc", "laconic_dbc.c", "laconic_dbc.h", "unity.c")
    assert [name for name in listed if name.endswith(made)] == []
