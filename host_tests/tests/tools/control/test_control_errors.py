"""What a program gives wrongly to filter, course, controller and CasADi's step is refused in one line of its name."""

from __future__ import annotations

import math
import tracemalloc

import casadi
import numpy as np
import pytest

import laconic
from laconic import BadInput
from laconic.tools.control import Camera, Course, Drive, Filter, PredictiveController, casadi_step, plot_drive
from laconic.tools.control.predictive import Pattern

STEP_S = 0.05
KNOWN = {"position_std_m": 0.1, "encoder_std_rad": 0.1, "yaw_rate_std_rad_per_s": 0.1, "bias_std_rad_per_s": 0.1}
UNITS = "rad/s, rad/s, rad/s, m, m, rad"


def plant(step_s=STEP_S):
    return laconic.Vehicle.of(laconic.read_scene("robotino2")).plant("auto", step_s=step_s)


def circle(t_s):
    return 0.1 * math.sin(t_s), 0.1 * math.cos(t_s), 0.2 * t_s


@pytest.fixture(scope="module")
def course():
    return Course(plant(), circle, 0.5)


@pytest.fixture(scope="module")
def controller(course):
    return PredictiveController(course, 10.0, horizon=5)


def refused(call):
    with pytest.raises(BadInput) as error:
        call()
    return str(error.value)


@pytest.mark.parametrize(("given", "text"), [
    (None, "plant: None is no plant; make one with vehicle.plant"), (3.0, "plant: 3.0 is no plant")])
@pytest.mark.parametrize("make", [casadi_step, lambda given: Course(given, circle, 0.5),
                                  lambda given: Filter(given, {})])
def test_what_is_no_plant_is_refused(make, given, text):
    assert refused(lambda: make(given)).startswith(text)


@pytest.mark.parametrize(("pose_at", "text"), [
    (None, "pose_at: None is no function"), (lambda t: None, "pose_at(0): None does not fit"),
    (lambda t: (1.0, 2.0), "pose_at(0): (1.0, 2.0) does not fit; give real numbers of shape (3,) in m, m, rad"),
    (lambda t: (0.0, math.nan, 0.0), "pose_at(0)[2]: nan is not finite; give finite numbers in m, m, rad"),
    (lambda t: "xyz", "pose_at(0): 'xyz' does not fit"),
    (lambda t: (1.0, [2.0], 3.0), "pose_at(0): (1.0, [2.0], 3.0) does not fit")])
def test_a_course_of_what_are_no_poses_is_refused(pose_at, text):
    assert refused(lambda: Course(plant(), pose_at, 0.5)).startswith(text)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("pose_at", [lambda t: (1e308 * math.sin(1e6 * t), 1e308 * math.cos(1e6 * t), 0.0),
                                     lambda t: (0.0, 0.0, 1e308 * t)])
def test_a_course_that_leaves_the_range_is_refused_before_any_warning(pose_at):
    assert refused(lambda: Course(plant(), pose_at, 0.5)).startswith("pose_at(0): moves faster than numbers go; give x")
    assert "does not fit" in refused(lambda: Course(plant(), lambda t: (np.ma.masked, 0.0, 0.0), 0.5))


@pytest.mark.parametrize(("duration_s", "text"), [
    (None, "None is no number"), ("2", "'2' is no number"), (math.nan, "nan is not finite"),
    (1e9, "more than 1000000 steps"), (0.07, "0.07 s is no whole number of steps of 0.05 s; give 0.05 or 0.1"),
    (-1, "less than a step")])
def test_a_duration_that_a_course_cannot_have_is_refused_and_never_cut(duration_s, text):
    message = refused(lambda: Course(plant(), circle, duration_s))
    assert message.startswith("duration_s: ") and text in message


def test_a_course_of_single_precision_has_all_its_steps():
    single = laconic.Vehicle(laconic.read_scene("robotino2").vehicle, "single").plant("auto", step_s=STEP_S)
    assert len(Course(single, circle, 2.0)) == 40


def test_a_controller_holds_the_end_of_its_course_and_has_no_step_before_its_begin(course, controller):
    end = course.states[-1].copy()
    end[:3] = 0.0  # at rest
    at_end, long_after = (controller.voltages(step, end) for step in (len(course), 10**15))
    assert long_after == pytest.approx(at_end, abs=1e-3)
    assert at_end == pytest.approx(np.zeros(3), abs=1e-2)
    off = end + [0, 0, 0, 0.05, 0, 0]
    assert np.abs(controller.voltages(10**15, off)).max() > 0.1  # it pulls back
    for step in (-1, -len(course), -(10**6)):
        assert refused(lambda given=step: controller.voltages(given, end)) == \
            f"step: {step} is before the course; give 0 for its first step, or more"


@pytest.mark.parametrize(("step", "state", "text"), [
    (1.5, np.zeros(6), "step: 1.5 is no whole number"), (None, np.zeros(6), "step: None is no whole number"),
    ("0", np.zeros(6), "step: '0' is no whole number"),
    (0, None, f"state: None does not fit; give real numbers of shape (6 or more,) in {UNITS}"),
    (0, "x", "state: 'x' does not fit"), (0, np.zeros((6, 1)), "state: an array of shape (6, 1) and type float64"),
    (0, [0, 0, math.inf, 0, 0, 0], "state[3]: inf is not finite"), (0, [1j] * 6, "state: [1j, 1j,")])
def test_steps_and_states_that_are_none_are_refused(controller, step, state, text):
    assert refused(lambda: controller.voltages(step, state)).startswith(text)


def test_a_motion_that_the_wheels_do_not_allow_is_that_of_another_robot():
    wheels = [{"kind": "fixed", "y_m": y_m, "axle_rad": -math.pi / 2} for y_m in (0.08, -0.08)]
    two = laconic.Vehicle({"mass_kg": 0.9, "yaw_inertia_kgm2": 2.4e-3, "wheel_radius_m": 0.03, "wheel": wheels,
                           "motor_gain_Nm_per_V": 0.1, "wheel_inertia_kgm2": 2e-5, "motor_damping_Nms": 0.2})
    straight = Course(two.plant("auto", step_s=STEP_S), lambda t: (0.1 * t, 0.0, 0.0), 0.5)
    ahead = PredictiveController(straight, 10.0, horizon=5)
    state = ahead.course.states[0] + [0.0, 0.01, 0.0, 0.0, 0.0, 0.0]  # as measured
    assert np.isfinite(ahead.voltages(0, state)).all()
    message = refused(lambda: ahead.voltages(0, state + [0.0, 2.0, 0.0, 0.0, 0.0, 0.0]))
    assert message.startswith("state: the wheels of this robot do not allow nu = [") and "of this robot" in message


def test_what_a_filter_says_beyond_the_state_is_not_read(course, controller):
    state = course.states[0]
    assert controller.voltages(0, [*state, math.nan]) == pytest.approx(controller.voltages(0, state), abs=1e-3)


@pytest.mark.parametrize(("settings", "text"), [
    ({"limit_V": None}, "limit_V: None is no number"), ({"limit_V": [1, 2]}, "limit_V: [1, 2] is no number"),
    ({"limit_V": math.inf}, "limit_V: inf is not above 0; give a finite number"),
    ({"horizon": None}, "horizon: None is no whole number"), ({"horizon": 1.5}, "horizon: 1.5 is no whole number"),
    ({"horizon": 10**9}, "horizon: 1000000000 steps are no plan; give 1 to 10000"),
    ({"weights": None}, "weights: None does not fit"), ({"weights": [1, 1, 1, 1, 1, -1]}, "weights: "),
    ({"voltage_weight": "x"}, "voltage_weight: 'x' is no number"), ({"course": None}, "course: None is no course")])
def test_a_controller_is_not_made_of_what_does_not_fit(course, settings, text):
    given = {"course": course, "limit_V": 10.0, **settings}
    assert refused(lambda: PredictiveController(given.pop("course"), given.pop("limit_V"), **given)).startswith(text)


def test_a_long_plan_takes_memory_by_its_length_alone():
    tracemalloc.start()
    pattern, found = Pattern(2000, 3), tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert found < 50e6 < pattern.rows**2 * 8  # bytes; a dense programme has gigabytes


@pytest.mark.parametrize(("call", "text"), [
    (lambda f: f.encoders(None), "turned_rad: None does not fit; give real numbers of shape (3,) in rad"),
    (lambda f: f.encoders(np.zeros((3, 1))), "turned_rad: an array of shape (3, 1) and type float64 does not fit"),
    (lambda f: f.encoders([0, math.nan, 0]), "turned_rad[2]: nan is not finite; give finite numbers in rad"),
    (lambda f: f.counts([math.nan] * 3), "count[1]: nan is not finite"), (lambda f: f.counts("abc"), "count: 'abc'"),
    (lambda f: f.counts([2**40] * 3), "count: [1099511627776.0, "),
    (lambda f: f.yaw_rate(None), "shown_rad_per_s: None is no number"),
    (lambda f: f.yaw_rate(math.inf), "shown_rad_per_s: inf is not finite"),
    (lambda f: f.fix(math.nan, 0, std_m=1), "x_m: nan is not finite"),
    (lambda f: f.fix(0, 0, std_m=1, place_m=None), "place_m: None does not fit; give real numbers of shape (2,) in m"),
    (lambda f: f.predict([1, 2, 3]), "input: [1, 2, 3]"), (lambda f: f.predict({}, steps=None), "steps: None")])
def test_readings_that_are_none_are_refused_and_leave_the_filter_as_it_was(call, text):
    ours = Filter(plant(0.01), KNOWN, encoder={"counts_per_turn": 2000})
    before = ours.state.tolist()
    assert refused(lambda: call(ours)).startswith(text)
    assert ours.state.tolist() == before


COUNTED = {"counts_per_turn": 2000}


def test_counts_of_32_bits_without_sign_are_the_same_reading():
    states = []
    for wrap, counts in (({}, [-5, 7, -9]), ({"wrap": 2**32}, [2**32 - 5, 7, 2**32 - 9])):
        found = Filter(plant(0.01), KNOWN, encoder=COUNTED | wrap)
        found.predict({"voltage_V": [6, -3, 2]})
        found.counts(counts)
        states.append(found.state.tolist())
    assert states[0] == states[1]


@pytest.mark.parametrize("counts", [0, -100, [4096, 0, 4096]])
def test_counts_need_an_encoder_at_every_wheel(counts):
    message = refused(lambda: Filter(plant(0.01), KNOWN, encoder={"counts_per_turn": counts}))
    assert message.startswith("encoder.counts_per_turn: is ") and "above 0" in message


@pytest.mark.parametrize(("encoder", "text"), [
    ({"counts_per_turn": [4096, False, 4096]}, "encoder.counts_per_turn: wheel 2 has none; give a number above 0"),
    ({}, "encoder.counts_per_turn: is missing"), ({"counts": 3}, "encoder.counts: unknown key"),
    ({"counts_per_turn": 4096, "gear_ratio": 0}, "encoder.gear_ratio: is 0; give another number, below 0 for"),
    ({"counts_per_turn": 4096, "wrap": 0}, "encoder.wrap: is 0; give the number of values that the counter has")])
def test_encoders_of_a_filter_are_read_as_those_of_a_scene(encoder, text):
    assert refused(lambda: Filter(plant(0.01), KNOWN, encoder=encoder)).startswith(text)


def test_counts_are_those_that_the_counter_shows():
    assert refused(lambda: Filter(plant(0.01), KNOWN, start_count=[1, 2, 3])).startswith("start_count: has no effect ")
    ours = Filter(plant(0.01), KNOWN, encoder={"counts_per_turn": 2000, "wrap": 100})
    for counts in ([100, 0, 0], [0, -1, 0]):
        assert refused(lambda given=counts: ours.counts(given)).endswith("a counter that wraps shows; give 0 to 99")
    assert ours.counts([99, 0, 1]).numbers == 3


HEAVY = laconic.read_scene("robotino2").vehicle | {"mass_kg": 30.0}


@pytest.mark.parametrize(("other", "what"), [
    (lambda: Filter(plant(0.02), KNOWN), "step_s"), (lambda: Filter(plant(0.01), KNOWN, encoder=COUNTED), "encoder"),
    (lambda: Filter(laconic.Vehicle(HEAVY).plant(step_s=0.01), KNOWN), "vehicle"),
    (lambda: Filter(laconic.Vehicle(HEAVY, "single").plant(step_s=0.01), KNOWN), "precision")])
def test_a_filter_takes_back_what_was_saved_of_its_like_alone(other, what):
    ours = Filter(plant(0.01), KNOWN)
    assert refused(lambda: ours.restore(other().save())) == \
        f"saved: is not of this filter, whose {what} is another; give what its save() gave"
    like = Filter(plant(0.01), KNOWN)
    like.predict({"voltage_V": [6, -3, 2]}, 5)
    ours.restore(like.save())
    assert ours.state.tolist() == like.state.tolist()


@pytest.mark.parametrize(("settings", "text"), [
    ({"period": 0}, "period: 0 is no number of steps between two views; give 1 or more"),
    ({"period": -1}, "period: -1 is no number of steps between two views; give 1 or more"),
    ({"period": None}, "period: None"), ({"period": 1.5}, "period: 1.5"),
    ({"std_m": -1.0}, "std_m: -1 is below 0"), ({"heading_std_rad": math.nan}, "heading_std_rad: nan is not finite"),
    ({"seed": -1}, "seed: ")])
def test_a_camera_that_none_is_is_refused(settings, text):
    given = {"period": 5, "std_m": 0.01, "heading_std_rad": 0.01, **settings}
    assert refused(lambda: Camera(**given)).startswith(text)


def test_a_picture_of_what_is_no_drive_is_refused(course):
    assert refused(lambda: plot_drive(None, course)).startswith("run: None is no drive")
    assert refused(lambda: plot_drive(Drive(0.1), None)).startswith("course: None is no course")


@pytest.mark.parametrize("far", [-1e7, 1e16, 1e31, 1e300])
def test_a_state_too_far_off_is_refused_and_the_plan_of_another_is_never_given(course, far, capfd):
    controller = PredictiveController(course, 10.0, horizon=5)
    near = course.states[0]
    there = near + [0, 0, 0, far, 0, 0]
    assert refused(lambda: controller.voltages(0, there)).startswith("state: ")  # of a fresh controller
    before = controller.voltages(0, near)
    message = refused(lambda: controller.voltages(0, there))
    assert "off the course, too far for a plan; give a state within 1e+06" in message
    assert controller.voltages(0, near) == pytest.approx(before, abs=1e-5)  # begun from the plan before
    assert capfd.readouterr().out == ""


STATE, VOLTS = np.array([1.0, -0.5, 2.0, 0.3, -0.2, 0.7]), np.array([2.0, -1.0, 0.5])


@pytest.mark.parametrize(("arguments", "text"), [
    ((np.zeros(5), VOLTS), f"s: array([0., 0., 0., 0., 0.]) does not fit; give real numbers of shape (6,) in {UNITS}"),
    ((None, VOLTS), "s: None does not fit"),
    ((STATE, [1, 2]), "u: [1, 2] does not fit; give real numbers of shape (3,) in V"),
    ((np.full(6, math.nan), VOLTS), "s[1]: nan is not finite"), ((STATE,), "arguments: there are 1; give s, u"),
    ((STATE, [1, [2], 3]), "u: [1, [2], 3] does not fit"), ((casadi.SX.sym("s", 6), VOLTS), "s: ")])
def test_numbers_that_a_step_of_casadi_cannot_take_are_refused(arguments, text, capfd):
    step = casadi_step(plant())
    assert refused(lambda: step(*arguments)).startswith(text)
    assert capfd.readouterr().err == ""


def test_a_step_of_casadi_that_the_core_refuses_has_the_core_s_line(capfd):
    step = casadi_step(plant(), ["payload.mass_kg"])
    assert refused(lambda: step(STATE, VOLTS, -200.0)) == \
        "vehicle.payload.mass_kg: -200 is negative; give 0 or a value above it"
    assert capfd.readouterr().err == ""


def test_a_step_of_casadi_takes_numbers_by_name_and_many_columns_at_once():
    step = casadi_step(plant())
    one = step(STATE, VOLTS)
    assert np.array_equal(step(u=VOLTS, s=STATE)["s_after"].full(), one.full())
    assert np.array_equal(step(casadi.DM(STATE), casadi.DM(VOLTS)).full(), one.full())
    many = step(np.stack([STATE, STATE], axis=1), np.stack([VOLTS, 0 * VOLTS], axis=1)).full()
    assert np.array_equal(many[:, :1], one.full()) and not np.array_equal(many[:, 1:], one.full())


@pytest.mark.parametrize(("more", "text"), [
    ({"parameters": "mass_kg"}, "parameters: 'mass_kg' is no list of names"), ({"parameters": None}, "parameters: "),
    ({"parameters": ["mass_kg", "mass_kg"]}, "parameters: mass_kg is named twice"),
    ({"name": "a b"}, "name: 'a b' is no name"), ({"name": None}, "name: None is no name")])
def test_a_step_of_casadi_is_not_made_of_what_does_not_fit(more, text):
    assert refused(lambda: casadi_step(plant(), **more)).startswith(text)


def test_a_number_that_is_not_there_is_refused_with_all_that_are_those_of_the_payload_among_them():
    step = plant().step_derivatives()
    message = refused(lambda: step.tangent(vehicle={"bogus": 1.0}))
    assert all(name in message for name in (" mass_kg,", "payload.mass_kg", "ground.slope_rad", "wheel[1].x_m"))
    assert "wheel[2].x_m" in refused(lambda: step.tangent(vehicle={"wheel[2].bogus": 1.0}))
