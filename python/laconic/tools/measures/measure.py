"""One named measure.

What a measure is about and a scene may lack.

Runs side by side as a measure sees them: signals at the instants of the run, one column for each vehicle.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from laconic.scene import Scene
from laconic.scene.reference import unit_of

OF_MODEL, OF_RUN = "model", "run"


@dataclass(frozen=True)
class Measure:
    """A number of each vehicle; `of` takes what it is of and gives (lanes,), NaN where a vehicle has none.

    A measure of a run takes a Course with the named signals; one of a model needs no run, and takes what its file says.
    """

    name: str                         # with its unit at its end: unit
    words: str                        # one line
    of: Callable[[Any], np.ndarray]
    kind: str = OF_RUN
    signals: tuple[str, ...] = ()     # outputs and inputs of the scene, without an index
    is_of_end: bool = False           # reads the last instant alone
    is_beside_nominal: bool = False   # reads the nominal run, too
    needs: str = ""                   # what a scene must have: "motor", "supply", "friction coefficient", "wheels"

    @property
    def text(self) -> str:
        """As it is given and written: the name, of some with arguments."""
        return self.name

    @property
    def unit(self) -> str:
        """"m/s" of largest_speed_m_per_s; empty for a ratio."""
        return unit_of(self.name)


def lacks(measure: Measure, scene: Scene) -> str:
    """What the measure needs and the scene has not, in words; empty where it has all."""
    vehicle = scene.vehicle
    ground = vehicle.get("ground", {})
    has = {"": True, "motor": "motor" in vehicle, "wheels": bool(vehicle["wheel"]),
           "supply": bool(vehicle.get("drive", {}).get("supply_V")),
           "friction coefficient": bool(vehicle["friction_coefficient"] or ground.get("friction_coefficient"))}
    words = {"motor": "[vehicle.motor]", "wheels": "wheels", "supply": "vehicle.drive.supply_V",
             "friction coefficient": "vehicle.friction_coefficient"}
    return "" if has[measure.needs] else words[measure.needs]


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
