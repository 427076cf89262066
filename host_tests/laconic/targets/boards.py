"""Cortex-M boards under QEMU: core_c/tests/board_bits.c with the core as one file."""

from __future__ import annotations

import subprocess
from pathlib import Path

from laconic.benchmark.binary_tools import run_tool
from laconic.benchmark.workshop import BENCH, Target
from laconic.errors import ResultFails
from laconic.paths import SOURCE_DIR, built

CORE = SOURCE_DIR / "core_c"
SOFT_DOUBLE = CORE / "soft_double"
LONGEST_S = 900.0  # zig builds the C library of a target when it is asked for it first


def board_lines(board: Target, folder: Path, *, real: str = "double", soft_double: bool = True, steps: int = 0,
                optimisation: str = "-O0") -> list[str]:
    """The output of a board: the self-test's finding, the lines of check_double.c and, with so many steps of each
    trajectory, `hash …`. Without `soft_double` libgcc adds."""
    image = board_image(board, folder, real=real, soft_double=soft_double, steps=steps, optimisation=optimisation)
    command = ["qemu-system-arm", "-M", board.machine, "-nographic", "-monitor", "none", "-serial", "none",
               "-semihosting-config", "enable=on,target=native", "-kernel", str(image)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST_S, stdin=subprocess.DEVNULL,
                          check=False)
    lines = [line for line in (done.stdout + done.stderr).splitlines() if line.strip()]
    if done.returncode != 0:
        raise ResultFails(f"{board.name} stopped early: {' '.join(lines[-2:])}")
    return lines


def board_image(board: Target, folder: Path, *, real: str, soft_double: bool, steps: int, optimisation: str) -> Path:
    """Compiles it; without steps the core is its self-test alone."""
    start, console, tests = CORE / "cortex_m", BENCH / "cortex_m", CORE / "tests"
    chosen = [f"-DSTEPS={steps}", "-DLACONIC_HASH"] if steps else []
    if real == "single":
        chosen.append("-DLACONIC_SINGLE")
    flags = [optimisation, *board.flags, *chosen, "-std=c99", "-ffp-contract=off", "-ffunction-sections",
             "-fdata-sections", "-DCHECK_DOUBLE_MAIN=0", '-DPRIx64="llx"',
             f"-I{CORE / 'include'}", f"-I{CORE / 'src'}", f"-I{console}", f"-I{start}"]
    compiler, out = board.tool("gcc"), folder / f"{board.name}.elf"
    sources = [tests / "board_bits.c", SOFT_DOUBLE / "check_double.c", console / "bench_board.c", start / "startup.c",
               built("amalgamation/laconic.c") if steps else CORE / "src" / "self_test.c"]
    if soft_double:
        sources.append(SOFT_DOUBLE / "soft_double.c")
    if steps:
        trajectories = folder / f"{board.name}.trajectories.o"
        run_tool([compiler, *flags, "-Dmain=laconic_trajectory_hash", "-c", str(tests / "trajectory_hash.c"), "-o",
                  str(trajectories)])
        sources.append(trajectories)
    run_tool([compiler, *flags, *map(str, sources), "-nostartfiles", "-Wl,--gc-sections", f"-L{start}",
              f"-T{board.script}", "-o", str(out)])
    return out
