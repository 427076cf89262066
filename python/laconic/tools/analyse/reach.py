"""How fast a vehicle of this kind can go: what its motors do under the largest inputs of its scene.

A bifurcation far beyond that is a property of the equations, not of the robot: it is reported, but not drawn.
"""

from __future__ import annotations

import numpy as np

from laconic.scene.inputs import Input
from laconic.tools.analyse.from_core import Subject

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
