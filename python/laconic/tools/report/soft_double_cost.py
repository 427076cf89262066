"""What soft_double.c costs beside libgcc's addition on a Cortex-M4F: instructions of an addition and of a step under
QEMU, and flash."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from laconic.base.paths import SOURCE_DIR
from laconic.errors import BadInput
from laconic.scene import read_scene
from laconic.scene.methods import EXPLICIT
from laconic.tools.report.counting import count_on_board, host_state, instructions_by_kind, size_of_step
from laconic.tools.report.workshop import M4F, Variant, Workshop

SOFT_DOUBLE = SOURCE_DIR / "core_c" / "optional" / "soft_double" / "soft_double.c"
KINDS = {"sum": "a + b, instructions", "difference": "a - b, instructions", "cancellation": "a - b, close together",
         "zero": "a + 0"}
PAIRS = 1000
Row = dict[str, Any]


def rows() -> list[Row]:
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
