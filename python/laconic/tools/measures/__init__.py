"""Measures by name: what a sweep writes of each run, and what an optimiser has as its goal.

    measure = measure_of("distance_m")
    measure.of(course)                      # (lanes,): one number for each vehicle
"""

from laconic.tools.measures.measure import Course as Course
from laconic.tools.measures.measure import Measure as Measure
from laconic.tools.measures.registry import measure_given as measure_given
from laconic.tools.measures.registry import measure_named as measure_named
from laconic.tools.measures.registry import measures_of as measures_of
