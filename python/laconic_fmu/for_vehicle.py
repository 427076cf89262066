"""A description for one vehicle: with friction, sensors, supports and an estimate where its start values have them."""

from __future__ import annotations

from . import estimate, friction, sensors, slipping, supports
from .description import Description


def for_vehicle(description: Description) -> Description:
    """The description without what its vehicle does not need."""
    of_estimate = estimate.for_vehicle(slipping.without_slip(description))
    return friction.for_vehicle(sensors.for_vehicle(supports.for_vehicle(of_estimate)))
