"""A replay whose path is far off: one line that says so, and what of the map or the scene is probably wrong.

What would mend it is tried: other signs, another order of the wheels, another size of a turn, steering the other way.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations
from typing import Any

import numpy as np

from laconic.errors import BadInput, Refused
from laconic.robot.logs import Log
from laconic.robot.logs.log import MEMBERS
from laconic.robot.replay.measures import RunErrors, path_length
from laconic.robot.replay.predicted import predict
from laconic.scene import Scene

POOR = 0.1           # path error that no robot has whose wheels roll
NOISE = 5.0          # times the noise of the poses: what is less may be noise
MENDS = 0.3          # of the error: a change that leaves less is worth a word
SAME_LENGTH = 0.05   # of the way: other sizes of a turn are tried beyond it
MOST_WHEELS = 6      # whose orders are tried
USUAL = ("scene, or in the map the order and signs of the wheels, ticks_per_turn, gear_ratio or a unit; wheels that "
         "slip do it, too")


def words_of_poor(scene: Scene, logs: Sequence[Log], errors: Sequence[RunErrors], inputs: str) -> list[str]:
    """One sentence on the runs whose path is far off; none where there is no such run."""
    poor = [(each, log) for each, log in zip(errors, logs, strict=True) if _is_poor(each, log)]
    if not poor:
        return []
    worst, log = max(poor, key=lambda pair: pair[0].path_error or 0.0)
    error = worst.path_error or 0.0
    others = f" and {len(poor) - 1} other runs" if len(poor) > 1 else ""
    mended = _mended(scene, log, error, inputs)
    why = f"with {mended[0]} it would be {100.0 * mended[1]:.2g} %" if mended else f"check the {USUAL}"
    return [f"{worst.run}{others}: the fit is poor, {100.0 * error:.3g} % of the path; {why}"]


def _is_poor(errors: RunErrors, log: Log) -> bool:
    """Whether the error is far above that of robots, and above the noise of the poses."""
    if errors.path_error is None or log.pose is None or not errors.path_error > POOR:
        return False
    place = log.pose[log.seen, :2]
    bends = np.diff(place, n=2, axis=0)
    noise_m = float(np.sqrt((bends**2).sum(axis=1).mean() / 6.0)) if len(bends) else 0.0
    return errors.path_error * path_length(log.time_s[log.seen], place) > NOISE * noise_m


def _mended(scene: Scene, log: Log, error: float, inputs: str) -> tuple[str, float] | None:
    """(what would leave least of the error, what it would be); None where nothing that is tried mends it."""
    found: list[tuple[float, int, str]] = []
    for number, (what, changed) in enumerate([*_changes(log), *_longer(scene, log, inputs)]):
        try:
            (_, errors), = predict(scene, [changed], inputs)
        except (BadInput, Refused):
            continue
        if errors.path_error is not None and errors.path_error < MENDS * error:
            found.append((errors.path_error, number, what))
    best = min(found, default=None)
    return None if best is None else (best[2], best[0])


def _changes(log: Log) -> Iterator[tuple[str, Log]]:
    """Logs as they would be by another map."""
    count = next((value.shape[1] for name in MEMBERS.values() if (value := getattr(log, name)) is not None), 0)
    every = np.arange(count)
    if count:
        yield "the signs of all wheels reversed", _turned(log, every, -np.ones(count))
    if log.steering_angle_rad is not None:
        yield "the sign of the steering reversed", replace(log, steering_angle_rad=-log.steering_angle_rad)
    if count < 2 or count > MOST_WHEELS:
        return
    for number in range(count):
        yield f"the sign of wheel {number + 1} reversed", _turned(log, every, np.where(every == number, -1.0, 1.0))
    for one, other in combinations(range(count), 2):
        order = every.copy()
        order[[one, other]] = other, one
        yield f"wheels {one + 1} and {other + 1} exchanged", _turned(log, order, np.ones(count))
    if count > 2:
        yield "the order of the wheels reversed", _turned(log, every[::-1], np.ones(count))


def _longer(scene: Scene, log: Log, inputs: str) -> Iterator[tuple[str, Log]]:
    """The log whose wheels turn as much more as the true path is longer."""
    assert log.pose is not None
    (path, _), = predict(scene, [log], inputs)
    true, rolled = (path_length(log.time_s[log.seen], pose[log.seen]) for pose in (log.pose, path))
    count = next((value.shape[1] for name in MEMBERS.values() if (value := getattr(log, name)) is not None), 0)
    if count and rolled > 0.0 and abs(true / rolled - 1.0) > SAME_LENGTH:
        what = f"wheels that turn {true / rolled:.3g} times as far (ticks_per_turn, gear_ratio, unit or radius)"
        yield what, _turned(log, np.arange(count), np.full(count, true / rolled))


def _turned(log: Log, order: np.ndarray, factors: np.ndarray) -> Log:
    parts: dict[str, Any] = {name: value[:, order] * factors for name in MEMBERS.values()
                             if (value := getattr(log, name)) is not None}
    return replace(log, **parts)
