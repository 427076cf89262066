"""Measures of a run are what their words say, for many vehicles at once."""

from __future__ import annotations

import numpy as np
import pytest

from laconic.errors import BadInput
from laconic.tools.measures import Course, measure_named, measures_of
from laconic.tools.measures.course import Winding

T = np.array([0.0, 1.0, 3.0])
PATH = {"x_m": np.array([[0.0, 0.0], [3.0, 1.0], [3.0, 1.0]]), "y_m": np.array([[0.0, 0.0], [4.0, 0.0], [6.0, 0.5]])}
NOMINAL = Course(T, {name: np.array(values)[:, None] for name, values in (("x_m", [0.0, 1.0, 2.0]),
                                                                          ("y_m", [0.0, 0.0, 0.0]))})


def of(name, signals, **more):
    return measure_named(name).of(Course(T, signals, **more))


def test_the_way_and_the_end_are_of_each_lane():
    assert of("distance_m", PATH).tolist() == [7.0, 1.5]
    assert of("end_y_m", PATH).tolist() == [6.0, 0.5]


def test_a_deviation_is_the_distance_from_the_nominal_run_at_the_same_instant():
    assert of("largest_deviation_m", PATH, nominal=NOMINAL).tolist() == [np.hypot(1.0, 6.0), np.hypot(1.0, 0.5)]
    assert of("end_deviation_m", PATH, nominal=NOMINAL).tolist() == [np.hypot(1.0, 6.0), np.hypot(1.0, 0.5)]


def test_the_time_to_come_as_far_as_the_nominal_run_is_between_instants_or_none():
    found = of("time_to_nominal_distance_s", PATH, nominal=NOMINAL)
    assert found[0] == pytest.approx(2.0 / 5.0, rel=1e-15)
    assert np.isnan(found[1]), "it comes 1.5 m far, the nominal one 2 m"


def test_work_and_currents_are_those_of_the_motors():
    speed, volts = np.full((3, 2, 1), 2.0), np.full((3, 2, 1), 6.0)
    winding = Winding(np.array([2.0]), np.array([1.0]), np.array([[1.0], [0.0]]))
    signals = {"wheel_speed_rad_per_s": speed, "voltage_V": volts, "wheel_torque_Nm": np.full((3, 2, 1), 0.5)}
    assert of("wheel_work_J", signals).tolist() == [6.0]
    assert of("largest_current_A", signals, winding=winding).tolist() == [2.0]
    assert of("electrical_energy_J", signals, winding=winding).tolist() == [36.0], "the undriven wheel takes nothing"


def test_every_measure_has_a_unit_and_one_line():
    for name, measure in measures_of("run").items():
        assert measure.unit, name
        assert "\n" not in measure.words
        assert measure.words[0].isupper()


def test_a_name_that_is_none_is_refused_with_the_nearest():
    with pytest.raises(BadInput, match="did you mean distance_m?"):
        measure_named("distanc_m")
