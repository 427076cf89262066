"""A thousand made-up robots: do the 95 % intervals of `laconic identify` hold the truth in 93 to 97 % of all cases?"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from laconic.identification.synthetic import ROBOTS, trials

TRIALS = 1000
LEAST, MOST = 0.93, 0.97


def soak(minutes: float, seed: int, advance: Callable[[float], None]) -> dict[str, Any]:
    """So many trials, fewer where the time is over before; passed when the share that holds lies between the limits."""
    held: dict[str, list[bool]] = {name: [] for name in ROBOTS}
    begin, done = time.monotonic(), 0
    for trial in trials(TRIALS, seed):
        held[trial.robot] += trial.held()
        done += 1
        advance(60.0 * minutes / TRIALS)
        if time.monotonic() - begin > 60.0 * minutes:
            break
    every = [each for several in held.values() for each in several]
    share = float(np.mean(every))
    margin = 3.0 * float(np.sqrt(0.95 * 0.05 / len(every))) if done < TRIALS else 0.0
    robots = {name: f"{100.0 * np.mean(several):.1f} % of {len(several)}" for name, several in held.items() if several}
    return {"passed": LEAST - margin <= share <= MOST + margin, "trials": done, "intervals": len(every),
            "held": round(share, 4), **robots}
