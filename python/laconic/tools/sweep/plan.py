"""The plan of a sweep: which values the varied keys have in each run. A run is a pure function of plan and index.

Grids and lists make a product, the last `--vary` running fastest. Distributions are sampled together, N samples in
all. With both, each point of the grid takes the same N samples, one after the other.

Points of the unit cube that the distributions of a plan are sampled at.
"""

from __future__ import annotations

import hashlib
import json
import math
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from laconic.errors import BadInput
from laconic.scene.key_path import check_apart
from laconic.scene.scene_tables import SceneTables, Value
from laconic.tools.measures import Measure, measure_given
from laconic.tools.sweep.varied import Varied, read_varied

SAMPLINGS = {"sobol": "quasi-random, scrambled Sobol'", "latin": "Latin hypercube", "random": "pseudo-random",
             "saltelli": "Saltelli's design for Sobol' indices"}


def saltelli_count(samples: int, keys: int) -> int:
    """Runs of Saltelli's design without second-order indices."""
    return samples * (keys + 2)


def unit_points(sampling: str, samples: int, keys: int, seed: int) -> np.ndarray:
    """(points, keys) of [0, 1): the same for the same arguments."""
    if keys == 0:
        return np.zeros((1, 0))
    if sampling == "random":
        return np.random.default_rng(seed).random((samples, keys))
    if sampling == "saltelli":
        return _saltelli(samples, keys, seed)
    from scipy.stats import qmc
    if sampling == "latin":
        return np.asarray(qmc.LatinHypercube(keys, seed=seed).random(samples))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that a count is no power of 2 costs some of the evenness, nothing else
        return np.asarray(qmc.Sobol(keys, seed=seed).random(samples))


def problem_of(keys: list[str]) -> dict[str, object]:
    """SALib's description of keys with values of [0, 1)."""
    return {"num_vars": len(keys), "names": keys, "bounds": [[0.0, 1.0]] * len(keys)}


def _saltelli(samples: int, keys: int, seed: int) -> np.ndarray:
    from SALib.sample import sobol
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return np.asarray(sobol.sample(problem_of([str(key) for key in range(keys)]), samples,
                                       calc_second_order=False, scramble=True, seed=seed))


FORMAT = 1
MOST_RUNS = 10**9
USUAL_MEASURES = ("end_x_m", "end_y_m", "end_heading_rad")


@dataclass(frozen=True)
class Plan:
    """All that decides what a sweep's runs are."""

    tables: SceneTables
    varied: tuple[Varied, ...]
    measures: tuple[Measure, ...]
    samples: int = 1           # of the distributions; base samples where they are Saltelli's
    seed: int = 0
    sampling: str = "sobol"    # a word of SAMPLINGS
    scene: str = ""            # as it was given

    @property
    def grid(self) -> list[Varied]:
        """Those with given values."""
        return [each for each in self.varied if not each.is_random]

    @property
    def drawn(self) -> list[Varied]:
        """Those with distributions."""
        return [each for each in self.varied if each.is_random]

    @property
    def is_saltelli(self) -> bool:
        """Whether the samples are those of Sobol' indices."""
        return self.sampling == "saltelli"

    @property
    def points(self) -> int:
        """Runs at each point of the grid."""
        if not self.drawn:
            return 1
        return saltelli_count(self.samples, len(self.drawn)) if self.is_saltelli else self.samples

    @property
    def runs(self) -> int:
        """How many there are."""
        return self.points * math.prod(len(each.levels) for each in self.grid)

    @cached_property
    def _drawn_values(self) -> dict[str, np.ndarray]:
        unit = unit_points(self.sampling, self.samples, len(self.drawn), self.seed)
        return {each.key.text: each.drawn(unit[:, column]) for column, each in enumerate(self.drawn)}

    def values(self, first: int, count: int) -> dict[str, np.ndarray]:
        """By key, in the order of `--vary`: values of runs `first` …; words and flags as objects."""
        return self.values_at(np.arange(first, first + count))

    def values_at(self, index: np.ndarray) -> dict[str, np.ndarray]:
        """The same of these runs."""
        place, sample = index // self.points, index % self.points
        of_grid: dict[str, np.ndarray] = {}
        for each in reversed(self.grid):
            levels = np.array(each.levels, object if isinstance(each.levels[0], str | bool | int) else float)
            of_grid[each.key.text] = levels[place % len(levels)]
            place = place // len(levels)
        return {each.key.text: self._drawn_values[each.key.text][sample] if each.is_random else of_grid[each.key.text]
                for each in self.varied}

    def of_run(self, index: int) -> dict[str, Value]:
        """The varied keys of one run."""
        return {key: values.tolist()[0] if isinstance(values, np.ndarray) else values[0]
                for key, values in self.values(index, 1).items()}

    def as_json(self) -> dict[str, Any]:
        """All of it, for the folder of results and for workers."""
        return {"format": FORMAT, "scene": self.scene, "path": str(self.tables.path), "tables": self.tables.entries,
                "vary": [each.text for each in self.varied], "measures": [each.text for each in self.measures],
                "samples": self.samples, "seed": self.seed, "sampling": self.sampling}

    @cached_property
    def digest(self) -> str:
        """Of all that decides the results; the name of the scene's file is not among it."""
        told = {key: value for key, value in self.as_json().items() if key not in ("scene", "path")}
        return hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()


def plan_from(told: Mapping[str, Any]) -> Plan:
    """The plan that `as_json` told."""
    from pathlib import Path
    return Plan(SceneTables(Path(told["path"]), told["tables"]), tuple(read_varied(text) for text in told["vary"]),
                tuple(measure_given(text) for text in told["measures"]), told["samples"], told["seed"],
                told["sampling"], told["scene"])


def make_plan(tables: SceneTables, vary: tuple[str, ...], measures: tuple[str, ...], *, samples: int | None = None,
              seed: int = 0, sampling: str = "sobol", scene: str = "") -> Plan:
    """The plan of a command line; BadInput names the option that does not fit."""
    if not vary:
        raise BadInput("--vary: is missing; give KEY=a:b:n, KEY=a,b,c or KEY~normal(m,s)")
    varied = tuple(read_varied(text) for text in vary)
    check_apart("--vary", [each.key for each in varied])
    is_random = any(each.is_random for each in varied)
    if is_random and samples is None:
        raise BadInput("--samples: is missing; a key has a distribution, so give the number of samples")
    if samples is not None and not is_random:
        raise BadInput(f"--samples {samples}: no key has a distribution; leave it out, or give KEY~normal(m,s)")
    if sampling == "saltelli" and any(not each.is_random for each in varied):
        raise BadInput("--sensitivity: needs a distribution of each key, such as KEY~uniform(a,b); take grids out")
    assert sampling in SAMPLINGS
    chosen = {(measure := measure_given(text)).text: measure for text in measures or USUAL_MEASURES}
    plan = Plan(tables, varied, tuple(chosen.values()), samples or 1, seed, sampling, scene)
    if plan.runs > MOST_RUNS:
        raise BadInput(f"--vary: makes {plan.runs} runs; give {MOST_RUNS} or fewer")
    return plan
