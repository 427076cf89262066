"""PyPI's canopen as the controller of a played vehicle in this process. Its bus is python-can's virtual one, and a
frame that it sends is answered before `send` returns, so that nothing waits and nothing depends on the machine's
speed."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import can
import canopen
from can.interfaces.virtual import VirtualBus

from laconic.can.play.canopen_eds import eds_of_scene
from laconic.can.play.node_in_process import InProcess
from laconic.can.play.node_vehicle import running
from laconic.can.play.settings import drive_settings
from laconic.can.rig.buses import VirtualClock, node_in_process
from laconic.can.rig.wire import ID_BASE
from laconic.scene import Scene


@dataclass
class Played:
    """A vehicle whose drives are CANopen nodes, its time, and the two ends of the bus between it and the controller."""

    vehicle: InProcess
    clock: VirtualClock
    network: canopen.Network
    far_end: can.BusABC
    eds: Path
    step_us: int
    messages: list[can.Message] = field(default_factory=list)  # of the drives

    def exchange(self) -> None:
        """Frames of the controller to the vehicle, and those of the vehicle to the controller."""
        while (message := self.far_end.recv(0.0)) is not None:
            self.vehicle.on_message(message, self.clock.now_us())
            self._answer()
        self._answer()

    def _answer(self) -> None:
        for message in self.vehicle.advance(self.clock.now_us()):
            self.messages.append(message)
            self.far_end.send(message)
        near_end = self.network.bus
        while (message := near_end.recv(0.0)) is not None:
            for listener in self.network.listeners:
                listener(message)

    def step(self, steps: int = 1) -> None:
        """So many steps of the core."""
        for _ in range(steps):
            self.clock.time_us += self.step_us
            self.exchange()

    def drive(self, number: int) -> Any:
        """What the library shows of a drive."""
        node = self.vehicle.node
        view = node.library.ffi.new("laconic_library_drive *")
        assert node.library.lib.laconic_library_drive_view(node.c, number, view)
        return view

    def node(self, node_id: int, kind: type = canopen.RemoteNode) -> Any:
        """A node of the client, with the EDS of this vehicle's drives."""
        return self.network.add_node(kind(node_id, str(self.eds)))


def download(node: Any, index: int, sub: int, data: bytes) -> None:
    """Writes an object by one request of the client. Its streams write again when they are collected after an abort,
    which would happen inside of another request here, where answers come before `send` returns."""
    size = len(data)
    expedited = bytes([0x23 | (4 - size) << 2]) if size <= 4 else b"\x21"
    rest = data.ljust(4, b"\0") if size <= 4 else size.to_bytes(4, "little")
    node.sdo.request_response(expedited + index.to_bytes(2, "little") + bytes([sub]) + rest)


class AnsweringBus(VirtualBus):
    """An end of a virtual bus whose other end answers at once."""

    exchange: Any = None

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Sends, and lets the other end work."""
        super().send(msg, timeout)
        if self.exchange is not None:
            self.exchange()


@contextmanager
def played_on_canopen(scene: Scene, folder: Path) -> Iterator[Played]:
    """A vehicle that plays, and a network of the client on its bus."""
    settings, clock, channel = drive_settings(scene, "canopen"), VirtualClock(), f"canopen {folder}"
    eds = folder / "drive.eds"
    eds.write_text(eds_of_scene(scene, "canopen"), encoding="ascii")
    with ExitStack() as stack:
        client, end = stack.enter_context(node_in_process(scene.run.real, ID_BASE, clock))
        vehicle = InProcess(client, end, scene, settings)
        near, far = (stack.enter_context(bus(channel=channel)) for bus in (AnsweringBus, VirtualBus))
        stack.enter_context(running(vehicle))
        network = canopen.Network(bus=near)
        played = Played(vehicle, clock, network, far, eds, round(1e6 * scene.run.step_s))
        near.exchange = played.exchange
        played.exchange()
        yield played
        near.exchange = None
