"""Whole vehicles on ground with friction that nothing drives, in both scalar types: is energy gained, does rest hold?

Passed when no step brings energy or a number that is not finite, when no bit changes of what rests below breakaway, and
when few steps are refused. A line of `wrong` names scalar type, seed and number of the vehicle, which make it again. A
minute takes some millions of steps.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import count as numbers
from typing import Any

from laconic.soak import StoppedEarly
from laconic.soak._turns import in_turns
from laconic.verification.friction.coasting import Coasted, coast, rest

SHARE = {"coasting, double": 0.5, "coasting, single": 0.3, "at rest, double": 0.1, "at rest, single": 0.1}
MOST_REFUSED = 1e-3
MOST_WRONG = 50


def soak(minutes: float, seed: int, advance: Callable[[float], None]) -> dict[str, Any]:
    """Half of the time for vehicles that coast in double, the rest for single and for those that rest."""
    counts = {name: Coasted() for name in SHARE}
    parts = {name: _part(name, seed, count) for name, count in counts.items()}
    try:
        in_turns(parts, SHARE, 60.0 * minutes, advance)
    except KeyboardInterrupt as stopped:
        raise StoppedEarly(_result(counts)) from stopped
    return _result(counts)


def _part(name: str, seed: int, count: Coasted) -> Iterator[None]:
    of, real = (coast if name.startswith("coasting") else rest), name.rpartition(" ")[2]
    for number in numbers():
        of([seed, number], count, real)
        yield


def _result(counts: dict[str, Coasted]) -> dict[str, Any]:
    wrong = [text for count in counts.values() for text in count.wrong]
    few = all(count.refused <= max(1.0, MOST_REFUSED * count.steps) for count in counts.values())
    texts = {name: count.text() for name, count in counts.items()}
    return {"passed": not wrong and few, **texts, "wrong": wrong[:MOST_WRONG]}
