"""Where a played vehicle went, from its own truth: pose at the end and way."""

from __future__ import annotations

from typing import Protocol

LOOK_US = 10_000

Pose = tuple[float, float, float]  # x [m], y [m] of the centre of mass, heading [rad]


class Travelling(Protocol):
    """A vehicle that knows where it is."""

    tells_motion: bool  # whether speed() is known while it plays

    def speed(self) -> tuple[float, float]:
        """Of the centre of mass [m/s], and yaw rate [rad/s], both without sign."""

    def pose(self) -> Pose | None:
        """At the end; None where it is not known."""


class Journey:
    """Adds up the way of the centre of mass; called in the loop."""

    def __init__(self, vehicle: Travelling):
        self.vehicle, self.way_m = vehicle, 0.0
        self._last_us: int | None = None

    def __call__(self, now_us: int) -> int:
        if self._last_us is None:
            self._last_us = now_us
        elif now_us >= self._last_us + LOOK_US:
            self.way_m += self.vehicle.speed()[0] * (now_us - self._last_us) / 1e6
            self._last_us = now_us
        return self._last_us + LOOK_US

    def figures(self) -> dict[str, float]:
        """For the table: what is known of it."""
        pose = self.vehicle.pose()
        found = dict(zip(("end_x_m", "end_y_m", "end_heading_rad"), pose, strict=True)) if pose is not None else {}
        return found | ({"way_m": self.way_m} if self.vehicle.tells_motion else {})
