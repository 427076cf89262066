"""One named measure."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

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
