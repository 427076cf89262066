"""Collocation at Chebyshev's points on 0 … 1: how values there give the derivative and the integral, in 50 digits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

from flint import arb, arb_mat

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
