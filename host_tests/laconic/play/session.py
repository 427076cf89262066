"""One `laconic play` from the open bus to its end, however that comes, and what there is to say about it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Protocol

import can

from laconic.errors import LaconicError
from laconic.play.listener import ListeningBus
from laconic.play.live import live_traffic
from laconic.play.loop import Lateness, Loop, Seconds, Traffic, Vehicle
from laconic.play.map_file import read_map
from laconic.play.map_join import check_map, join
from laconic.play.map_vehicle import MapVehicle
from laconic.play.options import PlayOptions, check_options, controller_bus
from laconic.play.settings import DriveSettings, drive_settings
from laconic.play.vehicle import check_playable, played
from laconic.rig.errors import BusDied, Interrupted
from laconic.rig.interruption import Interruption
from laconic.rig.link import Clock
from laconic.rig.logs import logged
from laconic.rig.verdict import Judgement, Verdict
from laconic.scene import Scene

Others = Sequence[Callable[[int], int | None]]
Say = Callable[[str], None]


class Played(Vehicle, Protocol):
    """A vehicle that can be judged."""

    lateness: Lateness

    def watchdogs(self) -> list[str]:
        """The watchdogs that fired, in words."""

    def notes(self) -> list[str]:
        """What else there is to say."""


def play(scene: Scene, options: PlayOptions, *, clock: Clock | None = None, others: Others = (),
         say: Say = lambda _: None) -> Judgement:
    """Plays the vehicle until it is stopped or `options.duration_s` is over. `others` are called in its loop, in tests
    controllers in virtual time; `say` gets the lines that a person wants to read at the start."""
    check_options(options)
    check_playable(scene)
    traffic, seconds = Traffic(clock or Clock()), Seconds()
    with Interruption() as signals, vehicle_of(scene, options, traffic, say) as vehicle, \
            controller_bus(options) as bus, logged(traffic, options.logs), shown(traffic, scene, options) as moved:
        traffic.may_go_on = signals.check
        say(where(bus))
        ending = Loop(vehicle, bus, traffic, others).run(options.duration_s, moved)
        return judged(scene, options, vehicle, traffic, seconds, ending, bus)


@contextmanager
def vehicle_of(scene: Scene, options: PlayOptions, traffic: Traffic, say: Say) -> Iterator[Played]:
    """The vehicle with its drives: a map's, in this process."""
    assert options.dbc is not None and options.map_path is not None
    joined = join(read_map(options.map_path, scene.wheel_count), options.dbc)
    settings: DriveSettings | None = None
    if joined.has_drives:
        settings = drive_settings(scene, options.drives or "canopen")
        scene = played(scene)
    check_map(scene, joined)
    yield MapVehicle(scene, settings, joined, traffic.clock.now_us())


def where(bus: can.BusABC) -> str:
    """What a person must know to connect a controller."""
    if isinstance(bus, ListeningBus):
        return f"listening on 127.0.0.1:{bus.port}: interface slcan, channel socket://127.0.0.1:{bus.port}"
    return f"on {bus.channel_info}"


@contextmanager
def shown(traffic: Traffic, scene: Scene, options: PlayOptions) -> Iterator[Callable[[float], None]]:
    """The live view, where it is wanted."""
    if not options.live:
        yield lambda _: None
        return
    with live_traffic(traffic, scene.name) as moved:
        yield moved


def judged(scene: Scene, options: PlayOptions, vehicle: Played, traffic: Traffic, seconds: Seconds,
           ending: LaconicError | None, bus: can.BusABC) -> Judgement:
    """Verdicts and figures."""
    judgement = Judgement(scene.name, "dbc" if options.dbc else "drives")
    died, late = isinstance(ending, BusDied), vehicle.lateness
    judgement.add(Verdict("bus", not died, str(ending) if died else f"{traffic.frames_in} frames from the controller, "
                          f"{traffic.frames_out} from the vehicle"))
    fired = vehicle.watchdogs()
    judgement.add(Verdict("watchdog", not fired, "; ".join(fired) or "never fired"))
    if ending is not None and not isinstance(ending, (BusDied, Interrupted)):
        judgement.add(Verdict("vehicle", False, str(ending)))
    judgement.figures |= {
        "seconds": seconds.passed(), "periods": late.periods, "late_periods": late.late_periods,
        "worst_lateness_ms": late.worst_us / 1000.0, "frames_in": traffic.frames_in, "frames_out": traffic.frames_out}
    if isinstance(ending, Interrupted):
        judgement.notes.append("stopped by the user")
    if isinstance(bus, ListeningBus) and not bus.joined:
        judgement.notes.append(f"no controller ever connected to port {bus.port}")
    judgement.notes += vehicle.notes()
    return judgement
