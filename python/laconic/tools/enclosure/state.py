"""What a motion is at an instant, and over a step: exact middles with radii, and the balls that users see.

How the radius of ζ grows over a step.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from flint import arb, arb_poly

from laconic.tools.enclosure.balls import Vector, length, upper
from laconic.tools.enclosure.defect import Defects, Growth, Step
from laconic.tools.enclosure.equation import Equation, Forcing
from laconic.tools.enclosure.flow import Frame

# ---- A number as single or double precision computes it: the range of what exact arithmetic gives, and how far
# rounding is from it at most. Every operation is rounded once, as the core's are.

@dataclass(frozen=True)
class Format:
    """u = half a unit in the last place of 1, and what the smallest numbers round by."""

    unit: arb
    least: arb

    @classmethod
    def of(cls, real: str) -> Format:
        info = np.finfo(np.float32 if real == "single" else np.float64)
        return cls(arb(float(info.eps)) / 2, arb(float(info.smallest_subnormal)))


@dataclass(frozen=True)
class Rounded:
    """`exact`: a ball with all that exact arithmetic can give; `off`: a bound of |computed − exact|."""

    exact: arb
    off: arb
    format: Format

    def _of(self, other: Any) -> Rounded:
        return other if isinstance(other, Rounded) else Rounded(arb(float(other)), arb(0), self.format)

    def _once(self, exact: arb, off: arb, tiny: bool) -> Rounded:
        """With the operation's own rounding; sums of floats do not underflow."""
        own = self.format.unit * (upper(exact) + off) + (self.format.least if tiny else arb(0))
        return Rounded(exact, upper(off + own), self.format)

    def __add__(self, other: Any) -> Rounded:
        b = self._of(other)
        return self._once(self.exact + b.exact, self.off + b.off, tiny=False)

    def __sub__(self, other: Any) -> Rounded:
        b = self._of(other)
        return self._once(self.exact - b.exact, self.off + b.off, tiny=False)

    def __rsub__(self, other: Any) -> Rounded:
        return self._of(other) - self

    def __mul__(self, other: Any) -> Rounded:
        b = self._of(other)
        off = upper(self.exact) * b.off + upper(b.exact) * self.off + self.off * b.off
        return self._once(self.exact * b.exact, off, tiny=True)

    __radd__, __rmul__ = __add__, __mul__

    def with_more(self, off: arb) -> Rounded:
        """Further off by so much."""
        return Rounded(self.exact, upper(self.off + off), self.format)


@dataclass(frozen=True)
class Beginning:
    """Where the motion starts, as balls."""

    zeta: Vector
    place_m: Vector
    heading_rad: arb


@dataclass(frozen=True)
class State:
    """Exact middles and radii: of ζ in the energy norm, of ∫ζ dt in the same norm, of the place in metres."""

    time_s: Fraction
    zeta: Vector
    travelled: Vector           # ∫ζ dt
    place_m: Vector
    zeta_radius: arb
    travelled_radius: arb
    place_radius: arb
    frame: Frame | None = None  # the same error of ζ in a box, where each direction is followed


@dataclass(frozen=True)
class Sample:
    """Balls that hold the true state at an instant."""

    time_s: Fraction
    zeta: Vector
    nu: Vector
    place_m: Vector
    heading_rad: arb
    wheel_angle_rad: Vector

    def row(self) -> Vector:
        """ν, place, heading, wheel angles in one list."""
        return [*self.nu, *self.place_m, self.heading_rad, *self.wheel_angle_rad]


@dataclass(frozen=True)
class Taken:
    """One step: its polynomials, and the radii that hold all along it."""

    begin: State
    step: Step
    travelled: list[arb_poly]
    place: list[arb_poly]
    zeta_radius: arb
    travelled_radius: arb
    place_radius: arb
    end: State


@dataclass(frozen=True)
class Radii:
    """Of ζ all along a step and at its end, of ∫ζ dt all along it."""

    zeta: arb
    zeta_at_end: arb
    travelled: arb
    pushed: arb     # what the step itself adds to the error of ζ at its end


def radii_of(state: State, step: Step, growth: Growth, defects: Defects, jump: arb, direction: arb, equation: Equation,
             forcing: Forcing) -> Radii:
    """How the radius of ζ grows over a step.

    A force fixed in the world lets an error η of the heading act on ζ: |e|' ≤ μ|e| + Bη + |defect|, η' ≤ k|e|. With
    c = √(B/k) the sum |e| + cη grows by at most e^(∫μ + h√(Bk)).
    """
    h, first = step.length_s, state.zeta_radius + jump
    turning = length([length([a, b]) for a, b in zip(forcing.cosine, forcing.sine, strict=True)])
    missed = defects.zeta + h * turning * direction
    yaw = length(equation.yaw_rate_of_zeta)
    heading = arb(0)
    if turning > 0 and yaw > 0:
        weight = upper((turning / yaw).sqrt())
        both = first + weight * yaw * state.travelled_radius + missed
        heading = upper(both * growth.at_most * (h * (turning * yaw).sqrt() * arb(1.0001)).exp() / weight)
    pushed = missed + h * turning * heading
    zeta = upper(growth.at_most * (first + pushed))
    return Radii(zeta, upper(growth.at_end * first + growth.at_most * pushed),
                 upper(state.travelled_radius + h * zeta), upper(growth.at_most * (pushed + jump)))
