"""What only FMUs of scenes with an IMU or encoders have: their settings and outputs.

Sensors sample at internal steps, which Model Exchange does not have, so such an FMU is one for Co-Simulation alone.
"""

from __future__ import annotations

from .description import Description
from .reduced import is_above_0, reduced, without_model_exchange

HAS_IMU, COUNTS = "has_imu", "encoder_counts_per_turn"
"""Above 0: the vehicle has an IMU; a wheel has an encoder."""
OF_IMU, OF_ENCODERS = "imu_", "encoder_"
"""How the names of all their other variables begin."""


def for_vehicle(description: Description) -> Description:
    """The description without the sensors that its vehicle does not have."""
    if not any(v.name == HAS_IMU for v in description.variables):
        return description  # of another model
    has_imu, has_encoders = (is_above_0(description, (name,)) for name in (HAS_IMU, COUNTS))
    absent = tuple(start for start, there in ((HAS_IMU, has_imu), (OF_IMU, has_imu), (OF_ENCODERS, has_encoders))
                   if not there)
    found = reduced(description, lambda v: not v.name.startswith(absent))
    return without_model_exchange(found) if has_imu or has_encoders else found
