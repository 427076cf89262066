"""FMU instances of both versions and kinds made, used and freed, under AddressSanitizer: memory stays as it was."""

from __future__ import annotations

import signal
import subprocess
import time
from collections.abc import Callable
from typing import Any

from laconic.paths import built
from laconic.soak import StoppedEarly

OPTIONS = ("cycles",)
SEED = 1  # nothing is drawn


def length(cycles: int = 100_000) -> float:
    """Cycles."""
    return float(cycles)


def soak(minutes: float, seed: int, advance: Callable[[float], None], cycles: int = 100_000) -> dict[str, Any]:
    """So many cycles, whatever minutes and seed; each with an instance of each version and kind, steps and states."""
    began, done = time.monotonic(), 0
    with subprocess.Popen([str(built("fuzz/fmu_endurance")), "cycles", str(cycles)], stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        wrong: list[str] = []
        try:
            for line in process.stderr or ():
                if line.strip().isdigit():
                    advance(int(line) - done)
                    done = int(line)
                else:
                    wrong.append(line.strip())
        except KeyboardInterrupt as stop:
            process.send_signal(signal.SIGINT)
            raise StoppedEarly({"passed": not wrong, "cycles": done, "wrong": wrong}) from stop
        told = (process.stdout.read() if process.stdout else "").strip()
    passed = process.returncode == 0 and not wrong
    return {"passed": passed, "cycles": cycles, "told": told, "wrong": wrong or "nothing",
            "cycles_per_s": round(cycles / (time.monotonic() - began))}
