"""The equations of motion as a quadratic vector field, in the coordinates that the core prepared.

ν = G ζ with GᵀAG = 1, and  ζ' = (g·ζ)(ζ × w) − diag(r) ζ + b = q(ζ, ζ) − diag(r) ζ + b  (g is the third row
of G, so g·ζ = ν3). With constraints, or when a component of ζ is missing, all vectors
keep length three and the components from `dof` on stay zero.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np


@dataclass(frozen=True)
class Field:
    """One vehicle under constant inputs."""

    dof: int                  # m
    nu_of_zeta: np.ndarray    # G
    gyro: np.ndarray          # w
    decay_per_s: np.ndarray   # r
    forcing: np.ndarray       # b
    lambda_yaw: float         # Λ

    @cached_property
    def yaw_row(self) -> np.ndarray:
        """g: ν3 = g·ζ."""
        return self.nu_of_zeta[2]

    @cached_property
    def cross_matrix(self) -> np.ndarray:
        """[· × w]: the matrix of ζ → ζ × w, on the components that exist."""
        w = self.gyro
        matrix = np.array([[0.0, w[2], -w[1]], [-w[2], 0.0, w[0]], [w[1], -w[0], 0.0]])
        return matrix[: self.dof, : self.dof]

    @cached_property
    def linear_matrix(self) -> np.ndarray:
        """−diag(r)."""
        return -np.diag(self.decay_per_s[: self.dof])

    def quadratic(self, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        """q(u, v), symmetric and bilinear; the vectors may be complex. On the first `dof` components."""
        g, cross = self.yaw_row[: self.dof], self.cross_matrix
        return 0.5 * ((g @ u) * (cross @ v) + (g @ v) * (cross @ u))

    def rates(self, zeta: np.ndarray) -> np.ndarray:
        """ζ'."""
        m = self.dof
        rotated = self.cross_matrix @ zeta
        return (self.yaw_row[:m] @ zeta) * rotated - self.decay_per_s[:m] * zeta + self.forcing[:m]

    def jacobian(self, zeta: np.ndarray) -> np.ndarray:
        """∂ζ'/∂ζ."""
        g, cross = self.yaw_row[: self.dof], self.cross_matrix
        return (cross @ zeta)[:, None] * g + (g @ zeta) * cross + self.linear_matrix

    def nu(self, zeta: np.ndarray) -> np.ndarray:
        """ν = G ζ, also for rows of many ζ."""
        return zeta @ self.nu_of_zeta[:, : self.dof].T

    def zeta(self, nu: np.ndarray) -> np.ndarray:
        """The ζ of a ν that the constraints allow (of any other: of the nearest allowed one)."""
        return np.linalg.lstsq(self.nu_of_zeta[:, : self.dof], np.asarray(nu, dtype=float), rcond=None)[0]
