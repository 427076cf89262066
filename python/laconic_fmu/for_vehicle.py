"""A description for one vehicle: with friction, sensors and an estimate only where its start values have them."""

from __future__ import annotations

from . import estimate, friction, sensors
from .description import Description


def for_vehicle(description: Description) -> Description:
    """The description without what its vehicle does not need."""
    return friction.for_vehicle(sensors.for_vehicle(estimate.for_vehicle(description)))
