"""The convex problem of one friction step, in the units of the core: energies over M R², speeds in rad/s.

    min over ν, s of  ½|ν − ν*|² + Σ_i [ ½ j (s − s*)² + D(s) + ½ viscous s² + axle |s| + grip |slip| ]
    slip_i = (along·ν − rim_along s, k (across·ν − rim_across s))
    D'(s) = −clamp(drive − drive_slope s, ± drive_limit)

The unknown z = (ν1, ν2, ν3, s_1 … s_N) has the masses (1, 1, 1, j_1 … j_N).

How well a given (ν, s, p) solves a friction step, by the definition of the field and sharing nothing with a solver.

The larger of two numbers, both relative to |M⁻¹ rhs|_M:
  dynamics     |M z + Bᵀp + τ − rhs| in the norm of M⁻¹
  natural map  |p − Π(p + slip/W)| √W for each contact, Π onto the disc of the grip, W the larger eigenvalue of the
               contact's Bᵢ M⁻¹ Bᵢᵀ; the same for each axle, whose impulse is what the wheel's balance leaves, within
               its bound
M holds the damping of the mode that the motors are in; a motor at its limit is a given impulse instead.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

Numbers = np.ndarray


@dataclass(frozen=True)
class StepProblem:
    """Data of one step; one row or item a wheel. Infinite grip: a rigid contact; infinite drive_limit: no limit."""

    along: Numbers         # N × 3: the contact point's velocity over R along the roller axis, for ν
    across: Numbers        # N × 3: the same across it
    rim_along: Numbers     # what wheel speed takes off the velocity along
    rim_across: Numbers
    inertia: Numbers       # j = J/(M R²)
    drag: Numbers          # k
    grip: Numbers          # h μ N/(M R)
    axle: Numbers          # h T/(M R²)
    drive: Numbers         # motor impulse at s = 0
    drive_slope: Numbers
    drive_limit: Numbers
    viscous: Numbers
    free_speed: Numbers    # s*
    free_nu: Numbers       # ν*

    @property
    def wheels(self) -> int:
        """N."""
        return len(self.inertia)

    def slip_rows(self) -> Numbers:
        """N × 2 × (3 + N): slip of each contact for z; the second row of a contact is zero where k = 0."""
        rows = np.zeros((self.wheels, 2, 3 + self.wheels))
        rows[:, 0, :3], rows[:, 1, :3] = self.along, self.drag[:, None] * self.across
        each = np.arange(self.wheels)
        rows[each, 0, 3 + each], rows[each, 1, 3 + each] = -self.rim_along, -self.drag * self.rim_across
        return rows

    def masses(self) -> Numbers:
        """The masses of z, without damping."""
        return np.concatenate([np.ones(3), self.inertia])

    def drive_impulse(self, speed: Numbers) -> Numbers:
        """What the motors give at these wheel speeds, viscous friction apart."""
        return np.clip(self.drive - self.drive_slope * speed, -self.drive_limit, self.drive_limit)

    def energy(self, z: Numbers) -> float:
        """What the step minimises, at z."""
        z = np.asarray(z, float)
        speed, far = z[3:], z - np.concatenate([self.free_nu, self.free_speed])
        slip = np.einsum("ndz,z->nd", self.slip_rows(), z)
        if np.any(np.isinf(self.grip) & (np.hypot(*slip.T) > 1e-12)):
            return np.inf
        grip = np.where(np.isinf(self.grip), 0.0, self.grip)
        return float(0.5 * far @ (self.masses() * far) + self._motor_energy(speed).sum()
                     + 0.5 * self.viscous @ speed**2 + self.axle @ np.abs(speed) + grip @ np.hypot(*slip.T))

    def _motor_energy(self, speed: Numbers) -> Numbers:
        """D(s) with D(0) = 0: the integral of the clamp, in three straight and curved pieces."""
        def primitive(free: Numbers) -> Numbers:
            inner = np.clip(free, -self.drive_limit, self.drive_limit)
            outer = np.abs(free) - np.abs(inner)
            return 0.5 * inner**2 + np.where(outer > 0.0, outer * np.abs(inner), 0.0)
        slope = np.where(self.drive_slope > 0.0, self.drive_slope, 1.0)
        held = -np.clip(self.drive, -self.drive_limit, self.drive_limit) * speed
        clamped = (primitive(self.drive - self.drive_slope * speed) - primitive(self.drive)) / slope
        return np.where(self.drive_slope > 0.0, clamped, held)

    def save(self, path: Path, **more: Any) -> None:
        """Writes a case to a small file; numbers keep all their bits."""
        data = {name: value.tolist() for name, value in asdict(self).items()}
        path.write_text(json.dumps(data | more, indent=1) + "\n")

    @staticmethod
    def load(path: Path) -> StepProblem:
        """A case from its file."""
        data = json.loads(path.read_text())
        return StepProblem(**{name: np.array(data[name], float) for name in StepProblem.__dataclass_fields__})


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
