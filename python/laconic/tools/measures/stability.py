"""How fast motions settle, and up to which speed straight motion is stable, for many vehicles at once.

About a straight motion ζ0 = s u (s: its speed, u: the ζ of 1 m/s in its direction, g·u = 0) a small change obeys

    δζ' = (s p gᵀ − diag(r)) δζ,     p = u × w,     with g·δζ the change of ν3

so λ is an eigenvalue where s Σ g_k p_k/(r_k + λ) = 1 (or −r_k, where g_k p_k = 0). The motion is stable at small s; it
stops being so at the smallest s > 0 with λ = 0 or λ = iω. For the paper's carriage along η that is ν2 = 2cΛσ²/ρ.
"""

from __future__ import annotations

import numpy as np

from laconic.tools.measures.prepared import Group

ROUNDING = 1e-13  # of the largest term of a sum: what is smaller is 0


def slowest_damping_per_s(group: Group) -> np.ndarray:
    """The smallest damping rate; 0 where a motion coasts for ever."""
    return group.decay_per_s.min(axis=1)


def fastest_damping_per_s(group: Group) -> np.ndarray:
    """The largest damping rate."""
    return group.decay_per_s.max(axis=1)


def straight_zeta(group: Group, direction_rad: float) -> np.ndarray:
    """ζ of 1 m/s straight in a direction of the body, (L, m); NaN where the constraints forbid it."""
    wanted = np.array([np.cos(direction_rad), np.sin(direction_rad), 0.0])
    zeta = np.linalg.pinv(group.motion_of_zeta) @ wanted
    scale = np.abs(group.motion_of_zeta).max(axis=(1, 2))
    missed = group.motion_of_zeta @ zeta[:, :, None]
    fits = (np.abs(missed[..., 0] - wanted) <= 1e-9 * np.maximum(1.0, scale)[:, None]).all(axis=1)
    return np.where(fits[:, None], zeta, np.nan)


def _coupling(group: Group, direction_rad: float) -> np.ndarray:
    """g_k p_k per m/s, (L, m), and so the growth of ν3 by ν3 through each damped direction."""
    return _pull(group, direction_rad) * group.models["nu_of_zeta"][:, 2, : group.dof]


def _pull(group: Group, direction_rad: float) -> np.ndarray:
    """p = u × w, (L, m)."""
    full = np.zeros((len(group.models), 3))
    full[:, : group.dof] = straight_zeta(group, direction_rad)
    return np.cross(full, group.models["gyro"])[:, : group.dof]


def straight_stable_speed_m_per_s(group: Group, direction_deg: float) -> np.ndarray:
    """Up to which speed straight motion in a direction of the body is stable; infinite where at every speed."""
    coupling, decay = _coupling(group, np.radians(direction_deg)), group.decay_per_s
    speed = first_unstable_speed(coupling, decay)
    undamped = (decay <= 1e-12 * decay.max(axis=1, keepdims=True)).any(axis=1)
    return np.where(np.isnan(coupling).any(axis=1), np.nan, np.where(undamped, 0.0, speed))


def first_unstable_speed(coupling: np.ndarray, decay: np.ndarray) -> np.ndarray:
    """The least s > 0 at which λ = 0 or λ = iω solves s Σ g p/(r + λ) = 1, from g p and r (L, m)."""
    squares = (np.zeros(len(decay)), *_squares_of_rate(coupling, decay))
    return np.min([_speed_at(coupling, decay, square) for square in squares], axis=0)


def _speed_at(coupling: np.ndarray, decay: np.ndarray, square: np.ndarray) -> np.ndarray:
    """s > 0 with 1 = s Σ g p/(r + iω), of which the real part is Σ g p r/(r² + ω²); infinite where there is none."""
    with np.errstate(divide="ignore", invalid="ignore"):
        each = coupling * decay / (decay**2 + square[:, None])
        inverse = each.sum(axis=1)
        return np.where(inverse > ROUNDING * np.abs(each).max(axis=1), 1.0 / inverse, np.inf)


def _squares_of_rate(coupling: np.ndarray, decay: np.ndarray) -> np.ndarray:
    """W = ω² > 0 at which the imaginary part vanishes, Σ g p/(r² + W) = 0; infinite for each root that is none, (2, L).

    With the denominators multiplied away it is a W² + b W + c = 0 for three rates, and linear for two.
    """
    lanes, rates = coupling.shape
    if rates < 2:
        return np.full((2, lanes), np.inf)
    others = [np.delete(decay**2, k, axis=1) for k in range(rates)]
    constant = sum(coupling[:, k] * others[k].prod(axis=1) for k in range(rates))
    total = coupling.sum(axis=1)
    if rates == 2:
        square, linear = np.zeros(lanes), total
    else:
        square, linear = total, sum(coupling[:, k] * others[k].sum(axis=1) for k in range(rates))
    return _positive_roots(square, np.asarray(linear), np.asarray(constant))


def _positive_roots(square: np.ndarray, linear: np.ndarray, constant: np.ndarray) -> np.ndarray:
    """Both roots of square W² + linear W + constant, infinite where not above 0, (2, L)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(linear**2 - 4.0 * square * constant)
        half = -0.5 * (linear + np.where(linear < 0.0, -root, root))
        both = np.array([half / square, constant / half])
    return np.where(np.isfinite(both) & (both > 0.0), both, np.inf)


def straight_growth_per_s(group: Group, speed_m_per_s: float, direction_deg: float) -> np.ndarray:
    """Largest real part of the eigenvalues about straight motion at a speed; below 0 a disturbance decays."""
    pull = speed_m_per_s * _pull(group, np.radians(direction_deg))
    yaw_row = group.models["nu_of_zeta"][:, 2, : group.dof]
    matrix = pull[:, :, None] * yaw_row[:, None, :]
    matrix[:, range(group.dof), range(group.dof)] -= group.decay_per_s
    usable = np.isfinite(matrix).all(axis=(1, 2))
    values = np.linalg.eigvals(np.where(usable[:, None, None], matrix, 0.0)).real.max(axis=1)
    return np.where(usable, values, np.nan)


def steady_growth_per_s(group: Group) -> np.ndarray:
    """Largest real part of the eigenvalues of that steady motion, straight or turning, which has the least; NaN where
    there is none. The inputs are held as at the run's start."""
    from laconic.tools.analyse.from_core import field_of
    from laconic.tools.analyse.steady import steady_motions

    found = []
    for (_, model), inputs in zip(group.pointers, group.inputs, strict=True):
        motions = steady_motions(field_of(group.core, model, inputs))
        found.append(min((float(motion.eigenvalues.real.max()) for motion in motions), default=np.nan))
    return np.array(found)
