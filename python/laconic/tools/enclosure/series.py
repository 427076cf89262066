"""Polynomials near the motion over one step: Taylor's, and those of the slow motion once fast damping has died away.

Nothing here need be right for the enclosure to hold: laconic.tools.enclosure.defect measures how far a polynomial
misses the equation. All numbers are exact midpoints; time counts from the step's start, in seconds.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb, arb_poly, ctx

from laconic.tools.enclosure.balls import Vector, cross, dot, larger, thin
from laconic.tools.enclosure.equation import Equation, Forcing

MOST_ITERATIONS = 60


@dataclass(frozen=True)
class Series:
    """Coefficients by power of time: ζ (three lists), cos θ and sin θ."""

    zeta: list[Vector]
    cosine: Vector
    sine: Vector

    def parts(self) -> list[Vector]:
        """All five lists."""
        return [*self.zeta, self.cosine, self.sine]


@dataclass(frozen=True)
class Start:
    """Where a step begins: midpoints."""

    zeta: Vector
    cosine: arb
    sine: arb


@dataclass(frozen=True)
class Rates:
    """Midpoints of the equation for one stretch of held inputs."""

    spin: Vector
    gyro: Vector
    decay: Vector       # diagonal of R
    yaw_rate: Vector
    forcing: Forcing

    @classmethod
    def of(cls, equation: Equation, forcing: Forcing) -> Rates:
        """The equation's, without what is off the diagonal of R."""
        return cls(thin(equation.spin), thin(equation.gyro), [equation.damping[j][j].mid() for j in range(3)],
                   thin(equation.yaw_rate_of_zeta),
                   Forcing(thin(forcing.constant), thin(forcing.cosine), thin(forcing.sine)))


def convolution(a: Sequence[arb], b: Sequence[arb]) -> arb:
    """The coefficient of the product of two series at the last power that both have."""
    return dot(a, b[::-1])


def taylor(rates: Rates, start: Start, order: int) -> Series:
    """Taylor's polynomial by the recurrence of the equation's quadratic terms."""
    zeta: list[Vector] = [[x] for x in start.zeta]
    cosine, sine, spins, turns = [start.cosine], [start.sine], [], []
    crossed: list[Vector] = [[], [], []]
    for k in range(order):
        at = [x[k] for x in zeta]
        spins.append(dot(rates.spin, at))
        turns.append(dot(rates.yaw_rate, at))
        for j, value in enumerate(cross(at, rates.gyro)):
            crossed[j].append(value)
        share = arb(1) / (k + 1)
        for j in range(3):
            rate = convolution(spins, crossed[j]) - rates.decay[j] * at[j] + forcing_at(rates, j, k, cosine, sine)
            zeta[j].append((rate * share).mid())
        fall, rise = convolution(turns, sine), convolution(turns, cosine)
        cosine.append((-fall * share).mid())
        sine.append((rise * share).mid())
    return Series(zeta, cosine, sine)


def forcing_at(rates: Rates, j: int, k: int, cosine: Vector, sine: Vector) -> arb:
    """Coefficient k of component j of b."""
    turning = rates.forcing.cosine[j] * cosine[k] + rates.forcing.sine[j] * sine[k]
    return turning + rates.forcing.constant[j] if k == 0 else turning


def slow_motion(rates: Rates, start: Start, order: int, fast: frozenset[int], unit_s: arb,
                scale: arb) -> Series | None:
    """The series in which the components `fast` follow the others without a decaying part of their own; None where the
    iteration does not settle. Their start is what comes out, not what `start` gives.

    A fast component solves z_k = (source_k − (k+1) z_{k+1})/r from the highest power down, the others and the heading
    go up from their start; the sources are of the last pass. `unit_s` scales time while this is done; `scale` is the
    size of ζ to whose rounding the passes must settle.
    """
    now = [[x] + [arb(0)] * order for x in (*start.zeta, start.cosine, start.sine)]
    settled = arb(2) ** (12 - ctx.prec)
    for _ in range(MOST_ITERATIONS):
        before, now = now, one_pass(rates, start, now, fast, unit_s)
        if not all(x.is_finite() for part in now for x in part):
            return None
        if (differs_by(before[:3], now[:3]) <= settled * larger(scale, largest_of(now[:3]))
                and differs_by(before[3:], now[3:]) <= settled * larger(arb(1), largest_of(now[3:]))):
            return Series([unscaled(part, unit_s) for part in now[:3]], *(unscaled(part, unit_s) for part in now[3:]))
    return None


def differs_by(before: list[Vector], now: list[Vector]) -> arb:
    """The largest change of a coefficient."""
    return largest_of([[a - b for a, b in zip(old, new, strict=True)] for old, new in zip(before, now, strict=True)])


def largest_of(parts: list[Vector]) -> arb:
    """The largest size of a coefficient, roughly."""
    return max((abs(x).mid() for part in parts for x in part), key=log2_of)


def unscaled(part: Vector, unit_s: arb) -> Vector:
    """Coefficients by powers of seconds, from those by powers of the unit."""
    found, scale = [], arb(1)
    for x in part:
        found.append((x / scale).mid())
        scale = scale * unit_s
    return found


def one_pass(rates: Rates, start: Start, now: list[Vector], fast: frozenset[int], unit_s: arb) -> list[Vector]:
    """Every component once, with the products of the last pass; time in units."""
    order = len(now[0]) - 1
    polynomials = [arb_poly(part) for part in now]
    zeta, cosine, sine = polynomials[:3], polynomials[3], polynomials[4]
    spin, turn = sum_of(rates.spin, zeta), sum_of(rates.yaw_rate, zeta)
    crossed = cross_of(zeta, rates.gyro)
    found = []
    for j in range(3):
        b = rates.forcing
        source = coefficients(spin * crossed[j] + cosine * b.cosine[j] + sine * b.sine[j] + b.constant[j], order)
        decay = rates.decay[j]
        found.append(downwards(source, decay, unit_s) if j in fast else upwards(source, decay, start.zeta[j], unit_s))
    fall, rise = coefficients(turn * sine * -1, order), coefficients(turn * cosine, order)
    return [*found, upwards(fall, arb(0), start.cosine, unit_s), upwards(rise, arb(0), start.sine, unit_s)]


def sum_of(factors: Vector, polynomials: Sequence[arb_poly]) -> arb_poly:
    return polynomials[0] * factors[0] + polynomials[1] * factors[1] + polynomials[2] * factors[2]


def cross_of(zeta: Sequence[arb_poly], gyro: Vector) -> list[arb_poly]:
    """ζ × w of polynomials."""
    return [zeta[1] * gyro[2] - zeta[2] * gyro[1], zeta[2] * gyro[0] - zeta[0] * gyro[2],
            zeta[0] * gyro[1] - zeta[1] * gyro[0]]


def coefficients(polynomial: arb_poly, order: int) -> Vector:
    """The coefficients up to a power, 0 beyond the polynomial's own."""
    found = [x.mid() for x in polynomial.coeffs()[:order + 1]]
    return found + [arb(0)] * (order + 1 - len(found))


def upwards(source: Vector, decay: arb, first: arb, unit_s: arb) -> Vector:
    """z' = source − r z from its start."""
    found = [first]
    for k in range(len(source) - 1):
        found.append(((source[k] - decay * found[k]) * unit_s / (k + 1)).mid())
    return found


def downwards(source: Vector, decay: arb, unit_s: arb) -> Vector:
    """The solution of z' = source − r z that has no part e^{−rt}."""
    found = [(source[-1] / decay).mid()]
    for k in range(len(source) - 2, -1, -1):
        found.append(((source[k] - found[-1] * (k + 1) / unit_s) / decay).mid())
    return found[::-1]


def serves(series: Series, unit_s: float, bound_s: float) -> float:
    """The time that a slow motion may be asked for: one unit where its passes have settled before they came to the last
    powers, of which each finds one more. Then the last terms are 0 and tell nothing."""
    found = (all(x == 0 for x in part[2:]) or any(x != 0 for x in part[-2:]) for part in series.parts())
    return bound_s if all(found) else min(unit_s, bound_s)


def step_for(series: Series, scale: arb, tolerance: arb, bound_s: float) -> float:
    """The time over which the last two terms stay below the tolerance, at most `bound_s`."""
    order = len(series.cosine) - 1
    found = bound_s
    for size, parts in ((scale, series.zeta), (arb(1), [series.cosine, series.sine])):
        limit = log2_of(size * tolerance)
        for power in (order - 1, order):
            largest = max((log2_of(part[power]) for part in parts), default=-math.inf)
            if largest > -math.inf:
                found = min(found, 2.0 ** min(1000.0, (limit - largest) / power))
    return 0.9 * found if found < bound_s else bound_s


def log2_of(number: arb) -> float:
    """About log2 |number|, for numbers of any size; −inf for 0."""
    mantissa, exponent = abs(number).mid().man_exp()
    return int(mantissa).bit_length() + int(exponent) if mantissa else -math.inf
