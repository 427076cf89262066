"""Measures that may take arguments: `straight_stable_speed_m_per_s(direction_deg=90)`."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from laconic.errors import BadInput, nearest_of
from laconic.tools.measures.measure import OF_MODEL, Measure

REQUIRED = math.nan  # an argument that has no default
SPELLED = re.compile(r"\s*(\w+)\s*(?:\((.*)\))?\s*")


@dataclass(frozen=True)
class ArguedMeasure(Measure):
    """`of` takes, beside what it is of (a Group of L vehicles where the measure is of a model), arguments by name."""

    of: Callable[..., np.ndarray]
    kind: str = OF_MODEL
    arguments: Mapping[str, float | None] = field(default_factory=dict)  # default, None: one of its own, or REQUIRED
    given: Mapping[str, float] = field(default_factory=dict)             # with which it is measured

    @property
    def usage(self) -> str:
        """The name with its arguments: "condition(length_m=…)"."""
        given = ", ".join(f"{name}=…" for name in self.arguments)
        return f"{self.name}({given})" if given else self.name

    @property
    def text(self) -> str:
        """The name with the arguments that it has: "end_distance_m(x_m=1,y_m=0.5)"."""
        given = ",".join(f"{name}={repr(self.given[name]).removesuffix('.0')}" for name in self.arguments
                         if name in self.given)
        return f"{self.name}({given})" if given else self.name


def split(text: str) -> tuple[str, dict[str, float]]:
    """Name and arguments of a measure as it is given; BadInput for what is neither."""
    found = SPELLED.fullmatch(text)
    if found is None:
        raise BadInput(f"{text}: is no measure; give a name, or NAME(argument=value)")
    given: dict[str, float] = {}
    for part in filter(str.strip, (found[2] or "").split(",")):
        name, sign, value = part.partition("=")
        if not sign:
            raise BadInput(f"{text}: {part.strip()} has no name; give argument=value")
        given[name.strip()] = finite_number(f"{text}: {name.strip()}", value)
    return found[1], given


def finite_number(name: str, text: str) -> float:
    """The number that a text of the command line gives; BadInput, which calls it `name`, for one that is not finite."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise BadInput(f"{name}: {text.strip() or 'nothing'} is no finite number; give one")
    return value


def with_arguments(measure: Measure, given: Mapping[str, float]) -> Measure:
    """The measure with its arguments given; BadInput for one that is not known or is missing."""
    known = measure.arguments if isinstance(measure, ArguedMeasure) else {}
    if unknown := [name for name in given if name not in known]:
        instead = nearest_of(unknown[0], known) if known else "it takes none"
        raise BadInput(f"{measure.name}: there is no argument {unknown[0]}; {instead}")
    missing = [name for name, default in known.items() if default is not None and name not in given]
    if missing:
        raise BadInput(f"{measure.name}: {missing[0]} is missing; give {measure.name}({missing[0]}=…)")
    if not given:
        return measure
    assert isinstance(measure, ArguedMeasure)
    return replace(measure, of=partial(measure.of, **given), given=dict(given))
