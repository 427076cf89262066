"""Double precision on Cortex-M3 and M4: this machine's bits with soft_double.c, libgcc's faults found without."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from assurance.targets import board_lines
from laconic.base.paths import SOURCE_DIR, built
from laconic.cli.main import run
from laconic.tools.report.workshop import BOARDS, M4F, run_tool

CORE = SOURCE_DIR / "core_c"
M3 = next(board for board in BOARDS if board.name == "Cortex-M3")
STEPS = 16  # of each trajectory; host_tests/assurance/targets.py takes all
SMALLEST = "a - b with a = 3ff0000000000000, b = 3de0000000000001 gives 3fefffffffefffff, not 3feffffffff00000"

needs_boards = pytest.mark.skipif(not M4F.present, reason="no arm-none-eabi-gcc or qemu-system-arm")
needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="no gcc")


@needs_gcc
def test_this_machine_computes_the_answers_that_check_double_knows(tmp_path: Path):
    program = tmp_path / "check"
    run_tool(["gcc", "-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Wpedantic", "-Werror", "-O2",
              str(CORE / "optional" / "soft_double" / "check_double.c"), "-o", str(program)])
    assert run_tool([str(program)]) == "double: sound\n"


@needs_boards
def test_the_linked_file_makes_double_precision_sound_on_a_cortex_m3(tmp_path: Path):
    assert board_lines(M3, tmp_path) == ["sound", "double: sound"]


@needs_boards
def test_self_test_and_check_double_find_what_libgcc_rounds_wrongly_and_nothing_else(tmp_path: Path):
    lines = board_lines(M4F, tmp_path, soft_double=False)
    if lines == ["sound", "double: sound"]:
        pytest.skip("this compiler's library rounds right")
    assert "link soft_double.c" in lines[0] and lines[-1] == "double: WRONG"
    assert SMALLEST in lines
    assert {line[:5] for line in lines[1:-1]} == {"a + b", "a - b"}


@pytest.mark.nightly
@needs_boards
@needs_gcc
def test_it_makes_double_precision_sound_on_a_cortex_m4f_and_trajectories_have_this_machines_bits(tmp_path: Path):
    program = tmp_path / "hash"
    run_tool(["gcc", "-O0", "-ffp-contract=off", f"-DSTEPS={STEPS}", "-I", str(built("amalgamation")), "-I",
              str(CORE / "include"), str(CORE / "tests" / "bits" / "trajectory_hash.c"),
              str(built("amalgamation/laconic.c")), "-o", str(program)])
    hashes = [f"hash {line}" for line in run_tool([str(program)]).split()]
    assert hashes and board_lines(M4F, tmp_path, steps=STEPS) == ["sound", "double: sound", *hashes]


@needs_boards
def test_every_function_of_libgccs_object_with_the_adder_is_ours(tmp_path: Path):
    """Else a program that calls another would link libgcc's object besides, and the linker refuse the second adder."""
    listed = run_tool([M4F.tool("gcc"), *M4F.flags, "-print-libgcc-file-name"]).strip()
    objects = run_tool([M4F.tool("nm"), "--defined-only", listed]).split("\n\n")
    theirs = next(text for text in objects if " T __aeabi_dadd" in text)
    names = [line.split()[2] for line in theirs.splitlines() if " T " in line]
    soft = tmp_path / "soft_double.o"
    source = CORE / "optional/soft_double/soft_double.c"
    run_tool([M4F.tool("gcc"), *M4F.flags, "-O2", "-c", str(source), "-o", str(soft)])
    ours = [line.split()[2] for line in run_tool([M4F.tool("nm"), "--defined-only", str(soft)]).splitlines()]
    assert set(names) <= set(ours)


@pytest.mark.skipif(not M4F.present or shutil.which("cmake") is None, reason="no arm-none-eabi-gcc or no cmake")
@pytest.mark.parametrize(("processor", "has_it"), [("cortex-m4", True), ("cortex-m7", False)])
def test_cmake_puts_it_into_the_core_where_the_processor_needs_it(processor: str, has_it: bool, tmp_path: Path):
    toolchain = SOURCE_DIR / "cmake" / "cortex_m.cmake"
    run_tool(["cmake", "-S", str(CORE), "-B", str(tmp_path), "--toolchain", str(toolchain),
              f"-DLACONIC_CPU={processor}", "-DLACONIC_REALS=double"])
    rules = (path for name in ("build.make", "build.ninja") for path in tmp_path.rglob(name))  # of either generator
    assert any("soft_double" in path.read_text() for path in rules) == has_it


def test_laconic_core_gives_it_out_beside_the_two_files(tmp_path: Path):
    assert run(["core", "--soft-double", "-o", str(tmp_path)]) == 0
    for name in ("soft_double.h", "soft_double.c", "check_double.c"):
        assert (tmp_path / name).read_bytes() == (CORE / "optional" / "soft_double" / name).read_bytes()
