"""Whether a run fits the no-slip model: the reactions that it needs against the grip that is available.

A wheel slips where the reaction it needs exceeds friction coefficient times normal load; it lifts where its normal load
would have to be below zero. The model does neither: from there on it describes another robot.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from laconic.core.plant import Plant


@dataclass(frozen=True)
class GripEvent:
    """One instant at which a wheel or support is over the edge."""

    time_s: float
    step: int
    where: str           # "wheel 2", "support 1"
    needed_N: float      # size of the reaction
    available_N: float   # friction coefficient times normal load; 0 where it would lift
    normal_N: float
    margin_N: float      # friction coefficient · normal load − needed: the worst of all wheels at this instant


@dataclass(frozen=True)
class Grip:
    """What the watch found over a run; events are None where there was none."""

    friction_coefficient: float | None  # None: not given, so that slip cannot be judged
    instants: int                       # instants that were checked: the start of every step, and the end
    slipping: int
    lifting: int
    first_slip: GripEvent | None
    worst_slip: GripEvent | None
    first_lift: GripEvent | None
    worst_lift: GripEvent | None
    slipping_wheels: tuple[int, ...] = ()  # that slipped at some instant, counted from 1
    slip_loss_J: float | None = None    # given where wheels slip by the ground's friction: then nothing must not slip
    wheel_slip_loss_J: tuple[float, ...] | None = None  # the same of each wheel, by what the ends of steps show

    @classmethod
    def of(cls, grip: Any, plant: Plant, step_s: float) -> Grip:
        """From a laconic_grip; `step_s` as it was given, which single precision does not keep."""
        events = {name: event_of(getattr(grip, name), plant, step_s)
                  for name in ("first_slip", "worst_slip", "first_lift", "worst_lift")}
        vehicle, loss_J, each_J = plant.c.vehicle, None, None
        if plant.has_friction and plant.c.friction.slips:
            loss_J = float(plant.c.slip.slip_loss_J.value)
            each_J = tuple(float(grip.slip_loss_J[i].value) for i in range(plant.wheel_count))
        slipped = [bool(grip.wheel_slips[i]) for i in range(plant.wheel_count)]
        wheels = tuple(i + 1 for i, slips in enumerate(slipped) if slips)
        if each_J is not None:
            wheels = losing_wheels(slipped, each_J, ROLLED * vehicle.mass_kg * vehicle.wheel_radius_m)
        return cls(float(vehicle.friction_coefficient or vehicle.ground.friction_coefficient) or None,
                   int(grip.instants), int(grip.slipping), int(grip.lifting), **events,
                   slipping_wheels=wheels, slip_loss_J=loss_J, wheel_slip_loss_J=each_J)

    @property
    def holds(self) -> bool:
        """Whether the ground gave the needed reactions at every instant."""
        return not (self.slipping or self.lifting)

    def as_json(self) -> dict[str, Any]:
        """Machine-readable. Where wheels slip by the ground's friction, there is no condition to hold: null."""
        found = {"holds": self.holds, **{name: _of_json(each) for name, each in asdict(self).items()}}
        return found if self.slip_loss_J is None else found | {"holds": None, "slipping": None}

    def warning(self) -> str:
        """The events in one line; "" where every reaction was available."""
        found = []
        if self.first_slip and self.worst_slip:
            first, worst = self.first_slip, self.worst_slip
            at_worst = self._more(first, worst, self.slipping, "margin " + newtons(worst.margin_N))
            found.append(f"{self._all_that_slip()}{first.where} slips at {first.time_s:g} s (needs "
                         f"{newtons(first.needed_N)} of grip, has {newtons(first.available_N)}{_load_below_zero(first)}"
                         f": margin {newtons(first.margin_N)}{at_worst})")
        if self.first_lift and self.worst_lift:
            first, worst = self.first_lift, self.worst_lift
            found.append(f"{first.where} lifts at {first.time_s:g} s (normal load {newtons(first.normal_N)}"
                         f"{self._more(first, worst, self.lifting, newtons(worst.normal_N))})")
        return " and ".join(found)

    def _all_that_slip(self) -> str:
        """Where they are several; the one that slips first follows with its numbers."""
        return f"{wheels_text(self.slipping_wheels)} slip, and first " if self.slipping_wheels[1:] else ""

    def remedy(self) -> str:
        """What to do about the events."""
        if self.first_slip:
            return REMEDY_OF_SLIP
        return "accelerate less, or check com_z_m" if self.first_lift else ""

    def _more(self, first: GripEvent, worst: GripEvent, count: int, size: str) -> str:
        at_worst = "" if worst == first else f"; at worst {size}, {worst.where} at {worst.time_s:g} s"
        return f"{at_worst}; {percent(count, self.instants)} of the run"


REMEDY_OF_SLIP = ("ramp the inputs (kind = \"table\") or ask for less, or let wheels slip: give [ground] "
                  "friction_coefficient in place of vehicle.friction_coefficient")


ROLLED = 1e-5                # J for 1 kg on wheels of 1 m: a millionth of the radius, slid with all of its weight
LEAST_SHARE = 1e-3           # of all that slip took: a wheel that took less touched its limit and did not slip


def losing_wheels(slipped: Sequence[bool], loss_J: Sequence[float], rounding_J: float) -> tuple[int, ...]:
    """Numbers of the wheels that slipped in some step and lost more than rounding and LEAST_SHARE of all losses."""
    least_J = max(rounding_J, LEAST_SHARE * sum(loss_J))
    return tuple(i + 1 for i, lost_J in enumerate(loss_J) if slipped[i] and lost_J > least_J)


def wheels_text(wheels: Sequence[int]) -> str:
    """Several wheels for people: "wheels 1, 2 and 4"."""
    if not wheels[1:]:
        return f"wheel {wheels[0]}"
    return f"wheels {', '.join(map(str, wheels[:-1]))} and {wheels[-1]}"


def _of_json(value: Any) -> Any:
    """JSON has no infinite number and no NaN."""
    if isinstance(value, dict):
        return {name: _of_json(each) for name, each in value.items()}
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _load_below_zero(event: GripEvent) -> str:
    """Why the margin is below minus the need: it counts the friction coefficient times a load below 0."""
    return f" under a load of {newtons(event.normal_N)}" if event.normal_N < 0.0 else ""


def percent(count: int, of: int) -> str:
    """A share in three digits; what only rounds to all is not all."""
    shown = f"{100 * count / of:.3g}"
    return "over 99.9 %" if shown == "100" and count < of else f"{shown} %"


def newtons(force_N: float) -> str:
    """A force for people: three digits, or all before the point."""
    if not math.isfinite(force_N):
        return "beyond all numbers"
    return f"{force_N:.0f} N" if abs(force_N) >= 100.0 else f"{force_N:.3g} N"


def event_of(event: Any, plant: Plant, step_s: float) -> GripEvent | None:
    """A laconic_grip_event; None where it never happened."""
    if not event.point:
        return None
    wheels = plant.wheel_count
    where = f"wheel {event.point}" if event.point <= wheels else f"support {event.point - wheels}"
    friction = float(plant.c.vehicle.friction_coefficient)
    return GripEvent(
        event.steps * step_s, int(event.steps), where, float(event.needed_N),
        max(0.0, friction * float(event.normal_N)), float(event.normal_N), float(event.margin_N))
