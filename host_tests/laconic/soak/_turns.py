"""Parts of a long run that share its time."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator


def in_turns(parts: dict[str, Iterator[None]], share: dict[str, float], time_s: float,
             advance: Callable[[float], None]) -> None:
    """Takes the part that is furthest behind its share of the time, one item after the other."""
    spent = dict.fromkeys(parts, 0.0)
    while sum(spent.values()) < time_s:
        name = min(parts, key=lambda part: spent[part] / share[part])
        began = time.monotonic()
        next(parts[name])
        took = time.monotonic() - began
        spent[name] += took
        advance(took)
