"""Steady motion of a body whose wheels are held at given speeds: the minimum of what the contacts dissipate.

This needs no step and no solver of the core: with the wheels held, Φ is a function of the body's velocity alone, and a
body that is not driven otherwise settles where Φ is least. Φ's slip part is homogeneous, so all speeds scale together.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from scipy.optimize import minimize

from references.friction.vehicles import geometry


def held_motion(vehicle: Mapping[str, Any], wheel_speed: np.ndarray, drag: float, load: np.ndarray) -> np.ndarray:
    """ν at which Σ load sqrt(slip_u² + k² slip_w²) is least, for held wheel speeds; rad/s."""
    rows = geometry(vehicle)
    start = np.linalg.lstsq(rows["along"], rows["rim_along"] * wheel_speed, rcond=None)[0]
    size = max(float(np.linalg.norm(start)), 1e-300)

    along, across = rows["along"], drag * rows["across"]
    rim = np.array([rows["rim_along"], drag * rows["rim_across"]]) * wheel_speed / size

    def dissipated(nu: np.ndarray, round_off: float) -> tuple[float, np.ndarray]:
        """Φ and its gradient, its corner rounded off at this slip."""
        slip = np.array([along @ nu, across @ nu]) - rim
        length = np.sqrt((slip**2).sum(axis=0) + round_off**2)
        force = load * slip / length
        return float(load @ length), force[0] @ along + force[1] @ across

    nu = 0.7 * start / size
    for round_off in 10.0 ** -np.arange(1.0, 8.0):
        nu = minimize(dissipated, nu, (round_off,), jac=True, method="BFGS", options={"gtol": 1e-9}).x
    return nu * size


def rolled_over_travelled(vehicle: Mapping[str, Any], direction: tuple[float, float], drag: float) -> float:
    """The distance that the wheels roll off over that which the body covers, equally loaded wheels held at the speeds
    that would move it in this direction of the body frame without slip."""
    rows = geometry(vehicle)
    wanted = np.array([*direction, 0.0])
    speed = rows["along"] @ wanted / rows["rim_along"]
    nu = held_motion(vehicle, speed, drag, np.ones(len(speed)))
    return float(np.linalg.norm(wanted[:2]) / np.linalg.norm(nu[:2]))
