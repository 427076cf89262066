"""What a robot's file says of gravity and a scene has not: another direction or strength, parts without weight."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

DOWN = np.cos(np.radians(0.1))  # as far as this from −z, gravity is along it
OF_EARTH_M_PER_S2, WITHIN = 9.80665, 0.02  # between −9.8 and −9.832 at the poles there is no difference to tell


def gravity_left_out(gravity_m_per_s2: Sequence[float], weightless: Sequence[str]) -> list[str]:
    """A remark for each; `weightless` are links or bodies that the file takes gravity from. Without any gravity,
    nothing of it matters."""
    strength = float(np.linalg.norm(gravity_m_per_s2))
    told, remarks = " ".join(f"{each:g}" for each in gravity_m_per_s2), []
    if strength == 0.0:
        return []
    if -gravity_m_per_s2[2] < DOWN * strength:
        remarks.append(f"gravity ({told}) m/s² is not along -z, which is not taken over; a slope is [ground] slope_deg")
    elif abs(strength / OF_EARTH_M_PER_S2 - 1.0) > WITHIN:
        remarks.append(f"gravity ({told}) m/s² is not taken over: wheels bear their loads at {OF_EARTH_M_PER_S2} m/s²")
    if weightless:
        remarks.append(f"what has no weight in the file has its weight in a scene: {listed(weightless)}")
    return remarks


def listed(names: Sequence[str]) -> str:
    """The first of them, and how many more there are."""
    return ", ".join(names[:6]) + (f" and {len(names) - 6} more" if names[6:] else "")
