"""PyPI's odrive-can as the controller: one client for each axis, speeds by CANSimple."""

from __future__ import annotations

import asyncio
import logging
from typing import Any

from odrive_can.odrive import ODriveCAN

from controllers.bench import Bench
from controllers.cycles import Cycles
from laconic.errors import ResultFails

SCENE = "robomaster_mecanum"
MOST_TURNS_PER_S = 20.0
NEAR_TURNS_PER_S = 0.6
ATTEMPTS = 5            # the client waits a second, a busy machine may need more
CYCLES_OF_A_CHECK = 100
SILENCE_S = 5.0
AXIS_BITS, AXIS_MASK = 5, 0x7E0


def hears(axis: int) -> dict[str, Any]:
    """The acceptance filter of an axis."""
    return {"can_id": axis << AXIS_BITS, "can_mask": AXIS_MASK, "extended": False}


class Clients:
    """The clients of all axes, each on an adapter that lets its axis through."""

    def __init__(self, bench: Bench):
        self.bench = bench
        self.adapters = {axis: bench.bus(can_filters=[hears(axis)]) for axis in bench.settings.node_ids}
        self.drives: list[Any] = [ODriveCAN(axis, adapter) for axis, adapter in self.adapters.items()]
        self.speeds: dict[int, float] = {}
        self.wanted: dict[int, float] = {}
        self._told: set[int] = set()
        self._all_told = asyncio.Event()

    async def __aenter__(self) -> Clients:
        await asyncio.gather(*(drive.start() for drive in self.drives))
        for drive in self.drives:
            drive.feedback_callback = self._take
            drive.clear_errors()
            drive.set_controller_mode("VELOCITY_CONTROL", "PASSTHROUGH")
        for drive in self.drives:
            await self._close_loop(drive)
        return self

    def _take(self, message: Any, drive: Any) -> None:
        self.speeds[drive.axis_id] = message.data["Vel_Estimate"]
        self._told.add(drive.axis_id)
        if len(self._told) == len(self.drives):
            self._all_told.set()

    async def next_estimates(self) -> None:
        """Until all axes have told their speed once more: commands never come faster than the drives take them."""
        try:
            await asyncio.wait_for(self._all_told.wait(), SILENCE_S)
        except asyncio.TimeoutError:
            self.bench.check()
            raise ResultFails(f"the axes told no speed for {SILENCE_S:g} s") from None
        self._told.clear()
        self._all_told.clear()

    def arrived(self) -> bool:
        """Whether the axes turn as they should."""
        return self.speeds.keys() == self.wanted.keys() and all(
            abs(speed - self.wanted[axis]) <= NEAR_TURNS_PER_S for axis, speed in self.speeds.items())

    async def _close_loop(self, drive: Any) -> None:
        for attempt in range(ATTEMPTS):
            try:
                await drive.set_axis_state("CLOSED_LOOP_CONTROL")
                return
            except TimeoutError:
                self.bench.check()
                if attempt == ATTEMPTS - 1:
                    raise ResultFails(f"axis {drive.axis_id} does not go into closed loop control") from None

    async def __aexit__(self, *_: object) -> None:
        for drive in self.drives:
            drive.stop()
        for adapter in self.adapters.values():
            adapter.shutdown()


async def _control(bench: Bench, cycles: Cycles) -> None:
    async with Clients(bench) as clients:
        while cycles.go_on(clients.arrived):
            for number, drive in enumerate(clients.drives):
                clients.wanted[drive.axis_id] = MOST_TURNS_PER_S * cycles.share(number % 2)  # ahead and round
                drive.set_input_vel(clients.wanted[drive.axis_id])
            if cycles.done % CYCLES_OF_A_CHECK == 0:
                bench.check()
                for drive in clients.drives:
                    drive.check_errors()
            await clients.next_estimates()
            cycles.end()
        if not clients.arrived():
            raise ResultFails(f"the axes turn with {clients.speeds} turns/s where {clients.wanted} were wanted")


def control(bench: Bench, cycles: Cycles) -> None:
    """Drives the vehicle; ResultFails where the drives do not follow."""
    logging.getLogger("odrive").setLevel(logging.ERROR)  # it would tell of each second without a frame
    asyncio.run(_control(bench, cycles))
