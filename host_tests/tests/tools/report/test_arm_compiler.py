"""A cross compiler without its C library (Debian's bare gcc-arm-none-eabi) is distinguished from a whole one."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from laconic.base.paths import SOURCE_DIR
from laconic.tools.report import workshop

pytestmark = pytest.mark.skipif(shutil.which("cmake") is None, reason="no cmake here")

COMPILER = "arm-none-eabi-gcc"
BARE = """#!/bin/sh
case "$*" in *nano.specs*) echo "$0: fatal error: cannot read spec file 'nano.specs': No such file" >&2; exit 1;; esac
echo "ld: cannot find -lc" >&2
exit 1
"""


def lacking(compiler: Path | str, folder: Path) -> str:
    """What a compiler lacks, in the words of CMake."""
    script = folder / "try.cmake"
    script.write_text(f'include("{SOURCE_DIR}/cmake/LaconicArmGcc.cmake")\nlaconic_arm_gcc_lacks(it)\n'
                      'message(STATUS "lacks ${it}")\n')
    done = subprocess.run(["cmake", f"-DLACONIC_ARM_GCC={compiler}", "-P", str(script)], cwd=folder, text=True,
                          capture_output=True, check=True)
    assert done.stdout.count("\n") == 1 and not done.stderr
    return done.stdout.strip().removeprefix("-- lacks").strip()


@pytest.fixture
def bare(tmp_path) -> Path:
    """A compiler that finds no C library."""
    path = tmp_path / COMPILER
    path.write_text(BARE)
    path.chmod(0o755)
    return path


def test_a_compiler_without_newlib_builds_no_firmware_and_one_line_reports_why(bare, tmp_path):
    message = lacking(bare, tmp_path)
    assert "nano.specs" in message and "install libnewlib-arm-none-eabi" in message


def test_no_compiler_is_reported_in_one_line(tmp_path):
    assert lacking("LACONIC_ARM_GCC-NOTFOUND", tmp_path) == f"no {COMPILER}"


@pytest.mark.skipif(not workshop.M4F.present, reason="no whole arm-none-eabi-gcc or no qemu-system-arm here")
def test_a_whole_compiler_lacks_nothing(tmp_path):
    assert lacking(shutil.which(COMPILER) or "", tmp_path) == ""


def test_the_bench_does_not_take_a_compiler_without_newlib_for_a_board(bare, monkeypatch):
    monkeypatch.setenv("PATH", str(bare.parent), prepend=":")
    workshop.can_link.cache_clear()
    try:
        assert not workshop.can_link(COMPILER, workshop.M4F.flags, bare=True)
    finally:
        workshop.can_link.cache_clear()
