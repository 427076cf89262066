"""FMU instances of both versions and kinds made, used and freed under sanitizers: memory stays as it was, and threads
with their own instances have the same bits and no race."""

from __future__ import annotations

import subprocess
from pathlib import Path

from assurance.common import Clock, called, each, of_targets, once, work

TARGETS = ("Laconic_fmi2", "Laconic_fmi3", "laconic_fmu_core")
CYCLES, THREADS = 2000, 8


def run_fmu(clock: Clock, seed: int) -> list[str]:
    """Cycles until the time is over, and the threads once."""
    cycles, threads = program("address,undefined"), program("thread")
    wrong, done = complaint([threads, "threads", str(THREADS)]), 0
    while not wrong and (done == 0 or clock):
        wrong = complaint([cycles, "cycles", str(CYCLES)])
        done += CYCLES
    print(f"  {done} cycles of four instances, {THREADS} threads")
    return wrong


def program(sanitizers: str) -> Path:
    """fmu_endurance.c with the interface under these sanitizers."""
    own, folder = of_targets(*TARGETS), work("long")
    out = folder / f"fmu-{sanitizers}"
    checks = [f"-fsanitize={sanitizers}", "-fno-sanitize-recover=all"]
    flags = ["-std=c99", "-O1", "-g", "-w", "-ffp-contract=off", *checks]
    objects = [folder / f"{sanitizers}-{number}.o" for number in range(len(own))]
    each([["gcc", *flags, *entry.headers(), "-c", entry.source, "-o", made]
          for entry, made in zip(own, objects, strict=True)])
    called(["gcc", *flags, *once(flag for entry in own for flag in entry.headers()),
            Path(__file__).with_name("fmu_endurance.c"), *objects, "-lpthread", "-o", out])
    return out


def complaint(command: list[str | Path]) -> list[str]:
    """What it prints where it fails."""
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return [] if done.returncode == 0 else [(done.stderr or done.stdout)[-600:]]
