"""Drives that fail, by script or by seed: what fails, which drive, when and for how long.

    stall:1@2           from 2 s on a brake holds wheel 1
    encoder:2@1.5+0.5   the encoder of wheel 2 is lost at 1.5 s, for half a second
    bus-off@2           the only station of a map's vehicle leaves the bus
    random              one of them, its wheel and its instant by the seed
"""

from __future__ import annotations

import random
import re
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import can

from laconic.can.play.can_fail import CanFail
from laconic.can.play.protocols import ERROR_FRAMES
from laconic.can.rig.faults import FIELD_TYPES, FaultModel, faults_from
from laconic.can.rig.faulty import FaultyBus
from laconic.errors import BadInput, nearest_of

RANDOM = "random"
FORM = re.compile(r"(?P<kind>[a-z-]+)(:(?P<wheel>\d+))?@(?P<at>[^+]+)(\+(?P<for>.+))?")


@dataclass(frozen=True)
class DriveFault:
    """One fault of the drive of one wheel, counted from 1; wheel 0: of the whole vehicle as a station of the bus."""

    kind: str
    wheel: int
    at_s: float
    for_s: float | None = None

    def __str__(self) -> str:
        wheel = f":{self.wheel}" if self.wheel else ""
        return f"{self.kind}{wheel}@{self.at_s:g}" + (f"+{self.for_s:g}" if self.for_s is not None else "")


class Breakable(Protocol):
    """A vehicle whose drives can be broken."""

    def break_drive(self, fault: DriveFault, *, is_broken: bool) -> None:
        """The fault begins, or ends."""


def read_faults(given: Sequence[str], can_fail: CanFail, duration_s: float | None, seed: int
                ) -> tuple[DriveFault, ...]:
    """The faults of --fault, of those that are possible; BadInput for one that cannot be."""
    return tuple(_read(text, can_fail, duration_s, seed + number) for number, text in enumerate(given))


def _read(text: str, can_fail: CanFail, duration_s: float | None, seed: int) -> DriveFault:
    if text == RANDOM:
        return _random(can_fail, duration_s, seed)
    form = FORM.fullmatch(text)
    if form is None:
        raise BadInput(f"--fault {text}: give KIND:WHEEL@SECONDS, such as stall:1@2 or encoder:2@1.5+0.5, or random")
    kind = form["kind"]
    if kind not in can_fail.kinds:
        reason = can_fail.why_not.get(kind) or f"there is no such fault here; {nearest_of(kind, can_fail.kinds)}"
        raise BadInput(f"--fault {text}: {reason}")
    wheel = _wheel(text, kind, form["wheel"], can_fail)
    at_s, for_s = _seconds(text, form["at"]), _seconds(text, form["for"]) if form["for"] else None
    if duration_s is not None and at_s >= duration_s:
        raise BadInput(f"--fault {text}: would come after the end; give an instant before {duration_s:g} s")
    return DriveFault(kind, wheel, at_s, for_s)


def _wheel(text: str, kind: str, number: str | None, can_fail: CanFail) -> int:
    if kind in can_fail.of_whole:
        if number is not None:
            raise BadInput(f"--fault {text}: a map's vehicle is one station of the bus; give {kind}@SECONDS, no wheel")
        return 0
    if number is None and len(can_fail.wheels) > 1:
        raise BadInput(f"--fault {text}: names no wheel; give {kind}:WHEEL@SECONDS with one of "
                       f"{', '.join(map(str, can_fail.wheels))}")
    wheel = int(number) if number is not None else can_fail.wheels[0]
    if wheel not in can_fail.wheels:
        raise BadInput(f"--fault {text}: wheel {wheel} has no drive; give one of "
                       f"{', '.join(map(str, can_fail.wheels))}")
    return wheel


def _random(can_fail: CanFail, duration_s: float | None, seed: int) -> DriveFault:
    if duration_s is None:
        raise BadInput("--fault random: needs --duration, in whose middle half it happens")
    chance = random.Random(seed)
    kind = chance.choice(can_fail.kinds)
    wheel = 0 if kind in can_fail.of_whole else chance.choice(can_fail.wheels)
    return DriveFault(kind, wheel, round(chance.uniform(0.25, 0.75) * duration_s, 3))


def _seconds(text: str, number: str) -> float:
    try:
        value = float(number)
    except ValueError:
        value = -1.0
    if not 0.0 <= value < 1e9:
        raise BadInput(f"--fault {text}: {number} is no time; give seconds from 0 on")
    return value


def read_bus_faults(given: Sequence[str], can_fail: CanFail, seed: int) -> dict[str, str]:
    """The faults of --bus-fault by name; FaultyBus reads their values."""
    found = {}
    for text in given:
        name, equals, value = text.partition("=")
        if name not in FIELD_TYPES:
            raise BadInput(f"--bus-fault {text}: give NAME=VALUE, such as loss=0.01; {nearest_of(name, FIELD_TYPES)}")
        if not equals:
            raise BadInput(f"--bus-fault {text}: has no value; give {name}=VALUE")
        if name in found:
            raise BadInput(f"--bus-fault {text}: {name} is given twice; keep one of them")
        if name == "error_frames" and (why := can_fail.why_not.get(ERROR_FRAMES)) is not None:
            raise BadInput(f"--bus-fault {text}: {why}")
        found[name] = value
    if not found:
        return {}
    faults = {"seed": str(seed), **found}
    try:
        FaultModel(faults_from(dict(faults)))  # before a bus is opened
    except ValueError as error:
        raise BadInput(f"--bus-fault {error}") from None
    return faults


def faulty_bus(bus: can.BusABC, faults: dict[str, str], now_s: Callable[[], float]) -> FaultyBus:
    """The controller's bus with these faults, which have been read, in front of it."""
    return FaultyBus(inner=bus, clock=now_s, **faults)


class Saboteur:
    """Begins and ends faults in time; called in the loop. One that is given twice at a time lasts until both end."""

    def __init__(self, vehicle: Breakable, faults: Sequence[DriveFault]):
        self.vehicle = vehicle
        self.first_s: float | None = None  # since the start, when the first fault began
        self._start_us: int | None = None
        self._lasting: Counter[tuple[str, int]] = Counter()  # by kind and wheel
        self._due = sorted([(fault.at_s, True, fault) for fault in faults]
                           + [(fault.at_s + fault.for_s, False, fault) for fault in faults if fault.for_s is not None],
                           key=lambda each: each[0])

    def __call__(self, now_us: int) -> int | None:
        self._start_us = now_us if self._start_us is None else self._start_us
        while self._due and self._start_us + 1e6 * self._due[0][0] <= now_us:
            at_s, is_broken, fault = self._due.pop(0)
            self._lasting[fault.kind, fault.wheel] += 1 if is_broken else -1
            self.vehicle.break_drive(fault, is_broken=self._lasting[fault.kind, fault.wheel] > 0)
            self.first_s = at_s if self.first_s is None else self.first_s
        return self._start_us + round(1e6 * self._due[0][0]) if self._due else None
