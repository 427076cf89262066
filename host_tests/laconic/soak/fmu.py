"""Random use of the whole C interface of the FMUs under AddressSanitizer and UndefinedBehaviorSanitizer."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from typing import Any

from laconic.paths import SOURCE_DIR, build_dir, built

SLICE_S = 5.0


def soak(minutes: float, seed: int, advance: Callable[[float], None]) -> dict[str, Any]:
    """Runs the kept corpus, then new inputs; an input that a sanitizer stops is kept in build/fuzz/fmu_culprit.bin."""
    program, culprit = built("fuzz/fmu_fuzz"), build_dir() / "fuzz" / "fmu_culprit.bin"
    corpus = sorted((SOURCE_DIR / "fmu" / "tests" / "corpus_fmi").glob("*"))
    result = subprocess.run([str(program), *map(str, corpus)], capture_output=True, text=True)
    left_s, inputs, slices = 60.0 * minutes, len(corpus), 0
    while left_s > 0.0 and result.returncode == 0:
        slice_s = min(SLICE_S, left_s)
        result = subprocess.run([str(program), "--seconds", f"{slice_s:.3f}", "--seed", str(seed + 1_000_003 * slices),
                                 "--out", str(culprit)], capture_output=True, text=True)
        inputs += int(result.stdout.strip() or 0)
        left_s, slices = left_s - slice_s, slices + 1
        advance(slice_s)
    found = result.returncode != 0
    lines = result.stderr.splitlines()
    summary = next((line for line in lines if "SUMMARY" in line or "runtime error" in line), "crash")
    return {"passed": not found, "inputs": inputs,
            "found": f"{summary}; replay: {program} {culprit}" if found else "nothing"}
