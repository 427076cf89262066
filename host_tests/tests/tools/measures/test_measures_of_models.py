"""Measures of a model: against closed forms that are derived here, and against the core and `laconic analyse`."""

from __future__ import annotations

import re
from itertools import product

import numpy as np
import pytest
from scipy.optimize import linprog

from laconic.errors import BadInput
from laconic.scene import read_scene
from laconic.tools.analyse.analyse import analyse
from laconic.tools.analyse.field import Field
from laconic.tools.analyse.from_core import subject_of
from laconic.tools.analyse.geometry import diagnose
from laconic.tools.measures import Course, measure_named, measures_of
from laconic.tools.measures.arguments import split, with_arguments
from laconic.tools.measures.authority import (
    acceleration_of_voltage,
    lever_over_radius,
    speed_of_voltage,
    straight_reach,
)
from laconic.tools.measures.measure import Winding
from laconic.tools.measures.prepared import Prepared
from laconic.tools.measures.stability import first_unstable_speed

SCENES = ("robotino2", "kuka_youbot", "optiodom_omni4", "paper_three_wheel_driven", "example_two_wheel_sizes",
          "paper_differential_drive", "turtlebot3_burger")


def measured(scene, text: str) -> float:
    """One measure of a scene."""
    name, given = split(text)
    core = scene.core()
    found = Prepared(core, [scene.c_vehicle(core)]).measured(with_arguments(measure_named(name, "model"), given).of)
    return float(found[0])


def group_of(scene):
    core = scene.core()
    return Prepared(core, [scene.c_vehicle(core)]).groups[0][1]


@pytest.mark.parametrize("name", SCENES)
def test_condition_and_yaw_authority_are_those_of_analyse(name):
    scene = read_scene(name)
    found = diagnose(subject_of(scene))
    assert measured(scene, "condition") == pytest.approx(found.condition, rel=1e-12)
    assert measured(scene, "yaw_authority") == pytest.approx(found.yaw_authority, rel=1e-12, abs=1e-15)


def test_three_omni_wheels_at_120_degrees_have_condition_1_with_a_length_of_root_2_times_their_distance():
    """ΞᵀΞ = diag(3/2, 3/2, 3 d²/ℓ²) in (v_ξ, v_η, ℓ θ')."""
    scene, distance_m = read_scene("robotino2"), 0.125
    assert measured(scene, f"condition(length_m={2.0**0.5 * distance_m!r})") == pytest.approx(1.0, rel=1e-12)
    assert measured(scene, "condition") == pytest.approx(np.sqrt(2.0), rel=1e-12)


@pytest.mark.parametrize("name", SCENES)
def test_what_a_volt_does_is_the_cores_derivative_and_its_steady_motion(name):
    scene = read_scene(name)
    subject, group = subject_of(scene), group_of(scene)
    field: Field = subject.field({})
    radius, scale = float(subject.model.wheel_radius_m), subject.matrices.lambda_yaw
    for wheel in range(subject.wheel_count):
        driven = subject.field({f"voltage_V[{wheel + 1}]": 1.0})
        rates = field.nu(driven.forcing[: field.dof]) * [radius, radius, 1.0 / scale]
        steady = field.nu(driven.forcing[: field.dof] / field.decay_per_s[: field.dof]) * [radius, radius, 1.0 / scale]
        assert acceleration_of_voltage(group)[0, :, wheel] == pytest.approx(rates, rel=1e-12, abs=1e-14)
        assert speed_of_voltage(group)[0, :, wheel] == pytest.approx(steady, rel=1e-12, abs=1e-14)


@pytest.mark.parametrize("name", ["robotino2", "kuka_youbot", "example_two_wheel_sizes"])
def test_largest_yaw_is_that_of_the_best_corner_of_all_voltages(name):
    group = group_of(scene := read_scene(name))
    corners = np.array(list(product((-1.0, 1.0), repeat=group.wheels)))
    best = (corners @ acceleration_of_voltage(group)[0].T)[:, 2].max()
    assert measured(scene, "yaw_acceleration_rad_per_s2_per_V") == pytest.approx(best, rel=1e-12)
    best = (corners @ speed_of_voltage(group)[0].T)[:, 2].max()
    assert measured(scene, "yaw_rate_rad_per_s_per_V") == pytest.approx(best, rel=1e-12)


@pytest.mark.parametrize("name", ["robotino2", "kuka_youbot", "paper_three_wheel_driven"])
def test_yaw_moment_is_that_of_the_forces_at_the_rollers(name):
    """A wheel's torque pulls along its roller's axis with 1/(R sin γ): Ξ's third column times Λ, from the core."""
    scene = read_scene(name)
    subject, group = subject_of(scene), group_of(scene)
    lever = subject.matrices.wheel_rows[:, 2] * subject.matrices.lambda_yaw
    assert lever_over_radius(group)[0] == pytest.approx(lever, rel=1e-12, abs=1e-13)


def farthest_along(columns: np.ndarray, direction: np.ndarray) -> float:
    """The largest multiple of a direction that columns within ±1 reach without yaw, by a linear program."""
    wheels = columns.shape[1]
    same = np.column_stack([columns, -np.array([*direction, 0.0])])
    found = linprog([0.0] * wheels + [-1.0], A_eq=same, b_eq=np.zeros(3), bounds=[(-1, 1)] * wheels + [(0, None)])
    return float(found.x[-1])


@pytest.mark.parametrize("seed", range(4))
def test_worst_direction_is_that_of_linear_programs_over_all_directions(seed):
    columns = np.random.default_rng(seed).normal(size=(3, 3 + seed)) * [[1.0], [1.0], [30.0]]
    turns = np.linspace(0.0, np.pi, 121)
    every = [farthest_along(columns, np.array([np.cos(turn), np.sin(turn)])) for turn in turns]
    radius = straight_reach(columns[None])[0]
    assert radius <= min(every) * (1.0 + 1e-9)
    assert radius == pytest.approx(min(every), rel=1e-2)  # the grid of directions misses the nearest edge by little


def test_worst_direction_where_nothing_yaws_and_where_a_direction_is_missing():
    square = np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]])
    assert straight_reach(square[None])[0] == pytest.approx(1.0)
    assert straight_reach(square[None, :, :1])[0] == 0.0
    assert measured(read_scene("turtlebot3_burger"), "worst_speed_m_per_s_per_V") == 0.0


def test_straight_motion_of_the_papers_carriage_is_stable_up_to_the_papers_threshold():
    """R · 2cΛσ²/ρ along η with Λ = 3, σ = 0.5, ρ = 0.4, c = 0.8 1/s, R = 0.05 m; the other way at every speed."""
    scene = read_scene("paper_three_wheel_driven")
    threshold = 0.05 * 2.0 * 0.8 * 3.0 * 0.5**2 / 0.4
    assert measured(scene, "straight_stable_speed_m_per_s(direction_deg=90)") == pytest.approx(threshold, rel=1e-12)
    assert measured(scene, "straight_stable_speed_m_per_s(direction_deg=-90)") == np.inf
    below, above = (measured(scene, f"straight_growth_per_s(speed_m_per_s={share * threshold!r}, direction_deg=90)")
                    for share in (0.999, 1.001))
    assert below < 0.0 < above


@pytest.mark.parametrize("seed", range(12))
def test_stable_speed_is_where_an_eigenvalue_crosses_real_or_in_a_pair(seed):
    """Random rates and couplings, as wheels that differ have them, against the eigenvalues at speeds around."""
    random = np.random.default_rng(seed)
    pull, yaw, decay = random.normal(size=3), random.normal(size=3), random.uniform(0.1, 3.0, 3)
    coupling = (pull * yaw)[None]
    found = first_unstable_speed(coupling, decay[None])[0]

    def growth(speed: float) -> float:
        return float(np.linalg.eigvals(speed * np.outer(pull, yaw) - np.diag(decay)).real.max())

    if np.isinf(found):
        assert all(growth(speed) < 0.0 for speed in np.geomspace(1e-3, 1e4, 200))
    else:
        assert growth(found) == pytest.approx(0.0, abs=1e-9 * found)
        assert all(growth(share * found) < 0.0 for share in np.linspace(0.01, 0.999, 50))
        assert growth(1.001 * found) > 0.0


def test_steady_growth_is_that_of_the_most_stable_motion_that_analyse_finds():
    """Straight on is unstable at these voltages, the circle beyond the threshold is stable."""
    scene = read_scene("paper_three_wheel_driven")
    core = scene.core()
    held = [scene.inputs_on_grid().held_at(0)]
    measure = measure_named("steady_growth_per_s", "model")
    found = Prepared(core, [scene.c_vehicle(core)], held).measured(measure.of)[0]
    motions = analyse(scene, ["steady"]).steady.motions
    growths = {motion.is_turning: motion.eigenvalues.real.max() for motion in motions}
    assert found == pytest.approx(growths[True], rel=1e-12)
    assert found < 0.0 < growths[False]


def test_least_load_and_grip_are_those_of_statics():
    """Wheel 3 of the paper's carriage carries Δ/δ3 = 0.02/0.08 of the weight; the others share the rest."""
    assert measured(read_scene("paper_three_wheel_driven"), "least_load_share") == pytest.approx(0.25, rel=1e-12)
    scene = read_scene("kuka_youbot")
    still = measured(scene, "grip_margin_N(acceleration_m_per_s2=0, direction_deg=0)")
    friction, mass_kg = scene.vehicle["friction_coefficient"], measured(scene, "total_mass_kg")
    assert still == pytest.approx(friction * mass_kg * 9.80665 / 4.0, rel=1e-9)
    assert measured(scene, "grip_margin_N(acceleration_m_per_s2=1, direction_deg=0)") < still


def test_vehicles_that_the_core_refuses_have_no_measure_and_leave_the_others_alone():
    scene = read_scene("robotino2")
    core = scene.core()
    good, bad = scene.c_vehicle(core), scene.c_vehicle(core)
    bad.mass_kg = -1.0
    found = Prepared(core, [good, bad, good])
    values = found.measured(measure_named("condition", "model").of)
    assert np.isnan(values).tolist() == [False, True, False]
    assert "mass_kg" in str(found.refused[1])


@pytest.mark.parametrize(("text", "word"), [
    ("straight_stable_speed_m_per_s", "direction_deg is missing"), ("condition(length=1)", "did you mean length_m?"),
    ("yaw_authority(a=1)", "it takes none"), ("condition(length_m=x)", "no finite number"), ("a b", "is no measure"),
    ("condition(1)", "give argument=value")])
def test_arguments_that_do_not_fit_are_refused_by_their_name(text, word):
    with pytest.raises(BadInput, match=re.escape(word)):
        measured(read_scene("robotino2"), text)


def test_every_measure_of_a_model_has_words_and_gives_one_number_for_each_vehicle():
    scene = read_scene("kuka_youbot")
    core = scene.core()
    vehicles = Prepared(core, [scene.c_vehicle(core)] * 3)
    for name, measure in measures_of("model").items():
        given = {argument: 0.5 for argument, default in measure.arguments.items() if default is not None}
        values = vehicles.measured(with_arguments(measure, given).of)
        assert values.shape == (3,), name
        assert not np.isnan(values).any(), name
        assert measure.words[0].isupper() and not measure.words.endswith("."), name


# ---- Measures of a run are what their words say, for many vehicles at once.

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
