"""A node in this process that plays: its C code is called directly, and its drives can be looked at and broken."""

from __future__ import annotations

import math
from collections.abc import Iterator

import can

from laconic.can.play.node_vehicle import LOOK_US, NodeVehicle
from laconic.can.play.settings import DriveSettings
from laconic.can.rig.buses import NodeOnBus
from laconic.can.rig.client import NodeClient
from laconic.can.rig.link import receive_on
from laconic.errors import ResultFails
from laconic.scene import Scene

MOST_STEPS_AT_ONCE = 64


class InProcess(NodeVehicle):
    """A node in this process: its C code is called directly, no frame passes another bus than the controller's."""

    watched = ()  # its drives are looked at

    def __init__(self, client: NodeClient, end: NodeOnBus, scene: Scene, settings: DriveSettings):
        super().__init__(client, scene, settings)
        self.node = end.node
        self._view = self.node.library.ffi.new("laconic_library_drive *")
        self._next_look_us = self._last_us = 0

    def start(self) -> None:
        """As for every node; what came behind the answer to START is the controller's, too."""
        super().start()
        while (message := receive_on(self.client.link.bus, 0.0)) is not None:
            self._hear_early(message)

    tells_motion = True

    def speed(self) -> tuple[float, float]:
        """Of the centre of mass and in yaw, as the node's plant has them."""
        now = self.node.motion()
        return math.hypot(*now.velocity_m_per_s), abs(now.yaw_rate_rad_per_s)

    def signals(self) -> dict[str, float]:
        """Pose, velocities and driven wheels, by the names of a run's signals."""
        now, library = self.node.motion(), self.node.library
        found = {"x_m": float(now.x_m), "y_m": float(now.y_m), "heading_rad": float(now.heading_rad),
                 "velocity_body_m_per_s[1]": float(now.velocity_m_per_s[0]),
                 "velocity_body_m_per_s[2]": float(now.velocity_m_per_s[1]),
                 "yaw_rate_rad_per_s": float(now.yaw_rate_rad_per_s)}
        wheels = self.settings.driven[: self.scene.wheel_count]
        driven = [index for index, has_drive in enumerate(wheels, start=1) if has_drive]
        for number, wheel in enumerate(driven):
            if library.lib.laconic_library_drive_view(self.node.c, number, self._view):
                found |= {f"wheel_angle_rad[{wheel}]": float(self._view.wheel_angle_rad),
                          f"wheel_speed_rad_per_s[{wheel}]": float(self._view.wheel_speed_rad_per_s)}
        return found

    def on_message(self, message: can.Message, now_us: int) -> None:
        """A frame of the controller; the node's own identifiers are not for it."""
        if not self.is_own(message):
            self.node.give(message, now_us)

    def order(self, wheel: int, faults: int) -> None:
        """As the node's own frames would order it, without them."""
        number = sum(self.settings.driven[: wheel - 1])
        self.node.library.lib.laconic_library_drive_order(self.node.c, number, faults)

    def advance(self, now_us: int) -> Iterator[can.Message]:
        """Periods that are due, and the frames of the drives after each."""
        yield from self._take_early()
        self._last_us = now_us
        for _ in range(MOST_STEPS_AT_ONCE):
            self.node.tick(now_us)
            yield from self._frames()
            if self.node.idle_us(now_us) > 0:
                break
        if now_us >= self._next_look_us:
            self._next_look_us = now_us + LOOK_US
            self._look_at_drives()

    def _frames(self) -> Iterator[can.Message]:
        while (message := self.node.take_message()) is not None:
            if self.is_own(message):
                self.take_own(message)
            else:
                yield from self.disturbed(message)

    def idle_us(self, now_us: int) -> int:
        """Microseconds to the next period."""
        return self.node.idle_us(now_us)

    def finish(self) -> None:
        """The period that ends with the run is part of it."""
        due_us = self._last_us + self.node.idle_us(self._last_us)
        if due_us <= self.client.link.clock.now_us():
            self.node.tick(due_us)
        super().finish()

    def _read_pose(self) -> None:
        """Of the node's plant, which no frame rounds."""
        now = self.node.motion()
        self._pose = (now.x_m, now.y_m, now.heading_rad)

    def _look_at_drives(self) -> None:
        self._note_unheard()
        if (state := self.node.inspect()["state"]) != "drives":
            self._ending = ResultFails(f"the node went into state {state}: the core refused a step")

    def _note_unheard(self) -> None:
        """The drives whose watchdog has fired, by name."""
        lib, view = self.node.library.lib, self._view
        for number in range(lib.laconic_library_drive_count(self.node.c)):
            lib.laconic_library_drive_view(self.node.c, number, view)
            if view.unheard:
                self._fired.add(f"drive {view.node_id} heard no controller in time")
