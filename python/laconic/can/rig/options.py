"""The options of `laconic rig`, and the node that they choose."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from laconic.can.rig.boards import own_node
from laconic.can.rig.bus_options import read_bus_options
from laconic.can.rig.buses import connected
from laconic.can.rig.client import NodeClient
from laconic.can.rig.session import read_key
from laconic.can.rig.wire import ID_BASE, ID_STRIDE
from laconic.errors import BadInput
from laconic.pictures.views.recorded import Recorded
from laconic.scene import Scene

LARGEST_BASE = 0x7E0


@dataclass(frozen=True)
class Options:
    """The options by name."""

    interface: str | None
    channel: str | None
    bitrate: int | None
    id_base: str | None
    board: str | None
    mode: str
    steps: int | None
    every: int
    fd: bool
    rate: int | None
    watchdog: int
    method: str | None
    real: str | None
    tolerances: tuple[str, ...]
    bus_options: tuple[str, ...]
    logs: tuple[Path, ...]
    replay: Path | None
    live: bool
    key: Path | None
    junit: Path | None
    json_wanted: bool
    recorded: Recorded = Recorded()  # where the run is written or shown besides its log


def read_id_base(given: str | None, scene: Scene | None) -> int:
    """--id-base, the scene's, or the contract's own."""
    of_scene = scene.rig.id_base if scene is not None else None
    where = f"--id-base {given}" if given is not None else f"{scene.path if scene else ''}: rig.id_base"
    try:
        base = int(given, 0) if given is not None else ID_BASE if of_scene is None else of_scene
    except ValueError:
        raise BadInput(f"{where}: no number; give one such as 0x{ID_BASE + ID_STRIDE:X}") from None
    if base % ID_STRIDE or not 0 <= base <= LARGEST_BASE:
        raise BadInput(f"{where}: {in_hex(base)} cannot be the base of a node's {ID_STRIDE} identifiers; give a "
                       f"multiple of {ID_STRIDE} from 0 to 0x{LARGEST_BASE:X}")
    return base


def in_hex(number: int) -> str:
    """A hexadecimal number, as identifiers are written."""
    return f"{'-' if number < 0 else ''}0x{abs(number):X}"


def check_bitrate(bitrate: int | None) -> None:
    """BadInput for a rate that no bus has."""
    if bitrate is not None and bitrate <= 0:
        raise BadInput(f"--bitrate {bitrate}: must be above 0; give bits per second, such as 500000")


@contextmanager
def node_for(options: Options, real: str, id_base: int) -> Iterator[NodeClient]:
    """A client on the chosen bus, or of a node that is started here."""
    check_bitrate(options.bitrate)
    if options.interface is None:
        if options.channel is not None:
            raise BadInput(f"--channel {options.channel}: give its --interface as well, such as slcan")
        if options.bitrate is not None:
            raise BadInput(f"--bitrate {options.bitrate}: give its --interface as well, such as socketcan")
        if options.bus_options:
            raise BadInput(f"--bus-option {options.bus_options[0]}: NAME=VALUE needs an --interface, such as faulty")
        if options.key is not None:
            raise BadInput(f"--key {options.key}: nodes that are started here have none; "
                           "give the --interface of one that has")
        with own_node(options.board or "virtual", real, id_base) as node:
            yield node
        return
    if options.board is not None:
        raise BadInput(f"--board {options.board}: starts a node itself; leave --interface out")
    more = read_bus_options(options.bus_options, options.interface)
    key = read_key(options.key) if options.key is not None else None
    with connected(options.interface, options.channel, id_base, key=key, bitrate=options.bitrate, **more) as node:
        yield node
