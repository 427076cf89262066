"""The methods of integration, in the order of their numbers, and those that only a host's core has."""

from __future__ import annotations

METHODS = ("auto", "rk4", "exponential-kahan", "exponential-kahan-4", "exact-flow", "exact-flow-4", "taylor-8",
           "exponential-gauss-8")
ON_HOSTS = {
    "exponential-gauss-8":
        "Eighth order, any damping; refuses steps in which it yaws too far; FMUs and firmware images leave it out"}
"""Methods that FMUs and firmware images leave out for their size, with what they are."""
