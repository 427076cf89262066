"""A parameter that may move: its path in the scene, its nominal value, and how far it may be from that beforehand.

Parameters are values θ with a normal prior of the nominal values and a covariance; what is solved for is z, in which
the prior is the unit ball: θ = nominal + L z, L Lᵀ the covariance.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from laconic.robot.replay.steered_signals import Fitted, of_log

Vehicle = dict[str, Any]
"""The keys of `[vehicle]`, as a Scene has them."""


def _copied(value: Any) -> Any:
    """A copy of tables and lists in each other. Fits make thousands, for which copy.deepcopy is slow."""
    if isinstance(value, dict):
        return {key: _copied(each) for key, each in value.items()}
    return [_copied(each) for each in value] if isinstance(value, list) else value


@dataclass(frozen=True)
class Parameter:
    """One number; `write` sets it in a vehicle (angles in rad, wheels in x and y)."""

    name: str                                    # "radius of wheel 1"
    path: str                                    # "vehicle.wheel[1].radius_m"
    group: str                                   # what --free calls it
    unit: str
    nominal: float
    prior_sd: float                              # its own, independent of the others'
    write: Callable[[Vehicle, float], None]
    shared_sd: float = 0.0                       # that it has in common with the others of its group
    low: float = -math.inf                       # bounds of what is possible
    high: float = math.inf


@dataclass(frozen=True)
class Parameters:
    """Several, with their prior."""

    each: tuple[Parameter, ...]

    def __len__(self) -> int:
        return len(self.each)

    @property
    def nominal(self) -> np.ndarray:
        """Nominal values."""
        return np.array([p.nominal for p in self.each])

    @property
    def covariance(self) -> np.ndarray:
        """Of the prior."""
        found = np.diag([p.prior_sd**2 for p in self.each])
        for i, one in enumerate(self.each):
            for j, other in enumerate(self.each):
                if one.group == other.group:
                    found[i, j] += one.shared_sd * other.shared_sd
        return found

    @property
    def factor(self) -> np.ndarray:
        """L."""
        return np.linalg.cholesky(self.covariance) if self.each else np.zeros((0, 0))

    def values(self, z: np.ndarray) -> np.ndarray:
        """θ of z, within what is possible."""
        found: np.ndarray = np.clip(self.nominal + self.factor @ z, [p.low for p in self.each],
                                    [p.high for p in self.each])
        return found

    def at_bounds(self, values: np.ndarray) -> list[str]:
        """Names of those that lie at a bound."""
        return [p.name for p, value in zip(self.each, values, strict=True) if value in (p.low, p.high)]

    def vehicle(self, base: Mapping[str, Any], values: np.ndarray) -> Vehicle:
        """A copy of the vehicle with these values in it, written in order."""
        vehicle = Fitted(_copied(dict(base)), of_log(base))
        for parameter, value in zip(self.each, values, strict=True):
            parameter.write(vehicle, float(value))
        return vehicle

    def without(self, names: Sequence[str]) -> Parameters:
        """The others."""
        return Parameters(tuple(p for p in self.each if p.name not in names))
