"""Runs side by side as a measure sees them: signals at the instants of the run, one column for each vehicle."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Course:
    """T instants of L runs, the start first and the end last; of measures of the end alone just these two."""

    time_s: np.ndarray                 # (T,)
    signals: Mapping[str, np.ndarray]  # (T, L), or (T, items, L) of a signal with an index
    nominal: Course | None = None      # the scene as its file is, at the same instants, L = 1
    winding: Winding | None = None     # None: the scene has no [vehicle.motor]

    def __getitem__(self, signal: str) -> np.ndarray:
        """A signal by its name without an index."""
        return self.signals[signal]

    @property
    def beside(self) -> Course:
        """The nominal run."""
        assert self.nominal is not None, "a measure beside the nominal run says so by its `is_beside_nominal`"
        return self.nominal


@dataclass(frozen=True)
class Winding:
    """The motors' windings seen from the wheels, of each vehicle."""

    resistance_ohm: np.ndarray       # (L,)
    back_emf_Vs_per_rad: np.ndarray  # (L,)  k_e n: voltage per speed of the wheel
    driven: np.ndarray               # (wheels, L)  1 where a wheel's motor is connected to its controller, else 0

    def currents_A(self, course: Course) -> np.ndarray:  # noqa: N802 (the unit)
        """(T, wheels, L): those of the core where drives have limits, else (U − k_e n χ') / R_a."""
        if "motor_current_A" in course.signals:
            return course["motor_current_A"]
        volts = course["voltage_V"] - self._back_emf_V(course)
        found: np.ndarray = self.driven * volts / self.resistance_ohm
        return found

    def powers_W(self, course: Course) -> np.ndarray:  # noqa: N802
        """(T, wheels, L): what each winding takes, (R_a I + k_e n χ') I."""
        current = self.currents_A(course)
        return (self.resistance_ohm * current + self._back_emf_V(course)) * current

    def _back_emf_V(self, course: Course) -> np.ndarray:  # noqa: N802
        return self.back_emf_Vs_per_rad * course["wheel_speed_rad_per_s"]
