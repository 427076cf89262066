"""One `laconic play` from the open bus to its end, however that comes, and what there is to say about it.

What goes wrong on purpose in a run, and the verdict on whether the vehicle stopped.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

import can

from laconic.can.play.faults import Saboteur, faulty_bus, read_bus_faults, read_faults
from laconic.can.play.live import live_traffic
from laconic.can.play.loop import Loop, Seconds, Traffic
from laconic.can.play.options import PlayOptions, check_options
from laconic.can.play.places import Place, Played, place_of
from laconic.can.play.settings import DriveSettings, as_values
from laconic.can.play.stopping import Journey, Witness
from laconic.can.play.vehicle import check_playable, coasts_for_ever
from laconic.can.rig.bagged import played_views
from laconic.can.rig.errors import BusDied, Interrupted, Interruption
from laconic.can.rig.faulty import FaultyBus
from laconic.can.rig.link import Clock
from laconic.can.rig.logs import Lost, logged
from laconic.can.rig.verdict import Judgement, Verdict
from laconic.errors import LaconicError
from laconic.scene import Scene


class Trouble:
    """Faults of drives and bus; `bus` is the controller's with its faults, `others` are called in the loop."""

    def __init__(self, place: Place, options: PlayOptions, vehicle: Played, traffic: Traffic, bus: can.BusABC):
        self.limits, self.bus = options.limits, bus
        self.faults = read_faults(options.faults, place.can_fail, options.duration_s, options.random_seed)
        bus_faults = read_bus_faults(options.bus_faults, place.can_fail, options.random_seed)
        if bus_faults:
            self.bus = faulty_bus(bus, bus_faults, lambda: traffic.clock.now_us() / 1e6)
        self.others: list[Callable[[int], int | None]] = []
        self._saboteur = Saboteur(vehicle, self.faults) if self.faults else None
        if self._saboteur is not None:
            self.others.append(self._saboteur)
        self._witness: Witness | None = None
        if self.limits.are_given:
            has_faults = bool(self.faults or bus_faults)
            self._witness = Witness(vehicle, self._first_fault if has_faults else None,
                                    coasts=coasts_for_ever(place.scene))
            self.others.append(self._witness)
            traffic.of_controller.append(self._witness.heard)

    def __enter__(self) -> Trouble:
        return self

    def __exit__(self, *_: object) -> None:
        if isinstance(self.bus, FaultyBus):
            self.bus.let_go()

    @property
    def judges_stop(self) -> bool:
        """Whether the vehicle's stop is judged: a watchdog that fires may be what stops it."""
        return self.limits.are_given

    def _first_fault(self) -> float | None:
        found = [self._saboteur.first_s if self._saboteur is not None else None,
                 self.bus.model.first_injection_s if isinstance(self.bus, FaultyBus) else None]
        return min((each for each in found if each is not None), default=None)

    def verdicts(self) -> list[Verdict]:
        """On the vehicle's stop, where it is wanted."""
        return [self._witness.verdict(self.limits)] if self._witness is not None else []


Others = Sequence[Callable[[int], int | None]]
OF_STATIONS = ("node_ids", "watchdog_s")
Say = Callable[[str], None]


def play(scene: Scene, options: PlayOptions, *, clock: Clock | None = None, others: Others = (),
         say: Say = lambda _: None) -> Judgement:
    """Plays the vehicle until it is stopped or `options.duration_s` is over. `others` are called in its loop, in tests
    controllers in virtual time; `say` gets the lines that a person wants to read at the start."""
    check_options(options)
    check_playable(scene)
    place = place_of(scene, options)
    read_faults(options.faults, place.can_fail, options.duration_s, options.random_seed)
    read_bus_faults(options.bus_faults, place.can_fail, options.random_seed)
    traffic, seconds, lost = Traffic(clock or Clock()), Seconds(), Lost()
    with Interruption() as signals, place.opened(traffic.clock) as (vehicle, bus), \
            logged(traffic, options.logs, lost), played_views(vehicle, scene, options.recorded) as recorders, \
            shown(traffic, scene, options) as moved:
        traffic.may_go_on = signals.check
        trouble, journey = Trouble(place, options, vehicle, traffic, bus), Journey(vehicle)
        with place.playing(vehicle), trouble:
            for line in introduction(place, bus):  # the scene has been taken: nothing is refused any more
                say(line)
            ending = Loop(vehicle, trouble.bus, traffic, [*trouble.others, journey, *recorders, *others]).run(
                options.duration_s, moved)
            signals.number = 0  # it has been heard
    judgement = judged(scene, place, vehicle, traffic, seconds, ending, trouble)
    judgement.unwritten += lost.values()
    judgement.figures |= journey.figures()
    judgement.notes += [*vehicle.notes(), *of_controllers(place, bus, judgement)]
    return judgement


def introduction(place: Place, bus: can.BusABC) -> Iterator[str]:
    """What a person must know: the drives with their settings, and how to connect a controller."""
    if place.settings is not None:
        yield drives_text(place.settings, is_map=place.options.dbc is not None)
        yield "the drives are the motors: the vehicle has no motor gain, and viscous friction as its only motor damping"
    if place.remark is not None:
        yield place.remark
    yield place.where(bus)


def drives_text(settings: DriveSettings, *, is_map: bool = False) -> str:
    """A line for each key, with its origin; drives of a map are no stations and have no watchdog of their own."""
    rows = [(key, value, f"({origin})") for key, value, origin in settings.rows()
            if not (is_map and key in OF_STATIONS)]
    widths = [max(len(row[column]) for row in rows) for column in range(2)]
    lines = (f"  {key:{widths[0]}}  {value:{widths[1]}}  {origin}" for key, value, origin in rows)
    return "\n".join([f"drives: {'of the map' if is_map else settings.protocol.name}", *lines])


@contextmanager
def shown(traffic: Traffic, scene: Scene, options: PlayOptions) -> Iterator[Callable[[float], None]]:
    """The live view, where it is wanted."""
    if not options.live:
        yield lambda _: None
        return
    with live_traffic(traffic, scene.name) as moved:
        yield moved


def judged(scene: Scene, place: Place, vehicle: Played, traffic: Traffic, seconds: Seconds,
           ending: LaconicError | None, trouble: Trouble) -> Judgement:
    """Verdicts and figures."""
    judgement = Judgement(scene.name, place.name)
    died, late = isinstance(ending, BusDied), vehicle.lateness
    text = f"{traffic.frames_in} frames heard, {traffic.frames_out} sent by the vehicle"
    judgement.add(Verdict("bus", not died, str(ending) if died else text))
    fired = vehicle.watchdogs()
    if trouble.judges_stop:
        judgement.notes += [f"watchdog: {each}" for each in fired]
    else:
        judgement.add(Verdict("watchdog", not fired, "; ".join(fired) or "never fired"))
    judgement.notes += [f"fault: {each}" for each in trouble.faults]
    if place.remark is not None:
        judgement.notes.append(place.remark)
    judgement.add(*trouble.verdicts())
    if ending is not None and not isinstance(ending, (BusDied, Interrupted)):
        judgement.add(Verdict("vehicle", False, str(ending)))
    judgement.figures |= {
        "seconds": seconds.passed(), "periods": late.periods, "late_periods": late.late_periods,
        "worst_lateness_ms": late.worst_us / 1000.0,
        "frames_in": traffic.frames_in, "frames_out": traffic.frames_out}
    if place.settings is not None:
        judgement.facts["drives"] = as_values(place.settings)
    if isinstance(ending, Interrupted):
        judgement.notes.append("stopped by the user")
    return judgement


def of_controllers(place: Place, bus: can.BusABC, judgement: Judgement) -> Iterator[str]:
    """Notes on programs at the port that were not there, or too slow."""
    if place.visitors(bus) == 0:
        yield f"no controller ever connected to port {place.port_of(bus)}"
    frames, longest_s = place.not_taken(bus)
    if frames:
        judgement.figures |= {"frames_not_taken": frames}
        how_long = f" (nothing for up to {longest_s:.2g} s)" if longest_s else ""
        yield (f"{frames} frames were lost to a program on the port, which did not read them in time{how_long}; what "
               "it reads late is old: a longer --step has fewer frames, docs/play.md")
