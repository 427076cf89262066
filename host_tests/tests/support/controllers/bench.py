"""A vehicle that plays on a board, a thread that passes its frames on, and a bus of this process for the controller."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from typing import Any

import can

from controllers.truth import SELECTED, Truth
from laconic.can.play.faults import DriveFault
from laconic.can.play.loop import Loop, Traffic
from laconic.can.play.node_in_process import InProcess
from laconic.can.play.node_vehicle import Bridged, NodeVehicle, running
from laconic.can.play.settings import DriveSettings, drive_settings
from laconic.can.play.vehicle import played
from laconic.can.rig.boards import own_node
from laconic.can.rig.buses import node_in_process
from laconic.can.rig.choices import BOARDS
from laconic.can.rig.client import NodeClient
from laconic.can.rig.link import Clock
from laconic.can.rig.wire import ID_BASE
from laconic.errors import LaconicError, ResultFails
from laconic.scene import Scene, read_scene
from laconic.scene.methods import EXPLICIT
from play_support import next_channel

END_S = 5.0  # for the node's last frames
METHOD = EXPLICIT  # every image contains it


class Telling(NodeVehicle):
    """A vehicle whose node tells the torques and the wheel motion of each step."""

    def choose_frames(self, *names: str) -> None:
        """As for every node, and the raw numbers of each step."""
        fd = self.client.identity is not None and self.client.identity.can_fd
        self.client.select(**{f"send_{name.lower()}": 1 for name in names}, **SELECTED, raw_fd=int(fd))


class TellingInProcess(Telling, InProcess):
    """In this process."""


class TellingBridged(Telling, Bridged):
    """Behind a line of its own."""


@dataclass
class Bench:
    """What a controller needs: its bus, the scene, the settings of the drives; and what is known of the vehicle."""

    scene: Scene
    settings: DriveSettings
    vehicle: NodeVehicle
    truth: Truth
    traffic: Traffic
    channel: str
    jobs: deque[Callable[[], None]] = field(default_factory=deque)
    endings: list[LaconicError] = field(default_factory=list)  # of the thread that passes frames on

    def bus(self, **filters: Any) -> can.BusABC:
        """One more station of the controller's bus."""
        return can.Bus(interface="virtual", channel=self.channel, **filters)

    def break_drive(self, kind: str, wheel: int, *, is_broken: bool = True) -> None:
        """A fault by order of a wheel's drive, counted from 1, begins or ends."""
        self.jobs.append(lambda: self.vehicle.break_drive(DriveFault(kind, wheel, 0.0), is_broken=is_broken))

    def check(self) -> None:
        """Raises what has ended the vehicle, or its line, meanwhile."""
        for ending in self.endings:
            raise ending


class Over(Exception):
    """The controller has ended; the loop, too."""


class Passing(threading.Thread):
    """The loop of play, in a thread, until it is ended. It alone uses the node's line: what others want there they put
    into `jobs`."""

    def __init__(self, vehicle: Any, end: can.BusABC, bench: Bench):
        super().__init__(daemon=True)
        self.loop, self.bench, self._is_over = Loop(vehicle, end, bench.traffic, [self._work]), bench, False
        bench.traffic.may_go_on = self._go_on

    def _work(self, now_us: int) -> None:
        while self.bench.jobs:
            self.bench.jobs.popleft()()

    def _go_on(self) -> None:
        if self._is_over:
            raise Over

    def run(self) -> None:
        with suppress(Over):
            ending = self.loop.run(None)
            self.bench.endings += [ending] if ending is not None else []

    def __enter__(self) -> Passing:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._is_over = True
        self.join(END_S)


@contextmanager
def vehicle_on(board: str, scene: Scene, settings: DriveSettings, clock: Clock) -> Iterator[NodeVehicle]:
    """A vehicle that tells its steps, not yet playing."""
    if board == "virtual":
        with node_in_process(scene.run.real, ID_BASE, clock) as (client, end):
            yield TellingInProcess(client, end, scene, settings)
    else:
        with own_node(board, scene.run.real, ID_BASE) as client:
            yield TellingBridged(client, scene, settings)


@contextmanager
def bench(scene_name: str, protocol: str, board: str, step_s: float, **numbers: float) -> Iterator[Bench]:
    """The scene behind drives on a board, playing by the wall clock; `numbers` replace those of all its drives. At the
    end the node is at rest and all its steps have been compared."""
    real = BOARDS[board].real if board in BOARDS else "double"
    scene = read_scene(scene_name).with_run(real=real, method=METHOD, step_s=step_s)
    settings = drive_settings(scene, protocol)
    own = {key: (value,) * scene.wheel_count for key, value in numbers.items()}
    settings = replace(settings, numbers=settings.numbers | own)
    channel, traffic = next_channel(), Traffic(Clock())
    with can.Bus(interface="virtual", channel=channel) as end, \
            vehicle_on(board, scene, settings, traffic.clock) as vehicle:
        truth = Truth(played(scene), vehicle.client.link)
        found = Bench(scene, settings, vehicle, truth, traffic, channel)
        with running(vehicle), Passing(vehicle, end, found):
            yield found
        found.check()
        if complaint := truth.complaint(steps_at_rest(vehicle.client)):
            raise ResultFails(complaint)


def steps_at_rest(client: NodeClient) -> int:
    """Steps of a node that has been stopped, by its HEARTBEAT, which follows what it still had to send."""
    link = client.link
    deadline_us = link.deadline_us(END_S)
    while (received := link.receive_until(deadline_us)) is not None:
        frame, data = received
        values = frame.unpack(data)
        if frame.name == "HEARTBEAT" and client.wire.choice("HEARTBEAT", "state", values["state"]) == "ready":
            return values["steps"]
    raise ResultFails(f"no HEARTBEAT of the stopped node came within {END_S:g} s")
