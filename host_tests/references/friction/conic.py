"""One friction step as a second-order cone program for Clarabel, an interior-point solver.

The unknowns are scaled by the root of their masses and by the size of the free motion, so that the quadratic form of
the free problem is the unit matrix. |slip| is a cone; the motor's clamp is a Huber term, ½ a (s − s0 − y)² + L |y|.
"""

from __future__ import annotations

from dataclasses import dataclass

import clarabel
import numpy as np
from scipy import sparse

from references.friction.problem import StepProblem


@dataclass(frozen=True)
class ConicSolution:
    """An approximate solution, to some 9 digits of the scale."""

    z: np.ndarray          # (ν, s)
    slip_impulse: np.ndarray  # N × 2: p, along the slip; the ground's force is −p
    axle_impulse: np.ndarray  # N: along the wheel's speed


class _Program:
    """Rows of a cone program, gathered cone by cone: min ½ xᵀPx + qᵀx, b − A x in the cones."""

    def __init__(self, size: int):
        self.quadratic, self.linear = np.zeros((size, size)), np.zeros(size)
        self.rows: list[np.ndarray] = []
        self.cones: list[object] = []
        self.size, self.height = size, 0

    def unknown(self, cost: float) -> int:
        """One unknown more, with its price."""
        self.quadratic = np.pad(self.quadratic, (0, 1))
        self.linear = np.append(self.linear, cost)
        self.size += 1
        return self.size - 1

    def cone(self, rows: list[dict[int, float]], kind: type) -> int:
        """The rows shall lie in the cone; gives the place of the first one's dual."""
        for row in rows:
            dense = np.zeros(self.size)
            dense[list(row)] = list(row.values())
            self.rows.append(dense)
        self.cones.append(kind(len(rows)))
        self.height += len(rows)
        return self.height - len(rows)

    def solve(self) -> tuple[np.ndarray, np.ndarray]:
        """(x, duals of the rows)."""
        matrix = np.zeros((self.height, self.size))
        for number, row in enumerate(self.rows):
            matrix[number, :len(row)] = -row
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-13
        solver = clarabel.DefaultSolver(
            sparse.csc_matrix(np.triu(self.quadratic)), self.linear, sparse.csc_matrix(matrix),
            np.zeros(self.height), self.cones, settings)
        solution = solver.solve()
        return np.array(solution.x), np.array(solution.z)


def scale_of(problem: StepProblem) -> float:
    """The size of the free motion in the energy norm, motors held at the free speed; 1 for a motion of nothing."""
    free = np.concatenate([problem.free_nu, problem.free_speed])
    mass = problem.masses() + np.concatenate([np.zeros(3), problem.viscous + problem.drive_slope])
    impulse = problem.masses() * free
    impulse[3:] += np.where(np.isfinite(problem.drive_limit),
                            np.clip(problem.drive, -problem.drive_limit, problem.drive_limit), problem.drive)
    size = float(np.sqrt(np.sum(impulse**2 / mass)))
    return size if size > 0.0 else 1.0


def solve_conic(problem: StepProblem) -> ConicSolution:
    """Clarabel's solution, whatever accuracy it reached; the polish judges it."""
    count, scale, mass = problem.wheels, scale_of(problem), problem.masses()
    unit = scale / np.sqrt(mass)     # z = unit · x; energies are divided by scale²
    program = _Program(3 + count)
    free = np.concatenate([problem.free_nu, problem.free_speed])
    program.quadratic[:] = np.eye(3 + count)
    program.linear[:] = -free / unit
    for i in range(count):
        _add_motor(program, problem, i, unit[3 + i], scale)
    contact_at = [_add_contact(program, rows * unit / scale, grip / scale)
                  for rows, grip in zip(problem.slip_rows(), problem.grip, strict=True)]
    axle_at = [_add_axle(program, 3 + i, axle * unit[3 + i] / scale**2) for i, axle in enumerate(problem.axle)]
    x, dual = program.solve()
    impulse, axle = np.zeros((count, 2)), np.zeros(count)
    for i, (first, places) in enumerate(contact_at):
        impulse[i, places] = -dual[first:first + len(places)] * scale
    for i, place in enumerate(axle_at):
        axle[i] = -dual[place] * scale**2 / unit[3 + i] if place is not None else 0.0
    return ConicSolution(x[:3 + count] * unit, impulse, axle)


def _add_motor(program: _Program, problem: StepProblem, i: int, unit: float, scale: float) -> None:
    slope, limit, drive = problem.drive_slope[i], problem.drive_limit[i], problem.drive[i]
    place = 3 + i
    program.quadratic[place, place] += problem.viscous[i] * unit**2 / scale**2
    if slope == 0.0:
        program.linear[place] -= np.clip(drive, -limit, limit) * unit / scale**2
        return
    stiffness = slope * unit**2 / scale**2
    program.quadratic[place, place] += stiffness
    program.linear[place] -= drive * unit / scale**2
    if np.isfinite(limit):
        size, over = program.unknown(limit * unit / scale**2), program.unknown(drive * unit / scale**2)
        program.quadratic[over, over] += stiffness
        program.quadratic[place, over] -= stiffness
        program.quadratic[over, place] -= stiffness
        program.cone([{size: 1.0}, {over: 1.0}], clarabel.SecondOrderConeT)


def _add_contact(program: _Program, rows: np.ndarray, grip: float) -> tuple[int, list[int]]:
    """Where the duals of slip stand, and of which of the two directions they are."""
    places = [d for d in range(2) if rows[d].any()]
    if grip == 0.0 or not places:
        return 0, []
    slips = [{int(c): float(rows[d, c]) for c in np.flatnonzero(rows[d])} for d in places]
    if np.isinf(grip):
        return program.cone(slips, clarabel.ZeroConeT), places
    size = program.unknown(grip)
    return program.cone([{size: 1.0}, *slips], clarabel.SecondOrderConeT) + 1, places


def _add_axle(program: _Program, place: int, axle: float) -> int | None:
    if axle == 0.0:
        return None
    size = program.unknown(axle)
    return program.cone([{size: 1.0}, {place: 1.0}], clarabel.SecondOrderConeT) + 1
