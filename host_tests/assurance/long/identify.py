"""Made-up robots: do the 95 % intervals of `laconic identify` hold the true parameters in 93 to 97 % of all cases?"""

from __future__ import annotations

import numpy as np

from assurance.common import Clock
from laconic.robot.identify.synthetic import ROBOTS, trials

TRIALS = 1000
LEAST, MOST = 0.93, 0.97


def run(clock: Clock, seed: int) -> list[str]:
    """So many trials, fewer where the time is over before: then the limits are wider by three standard deviations."""
    held: dict[str, list[bool]] = {name: [] for name in ROBOTS}
    done = 0
    for trial in trials(TRIALS, seed):
        held[trial.robot] += trial.held()
        done += 1
        if not clock:
            break
    every = [each for several in held.values() for each in several]
    share = float(np.mean(every))
    margin = 3.0 * float(np.sqrt(0.95 * 0.05 / len(every))) if done < TRIALS else 0.0
    print(f"  {done} trials, {len(every)} intervals, {100.0 * share:.2f} % hold;",
          ", ".join(f"{name} {100.0 * np.mean(several):.1f} %" for name, several in held.items() if several))
    return [] if LEAST - margin <= share <= MOST + margin else [f"{share:.4f} of the intervals hold"]
