"""Measures of runs for many choices at once: those of a sweep, whose runs step side by side in a batch."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from laconic.errors import BadInput
from laconic.scene.key_path import key_path
from laconic.scene.scene_tables import SceneTables
from laconic.tools.measures.measure import Measure
from laconic.tools.optimise.candidates import values_of
from laconic.tools.optimise.problem import Free
from laconic.tools.sweep.chunk import nominal_course, run_chunk
from laconic.tools.sweep.plan import Plan
from laconic.tools.sweep.varied import Varied


class Runs:
    """The scene's run with other numbers; `nominal`: that of the scene as it is, where a measure looks at it."""

    def __init__(self, tables: SceneTables, free: Sequence[Free], measures: Sequence[Measure]):
        varied = tuple(Varied(key, key_path(key), (each.low, each.high)) for each in free for key in each.keys)
        self.free, self.plan = free, Plan(tables, varied, tuple(measures))
        self.nominal = nominal_course(self.plan)

    def measured(self, choices: np.ndarray) -> np.ndarray:
        """(L, measures) of choices (L, p); NaN where a run is refused."""
        columns = values_of(self.free, choices.T)
        return run_chunk(self.plan, self.nominal, columns).measures.T

    def refusal(self, choice: np.ndarray) -> BadInput | None:
        """Why a choice has no run; None where it has one."""
        reasons = run_chunk(self.plan, self.nominal, values_of(self.free, choice[:, None])).reasons
        return BadInput(f"{self.plan.tables.path}: {reasons[0].reason}") if reasons else None
