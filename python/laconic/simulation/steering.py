"""Commands of hinges over a run: rates, angles and twists on the grid of its steps, within the limits of the scene.

Prescribed and coordinated hinges follow commands alone, so their angles are known before the motion. Without limits
a command varies linearly over each step. Within a limit of rate or angle a step goes as far towards the command as it
may, and is counted in `Limited`; with `at_limit = "refuse"` the run ends there.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Protocol

import numpy as np

from laconic.core.articulated import ArticulatedVehicle
from laconic.core.articulated_input import row_length
from laconic.errors import BadInput, Refused
from laconic.scene import Scene
from laconic.scene.hinge_signals import ANGLE, CURVATURE, RATE, TWIST
from laconic.scene.hinges import Hinge

ACROSS = 1e-9    # of an axle's direction: rounding
ROUNDING = 1e-9  # of a limit of rate
OF_ANGLE = 1e-12  # rad
STUCK = 1e-10    # of the way to a twist: the hinge is at its stop
HALVINGS = 50    # of the way to a twist beyond a limit


@dataclass
class Limited:
    """How long one limit held a command back."""

    hinge: str
    limit: str  # "rate" or "angle"
    first_s: float
    steps: int = 0

    def in_words(self, step_s: float) -> str:
        """For people."""
        return (f"{self.hinge}: the limit of its {self.limit} held the command back for {self.steps * step_s:g} s, "
                f"first at {self.first_s:g} s")


class Samples(Protocol):
    """Inputs on the grid of the steps: those of a scene, or those of a program that drives."""

    @property
    def signals(self) -> Sequence[str]:
        """Their names."""

    @property
    def step_s(self) -> float:
        """Of the grid."""

    def samples(self, first: int, count: int) -> np.ndarray:
        """Values (step, start|middle|end, signal) of some steps."""


class LiveInputs:
    """Inputs of the coming step, in the place of those that a scene gives for a run."""

    def __init__(self, signals: Sequence[str], step_s: float):
        self.signals, self.step_s = tuple(signals), step_s
        self.values = np.zeros(len(signals))

    def samples(self, first: int, count: int) -> np.ndarray:
        """The same at start, middle and end of each step."""
        return np.broadcast_to(self.values, (count, 3, len(self.values)))


@dataclass
class Commands:
    """The rows of inputs of a run, in order; `limited` fills as they are made, `refused` says what ends the run."""

    scene: Scene
    vehicle: ArticulatedVehicle
    inputs: Samples
    limited: dict[tuple[str, str], Limited] = field(default_factory=dict)
    refused: Refused | None = None

    def __post_init__(self) -> None:
        self._angle = {hinge.name: hinge.start_angle_rad for hinge in self.scene.hinges}
        self._numbers = {signal: at for at, signal in enumerate(self.inputs.signals)}
        self._plain = [(at, self.vehicle.slot(signal)) for signal, at in self._numbers.items()
                       if signal.partition("[")[0] not in (ANGLE, CURVATURE)]
        self._steering = self._steering_of() if self.vehicle.is_coordinated else None
        self._ends = 0  # the step that a limit refuses
        self._twist: np.ndarray | None = None
        self._stuck: tuple[list[np.ndarray], Hinge, str, float, float] | None = None  # target and twist at a stop

    def _steering_of(self) -> _Steering:
        return _Steering(self.scene, self._numbers)

    # ---- rows

    def first_row(self) -> np.ndarray:
        """The inputs at the start, where coordinated wheels point as commanded, within their stops."""
        row = self._rows(self._given(0, 1))[0, 0]
        if self._steering is not None and self._steering.is_limited:
            slot = self.vehicle.slot(TWIST)
            row[slot : slot + 3] = self._start_twist(self._steering, row[slot : slot + 3])
        return row

    def rows(self, first: int, count: int) -> np.ndarray:
        """Inputs at the start and end of steps `first` … in a row (steps, 2, numbers); steps come in order. Fewer where
        a limit ends the run: then `refused` is set."""
        given = self._given(first, count)
        found = self._rows(given)
        end = first + count
        for hinge in self.scene.hinges:
            if hinge.kind == "prescribed" and (f"{ANGLE}[{hinge.name}]" in self._numbers or hinge.has_stops
                                               or math.isfinite(hinge.rate_limit_rad_per_s)):
                end = min(end, self._until(partial(self._follow, hinge, found, given, first), end))
        if self._steering is not None:
            end = min(end, self._until(partial(self._steer, self._steering, found, given, first), end))
        return found[: end - first]

    def _until(self, follow: Callable[[], None], end: int) -> int:
        """The step before which commands can be followed."""
        try:
            follow()
        except Refused as refused:
            if self._ends < end:
                self.refused = refused
            return self._ends
        return end

    def row_at(self, tick: int, before: np.ndarray | None) -> np.ndarray:
        """The inputs at the end of the run: what would act from there on, commands as they are."""
        row = self._rows(self._given(tick, 1))[0, 0]
        if before is not None:
            for slot in self._command_slots():
                row[slot] = before[slot]
        return row

    def _command_slots(self) -> list[int]:
        slots = [self.vehicle.slot(f"{RATE}[{hinge.name}]") for hinge in self.scene.hinges]
        first = self.vehicle.slot(TWIST)
        return [*slots, first, first + 1, first + 2]

    def _given(self, first: int, count: int) -> np.ndarray:
        """The scene's inputs at the start and end of some steps, (steps, 2, signals)."""
        return self.inputs.samples(first, count)[:, [0, 2]]

    def _rows(self, given: np.ndarray) -> np.ndarray:
        found = np.zeros((*given.shape[:2], row_length(self.vehicle.core)))
        for at, slot in self._plain:
            found[:, :, slot] = given[:, :, at]
        if self._steering is not None:
            slot = self.vehicle.slot(TWIST)
            found[:, :, slot : slot + 3] = self._steering.twists(given)
        return found

    # ---- prescribed hinges

    def _follow(self, hinge: Hinge, rows: np.ndarray, given: np.ndarray, first: int) -> None:
        """Rates of one hinge within its limits, towards a commanded angle or along a commanded rate."""
        column = self._numbers.get(f"{ANGLE}[{hinge.name}]")
        targets = None if column is None else given[:, 1, column]
        self._go_to(hinge, rows, targets, first, np.zeros(len(rows)))

    def _go_to(self, hinge: Hinge, rows: np.ndarray, targets: np.ndarray | None, first: int, reached: np.ndarray
               ) -> None:
        """The same towards given angles, or along the rates in `rows`; `reached` gets the angle at each step's end."""
        slot, h = self.vehicle.slot(f"{RATE}[{hinge.name}]"), self.inputs.step_s
        angle, most = self._angle[hinge.name], hinge.rate_limit_rad_per_s
        rates = rows[:, :, slot] if targets is None else _held_rates(angle, targets, h)
        ends = np.cumsum([angle, *(0.5 * h * rates.sum(axis=1))])[1:] if targets is None else targets
        if len(ends) and np.abs(rates).max() <= most and hinge.low_rad <= ends.min() and ends.max() <= hinge.high_rad:
            rows[:, :, slot], self._angle[hinge.name] = rates, float(ends[-1])  # no limit holds it back
            reached[:] = ends
            return
        for k in range(len(rows)):
            if targets is None:
                wanted = rows[k, :, slot]
            else:
                target = targets[k]
                within = min(max(target, hinge.low_rad), hinge.high_rad)
                if abs(within - target) > OF_ANGLE:
                    self._limit(hinge, "angle", first + k, target, within)
                wanted = np.full(2, (within - angle) / h)
            rates = np.clip(wanted, -most, most)
            is_reached = targets is not None and np.array_equal(rates, wanted)
            if np.any(np.abs(wanted) > most * (1.0 + ROUNDING)):
                self._limit(hinge, "rate", first + k, float(np.max(np.abs(wanted))), most)
            end = within if is_reached else angle + 0.5 * h * float(rates.sum())
            stop = min(max(end, hinge.low_rad), hinge.high_rad)
            if abs(stop - end) > OF_ANGLE:
                self._limit(hinge, "angle", first + k, end, stop)
                rates = np.full(2, (stop - angle) / h)
            rows[k, :, slot], angle, reached[k] = rates, stop, stop
        self._angle[hinge.name] = angle

    def _limit(self, hinge: Hinge, what: str, step: int, value: float, limit: float) -> None:
        """Counts a limited step; ends the run where the scene says so."""
        time_s = step * self.inputs.step_s
        if hinge.refuses:
            unit = "rad/s" if what == "rate" else "rad"
            self._ends = step
            raise Refused(
                "limit of a hinge", f"hinge_{what}", 0, f"{self.scene.path}: at t = {time_s:g} s: {hinge.place} "
                f"({hinge.name}): the command asks for {value:.6g} {unit}, the limit of its {what} is {limit:.6g} "
                f"{unit}; command less, or give at_limit = \"saturate\"", value=value, limit=limit)
        found = self.limited.setdefault((hinge.name, what), Limited(hinge.name, what, time_s))
        found.steps += 1

    # ---- coordinated hinges

    def _steer(self, steering: _Steering, rows: np.ndarray, given: np.ndarray, first: int) -> None:
        """Twists within the limits of all coordinated hinges."""
        if not steering.is_limited:
            return
        slot, h = self.vehicle.slot(TWIST), self.inputs.step_s
        if self._steer_freely(steering, rows[:, :, slot : slot + 3], h):
            return
        targets = steering.unit(rows[:, 1, slot : slot + 3])
        for k, target in enumerate(targets):
            now = self._twist
            if now is None or not np.any(target):
                return  # which the core refuses
            reached = self._towards(steering, target, first + k, h)
            rows[k, 0, slot : slot + 3], rows[k, 1, slot : slot + 3] = now, reached
            for hinge, turn in zip(steering.hinges, steering.turns(now, reached), strict=True):
                self._angle[hinge.name] += float(turn)
            self._twist = reached

    def _steer_freely(self, steering: _Steering, twists: np.ndarray, h: float) -> bool:
        """Takes all twists of some steps as they are commanded, if no limit holds one of them back."""
        wanted = steering.unit(twists[:, 1])
        if self._twist is None or not wanted.any(axis=1).all():
            return False
        way = np.vstack([self._twist, wanted])
        turns = steering.turns(way[:-1], way[1:])
        now = np.array([self._angle[hinge.name] for hinge in steering.hinges])
        angles = np.cumsum(np.vstack([now, turns]), axis=0)[1:]
        if (np.abs(turns) > h * steering.rates).any() or (angles > steering.highs).any() or \
                (angles < steering.lows).any():
            return False
        twists[:, 0], twists[:, 1], self._twist = way[:-1], way[1:], way[-1]
        for hinge, angle in zip(steering.hinges, angles[-1], strict=True):
            self._angle[hinge.name] = float(angle)
        return True

    def _start_twist(self, steering: _Steering, given: np.ndarray) -> np.ndarray:
        """The twist at the start: the given one, or as near to it from straight ahead as the stops allow."""
        target = steering.unit(given)
        self._twist = target
        if not np.any(target):
            return given  # which the core refuses
        self._take_angles(steering, target)
        if any(not hinge.low_rad - OF_ANGLE <= self._angle[hinge.name] <= hinge.high_rad + OF_ANGLE
               for hinge in steering.hinges):
            self._twist = np.array([1.0, 0.0, 0.0])
            self._take_angles(steering, self._twist)
            self._twist = self._towards(steering, target, 0, math.inf)
            self._take_angles(steering, self._twist)
        return self._twist

    def _take_angles(self, steering: _Steering, twist: np.ndarray) -> None:
        """Angles of the hinges, next to those that the file gives."""
        for hinge, angle in zip(steering.hinges, steering.angles(twist).tolist(), strict=True):
            turns = round((hinge.start_angle_rad - angle) / (2.0 * math.pi))
            self._angle[hinge.name] = angle + 2.0 * math.pi * turns

    def _towards(self, steering: _Steering, target: np.ndarray, step: int, h: float) -> np.ndarray:
        """As far from the present twist to the target as limits allow."""
        assert self._twist is not None
        now = self._twist
        if self._stuck is not None and np.array_equal([target, now], self._stuck[0]):  # at a stop, as a step before
            self._limit(*self._stuck[1:3], step, *self._stuck[3:])
            return now
        broken, low, high = self._broken(steering, now, target, h), 0.0, 1.0
        if broken is None:
            return target
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            nearer = self._broken(steering, now, now + middle * (target - now), h)
            low, high, broken = (middle, high, broken) if nearer is None else (low, middle, nearer)
        hinge, what, _, limit = broken  # the one that holds it here
        asked = self._asked(steering, hinge, what, now, target, h)
        self._limit(hinge, what, step, asked, limit)
        if what == "angle" and low < STUCK:
            self._stuck = ([target, now], hinge, what, asked, limit)
            return now
        return steering.unit(now + low * (target - now))

    def _asked(self, steering: _Steering, hinge: Hinge, what: str, now: np.ndarray, target: np.ndarray, h: float
               ) -> float:
        """The rate or angle that the command asks of a hinge."""
        turn = steering.turns(now, target)[steering.hinges.index(hinge)]
        return float(abs(turn) / h if what == "rate" else self._angle[hinge.name] + turn)

    def _broken(self, steering: _Steering, now: np.ndarray, then: np.ndarray, h: float
                ) -> tuple[Hinge, str, float, float] | None:
        """The first limit that a step from one twist to another breaks: hinge, kind, value, limit."""
        turns = steering.turns(now, then)
        angles = np.array([self._angle[hinge.name] for hinge in steering.hinges]) + turns
        fast = np.abs(turns) > h * steering.rates * (1.0 + ROUNDING) if math.isfinite(h) else np.zeros(len(turns), bool)
        far = (angles > steering.highs + OF_ANGLE) | (angles < steering.lows - OF_ANGLE)
        if not (fast.any() or far.any()):
            return None
        at = int(np.argmax(fast | far))
        hinge = steering.hinges[at]
        if fast[at]:
            return hinge, "rate", abs(turns[at]) / h, hinge.rate_limit_rad_per_s
        return hinge, "angle", angles[at], hinge.high_rad if turns[at] > 0.0 else hinge.low_rad


def _held_rates(angle: float, targets: np.ndarray, h: float) -> np.ndarray:
    """Rates, held over each step, that reach all targets one after the other, (steps, 2)."""
    return np.repeat(np.diff(targets, prepend=angle)[:, None] / h, 2, axis=1)


class _Steering:
    """How the scene's inputs make a twist, and the twist the angles of coordinated hinges."""

    def __init__(self, scene: Scene, numbers: dict[str, int]):
        self.scene, self._numbers = scene, numbers
        bodies = [body for hinge, body in zip(scene.hinges, scene.vehicle["body"], strict=True)
                  if hinge.kind == "coordinated"]
        self.hinges = [hinge for hinge in scene.hinges if hinge.kind == "coordinated"]
        self.places = np.array([(body["hinge_x_m"], body["hinge_y_m"]) for body in bodies])
        self._size_m = max(float(np.abs(self.places).max()), 1e-3)
        self.rates, self.lows, self.highs = (np.array([getattr(hinge, name) for hinge in self.hinges])
                                             for name in ("rate_limit_rad_per_s", "low_rad", "high_rad"))
        self.is_limited = any(hinge.has_stops or math.isfinite(hinge.rate_limit_rad_per_s) for hinge in self.hinges)
        self._axle_x_m = self._axle_of_carriage() if CURVATURE in numbers or ANGLE in numbers else 0.0
        self._base_m = float(np.mean(self.places[:, 0])) - self._axle_x_m
        if ANGLE in numbers and abs(self._base_m) < 1e-6 * self._size_m:
            raise BadInput(f"{scene.path}: input: {ANGLE} is that of wheels ahead of or behind a fixed axle, and these "
                           f"lie on it or around the origin; give {TWIST} or {ANGLE}[name]")

    def _axle_of_carriage(self) -> float:
        """ξ of the line on which the carriage's fixed wheels stand; 0 where it has none."""
        found = [wheel for wheel in self.scene.vehicle["wheel"] if "body" not in wheel and wheel["kind"] == "fixed"]
        for wheel in found:
            if abs(math.cos(wheel["axle_rad"])) > ACROSS:
                raise BadInput(f"{self.scene.path}: input: {CURVATURE} and {ANGLE} need fixed wheels that roll along "
                               f"the first axis (axle_deg = 90 or -90); give {TWIST}")
        return float(found[0]["x_m"]) if found else 0.0

    def twists(self, given: np.ndarray) -> np.ndarray:
        """Twists (…, 3) from the samples (…, signals); straight ahead where nothing steers."""
        twists = np.zeros((*given.shape[:-1], 3))
        if any(signal.startswith(TWIST) for signal in self._numbers):
            for i in range(3):
                if (at := self._numbers.get(f"{TWIST}[{i + 1}]")) is not None:
                    twists[..., i] = given[..., at]
            return twists
        twists[..., 0] = 1.0
        if CURVATURE in self._numbers:
            twists[..., 2] = given[..., self._numbers[CURVATURE]]
        elif ANGLE in self._numbers:
            angles = given[..., self._numbers[ANGLE]]
            if np.any(np.abs(angles) >= math.pi / 2):
                raise BadInput(f"{self.scene.path}: input: {ANGLE} reaches {float(np.max(np.abs(angles))):g} rad; give "
                               f"less than a right angle, or {TWIST}")
            twists[..., 2] = tangent_of(angles) / self._base_m
        twists[..., 1] = -self._axle_x_m * twists[..., 2]
        return twists

    def unit(self, twist: np.ndarray) -> np.ndarray:
        """The twist of size 1, or each of many; lengths are over the vehicle's, and 0 stays 0."""
        largest = np.abs(twist).max(axis=-1, keepdims=True)
        usable = (largest > 0.0) & (largest < math.inf)
        scaled = np.divide(twist, largest, out=np.zeros_like(twist), where=usable)
        ahead, aside, yaw = np.split(scaled * (1.0, 1.0, self._size_m), 3, axis=-1)
        size = np.sqrt(ahead * ahead + aside * aside + yaw * yaw)  # the same bits everywhere
        return np.divide(scaled, size, out=scaled, where=usable)

    def _directions(self, twist: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Velocity at each hinge, ahead and to the left, for one twist or many."""
        x, y = self.places.T
        ahead, aside, yaw = (twist[..., [i]] for i in range(3))
        return ahead - yaw * y, aside + yaw * x

    def angles(self, twist: np.ndarray) -> np.ndarray:
        """Angle of each hinge in [−π, π], for one twist or many."""
        return angle_of(*self._directions(twist))

    def turns(self, now: np.ndarray, then: np.ndarray) -> np.ndarray:
        """How far each hinge turns from one twist to another."""
        (x0, y0), (x, y) = self._directions(now), self._directions(then)
        return angle_of(x * x0 + y * y0, y * x0 - x * y0)


def tangent_of(angles: np.ndarray) -> np.ndarray:
    """Tangents of angles below a right angle, by operations that every machine rounds alike, as the npm package does:
    sine over cosine of an eighth by their series, doubled three times."""
    eighths = angles / 8.0
    t = eighths * _series(eighths, 13) / _series(eighths, 12)
    for _ in range(3):
        t = 2.0 * t / (1.0 - t * t)
    return t


def _series(x: np.ndarray, last: int) -> np.ndarray:
    """Of sin(x)/x by odd powers up to a last one, of cos(x) by even ones."""
    found, square = np.ones_like(x), x * x
    for k in range(last, 1, -2):
        found = 1.0 - square * found / (k * (k - 1.0))
    return found


def angle_of(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Directions of vectors, by operations that every machine rounds alike, as the npm package does.

    The tangent of the half angle is y/(r + x) in the right half plane; three more halves leave a short series.
    """
    beside = np.abs(x)
    whole = np.sqrt(x * x + y * y) + beside
    t = np.divide(y, whole, out=np.zeros_like(whole), where=whole > 0.0)
    for _ in range(3):
        t = t / (1.0 + np.sqrt(1.0 + t * t))
    square, series = t * t, np.zeros_like(t)
    for k in range(15, 0, -2):
        series = 1.0 / k - square * series
    angle = 16.0 * (t * series)
    return np.where(x < 0.0, np.where(y < 0.0, -math.pi, math.pi) - angle, angle)
