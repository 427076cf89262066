"""PyPI moteus, unchanged, drives a scene over its python-can transport."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Awaitable, Callable
from typing import Any

import pytest

from driven_scene import DrivenScene, driven_scene

moteus = pytest.importorskip("moteus")
Register, Mode = moteus.Register, moteus.Mode

SCENE, IDS = "robomaster_mecanum", (1, 2, 3, 4)


def share(number: int) -> float:
    """Of a wheel's motion; a curve to the left, which four mecanum wheels can roll: 1 and 3 are left, 2 and 4 right."""
    return 1.0 if number % 2 else 1.5


class Wheels:
    """One client program for all wheels."""

    def __init__(self, scene: DrivenScene):
        self.scene = scene
        self.transport = moteus.PythonCan(interface="virtual", channel=scene.adapter())
        self.controllers = [moteus.Controller(id=each, transport=self.transport) for each in IDS]

    async def cycle(self, commands: list[Any]) -> dict[int, dict[int, float]]:
        """One cycle of the client, answered at once; what each wheel says."""
        task = asyncio.ensure_future(self.transport.cycle(commands))
        while not task.done():
            await asyncio.sleep(0)
            self.scene.answer()
        return {each.id: each.values for each in await task}

    async def command(self, make: Callable[[Any], Any], steps: int = 1) -> dict[int, dict[int, float]]:
        """The same command for each wheel, then steps."""
        values = await self.cycle([make(each) for each in self.controllers])
        self.scene.step(steps)
        return values


def run(control: Callable[[Wheels], Awaitable[None]], **numbers: float) -> int:
    async def all_of_it(scene: DrivenScene) -> None:
        wheels = Wheels(scene)
        await control(wheels)
        wheels.transport.close()

    with driven_scene(SCENE, "moteus", **numbers) as scene:
        asyncio.run(all_of_it(scene))
        return scene.steps


def test_moteus_drives_four_wheels_and_the_core_agrees_bit_for_bit():
    async def control(wheels: Wheels) -> None:
        await wheels.command(lambda each: each.make_stop())
        for cycle in range(200):
            speed = 0.5 * math.sin(cycle / 50.0)
            values = await wheels.command(lambda each, speed=speed: each.make_position(
                position=math.nan, velocity=speed * share(each.id), maximum_torque=3.0, query=True), 20)
        assert {each[Register.MODE] for each in values.values()} == {Mode.POSITION}
        for _ in range(50):
            values = await wheels.command(lambda each: each.make_position(
                position=math.nan, velocity=0.5 * share(each.id), query=True), 20)
        for number, each in values.items():
            assert abs(each[Register.VELOCITY] - 0.5 * share(number)) < 0.01
            drive = wheels.scene.drive(number - 1)
            assert abs(each[Register.POSITION] * 2.0 * math.pi - drive.wheel_angle_rad) < 0.2

    assert run(control) >= 5_000


def test_its_client_moves_to_a_place_and_sees_when_the_trajectory_is_complete():
    async def control(wheels: Wheels) -> None:
        extra = moteus.QueryResolution()
        extra.trajectory_complete = moteus.INT8
        done: dict[int, dict[int, float]] = {}
        for _ in range(300):
            done = await wheels.command(lambda each: each.make_position(
                position=share(each.id), velocity=0.0, accel_limit=4.0, velocity_limit=1.0, query_override=extra), 20)
            if all(each[Register.TRAJECTORY_COMPLETE] for each in done.values()):
                break
        values = await wheels.command(lambda each: each.make_position(position=math.nan, query=True), 500)
        values = await wheels.command(lambda each: each.make_query())
        for number, each in values.items():
            assert abs(each[Register.POSITION] - share(number)) < 0.02

    run(control)


def test_a_silent_client_finds_the_timeout_mode_and_leaves_it_by_stop():
    async def control(wheels: Wheels) -> None:
        for _ in range(30):
            await wheels.command(lambda each: each.make_position(position=math.nan, velocity=1.0, query=True), 20)
        wheels.scene.step(1500)
        values = await wheels.command(lambda each: each.make_query())
        assert {each[Register.MODE] for each in values.values()} == {Mode.TIMEOUT}
        assert all(abs(each[Register.VELOCITY]) < 0.05 for each in values.values())  # damped to rest
        assert all(wheels.scene.drive(number).unheard for number in range(4))  # for the verdict of play
        await wheels.command(lambda each: each.make_position(position=math.nan, velocity=1.0, query=True), 5)
        values = await wheels.command(lambda each: each.make_stop(query=True))
        await wheels.command(lambda each: each.make_position(position=math.nan, velocity=1.0, query=True), 5)
        values = await wheels.command(lambda each: each.make_query())
        assert {each[Register.MODE] for each in values.values()} == {Mode.POSITION}

    run(control)


def test_its_discovery_finds_every_drive_with_a_uuid_of_its_own():
    async def control(wheels: Wheels) -> None:
        task = asyncio.ensure_future(wheels.transport.discover(timeout=0.05))
        while not task.done():
            await asyncio.sleep(0.001)
            wheels.scene.answer()
        found = await task
        assert sorted(each.can_id for each in found) == list(IDS)
        assert len({bytes(each.uuid) for each in found}) == len(IDS)

    run(control)
