"""The search over the whole ranges: SciPy's differential evolution, each generation measured side by side."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import NonlinearConstraint, differential_evolution

from laconic.errors import BadInput
from laconic.scene.key_path import key_path
from laconic.scene.scene_tables import SceneTables
from laconic.tools.measures.measure import Measure
from laconic.tools.optimise.archive import Archive
from laconic.tools.optimise.candidates import values_of
from laconic.tools.optimise.problem import Free
from laconic.tools.sweep.chunk import nominal_course, run_chunk
from laconic.tools.sweep.plan import Plan
from laconic.tools.sweep.varied import Varied

# ---- Measures of runs for many choices at once: those of a sweep, whose runs step side by side in a batch.

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


Loss = Callable[[np.ndarray], np.ndarray]
"""One number to make small from the goals' losses, (L, goals) → (L,)."""

RANDOM = "rng" if "rng" in inspect.signature(differential_evolution).parameters else "seed"  # renamed in SciPy 1.15


@dataclass(frozen=True)
class Effort:
    """How long a search goes on: generations at most, vehicles in each, and the spread of losses at which it ends."""

    generations: int = 300
    population: int = 0   # 0: 15 for each free number, 40 at least
    tolerance: float = 1e-11  # as a share of the losses' mean

    def between(self) -> Effort:
        """For a point of the front, whose search begins among all that was measured before."""
        return replace(self, generations=max(self.generations // 4, 1), tolerance=1e-9)

    def size(self, free: int) -> int:
        """Vehicles in a generation."""
        return self.population or max(15 * free, 40)


def search(archive: Archive, loss: Loss, effort: Effort, random: np.random.Generator, first: np.ndarray,
           each_generation: Callable[[], None] = lambda: None) -> None:
    """Fills the archive; `first`: shares (L, p) that the first generation has beside random ones."""
    problem = archive.problem
    count = len(problem.free)

    def of_losses(shares: np.ndarray) -> np.ndarray:
        found = loss(problem.losses(archive.measured(np.atleast_2d(shares.T))))
        return found if shares.ndim > 1 else found[0]

    def of_excesses(shares: np.ndarray) -> np.ndarray:
        found = problem.excesses(archive.measured(np.atleast_2d(shares.T)))
        return found.T if shares.ndim > 1 else found[0]

    bounds = NonlinearConstraint(of_excesses, -np.inf, 0.0)
    differential_evolution(
        of_losses, [(0.0, 1.0)] * count, maxiter=effort.generations, vectorized=True, updating="deferred", polish=False,
        constraints=bounds if problem.constraints else (), init=_population(effort.size(count), count, first, random),
        recombination=0.9, tol=effort.tolerance, callback=lambda *_, **__: each_generation(),
        **{RANDOM: random})


def _population(size: int, count: int, first: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """A Latin hypercube, its first members replaced by the given ones."""
    strata = np.stack([random.permutation(size) for _ in range(count)], axis=1)
    shares = (strata + random.random((size, count))) / size
    known = np.clip(first[: size // 2], 0.0, 1.0)
    shares[: len(known)] = known
    return shares
