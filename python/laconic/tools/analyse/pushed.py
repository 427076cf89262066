"""Straight motion under a force that is fixed in the world (the caster of the paper's section 3).

The vehicle speeds up for ever, so ν has no steady motion; but there are headings it can keep. For an undamped vehicle
without gyroscopic term (its axle line runs through the centre of mass) θ'' = g·b(θ)/Λ, with
b(θ) = constant + cosine cos θ + sine sin θ as the core prepares it: headings where g·b = 0, stable where it falls.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from laconic.tools.analyse.from_core import Subject


@dataclass(frozen=True)
class PushedHeading:
    """A heading that the force lets the vehicle keep."""

    heading_rad: float
    rate_squared_per_s2: float  # s² of the small motions about it
    stable: bool

    @property
    def words(self) -> str:
        """For the report."""
        size = np.sqrt(abs(self.rate_squared_per_s2))
        if self.stable:
            return f"heading {np.degrees(self.heading_rad):.1f}°: stable, swings about it at {size:.4g} rad/s"
        return f"heading {np.degrees(self.heading_rad):.1f}°: unstable, leaves it with {size:.4g} 1/s"


def world_force_acts(subject: Subject) -> bool:
    """Whether the held inputs contain a force fixed in the world."""
    return any(subject.inputs.get(f"world_force_N[{k}]", 0.0) for k in (1, 2))


def headings(subject: Subject) -> list[PushedHeading] | None:
    """The headings that can be kept; None where damping or a gyroscopic term makes the question another one."""
    core, model = subject.core, subject.model
    forcing = core.ffi.new("laconic_forcing *")
    core.lib.laconic_forcing_of(forcing, model, core.input(subject.inputs))
    damped = core.numbers(model.decay_per_s)[: model.dof].any()
    if damped or np.abs(core.numbers(model.gyro)).max() > 1e-12 or not forcing.rotates:
        return None
    yaw = core.numbers(model.nu_of_zeta, 3, 3)[2] / float(model.yaw_scale)
    parts = (forcing.constant, forcing.cosine, forcing.sine)
    constant, cosine, sine = (float(yaw @ core.numbers(part)) for part in parts)
    size = np.hypot(cosine, sine)
    if size <= 1e-300 or abs(constant) > size:
        return []
    phase, open_angle = np.arctan2(sine, cosine), np.arccos(-constant / size)
    found = []
    for heading in (phase - open_angle, phase + open_angle):
        slope = -cosine * np.sin(heading) + sine * np.cos(heading)
        wrapped = float(np.mod(heading + 1e-9, 2.0 * np.pi) - 1e-9)
        found.append(PushedHeading(wrapped, float(slope), bool(slope < 0.0)))
    return sorted(found, key=lambda f: f.heading_rad)
