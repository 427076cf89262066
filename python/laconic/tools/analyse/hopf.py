"""Andronov–Hopf points: where they lie, and the first Lyapunov coefficient, whose sign decides where a cycle exists.

The vector field is exactly quadratic, so the coefficient needs no third derivatives:
    l1 = Re[ −2 ⟨p, B(q, J⁻¹ B(q, q̄))⟩ + ⟨p, B(q̄, (2iΩ − J)⁻¹ B(q, q))⟩ ] / (2Ω),
B = 2 q(·,·), J q = iΩ q, Jᵀ p = −iΩ p, ⟨p, q⟩ = 1. Negative: a stable cycle around the unstable motion
(supercritical); positive: an unstable cycle around the still stable one (subcritical). With |q| = 1 in ζ, whose norm is
the energy's, it is in 1/s · (s/rad)²; only its sign has a meaning of its own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from laconic.tools.analyse.field import Field


@dataclass(frozen=True)
class HopfPoint:
    """A steady motion with a pair ±iΩ."""

    parameter: float
    nu: np.ndarray
    frequency_rad_per_s: float
    lyapunov: float

    @property
    def kind(self) -> str:
        """Which way the limit cycle is born."""
        return "subcritical" if self.lyapunov > 0.0 else "supercritical"


def has_oscillating_pair(jacobian: np.ndarray) -> bool:
    """Where the test is zero: is the pair imaginary (a true Hopf point), or real and opposite (a neutral saddle)?"""
    eigenvalues = np.linalg.eigvals(jacobian)
    nearest = eigenvalues[np.argsort(np.abs(eigenvalues.real))[:2]]
    return bool(np.abs(nearest.imag).min() > 1e-9 * np.abs(eigenvalues).max())


def first_lyapunov(field: Field, zeta: np.ndarray) -> tuple[float, float]:
    """(l1, Ω) at a Hopf point."""
    jacobian = field.jacobian(zeta)
    values, right = np.linalg.eig(jacobian)
    chosen = int(np.argmin(np.abs(values.real) + (values.imag <= 0.0) * 1e300))
    frequency = float(values[chosen].imag)
    q = right[:, chosen] / np.linalg.norm(right[:, chosen])
    left_values, left = np.linalg.eig(jacobian.T)
    p = left[:, int(np.argmin(np.abs(left_values + 1j * frequency)))]
    p = p / np.conj(np.vdot(p, q))

    def b(u: np.ndarray, v: np.ndarray) -> np.ndarray:
        return 2.0 * field.quadratic(u, v)

    still = np.linalg.solve(jacobian, b(q, q.conj()))
    double = np.linalg.solve(2j * frequency * np.eye(len(q)) - jacobian, b(q, q))
    value = np.vdot(p, -2.0 * b(q, still) + b(q.conj(), double)).real / (2.0 * frequency)
    return float(value), frequency
