"""Measures of a run's end beside a place that is given, as an optimiser has it for its goal."""

from __future__ import annotations

import numpy as np

from laconic.tools.measures.arguments import ArguedMeasure
from laconic.tools.measures.course import Course
from laconic.tools.measures.measure import OF_RUN


def end_distance(course: Course, x_m: float = 0.0, y_m: float = 0.0) -> np.ndarray:
    """How far from a place a run ends."""
    dx, dy = course["x_m"][-1] - x_m, course["y_m"][-1] - y_m
    return np.asarray(np.sqrt(dx * dx + dy * dy))


MEASURES_OF_ENDS = (
    ArguedMeasure("end_distance_m", "How far from the place (x_m, y_m), the origin if none is given, the run ends",
                  end_distance, kind=OF_RUN, signals=("x_m", "y_m"), is_of_end=True,
                  arguments={"x_m": None, "y_m": None}),)
