"""Where the vehicle runs and how it comes to the controller's bus. Everything that can be wrong with the input is found
when a place is made, before a bus is opened."""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from typing import Any, Protocol

import can

from laconic.can.play.can_fail import CanFail, drives_can_fail, map_can_fail
from laconic.can.play.faults import DriveFault
from laconic.can.play.listener import ListeningBus, listening_socket
from laconic.can.play.loop import Lateness, Vehicle
from laconic.can.play.map_file import read_map
from laconic.can.play.map_join import check_map, join
from laconic.can.play.map_vehicle import MapVehicle
from laconic.can.play.node_in_process import InProcess
from laconic.can.play.node_vehicle import Bridged, NodeVehicle, OnBus, running
from laconic.can.play.options import PlayOptions, controller_bus
from laconic.can.play.protocols import OF_MAP
from laconic.can.play.settings import DriveSettings, drive_settings
from laconic.can.play.stopping import Travelling
from laconic.can.play.vehicle import played, silent_sensors
from laconic.can.rig.bagged import check_rigid
from laconic.can.rig.boards import own_node
from laconic.can.rig.buses import connected, node_in_process, node_process
from laconic.can.rig.choices import ON_BUS
from laconic.can.rig.client import NodeClient
from laconic.can.rig.link import Clock, Link
from laconic.can.rig.options import read_id_base
from laconic.errors import BadInput
from laconic.scene import Scene


class Played(Vehicle, Travelling, Protocol):
    """A vehicle that can be judged."""

    lateness: Lateness

    def break_drive(self, fault: DriveFault, *, is_broken: bool) -> None:
        """A fault of a drive begins, or ends."""

    def watchdogs(self) -> list[str]:
        """The watchdogs that fired, in words."""

    def notes(self) -> list[str]:
        """What else there is to say."""


class Place(ABC):
    """One kind of place."""

    name = ""
    settings: DriveSettings | None = None
    options: PlayOptions
    scene: Scene
    can_fail: CanFail                  # what can go wrong on purpose there
    serves_itself = False              # the vehicle's process serves the controller's port
    remark: str | None = None          # what a person should know of this scene there

    @abstractmethod
    def opened(self, clock: Clock) -> AbstractContextManager[tuple[Any, can.BusABC]]:
        """The vehicle and the controller's bus."""

    def playing(self, vehicle: Any) -> AbstractContextManager[Any]:
        """A context in which the vehicle moves."""
        return nullcontext(vehicle)

    def where(self, bus: can.BusABC) -> str:
        """What a person must know to connect a controller."""
        if (port := self.port_of(bus)) is not None:
            return listening_text(port)
        options = self.options
        return f"on {' '.join(each for each in (options.interface, options.channel) if each)}"

    def port_of(self, bus: can.BusABC) -> int | None:
        """At which controllers connect; None: they are on a bus of another kind."""
        return bus.port if isinstance(bus, ListeningBus) else None

    def not_taken(self, bus: can.BusABC) -> tuple[int, float]:
        """Once the run is over: frames that programs on the port did not read in time, and for how long [s] they read
        nothing."""
        return bus.not_taken() if isinstance(bus, ListeningBus) else (0, 0.0)

    def visitors(self, bus: can.BusABC) -> int | None:
        """Once the run is over: how many programs have connected; None where nobody counts them."""
        return bus.joined if isinstance(bus, ListeningBus) else None


def listening_text(port: int) -> str:
    """Where a controller can connect."""
    return f"listening on 127.0.0.1:{port}: interface slcan, channel socket://127.0.0.1:{port}"


class OfMap(Place):
    """Frames of a DBC, by a plant in this process."""

    name = "dbc"

    def __init__(self, scene: Scene, options: PlayOptions):
        assert options.dbc is not None and options.map_path is not None
        self.options, self.scene = options, scene
        self.joined = join(read_map(options.map_path, scene.wheel_count), options.dbc)
        if self.joined.has_drives:
            named = scene.rig.drives is not None and scene.rig.drives.protocol is not None
            self.settings = drive_settings(scene, None if named else OF_MAP.name)
            self.scene = played(scene)
        check_map(self.scene, self.joined)
        self.can_fail = map_can_fail(scene, self.settings, options)

    @contextmanager
    def opened(self, clock: Clock) -> Iterator[tuple[Any, can.BusABC]]:
        """The plant."""
        self._clock = clock
        with controller_bus(self.options) as bus:
            yield MapVehicle(self.scene, self.settings, self.joined), bus

    @contextmanager
    def playing(self, vehicle: MapVehicle) -> Iterator[Any]:
        """The plant moves from now on."""
        vehicle.begin(self._clock.now_us())
        yield vehicle


class OfNode(Place):
    """Drives of a protocol, by a node."""

    port: int | None = None  # of the process, where the controller connects to it

    def __init__(self, scene: Scene, options: PlayOptions):
        self.options, self.scene = options, scene
        self.settings: DriveSettings = drive_settings(scene, options.drives, options.id_base)
        self.name = self.settings.protocol.name
        self.id_base = read_id_base(options.id_base, scene)
        self.last_words: list[str] = []  # of that process
        self.serves_itself = options.is_served and options.listen is not None
        self.remark = silent_sensors(scene)
        self.can_fail = drives_can_fail(
            self.settings, options, rolls_on_hinges=scene.has_hinges and not scene.slips_on_hinges)

    @contextmanager
    def opened(self, clock: Clock) -> Iterator[tuple[Any, can.BusABC]]:
        """The node that the options choose."""
        kind, real = self.options.board or "virtual", self.scene.run.real
        if self.serves_itself:
            with self._shared_port(self.options.listen or 0) as found:
                yield found
            return
        with controller_bus(self.options) as bus:
            if kind == ON_BUS:
                yield OnBus(NodeClient(Link(bus, self.id_base, clock=clock)), self.scene, self.settings), bus
            elif kind == "virtual":
                with node_in_process(real, self.id_base, clock) as (client, end):
                    yield InProcess(client, end, self.scene, self.settings), bus
            else:
                with own_node(kind, real, self.id_base) as client:
                    yield Bridged(client, self.scene, self.settings), bus

    @contextmanager
    def _shared_port(self, wanted: int) -> Iterator[tuple[Any, can.BusABC]]:
        """The process serves the port itself: controller and play are stations of its bus, and no frame of the
        controller waits for Python."""
        listening_socket(wanted).close()  # a port that is taken is named so
        with node_process(self.scene.run.real, self.id_base, "--shared", "--port", str(wanted),
                          last_words=self.last_words) as self.port, \
                connected("slcan", f"socket://127.0.0.1:{self.port}", self.id_base) as client:
            yield OnBus(client, self.scene, self.settings, hears_alone=True), client.link.bus

    def port_of(self, bus: can.BusABC) -> int | None:
        """The port of the process, where it serves one."""
        return super().port_of(bus) if self.port is None else self.port

    def _last_count(self, what: str) -> int:
        found = re.search(rf"{what} (\d+)", "".join(self.last_words))
        return int(found[1]) if found else 0

    def not_taken(self, bus: can.BusABC) -> tuple[int, float]:
        """As the process counted them, which does not tell for how long."""
        return (self._last_count("frames not taken"), 0.0) if self.serves_itself else super().not_taken(bus)

    def visitors(self, bus: can.BusABC) -> int | None:
        """Without play itself, which is one of them."""
        return max(0, self._last_count("clients") - 1) if self.serves_itself else super().visitors(bus)

    def playing(self, vehicle: NodeVehicle) -> AbstractContextManager[Any]:
        """The node plays, and is at rest at the end."""
        if self.options.limits.are_given and not vehicle.tells_motion:
            vehicle.watched = (*vehicle.watched, "VELOCITY" if self.scene.has_hinges else "NU")
        return running(vehicle)


def place_of(scene: Scene, options: PlayOptions) -> Place:
    """The place that the options choose; BadInput for what is wrong with scene, drives, DBC or map."""
    check_rigid(scene, options.recorded)
    if scene.has_hinges and options.dbc is not None:
        raise BadInput(f"{scene.path}: --dbc does not take vehicles with hinges yet; leave it out, and give --drives")
    return OfMap(scene, options) if options.dbc is not None else OfNode(scene, options)
