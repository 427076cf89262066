"""core_c/soft_double beside the addition of this machine's processor, on pairs of which half are any bits, the others
those that rounding is sensitive to."""

from __future__ import annotations

import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from laconic.benchmark.binary_tools import run_tool
from laconic.benchmark.workshop import HOST
from laconic.errors import BadInput
from laconic.paths import SOURCE_DIR

CORE = SOURCE_DIR / "core_c"
PAIRS = 20_000_000  # between two looks at the clock
FLAGS = ("-std=c99", "-O2", "-ffp-contract=off")


def soak(minutes: float, seed: int, advance: Callable[[float], None]) -> dict[str, Any]:
    """Pairs with new seeds until the time is up or one differs."""
    if lacking := HOST.missing:
        raise BadInput(f"soak soft-double: needs {lacking}")
    began, done, wrong = time.monotonic(), 0, ""
    with TemporaryDirectory() as folder:
        program = Path(folder) / "soak_soft_double"
        sources = [CORE / "tests" / "soak_soft_double.c", CORE / "soft_double" / "soft_double.c"]
        run_tool(["gcc", *FLAGS, f"-I{CORE / 'soft_double'}", *map(str, sources), "-o", str(program)])
        while not wrong and time.monotonic() - began < 60.0 * minutes:
            before = time.monotonic()
            ran = subprocess.run([str(program), str(seed), str(PAIRS)], capture_output=True, text=True, check=False)
            wrong = "" if ran.returncode == 0 else ran.stdout.strip() or f"stopped with status {ran.returncode}"
            done, seed = done + PAIRS, seed + 1
            advance(time.monotonic() - before)
    return {"passed": not wrong, "pairs": done, **({"wrong": wrong} if wrong else {})}
