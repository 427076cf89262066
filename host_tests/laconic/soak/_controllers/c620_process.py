"""The C620 client in a process of its own, on the port of `laconic play --listen`: one command for each feedback of all
drives, until the port is closed. It says "ready" when it has read its modules, and waits for the port.

    python -m laconic.soak._controllers.c620_process PORT STEP_S
"""

from __future__ import annotations

import sys
import time
from contextlib import suppress

import can

from laconic.rig.buses import open_bus
from laconic.rig.errors import CannotReach
from laconic.soak._controllers.c620 import DRIVES, MOST_RPM, SpeedLoops

PATIENCE_S = 20.0


def connected(port: str) -> can.BusABC:
    """The bus, as soon as somebody listens there."""
    until = time.monotonic() + PATIENCE_S
    while True:
        try:
            return open_bus("slcan", f"socket://127.0.0.1:{port}")
        except CannotReach:
            if time.monotonic() > until:
                raise
            time.sleep(0.01)


def main(port: str, step_s: str) -> None:
    """Drives ahead at half the speed."""
    print("ready", flush=True)
    with suppress(can.CanError, OSError), connected(port) as bus:
        loops = SpeedLoops(bus, float(step_s))
        loops.wanted_rpm = [0.5 * MOST_RPM] * DRIVES
        while True:  # until play ends
            if (message := bus.recv(1.0)) is not None:
                loops.hear(message)


if __name__ == "__main__":
    main(*sys.argv[1:])
