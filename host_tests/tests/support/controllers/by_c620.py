"""A client of C620 speed controllers, from their public manual, as the controller: speed loops that answer the drives'
feedback with currents, as fast as it comes."""

from __future__ import annotations

import math
import struct

import can

from controllers.bench import Bench
from controllers.cycles import Cycles
from laconic.errors import ResultFails

SCENE = "robomaster_mecanum"
SILENCE_S = 5.0
DRIVES = 4
CURRENTS, FEEDBACK = 0x200, 0x201
FULL_SCALE = 16384                       # 20 A
RAW_PER_RPM, RAW_PER_RPM_S = 10.0, 100.0
MOST_RPM = 2000.0
NEAR_RPM = 60.0                          # 3 % of that


class SpeedLoops:
    """Four of them. A command follows when all four drives have spoken."""

    def __init__(self, bus: can.BusABC, step_s: float):
        self.bus, self.step_s = bus, step_s
        self.wanted_rpm, self.rpm, self._sum = [0.0] * DRIVES, [0] * DRIVES, [0.0] * DRIVES
        self._spoken: set[int] = set()

    def hear(self, message: can.Message) -> bool:
        """Takes a frame; whether it was answered by a command."""
        number = message.arbitration_id - FEEDBACK
        if not 0 <= number < DRIVES:
            return False
        _, self.rpm[number], _, _ = struct.unpack(">HhhBx", message.data)
        self._spoken.add(number)
        if len(self._spoken) < DRIVES:
            return False
        self._spoken.clear()
        data = struct.pack(">4h", *(self._raw(each) for each in range(DRIVES)))
        self.bus.send(can.Message(arbitration_id=CURRENTS, data=data, is_extended_id=False))
        return True

    def arrived(self) -> bool:
        """Whether the drives turn as they should."""
        return all(math.isclose(seen, wanted, abs_tol=NEAR_RPM) for seen, wanted in
                   zip(self.rpm, self.wanted_rpm, strict=True))

    def _raw(self, number: int) -> int:
        error = self.wanted_rpm[number] - self.rpm[number]
        wanted = RAW_PER_RPM * error + self._sum[number]
        if abs(wanted) < FULL_SCALE:
            self._sum[number] += RAW_PER_RPM_S * error * self.step_s
        return round(max(-FULL_SCALE, min(FULL_SCALE, wanted)))


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
