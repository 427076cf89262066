"""The operations of a Runge-Kutta step with its inputs held, in the core's order, for any kind of number.

With numpy's float32 it has the core's bits (a test compares them); with laconic.tools.enclosure.state it tells how
far rounding can bring them from exact arithmetic.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

Numbers = list[Any]

SINE = (-0.16666654940256574587, 0.0083321779190321380808, -0.00019517267132177431398)
COSINE = (0.041666646860773310301, -0.0013887367223119975287, 0.000024438416549882651326)
SINC = (-0.16666664580678050564, 0.0083290180090501000745)
J1 = (0.33333329701864815124, -0.033314737524190506486)
SINE_ERROR, COSINE_ERROR, SINC_ERROR, J1_ERROR = 4e-9, 1e-10, 3e-11, 4e-8  # of the polynomials, as polynomials.h has


@dataclass(frozen=True)
class Constants:
    """What a step reads of model and integrator, as the kind of number that it is taken with."""

    step_s: Any
    spin: Numbers
    gyro: Numbers
    decay: Numbers
    along: Numbers
    across: Numbers
    yaw: Numbers
    of: Any  # makes a constant of the text such a number


@dataclass(frozen=True)
class Step:
    """What a step adds: to ζ, to ∫ζ dt, along and across the heading in its middle, to the heading."""

    delta: Numbers
    path: Numbers
    forth: Any
    left: Any
    yaw: Any


def dot(a: Numbers, b: Numbers) -> Any:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Numbers, b: Numbers) -> Numbers:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def scaled(factor: Any, v: Numbers) -> Numbers:
    return [factor * x for x in v]


def plus(a: Numbers, b: Numbers) -> Numbers:
    return [x + y for x, y in zip(a, b, strict=True)]


def rate(k: Constants, z: Numbers, b: Numbers) -> Numbers:
    """zeta_rate of step_internals.h"""
    gyroscopic = scaled(dot(k.spin, z), cross(z, k.gyro))
    return [q - r * x + f for q, r, x, f in zip(gyroscopic, k.decay, z, b, strict=True)]


def rk4_step(k: Constants, z: Numbers, b: Numbers) -> Step:
    """held_stages, simpson and displacement."""
    h, half = k.step_s, k.of(0.5) * k.step_s
    k1 = rate(k, z, b)
    k2 = rate(k, plus(z, scaled(half, k1)), b)
    k3 = rate(k, plus(z, scaled(half, k2)), b)
    k4 = rate(k, plus(z, scaled(h, k3)), b)
    sixth = h * k.of(1.0 / 6.0)
    inner = plus(k2, k3)
    forth = scaled(sixth, plus(k1, inner))
    mean = plus(z, forth)
    delta = plus(forth, scaled(sixth, plus(inner, k4)))
    return displaced(k, delta, scaled(h, mean), scaled(h, delta))


def displaced(k: Constants, delta: Numbers, path: Numbers, bend: Numbers) -> Step:
    """displacement of step_internals.h, for a yaw below a quarter of a radian."""
    yaw, yaw_bend = dot(k.yaw, path), dot(k.yaw, bend) * k.of(1.0 / 12.0)
    forth, left = dot(k.along, path), dot(k.across, path)
    alpha = k.of(0.5) * yaw
    square = alpha * alpha
    sinc = k.of(1.0) + square * horner(k, SINC, square)
    half_j1 = k.of(0.5) * alpha * horner(k, J1, square)
    aside_forth = half_j1 * dot(k.along, bend) - yaw_bend * forth
    aside_left = half_j1 * dot(k.across, bend) - yaw_bend * left
    return Step(delta, path, sinc * forth - aside_left, sinc * left + aside_forth, yaw)


def horner(k: Constants, coefficients: Sequence[float], x: Any) -> Any:
    """c0 + x (c1 + x (c2 …))"""
    found = k.of(coefficients[-1])
    for each in reversed(coefficients[:-1]):
        found = k.of(each) + x * found
    return found


def direction(k: Constants, x: Any) -> tuple[Any, Any]:
    """Sine and cosine of an angle of at most π/4."""
    z = x * x
    return (x + x * z * horner(k, SINE, z), k.of(1.0) - z * k.of(0.5) + z * z * horner(k, COSINE, z))
