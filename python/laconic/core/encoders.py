"""Settings of encoders: read by the same rules from a scene's [sensors.encoder], for Plant.sensors, and for Filter.

In the core's struct 0 counts are no encoder, a gear ratio of 0 is 1, and a wrap of 0 is 32 bits; whoever writes such a
0 means something else, so it is refused here. A wrap of 2³² is 32 bits, too, shown without a sign.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping
from typing import Any, NoReturn

import numpy as np

from laconic.core.given import finite_number, is_real, shown
from laconic.errors import BadInput

COUNTS, GEAR, WRAP = KEYS = ("counts_per_turn", "gear_ratio", "wrap")
NO_ENCODER = False  # in a list of counts: a wheel without an encoder
LEAST_INTEGER, MOST_INTEGER = -(2**31), 2**31 - 1
WHOLE_COUNT = 2**32  # wrap of an unsigned counter of 32 bits; the core shows the same bits as numbers with sign
A_COUNT = "a whole number, or a list with one for each wheel, false for none"

Fail = Callable[[str, str], NoReturn]
"""Raises BadInput for a key, with a message."""


def failing(name: str) -> Fail:
    """For tables that no file has."""
    def fail(key: str, message: str) -> NoReturn:
        raise BadInput(f"{name}.{key}: {message}")
    return fail


def read_encoders(given: Mapping[str, Any], wheel_count: int, fail: Fail) -> dict[str, Any]:
    """What is given of `KEYS`, checked; lists have an entry for each wheel, counts of 0 for one without an encoder."""
    if wheel_count == 0:
        fail(COUNTS, "counts turns of wheels, and the vehicle has none; leave the encoders out")
    if COUNTS not in given:
        fail(COUNTS, f"is missing; give it as {A_COUNT}")
    counts = _counts(given[COUNTS], wheel_count, fail)
    found: dict[str, Any] = {COUNTS: counts}
    if GEAR in given:
        found[GEAR] = _gears(given[GEAR], counts, fail)
    if WRAP in given:
        found[WRAP] = _wrap(given[WRAP], fail)
    return found


def _counts(given: Any, wheel_count: int, fail: Fail) -> tuple[int, ...]:
    listed = _listed(given)
    many = [given] * wheel_count if listed is None else listed
    if len(many) != wheel_count:
        fail(COUNTS, f"has {len(many)} entries; give one number, or one for each of the {wheel_count} wheels, false "
             "for a wheel without an encoder")
    counts = tuple(_count(each, listed is not None, fail) for each in many)
    if not any(counts):
        fail(COUNTS, "gives no wheel an encoder; leave the encoders out")
    return counts


def _count(given: Any, is_of_list: bool, fail: Fail) -> int:
    if is_of_list and isinstance(given, bool | np.bool_) and not given:
        return 0
    count = _whole(COUNTS, given, A_COUNT, fail)
    if count <= 0:
        fail(COUNTS, f"is {shown(count)}; give a number above 0{', false for none' * is_of_list}")
    return count


def _gears(given: Any, counts: tuple[int, ...], fail: Fail) -> tuple[float, ...]:
    """Turns of the encoder for one of the wheel, an entry for each wheel."""
    listed, encoders = _listed(given), sum(map(bool, counts))
    values = [_gear(each, fail) for each in ([given] * len(counts) if listed is None else listed)]
    if len(values) == encoders < len(counts):
        rest = iter(values)
        values = [next(rest) if count else 1.0 for count in counts]
    if len(values) != len(counts):
        fail(GEAR, f"has {len(values)} entries; give one number, or {encoders}, one for each encoder")
    return tuple(values)


def _gear(given: Any, fail: Fail) -> float:
    try:
        value = finite_number(GEAR, given)
    except BadInput:
        fail(GEAR, f"{shown(given)} is no finite number; give a number, or a list with one for each encoder")
    if value == 0.0:
        fail(GEAR, "is 0; give another number, below 0 for an encoder that counts backwards")
    return value


def is_unsigned(given: Mapping[str, Any]) -> bool:
    """Whether encoders with these settings show numbers from 0 to 2³² − 1."""
    return given.get(WRAP) == WHOLE_COUNT


def core_wrap(wrap: int) -> int:
    """The wrap of the core's struct, whose integers have 32 bits with sign."""
    return 0 if wrap == WHOLE_COUNT else wrap


def unsigned(counts: np.ndarray) -> np.ndarray:
    """Counts of 32 bits with sign as those of an unsigned counter."""
    found: np.ndarray = np.where(counts < 0, counts + WHOLE_COUNT, counts)
    return found


def signed(counts: np.ndarray) -> np.ndarray:
    """The inverse of `unsigned`."""
    found: np.ndarray = np.where(counts > MOST_INTEGER, counts - WHOLE_COUNT, counts)
    return found


def _wrap(given: Any, fail: Fail) -> int:
    wrap = _whole(WRAP, given, "a whole number", fail, (WHOLE_COUNT,))
    if wrap < 2:
        fail(WRAP, f"is {shown(wrap)}; give the number of values that the counter has, such as 65536, or take it out "
             "for 32 bits")
    return wrap


def _whole(key: str, given: Any, what: str, fail: Fail, others: tuple[int, ...] = ()) -> int:
    """A whole number that the core has room for, or one of some others."""
    try:
        found = operator.index(given if is_real(given) else None)  # type: ignore[arg-type]  # which it refuses
    except TypeError:
        fail(key, f"is {str(given).lower() if isinstance(given, bool) else shown(given)}, not {what}")
    if not LEAST_INTEGER <= found <= MOST_INTEGER and found not in others:
        more = "".join(f", or {other}" for other in others)
        fail(key, f"is {shown(found)}; give a whole number of at most 32 bits, {LEAST_INTEGER} to {MOST_INTEGER}{more}")
    return int(found)


def _listed(given: Any) -> list[Any] | None:
    """The items of a list, tuple or array; None for anything else."""
    if isinstance(given, np.ndarray) and given.ndim == 1:
        return list(given)
    return list(given) if isinstance(given, list | tuple) else None
