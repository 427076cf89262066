"""Error estimate of a plant's run from Python: the core's laconic_estimate, beside the plant that it watches.

    estimate = plant.estimate()
    estimate.run({"voltage_V": [2.0, -2.0]}, steps=1000)     # the bits of plant.run
    estimate.read().now.place_m                              # how far the place is off, in metres
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from laconic.core.copies import NotCopied, OwnMemory
from laconic.core.given import c_object, step_count
from laconic.core.inputs import Schedule
from laconic.core.saved import check_saved
from laconic.errors import BadInput

if TYPE_CHECKING:
    from laconic.core.plant import Plant
    from laconic.core.recording import Recorder

USUAL_STEPS = 16


@dataclass(frozen=True)
class ErrorSizes:
    """Sizes of an error of the state."""

    nu_rad_per_s: float
    """Of the component of ν that is farthest off."""
    place_m: float
    """Distance of the centre of mass from its true place."""
    heading_rad: float
    wheel_angle_rad: float
    """Of the wheel that is farthest off."""


@dataclass(frozen=True)
class Errors:
    """What is known of a plant's error."""

    now: ErrorSizes
    """At this moment, rounding included."""
    largest: ErrorSizes
    """Since the start of the estimate."""
    rounding: ErrorSizes
    """The part of `now` that rounding makes whatever the step is."""
    unknown: int
    """Steps of which no half was taken: all that they change counts as error. 0: none."""


class Estimate(OwnMemory):
    """The error of one plant; `c` is the laconic_estimate itself. Step the plant by `run` from now on. A copy watches a
    plant of its own: `plant` of the copy."""

    def __init__(self, plant: Plant, most_steps: int = USUAL_STEPS):
        """No error yet; one step in `most_steps` is taken twice. Refused where that is not 1 to 1024."""
        self.plant, core = plant, plant.core
        self.c: Any = core.ffi.new("laconic_estimate *")
        why, most_steps = core.why(), min(step_count("most_steps", most_steps), 2**31 - 1)
        core.check(core.lib.laconic_estimate_start(self.c, plant.c, most_steps,
                                                   core.lib.laconic_finer_method(plant.c), why), why)

    def run(self, held: Any = None, steps: int = 1) -> None:
        """Steps with the input held, given as Plant.run takes it; the plant's bits are the same."""
        core, why = self.plant.core, self.plant.core.why()
        held, steps = self.plant.input_of(held), step_count("steps", steps)
        core.check(core.lib.laconic_estimate_run(self.c, self.plant.c, held, steps, why), why)

    def follow(self, schedule: Schedule, until_step: int, recorder: Recorder | None = None,
               rows: ErrorRows | None = None) -> None:
        """Steps along a schedule, recorded on the way, as Plant.follow."""
        core, why = self.plant.core, self.plant.core.why()
        until_step = step_count("until_step", until_step)
        record, error_rows = (core.ffi.NULL if each is None else each.c for each in (recorder, rows))
        core.check(core.lib.laconic_estimate_follow(self.c, self.plant.c, schedule.c, until_step, record, error_rows,
                                                    why), why)

    def change(self, vehicle: Any) -> None:
        """Plant.change, and the estimate goes on with the error that was; where friction begins or ends it starts
        anew."""
        self._carry(lambda: self.plant.change(vehicle))

    def set_step(self, step_s: float) -> None:
        """Plant.set_step, and the estimate goes on with the error that was."""
        self._carry(lambda: self.plant.set_step(step_s))

    def _carry(self, change: Callable[[], None]) -> None:
        """Where the estimate cannot go on the plant stays as it was."""
        core, c, why = self.plant.core, self.plant.c, self.plant.core.why()
        before = core.ffi.new("laconic_plant *", c[0])
        change()
        status = core.lib.laconic_estimate_carry(self.c, before, c, core.lib.laconic_finer_method(c), why)
        if status != core.lib.LACONIC_OK:
            c[0] = before[0]
        core.check(status, why)

    def read(self) -> Errors:
        """The errors at this moment."""
        found = self.plant.core.ffi.new("laconic_errors *")
        self.plant.core.lib.laconic_estimate_read(found, self.c, self.plant.c)
        return Errors(sizes_of(found.now), sizes_of(found.largest), sizes_of(found.rounding), int(found.unknown))

    def save(self) -> Any:
        """A copy of what is known; save the plant with it."""
        return self.plant.core.ffi.new("laconic_estimate *", self.c[0])

    def restore(self, saved: Any) -> None:
        """Back to what `save` gave; BadInput for what an estimate of another robot, method, step or window gave."""
        found = c_object(self.plant.core, "estimate", saved)
        if _constants_of(found) != _constants_of(self.c):
            raise BadInput("estimate: was saved for another robot, method, step or window; give what the save() of "
                           "this one gave")
        check_saved(self.plant.core, "estimate", found[0])
        self.c[0] = found[0]


def _constants_of(estimate: Any) -> tuple[Any, ...]:
    """What stays while an estimate runs, by which it belongs to its plant."""
    halves = estimate.halves
    return (estimate.most_steps, halves.method, estimate.finer.method, halves.step_s, halves.gyro_limit,
            *estimate.angle_per_zeta, *(gain for decay in halves.decay for gain in decay.gain),
            *(weight for row in halves.collocation for weight in row))


def sizes_of(error: Any) -> ErrorSizes:
    """Of a laconic_error."""
    return ErrorSizes(*(float(getattr(error, name)) for name in NAMES))


NAMES = tuple(ErrorSizes.__dataclass_fields__)


class ErrorRows(NotCopied):
    """Rows of errors, one at the start of every `every`-th step; room for `rows` of them."""

    REMEDY = "take its columns()"

    def __init__(self, plant: Plant, every: int, rows: int):
        ffi = plant.core.ffi
        self._table = np.zeros((rows, len(NAMES)), plant.core.dtype)
        self.c: Any = ffi.new("laconic_error_rows *", {
            "every": every, "row": ffi.cast("laconic_error *", ffi.from_buffer(self._table, require_writable=True)),
            "row_room": rows})

    def __len__(self) -> int:
        """How many were taken."""
        return int(self.c.row_count)

    def take(self, estimate: Estimate) -> None:
        """The row of the present moment: at the end of a run. There must be room."""
        now = estimate.read().now
        self._table[len(self)] = [getattr(now, name) for name in NAMES]
        self.c.row_count += 1

    def columns(self) -> dict[str, np.ndarray]:
        """What was taken, by signal name."""
        table = self._table[: self.c.row_count].astype(float, copy=False)
        return {f"estimated_error_{name}": column for name, column in zip(NAMES, table.T, strict=True)}
