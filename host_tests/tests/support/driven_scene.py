"""A scene behind drives for a client that we did not write: a node in this process on a virtual bus, in virtual time,
and beside it the core, fed with the torques of the drives."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Iterator
from contextlib import closing, contextmanager
from dataclasses import replace
from typing import Any

import can
import numpy as np

from laconic.can.play.node_in_process import InProcess
from laconic.can.play.node_vehicle import running
from laconic.can.play.settings import drive_settings
from laconic.can.play.vehicle import played
from laconic.can.rig.buses import VirtualClock, node_in_process
from laconic.core import load
from laconic.scene import read_scene
from play_support import next_channel

PATIENCE_STEPS = 5000


class DrivenScene:
    """Steps, one period of the core each, and adapters by which controllers are on its bus."""

    def __init__(self, vehicle: InProcess, clock: VirtualClock):
        self.vehicle, self.clock, self.steps = vehicle, clock, 0
        self._adapters: list[tuple[can.BusABC, Callable[[can.Message], bool]]] = []
        core = load("double")
        self._plant, self._core = played(vehicle.scene).plant(core), core
        self._row = np.zeros(core.input_length)
        self._torques = self._row[core.input_fields["axle_torque_Nm"][0]:]
        node = vehicle.node
        self._count = node.library.lib.laconic_library_drive_count(node.c)
        self._period_us = round(1e6 * vehicle.scene.run.step_s)
        self._view = node.library.ffi.new("laconic_library_drive *")

    def adapter(self, hears: Callable[[can.Message], bool] = lambda _: True) -> str:
        """The channel of one more adapter. `hears` is its acceptance filter: what it drops costs the client no time."""
        channel = next_channel()
        self._adapters.append((can.Bus(interface="virtual", channel=channel), hears))
        return channel

    def close(self) -> None:
        """The ends of the adapters that are ours."""
        for bus, _ in self._adapters:
            bus.shutdown()

    def drive(self, number: int) -> Any:
        """What the library knows of a drive, until the next call."""
        node = self.vehicle.node
        assert node.library.lib.laconic_library_drive_view(node.c, number, self._view)
        return self._view

    def step(self, periods: int = 1) -> None:
        """Frames of the controller, then a period, then the frames of the drives; wheel motion is that of the core, bit
        for bit."""
        for _ in range(periods):
            self._take()
            self.clock.time_us += self._period_us
            self._give()
            self.steps += 1
            self._agree()

    def answer(self) -> None:
        """Frames of the controller and the drives' answers, at the same instant."""
        self._take()
        self._give()

    def _take(self) -> None:
        for bus, _ in self._adapters:
            while (message := bus.recv(0)) is not None:
                self.vehicle.on_message(message, self.clock.time_us)

    def _give(self) -> None:
        for message in self.vehicle.advance(self.clock.time_us):
            for bus, hears in self._adapters:
                if hears(message):
                    bus.send(message)

    def _agree(self) -> None:
        seen = []
        for number in range(self._count):
            view = self.drive(number)
            self._torques[view.wheel] = view.axle_torque_Nm
            seen.append((view.wheel, view.wheel_speed_rad_per_s, view.wheel_angle_rad))
        self._plant.run(self._core.input(self._row))
        speeds, angles = self._plant.wheel_speeds(), self._plant.wheel_angles()
        for wheel, speed, angle in seen:
            assert (speed, angle) == (speeds[wheel], angles[wheel]), f"step {self.steps}, wheel {wheel + 1}"

    async def pass_time(self, periods: int) -> None:
        """Steps in which the client reads what comes; what it has not read afterwards would be taken for an answer."""
        for _ in range(periods):
            self.step()
            await asyncio.sleep(0)
        await asyncio.sleep(0.05)

    async def during(self, awaited: Awaitable[Any]) -> Any:
        """Steps while a client waits."""
        task = asyncio.ensure_future(awaited)
        for _ in range(PATIENCE_STEPS):
            if task.done():
                return task.result()
            self.step()
            await asyncio.sleep(0.001)
        task.cancel()
        raise AssertionError(f"the client still waits after {PATIENCE_STEPS} steps")


@contextmanager
def driven_scene(name: str, protocol: str, watchdog_s: float | None = None, **numbers: float
                 ) -> Iterator[DrivenScene]:
    """The scene, playing; `numbers` replace those of all its drives."""
    scene, clock = read_scene(name), VirtualClock()
    settings = drive_settings(scene, protocol)
    own = {key: (value,) * scene.wheel_count for key, value in numbers.items()}
    settings = replace(settings, watchdog_s=watchdog_s, numbers=settings.numbers | own)
    with node_in_process("double", clock=clock) as (client, end), \
            running(InProcess(client, end, scene, settings)) as vehicle, \
            closing(DrivenScene(vehicle, clock)) as driven:
        yield driven
