"""The free motion in closed form: no motor, no damping, no force.

With the heading as independent variable the system is linear: for φ = θ − θ0, P the upper left block of A⁻¹,
    (ν1, ν2)(φ) = [cos Ωφ E + Ω⁻¹ sin Ωφ P S2] (ν1, ν2)(0),   Ω = √det P,   ν3(φ) = n0 + a cos Ωφ + b sin Ωφ,
and the time is elementary, t = Λ ∫ dφ/ν3. With constraints the same holds with G Gᵀ in place of A⁻¹; where Ω = 0
(a caster, an axle through the centre of mass) the sines become powers of φ.

It shares no code with the core's method that is exact for it, and checks that.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

S2 = np.array([[0.0, 1.0], [-1.0, 0.0]])
STRAIGHT = 1e-14  # |ν3| below this fraction of |ν|: the heading never changes


@dataclass(frozen=True)
class FreeMotion:
    """The motion from one state on."""

    start_nu: np.ndarray
    inverse_inertia: np.ndarray  # A⁻¹, or G Gᵀ with constraints
    lambda_yaw: float

    # ---- constants of this motion

    @property
    def petal_rate(self) -> float:
        """Ω: one petal is 2π/Ω of heading."""
        return float(np.sqrt(max(np.linalg.det(self.inverse_inertia[:2, :2]), 0.0)))

    def harmonics(self) -> tuple[float, float, float]:
        """n0, a, b of ν3(φ) = n0 + a cos Ωφ + b sin Ωφ."""
        omega, pull = self.petal_rate, self.inverse_inertia[2, :2] @ S2
        rotated = self.inverse_inertia[:2, :2] @ S2 @ self.start_nu[:2]
        a = -float(pull @ rotated) / omega**2
        return float(self.start_nu[2]) - a, a, float(pull @ self.start_nu[:2]) / omega

    @property
    def discriminant(self) -> float:
        """n0² − a² − b²: above zero ν3 never vanishes on the curve."""
        n0, a, b = self.harmonics()
        return n0 * n0 - a * a - b * b

    @property
    def kind(self) -> str:
        """straight, uniform, periodic or asymptotic."""
        if abs(self.start_nu[2]) <= STRAIGHT * np.abs(self.start_nu).max(initial=0.0):
            return "straight"
        if self._omega_is_zero():
            return "asymptotic" if self._slope() else "uniform"
        return "periodic" if self.discriminant > 0.0 else "asymptotic"

    @property
    def period_s(self) -> float:
        """Time of one petal; infinite for a motion that does not return."""
        if self.kind != "periodic":
            return float("inf")
        return float(2.0 * np.pi * self.lambda_yaw / (self.petal_rate * np.sqrt(self.discriminant)))

    def limit_nu(self) -> np.ndarray:
        """The limit of ν in an asymptotic motion."""
        return self.nu_at_angle(self._angle_limit()) if self.kind == "asymptotic" else self.start_nu

    def _slope(self) -> float:
        """dν3/dφ at the start; 0 where only rounding is left."""
        pull = self.inverse_inertia[2, :2] @ S2
        size = np.abs(self.inverse_inertia).max() * np.abs(self.start_nu).max()
        slope = float(pull @ self.start_nu[:2])
        return slope if abs(slope) > 1e-13 * size else 0.0

    def _omega_is_zero(self) -> bool:
        block = self.inverse_inertia[:2, :2]
        return self.petal_rate**2 <= 1e-13 * np.abs(block).max() ** 2

    # ---- evaluation

    def nu_at_angle(self, angle_rad: float | np.ndarray) -> np.ndarray:
        """ν after the heading has changed by φ; one row per angle."""
        phi = np.asarray(angle_rad, dtype=float)[..., None]
        omega, block = self.petal_rate, self.inverse_inertia[:2, :2]
        start, rotated = self.start_nu[:2], block @ S2 @ self.start_nu[:2]
        if self._omega_is_zero():
            cos, sine, versine = np.ones_like(phi), phi, 0.5 * phi**2
        else:
            cos, sine = np.cos(omega * phi), np.sin(omega * phi) / omega
            versine = 2.0 * np.sin(0.5 * omega * phi) ** 2 / omega**2
        plane = cos * start + sine * rotated
        integral = sine * start + versine * rotated
        yaw = self.start_nu[2] + integral @ (self.inverse_inertia[2, :2] @ S2)
        return np.concatenate([plane, yaw[..., None]], axis=-1)

    def angle_at(self, time_s: float | np.ndarray) -> np.ndarray:
        """φ(t): by the tangent of Ωφ/2, with whole petals counted."""
        time = np.asarray(time_s, dtype=float)
        if self.kind == "straight":
            return np.zeros_like(time)
        if self._omega_is_zero():
            return self._angle_without_petals(time)
        n0, a, b = self.harmonics()
        r, stretched = n0 + a, 0.5 * self.petal_rate * time / self.lambda_yaw
        root = np.sqrt(abs(self.discriminant))
        if self.discriminant > 0.0:
            petals = np.floor(stretched * root / np.pi)
            rest = stretched * root - np.pi * petals
            half = np.pi * petals + np.arctan2(abs(r) * np.sin(rest) / root, np.cos(rest) - b * np.sin(rest) / root)
            return 2.0 * np.sign(r) * half / self.petal_rate
        tangent = np.tanh(stretched * root) / root if root > 0.0 else stretched
        return 2.0 * np.arctan2(r * tangent, 1.0 - b * tangent) / self.petal_rate

    def _angle_without_petals(self, time: np.ndarray) -> np.ndarray:
        """Ω = 0: ν3 = ν3(0) + s φ, so φ grows or decays exponentially (s = 0: evenly)."""
        rate, yaw_rate = self._slope() / self.lambda_yaw, self.start_nu[2] / self.lambda_yaw
        return yaw_rate * (time if rate == 0.0 else np.expm1(rate * time) / rate)

    def _angle_limit(self) -> float:
        """The whole change of heading of an asymptotic motion."""
        if self._omega_is_zero():
            return -self.start_nu[2] / self._slope()
        n0, a, b = self.harmonics()
        root = np.sqrt(max(-self.discriminant, 0.0))
        return float(2.0 * np.arctan2((n0 + a), root - b) / self.petal_rate)

    def nu_at(self, time_s: float | np.ndarray) -> np.ndarray:
        """ν at some instants, one row each."""
        return self.nu_at_angle(self.angle_at(time_s))

    def path(self, time_s: np.ndarray, wheel_radius_m: float, heading_rad: float = 0.0) -> np.ndarray:
        """Displacement (x, y) of the centre of mass at ascending instants from t = 0, by Gauss's rule between them."""
        nodes, weights = np.polynomial.legendre.leggauss(12)
        starts = np.concatenate([[0.0], np.asarray(time_s, dtype=float)])
        lengths = np.diff(starts)
        inside = starts[:-1, None] + 0.5 * lengths[:, None] * (nodes + 1.0)
        angle = self.angle_at(inside)
        nu, heading = self.nu_at_angle(angle), angle + heading_rad
        speed_x = wheel_radius_m * (nu[..., 0] * np.cos(heading) - nu[..., 1] * np.sin(heading))
        speed_y = wheel_radius_m * (nu[..., 0] * np.sin(heading) + nu[..., 1] * np.cos(heading))
        steps = 0.5 * lengths[:, None] * np.stack([speed_x @ weights, speed_y @ weights], axis=-1)
        return np.cumsum(steps, axis=0)


def yaw_by_integral(inertia: np.ndarray, start_nu: np.ndarray, nu: np.ndarray) -> np.ndarray:
    """ν3 = (K − A13 ν1 − A23 ν2)/A33: the same by the integral K (without constraints)."""
    k = inertia[2] @ start_nu
    return (k - nu[..., 0] * inertia[2, 0] - nu[..., 1] * inertia[2, 1]) / inertia[2, 2]
