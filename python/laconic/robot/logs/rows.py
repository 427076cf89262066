"""The rows of a log where its quantities were recorded at different instants: joined topics, frames of a bus.

A quantity that flows (angles, speeds, currents, poses) is interpolated between its samples; one that a controller holds
(voltages, set speeds) is held. Rows before the first sample of a quantity or after the last one are left out.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from laconic.robot.logs.log import LEAST_SAMPLES, counted

HELD = ("voltage", "set_speed", "speed")
WORTH = 0.5             # of the rows: a quantity that may be absent and leaves fewer is left out itself


@dataclass(frozen=True)
class Sampled:
    """A quantity at all samples of a table; NaN: not recorded there."""

    name: str
    values: np.ndarray          # samples × columns
    is_optional: bool = False
    is_command: bool = False

    @property
    def is_held(self) -> bool:
        """Whether it keeps its value until the next sample."""
        return self.is_command or self.name in HELD

    @property
    def has_gaps(self) -> bool:
        """Whether it lacks values."""
        return bool(np.isnan(self.values).any())


@dataclass(frozen=True)
class Chosen:
    """The rows of the log, by the table's samples, and the quantities at them."""

    rows: np.ndarray
    values: dict[str, np.ndarray]
    remarks: tuple[str, ...]


def choose(time_s: np.ndarray, quantities: Sequence[Sampled], is_row: np.ndarray | None, hold_s: float,
           lines: Callable[[np.ndarray], str] | None, *, tells_gaps: bool = True) -> Chosen:
    """Rows at which all quantities are known. `hold_s`: a younger sample is taken as it is; `lines`: names samples for
    remarks, None: there are none to make; `tells_gaps`: a remark states how much was filled in."""
    rows = np.arange(len(time_s)) if is_row is None else np.flatnonzero(is_row)
    remarks: list[str] = []
    kept = list(quantities)
    known = {each.name: _known(time_s, each, rows, hold_s) for each in kept}
    for each in [each for each in kept if each.is_optional and each.has_gaps]:
        others = np.all([known[other.name] for other in kept if other is not each], axis=0)
        most = max(LEAST_SAMPLES, WORTH * others.sum())
        if (others & known[each.name]).sum() < most and len(kept) > 1:
            kept.remove(each)
            remarks.append(f"{each.name} is left out: it is known at {int((others & known[each.name]).sum())} of "
                           f"{int(others.sum())} rows")
    usable = np.all([known[each.name] for each in kept], axis=0) if kept else np.full(len(rows), True)
    if lines is not None:
        remarks += [_gaps(time_s, each) for each in kept if each.has_gaps and tells_gaps]
        if not usable.all():
            remarks.append(f"{lines(rows[~usable])} left out: not every quantity has begun, or one has ended")
    rows = rows[usable]
    return Chosen(rows, {each.name: _at(time_s, each, rows, hold_s) for each in kept}, tuple(remarks))


def _known(time_s: np.ndarray, each: Sampled, rows: np.ndarray, hold_s: float) -> np.ndarray:
    """At which rows all columns have a value: a sample, or one on either side."""
    found = np.full(len(rows), True)
    if not each.has_gaps:
        return found
    for column in each.values.T:
        samples = np.flatnonzero(~np.isnan(column))
        before = np.searchsorted(samples, rows, side="right") - 1
        has_before = before >= 0
        found &= has_before
        if not each.is_held and len(samples):
            age_s = time_s[rows] - time_s[samples[np.maximum(before, 0)]]
            found &= (age_s <= hold_s) | (before + 1 < len(samples))
    return found


def _at(time_s: np.ndarray, each: Sampled, rows: np.ndarray, hold_s: float) -> np.ndarray:
    """The values at rows where they are known."""
    if not each.has_gaps:
        return each.values[rows]
    return np.column_stack([_column_at(time_s, column, rows, np.inf if each.is_held else hold_s)
                            for column in each.values.T])


def _column_at(time_s: np.ndarray, column: np.ndarray, rows: np.ndarray, hold_s: float) -> np.ndarray:
    samples = np.flatnonzero(~np.isnan(column))
    before = np.searchsorted(samples, rows, side="right") - 1
    first = samples[before]
    after = samples[np.minimum(before + 1, len(samples) - 1)]
    age_s, apart_s = time_s[rows] - time_s[first], time_s[after] - time_s[first]
    share = np.where((age_s > hold_s) & (apart_s > 0.0), age_s / np.where(apart_s > 0.0, apart_s, 1.0), 0.0)
    found: np.ndarray = column[first] + share * (column[after] - column[first])
    return found


def _gaps(time_s: np.ndarray, each: Sampled) -> str:
    """How much of a quantity was filled in."""
    blank = np.isnan(each.values).any(axis=1)
    apart_s = max(float(np.diff(time_s[~np.isnan(column)]).max(initial=0.0)) for column in each.values.T)
    how = "held from the line before" if each.is_held else "interpolated"
    return (f"{each.name} is blank on {counted(int(blank.sum()), 'line')} of {len(blank)} and is {how} there, over "
            f"{apart_s:.3g} s at most")


def fresh(values: np.ndarray, rows: np.ndarray) -> np.ndarray | None:
    """The rows at which all columns have a sample since the row before; None: at all rows."""
    there = ~np.isnan(values)
    count = np.cumsum(there, axis=0)
    now = count[rows]
    before = np.vstack([np.zeros((1, values.shape[1]), int), now[:-1]])
    found = np.flatnonzero((now > before).all(axis=1))
    return None if len(found) == len(rows) else found
