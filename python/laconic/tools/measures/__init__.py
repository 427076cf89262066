"""Measures by name: what a sweep writes of each run, and what an optimiser has as its goal.

    measure = measure_of("distance_m")
    measure.of(course)                      # (lanes,): one number for each vehicle
"""

from __future__ import annotations

from laconic.errors import BadInput, nearest_of
from laconic.tools.measures.arguments import split, with_arguments
from laconic.tools.measures.measure import OF_RUN
from laconic.tools.measures.measure import Course as Course
from laconic.tools.measures.measure import Measure as Measure
from laconic.tools.measures.of_model import MEASURES_OF_MODELS
from laconic.tools.measures.of_runs import MEASURES_OF_ENDS, MEASURES_OF_RUNS

# A file of measures joins by its row here.
FILES = (MEASURES_OF_RUNS, MEASURES_OF_ENDS, MEASURES_OF_MODELS)


def measures_of(kind: str | None = None) -> dict[str, Measure]:
    """Measures by name: of a "run", of a "model", or all, in the order in which they are listed."""
    return {each.name: each for file in FILES for each in file if kind in (None, each.kind)}


def measure_named(name: str, kind: str | None = OF_RUN, option: str = "--measure") -> Measure:
    """One of them; BadInput with the nearest name."""
    known = measures_of(kind)
    if name not in known:
        raise BadInput(f"{option} {name}: there is no such measure; {nearest_of(name, known)}")
    return known[name]


def measure_given(text: str, kind: str | None = OF_RUN, option: str = "--measure") -> Measure:
    """One as an option gives it, NAME or NAME(argument=value); BadInput with the option in front."""
    try:
        name, given = split(text)
        return with_arguments(measure_named(name, kind, option), given)
    except BadInput as why:
        raise BadInput(str(why) if str(why).startswith(option) else f"{option} {why}") from None
