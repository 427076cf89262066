"""Controllers that others wrote drive a played vehicle, on a process and on an emulated Cortex-M4F: every step of its
wheels has the core's bits for the torques of the drives."""

from __future__ import annotations

import sys
from importlib.util import find_spec

from assurance.common import ROOT, Clock
from laconic.can.rig.boards import why_no_emulation

CYCLES = 1000


def run(clock: Clock, seed: int) -> list[str]:
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
