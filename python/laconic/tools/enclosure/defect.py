"""How far a step's polynomials miss the equation, and how far the motion can be from them at its end: proved bounds.

With the error e of ζ in the energy norm, e' = J(t) e + (g·e)(e×w) + (b's change with the heading) − defect. The term
(g·e)(e×w) does no work: it is perpendicular to e. So |e|' ≤ μ |e| + …, with μ the largest eigenvalue of the symmetric
part of J along the polynomial alone, however stiff R is; and no enclosure of the motion is needed beforehand.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from flint import arb, arb_poly

from laconic.tools.enclosure.balls import Matrix, Vector, combined, cross, dot, largest, length
from laconic.tools.enclosure.equation import Equation, Forcing
from laconic.tools.enclosure.series import Series, cross_of

PIECES = 8  # of a step, for each of which the growth is bounded by itself


@dataclass(frozen=True)
class Step:
    """A step's polynomials in its own time from 0 to 1, exact, and its length in seconds as a ball."""

    length_s: arb
    zeta: list[arb_poly]
    cosine: arb_poly
    sine: arb_poly

    @classmethod
    def of(cls, series: Series, length_s: arb) -> Step:
        """The series over a length of time."""
        def scaled(part: Vector) -> arb_poly:
            found, power = [], arb(1)
            for x in part:
                found.append((x * power).mid())
                power = power * length_s
            return arb_poly(found)

        return cls(length_s, [scaled(part) for part in series.zeta], scaled(series.cosine), scaled(series.sine))


@dataclass(frozen=True)
class Defects:
    """Bounds over the step of what the polynomials miss, times its length: of ζ, and of (cos θ, sin θ)."""

    zeta: arb
    direction: arb


def defects_of(step: Step, equation: Equation, forcing: Forcing) -> Defects:
    """p' − h f(p), a polynomial whose coefficients are balls: it holds whatever the vehicle's balls hold."""
    spin, turn = combined(equation.spin, step.zeta), combined(equation.yaw_rate_of_zeta, step.zeta)
    crossed = cross_of(step.zeta, equation.gyro)
    missed = []
    for j in range(equation.freedoms):
        rate = spin * crossed[j] - combined(equation.damping[j], step.zeta)
        rate += step.cosine * forcing.cosine[j] + step.sine * forcing.sine[j] + forcing.constant[j]
        missed.append(largest(step.zeta[j].derivative() - rate * step.length_s))
    turned = [step.cosine.derivative() + turn * step.sine * step.length_s,
              step.sine.derivative() - turn * step.cosine * step.length_s]
    return Defects(length(missed), length([largest(each) for each in turned]))


@dataclass(frozen=True)
class Growth:
    """e^∫μ over a step, and the largest of it up to any instant within."""

    at_end: arb
    at_most: arb


def growth_of(step: Step, equation: Equation) -> Growth:
    """By pieces: μ at each middle, and what half a piece of the way can add."""
    speed = length([largest(part.derivative()) for part in step.zeta])
    slack = speed / (2 * PIECES) * length(equation.gyro) * length(equation.spin)
    whole = positive = arb(0)
    for piece in range(PIECES):
        middle = arb(2 * piece + 1) / (2 * PIECES)
        rate = upper_end(growth_rate(equation, [part(middle) for part in step.zeta]) + slack)
        whole += rate
        positive += rate if rate > 0 else arb(0)
    share = step.length_s / PIECES
    return Growth(upper_end((whole * share).exp()), upper_end((positive * share).exp()))


def upper_end(number: arb) -> arb:
    """The upper end, exact."""
    return arb(number.upper())


def growth_rate(equation: Equation, zeta: Vector) -> arb:
    """An upper bound of the largest eigenvalue of the symmetric part of (ζ×w)gᵀ − R (+ a turn, which adds nothing)."""
    arm, spin, size = cross(zeta, equation.gyro), equation.spin, equation.freedoms
    form = [[(arm[i] * spin[j] + arm[j] * spin[i] - equation.damping[i][j] - equation.damping[j][i]) / 2
             for j in range(size)] for i in range(size)]
    guess = float(np.linalg.eigvalsh([[float(x.mid()) for x in row] for row in form])[-1])
    margin = 1e-13 * sum(abs(float(x.mid())) for row in form for x in row) + 1e-200
    while True:
        bound = arb(guess + margin)
        if is_positive([[bound * (i == j) - form[i][j] for j in range(size)] for i in range(size)]):
            return bound
        margin *= 16.0


def is_positive(form: Matrix) -> bool:
    """Whether every symmetric matrix in the balls is proved positive definite: Cholesky's pivots are above 0."""
    size = len(form)
    lower: Matrix = []
    for i in range(size):
        row: Vector = []
        for j in range(i):
            row.append((form[i][j] - dot(row, lower[j][:j])) / lower[j][j])
        pivot = form[i][i] - dot(row, row)
        if not pivot > 0:
            return False
        lower.append([*row, pivot.sqrt()])
    return True
