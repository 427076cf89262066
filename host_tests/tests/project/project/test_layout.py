"""The tree keeps the shape that its documents promise."""

from __future__ import annotations

import ast
import re
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[4]
MOST_LINES_OF_CODE = 400


def test_every_source_file_of_the_core_has_its_test_file():
    sources = {path.stem for path in (ROOT / "core_c/src").glob("*.c")}
    tests = {path.stem.removeprefix("test_") for path in (ROOT / "core_c/tests").glob("test_*.c")}
    assert sources - tests == set()


def test_every_header_of_the_core_serves_more_than_one_file():
    rooms = [ROOT / "core_c" / room for room in ("src", "derivatives")]
    texts = [path.read_text(encoding="utf-8") for room in rooms for path in room.iterdir()]
    users = {path.name: sum(f'#include "{path.name}"' in text for text in texts)
             for path in (ROOT / "core_c/src").glob("*.h")}
    assert {name: count for name, count in users.items() if count < 2} == {}


@pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc")
def test_a_program_that_steps_with_one_method_holds_no_other_and_no_refusals(tmp_path):
    (tmp_path / "main.c").write_text("""#include "laconic/laconic.h"
        static laconic_plant p;
        static laconic_input held;
        int main(void) {
            p.integrator.chosen = &laconic_rk4;
            return laconic_step(&p.model, &p.integrator, &p.state, &held);
        }
        """)
    sections = ["-ffunction-sections", "-fdata-sections", "-Wl,--gc-sections"]
    sources = sorted(map(str, (ROOT / "core_c/src").glob("*.c")))
    subprocess.run(["gcc", "-std=c99", *sections, "-DLACONIC_WITH_PREPARE=0", f"-I{ROOT / 'core_c/include'}", "main.c",
                    *sources, "-o", "program"], cwd=tmp_path, check=True)
    names = subprocess.run(["nm", "program"], cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    functions = set(re.findall(r" [tT] (\w+)", names))
    assert {"laconic_step", "rk4_step"} <= functions
    others = {name for name in functions if name.endswith("_step")} - {"laconic_step", "rk4_step"}
    assert others | functions & {"laconic_step_refusal", "laconic_message", "laconic_prepare", "laconic_phi"} == set()


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


C_COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*", re.DOTALL)
PARTS = ("cmake", "core_c", "firmware_stub", "fmu", "host_tests", "packages/c")
SOURCES = [path for part in PARTS for path in (ROOT / part).rglob("*")
           if path.suffix in (".c", ".h", ".py", ".cmake") or path.name == "CMakeLists.txt"]


def docstrings(tree: ast.Module) -> list[ast.Constant]:
    """Those of the module, its classes and functions."""
    owners = (node for node in ast.walk(tree) if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)))
    return [node.body[0].value for node in owners if ast.get_docstring(node)]


def lines_of_code(path: Path) -> int:
    """Lines that hold more than a comment, a docstring or nothing."""
    text = path.read_text(encoding="utf-8")
    if path.suffix in (".c", ".h"):
        return sum(bool(line.strip()) for line in C_COMMENT.sub("", text).splitlines())
    lines = [line for line in text.splitlines() if line.strip() and not line.strip().startswith("#")]
    comments = docstrings(ast.parse(text)) if path.suffix == ".py" else []
    return len(lines) - sum(len([line for line in text.splitlines()[doc.lineno - 1:doc.end_lineno] if line.strip()])
                            for doc in comments)


def names_its_job(path: Path) -> bool:
    """Whether the file begins with a comment of some words; an empty package file has none to do."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".py":
        comment = ast.get_docstring(ast.parse(text))
        return not text.strip() or (comment is not None and len(comment.split()) > 2)
    comment = re.match(r"/\*(.*?)\*/" if path.suffix in (".c", ".h") else r"#(.*)", text, re.DOTALL)
    return comment is not None and len(comment[1].split()) > 2


def test_every_source_file_begins_with_its_one_job():
    assert len(SOURCES) > 300
    assert [str(path.relative_to(ROOT)) for path in SOURCES if not names_its_job(path)] == []


def test_no_source_file_is_longer_than_a_reader_can_hold():
    longer = {path.name for path in SOURCES if lines_of_code(path) > MOST_LINES_OF_CODE}
    assert longer <= {"laconic.h"}  # the manual of the core, read from top to bottom


def test_no_line_of_code_is_too_long():  # clang-format does not wrap comments, ruff overlooks lines without a blank
    long = [f"{path.relative_to(ROOT)}:{number}" for path in SOURCES if path.suffix in (".c", ".h", ".py")
            for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1) if len(line) > 120]
    assert long == []


def test_nothing_generated_is_committed():
    if not (ROOT / ".git").exists() or shutil.which("git") is None:
        pytest.skip("no checkout, or no git")
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split()
    made = (".fmu", ".o", ".so", ".a", ".pyc", "laconic_dbc.c", "laconic_dbc.h", "unity.c")
    assert [name for name in listed if name.endswith(made)] == []
