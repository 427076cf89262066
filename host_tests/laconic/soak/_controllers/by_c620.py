"""The client of C620 speed controllers as the controller: it goes on as fast as their feedback comes."""

from __future__ import annotations

from laconic.errors import ResultFails
from laconic.soak._controllers.bench import Bench
from laconic.soak._controllers.c620 import DRIVES, MOST_RPM, SpeedLoops
from laconic.soak._controllers.cycles import Cycles

SCENE = "robomaster_mecanum"
SILENCE_S = 5.0


def control(bench: Bench, cycles: Cycles) -> None:
    """Drives the vehicle; ResultFails where the drives do not follow."""
    with bench.bus() as bus:
        loops = SpeedLoops(bus, bench.scene.run.step_s)
        while cycles.go_on(loops.arrived):
            message = bus.recv(SILENCE_S)
            if message is None:
                bench.check()
                raise ResultFails(f"the drives were silent for {SILENCE_S:g} s after {cycles.done} cycles")
            loops.wanted_rpm = [MOST_RPM * cycles.share(number % 2) for number in range(DRIVES)]  # ahead and round
            if loops.hear(message):
                cycles.end()
        if not loops.arrived():
            raise ResultFails(f"the drives turn with {loops.rpm} rpm where {loops.wanted_rpm} were wanted")
