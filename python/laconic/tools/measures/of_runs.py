"""Measures of a run. They take no sines and cosines, so that every machine of a cluster gives the same bits.

Measures of a run's end beside a place that is given, as an optimiser has it for its goal.
"""

from __future__ import annotations

import numpy as np

from laconic.tools.measures.arguments import ArguedMeasure
from laconic.tools.measures.measure import OF_RUN, Course, Measure

PLACE, WHEELS = ("x_m", "y_m"), ("voltage_V", "wheel_speed_rad_per_s")


def _end(signal: str) -> Measure:
    words = {"x_m": "Where the run ends: x of the centre of mass", "y_m": "Where the run ends: y of the centre of mass",
             "heading_rad": "Where the run ends: heading, with whole turns", "energy_J": "Kinetic energy at the end",
             "yaw_rate_rad_per_s": "Yaw rate at the end"}
    return Measure(f"end_{signal}", words[signal], lambda course: course[signal][-1], signals=(signal,),
                   is_of_end=True)


def _stretches(course: Course) -> np.ndarray:
    """(T − 1, L): the way between instants."""
    dx, dy = (np.diff(course[name], axis=0) for name in PLACE)
    return np.sqrt(dx * dx + dy * dy)


def distance(course: Course) -> np.ndarray:
    """The way of the centre of mass."""
    return _sum(_stretches(course))


def _sum(values: np.ndarray) -> np.ndarray:
    """Over the first axis, one after the other: the bits must not depend on how many lanes there are."""
    total = np.zeros(values.shape[1:], values.dtype)
    for value in values:
        total = total + value
    return total


def _integral(course: Course, rates: np.ndarray) -> np.ndarray:
    """Over time, by trapezia."""
    steps = np.diff(course.time_s).reshape(-1, *[1] * (rates.ndim - 1))
    return _sum(steps * (rates[1:] + rates[:-1]) * 0.5)


def _over_wheels(values: np.ndarray) -> np.ndarray:
    """(T, wheels, L) → (T, L)."""
    return _sum(np.swapaxes(values, 0, 1))


def wheel_work(course: Course) -> np.ndarray:
    """Work of all torques on the wheels."""
    return _integral(course, _over_wheels(course["wheel_torque_Nm"] * course["wheel_speed_rad_per_s"]))


def electrical_energy(course: Course) -> np.ndarray:
    """Taken by the windings, what brakes give back counted against it."""
    assert course.winding is not None
    return _integral(course, _over_wheels(course.winding.powers_W(course)))


def largest_current(course: Course) -> np.ndarray:
    """Of any motor."""
    assert course.winding is not None
    return _largest(course.winding.currents_A(course))


def _largest(values: np.ndarray) -> np.ndarray:
    """Size of the largest number of all instants, and of all items."""
    found: np.ndarray = np.abs(values).max(axis=tuple(range(values.ndim - 1)))
    return found


def largest_speed(course: Course) -> np.ndarray:
    """Of the centre of mass."""
    across, along = course["velocity_body_m_per_s"][:, 1], course["velocity_body_m_per_s"][:, 0]
    found: np.ndarray = np.sqrt(along * along + across * across).max(axis=0)
    return found


def deviations(course: Course) -> np.ndarray:
    """(T, L): how far a run is from the nominal one at the same instant."""
    dx, dy = (course[name] - course.beside[name] for name in PLACE)
    return np.sqrt(dx * dx + dy * dy)


def time_to_nominal_distance(course: Course) -> np.ndarray:
    """When a run has come as far as the nominal one comes in all, linear between instants; NaN where it never does."""
    goal, times = distance(course.beside)[0], course.time_s
    way = np.zeros(course[PLACE[0]].shape)
    for instant, stretch in enumerate(_stretches(course), start=1):
        way[instant] = way[instant - 1] + stretch
    at: np.ndarray = np.argmax(way >= goal, axis=0)
    lanes = np.arange(len(at))
    earlier = np.maximum(at - 1, 0)
    before, after = way[earlier, lanes], way[at, lanes]
    with np.errstate(invalid="ignore", divide="ignore"):
        share = np.where(after > before, (goal - before) / (after - before), 0.0)
    found = np.take(times, earlier) + share * (np.take(times, at) - np.take(times, earlier))
    return np.where((way >= goal).any(axis=0), found, np.nan)


MEASURES_OF_RUNS = (
    *(_end(signal) for signal in ("x_m", "y_m", "heading_rad", "yaw_rate_rad_per_s", "energy_J")),
    Measure("distance_m", "Way of the centre of mass", distance, signals=PLACE),
    Measure("largest_speed_m_per_s", "Largest speed of the centre of mass", largest_speed,
            signals=("velocity_body_m_per_s",)),
    Measure("largest_wheel_speed_rad_per_s", "Largest speed of any wheel",
            lambda course: _largest(course["wheel_speed_rad_per_s"]), signals=("wheel_speed_rad_per_s",),
            needs="wheels"),
    Measure("largest_voltage_V", "Largest voltage of any motor", lambda course: _largest(course["voltage_V"]),
            signals=("voltage_V",), needs="wheels"),
    Measure("largest_current_A", "Largest current of any motor", largest_current, signals=WHEELS, needs="motor"),
    Measure("wheel_work_J", "Work of the torques on all wheels", wheel_work,
            signals=("wheel_torque_Nm", "wheel_speed_rad_per_s"), needs="wheels"),
    Measure("electrical_energy_J", "Energy that the motors' windings take, less what they give back",
            electrical_energy, signals=WHEELS, needs="motor"),
    Measure("supply_energy_J", "Energy from the supply", lambda course: course["supply_energy_J"][-1],
            signals=("supply_energy_J",), is_of_end=True, needs="supply"),
    Measure("end_deviation_m", "Distance between the ends of this and of the nominal run",
            lambda course: deviations(course)[-1], signals=PLACE, is_of_end=True, is_beside_nominal=True),
    Measure("end_heading_deviation_rad", "Heading at the end less that of the nominal run",
            lambda course: course["heading_rad"][-1] - course.beside["heading_rad"][-1], signals=("heading_rad",),
            is_of_end=True, is_beside_nominal=True),
    Measure("largest_deviation_m", "Largest distance from the nominal run at the same instant",
            lambda course: deviations(course).max(axis=0), signals=PLACE, is_beside_nominal=True),
    Measure("time_to_nominal_distance_s", "Until it has come as far as the nominal run comes in all; empty where it "
                                          "never does",
            time_to_nominal_distance, signals=PLACE, is_beside_nominal=True),
    Measure("least_grip_margin_N", "Least of friction coefficient times normal load, less the reaction that a "
                                       "wheel needs; below 0 it would slip",
            lambda course: course["no_slip_margin_N"].min(axis=0), signals=("no_slip_margin_N",),
            needs="friction coefficient"))


def end_distance(course: Course, x_m: float = 0.0, y_m: float = 0.0) -> np.ndarray:
    """How far from a place a run ends."""
    dx, dy = course["x_m"][-1] - x_m, course["y_m"][-1] - y_m
    return np.asarray(np.sqrt(dx * dx + dy * dy))


MEASURES_OF_ENDS = (
    ArguedMeasure("end_distance_m", "How far from the place (x_m, y_m), the origin if none is given, the run ends",
                  end_distance, kind=OF_RUN, signals=("x_m", "y_m"), is_of_end=True,
                  arguments={"x_m": None, "y_m": None}),)
