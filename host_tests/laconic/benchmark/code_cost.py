"""What a code behind a frame costs on a Cortex-M4F: instructions under QEMU, for two keys and messages, and flash."""

from __future__ import annotations

import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from laconic.benchmark.counting import CALIBRATED_INSTRUCTIONS
from laconic.benchmark.workshop import BENCH, M4F, run_tool
from laconic.errors import BadInput
from laconic.paths import SOURCE_DIR

NODE = SOURCE_DIR / "firmware_stub"
SOURCES = ("aes", "cmac", "secoc")
KINDS = {"key": "a key, once", "seal_8": "code of a frame of 8 bytes", "open_8": "its check",
         "seal_64": "code of a frame of 64 bytes"}
ROUNDS = 5
Row = dict[str, Any]


def rows() -> list[Row]:
    """A row for each figure; `other_key`: the same with another key and message, which must not differ."""
    if not M4F.present:
        raise BadInput("no arm-none-eabi-gcc with its C library, or no qemu-system-arm here: install both")
    with TemporaryDirectory() as folder:
        counted = instructions(Path(folder))
        flash = flash_bytes(Path(folder))
    table = [{"who": text, "instructions": counted[kind], "other_key": counted[f"{kind}_other"]}
             for kind, text in KINDS.items()]
    return [*table, {"who": "flash B of aes, cmac and secoc", "instructions": flash, "other_key": ""}]


def instructions(folder: Path) -> dict[str, int]:
    """By kind, each with the loop and the call around it."""
    console, startup = BENCH / "cortex_m", BENCH.parent / "cortex_m"
    image = folder / "count_code.elf"
    sources = [console / "count_code.c", console / "bench_board.c", startup / "startup.c", *_of_node()]
    run_tool([M4F.tool("gcc"), *_flags(), f"-I{console}", f"-I{startup}", f"-L{startup}", "-ffreestanding",
              "-nostartfiles", *map(str, sources), f"-T{M4F.script}", "-o", str(image)])
    command = ["qemu-system-arm", "-M", M4F.machine, "-nographic", "-monitor", "none", "-serial", "none", "-icount",
               "shift=8", "-semihosting-config", "enable=on,target=native", "-kernel", str(image)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, stdin=subprocess.DEVNULL, check=True)
    ticks = {name: int(value) for name, value in
             (line.split() for line in (done.stdout + done.stderr).splitlines() if line.strip())}
    per_instruction = ticks.pop("calibration") / CALIBRATED_INSTRUCTIONS
    return {name: round(value / per_instruction / ROUNDS) for name, value in ticks.items()}


def flash_bytes(folder: Path) -> int:
    """Code and constants of the three files."""
    total = 0
    for source in _of_node():
        made = folder / f"{source.stem}.o"
        run_tool([M4F.tool("gcc"), *_flags(), "-c", str(source), "-o", str(made)])
        text = subprocess.run([M4F.tool("size"), str(made)], capture_output=True, text=True, check=True).stdout
        total += int(text.splitlines()[1].split()[0])
    return total


def _of_node() -> list[Path]:
    return [NODE / "secure" / f"{name}.c" for name in SOURCES]


def _flags() -> list[str]:
    return [*M4F.flags, "-O2", "-std=c99", f"-I{NODE / 'include'}"]
