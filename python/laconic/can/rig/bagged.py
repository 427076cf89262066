"""A run of `laconic rig` or `laconic play` as topics of ROS 2, written while it runs."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import can
import numpy as np

from laconic.can.rig.link import Link
from laconic.can.rig.wire import WHEELS_A_GROUP, Frame, wire
from laconic.errors import BadInput
from laconic.scene import Scene
from laconic.scene.ground import slips

if TYPE_CHECKING:
    from laconic.robot.bags.run_topics import RunTopics

LOOK_US = 10_000     # between two instants of a played vehicle


class FrameTopics:
    """Listens to a node's frames with signals: one instant once pose and all wheels have come anew. In free run it
    sends no wheel speeds; without slip they follow from its pseudo-velocities."""

    def __init__(self, topics: RunTopics, scene: Scene, id_base: int, now_s: Callable[[], float], *, is_free: bool):
        self.topics, self.id_base, self.now_s = topics, id_base, now_s
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
            self.topics.take(self.now_s(), self._signals)
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
def bagged(link: Link, scene: Scene, id_base: int, mode: str, path: Path | None) -> Iterator[None]:
    """Writes what a node sends, up to the end of the run, early or not."""
    if path is None:
        yield
        return
    if mode == "same-bits":
        raise BadInput(f"--bag {path}: needs frames with signals, and --same-bits has raw ones; leave one of them out")
    from laconic.robot.bags.run_topics import RunTopics, open_bag  # where a bag is wanted, and only there

    steps = itertools.count(1)
    began_us = link.clock.now_us()

    def now_s() -> float:
        return (link.clock.now_us() - began_us) / 1e6 if mode == "free-run" else next(steps) * scene.run.step_s

    with open_bag(path) as bag:
        link.listeners.append(FrameTopics(RunTopics(scene, bag), scene, id_base, now_s,
                                          is_free=mode == "free-run").take)
        yield


class PlayTopics:
    """Looks at a played vehicle at even instants; called in the loop."""

    def __init__(self, topics: RunTopics, look: Callable[[], Mapping[str, float]]):
        self.topics, self.look = topics, look
        self._began_us: int | None = None
        self._next_us = 0

    def __call__(self, now_us: int) -> int:
        if self._began_us is None:
            self._began_us = self._next_us = now_us
        if now_us >= self._next_us:
            self.topics.take((now_us - self._began_us) / 1e6, self.look())
            self._next_us = max(self._next_us + LOOK_US, now_us + 1)
        return self._next_us


@contextmanager
def played_bag(vehicle: Any, scene: Scene, path: Path | None) -> Iterator[list[Callable[[int], int | None]]]:
    """What the loop calls, so that a played vehicle is written; nothing where no bag is wanted."""
    if path is None:
        yield []
        return
    if (look := getattr(vehicle, "signals", None)) is None:
        raise BadInput(f"--bag {path}: needs a vehicle in this process, whose motion can be seen; leave --board out")
    from laconic.robot.bags.run_topics import RunTopics, open_bag

    with open_bag(path) as bag:
        yield [PlayTopics(RunTopics(scene, bag), look)]
