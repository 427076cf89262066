"""Collocation at Gauss' points in 50 digits, written from docs/integrators.md: its increment, and its displacement."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from mpmath import mp, mpf

from laconic.tools.verify.exact.exact_model import ExactModel, Vector, added, cross, dot

SETTLED, MOST_ROUNDS = mpf(10) ** -38, 400
PARTS = 3  # of a stretch, in double precision
WHOLE = (mpf(1),)
POINTS = range(4)


def points() -> list[Any]:
    """Gauss' four points on 0 … 1, in their order."""
    inner, outer = (mp.sqrt(mpf(3) / 7 + sign * mpf(2) / 7 * mp.sqrt(mpf(6) / 5)) for sign in (-1, 1))
    return [(1 + x) / 2 for x in (-outer, -inner, inner, outer)]


def lagrange(at: list[Any], i: int) -> list[Any]:
    """Coefficients of 1, s, s², s³ of the polynomial that is 1 at point i and 0 at the others."""
    c = [mpf(1)]
    for k in POINTS:
        if k != i:
            c = [(up - at[k] * down) / (at[i] - at[k]) for up, down in zip([mpf(0), *c], [*c, mpf(0)], strict=True)]
    return c


def phi(k: int, a: Any) -> Any:
    """φk at −a; by its series where the recurrence would cancel."""
    return mp.hyp1f1(1, k + 1, -a) / mp.factorial(k)


@dataclass
class Weights:
    """Of one axis: of F at each point, in η at a place and in its integral up to there; with h."""

    to_point: list[list[Any]]
    mean_to_point: list[list[Any]]
    end: list[Any]
    mean: list[Any]


def weights_of(h: Any, a: Any) -> Weights:
    at = points()
    polynomials = [lagrange(at, i) for i in POINTS]

    def of(i: int, k: int, to: Any, phis: list[Any]) -> Any:
        return h * sum(c * mp.factorial(n) * phis[n + k] * to ** (n + k) for n, c in enumerate(polynomials[i]))

    table = [[phi(k, a * to) for k in range(6)] for to in (*at, mpf(1))]
    return Weights([[of(i, 1, at[j], table[j]) for j in POINTS] for i in POINTS],
                   [[of(i, 2, at[j], table[j]) for j in POINTS] for i in POINTS],
                   [of(i, 1, mpf(1), table[4]) for i in POINTS], [of(i, 2, mpf(1), table[4]) for i in POINTS])


def response(weights: list[list[Any]], rate: list[Vector]) -> Vector:
    """Σ weight · F; `weights`: of each axis, one of each point."""
    return [sum(weights[k][i] * rate[i][k] for i in POINTS) for k in range(3)]


def settled(now: list[Vector], before: list[Vector]) -> bool:
    """Whether a round changed nothing that counts."""
    changes = [abs(a - b) for z, old in zip(now, before, strict=True) for a, b in zip(z, old, strict=True)]
    return max(changes) <= SETTLED * max(abs(a) for z in now for a in z)


def panels_of(integrator: Any) -> list[Any]:
    """The share of a step that each panel has, by the core's integrator: stretches of 1, 1, 2, 4 …, each in three equal
    parts, and the rest of the step."""
    shares = [mpf(integrator.first_share) * 2 ** max(0, k - 1)
              for k in range(integrator.stretches) for _ in range(PARTS)]
    return [*shares, 1 - sum(shares)] if integrator.has_rest or not shares else shares


def gauss_8(m: ExactModel, h: Any, start: Vector, b: Callable[[Any], Vector],
            shares: Sequence[Any] = WHOLE) -> tuple[tuple[Vector, Vector, Vector], tuple[Any, Any, Any]]:
    """(increment, mean, slope) of ζ and (along, across, yaw) in axes at the heading in the middle."""
    at, undamped = points(), weights_of(mpf(1), mpf(0))
    delta, mean, moved, turned = [mpf(0)] * 3, [mpf(0)] * 3, mp.mpc(0), mpf(0)

    def yaw_of(path: Vector) -> Any:
        return dot(m.nu_of_zeta[2], path) / m.yaw_scale

    def velocity(z: Vector) -> Any:
        return m.radius * mp.mpc(dot(m.nu_of_zeta[0], z), dot(m.nu_of_zeta[1], z))

    for share in shares:
        length, z0 = share * h, added(start, 1, delta)
        axes = [weights_of(length, length * r) for r in m.decay]

        z, rate = [z0] * 4, [z0] * 4
        for _ in range(MOST_ROUNDS):
            before, rate = z, []
            for j in POINTS:
                yaw = turned + sum(length * undamped.to_point[i][j] * yaw_of(z[i]) for i in POINTS)
                twist, push = cross(z[j], m.gyro), b(yaw)
                rate.append([dot(m.nu_of_zeta[2], z[j]) * twist[k] + push[k] - m.decay[k] * z0[k] for k in range(3)])
            z = [added(z0, 1, response([[row[j] for row in w.to_point] for w in axes], rate)) for j in POINTS]
            if settled(z, before):
                break
        average = added(z0, 1, response([w.mean for w in axes], rate))
        yaw_change, shift, lacking = length * yaw_of(average), mp.mpc(0), length * velocity(average)
        for j in POINTS:
            if len(shares) == 1:
                yaw = sum(length * undamped.to_point[i][j] * yaw_of(z[i]) for i in POINTS)
            else:
                so_far = response([[row[j] for row in w.mean_to_point] for w in axes], rate)
                yaw = length * yaw_of(added(so_far, at[j], z0))
            part = length * undamped.end[j] * velocity(z[j])
            shift += part * mp.expj(yaw)
            lacking -= part
        moved += mp.expj(turned) * (shift + (lacking if len(shares) > 1 else 0))
        delta, mean = added(delta, 1, response([w.end for w in axes], rate)), added(mean, share, average)
        turned += yaw_change
    moved *= mp.expj(-turned / 2)
    return (delta, mean, delta), (moved.real, moved.imag, turned)
