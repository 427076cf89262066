"""A controller for C620 drives, that of the page, drives the mecanum scene; the wheels move as a plant does that is fed
with the drives' torques."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import can
import numpy as np
import pytest

from laconic.base.paths import SOURCE_DIR
from laconic.can.play.settings import drive_parameters, drive_settings
from laconic.can.play.vehicle import played
from laconic.can.rig.boards import own_node, why_no_emulation
from laconic.can.rig.buses import NodeOnBus, VirtualClock, paired_buses
from laconic.can.rig.client import NodeClient
from laconic.can.rig.errors import NodeRefused
from laconic.can.rig.link import Link
from laconic.can.rig.lockstep import start_of
from laconic.can.rig.node_library import LibraryNode
from laconic.can.rig.parameters import Parameter, parameters_of
from laconic.can.rig.wire import ID_BASE
from laconic.core.plant import Plant
from laconic.scene import Scene, read_scene
from laconic.scene.methods import EXPLICIT

PAGE = (SOURCE_DIR / "docs" / "play-drives.md").read_text(encoding="utf-8")


class Bench:
    """The scene behind its drives in a node of this process, on a virtual bus with a controller."""

    def __init__(self, client: NodeClient, end: NodeOnBus, scene: Scene):
        self.client, self.end, self.node, self.scene = client, end, end.node, scene
        self.twin = scene.plant(scene.core())
        self._view = self.node.library.ffi.new("laconic_library_drive *")

    def load(self, changed: dict[tuple[str, int], float | int] | None = None) -> None:
        """Vehicle and drives; `changed` replaces numbers of the drives."""
        drives = {(field, item): value for field, item, value in drive_parameters(drive_settings(self.scene, None))}
        numbers: list[Parameter] = [(*key, value) for key, value in (drives | (changed or {})).items()]
        if not self.client.link.session.is_open:
            self.client.open()
        self.client.load_parameters([*parameters_of(self.twin, start_of(self.scene)), *numbers], self.twin.core.dtype)

    def drive(self, number: int) -> Any:
        """A drive at the end of the last step."""
        assert self.node.library.lib.laconic_library_drive_view(self.node.c, number, self._view)
        return self._view

    def of_each(self, member: str) -> list[float]:
        """A number of the four drives."""
        return [getattr(self.drive(number), member) for number in range(4)]

    def step(self, controller: can.BusABC, hear: Any) -> list[int]:
        """One period: the step, its feedback, and the controller's answer; the identifiers that it heard."""
        self.end.clock.time_us += 1000
        self.node.tick(self.end.clock.time_us)
        self.end.send_all()
        heard = []
        while (message := controller.recv(0)) is not None:
            heard.append(message.arbitration_id)
            hear(message)
        while (message := self.end.bus.recv(0)) is not None:
            self.node.give(message, self.end.clock.time_us)
        return heard


@contextmanager
def bench(real: str = "double") -> Iterator[tuple[Bench, can.BusABC]]:
    """The bench, and the controller's end of the bus."""
    scene, clock = played(read_scene("robomaster_mecanum").with_run(real=real)), VirtualClock()
    with paired_buses() as (ours, its):
        end = NodeOnBus(LibraryNode(real), its, clock)
        yield Bench(NodeClient(Link(ours, ID_BASE, clock=clock, pump=end.pump)), end, scene), ours


def controller_of_the_page() -> Any:
    """The class WheelSpeeds, as a reader copies it."""
    names: dict[str, Any] = {}
    exec(re.search(r"```python\n([^`]*class WheelSpeeds.*?)```", PAGE, re.DOTALL)[1], names)
    return names["WheelSpeeds"]


def wheel_speeds_for(scene: Scene, ahead_m_per_s: float, left_m_per_s: float, yaw_rad_per_s: float) -> list[float]:
    """Speeds of the wheels of a mecanum vehicle that moves so."""
    found = []
    for wheel in scene.vehicle["wheel"]:
        side = np.sign(wheel["roller_rad"])
        along = ahead_m_per_s - yaw_rad_per_s * wheel["y_m"] - side * (left_m_per_s + yaw_rad_per_s * wheel["x_m"])
        found.append(along / scene.vehicle["wheel_radius_m"])
    return found


def motion_of_origin(twin: Plant) -> tuple[float, float, float]:
    """Velocity ahead and to the left of the body's origin, and the yaw rate."""
    (ahead, left), yaw_rate = twin.body_velocity()
    return ahead + yaw_rate * twin.c.model.com_y_m, left - yaw_rate * twin.c.model.com_x_m, yaw_rate


def feed(twin: Plant, held: Any, torques_Nm: list[float]) -> None:
    """One step of a plant with these axle torques."""
    for wheel, torque_Nm in enumerate(torques_Nm):
        held.axle_torque_Nm[wheel] = torque_Nm
    twin.run(held)


@pytest.mark.parametrize(("real", "cycles"), [
    pytest.param("double", 10_000, marks=pytest.mark.nightly), ("double", 4000),
    pytest.param("single", 2_000, marks=pytest.mark.nightly), ("single", 1000)])
def test_the_controller_of_the_page_drives_the_scene_and_wheels_move_as_the_core_with_its_torques(
        real: str, cycles: int) -> None:
    with bench(real) as (this, controller):
        this.load()
        this.client.control("START_DRIVES")
        loops, twin = controller_of_the_page()(controller), this.twin
        held = twin.core.ffi.new("laconic_input *")
        motions = [(0.5, 0.0, 0.0), (0.0, 0.5, 0.0), (0.0, 0.0, 1.0), (-0.3, 0.2, -0.5)]
        for cycle in range(cycles):
            motion = motions[cycle * len(motions) // cycles]
            loops.wanted_rad_per_s = wheel_speeds_for(this.scene, *motion)
            assert this.step(controller, loops.hear) == [0x201, 0x202, 0x203, 0x204]
            feed(twin, held, this.of_each("torque_Nm"))
            if cycle % 50 == 0 or cycle == cycles - 1:
                assert this.of_each("wheel_speed_rad_per_s") == list(map(float, twin.wheel_speeds()))
                assert this.of_each("wheel_angle_rad") == list(map(float, twin.wheel_angles()))
            if real == "double" and (cycle + 1) % (cycles // len(motions)) == 0:
                assert np.allclose(motion_of_origin(twin), motion, atol=5e-3)
        assert this.node.inspect()["steps"] == cycles and this.node.inspect()["late_periods"] == 0


def test_the_feedback_counts_what_the_wheels_turn() -> None:
    with bench() as (this, controller):
        this.load()
        this.client.control("START_DRIVES")
        loops, turned, last = controller_of_the_page()(controller), 0, 0

        def hear(message: can.Message) -> None:
            nonlocal turned, last
            loops.hear(message)
            if message.arbitration_id == 0x201:
                angle = int.from_bytes(message.data[:2], "big")
                turned += (angle - last + 4096) % 8192 - 4096
                last = angle

        loops.wanted_rad_per_s = [20.0] * 4
        for _ in range(3000):
            this.step(controller, hear)
        drive = this.drive(0)
        assert turned == drive.count > 100_000
        assert turned / 8192 * 187 / 3591 * 2 * np.pi == pytest.approx(drive.wheel_angle_rad, abs=1e-4)


def test_a_controller_that_goes_silent_keeps_its_last_currents_or_loses_its_drives_by_the_watchdog() -> None:
    for watchdog_s, still_pushes in ((0.0, True), (0.05, False)):
        with bench() as (this, controller):
            this.load({("DRIVE_WATCHDOG", 0): watchdog_s})
            this.client.control("START_DRIVES")
            controller.send(can.Message(arbitration_id=0x200, data=bytes([1, 0] * 4), is_extended_id=False))
            for _ in range(200):
                this.step(controller, lambda _: None)
            assert (this.drive(0).current_A > 0) == still_pushes
            assert bool(this.drive(0).faults & 32) != still_pushes


def test_faults_by_order_take_the_torque_of_their_drive_alone() -> None:
    with bench() as (this, controller):
        this.load({("DRIVE_STALL_TIME", wheel): 0.1 for wheel in (1, 2, 3, 4)})
        this.client.control("START_DRIVES")
        lib, loops = this.node.library.lib, controller_of_the_page()(controller)
        loops.wanted_rad_per_s = [10.0] * 4

        def run(periods: int) -> None:
            for _ in range(periods):
                this.step(controller, loops.hear)

        run(500)
        lib.laconic_library_drive_break(this.node.c, 1, 4)  # over-temperature
        run(100)
        assert this.drive(1).current_A == 0.0 and this.drive(1).faults == 4
        assert this.drive(0).current_A != 0.0
        lib.laconic_library_drive_mend(this.node.c, 1, 4)
        run(100)
        assert this.drive(1).faults == 0 and this.drive(1).current_A != 0.0
        lib.laconic_library_drive_break(this.node.c, 2, 1)  # the encoder
        count = this.drive(2).count
        run(50)
        assert this.drive(2).count == count and this.drive(2).wheel_speed_rad_per_s > 1.0
        lib.laconic_library_drive_brake(this.node.c, 0, 50.0)
        run(400)
        assert abs(this.drive(0).wheel_speed_rad_per_s) < 0.1


@pytest.mark.parametrize(("field", "item", "value", "status"), [
    ("DRIVE_PROTOCOL", 0, 77, "not supported"), ("ENCODER_COUNTS", 2, 0, "not positive"),
    ("DRIVE_GEAR_RATIO", 3, 0.0, "not positive"), ("DRIVE_CURRENT_LIMIT", 1, float("nan"), "not finite"),
    ("DRIVE_NODE_ID", 2, 1, "above limit"), ("DRIVE_NODE_ID", 4, 9, "above limit"),
    ("DRIVE_WATCHDOG", 0, -1.0, "negative")])
def test_numbers_that_no_drive_can_have_are_refused_by_field_and_wheel(
        field: str, item: int, value: float | int, status: str) -> None:
    with bench() as (this, _):
        with pytest.raises(NodeRefused) as refused:
            this.load({(field, item): value})
        found = refused.value
        assert (found.status, found.field, found.item) == (status, field.lower().replace("_", " "), item)


@pytest.mark.parametrize(("kind", "real"), [("process", "double"), pytest.param(
    "an386-drives", "single", marks=pytest.mark.skipif(why_no_emulation() is not None, reason="no emulated boards"))])
def test_the_controller_of_the_page_drives_a_process_and_a_board_that_has_no_other_protocol(
        kind: str, real: str) -> None:
    """Behind a serial line, 200 periods a second by a clock of their own; the wheels' speeds hold for twenty of them.

    How many periods that takes depends on how late this process answers.
    """
    scene = played(read_scene("robomaster_mecanum").with_run(real=real, method=EXPLICIT, step_s=0.005))
    twin = scene.plant(scene.core())
    with own_node(kind, real) as client:
        client.open()
        client.load_parameters([*parameters_of(twin, start_of(scene)), *drive_parameters(drive_settings(scene, None))],
                               twin.core.dtype)
        client.control("START_DRIVES")
        bus, heard, right = client.link.bus, 0, 0
        loops = controller_of_the_page()(bus)
        loops.wanted_rad_per_s = wheel_speeds_for(scene, 0.4, 0.1, 0.2)
        wanted_rpm = np.array(loops.wanted_rad_per_s) * 60 / (2 * np.pi) * 3591 / 187
        while heard < 20_000 and right < 80 and (message := bus.recv(2.0)) is not None:
            loops.hear(message)
            heard += 1
            right = right + 1 if np.allclose(loops.rpm, wanted_rpm, rtol=0.02, atol=5) else 0
        assert right == 80, (heard, loops.rpm, wanted_rpm)
        client.stop()
