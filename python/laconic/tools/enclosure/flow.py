"""How a step carries errors in each direction: for motions whose neighbours part slowly while some norm grows fast.

Free motion turns ζ for ever and errors grow in proportion to time, but at each instant some direction grows by e^(qt).
So an error is also kept in a box along axes of its own, e = C r with |r_i| at most reach_i. A step takes it to Φ C r,
Φ the derivative of the flow; the new axes are an orthonormal basis of Φ C, the longest edge first (Lohner), so that a
box that is turned and sheared needs no much larger box.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from flint import arb, arb_mat, arb_poly

from laconic.tools.enclosure.balls import (
    Matrix,
    Vector,
    combined,
    dot,
    larger,
    largest,
    length,
    precision,
    times,
    upper,
)
from laconic.tools.enclosure.defect import Growth, Step
from laconic.tools.enclosure.equation import Equation
from laconic.tools.enclosure.series import cross_of

ORDER = 24          # of the polynomials for Φ: errors of errors may be coarse
BITS = 80
USEFUL = 1e-4       # the largest error of Φ with which the axes are of use


@dataclass(frozen=True)
class Frame:
    """A box that holds the error of ζ: exact axes as columns, and how far it reaches along each."""

    axes: Matrix
    reach: Vector

    @classmethod
    def around(cls, radius: arb, size: int) -> Frame:
        """The box around a ball."""
        return cls([[arb(i == j) for j in range(size)] for i in range(size)], [radius] * size)

    def radius(self) -> arb:
        """An upper bound of the length of what the box holds."""
        columns = [list(column) for column in zip(*self.axes, strict=True)]
        rows = [sum((upper(dot(a, b)) for b in columns), arb(0)) for a in columns]  # of CᵀC, whose norm they bound
        most = rows[0]
        for row in rows[1:]:
            most = larger(most, row)
        return upper(length(self.reach) * most.sqrt())


@dataclass(frozen=True)
class Flow:
    """Φ over a step, and a bound of its error in the norm of matrices."""

    matrix: Matrix
    error: arb


def flow_of(step: Step, equation: Equation, growth: Growth) -> Flow:
    """Φ' = J Φ by a polynomial in doubles, its defect in balls."""
    guess, size = variation(step, equation), equation.freedoms
    with precision(BITS):
        spin, crossed = combined(equation.spin, step.zeta), cross_of(step.zeta, equation.gyro)
        missed, matrix = [], [[arb(0)] * size for _ in range(size)]
        for column in range(size):
            part = [arb_poly([arb(float(x)) for x in guess[:, j, column]]) for j in range(3)]
            of_spin, of_cross = combined(equation.spin, part), cross_of(part, equation.gyro)
            for j in range(size):
                rate = of_spin * crossed[j] + spin * of_cross[j] - combined(equation.damping[j], part)
                missed.append(largest(part[j].derivative() - rate * step.length_s))
                matrix[j][column] = part[j](arb(1))
        return Flow(matrix, upper(growth.at_most * length(missed)))


def variation(step: Step, equation: Equation) -> np.ndarray:
    """Coefficients (power, component, column) of Φ in the step's own time, in doubles."""
    zeta = np.zeros((ORDER + 1, 3))
    for j, part in enumerate(step.zeta):
        found = [float(x) for x in part.coeffs()[:ORDER + 1]]
        zeta[:len(found), j] = found
    spin, gyro = (np.array([float(x) for x in v]) for v in (equation.spin, equation.gyro))
    decay = np.array([float(equation.damping[j][j].mid()) for j in range(3)])
    crossed, spins, h = np.cross(zeta, gyro), zeta @ spin, float(step.length_s)
    powers = np.zeros((ORDER + 1, 3, equation.freedoms))
    powers[0] = np.eye(3)[:, :equation.freedoms]
    turned, spun = np.zeros_like(powers), np.zeros((ORDER + 1, equation.freedoms))
    for k in range(ORDER):
        turned[k], spun[k] = np.cross(powers[k], gyro, axisa=0, axisc=0), spin @ powers[k]
        rate = np.einsum("ij,ic->jc", crossed[k::-1], spun[:k + 1]) - decay[:, None] * powers[k]
        powers[k + 1] = h * (rate + np.einsum("i,ijc->jc", spins[k::-1], turned[:k + 1])) / (k + 1)
    return powers


def carried(frame: Frame, flow: Flow, radius: arb, added: arb) -> Frame | None:
    """The box after a step: `radius` bounds the error before it, `added` what the step adds to what Φ does; None where
    Φ is too coarse to be of use."""
    if not flow.error < USEFUL:
        return None
    size = len(frame.reach)
    moved = [times(flow.matrix, [frame.axes[i][j] for i in range(size)]) for j in range(size)]
    largest_reach = max(float(x.log().mid()) for x in frame.reach)
    edges = np.array([[float(x) * np.exp(float(reach.log().mid()) - largest_reach) for x in column]
                      for column, reach in zip(moved, frame.reach, strict=True)])
    edges = edges[np.argsort(-np.linalg.norm(edges, axis=1))]
    if not np.all(np.isfinite(edges)):
        return None
    axes, _ = np.linalg.qr(edges.T + 1e-300)
    new = [[arb(float(x)) for x in row] for row in axes]
    back = arb_mat(new).inv().tolist()
    rest = flow.error * radius + added
    reach = [upper(sum((upper(dot(row, column)) * r for column, r in zip(moved, frame.reach, strict=True)), arb(0))
                   + length(row) * rest) for row in back]
    return Frame(new, reach)
