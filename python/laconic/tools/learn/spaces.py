"""The spaces of one robot, and seeds for many."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.spaces import Box
from gymnasium.utils import seeding

from laconic.core.given import shown, whole_number
from laconic.errors import BadInput
from laconic.tools.learn.task import OBSERVATION


def action_space(wheel_count: int) -> Box:
    """A share of the largest voltage for each wheel."""
    return Box(-1.0, 1.0, (wheel_count,), np.float32)


def observation_space() -> Box:
    """Of laconic.tools.learn.task.OBSERVATION: sine and cosine are bounded, the rest by physics alone."""
    high = np.array([1.0 if name.startswith(("cos_", "sin_")) else np.inf for name in OBSERVATION], np.float32)
    return Box(-high, high, dtype=np.float32)


def generators_of(seed: int | Sequence[int | None] | None, lanes: int) -> list[np.random.Generator]:
    """One for each lane; of one seed lane k has seed + k, as in Gymnasium's own vector environments."""
    if seed is None or isinstance(seed, int | np.integer):
        first = None if seed is None else checked_seed("seed", seed)
        seeds: list[int | None] = [None if first is None else first + lane for lane in range(lanes)]
    elif isinstance(seed, str) or not isinstance(seed, Sequence | np.ndarray):
        raise BadInput(f"seed: {shown(seed)} is no seed; give a whole number, a list of one for each environment, or "
                       "None")
    else:
        seeds = [None if each is None else checked_seed(f"seed[{lane}]", each) for lane, each in enumerate(seed, 1)]
    if len(seeds) != lanes:
        raise BadInput(f"seed: {len(seeds)} seeds for {lanes} environments; give one for each, or one number")
    return [seeding.np_random(each)[0] for each in seeds]


def check_open(what: str, is_closed: bool) -> None:
    """BadInput where close() was called."""
    if is_closed:
        raise BadInput(f"{what}: this environment is closed; make another one")


def checked_seed(name: str, given: Any) -> int:
    """A seed that Gymnasium takes."""
    seed = whole_number(name, given)
    if seed < 0:
        raise BadInput(f"{name}: {seed} is below 0; give a whole number from 0 on")
    return seed
