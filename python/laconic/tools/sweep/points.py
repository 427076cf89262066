"""Points of the unit cube that the distributions of a plan are sampled at."""

from __future__ import annotations

import warnings

import numpy as np

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
