"""The purity check must be able to fail: each thing that the core must not do is shown to it once."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

CHECK = Path(__file__).parents[4] / "cmake" / "check_purity.py"
COMPILER = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
needs_tools = pytest.mark.skipif(not (COMPILER and shutil.which("objdump")), reason="no compiler or no objdump")


def judge(folder: Path, text: str, *flags: str, build: bool = True) -> subprocess.CompletedProcess[str]:
    source = folder / "sample.c"
    source.write_text(text)
    command = [sys.executable, str(CHECK), "--sources", str(source)]
    if build:
        built = folder / "sample.o"
        subprocess.run([COMPILER, "-std=c99", "-c", *flags, str(source), "-o", str(built)], check=True)
        command += ["--objects", str(built)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@needs_tools
def test_a_pure_file_passes(tmp_path):
    text = '#include <stdint.h>\nstatic const int table[2] = {1, 2};\nint f(int i) { return table[i]; }\n'
    assert judge(tmp_path, text).returncode == 0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("#include <math.h>\n", "includes math.h"),
        ('#include "fmi3Functions.h"\n', "includes fmi3Functions.h"),
        ("#include SOME_HEADER\n", "by the macro SOME_HEADER"),
        ("double f(double x) { return __builtin_sqrt(x); }\n", "__builtin_sqrt"),
    ],
)
def test_a_source_that_reaches_outside_is_named(tmp_path, text, message):
    verdict = judge(tmp_path, text, build=False)
    assert verdict.returncode == 1
    assert message in verdict.stderr


@needs_tools
@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("double sin(double); double f(double x) { return sin(x) + 1.0; }\n", "calls sin"),
        ("void *malloc(unsigned long); void *f(void) { return malloc(8); }\n", "calls malloc"),
        ("int counter = 3; int f(void) { return counter++; }\n", "writable data in .data"),
        ("int f(void) { static int n; return n++; }\n", "writable data in .bss"),
    ],
)
def test_an_object_that_reaches_outside_is_named(tmp_path, text, message):
    verdict = judge(tmp_path, text)
    assert verdict.returncode == 1
    assert message in verdict.stderr


@needs_tools
def test_fused_multiply_add_is_found(tmp_path):
    text = "double f(double a, double b, double c) { return a * b + c; }\n"
    flags = ["-O2", "-march=x86-64-v3", "-ffp-contract=fast"]
    probe = subprocess.run([COMPILER, *flags, "-E", "-x", "c", "/dev/null"], capture_output=True, check=False)
    if probe.returncode:
        pytest.skip("this compiler does not build for x86-64-v3")
    verdict = judge(tmp_path, text, *flags)
    assert verdict.returncode == 1
    assert "not the same bits" in verdict.stderr
