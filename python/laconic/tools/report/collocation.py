"""The true motion of (4.7) in 50 digits, however stiff: collocation of high degree on panels that grow with the time
since the inputs changed.

It shares the exact constants with references.derivatives, and nothing with the core's methods or with the
enclosures. Damping that is fast beside a panel is solved with the polynomial; all else is iterated.

Collocation at Chebyshev's points on 0 … 1: how values there give the derivative and the integral, in 50 digits.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from itertools import pairwise
from typing import Any

from flint import arb, arb_mat, ctx
from mpmath import mp, mpf

from laconic.errors import ResultFails
from laconic.tools.enclosure.balls import Vector, added, ball, dot
from laconic.tools.verify.exact.exact_model import ExactModel, exact_model, numbers_of
from laconic.tools.verify.exact.exact_steps import forcing_of

POINTS = 28
BITS = 220  # 50 digits, and what the matrices take


@dataclass(frozen=True)
class Nodes:
    """Matrices over the points after the first, which is 0; the last is 1."""

    derivative: arb_mat   # of the polynomial through all points, at these, by the values at these
    from_start: arb_mat   # the same by the value at 0
    integral: arb_mat     # from 0 to each


@lru_cache(maxsize=1)
def nodes() -> Nodes:
    """By the barycentric weights of Chebyshev's extreme points."""
    at = [(1 - arb.cos_pi(arb(k) / POINTS)) / 2 for k in range(POINTS + 1)]
    weights = [arb((-1) ** k) / (2 if k in (0, POINTS) else 1) for k in range(POINTS + 1)]

    def row(i: int) -> list[arb]:
        others = [weights[j] / weights[i] / (at[i] - at[j]) if j != i else arb(0) for j in range(POINTS + 1)]
        others[i] = -sum(others, arb(0))
        return others

    rows = [row(i) for i in range(1, POINTS + 1)]
    derivative = arb_mat([each[1:] for each in rows]).mid()
    return Nodes(derivative, arb_mat([[each[0]] for each in rows]).mid(), derivative.inv().mid())


def damped(decay: arb) -> tuple[arb_mat, arb_mat]:
    """What solves x' = f − decay·x: the matrix that takes f at the points to x there, and what the start adds."""
    table = nodes()
    identity = arb_mat(POINTS, POINTS, [decay if i == j else 0 for i in range(POINTS) for j in range(POINTS)])
    response = (table.derivative + identity).inv().mid()
    return response, (response * table.from_start * -1).mid()


def last_coefficient(values: Sequence[arb]) -> arb:
    """The size of the highest of Chebyshev's coefficients of the polynomial with these values at all points."""
    ends = (values[0] + values[-1] * (-1) ** POINTS) / 2
    return abs(sum((x if k % 2 else -x for k, x in enumerate(values[1:-1])), ends)) / POINTS


def column(numbers: Sequence[arb]) -> arb_mat:
    return arb_mat(len(numbers), 1, list(numbers))


Held = Mapping[str, Sequence[float]]

DIGITS = 60              # with which numbers pass from mpmath
FIRST = 2.0              # of the fastest damping's time, the first panel after a change of inputs
GROWTH = 0.5             # of the time since then, each further one
LONGEST_S = 1e4
MOST_PANELS = 20_000
FAST = 0.5               # decay times panel, from which on damping is solved
ROUNDS = 60
SETTLED = arb(2) ** -150  # of the largest number, between two rounds
RESOLVED = 1e-26         # of the largest number, the last coefficient of a panel's polynomials
HOPELESS = 1e6           # of the largest number: an iteration that moves so far does not settle
SHORTEST_S = 1e-15


def exact(number: object) -> arb:
    """A number of mpmath."""
    return arb(mp.nstr(number, DIGITS)).mid()


@dataclass(frozen=True)
class Constants:
    """A model's numbers, and b = constant + cos θ · cosine + sin θ · sine."""

    spin: Vector
    gyro: Vector
    decay: Vector
    yaw: Vector
    along: Vector
    across: Vector
    forcing: tuple[Vector, Vector, Vector]

    @classmethod
    def of(cls, model: ExactModel, held: Held) -> Constants:
        """With the inputs held."""
        given = {name: [mpf(x) for x in values] for name, values in held.items()}
        b = forcing_of(model, given, mpf(0))
        ahead, aside, back = ([exact(x) for x in b(angle)] for angle in (mpf(0), mp.pi / 2, mp.pi))
        constant = [(p + q) / 2 for p, q in zip(ahead, back, strict=True)]
        forcing = (constant, added(ahead, arb(-1), constant), added(aside, arb(-1), constant))
        radius, rows = exact(model.radius), [[exact(x) for x in row] for row in model.nu_of_zeta]
        return cls(rows[2], [exact(x) for x in model.gyro], [exact(x) for x in model.decay],
                   [x / exact(model.yaw_scale) for x in rows[2]], [x * radius for x in rows[0]],
                   [x * radius for x in rows[1]], forcing)


@dataclass(frozen=True)
class Motion:
    """A state: ζ, ∫ζ dt, heading, place."""

    zeta: Vector
    travelled: Vector
    heading: arb
    place: Vector


def rate_at(k: Constants, z: Vector, heading: arb, is_turning: bool) -> Vector:
    """(g·ζ)(ζ×w) + b"""
    s, (x, y, w) = dot(k.spin, z), z
    g = k.gyro
    rate = [s * (y * g[2] - w * g[1]), s * (w * g[0] - x * g[2]), s * (x * g[1] - y * g[0])]
    constant, by_cosine, by_sine = k.forcing
    if not is_turning:
        return [p + q for p, q in zip(rate, constant, strict=True)]
    sine, cosine = heading.sin_cos()
    return [p + q + cosine * c + sine * d for p, q, c, d in zip(rate, constant, by_cosine, by_sine, strict=True)]


def panel(k: Constants, start: Motion, h: arb) -> Motion | None:
    """The motion after so long; None where the iteration does not settle, or the polynomials do not resolve it."""
    table = nodes()
    axes = [damped(h * r) if r * h > FAST else None for r in k.decay]
    is_turning = any(x != 0 for each in k.forcing[1:] for x in each)
    z = [[x] * POINTS for x in start.zeta]
    headings = [start.heading] * POINTS
    for _ in range(ROUNDS):
        rates = [rate_at(k, list(each), heading, is_turning)
                 for each, heading in zip(zip(*z, strict=True), headings, strict=True)]
        fresh = [axis_of(table.integral, axis, h, start.zeta[j], [rate[j] for rate in rates], k.decay[j], z[j])
                 for j, axis in enumerate(axes)]
        headings = headings_of(k, start, h, fresh)
        moved = max(float(abs(p - q)) for new, old in zip(fresh, z, strict=True) for p, q in zip(new, old, strict=True))
        z = fresh
        largest = max(1.0, *(float(abs(x)) for each in z for x in each))
        if not (all(x.is_finite() for each in z for x in each) and moved < HOPELESS * largest):
            return None
        if moved <= float(SETTLED) * largest:
            is_resolved = all(float(last_coefficient(each)) <= RESOLVED * largest for each in
                              ([x, *rest] for x, rest in zip(start.zeta, z, strict=True)))
            return end_of(k, start, h, z, headings) if is_resolved else None
    return None


def axis_of(integral: arb_mat, axis: tuple[arb_mat, arb_mat] | None, h: arb, start: arb, rate: Vector, decay: arb,
            z: Vector) -> Vector:
    """One component of ζ at the points."""
    if axis is None:
        slow = column([f - decay * x for f, x in zip(rate, z, strict=True)])
        return [start + h * x.mid() for x in (integral * slow).entries()]
    response, from_start = axis
    found = response * (column(rate) * h) + from_start * start
    return list(found.mid().entries())


def headings_of(k: Constants, start: Motion, h: arb, z: list[Vector]) -> Vector:
    turn = column([dot(k.yaw, each) for each in zip(*z, strict=True)])
    return [start.heading + h * x for x in (nodes().integral * turn).mid().entries()]


def end_of(k: Constants, start: Motion, h: arb, z: list[Vector], headings: Vector) -> Motion:
    """At the last point."""
    total = nodes().integral.tolist()[-1]
    velocity = []
    for each, heading in zip(zip(*z, strict=True), headings, strict=True):
        sine, cosine = heading.sin_cos()
        along, across = dot(k.along, each), dot(k.across, each)
        velocity.append((along * cosine - across * sine, along * sine + across * cosine))
    place = [(x + h * dot(total, each)).mid()
             for x, each in zip(start.place, zip(*velocity, strict=True), strict=True)]
    travelled = [(x + h * dot(total, each)).mid() for x, each in zip(start.travelled, z, strict=True)]
    return Motion([each[-1].mid() for each in z], travelled, headings[-1].mid(), place)


def onward(k: Constants, start: Motion, begin_s: Fraction, end_s: Fraction) -> Motion:
    """From one time to another, both since the inputs changed: panels grow from the time of the fastest decay."""
    fastest, now, state, most, panels = max(float(x) for x in k.decay), begin_s, start, LONGEST_S, 0
    while now < end_s:
        panels += 1
        h = min(most, max(FIRST / fastest if fastest > 0 else LONGEST_S, GROWTH * float(now)))
        length = min(Fraction(h), end_s - now)
        found = panel(k, state, ball(length).mid())
        if found is None:
            most = float(length) / 2
            if most < SHORTEST_S or panels > MOST_PANELS:
                raise ResultFails(f"the collocation does not settle in panels of {h:g} s")
            continue
        state, now, most = found, now + length, min(LONGEST_S, 2 * most)
    return state


def exact_start(table: Mapping[str, Any], nu: Sequence[float]) -> tuple[ExactModel, Vector]:
    """A vehicle's model, and ν at the start: doubles meet the constraints to rounding alone, this to all digits."""
    with mp.workdps(DIGITS), ctx.workprec(BITS):
        model = exact_model(numbers_of(table))
        return model, [exact(x) for x in model.nu(model.zeta([mpf(float(x)) for x in nu]))]


def true_states(model: ExactModel, start_nu: Sequence[arb], heading_rad: float, helds: Sequence[Held],
                cuts_s: Sequence[Sequence[Fraction]]) -> list[Vector]:
    """(ν, x, y, θ, χ) at instants. `helds`: the inputs of each stretch; `cuts_s`: for each stretch its instants,
    ascending; it begins where the last one ended, the first at 0."""
    with mp.workdps(DIGITS), ctx.workprec(BITS):
        rows = [[exact(x) for x in row] for row in model.nu_of_zeta]
        wheels = [[exact(x) for x in row] for row in model.wheel_rows]
        zeta = [dot([exact(x) for x in row], start_nu).mid() for row in model.zeta_of_nu]
        state, begin = Motion(zeta, [arb(0)] * 3, arb(heading_rad), [arb(0)] * 2), Fraction(0)
        found = []
        for held, cuts in zip(helds, cuts_s, strict=True):
            constants = Constants.of(model, held)
            for a, b in pairwise([begin, *cuts]):
                state = onward(constants, state, a - begin, b - begin)
                found.append([*(dot(row, state.zeta) for row in rows), *state.place, state.heading,
                              *(dot(row, state.travelled) for row in wheels)])
            begin = cuts[-1]
        return found
