"""What goes wrong on purpose in a run, and the verdict on whether the vehicle stopped."""

from __future__ import annotations

from collections.abc import Callable

import can

from laconic.can.play.faults import Saboteur, faulty_bus, read_bus_faults, read_faults
from laconic.can.play.loop import Traffic
from laconic.can.play.options import PlayOptions
from laconic.can.play.places import Place, Played
from laconic.can.play.stopping import Witness
from laconic.can.play.vehicle import coasts_for_ever
from laconic.can.rig.faulty import FaultyBus
from laconic.can.rig.verdict import Verdict


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
