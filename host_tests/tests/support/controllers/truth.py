"""What a node that plays says of its own steps, beside the core: the core takes the torques of the drives that the node
names and must have the node's wheel motion after each step, bit for bit."""

from __future__ import annotations

from typing import Any

import can
import numpy as np

from laconic.can.rig.link import Link
from laconic.can.rig.wire import wire
from laconic.scene import Scene

SELECTED = {"raw_wheel_speed": 1, "raw_wheel_angle": 1, "raw_axle_torque": 1}  # numbers of a row, in this order
RAW_FRAMES = {"RAW_OUTPUT": 2, "RAW_OUTPUT_FD": 4}  # bytes before the numbers


class Truth:
    """The core beside a node. `scene` is the one that plays, without motors of its own."""

    def __init__(self, scene: Scene, link: Link):
        self.plant = scene.plant(scene.core())
        self.steps = self.parts_missing = 0
        self.first_difference: str | None = None
        self.most_speed_rad_per_s = self.most_torque_Nm = 0.0
        self.torque_Nm: Any = np.zeros(scene.wheel_count)  # of the last step
        self._wheels, self._dtype = scene.wheel_count, self.plant.core.dtype
        self._held = self.plant.core.ffi.new("laconic_input *")
        self._heads = {link.id_base + wire()[name].offset: head for name, head in RAW_FRAMES.items()}
        self._bytes, self._parts = b"", 0
        link.listeners.append(self.hear)

    def hear(self, message: can.Message) -> None:
        """A frame of the node's own."""
        head = self._heads.get(message.arbitration_id)
        if head is None or message.is_extended_id:
            return
        part, modulus = (message.data[3], 256) if head == 4 else (message.data[1] >> 4, 16)
        if part != self._parts % modulus:
            self.parts_missing += 1
            self._bytes, self._parts = b"", 0
            if part != 0:
                return
        self._bytes += bytes(message.data[head:])
        self._parts += 1
        if len(self._bytes) >= 3 * self._wheels * self._dtype.itemsize:
            row = np.frombuffer(self._bytes, self._dtype, 3 * self._wheels)
            self._bytes, self._parts = b"", 0
            self._step(row)

    def _step(self, row: np.ndarray) -> None:
        count = self._wheels
        speeds, angles, self.torque_Nm = row[:count], row[count : 2 * count], row[2 * count :]
        self.steps += 1
        self.most_speed_rad_per_s = max(self.most_speed_rad_per_s, float(np.abs(speeds).max()))
        self.most_torque_Nm = max(self.most_torque_Nm, float(np.abs(self.torque_Nm).max()))
        if self.first_difference is not None:
            return
        for wheel, torque_Nm in enumerate(self.torque_Nm):
            self._held.axle_torque_Nm[wheel] = torque_Nm
        self.plant.run(self._held)
        for what, seen, core in (("speed", speeds, self.plant.wheel_speeds()), ("angle", angles,
                                                                                 self.plant.wheel_angles())):
            if seen.tobytes() != np.asarray(core, self._dtype).tobytes():
                self.first_difference = f"wheel {what}s after step {self.steps}: {seen} on the node, {core} by the core"
                return

    def complaint(self, steps: int) -> str | None:
        """Why this was no run with equal bits; None: it was. `steps`: how many the node has taken."""
        if self.steps != steps or self.parts_missing:
            return (f"{steps - self.steps} of the node's {steps} steps were not seen: the line is too slow for their "
                    "frames; give a longer --step")
        return self.first_difference
