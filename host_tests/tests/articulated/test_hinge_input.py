"""Scenes with hinges: what contradicts is one line with field and remedy; commands are followed within their limits."""

from __future__ import annotations

import copy
import math
from typing import Any

import numpy as np
import pytest
from hinge_scenes import CASTER, WHEEL, held, scene_with, tables_of, two_wheels

from laconic import RunRefused, build_scene, simulate
from laconic.errors import BadInput

TRAILER = {"hitch_x_m": -0.3, "length_m": 0.8, "track_m": 0.4, "radius_m": 0.1}
BODY = {"name": "arm", "hinge": "free", "hinge_x_m": 0.2, "mass_kg": 1.0, "yaw_inertia_kgm2": 0.1}
STEERED = {"kind": "fixed", "x_m": 0.5, "y_m": 0.0, "steered": "prescribed", "driven": False}


def with_steered(**keys: Any) -> dict[str, Any]:
    """A tricycle: two wheels and a steered one ahead."""
    tables = two_wheels()
    tables["vehicle"]["wheel"].append({**STEERED, **keys})
    return tables


def fails(tables: dict[str, Any], *words: str) -> None:
    with pytest.raises(BadInput) as why:
        simulate(build_scene(tables))
    text = str(why.value)
    assert "\n" not in text and "Traceback" not in text
    for word in words:
        assert word in text, text


@pytest.mark.parametrize(("tables", "words"), [
    (two_wheels(caster=[{**CASTER, "trail_m": 0.0}]), ("caster[1].trail_m", "is 0", "above 0")),
    (two_wheels(caster=[{**CASTER, "twin_m": -1.0}]), ("caster[1].twin_m", "above 0")),
    (two_wheels(caster=[{k: v for k, v in CASTER.items() if k != "radius_m"}]), ("caster[1].radius_m", "is missing")),
    (two_wheels(caster=[{**CASTER, "trial_m": 0.1}]), ("caster[1].trial_m", "trail_m")),
    (two_wheels(caster=[{**CASTER, "mass_kg": -1.0}]), ("caster[1].mass_kg", "0 or more")),
    (two_wheels(caster=[{**CASTER, "name": "a b"}]), ("caster[1].name", "letters, digits")),
    (two_wheels(caster=[{**CASTER, "name": "c"}, {**CASTER, "name": "c"}]), ("caster[2].name", "vehicle.caster[1]")),
    (two_wheels(caster=[{**CASTER, "name": "carriage"}]), ("caster[1].name", "body 0")),
    (two_wheels(caster=[{**CASTER, "parent": "arm"}]), ("caster[1].parent", "there is no body 'arm'")),
    (two_wheels(caster=[{**CASTER, "x_m": math.inf}]), ("caster[1].x_m", "finite")),
    (two_wheels(caster=[{**CASTER, "start_angle_deg": 100.0, "stop_high_deg": 90.0}]), ("start_angle", "stops")),
    (two_wheels(caster=[{**CASTER, "stop_low_rad": 1.0, "stop_high_rad": -1.0}]), ("stop_high_rad", "not above")),
    (two_wheels(trailer=[{**TRAILER, "length_m": 0.0}]), ("trailer[1].length_m", "above 0")),
    (two_wheels(body=[{**BODY, "hinge": "ball"}]), ("body[1].hinge", "there is no 'ball'")),
    (two_wheels(body=[{**BODY, "hinge": "motor"}]), ("body[1].gain_Nm_per_V", "is missing")),
    (two_wheels(body=[{**BODY, "gain_Nm_per_V": 1.0}]), ("body[1].gain_Nm_per_V", '"free"')),
    (two_wheels(body=[{**BODY, "hinge": "prescribed", "damping_Nms": 1.0}]), ("body[1].damping_Nms", "no effect")),
    (two_wheels(body=[{**BODY, "rate_limit_rad_per_s": 1.0}]), ("body[1].rate_limit_rad_per_s", "no effect")),
    (two_wheels(body=[{**BODY, "at_limit": "saturate"}]), ("body[1].at_limit", "refuse")),
    (two_wheels(body=[{**BODY, "yaw_inertia_kgm2": 0.0, "mass_kg": 0.0}]),
     ("vehicle.body[1] (arm)", "turns without inertia")),
    (two_wheels(body=[{**BODY, "parent": "b"}, {**BODY, "name": "b", "parent": "arm"}]), ("in the end hangs",)),
    (two_wheels(body=[{**BODY, "servo_gain_Nm_per_rad": 1.0}]), ("servo_gain_Nm_per_rad", "ground.friction_coeff")),
    (with_steered(kind="omni"), ("wheel[3].kind", "fixed")),
    (with_steered(steered="power"), ("wheel[3].steered", "there is no 'power'")),
    (with_steered(body="nobody"), ("wheel[3].body", "there is no body 'nobody'")),
    (with_steered(steered="motor"), ("wheel[3].steering_gain_Nm_per_V", "is missing")),
    (with_steered(steered="motor", steering_gain_Nm_per_V=1.0), ("vehicle.wheel[3] (wheel_3)", "without inertia")),
    (with_steered(steered="coordinated", axle_deg=20.0), ("vehicle.wheel[3]", "axle_rad")),
    (with_steered() | {"initial": {"velocity_body_m_per_s": [0.5, 0.2]}}, ("initial.velocity_body_m_per_s", "nearest")),
    (with_steered() | {"initial": {"nu_rad_per_s": [1.0, 0.0, 0.0]}}, ("initial.nu_rad_per_s", "velocity_body")),
    (with_steered() | {"initial": {"wheel_speed_rad_per_s": [1.0, 0.0, 0.0]}}, ("wheel_speed_rad_per_s", "no effect")),
    (two_wheels(caster=[CASTER], friction_coefficient=0.5) | {"ground": {"slope_deg": 0.0, "roller_drag": 0.5}},
     ("ground.roller_drag", "no effect on ideal ground")),
    (two_wheels(caster=[CASTER], drive={"supply_V": 12.0}, motor={
        "resistance_ohm": 1.0, "torque_constant_Nm_per_A": 0.1, "back_emf_Vs_per_rad": 0.1, "gear_ratio": 1.0}),
     ("vehicle.drive", "take it out")),
    (with_steered() | {"sensors": {"imu": {}}}, ("sensors", "take the table out")),
    (with_steered() | {"base": {"track_m": 1.0}}, ("base.track_m", "is no known key here")),
    (with_steered() | {"outputs": {"signals": ["hinge_angle_rad[rear]"]}}, ("outputs.signals", "hinge_angle_rad")),
    (with_steered() | {"outputs": {"signals": ["nu_rad_per_s"]}}, ("outputs.signals", "there is no signal")),
    (with_steered() | {"outputs": {"signals": ["no_slip_margin_N"]}}, ("friction_coefficient",)),
    (with_steered() | {"input": held(hinge_voltage_V__wheel_3=1.0)}, ("hinge_voltage_V[wheel_3]", '"motor"', "none")),
    (with_steered() | {"input": held(steering_rate_rad_per_s__front=1.0)}, ("steering_rate_rad_per_s[wheel_3]",)),
    (with_steered() | {"input": held(steering_twist__1=1.0)}, ("steering_twist[1]", '"coordinated"')),
    (with_steered() | {"input": held(steering_curvature_per_m=1.0)}, ("steering_curvature_per_m", '"coordinated"')),
    (with_steered() | {"input": held(steering_angle_rad__wheel_3=1.0)}, ("wheel[3].rate_limit_rad_per_s", "missing")),
    (with_steered(rate_limit_rad_per_s=1.0) | {"input": held(steering_angle_rad__wheel_3=1.0,
                                                             steering_rate_rad_per_s__wheel_3=1.0)},
     ("steering_angle_rad[wheel_3]", "besides")),
    (with_steered() | {"input": held(voltage_V__4=1.0)}, ("voltage_V[4]", "3 wheels")),
    (tables_of("f1tenth", input=held(steering_angle_rad__front_left=0.1)),
     ("steering_angle_rad[front_left]", "is coordinated", "steered together", "steering_curvature_per_m")),
    (tables_of("f1tenth", input=held(steering_rate_rad_per_s__front_left=0.1)), ("is coordinated", "steering_twist")),
    (tables_of("f1tenth", input=held(steering_angle_rad__fron_left=0.1)), ("there is steering_angle_rad",)),
    ({**two_wheels(), "vehicle": {**two_wheels()["vehicle"], "wheel": [
        *two_wheels()["vehicle"]["wheel"], {"kind": "fixed", "x_m": 0.5, "y_m": 0.0, "stered": "prescribed"}]}},
     ("wheel[3].stered", "did you mean steered?")),
    ({**two_wheels(), "vehicle": {**two_wheels()["vehicle"], "wheel": [
        *two_wheels()["vehicle"]["wheel"], {"kind": "fixed", "x_m": 0.5, "y_m": 0.0, "name": "front", "steerd": "motor",
                                            "rate_limit_rad_per_s": 2.0}]}},
     ("wheel[3].steerd", "did you mean steered?")),
    (two_wheels(caster=[{**CASTER, "com_x_m": -0.02}]), ("caster[1].com_x_m", "without mass", "give mass_kg")),
    (two_wheels(caster=[{**CASTER, "start_rate_rad_per_s": 2.0}]),
     ("caster[1].start_rate_rad_per_s: 2 has no effect", "set its rate, here 0 rad/s")),
    (two_wheels(trailer=[{**TRAILER, "start_angle_deg": 30.0, "start_rate_rad_per_s": -3.0}]),
     ("trailer[1].start_rate_rad_per_s", "here -0.5 rad/s")),
    (two_wheels(body=[{**BODY, "parent": "arm"}]), ("body[1].parent", "the body itself")),
    (two_wheels(trailer=[{**TRAILER, "name": "cart", "parent": "carts"}]),
     ("trailer[1].parent", "there is no body 'carts'; known are carriage")),
    (two_wheels() | {"input": held(hinge_torque_Nm__arm=1.0)}, ("there is no signal", "hinge_torque_Nm"))])
def test_what_contradicts_is_one_line_with_field_and_remedy(tables: dict[str, Any], words: tuple[str, ...]) -> None:
    fails(tables, *words)


@pytest.mark.parametrize("key", ["name", "scrub_m", "mass_kg", "yaw_inertia_kgm2", "rate_limit_rad_per_s", "at_limit",
                                 "stop_low_deg", "start_angle_rad", "steering_damping_Nms"])
def test_keys_of_steering_mean_nothing_for_other_wheels(key: str) -> None:
    tables = two_wheels()
    tables["vehicle"]["wheel"][1][key] = "x" if key in ("name", "at_limit") else 1.0
    fails(tables, f"wheel[2].{key}", "steered")


def test_modules_that_nothing_coordinates_are_refused_with_the_remedy() -> None:
    tables = tables_of("frc_swerve_mk4i", input=[])
    for wheel in tables["vehicle"]["wheel"]:
        wheel |= {"steered": "motor", "steering_gain_Nm_per_V": 1.0}
        del wheel["rate_limit_rad_per_s"]
    fails(tables, "vehicle: ", "coordinated hinges")
    fails(tables, "or give ground.friction_coefficient")
    for wheel, angle in zip(tables["vehicle"]["wheel"], (0.0, 0.1, 0.2, 0.3), strict=True):
        del wheel["steering_gain_Nm_per_V"]
        wheel |= {"steered": "prescribed", "start_angle_rad": angle}
    fails(tables, "ask for different turning centres", "coordinated hinges")


def test_two_commands_of_coordinated_wheels_and_a_twist_of_nothing_are_refused() -> None:
    car = tables_of("f1tenth")
    fails(car | {"input": held(steering_angle_rad=0.1, steering_curvature_per_m=0.2)}, "besides", "one of them")
    fails(car | {"input": held(steering_twist__1=0.0)}, "no direction")
    for wheel in car["vehicle"]["wheel"][2:]:
        for key in ("rate_limit_rad_per_s", "stop_low_rad", "stop_high_rad"):
            del wheel[key]
    aside = held(steering_twist__1=1.0, steering_twist__2=0.5)
    fails(car | {"input": aside}, "steering_twist: ", "fixed wheels of the carriage slide")


def test_curvature_angle_and_twist_steer_a_car_alike() -> None:
    car, curvature = tables_of("f1tenth", run={"duration_s": 2.0, "step_s": 0.01}), math.tan(0.2) / 0.3302
    motors = held(voltage_V__1=2.0, voltage_V__2=2.0)
    ways = (held(steering_angle_rad=0.2), held(steering_curvature_per_m=curvature),
            held(steering_twist__1=1.0, steering_twist__3=curvature))
    ends = [simulate(scene_with(car, input=motors + way)).columns for way in ways]
    for name in ("x_m", "y_m", "heading_rad", "hinge_angle_rad[front_left]"):
        assert np.ptp([columns[name][-1] for columns in ends]) < 1e-12, name


def test_the_curvature_is_that_of_the_fixed_axle_wherever_the_origin_is() -> None:
    car = tables_of("f1tenth", run={"duration_s": 2.0, "step_s": 0.01})
    moved = copy.deepcopy(car)
    for wheel in moved["vehicle"]["wheel"]:
        wheel["x_m"] -= 0.2
    moved["vehicle"]["com_x_m"] -= 0.2
    inputs = held(voltage_V__1=2.0, voltage_V__2=2.0, steering_curvature_per_m=0.5)
    one, other = (simulate(scene_with(each, input=inputs)).columns for each in (car, moved))
    for name in ("x_m", "y_m", "heading_rad"):
        assert np.abs(one[name] - other[name]).max() < 1e-9
    assert one["velocity_body_m_per_s[1]"][-1] * 0.5 == pytest.approx(one["yaw_rate_rad_per_s"][-1], rel=1e-12)


def test_a_commanded_angle_is_reached_at_the_limit_of_the_rate_and_held() -> None:
    tables = with_steered(name="front", rate_limit_rad_per_s=0.5)
    run = simulate(scene_with(tables, initial={}, input=held(steering_angle_rad__front=0.2)))
    angle = run.columns["hinge_angle_rad[front]"]
    assert np.abs(angle - np.minimum(0.5 * run.time_s, 0.2)).max() < 1e-12
    (limited,) = run.limited
    assert (limited.hinge, limited.limit, limited.first_s) == ("front", "rate", 0.0)
    assert limited.steps * 0.01 == pytest.approx(0.4, abs=0.011)


@pytest.mark.parametrize("signal", ["steering_angle_rad__front", "steering_rate_rad_per_s__front"])
def test_a_stop_holds_a_commanded_hinge_and_is_told_or_ends_the_run(signal: str) -> None:
    keys: dict[str, Any] = {"name": "front", "rate_limit_rad_per_s": 5.0, "stop_high_rad": 0.3}
    run = simulate(scene_with(with_steered(**keys), initial={}, input=held(**{signal: 1.0})))
    assert run.columns["hinge_angle_rad[front]"].max() == pytest.approx(0.3, rel=1e-12)
    assert run.columns["hinge_rate_rad_per_s[front]"][-1] == 0.0
    assert {(each.hinge, each.limit) for each in run.limited} >= {("front", "angle")}
    refusing = with_steered(**keys, at_limit="refuse")
    scene = scene_with(refusing, initial={}, input=held(steering_rate_rad_per_s__front=1.0))
    with pytest.raises(RunRefused, match=r"vehicle.wheel\[3\] \(front\).*limit of its angle is 0.3") as why:
        simulate(scene)
    assert why.value.run.time_s[-1] == pytest.approx(0.3) and why.value.run.steps == 30


def test_coordinated_wheels_keep_their_limits_and_still_roll() -> None:
    turn = {"signal": "steering_angle_rad", "kind": "steps", "t_s": [0.5], "value": [0.6]}
    car = tables_of("f1tenth", run={"duration_s": 2.0, "step_s": 0.01})
    run = simulate(scene_with(car, input=[*held(voltage_V__1=2.0, voltage_V__2=2.0), turn]))
    angles = run.columns_of("hinge_angle_rad")
    assert angles.max() == pytest.approx(0.4189, abs=1e-9)
    assert np.abs(np.diff(angles, axis=0)).max() == pytest.approx(3.2 * 0.01, rel=1e-6)
    assert {each.limit for each in run.limited} == {"rate", "angle"}
    left, right = 1.0 / np.tan(angles[-1])
    assert right - left == pytest.approx(0.236 / 0.3302, rel=1e-9)
    for wheel in car["vehicle"]["wheel"][2:]:
        wheel["at_limit"] = "refuse"
    with pytest.raises(RunRefused, match="limit of its rate is 3.2"):
        simulate(scene_with(car, input=[*held(voltage_V__1=2.0, voltage_V__2=2.0), turn]))


def test_without_a_limit_a_twist_that_jumps_is_refused_with_its_remedy() -> None:
    car = tables_of("f1tenth", run={"duration_s": 2.0, "step_s": 0.01})
    for wheel in car["vehicle"]["wheel"][2:]:
        for key in ("rate_limit_rad_per_s", "stop_low_rad", "stop_high_rad"):
            del wheel[key]
    turn = {"signal": "steering_curvature_per_m", "kind": "steps", "t_s": [0.5], "value": [1.0]}
    with pytest.raises(RunRefused, match=r"vehicle.wheel\[3\] \(front_left\): the twist turns this steered wheel .* "
                                         r"give its slope \(steering_twist_rate\) in an FMU or in C"):
        simulate(scene_with(car, input=[turn]))


def test_a_start_beyond_the_stops_is_held_at_the_stop() -> None:
    car = tables_of("f1tenth", run={"duration_s": 0.1, "step_s": 0.01}, input=held(steering_angle_rad=0.6))
    run = simulate(build_scene(car))
    assert run.columns_of("hinge_angle_rad")[0].max() == pytest.approx(0.4189, abs=1e-9)
    assert {(each.hinge, each.limit) for each in run.limited} == {("front_left", "angle")}


def test_a_motor_at_its_shaft_is_its_gain_damping_and_inertia() -> None:
    shaft = {"resistance_ohm": 0.5, "torque_constant_Nm_per_A": 0.05, "back_emf_Vs_per_rad": 0.06, "gear_ratio": 40.0,
             "viscous_friction_Nms": 1e-4, "rotor_inertia_kgm2": 1e-5}
    direct = {"steering_gain_Nm_per_V": 4.0, "steering_damping_Nms": 1600.0 * (0.05 * 0.06 / 0.5 + 1e-4),
              "yaw_inertia_kgm2": 0.02 + 1600.0 * 1e-5}
    keys = {"steered": "motor", "name": "front", "yaw_inertia_kgm2": 0.02}
    ends = [simulate(scene_with(with_steered(**{**keys, **more}), initial={}, input=held(hinge_voltage_V__front=3.0)))
            for more in ({"steering_motor": shaft}, direct)]
    one, other = (run.columns["hinge_angle_rad[front]"] for run in ends)
    assert one[-1] > 0.1 and np.abs(one - other).max() < 1e-12
    fails(with_steered(**keys, steering_motor=shaft, steering_gain_Nm_per_V=1.0), "steering_gain_Nm_per_V", "besides")


def test_bodies_may_come_in_any_order_and_keep_their_names() -> None:
    chain = [{**TRAILER, "name": "b", "parent": "a", "hitch_x_m": -1.0}, {**TRAILER, "name": "a"}]
    run = simulate(build_scene(two_wheels(trailer=chain)))
    turned = simulate(build_scene(two_wheels(trailer=chain[::-1])))
    for name in ("hinge_angle_rad[a]", "hinge_angle_rad[b]", "x_m"):
        assert np.array_equal(run.columns[name], turned.columns[name])
    assert run.columns["wheel_angle_rad[3]"][-1] == pytest.approx(0.8 * 0.5 / 0.1)


def test_limits_of_the_core_are_told_by_the_files_words() -> None:
    many = [{**CASTER, "x_m": 0.1 + 0.01 * i} for i in range(9)]
    fails(two_wheels(caster=many), "9 bodies on hinges", "room for 8")
    fails(two_wheels(wheel=[{**WHEEL, "x_m": 0.0, "y_m": 0.2}, {**WHEEL, "x_m": 0.0, "y_m": -0.2, "radius_m": -1.0}],
                     caster=[CASTER]), "wheel[2].radius_m")
