"""What parts that a firmware may add cost on a Cortex-M4F: instructions under QEMU, and flash."""

from __future__ import annotations

import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from laconic.base.paths import SOURCE_DIR
from laconic.errors import BadInput
from laconic.scene import read_scene
from laconic.scene.methods import EXPLICIT
from laconic.tools.report.counting import count_on_board, host_state, instructions_by_kind, size_of_step
from laconic.tools.report.workshop import M4F, Variant, Workshop, run_tool

# ---- soft_double.c beside libgcc's addition: an addition, and a step.

SOFT_DOUBLE = SOURCE_DIR / "core_c" / "optional" / "soft_double" / "soft_double.c"
KINDS = {"sum": "a + b, instructions", "difference": "a - b, instructions", "cancellation": "a - b, close together",
         "zero": "a + 0"}
PAIRS = 1000
Row = dict[str, Any]


def soft_double_rows() -> list[Row]:
    """A row for each figure, with soft_double.c and with libgcc; BadInput where compiler or emulator are missing."""
    if not M4F.present:
        raise BadInput("no arm-none-eabi-gcc with its C library, or no qemu-system-arm here: install both")
    with TemporaryDirectory() as folder:
        ours, theirs = (additions(Path(folder), soft) for soft in (True, False))
        table = [{"who": text, "soft_double": ours[kind], "libgcc": theirs[kind]} for kind, text in KINDS.items()]
        for method in (EXPLICIT, "auto"):
            table += step_rows(Path(folder), method)
    return table


def additions(folder: Path, soft_double: bool) -> dict[str, float]:
    """Instructions of one addition, by kind."""
    counted = instructions_by_kind(M4F, "count_add", [SOFT_DOUBLE] if soft_double else [], (), folder)
    return {name: round(value / PAIRS, 1) for name, value in counted.items()}


def step_rows(folder: Path, method: str) -> list[Row]:
    """Instructions and flash of a step of s1, and whether its bits are this machine's."""
    variant = Variant(read_scene("s1").with_run(method=method), "double", "-O2")
    found = {}
    for name, soft in (("soft_double", True), ("libgcc", False)):
        workshop = Workshop(folder / f"{method}_{name}", soft_double=soft)
        ran = count_on_board(workshop, M4F, variant)
        same = host_state(workshop.host_program(variant), ran.steps) == ran.state
        found[name] = (round(ran.instructions), size_of_step(workshop, M4F, variant).flash, "yes" if same else "NO")
    titles = ("instructions", "flash B", "host's bits")
    return [{"who": f"step of s1, {method}, {title}"} | {name: values[k] for name, values in found.items()}
            for k, title in enumerate(titles)]


# ---- A code behind a frame: for two keys and messages.

FIRMWARE = SOURCE_DIR / "firmware_stub"
CODE_SOURCES = ("aes", "cmac", "secoc")
CODE_KINDS = {"key": "a key, once", "seal_8": "code of a frame of 8 bytes", "open_8": "its check",
              "seal_64": "code of a frame of 64 bytes"}
INCLUDES = (f"-I{FIRMWARE / 'include'}",)
ROUNDS = 5


def code_rows() -> list[Row]:
    """A row for each figure; `other_key`: the same with another key and message, which must not differ."""
    if not M4F.present:
        raise BadInput("no arm-none-eabi-gcc with its C library, or no qemu-system-arm here: install both")
    with TemporaryDirectory() as folder:
        counted = code_instructions(Path(folder))
        flash = flash_bytes(Path(folder))
    table = [{"who": text, "instructions": counted[kind], "other_key": counted[f"{kind}_other"]}
             for kind, text in CODE_KINDS.items()]
    return [*table, {"who": "flash B of aes, cmac and secoc", "instructions": flash, "other_key": ""}]


def code_instructions(folder: Path) -> dict[str, int]:
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
    return [FIRMWARE / "secure" / f"{name}.c" for name in CODE_SOURCES]
