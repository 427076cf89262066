"""What only FMUs with an error estimate have (vehicle/estimate_part.c): its settings and outputs.

An estimate follows internal steps, which Model Exchange does not have, so such an FMU is one for Co-Simulation alone.
"""

from __future__ import annotations

from dataclasses import replace

from .description import Description
from .reduced import is_above_0, reduced, without_model_exchange

SWITCH = "estimate_error"
"""Above 0: the FMU estimates its error."""
START = "estimate"
"""How the names of all variables of the estimate begin."""


def with_estimate(description: Description) -> Description:
    """The description of an FMU that estimates its error unless it is told otherwise."""
    return replace(description, variables=tuple(
        replace(v, start=("true",)) if v.name == SWITCH else v for v in description.variables))


def without_estimate(description: Description) -> Description:
    """The description of an FMU that cannot."""
    if not any(v.name == SWITCH for v in description.variables):
        return description  # of another model
    return reduced(description, lambda v: not v.name.startswith(START))


def for_vehicle(description: Description) -> Description:
    """The description without an estimate where none is asked for, else without Model Exchange."""
    if is_above_0(description, (SWITCH,)):
        return without_model_exchange(description)
    return without_estimate(description)
