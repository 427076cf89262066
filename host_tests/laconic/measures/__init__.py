"""Measures by name: what a sweep writes of each run, and what an optimiser has as its goal.

    measure = measure_of("distance_m")
    measure.of(course)                      # (lanes,): one number for each vehicle
"""

from laconic.measures.course import Course as Course
from laconic.measures.measure import Measure as Measure
from laconic.measures.registry import measure_given as measure_given
from laconic.measures.registry import measure_named as measure_named
from laconic.measures.registry import measures_of as measures_of
