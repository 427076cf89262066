"""The description of an FMU whose derivatives are those of the last communication step (vehicle/kept_step.c).

A step passes every input and state on to nearly every output, while at an instant most outputs depend on few of them.
One structure cannot state both, so this FMU is for Co-Simulation alone, and its outputs depend on everything.
"""

from __future__ import annotations

from .description import Description
from .reduced import EVERYTHING, reduced, without_model_exchange


def of_step(description: Description) -> Description:
    """The description for Co-Simulation with derivatives of its steps."""
    names = {v.reference: v.name for v in description.variables}
    unknowns = {names[u.reference]: EVERYTHING for u in description.unknowns if u.tag != "InitialUnknown"}
    return without_model_exchange(reduced(description, lambda v: True, unknowns))
