"""The states of a vehicle under held voltages in 50 digits: as near to the truth as doubles can tell."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

import numpy as np

from laconic.tools.report.collocation import exact_start, true_states
from laconic.tools.verify.exact.trials import INPUTS


def exact_states(vehicle: Mapping[str, Any], nu: Sequence[float], stretches_V: Sequence[Sequence[float]],  # noqa: N803
                 cuts_s: Sequence[Sequence[Fraction]]) -> np.ndarray:
    """(ν, x, y, θ, χ) at instants, from the origin; `stretches_V`: the voltages of each stretch, `cuts_s`: its
    instants."""
    model, start = exact_start({key: value for key, value in vehicle.items() if key != "support"}, nu)
    helds = [held_voltages(each) for each in stretches_V]
    return np.array([[float(x) for x in row] for row in true_states(model, start, 0.0, helds, cuts_s)])


def held_voltages(voltages_V: Sequence[float]) -> dict[str, list[float]]:  # noqa: N803
    """Inputs with nothing but these voltages."""
    held = {name: [0.0] * (len(voltages_V) if name == "axle_torque_Nm" else 2) for name in INPUTS}
    return held | {"voltage_V": [float(x) for x in voltages_V], "body_moment_Nm": [0.0]}
