"""Sweeps that are killed at random instants, each compared with one that nothing disturbs."""

from __future__ import annotations

import hashlib
import random
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

RUNS_AT_LEAST, RUNS_AT_MOST = 3_000, 30_000
LONGEST_S = 600.0
SCENES = ("paper_three_wheel_driven", "turtlebot3_burger", "kuka_youbot")


def soak(minutes: float, seed: int, advance: Callable[[float], None]) -> dict[str, Any]:
    """One sweep after the other until the time is up; each is killed some times before it comes to its end."""
    source, sweeps, kills, bad = random.Random(seed), 0, 0, []
    began = last = time.monotonic()
    while time.monotonic() - began < 60.0 * minutes:
        with tempfile.TemporaryDirectory() as folder:
            found, killed = _disturbed(source, Path(folder))
        sweeps, kills = sweeps + 1, kills + killed
        bad += [found] if found else []
        now = time.monotonic()
        advance(now - last)
        last = now
    return {"passed": not bad, "sweeps": sweeps, "kills": kills, "bad": bad}


def _disturbed(source: random.Random, folder: Path) -> tuple[str, int]:
    """What differs, empty where nothing does, and how often the sweep was killed."""
    runs, scene = source.randrange(RUNS_AT_LEAST, RUNS_AT_MOST), source.choice(SCENES)
    arguments = [scene, "--vary", "vehicle.mass_kg~uniform(1,20)", "--samples", str(runs), "--seed",
                 str(source.randrange(2**31))]
    took_s = time.monotonic()
    _run(arguments, folder / "whole", LONGEST_S)
    took_s = time.monotonic() - took_s
    kills = source.randrange(1, 4)
    for _ in range(kills):
        _run(arguments, folder / "killed", source.uniform(0.2, 0.9) * took_s)
    _run(arguments, folder / "killed", LONGEST_S)
    whole, killed = (_digest(folder / name) for name in ("whole", "killed"))
    return ("" if whole and whole == killed else f"{' '.join(arguments)}: {whole} and {killed}"), kills


def _run(arguments: list[str], folder: Path, at_most_s: float) -> None:
    """A sweep that is killed unless it ends within this time."""
    with suppress(subprocess.TimeoutExpired):
        subprocess.run([sys.executable, "-m", "laconic", "sweep", *arguments, "-o", str(folder)], timeout=at_most_s,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)


def _digest(folder: Path) -> str:
    """Of the results; empty where there are none."""
    file = folder / "results.parquet"
    return hashlib.sha256(file.read_bytes()).hexdigest() if file.exists() else ""
