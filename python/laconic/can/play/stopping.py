"""Where a played vehicle went, and whether it stopped in time: by its own truth, not by what the drives say."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import can

from laconic.can.rig.verdict import Verdict
from laconic.errors import BadInput

LOOK_US = 10_000
COASTS = ("a drive that is off lets its wheel coast, which only friction ends, and this scene has none: give "
          "[vehicle.motor] viscous_friction_Nms, or [ground] friction_coefficient and axle_friction_Nm")
STANDS_M_PER_S, STANDS_RAD_PER_S = 0.01, 0.02

Pose = tuple[float, float, float]  # x [m], y [m] of the centre of mass, heading [rad]


class Moving(Protocol):
    """A vehicle whose motion is known."""

    def speed(self) -> tuple[float, float]:
        """Of the centre of mass [m/s], and yaw rate [rad/s], both without sign."""


@dataclass(frozen=True)
class Limits:
    """What --stop-within and --stop-distance ask for."""

    within_s: float | None = None
    distance_m: float | None = None

    @property
    def are_given(self) -> bool:
        """Whether there is anything to judge."""
        return self.within_s is not None or self.distance_m is not None

    def check(self) -> None:
        """BadInput for a limit that no vehicle can meet."""
        for name, value in (("--stop-within", self.within_s), ("--stop-distance", self.distance_m)):
            if value is not None and not 0.0 < value < float("inf"):
                raise BadInput(f"{name} {value:g}: give a number above 0")


class Witness:
    """Measures time and way from a mark to standstill; called in the loop.

    The mark is the first fault: of `first_fault`, seconds since the start once it has come. Where there are no faults
    it is the last frame of the controller."""

    def __init__(self, vehicle: Moving, first_fault: Callable[[], float | None] | None, *,
                 coasts: bool = False):
        self.vehicle, self.first_fault, self.coasts = vehicle, first_fault, coasts
        self._start_us: int | None = None
        self._now_us = self._next_us = 0
        self._way_m = 0.0
        self._moved_s: float | None = None     # when it last moved
        self._mark: tuple[float, float] | None = None  # time, and the way until then

    def heard(self, message: can.Message) -> None:
        """A frame of the controller, where its silence is judged."""
        if self.first_fault is None and self._start_us is not None:
            self._mark = (self._seconds(), self._way_m)

    def _seconds(self) -> float:
        return (self._now_us - (self._start_us or 0)) / 1e6

    def __call__(self, now_us: int) -> int:
        if self._start_us is None:
            self._start_us = self._now_us = self._next_us = now_us
        if now_us >= self._next_us:
            speed, yaw_rate = self.vehicle.speed()
            self._way_m += speed * (now_us - self._now_us) / 1e6
            self._next_us = now_us + LOOK_US
            self._now_us = now_us
            if speed > STANDS_M_PER_S or yaw_rate > STANDS_RAD_PER_S:
                self._moved_s = self._seconds()
            if self.first_fault is not None and self._mark is None and self.first_fault() is not None:
                self._mark = (self._seconds(), self._way_m)
        return self._next_us

    def verdict(self, limits: Limits) -> Verdict:
        """Whether it stood after so long and so far, and until the end."""
        if self._mark is None:
            return Verdict("stopped", False, "no fault came, so there was nothing to stop for"
                           if self.first_fault is not None else "no controller was heard")
        if self._moved_s is None:
            return Verdict("stopped", False, "the vehicle never moved, so there was nothing to stop")
        since_s, before_m = self._mark
        took_s = max(0.0, self._moved_s - since_s)
        way_m = self._way_m - before_m
        stands = self._moved_s < self._seconds()
        what = "the first fault" if self.first_fault is not None else "the controller's last frame"
        detail = f"{took_s:.3g} s and {way_m:.3g} m after {what} at {since_s:.3g} s"
        if not stands:
            hint = f"; {COASTS}" if self.coasts else ""
            return Verdict("stopped", False, f"still moving at the end, {detail}{hint}", took_s, limits.within_s or 0.0)
        passed = (limits.within_s is None or took_s <= limits.within_s) and (
            limits.distance_m is None or way_m <= limits.distance_m)
        return Verdict("stopped", passed, detail, took_s, limits.within_s or 0.0)


# ---- the way

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
