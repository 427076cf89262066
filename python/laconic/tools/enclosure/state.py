"""What a motion is at an instant, and over a step: exact middles with radii, and the balls that users see."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from flint import arb, arb_poly

from laconic.tools.enclosure.balls import Vector
from laconic.tools.enclosure.defect import Step
from laconic.tools.enclosure.flow import Frame


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
