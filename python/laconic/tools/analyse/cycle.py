"""Limit cycles by shooting, with their Floquet multipliers.

The unknowns are the starting point and the period; the variational equation runs along, so Newton's method is exact
and the multipliers come with it. One multiplier is 1 (along the motion); the others decide.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from laconic.tools.analyse.field import Field

# ---- Andronov–Hopf points: where they lie, and the first Lyapunov coefficient, whose sign decides where a cycle
# exists.
#
# The vector field is exactly quadratic, so the coefficient needs no third derivatives:
#     l1 = Re[ −2 ⟨p, B(q, J⁻¹ B(q, q̄))⟩ + ⟨p, B(q̄, (2iΩ − J)⁻¹ B(q, q))⟩ ] / (2Ω),
# B = 2 q(·,·), J q = iΩ q, Jᵀ p = −iΩ p, ⟨p, q⟩ = 1. Negative: a stable cycle around the unstable motion
# (supercritical); positive: an unstable cycle around the still stable one (subcritical). With |q| = 1 in ζ, whose norm
# is the energy's, it is in 1/s · (s/rad)²; only its sign has a meaning of its own.

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


@dataclass(frozen=True)
class LimitCycle:
    """A closed orbit in ν."""

    parameter: float
    start_zeta: np.ndarray
    path_nu: np.ndarray       # ν along one period
    period_s: float
    multipliers: np.ndarray
    size: float               # largest distance in ν from the steady motion inside
    residual: float           # how well it closes

    @property
    def stable(self) -> bool:
        """All multipliers but the one along the motion inside the unit circle."""
        along = int(np.argmin(np.abs(self.multipliers - 1.0)))
        return bool(np.abs(np.delete(self.multipliers, along)).max(initial=0.0) < 1.0)


def flow(field: Field, zeta: np.ndarray, duration_s: float, samples: int = 2,
         tolerance: float = 1e-12) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """(times, ζ at the times, ∂ζ(end)/∂ζ(start)); None where the motion cannot be followed so far."""
    m = field.dof

    def rates(_: float, packed: np.ndarray) -> np.ndarray:
        point, matrix = packed[:m], packed[m:].reshape(m, m)
        return np.concatenate([field.rates(point), (field.jacobian(point) @ matrix).ravel()])

    start = np.concatenate([zeta, np.eye(m).ravel()])
    times = np.linspace(0.0, duration_s, samples)
    run = solve_ivp(rates, (0.0, duration_s), start, method="DOP853", rtol=tolerance, atol=tolerance, t_eval=times)
    if not run.success or run.y.shape[1] < samples:
        return None
    return times, run.y[:m].T, run.y[m:, -1].reshape(m, m)


def shoot(field: Field, guess: np.ndarray, period_s: float, centre: np.ndarray, parameter: float) -> LimitCycle | None:
    """Newton on (ζ, T), held to the plane through the guess across the flow; None if it does not settle."""
    zeta, anchor, normal = guess.copy(), guess.copy(), field.rates(guess)
    scale, m, first_period = max(1.0, float(np.abs(centre).max())), field.dof, period_s
    for _ in range(12):
        result = flow(field, zeta, period_s, tolerance=1e-10)
        if result is None:
            return None
        _, path, monodromy = result
        residual = np.append(path[-1] - zeta, normal @ (zeta - anchor))
        system = np.zeros((m + 1, m + 1))
        system[:m, :m] = monodromy - np.eye(m)
        system[:m, m] = field.rates(path[-1])
        system[m, :m] = normal
        step = np.linalg.lstsq(system, -residual, rcond=None)[0]
        zeta, period_s = zeta + step[:m], period_s + step[m]
        if not 0.3 < period_s / first_period < 3.0 or not np.isfinite(zeta).all():
            return None
        if np.abs(step[:m]).max() < 1e-8 * scale and abs(step[m]) < 1e-8 * period_s:
            return _finished(field, zeta, period_s, centre, parameter)
    return None


def _finished(field: Field, zeta: np.ndarray, period_s: float, centre: np.ndarray,
              parameter: float) -> LimitCycle | None:
    result = flow(field, zeta, period_s, samples=200)
    if result is None:
        return None
    _, path, monodromy = result
    nu = field.nu(path)
    distance = float(np.abs(nu - field.nu(centre)).max())
    if distance < 1e-5 * max(1.0, float(np.abs(nu).max())):
        return None  # fell back onto the steady motion itself
    return LimitCycle(
        parameter=parameter,
        start_zeta=zeta,
        path_nu=nu,
        period_s=float(period_s),
        multipliers=np.linalg.eigvals(monodromy),
        size=distance,
        residual=float(np.abs(path[-1] - zeta).max()),
    )


def cycle_near(field: Field, centre: np.ndarray, parameter: float, lyapunov: float) -> LimitCycle | None:
    """The cycle around a steady motion near a Hopf point, from the amplitude that its normal form predicts.

    z' = (α + iΩ) z + l1 Ω |z|² z has the cycle |z|² = −α/(l1 Ω), in the eigenvectors' plane.
    """
    values, vectors = np.linalg.eig(field.jacobian(centre))
    k = int(np.argmax(values.imag))
    if values[k].imag <= 0.0 or -values[k].real * lyapunov <= 0.0:
        return None
    amplitude = np.sqrt(-values[k].real / (lyapunov * values[k].imag))
    direction = 2.0 * (vectors[:, k] / np.linalg.norm(vectors[:, k])).real
    period_s = 2.0 * np.pi / values[k].imag
    for factor in (1.0, 0.9, 1.1, 0.8):
        cycle = shoot(field, centre + factor * amplitude * direction, period_s, centre, parameter)
        if cycle is not None:
            return cycle
    return None
