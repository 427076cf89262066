"""The convex problem of one friction step, in the units of the core: energies over M R², speeds in rad/s.

    min over ν, s of  ½|ν − ν*|² + Σ_i [ ½ j (s − s*)² + D(s) + ½ viscous s² + axle |s| + grip |slip| ]
    slip_i = (along·ν − rim_along s, k (across·ν − rim_across s))
    D'(s) = −clamp(drive − drive_slope s, ± drive_limit)

The unknown z = (ν1, ν2, ν3, s_1 … s_N) has the masses (1, 1, 1, j_1 … j_N).
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

Numbers = np.ndarray


@dataclass(frozen=True)
class StepProblem:
    """Data of one step; one row or item a wheel. Infinite grip: a rigid contact; infinite drive_limit: no limit."""

    along: Numbers         # N × 3: the contact point's velocity over R along the roller axis, for ν
    across: Numbers        # N × 3: the same across it
    rim_along: Numbers     # what wheel speed takes off the velocity along
    rim_across: Numbers
    inertia: Numbers       # j = J/(M R²)
    drag: Numbers          # k
    grip: Numbers          # h μ N/(M R)
    axle: Numbers          # h T/(M R²)
    drive: Numbers         # motor impulse at s = 0
    drive_slope: Numbers
    drive_limit: Numbers
    viscous: Numbers
    free_speed: Numbers    # s*
    free_nu: Numbers       # ν*

    @property
    def wheels(self) -> int:
        """N."""
        return len(self.inertia)

    def slip_rows(self) -> Numbers:
        """N × 2 × (3 + N): slip of each contact for z; the second row of a contact is zero where k = 0."""
        rows = np.zeros((self.wheels, 2, 3 + self.wheels))
        rows[:, 0, :3], rows[:, 1, :3] = self.along, self.drag[:, None] * self.across
        each = np.arange(self.wheels)
        rows[each, 0, 3 + each], rows[each, 1, 3 + each] = -self.rim_along, -self.drag * self.rim_across
        return rows

    def masses(self) -> Numbers:
        """The masses of z, without damping."""
        return np.concatenate([np.ones(3), self.inertia])

    def drive_impulse(self, speed: Numbers) -> Numbers:
        """What the motors give at these wheel speeds, viscous friction apart."""
        return np.clip(self.drive - self.drive_slope * speed, -self.drive_limit, self.drive_limit)

    def energy(self, z: Numbers) -> float:
        """What the step minimises, at z."""
        z = np.asarray(z, float)
        speed, far = z[3:], z - np.concatenate([self.free_nu, self.free_speed])
        slip = np.einsum("ndz,z->nd", self.slip_rows(), z)
        if np.any(np.isinf(self.grip) & (np.hypot(*slip.T) > 1e-12)):
            return np.inf
        grip = np.where(np.isinf(self.grip), 0.0, self.grip)
        return float(0.5 * far @ (self.masses() * far) + self._motor_energy(speed).sum()
                     + 0.5 * self.viscous @ speed**2 + self.axle @ np.abs(speed) + grip @ np.hypot(*slip.T))

    def _motor_energy(self, speed: Numbers) -> Numbers:
        """D(s) with D(0) = 0: the integral of the clamp, in three straight and curved pieces."""
        def primitive(free: Numbers) -> Numbers:
            inner = np.clip(free, -self.drive_limit, self.drive_limit)
            outer = np.abs(free) - np.abs(inner)
            return 0.5 * inner**2 + np.where(outer > 0.0, outer * np.abs(inner), 0.0)
        slope = np.where(self.drive_slope > 0.0, self.drive_slope, 1.0)
        held = -np.clip(self.drive, -self.drive_limit, self.drive_limit) * speed
        clamped = (primitive(self.drive - self.drive_slope * speed) - primitive(self.drive)) / slope
        return np.where(self.drive_slope > 0.0, clamped, held)

    def save(self, path: Path, **more: Any) -> None:
        """Writes a case to a small file; numbers keep all their bits."""
        data = {name: value.tolist() for name, value in asdict(self).items()}
        path.write_text(json.dumps(data | more, indent=1) + "\n")

    @staticmethod
    def load(path: Path) -> StepProblem:
        """A case from its file."""
        data = json.loads(path.read_text())
        return StepProblem(**{name: np.array(data[name], float) for name in StepProblem.__dataclass_fields__})
