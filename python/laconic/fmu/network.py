"""A scene's CAN node as a network FMU by FMI-LS-BUS.

    make_network_fmu(read_scene("robomaster_mecanum"), Path("vehicle.fmu"), drives="robomaster")

The FMU loads its scene as any node does: by the frames of a rig, which are recorded here from a client and a node in
this process.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import can

from laconic.base.outputs import whole_file
from laconic.base.paths import SOURCE_DIR, as_path, built
from laconic.can.play.node_vehicle import remedy
from laconic.can.play.settings import DriveSettings, drive_parameters, drive_settings
from laconic.can.play.vehicle import check_playable, played
from laconic.can.rig.buses import NodeOnBus, VirtualClock, paired_buses
from laconic.can.rig.client import NodeClient
from laconic.can.rig.errors import NodeRefused
from laconic.can.rig.link import Link
from laconic.can.rig.lockstep import load_scene
from laconic.can.rig.node_library import LibraryNode
from laconic.can.rig.options import read_id_base
from laconic.can.rig.wire import ID_BASE, ID_STRIDE
from laconic.errors import BadInput, shown
from laconic.fmu.make import content_of
from laconic.scene import Scene, check_scene
from laconic_fmu.network import TX_CLOCKS, NodeContent, node_fmu

DESCRIPTION = SOURCE_DIR / "fmu" / "network" / "node" / "modelDescription.xml"
SESSION = 0x1ACC0DE  # of the rig whose frames are recorded; any other does as well
FRAME_BYTES = 8
FD_BIT_RATES = {"moteus": 5_000_000, None: 2_000_000}  # of the protocols that have CAN FD, and of the node's own frames


class LoadingClient(NodeClient):
    """A rig that knows its node to be there, so that no time passes while it loads."""

    def _wait_for_life(self) -> None:
        pass


class RecordedNode(NodeOnBus):
    """A node in this process; `frames` are those that have reached it."""

    def __init__(self, node: LibraryNode, bus: can.BusABC, clock: VirtualClock):
        super().__init__(node, bus, clock)
        self.frames: list[tuple[int, bytes]] = []

    def deliver(self, message: can.Message) -> None:
        """A frame of the rig: its place in the node's range, and its bytes."""
        assert len(message.data) == FRAME_BYTES
        self.frames.append((message.arbitration_id - ID_BASE, bytes(message.data)))
        super().deliver(message)


@contextmanager
def recorded_node() -> Iterator[tuple[NodeClient, RecordedNode]]:
    """A client of a node as after power-up, at time 0, and the node."""
    clock = VirtualClock()
    with paired_buses() as (ours, its):
        node = RecordedNode(LibraryNode("double"), its, clock)
        yield LoadingClient(Link(ours, clock=clock, pump=node.pump), random_bits=lambda _: SESSION), node
        assert clock.time_us == 0


def loading_frames(scene: Scene, settings: DriveSettings | None) -> list[tuple[int, bytes]]:
    """The frames that load a scene into a node, and with drives start them; they do not depend on its id base."""
    double = scene.with_run(real="double")
    with recorded_node() as (client, node):
        if settings is None:
            load_scene(client, double)
            return node.frames
        try:
            load_scene(client, played(double), drive_parameters(settings))
            client.start_drives()
        except NodeRefused as refused:
            raise BadInput(f"{scene.path}: rig.drives: {refused}; {remedy(refused, scene)}") from None
        return node.frames


def taken_bases(settings: DriveSettings | None) -> int:
    """Bit k: a drive uses one of the identifiers from ID_STRIDE k on."""
    bits = 0
    if settings is not None:
        for node_id, has_drive in zip(settings.node_ids, settings.driven, strict=True):
            for each in settings.protocol.identifiers(node_id) if has_drive else ():
                bits |= 1 << each // ID_STRIDE
    return bits


def make_network_fmu(scene: Scene, out: str | Path, *, drives: str | None = None, tx_clock: str = TX_CLOCKS[0],
                     sources: bool = True) -> Path:
    """Writes the FMU of the scene's node; with `drives` its wheels have drives of that protocol, which play from the
    start, else it waits for a rig. BadInput when the scene has no such FMU."""
    check_scene(scene)
    if tx_clock not in TX_CLOCKS:
        raise BadInput(f"tx_clock: there is no {shown(tx_clock)}; give {' or '.join(TX_CLOCKS)}")
    if scene.wheel_count == 0:
        raise BadInput(f"{scene.path}: vehicle.wheel: there is none; a node on a bus needs a wheel")
    id_base, settings = read_id_base(None, scene), None
    if drives is not None:
        check_playable(scene)
        settings = drive_settings(scene, drives)
    values = {"wheel_count": [scene.wheel_count], "id_base": [id_base],
              "fd_bit_rate_bit_per_s": [FD_BIT_RATES.get(drives, 0)]}
    speaks = f"motor drives that speak {drives}" if drives else "the node's own protected frames"
    content = content_of(scene, scene.name, f"A CAN node that simulates it, with {speaks}; its numbers: {scene.source}",
                         values)
    own = NodeContent(loading_frames(scene, settings), tx_clock, sources, taken_bases(settings))
    path = as_path("out", out)
    with whole_file(path) as fresh:
        node_fmu(built("fmu/LaconicNode_fmi3.fmu"), DESCRIPTION, content, own, fresh)
    return path
