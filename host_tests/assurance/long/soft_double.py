"""The core's soft addition beside the addition of this machine's processor, on pairs of which half are any bits, the
others those that rounding is sensitive to."""

from __future__ import annotations

import subprocess
from pathlib import Path

from assurance.common import ROOT, Clock, called, work

FOLDER = ROOT / "core_c/optional/soft_double"
PAIRS = 5_000_000  # between two looks at the clock


def run(clock: Clock, seed: int) -> list[str]:
    """Pairs with new seeds."""
    program, done = work("long") / "soft_double", 0
    called(["gcc", "-std=c99", "-O2", "-ffp-contract=off", f"-I{FOLDER}", Path(__file__).with_suffix(".c"),
            FOLDER / "soft_double.c", "-o", program])
    while done == 0 or clock:
        ran = subprocess.run([program, str(seed), str(PAIRS)], capture_output=True, text=True, check=False)
        if ran.returncode != 0:
            return [ran.stdout.strip() or f"stopped with status {ran.returncode}"]
        done, seed = done + PAIRS, seed + 1
    print(f"  {done} pairs")
    return []
