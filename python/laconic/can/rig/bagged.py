"""A run of `laconic rig` or `laconic play` for recordings and viewers, instant by instant while it runs."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

import can
import numpy as np

from laconic.can.rig.link import Link
from laconic.can.rig.wire import WHEELS_A_GROUP, Frame, wire
from laconic.errors import BadInput
from laconic.pictures.views.recorded import Recorded, open_viewers
from laconic.pictures.views.robot_view import Viewer
from laconic.scene import Scene
from laconic.scene.ground import slips

LOOK_US = 10_000     # between two instants of a played vehicle


class FrameViews:
    """Listens to a node's frames with signals: one instant once pose and all wheels have come anew. In free run it
    sends no wheel speeds; without slip they follow from its pseudo-velocities."""

    def __init__(self, viewers: Sequence[Viewer], scene: Scene, id_base: int, now_s: Callable[[], float], *,
                 is_free: bool):
        self.viewers, self.id_base, self.now_s = viewers, id_base, now_s
        self._by_nu = None
        self._has_wheels = not is_free
        if is_free and not slips(scene.vehicle):
            core = scene.core()
            self._by_nu = core.matrices(core.vehicle(scene.vehicle)).wheel_rows
        self._wheels = scene.wheel_count
        self._signals: dict[str, float] = {}
        self._due = self._expected()

    def _expected(self) -> set[str]:
        wheels = range(1, self._wheels + 1) if self._has_wheels or self._by_nu is not None else ()
        return {"x_m", *(f"wheel_speed_rad_per_s[{number}]" for number in wheels)}

    def take(self, message: can.Message) -> None:
        """A frame has passed."""
        frame = wire().by_offset.get(message.arbitration_id - self.id_base)
        if frame is None or message.is_remote_frame or message.is_error_frame:
            return
        found = self._of(frame, bytes(message.data))
        self._signals |= found
        self._due -= set(found)
        if found and not self._due:
            now_s = self.now_s()
            for viewer in self.viewers:
                viewer.take(now_s, self._signals)
            self._due = self._expected()

    def _of(self, frame: Frame, data: bytes) -> dict[str, float]:
        """The signals of a frame; none of one with other contents."""
        if frame.name not in ("POSE", "WHEEL_SPEED", "NU") or (frame.name == "NU" and self._by_nu is None):
            return {}
        values = frame.physical(data)
        if frame.name == "POSE":
            return {"x_m": values["x"], "y_m": values["y"], "heading_rad": values["heading"]}
        if frame.name == "NU":
            assert self._by_nu is not None
            speeds = self._by_nu @ np.array([values[f"nu_{number}"] for number in (1, 2, 3)])
            return {f"wheel_speed_rad_per_s[{number}]": float(speed) for number, speed in enumerate(speeds, start=1)}
        first = WHEELS_A_GROUP * int(values["group"]) + 1
        return {f"wheel_speed_rad_per_s[{first + index}]": values[f"wheel_speed_{index + 1}"]
                for index in range(WHEELS_A_GROUP) if first + index <= self._wheels}


@contextmanager
def viewed(link: Link, scene: Scene, id_base: int, mode: str, recorded: Recorded) -> Iterator[None]:
    """Writes or shows what a node sends, up to the end of the run, early or not."""
    if not recorded:
        yield
        return
    if mode == "same-bits":
        raise BadInput(f"{recorded.first}: needs frames with signals, and --same-bits has raw ones; leave one of them "
                       "out")
    steps = itertools.count(1)
    began_us = link.clock.now_us()

    def now_s() -> float:
        return (link.clock.now_us() - began_us) / 1e6 if mode == "free-run" else next(steps) * scene.run.step_s

    with open_viewers(recorded, scene) as viewers:
        link.listeners.append(FrameViews(viewers, scene, id_base, now_s, is_free=mode == "free-run").take)
        yield


def check_rigid(scene: Scene, recorded: Recorded) -> None:
    """BadInput for bodies on hinges: frames and played vehicles do not say where they are."""
    if scene.has_hinges and recorded:
        raise BadInput(f"{scene.path}: {recorded.first.partition(' ')[0]} does not take vehicles with hinges yet on a "
                       "bus; leave it out")


class PlayViews:
    """Looks at a played vehicle at even instants; called in the loop."""

    def __init__(self, viewers: Sequence[Viewer], look: Callable[[], Mapping[str, float]]):
        self.viewers, self.look = viewers, look
        self._began_us: int | None = None
        self._next_us = 0

    def __call__(self, now_us: int) -> int:
        if self._began_us is None:
            self._began_us = self._next_us = now_us
        if now_us >= self._next_us:
            time_s, signals = (now_us - self._began_us) / 1e6, self.look()
            for viewer in self.viewers:
                viewer.take(time_s, signals)
            self._next_us = max(self._next_us + LOOK_US, now_us + 1)
        return self._next_us


@contextmanager
def played_views(vehicle: Any, scene: Scene, recorded: Recorded) -> Iterator[list[Callable[[int], int | None]]]:
    """What the loop calls, so that a played vehicle is written or shown; nothing where nobody wants that."""
    if not recorded:
        yield []
        return
    if (look := getattr(vehicle, "signals", None)) is None:
        raise BadInput(f"{recorded.first}: needs a vehicle in this process, whose motion can be seen; leave --board "
                       "out")
    with open_viewers(recorded, scene) as viewers:
        yield [PlayViews(viewers, look)]
