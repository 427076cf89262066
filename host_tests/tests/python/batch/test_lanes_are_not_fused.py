"""The look for fused multiply-adds in the lanes' objects finds one where there is one, and passes over none."""

from __future__ import annotations

import platform
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from laconic.base.paths import SOURCE_DIR

PRODUCT = """
double fused(double a, double b, double c) { return a * b + c; }
double apart(double a, double b) { return a * b; }
"""


@pytest.mark.skipif(platform.machine() != "x86_64" or not shutil.which("cc") or not shutil.which("objdump"),
                    reason="no C compiler for x86-64 or no objdump")
@pytest.mark.parametrize(("options", "status"), [(["-mfma", "-ffp-contract=fast"], 1), (["-mavx2"], 0),
                                                 (["-mfma", "-ffp-contract=off"], 0)])
def test_a_fused_multiply_add_is_found_with_its_function(tmp_path: Path, options, status):
    source, made = tmp_path / "product.c", tmp_path / "product.o"
    source.write_text(PRODUCT, encoding="utf-8")
    subprocess.run(["cc", "-O2", "-c", *options, str(source), "-o", str(made)], check=True)
    found = looked_at("objdump", made)
    assert found.returncode == status
    assert ("product.o: fused has vfmadd" in found.stderr) is bool(status) and "apart" not in found.stderr


def test_without_objdump_the_look_is_skipped_in_one_line(tmp_path: Path):
    found = looked_at(str(tmp_path / "objdump"), tmp_path / "a.o")
    assert (found.returncode, found.stdout.count("\n"), found.stderr) == (77, 1, "")
    assert found.stdout.startswith("skipped: no objdump")


@pytest.mark.skipif(sys.platform == "win32", reason="a shell script stands for objdump")
def test_arms_names_of_fused_operations_are_known(tmp_path: Path):
    objdump = tmp_path / "objdump"
    lines = ("0 <f>:", " 0:\tfmadd d0, d1, d2, d0", " 4:\tfmla v0.2d, v1.2d, v2.2d", " 8:\tfmul d0, d1, d2")
    objdump.write_text("\n".join(["#!/bin/sh", "cat <<END", *lines, "END", ""]), encoding="utf-8")
    objdump.chmod(0o755)
    found = looked_at(str(objdump), tmp_path / "a.o")
    assert found.stderr.splitlines() == ["a.o: f has fmadd", "a.o: f has fmla"]


def looked_at(objdump: str, made: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, str(SOURCE_DIR / "core_c/tests/bits/not_fused.py"), objdump, str(made)],
                          capture_output=True, text=True, check=False)
