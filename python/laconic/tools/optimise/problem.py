"""What is optimised: free numbers with their ranges, goals and constraints by measures, as options give them."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from laconic.errors import BadInput
from laconic.tools.measures.arguments import finite_number

NOT_MEASURED = 1e30  # how far a vehicle that the core refuses is from every constraint
LARGEST = 1e100      # beyond, values are cut for the optimiser: it takes squares of them


@dataclass(frozen=True)
class Free:
    """A number of the scene that may be chosen within a range, in the scene's unit; several keys have it together."""

    key: str  # with commas between several
    low: float
    high: float

    @property
    def keys(self) -> tuple[str, ...]:
        """Each of them."""
        return tuple(part.strip() for part in self.key.split(","))


@dataclass(frozen=True)
class Goal:
    """A measure to be made as small or as large as possible."""

    measure: str
    is_largest: bool

    @property
    def text(self) -> str:
        """As it is given."""
        return f"{'max' if self.is_largest else 'min'}:{self.measure}"

    def loss(self, values: np.ndarray) -> np.ndarray:
        """What is made small: the measure or its negative; infinite where there is no measure."""
        loss = -values if self.is_largest else values
        return np.where(np.isnan(loss), np.inf, np.clip(loss, -LARGEST, LARGEST))


@dataclass(frozen=True)
class Constraint:
    """A bound that a measure has to keep."""

    measure: str
    is_upper: bool
    bound: float

    @property
    def text(self) -> str:
        """As it is given."""
        return f"{self.measure}{'<=' if self.is_upper else '>='}{self.bound:g}"

    def excess(self, values: np.ndarray) -> np.ndarray:
        """How far values are beyond the bound, as a share of its size; 0 or less where they keep it."""
        over = (values - self.bound) if self.is_upper else (self.bound - values)
        scaled = over / (abs(self.bound) or 1.0)
        return np.where(np.isnan(scaled), NOT_MEASURED, np.clip(scaled, -LARGEST, LARGEST))


@dataclass(frozen=True)
class Problem:
    """Free numbers, goals and constraints, and what measures many choices at once.

    `measured` takes choices (L, p), one number for each free one, and gives the measures (L, M) in the order of
    `measures`; NaN for a vehicle that the core refuses.
    """

    free: tuple[Free, ...]
    goals: tuple[Goal, ...]
    constraints: tuple[Constraint, ...]
    measured: Callable[[np.ndarray], np.ndarray]
    jacobian: Callable[[np.ndarray], np.ndarray | None] = lambda choice: None  # (M, p) at (p,), NaN: not known exactly

    @property
    def measures(self) -> tuple[str, ...]:
        """Every measure of goals and constraints, once."""
        return measures_of(self.goals, self.constraints)

    def choices(self, shares: np.ndarray) -> np.ndarray:
        """Choices from shares of the ranges, (…, p)."""
        low, high = self._range
        return np.where(shares == 1.0, high, low + shares * (high - low))

    def shares(self, choices: np.ndarray) -> np.ndarray:
        """Where choices lie in their ranges, 0 to 1."""
        low, high = self._range
        return (choices - low) / (high - low)

    @property
    def _range(self) -> tuple[np.ndarray, np.ndarray]:
        return np.array([each.low for each in self.free]), np.array([each.high for each in self.free])

    def losses(self, values: np.ndarray) -> np.ndarray:
        """Of each goal, (…, goals), from measures (…, M)."""
        return np.stack([goal.loss(values[..., self.column(goal.measure)]) for goal in self.goals], axis=-1)

    def excesses(self, values: np.ndarray) -> np.ndarray:
        """Of each constraint, (…, constraints)."""
        each = [one.excess(values[..., self.column(one.measure)]) for one in self.constraints]
        return np.stack(each, axis=-1) if each else np.zeros((*values.shape[:-1], 0))

    def column(self, measure: str) -> int:
        """Where a measure stands."""
        return self.measures.index(measure)


def measures_of(goals: Sequence[Goal], constraints: Sequence[Constraint]) -> tuple[str, ...]:
    """Every measure of goals and constraints, once."""
    return tuple(dict.fromkeys([*(goal.measure for goal in goals), *(each.measure for each in constraints)]))


def read_free(text: str) -> Free:
    """KEY=a:b."""
    key, sign, span = text.rpartition("=")
    low, colon, high = span.partition(":")
    if not (sign and colon and key.strip()):
        raise BadInput(f"--free {text}: is no range; give KEY=a:b, such as vehicle.com_y_m=0:0.05")
    ends = [finite_number(f"--free {text}", each) for each in (low, high)]
    if not ends[0] < ends[1]:
        raise BadInput(f"--free {text}: the range is empty; give the smaller number first")
    return Free(key.strip(), *ends)


def read_goal(text: str) -> Goal:
    """min:MEASURE or max:MEASURE."""
    word, colon, measure = (part.strip() for part in text.partition(":"))
    if not colon or word not in ("min", "max"):
        name = text.rpartition(":")[2].strip()
        raise BadInput(f"--goal {text}: does not say which way; give min:{name} or max:{name}")
    return Goal(measure, word == "max")


def read_constraint(text: str) -> Constraint:
    """MEASURE<=value or MEASURE>=value."""
    found = re.fullmatch(r"\s*(.+?)\s*(<=|>=)\s*([^<>=]+)", text)
    if found is None:
        raise BadInput(f"--subject-to {text}: is no bound; give 'MEASURE<=value' or 'MEASURE>=value', in quotes")
    return Constraint(found[1], found[2] == "<=", finite_number(f"--subject-to {text}", found[3]))
