"""The rules of CONTRIBUTING.md hold, no test is forgotten, and a program holds no method that it does not call."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys

import pytest

from laconic.base.paths import SOURCE_DIR

C_TESTS = sorted(path for part in ("core_c", "fmu", "firmware_stub") for path in (SOURCE_DIR / part).rglob("test_*.c"))


@pytest.mark.skipif(not (SOURCE_DIR / ".git").exists() or shutil.which("git") is None,
                    reason="needs a checkout, and git")
def test_the_rules_of_contributing_hold() -> None:
    script = SOURCE_DIR / "host_tests" / "assurance" / "rules.py"
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc")
def test_a_program_that_steps_with_one_method_holds_no_other_and_no_refusals(tmp_path) -> None:
    (tmp_path / "main.c").write_text("""#include "laconic/laconic.h"
        static laconic_plant p;
        static laconic_input held;
        int main(void) {
            p.integrator.chosen = &laconic_rk4;
            return laconic_step(&p.model, &p.integrator, &p.state, &held);
        }
        """)
    sections = ["-ffunction-sections", "-fdata-sections", "-Wl,--gc-sections"]
    core = SOURCE_DIR / "core_c"
    folders = [core / "include", *(path for path in (core / "src").iterdir() if path.is_dir())]
    subprocess.run(["gcc", "-std=c99", *sections, "-DLACONIC_WITH_PREPARE=0", *(f"-I{path}" for path in folders),
                    "main.c", *sorted(map(str, (core / "src").rglob("*.c"))), "-o", "program"],
                   cwd=tmp_path, check=True)
    names = subprocess.run(["nm", "program"], cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    functions = set(re.findall(r" [tT] (\w+)", names))
    assert {"laconic_step", "rk4_step"} <= functions
    others = {name for name in functions if name.endswith("_step")} - {"laconic_step", "rk4_step"}
    assert others | functions & {"laconic_step_refusal", "laconic_message", "laconic_prepare", "laconic_phi"} == set()


@pytest.mark.parametrize("path", C_TESTS, ids=lambda path: path.stem)
def test_every_test_that_is_written_is_run(path) -> None:
    text = path.read_text(encoding="utf-8")
    head = re.compile(r"^static void (\w+)\(void\) \{", re.MULTILINE)
    assert set(head.findall(text)) - set(re.findall(r"\w+", head.sub("", text))) == set()
    assert "RUN_TEST(" in text
