"""The options of `laconic play`, and the controller's bus that they choose."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

import can

from laconic.can.play.listener import ListeningBus
from laconic.can.play.stopping import Limits
from laconic.can.rig.bus_options import read_bus_options
from laconic.can.rig.buses import open_bus
from laconic.can.rig.options import check_bitrate
from laconic.errors import BadInput
from laconic.pictures.views.recorded import Recorded


@dataclass(frozen=True)
class PlayOptions:
    """The options by name."""

    interface: str | None = None
    channel: str | None = None
    bitrate: int | None = None
    bus_options: tuple[str, ...] = ()
    can_fd: bool = False
    listen: int | None = None
    drives: str | None = None
    dbc: Path | None = None
    map_path: Path | None = None
    board: str | None = None
    id_base: str | None = None
    duration_s: float | None = None
    logs: tuple[Path, ...] = ()
    live: bool = False
    faults: tuple[str, ...] = ()
    bus_faults: tuple[str, ...] = ()
    seed: int | None = None
    stop_within_s: float | None = None
    stop_distance_m: float | None = None
    recorded: Recorded = Recorded()  # where the run is written or shown besides its log

    @property
    def is_served(self) -> bool:
        """Whether the node itself is on the controller's bus, so that frames do not pass through this process."""
        return self.board == "bus" or (self.board == "process" and self.listen is not None)

    @property
    def random_seed(self) -> int:
        """Of random faults; 1 unless one is given."""
        return 1 if self.seed is None else self.seed

    @property
    def limits(self) -> Limits:
        """How soon the vehicle must stop."""
        return Limits(self.stop_within_s, self.stop_distance_m)


def check_options(options: PlayOptions) -> None:
    """BadInput for options that exclude each other or lack their counterpart."""
    if options.listen is not None and options.interface is not None:
        raise BadInput(f"--listen {options.listen}: serves a bus itself; leave --interface out")
    for name, value in (("--channel", options.channel), ("--bitrate", options.bitrate),
                        ("--bus-option", " ".join(options.bus_options) or None),
                        ("--can-fd", "" if options.can_fd else None)):
        if value is not None and options.interface is None:
            raise BadInput(f"{f'{name} {value}'.strip()}: give its --interface as well, such as socketcan")
    if options.listen is None and options.interface is None:
        raise BadInput("--interface: is missing; give it with --channel for the bus of the controller, or --listen 0 "
                       "for a port that it can connect to")
    if (options.dbc is None) != (options.map_path is None):
        raise BadInput("--map: is missing; it says which signal of --dbc is what" if options.map_path is None else
                       "--dbc: is missing; it has the messages of --map")
    if options.dbc is not None and options.drives is not None:
        raise BadInput(f"--drives {options.drives}: speaks the protocol of drives, --dbc its own; give one of them")
    if options.dbc is not None and options.board not in (None, "virtual"):
        raise BadInput(f"--board {options.board}: a vehicle with --dbc runs in this process; leave --board out")
    if options.dbc is not None and options.id_base is not None:
        raise BadInput(f"--id-base {options.id_base}: a vehicle with --dbc has the identifiers of its messages and "
                       "none of a node; leave --id-base out")
    if options.duration_s is not None and not 0.0 < options.duration_s < 1e9:
        raise BadInput(f"--duration {options.duration_s:g}: give seconds above 0 and below 1e9, or leave it out to "
                       "play until Ctrl-C")
    check_bitrate(options.bitrate)
    if options.seed is not None and "random" not in options.faults and not options.bus_faults:
        raise BadInput(f"--seed {options.seed}: nothing here is random; give --fault random or a --bus-fault, or "
                       "leave --seed out")
    options.limits.check()
    if options.board == "bus" and options.listen is not None:
        raise BadInput("--board bus: the node is a station of the controller's bus, and at a port of --listen there is "
                       "none; give --interface and --channel of that bus, or --board process")
    if options.bus_faults and options.is_served:
        raise BadInput(f"--bus-fault {options.bus_faults[0]}: with --board {options.board} frames do not pass through "
                       "this process; leave --board out")


@contextmanager
def controller_bus(options: PlayOptions) -> Iterator[can.BusABC]:
    """The bus on which the controller is."""
    if options.listen is not None:
        bus: can.BusABC = ListeningBus(options.listen)
    else:
        more = read_bus_options(options.bus_options, options.interface or "")
        if options.can_fd:
            more["fd"] = True
        bus = open_bus(options.interface or "", options.channel, bitrate=options.bitrate, **more)
    try:
        yield bus
    finally:
        with suppress(can.CanError, OSError):
            bus.shutdown()
