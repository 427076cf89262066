"""Are the errors of a run's stretches independent? Where neighbours are alike, the model lacks something.

Errors that keep their sign for a while (a floor that differs, a marker beside the middle, a wheel that slips in curves)
tell less than as many independent ones, so intervals from single stretches are too narrow. Then the score is summed
over blocks of stretches, up to whole runs and sessions, and the widest interval of all lengths counts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

LENGTHS = (2, 3, 4, 6, 8, 12)   # of blocks, in stretches; beyond: runs and sessions
SPARE = 3                       # blocks that there must be beside one for each parameter
LEAST_LIKENESS = 0.2            # correlation of neighbours below which it does not matter
DEVIATIONS = 3.5                # of chance, beyond which it is none


@dataclass(frozen=True)
class Structure:
    """How alike neighbouring stretches are, and what that does to the intervals."""

    likeness: float = 0.0       # correlation of the errors of neighbouring stretches
    is_found: bool = False      # it is no chance, and large enough to matter
    widening: float = 1.0       # largest factor by which an interval grew


def unexplained(errors: Sequence[np.ndarray], jacobians: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Errors less what parameters near the found ones would explain of them, which chance leaves in each curve alike.

    The parameters follow from whole paths, so stretches alone could be explained a little better. In units of each
    component's size; jacobians: stretches × components × parameters, in z.
    """
    size = np.sqrt(np.mean(np.concatenate(errors) ** 2, axis=0))
    size = np.where(size > 0.0, size, 1.0)
    whole = np.concatenate([(each / size[:, None]).reshape(-1, each.shape[2]) for each in jacobians])
    target = np.concatenate([(each / size).ravel() for each in errors])
    step = np.linalg.lstsq(whole, target, rcond=None)[0]
    return [each / size - (of_each / size[:, None]) @ step for each, of_each in zip(errors, jacobians, strict=True)]


def likeness_of(errors: Sequence[np.ndarray]) -> tuple[float, bool]:
    """(largest correlation of neighbours among the components, whether it is found); errors: stretches × components."""
    alike, size, pairs = (np.zeros(errors[0].shape[1]) for _ in range(3)) if errors else (np.zeros(1),) * 3
    for each in errors:
        alike += (each[1:] * each[:-1]).sum(axis=0)
        size += (each**2).sum(axis=0) * (len(each) - 1) / max(len(each), 1)
        pairs += max(len(each) - 1, 0)
    correlation = np.where(size > 0.0, alike / np.where(size > 0.0, size, 1.0), 0.0)
    found = (correlation > LEAST_LIKENESS) & (correlation * np.sqrt(np.maximum(pairs, 1)) > DEVIATIONS)
    return float(correlation.max(initial=0.0)), bool(found.any())


def block_sums(rows: Sequence[np.ndarray], sessions: Sequence[str], parameters: int) -> list[np.ndarray]:
    """The score's parts summed over longer and longer blocks, as long as enough of them are left."""
    every = [np.vstack([_summed(part, length) for part in rows]) for length in LENGTHS]
    of_runs = np.array([part.sum(axis=0) for part in rows])
    names = list(dict.fromkeys(sessions))
    of_sessions = np.array([sum(row for row, session in zip(of_runs, sessions, strict=True) if session == name)
                            for name in names])
    return [found for found in (*every, of_runs, of_sessions) if len(found) >= parameters + SPARE]


def _summed(rows: np.ndarray, length: int) -> np.ndarray:
    starts = np.arange(0, len(rows), length)
    found: np.ndarray = np.add.reduceat(rows, starts, axis=0)
    return found
