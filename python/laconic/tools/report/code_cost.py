"""What a code behind a frame costs on a Cortex-M4F: instructions under QEMU, for two keys and messages, and flash."""

from __future__ import annotations

import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from laconic.base.paths import SOURCE_DIR
from laconic.errors import BadInput
from laconic.tools.report.counting import instructions_by_kind
from laconic.tools.report.workshop import M4F, run_tool

NODE = SOURCE_DIR / "firmware_stub"
SOURCES = ("aes", "cmac", "secoc")
KINDS = {"key": "a key, once", "seal_8": "code of a frame of 8 bytes", "open_8": "its check",
         "seal_64": "code of a frame of 64 bytes"}
INCLUDES = (f"-I{NODE / 'include'}",)
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
    counted = instructions_by_kind(M4F, "count_code", _of_node(), INCLUDES, folder)
    return {name: round(value / ROUNDS) for name, value in counted.items()}


def flash_bytes(folder: Path) -> int:
    """Code and constants of the three files."""
    total = 0
    for source in _of_node():
        made = folder / f"{source.stem}.o"
        run_tool([M4F.tool("gcc"), *M4F.flags, "-O2", "-std=c99", *INCLUDES, "-c", str(source), "-o", str(made)])
        text = subprocess.run([M4F.tool("size"), str(made)], capture_output=True, text=True, check=True).stdout
        total += int(text.splitlines()[1].split()[0])
    return total


def _of_node() -> list[Path]:
    return [NODE / "secure" / f"{name}.c" for name in SOURCES]
