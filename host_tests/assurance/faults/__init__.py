"""Faults of a node in virtual time: each bit of its memory flipped in the midst of a session, its power lost between
any two events, its clock wrong; and, over the virtual bus, the rig's matrix of lost, late and changed frames.

    faults [--only memory|power|clocks|frames] [--sample N] [--minutes M] [--seed S]

A flipped bit is harmless where the motion stays the same to the last bit, noticed where node, core or rig report it,
silent where the motion is another and nobody reports it. With all checks on none may be silent, and none may end in a
wrong pointer or a call without end."""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections import Counter
from pathlib import Path

from assurance.common import PARTS, ROOT, Clock, Unusable, build, called, of_targets, once, work

HERE = Path(__file__).parent
KINDS = ("memory", "power", "clocks", "frames")
CHECKS = ("none", "sum", "all")
REALS = ("double", "single")
BY_OTHERS = ("harmless", "silent", "crash", "hang")


def program(real: str) -> Path:
    """The campaign of one scalar type, without sanitizers: a flipped bit may do what it does on a board."""
    rig = next((ROOT / PARTS["node"] / "tests").rglob("rig.c"))
    headers = once(flag for entry in of_targets(f"laconic_node_{real}") for flag in entry.headers())
    out = work("faults") / f"campaign_{real}"
    archives = [next(build().rglob(f"lib{name}.a"), None)
                for name in (f"laconic_node_{real}", f"laconic{'_single' if real == 'single' else ''}", "laconic_wire")]
    if None in archives:
        raise Unusable(f"the node is not built; cmake --build {build()} --target laconic_node")
    sources = [*sorted(HERE.glob("*.c")), rig]
    called(["gcc", "-O2", "-std=c99", *headers, f"-I{rig.parent}", *sources, *filter(None, archives), "-o", out])
    return out


def memory(sample: int, seed: int, reals: tuple[str, ...] = REALS, choices: tuple[str, ...] = CHECKS) -> bool:
    """So many bits of each scalar type, without checks, with sums and ranges, and with all."""
    sound = True
    for real in reals:
        made = program(real)
        for checks in choices:
            found = Counter[str]()
            bits = int(called([made, "bits"]).split()[1])
            printed = called([made, "memory", "0", str(min(sample, bits)), str(seed), checks], 1e5)
            for _, outcome, count, *_ in (line.split("|") for line in printed.splitlines()):
                found[outcome] += int(count)
            noticed = sum(count for outcome, count in found.items() if outcome not in BY_OTHERS)
            restarts = found["crash"] + found["hang"]
            print(f"memory, {real}, checks {checks}: {found.total()} of {bits} bits, {found['harmless']} harmless, "
                  f"{noticed} noticed, {found['silent']} silent, {restarts} restarts", flush=True)
            sound &= checks != "all" or found["silent"] + restarts == 0
    return sound


def session(kind: str, reals: tuple[str, ...] = REALS) -> bool:
    """Power or clocks, whole; the program fails where a figure is not as it must be."""
    sound = True
    for real in reals:
        done = subprocess.run([program(real), kind], capture_output=True, text=True, check=False)
        for line in done.stdout.splitlines():
            print(f"{kind}, {real}, {line.replace('|', ', ')}")
        print(f"{kind}, {real}: {'passed' if done.returncode == 0 else 'FAILED'}", flush=True)
        sound &= done.returncode == 0
    return sound


def frames(clock: Clock, seed: int) -> bool:
    """The matrix of faults of frames, with a new seed each time; once at least."""
    sys.path.insert(0, str(ROOT / "host_tests/tests/support"))
    from fault_matrix import run_matrix

    cases = injected = 0
    bad: list[str] = []
    while cases == 0 or clock:
        for row in run_matrix(seed):
            cases, injected = cases + 1, injected + row.injected
            if not row.good or row.undetected:
                bad.append(f"{row.fault} on {row.frame}: {row.undetected} undetected, {'; '.join(row.problems)}")
        seed += 1
    print(f"frames: {cases} cases, {injected} faults, {len(bad)} wrong", *bad, sep="\n  ")
    return not bad


def arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--only", choices=KINDS)
    parser.add_argument("--sample", type=int, default=20_000, metavar="N", help="bits of memory, 20000 by default")
    parser.add_argument("--minutes", type=float, default=1.0, help="of frames, 1 by default")
    parser.add_argument("--seed", type=int, default=1)


def run(options: argparse.Namespace) -> bool:
    """All kinds, or one."""
    sound = True
    for kind in KINDS if options.only is None else (options.only,):
        if kind == "memory":
            sound &= memory(options.sample, options.seed)
        elif kind == "frames":
            sound &= frames(Clock(options.minutes), options.seed)
        else:
            sound &= session(kind)
    return sound
