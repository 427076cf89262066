"""The methods of integration, in the order of their numbers."""

from __future__ import annotations

METHODS = ("auto", "rk4", "exponential-kahan", "exponential-kahan-4", "exact-flow", "exact-flow-4", "taylor-8",
           "exponential-gauss-8")
