"""Inputs that are held, of many runs whose values differ: the numbers of each signal from a step on."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from laconic.batch import Batch
from laconic.scene.inputs import InputsOnGrid

Given = Mapping[tuple[str, int], np.ndarray]
"""By the location of an input and the place of a value in its list, from 0: that value in each run."""


class HeldInputs:
    """What `InputsOnGrid` has of one scene, with some values that differ from run to run; the same sums, bit by bit."""

    def __init__(self, grid: InputsOnGrid, given: Given):
        self._grid, self._given = grid, given

    def changes(self) -> tuple[int, ...]:
        """The steps at whose start some input changes, the first step among them."""
        return self._grid.changes

    def at(self, tick: int) -> dict[str, np.ndarray]:
        """By signal: one number for all runs, or one for each."""
        found = {signal: np.zeros(()) for signal in self._grid.signals}
        for each in self._grid.given:
            place = int(np.searchsorted(self._grid.ticks_of(each), tick, side="right"))
            own = self._given.get((each.location, place - 1))
            level = np.asarray(self._grid.levels_of(each)[place]) if own is None else own
            found[each.signal] = found[each.signal] + level
        return found

    def set_into(self, batch: Batch, tick: int) -> None:
        """Gives the batch what acts from the start of a step on."""
        for signal, values in self.at(tick).items():
            name, _, item = signal.partition("[")
            row = getattr(batch, name)
            with np.errstate(over="ignore"):  # the core names a number that is too large for its scalar type
                row[int(item[:-1]) - 1 if item else ...] = values
