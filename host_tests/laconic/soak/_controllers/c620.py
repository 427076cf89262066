"""A client of C620 speed controllers, from their public manual: speed loops that answer feedback with currents."""

from __future__ import annotations

import math
import struct

import can

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
