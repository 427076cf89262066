"""The look for fused multiply-adds in the lanes' objects finds one where there is one, and passes over none."""

from __future__ import annotations

import importlib.util
import os
import platform
import shutil
import subprocess
from pathlib import Path

import pytest

from laconic.paths import SOURCE_DIR

spec = importlib.util.spec_from_file_location("not_fused", SOURCE_DIR / "core_c/tests/not_fused.py")
not_fused = importlib.util.module_from_spec(spec)
spec.loader.exec_module(not_fused)

PRODUCT = """
double fused(double a, double b, double c) { return a * b + c; }
double apart(double a, double b) { return a * b; }
"""


@pytest.mark.skipif(platform.machine() != "x86_64" or not shutil.which("cc") or not shutil.which("objdump"),
                    reason="no C compiler for x86-64 or no objdump")
@pytest.mark.parametrize(("options", "status"), [(["-mfma", "-ffp-contract=fast"], 1), (["-mavx2"], 0),
                                                 (["-mfma", "-ffp-contract=off"], 0)])
def test_a_fused_multiply_add_is_found_with_its_function(tmp_path: Path, capsys, options, status):
    source, made = tmp_path / "product.c", tmp_path / "product.o"
    source.write_text(PRODUCT, encoding="utf-8")
    subprocess.run(["cc", "-O2", "-c", *options, str(source), "-o", str(made)], check=True)
    assert not_fused.main("objdump", [made]) == status
    error = capsys.readouterr().err
    assert ("product.o: fused has vfmadd" in error) is bool(status) and "apart" not in error


def test_without_objdump_the_look_is_skipped_in_one_line(tmp_path: Path, capsys):
    assert not_fused.main(os.fspath(tmp_path / "objdump"), [tmp_path / "a.o"]) == 77
    assert capsys.readouterr().out.startswith("skipped: no objdump") and capsys.readouterr().out == ""


def test_arms_names_of_fused_operations_are_known():
    lines = "f>:\n   0:\tfmadd d0, d1, d2, d0\n   4:\tfmla v0.2d, v1.2d, v2.2d\n   8:\tfmul d0, d1, d2\n"
    assert not_fused.fused(f"0 <{lines}") == ["f has fmadd", "f has fmla"]
