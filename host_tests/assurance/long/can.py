"""Long runs over CAN: one node process for as long as it lasts, played vehicles, all scenes on the rig."""

from __future__ import annotations

import random
import sys
from importlib.util import find_spec
from pathlib import Path

from assurance.common import ROOT, Clock
from laconic.can.rig.boards import own_node, why_no_emulation
from laconic.can.rig.free_judge import judge_free_run
from laconic.can.rig.judge import judge_same_bits
from laconic.can.rig.verdict import Judgement
from laconic.core import REALS
from laconic.scene import read_scene, rigid_scene_names

# ---- One node process: lockstep with the core's bits and free runs at 1 kHz in turn, new vehicles all the time. Its
# memory may not grow, no motion may be another than the core's, and its own checks of memory must stay silent.

LOCKSTEP_STEPS, FREE_S, RATE_HZ, MOST_GROWTH_KB = 5_000, 10.0, 1000, 1024
OF_THE_MACHINE = ("punctuality", "clock", "envelope")  # verdicts of lateness


def run_node(clock: Clock, seed: int) -> list[str]:
    """Turns until the time is over, two at least."""
    source, bad, memory_kb, late = random.Random(seed), list[str](), list[int](), 0.0
    with own_node("process", "double") as node:
        while len(memory_kb) < 2 or clock:
            name, fd = source.choice(rigid_scene_names()), source.choice((False, True))
            scene = read_scene(name).with_run(real="double")
            bad += wrong(f"{name}, lockstep", judge_same_bits(node, scene, LOCKSTEP_STEPS, every=20, fd=fd))
            free = read_scene("turtlebot3_burger").with_run(step_s=1.0 / RATE_HZ, duration_s=FREE_S, real="double")
            judgement = judge_free_run(node, free, FREE_S, RATE_HZ, 200, {}, moved=lambda _: None)
            bad += wrong("free run", judgement)
            late += judgement.figures.get("late_periods", 0)
            memory_kb.append(resident_kb())
    growth_kb = memory_kb[-1] - memory_kb[0]
    print(f"  {len(memory_kb)} turns, {late:g} late periods, {memory_kb[-1]} kB of memory, {growth_kb} kB more than "
          "at first")
    return bad + ([f"memory grew by {growth_kb} kB"] if growth_kb > MOST_GROWTH_KB else [])


def wrong(what: str, judgement: Judgement) -> list[str]:
    """Failed verdicts, but lateness, which is the machine's."""
    return [f"{what}: {each.name}: {each.detail}" for each in judgement.verdicts
            if not each.passed and each.name not in OF_THE_MACHINE]


def resident_kb() -> int:
    """Resident memory of the youngest node; 0 where the system does not state it."""
    for process in sorted(Path("/proc").glob("[0-9]*"), key=lambda each: -int(each.name)):
        try:
            if "laconic-node" in (process / "cmdline").read_text(encoding="utf-8", errors="replace").split("\0")[0]:
                return int((process / "status").read_text(encoding="utf-8").split("VmRSS:")[1].split()[0])
        except (OSError, IndexError):
            continue
    return 0


# ---- Controllers that others wrote drive a played vehicle, on a process and on an emulated Cortex-M4F: every step of
# its wheels has the core's bits for the torques of the drives.

CYCLES = 1000


def run_play(clock: Clock, seed: int) -> list[str]:
    """Each controller on each board in turn; nothing is drawn."""
    sys.path.insert(0, str(ROOT / "host_tests/tests/support"))
    from controllers import CONTROLLERS
    from controllers import run as drive

    boards = ["process"] + ([] if why_no_emulation() else ["an386"])
    bad, done = list[str](), 0
    while done == 0 or clock:
        for board in boards:
            for protocol in CONTROLLERS:
                if protocol == "odrive" and find_spec("odrive_can") is None:
                    continue  # it needs Python 3.11
                verdict = drive(protocol, board, CYCLES)
                print(f"  {protocol} on {board}: {verdict}", flush=True)
                bad += [] if verdict.startswith("passed") else [f"{protocol} on {board}: {verdict}"]
        done += 1
    return bad


# ---- All scenes in lockstep on the virtual bus and over SLCAN to a process, each with the bits of the core.

RIG_STEPS = 10_000


def run_rig(clock: Clock, seed: int) -> list[str]:
    """Scenes, scalar types, frames and lines in random order."""
    source, bad, done = random.Random(seed), list[str](), 0
    while done == 0 or clock:
        name, real = source.choice(rigid_scene_names()), source.choice(REALS)
        fd, kind = source.choice((False, True)), source.choice(("virtual", "process"))
        with own_node(kind, real) as node:
            judgement = judge_same_bits(node, read_scene(name).with_run(real=real), RIG_STEPS, every=20, fd=fd)
        done += 1
        bad += [] if judgement.passed else [f"{name}, {real}, {kind}, {'FD' if fd else 'classic'}"]
    print(f"  {done} runs of {RIG_STEPS} steps")
    return bad
