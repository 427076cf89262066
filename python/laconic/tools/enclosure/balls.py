"""Numbers as balls [m ± r] of Arb, through which every operation rounds outwards: exact input, vectors, upper bounds.

The room's other modules take precision as it is set here: `precision(bits)` around the work.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from decimal import Decimal
from fractions import Fraction
from operator import mul

from flint import arb, arb_poly, ctx, fmpq

Vector = list[arb]
Matrix = list[Vector]
Number = int | float | Decimal | Fraction


@contextmanager
def precision(bits: int) -> Iterator[None]:
    """Midpoints have so many bits inside."""
    with ctx.workprec(bits):
        yield


def ball(number: Number) -> arb:
    """A number as it is: a decimal or a fraction as the ball around it, a float exactly."""
    if isinstance(number, float):
        return arb(number)
    exact = Fraction(number)
    return arb(fmpq(exact.numerator, exact.denominator))


def dot(a: Sequence[arb], b: Sequence[arb]) -> arb:
    return sum(map(mul, a, b), arb(0))


def cross(a: Vector, b: Vector) -> Vector:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def added(a: Vector, factor: arb, b: Vector) -> Vector:
    return [x + factor * y for x, y in zip(a, b, strict=True)]


def combined(factors: Sequence[arb], polynomials: Sequence[arb_poly]) -> arb_poly:
    """Σ factor · polynomial."""
    return sum((p * factor for factor, p in zip(factors, polynomials, strict=True)), arb_poly([0]))


def combined_vectors(factors: Sequence[arb], rows: Sequence[Vector]) -> Vector:
    """Σ factor · row, of vectors."""
    return [dot(factors, column) for column in zip(*rows, strict=True)]


def times(matrix: Matrix, vector: Vector) -> Vector:
    return [dot(row, vector) for row in matrix]


def transposed(matrix: Sequence[Vector]) -> Matrix:
    return [list(column) for column in zip(*matrix, strict=True)]


def upper(number: arb) -> arb:
    """The largest size of what the ball holds, as an exact number."""
    return arb(number.abs_upper())


def length(vector: Sequence[arb]) -> arb:
    """An upper bound of the Euclidean length."""
    return upper(sum((upper(x) ** 2 for x in vector), arb(0)).sqrt())


def largest(polynomial: arb_poly) -> arb:
    """An upper bound of a polynomial's size on [0, 1]: the sum of its coefficients' sizes."""
    return upper(sum((upper(c) for c in polynomial.coeffs()), arb(0)))


def widened(number: arb, radius: arb) -> arb:
    """The ball with a radius added."""
    return number + arb(0, radius)


def thin(numbers: Sequence[arb]) -> Vector:
    """The midpoints, exact."""
    return [number.mid() for number in numbers]


def radius_of(numbers: Sequence[arb]) -> arb:
    """An upper bound of the distance between the midpoints and what the balls hold."""
    return length([number.rad() for number in numbers])


def smaller(a: arb, b: arb) -> arb:
    """The smaller of two exact numbers."""
    return a if a < b else b


def larger(a: arb, b: arb) -> arb:
    """The larger of two exact numbers."""
    return a if a > b else b
