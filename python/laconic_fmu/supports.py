"""What only FMUs of vehicles with supports have: the loads of these."""

from __future__ import annotations

from .description import Description
from .reduced import is_above_0, reduced

COUNT, LOAD = "support_count", "support_load_N"


def for_vehicle(description: Description) -> Description:
    """The description without what its vehicle does not need."""
    if is_above_0(description, (COUNT,)) or not any(v.name == LOAD for v in description.variables):
        return description
    return reduced(description, lambda v: v.name != LOAD)
