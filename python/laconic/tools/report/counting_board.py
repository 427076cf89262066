"""A board under QEMU that counts its own instructions: how an image runs there, and one that counts calls by kind."""

from __future__ import annotations

import subprocess
from collections.abc import Sequence
from pathlib import Path

from laconic.errors import ResultFails
from laconic.tools.report.binary_tools import run_tool
from laconic.tools.report.workshop import BENCH, Target

CALIBRATED_INSTRUCTIONS = 65536  # of the loop whose ticks an image prints as "calibration"


def lines_of_board(target: Target, image: Path, timeout_s: float = 60.0) -> tuple[list[str], int]:
    """What an image prints, with one instruction every 256 ns, and its exit status."""
    command = ["qemu-system-arm", "-M", target.machine, "-nographic", "-monitor", "none", "-serial", "none", "-icount",
               "shift=8", "-semihosting-config", "enable=on,target=native", "-kernel", str(image)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=timeout_s, stdin=subprocess.DEVNULL,
                          check=False)
    return [line for line in (done.stdout + done.stderr).splitlines() if line.strip()], done.returncode


def stopped_early(target: Target, image: Path, lines: Sequence[str]) -> ResultFails:
    """What to raise where an image did not print all."""
    return ResultFails(f"{image.name} on {target.machine} stopped early: {' '.join(lines[-2:])}")


def instructions_by_kind(target: Target, counter: str, sources: Sequence[Path], flags: Sequence[str],
                         folder: Path) -> dict[str, float]:
    """Of the loops of `counter`, a file of the core's bench, linked with `sources`."""
    console, startup = BENCH / "cortex_m", BENCH.parent / "cortex_m"
    image = folder / f"{counter}.elf"
    files = [console / f"{counter}.c", console / "bench_board.c", startup / "startup.c", *sources]
    run_tool([target.tool("gcc"), *target.flags, "-O2", "-std=c99", *flags, f"-I{console}", f"-I{startup}",
              f"-L{startup}", "-ffreestanding", "-nostartfiles", *map(str, files), f"-T{target.script}", "-o",
              str(image)])
    lines, status = lines_of_board(target, image, 120.0)
    if status != 0:
        raise stopped_early(target, image, lines)
    ticks = {name: int(value) for name, value in map(str.split, lines)}
    per_instruction = ticks.pop("calibration") / CALIBRATED_INSTRUCTIONS
    return {name: value / per_instruction for name, value in ticks.items()}
