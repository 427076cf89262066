"""Long runs of commands that make studies: `sweep` and `identify`."""

from __future__ import annotations

import hashlib
import random
import subprocess
import sys
import tempfile
import time
from contextlib import suppress
from pathlib import Path

import numpy as np

from assurance.common import ROOT, Clock

# ---- Sweeps that are killed at random instants, each compared with one that nothing disturbs.

LEAST_RUNS, MOST_RUNS, LONGEST_S = 3_000, 30_000, 600.0
SWEPT = ("paper_three_wheel_driven", "turtlebot3_burger", "kuka_youbot")


def run_sweep(clock: Clock, seed: int) -> list[str]:
    """One sweep after the other; each is killed some times before it comes to its end."""
    source, bad, done = random.Random(seed), list[str](), 0
    while done == 0 or clock:
        arguments = [source.choice(SWEPT), "--vary", "vehicle.mass_kg~uniform(1,20)", "--samples",
                     str(source.randrange(LEAST_RUNS, MOST_RUNS)), "--seed", str(source.randrange(2**31))]
        with tempfile.TemporaryDirectory() as folder:
            whole, killed = Path(folder, "whole"), Path(folder, "killed")
            began_s = time.monotonic()
            sweep(arguments, whole, LONGEST_S)
            took_s = time.monotonic() - began_s
            for limit_s in [source.uniform(0.2, 0.9) * took_s for _ in range(source.randrange(1, 4))] + [LONGEST_S]:
                sweep(arguments, killed, limit_s)
            if not digest(whole) or digest(whole) != digest(killed):
                bad.append(" ".join(arguments))
        done += 1
    print(f"  {done} sweeps")
    return bad


def sweep(arguments: list[str], folder: Path, limit_s: float) -> None:
    """One that is killed unless it ends within this time."""
    with suppress(subprocess.TimeoutExpired):
        subprocess.run([sys.executable, "-m", "laconic", "sweep", *arguments, "-o", str(folder)], timeout=limit_s,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)


def digest(folder: Path) -> str:
    """Of the results; empty where there are none."""
    file = folder / "results.parquet"
    return hashlib.sha256(file.read_bytes()).hexdigest() if file.exists() else ""


# ---- Made-up robots: do the 95 % intervals of `laconic identify` hold the true parameters in 93 to 97 % of all
# cases?

TRIALS = 1000
LEAST_HELD, MOST_HELD = 0.93, 0.97


def run_identify(clock: Clock, seed: int) -> list[str]:
    """So many trials, fewer where the time is over before: then the limits are wider by three standard deviations."""
    sys.path.insert(0, str(ROOT / "host_tests/tests/support"))
    from synthetic import ROBOTS, trials

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
    return [] if LEAST_HELD - margin <= share <= MOST_HELD + margin else [f"{share:.4f} of the intervals hold"]
