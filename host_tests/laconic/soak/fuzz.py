"""SLCAN reader, frame handler, parameter loader and drives under libFuzzer with sanitizers, the time shared evenly."""

from __future__ import annotations

import re
import subprocess
import time
from collections.abc import Callable
from typing import Any

from laconic.errors import BadInput
from laconic.paths import SOURCE_DIR, build_dir, built

TARGETS = ("slcan", "frames", "loader", "canopen", "odrive", "robomaster", "moteus")
SLICE_S = 5.0


def soak(minutes: float, seed: int, advance: Callable[[float], None]) -> dict[str, Any]:
    """Runs each target so many minutes; new inputs are kept in build/fuzz, apart from the corpus of the sources."""
    result: dict[str, Any] = {"passed": True}
    for number, target in enumerate(TARGETS):
        runs, coverage, crash = fuzz(target, 60.0 * minutes, seed + number, lambda s: advance(s / len(TARGETS)))
        result[target] = f"{runs} inputs, {coverage} edges, " + (f"FOUND: {crash}" if crash else "nothing found")
        result["passed"] &= not crash
    return result


def fuzz(target: str, seconds: float, seed: int, advance: Callable[[float], None]) -> tuple[int, int, str]:
    """(inputs tried, edges covered, file with the input that fails, or "")."""
    program, fresh = built(f"fuzz/fuzz_{target}"), build_dir() / "fuzz" / target
    fresh.mkdir(exist_ok=True)
    command = [str(program), f"-max_total_time={max(1, round(seconds))}", f"-seed={seed % 2**31 or 1}", "-max_len=2000",
               "-rss_limit_mb=1024", f"-artifact_prefix={fresh}/", str(fresh),
               str(SOURCE_DIR / "firmware_stub" / "fuzz" / "corpus" / target)]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as process:
        log, last = [], time.monotonic()
        for line in process.stderr or ():
            log.append(line)
            now = time.monotonic()
            if now - last > SLICE_S:
                advance(now - last)
                last = now
    text = "".join(log)
    if process.returncode and "libFuzzer" not in text and "SUMMARY" not in text and "Test unit" not in text:
        raise BadInput(f"{program}: is no libFuzzer target; install clang with libclang-rt and build again")
    crash = re.search(r"Test unit written to (\S+)", text)
    runs = re.search(r"Done (\d+) runs", text)
    edges = re.findall(r"cov: (\d+)", text)
    return int(runs.group(1)) if runs else 0, int(edges[-1]) if edges else 0, crash.group(1) if crash else ""
