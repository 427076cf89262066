"""The true motion of a made-up vehicle in 50 digits; where damping is at most a thousand times the usual it is enclosed
as well, and the 50 digits must lie inside."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from flint import arb

from laconic.enclosure.balls import Vector, ball, precision, times
from laconic.enclosure.equation import equation_of
from laconic.enclosure.loads import Stretch
from laconic.enclosure.motion import Motion
from laconic.enclosure.state import Beginning
from laconic.errors import ResultFails
from laconic.population.collocation import exact_start, true_states
from laconic.population.made import Made, cuts_s
from laconic.verification.derivatives.trials import INPUTS

MOST_ENCLOSED = 1e3       # times the usual damping
GOAL_BITS, GUARD_BITS = 100, 48
AGREE = 1e-20             # of 50 digits with an enclosure, beyond its radius, relative to the largest number
KINDS = {"nu": slice(0, 3), "pose": slice(3, 6), "wheel": slice(6, None)}


@dataclass(frozen=True)
class Truth:
    """States at the instants, and how they were found."""

    by: str                # "enclosure", "50 digits"
    states: list[Vector]   # as balls; those of 50 digits are thin
    width: float           # the largest radius beside the largest number of its kind, or 1

    def errors(self, found: np.ndarray) -> dict[str, float]:
        """Upper bounds of the core's errors, by kind: beside the largest true number, or 1 where that is less."""
        return {name: max((upper(ball(float(x)) - y) for each, row in zip(found, self.states, strict=True)
                           for x, y in zip(each[part], row[part], strict=True)), default=0.0) / self.size(part)
                for name, part in KINDS.items()}

    def size(self, part: slice) -> float:
        """The largest number of a kind, or 1 where that is less."""
        return size_of(self.states, part)


def upper(number: arb) -> float:
    return float(number.abs_upper())


def size_of(states: list[Vector], part: slice) -> float:
    return max(1.0, *(upper(x) for row in states for x in row[part]), 1.0)


def truth_of(vehicle: Made, nu: np.ndarray) -> Truth:
    """The true motion from the core's start."""
    model, start = exact_start(vehicle.trial.table, nu.tolist())
    digits = true_states(model, start, vehicle.trial.heading_rad, vehicle.helds, cuts_s(vehicle.real))
    if vehicle.factor > MOST_ENCLOSED:
        return Truth("50 digits", digits, 0.0)
    states = enclosed(vehicle, start)
    check_inside(states, digits)
    width = max(upper(x.rad()) / size_of(states, part) for part in KINDS.values() for row in states for x in row[part])
    return Truth("enclosure", states, width)


def check_inside(enclosure: list[Vector], digits: list[Vector]) -> None:
    """ResultFails where the two differ: then one of them is wrong."""
    for part in KINDS.values():
        slack = AGREE * size_of(enclosure, part)
        off = max((upper(x - y) - upper(x.rad()) for one, other in zip(enclosure, digits, strict=True)
                   for x, y in zip(one[part], other[part], strict=True)), default=0.0)
        if not off <= slack:
            raise ResultFails(f"the motion in 50 digits is {off:.1e} outside of its enclosure")


def enclosed(vehicle: Made, start_nu: Vector) -> list[Vector]:
    """By laconic.enclosure, each number of the vehicle the double that it is."""
    cuts = cuts_s(vehicle.real)
    edges = [cuts[0][0] * 0, *(each[-1] for each in cuts)]
    stretches = [Stretch(begin, end, named(held))
                 for (begin, end), held in zip(pairwise(edges), vehicle.helds, strict=True)]
    with precision(GOAL_BITS + GUARD_BITS):
        table = vehicle.trial.table
        equation = equation_of(table, table.get("ground"))
        zeta = times(equation.zeta_of_nu, start_nu)
        motion = Motion(equation, Beginning(zeta, [arb(0), arb(0)], ball(vehicle.trial.heading_rad)), GOAL_BITS)
        return [sample.row() for sample in motion.samples(stretches, [t for each in cuts for t in each])]


def named(held: dict[str, list[float]]) -> dict[str, float]:
    """Inputs by the names of a scene's signals."""
    found = {}
    for name in INPUTS:
        if name == "body_moment_Nm":
            found[name] = held[name][0]
        else:
            found |= {f"{name}[{i}]": value for i, value in enumerate(held[name], start=1)}
    return found
