"""A description for one vehicle or one variant: with friction, sensors, supports, an estimate and derivatives of steps
where its start values, or the build, ask for them.

Sensors sample at internal steps, an estimate follows them, and derivatives of a step belong to one. Model Exchange has
no internal steps, so an FMU with any of these is one for Co-Simulation alone.
"""

from __future__ import annotations

from dataclasses import replace

from . import friction, slipping
from .description import Description
from .reduced import EVERYTHING, is_above_0, reduced, without_model_exchange


def for_vehicle(description: Description) -> Description:
    """The description without what its vehicle does not need."""
    of_estimate = for_estimate(slipping.without_slip(description))
    return friction.for_vehicle(for_sensors(for_supports(of_estimate)))


# ---- An error estimate (vehicle/estimate_part.c): its settings and outputs.

ESTIMATE_SWITCH = "estimate_error"
"""Above 0: the FMU estimates its error."""
ESTIMATE_START = "estimate"
"""How the names of all variables of the estimate begin."""


def with_estimate(description: Description) -> Description:
    """The description of an FMU that estimates its error unless it is told otherwise."""
    return replace(description, variables=tuple(
        replace(v, start=("true",)) if v.name == ESTIMATE_SWITCH else v for v in description.variables))


def without_estimate(description: Description) -> Description:
    """The description of an FMU that cannot."""
    if not any(v.name == ESTIMATE_SWITCH for v in description.variables):
        return description  # of another model
    return reduced(description, lambda v: not v.name.startswith(ESTIMATE_START))


def for_estimate(description: Description) -> Description:
    """The description without an estimate where none is asked for, else without Model Exchange."""
    if is_above_0(description, (ESTIMATE_SWITCH,)):
        return without_model_exchange(description)
    return without_estimate(description)


# ---- An IMU or encoders: their settings and outputs.

HAS_IMU, ENCODER_COUNTS = "has_imu", "encoder_counts_per_turn"
"""Above 0: the vehicle has an IMU; a wheel has an encoder."""
OF_IMU, OF_ENCODERS = "imu_", "encoder_"
"""How the names of all their other variables begin."""


def for_sensors(description: Description) -> Description:
    """The description without the sensors that its vehicle does not have."""
    if not any(v.name == HAS_IMU for v in description.variables):
        return description  # of another model
    has_imu, has_encoders = (is_above_0(description, (name,)) for name in (HAS_IMU, ENCODER_COUNTS))
    absent = tuple(start for start, there in ((HAS_IMU, has_imu), (OF_IMU, has_imu), (OF_ENCODERS, has_encoders))
                   if not there)
    found = reduced(description, lambda v: not v.name.startswith(absent))
    return without_model_exchange(found) if has_imu or has_encoders else found


# ---- Supports: their loads.

SUPPORT_COUNT, SUPPORT_LOAD = "support_count", "support_load_N"


def for_supports(description: Description) -> Description:
    """The description without what its vehicle does not need."""
    if is_above_0(description, (SUPPORT_COUNT,)) or not any(v.name == SUPPORT_LOAD for v in description.variables):
        return description
    return reduced(description, lambda v: v.name != SUPPORT_LOAD)


# ---- Derivatives of the last communication step (vehicle/kept_step.c). A step passes every input and state on to
# nearly every output, while at an instant most outputs depend on few of them. One structure cannot state both.

def of_step(description: Description) -> Description:
    """The description for Co-Simulation with derivatives of its steps."""
    names = {v.reference: v.name for v in description.variables}
    unknowns = {names[u.reference]: EVERYTHING for u in description.unknowns if u.tag != "InitialUnknown"}
    return without_model_exchange(reduced(description, lambda v: True, unknowns))
