"""ν in the units of a driver: ν1, ν2 and ν3 are rolling speeds in rad/s, people think in m/s and rad/s of yaw.

v = R (ν1 e_ξ + ν2 e_η) is the velocity of the centre of mass in body axes, ω = ν3/Λ the yaw rate.

How fast a vehicle of this kind can go: what its motors do under the largest inputs of its scene.

A bifurcation far beyond that is a property of the equations, not of the robot: it is reported, but not drawn.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from laconic.scene.inputs import Input
from laconic.tools.analyse.from_core import Subject

ROUNDING = 1e-9  # of the largest speeds: what is smaller is what rounding left


def wheel_radius_m(subject: Subject) -> float:
    """R: metres of travel for each radian of ν1 or ν2."""
    return float(subject.model.wheel_radius_m)


def of_driver(subject: Subject, nu: np.ndarray) -> dict[str, Any]:
    """Velocity in body axes [m/s] and yaw rate [rad/s] of a ν."""
    nu = without_rest(nu)
    return {"velocity_body_m_per_s": wheel_radius_m(subject) * nu[:2],
            "yaw_rate_rad_per_s": float(nu[2]) / subject.matrices.lambda_yaw}


def without_rest(nu: np.ndarray, size: float = 0.0) -> np.ndarray:
    """ν with what rounding left behind set to zero; `size`: what else was reckoned with, where that is larger [rad/s].
    """
    nu = np.asarray(nu, dtype=float)
    return np.where(np.abs(nu) < ROUNDING * max(float(np.abs(nu).max(initial=0.0)), size, 1e-300), 0.0, nu)


def motion_text(subject: Subject, nu: np.ndarray) -> str:
    """ν with the velocity and yaw rate it stands for."""
    found = of_driver(subject, nu)
    along, across = found["velocity_body_m_per_s"]
    shown = ", ".join(f"{v:.6g}" for v in without_rest(nu))
    return (f"ν = ({shown}) rad/s, that is ({along:.4g}, {across:.4g}) m/s along the body's ξ, η and "
            f"{found['yaw_rate_rad_per_s']:.4g} rad/s of yaw")


def command_text(subject: Subject, name: str, value: float, digits: int = 9) -> str:
    """A parameter's value; a commanded ν1 or ν2 in m/s, too."""
    if name not in ("nu1", "nu2"):
        return f"{name} = {value:.{digits}g}"
    return f"{name} = {value:.{digits}g} rad/s ({wheel_radius_m(subject) * value:.4g} m/s)"


HEADROOM = 2.0  # over the run's largest inputs: a scene seldom uses the full range of its motors
WORLD = "world_force"


def largest(given: Input) -> float:
    """The largest size of an input over time."""
    return abs(given.amplitude) if given.kind == "sine" else max(map(abs, given.value), default=0.0)


def largest_nu(subject: Subject) -> np.ndarray:
    """|ν| in steady motion, component by component, with every input at its largest and all of them helping.

    The steady answer to held inputs is linear in them as long as nothing turns: b/r in the core's own coordinates.
    A direction without damping has no limit of its own: infinite where something drives it.
    """
    total = np.zeros(3)
    for given in subject.scene.inputs:
        size = largest(given)
        if not size or given.signal.startswith(WORLD):
            continue
        field = subject.field({given.signal: size})
        forcing, decay = field.forcing[: field.dof], field.decay_per_s[: field.dof]
        damped = decay > 0.0
        total += np.abs(field.nu(np.where(damped, forcing, 0.0) / np.where(damped, decay, 1.0)))
        if np.any(forcing[~damped] != 0.0):
            return np.full(3, np.inf)
    return total


def reach_rad_per_s(subject: Subject, which: int, commanded: float) -> float:
    """The largest |ν1| or |ν2| (which: 0, 1) worth showing; at least some headroom over the commanded one."""
    found = float(largest_nu(subject)[which])
    return HEADROOM * max(found if np.isfinite(found) else 0.0, abs(commanded))
