"""How the radius of ζ grows over a step."""

from __future__ import annotations

from dataclasses import dataclass

from flint import arb

from laconic.tools.enclosure.balls import length, upper
from laconic.tools.enclosure.defect import Defects, Growth, Step
from laconic.tools.enclosure.equation import Equation, Forcing
from laconic.tools.enclosure.state import State


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
