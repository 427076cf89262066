"""Phase portrait of the free motion in the plane (ν3, ν⊥), as in the paper's Fig. 4.

ν⊥ is the component of (ν1, ν2) across the direction that is coupled to turning: ν2 for the paper's carriage. For one
value of K the curves are ellipses about (K/A33, 0); those that reach over ν3 = 0 consist of two motions, one on either
side, that lead from unstable straight motions to stable ones. With two degrees of freedom there is no K: the plane is
the whole phase space and the ellipses of equal energy lie about the origin.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from laconic.tools.analyse.free_motion import S2, FreeMotion
from laconic.tools.analyse.from_core import Subject

SIZES = (0.2, 0.4, 0.6, 0.8, 1.0, 1.25, 1.6)  # of the ellipse that touches ν3 = 0


@dataclass(frozen=True)
class Portrait:
    """The curves of one portrait."""

    across: np.ndarray         # direction of ν⊥ in (ν1, ν2)
    label: str                 # its name
    centre: float              # K/A33, on the axis ν⊥ = 0
    integral: float | None     # K; None with constraints
    curves: list[FreeMotion]
    straight_slope: float      # d(growth rate of ν3)/dν⊥ on the line ν3 = 0; below zero for ν⊥ where the product is


def across_direction(subject: Subject) -> tuple[np.ndarray, str] | None:
    """ν⊥ and its name; None where turning is not coupled to anything."""
    if subject.model.dof == 3:
        coupling = subject.matrices.inertia[2, :2]
        if np.abs(coupling).max() < 1e-12 * abs(subject.matrices.inertia[2, 2]):
            return None
        unit = coupling / np.linalg.norm(coupling)
        across = np.array([unit[1], -unit[0]])
    else:
        if subject.model.dof == 1:
            return None
        basis = subject.allowed_columns
        straight = basis @ np.array([basis[2, 1], -basis[2, 0]])
        if np.abs(straight[:2]).max() < 1e-12:
            return None
        across = straight[:2] / np.linalg.norm(straight[:2])
    across = across * (1.0 if across[int(np.argmax(np.abs(across)))] > 0.0 else -1.0)
    across = np.where(np.abs(across) < 1e-12, 0.0, across)
    names = {(1.0, 0.0): r"$\nu_1$", (0.0, 1.0): r"$\nu_2$"}
    angle = np.degrees(np.arctan2(across[1], across[0]))
    return across, names.get(tuple(np.round(across, 12)), rf"$\nu_\perp$ (at {angle:.0f}° from $\xi$)")


def portrait(subject: Subject, start_nu: np.ndarray) -> Portrait | None:
    """Curves around the one through a state; None where ν3 never changes in free motion."""
    direction = across_direction(subject)
    if direction is None:
        return None
    across, label = direction
    inverse, big = subject.matrices.inverse_inertia, subject.matrices.lambda_yaw
    slope = float(inverse[2, :2] @ S2 @ across) / big
    if abs(slope) * big < 1e-12 * inverse[2, 2]:
        return None
    if subject.model.dof == 3:
        integral = float(subject.matrices.inertia[2] @ start_nu)
        if abs(integral) < 1e-9 * max(1.0, float(np.abs(start_nu).max())):
            integral = float(subject.matrices.inertia[2, 2] * max(1.0, float(np.abs(start_nu).max())))
        centre = integral / float(subject.matrices.inertia[2, 2])
        unit = FreeMotion(np.array([*across, centre]), inverse, big)
        _, a, b = unit.harmonics()
        unit_reach = float(np.hypot(a, b))
        own = FreeMotion(start_nu, inverse, big)
        own_reach = float(np.hypot(*own.harmonics()[1:])) if own.kind in ("periodic", "asymptotic") else 0.0
        touching = abs(centre)
        wide = [share * own_reach for share in (0.25, 0.5, 0.75, 1.25)] if own_reach > 1.6 * touching else []
        reaches = [touching, *wide] if wide else [size * touching for size in SIZES]
        starts = [np.array([*(reach / unit_reach * across), centre]) for reach in reaches]
    else:
        integral, centre = None, 0.0
        turning = inverse[:, 2] / inverse[2, 2]
        size = max(1.0, abs(float(start_nu[2])), float(np.abs(start_nu[:2]).max()))
        starts = [share * size * turning for share in (0.25, 0.5, 0.75, 1.0)]
    return Portrait(across, label, centre, integral, [FreeMotion(s, inverse, big) for s in starts], slope)


def half_curves(motion: FreeMotion, points: int = 600) -> list[np.ndarray]:
    """ν along the whole ellipse in the direction of time, cut where ν3 changes its sign."""
    nu = motion.nu_at_angle(np.linspace(0.0, 2.0 * np.pi / motion.petal_rate, points))
    side = np.sign(nu[:, 2])
    cuts = np.flatnonzero(np.diff(side) != 0) + 1
    pieces = [piece for piece in np.split(nu, cuts) if len(piece) > 2]
    if len(pieces) > 1 and np.sign(pieces[0][1, 2]) == np.sign(pieces[-1][1, 2]):
        pieces = [np.concatenate([pieces[-1], pieces[0]]), *pieces[1:-1]]
    return [piece if piece[len(piece) // 2, 2] > 0.0 else piece[::-1] for piece in pieces]
