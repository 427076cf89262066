"""How well a given (ν, s, p) solves a friction step, by the definition of the field and sharing nothing with a solver.

The larger of two numbers, both relative to |M⁻¹ rhs|_M:
  dynamics     |M z + Bᵀp + τ − rhs| in the norm of M⁻¹
  natural map  |p − Π(p + slip/W)| √W for each contact, Π onto the disc of the grip, W the larger eigenvalue of the
               contact's Bᵢ M⁻¹ Bᵢᵀ; the same for each axle, whose impulse is what the wheel's balance leaves, within
               its bound
M holds the damping of the mode that the motors are in; a motor at its limit is a given impulse instead.
"""

from __future__ import annotations

import numpy as np

from references.friction.problem import StepProblem


def residual(problem: StepProblem, z: np.ndarray, slip_impulse: np.ndarray) -> float:
    """The residual of z = (ν, s) with the impulses p (N × 2, along the slip; the ground gives −p)."""
    mass, rhs = _balance(problem, z[3:])
    rows = problem.slip_rows()
    rest = mass * z + np.einsum("ndz,nd->z", rows, slip_impulse) - rhs
    axle = np.clip(-rest[3:], -problem.axle, problem.axle)
    rest[3:] += axle
    worst = float(np.sqrt(np.sum(rest**2 / mass)))
    for row, p, grip in zip(rows, slip_impulse, problem.grip, strict=True):
        weight = float(np.linalg.eigvalsh((row / mass) @ row.T)[-1])
        worst = max(worst, _natural(p, row @ z, grip, weight) if weight > 0.0 else float(np.hypot(*p)))
    for tau, speed, bound, inertia in zip(axle, z[3:], problem.axle, mass[3:], strict=True):
        worst = max(worst, _natural(np.array([tau]), np.array([speed]), bound, 1.0 / inertia))
    size = size_of(problem, z)
    return worst / size if size > 0.0 else worst


def size_of(problem: StepProblem, z: np.ndarray) -> float:
    """|M⁻¹ rhs|_M: the size of the step's free motion, the motors as they are at z."""
    mass, rhs = _balance(problem, z[3:])
    return float(np.sqrt(np.sum(rhs**2 / mass)))


def _balance(problem: StepProblem, speed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    free = problem.drive - problem.drive_slope * speed
    within = np.abs(free) <= problem.drive_limit
    mass = problem.masses()
    rhs = mass * np.concatenate([problem.free_nu, problem.free_speed])
    mass[3:] += problem.viscous + np.where(within, problem.drive_slope, 0.0)
    rhs[3:] += np.where(within, problem.drive, np.copysign(np.where(within, 0.0, problem.drive_limit), free))
    return mass, rhs


def _natural(p: np.ndarray, slip: np.ndarray, grip: float, weight: float) -> float:
    """|p − Π(p + slip/W)| √W."""
    moved = p + slip / weight
    size = float(np.linalg.norm(moved))
    nearest = moved * (grip / size) if size > grip else moved
    return float(np.linalg.norm(p - nearest)) * weight**0.5
