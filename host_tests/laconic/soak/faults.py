"""The fault matrix repeatedly, with new seeds."""

from __future__ import annotations

import random
import time
from collections.abc import Callable
from typing import Any

from laconic.benchmark.fault_matrix import run_matrix
from laconic.benchmark.watched_ends import Row


def soak(minutes: float, seed: int, advance: Callable[[float], None]) -> dict[str, Any]:
    """Runs the matrix, with a new seed each time, until the time is up."""
    source, cases, injected, bad = random.Random(seed), 0, 0, []
    began = last = time.monotonic()
    while time.monotonic() - began < 60.0 * minutes:
        for row in run_matrix(source.randrange(2**31)):
            cases, injected = cases + 1, injected + row.injected
            bad += [describe(row)] if not row.good or row.undetected else []
            now = time.monotonic()
            advance(now - last)
            last = now
            if now - began >= 60.0 * minutes:
                break
    return {"passed": not bad, "cases": cases, "faults": injected, "bad": bad}


def describe(row: Row) -> str:
    """One case in one line."""
    return f"{row.fault} on {row.frame}: {row.undetected} undetected, {'; '.join(row.problems) or 'no other problem'}"
