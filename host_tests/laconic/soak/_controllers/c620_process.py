"""The C620 client in a process of its own, on the port of `laconic play --listen`: one command for each feedback of all
drives, until the port is closed.

    python -m laconic.soak._controllers.c620_process PORT STEP_S
"""

from __future__ import annotations

import sys

import can

from laconic.rig.buses import open_bus
from laconic.soak._controllers.by_c620 import DRIVES, MOST_RPM, SpeedLoops


def main(port: str, step_s: str) -> None:
    """Drives ahead at half the speed."""
    with open_bus("slcan", f"socket://127.0.0.1:{port}") as bus:
        loops = SpeedLoops(bus, float(step_s))
        loops.wanted_rpm = [0.5 * MOST_RPM] * DRIVES
        try:
            while True:
                if (message := bus.recv(1.0)) is not None:
                    loops.hear(message)
        except (can.CanError, OSError):
            pass  # play has ended


if __name__ == "__main__":
    main(*sys.argv[1:])
