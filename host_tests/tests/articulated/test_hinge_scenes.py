"""Robots with hinges go where hand calculation says that they go."""

from __future__ import annotations

import copy
import math
from typing import Any

import numpy as np
import pytest
from hinge_scenes import CASTER, HINGED, SLIDING, held, scene_with, tables_of, two_wheels

from laconic import Trajectory, build_scene, read_scene, simulate
from laconic.base.paths import scene_names
from laconic.cli.commands.simulate import resting, summary
from laconic.scene import rigid_scene_names
from laconic.scene.hinges import has_hinges
from laconic.tools.analyse.hinged import hinged_numbers, study_hinges


@pytest.fixture(scope="module")
def runs() -> dict[str, Trajectory]:
    return {name: simulate(read_scene(name)) for name in HINGED}


def at(run: Trajectory, time_s: float, *names: str) -> tuple[float, ...]:
    row = int(np.argmin(np.abs(run.time_s - time_s)))
    return tuple(float(run.columns[name][row]) for name in names)


def test_the_project_has_these_scenes_with_hinges() -> None:
    assert sorted({*scene_names()} - {*rigid_scene_names()}) == sorted([*HINGED, *SLIDING])


@pytest.mark.parametrize("name", HINGED)
def test_each_runs_to_its_end_without_slip_or_limits_and_moves(runs: dict[str, Trajectory], name: str) -> None:
    run = runs[name]
    assert run.time_s[-1] == read_scene(name).run.duration_s and run.limited == ()
    assert run.least_margin is not None and run.least_margin[0] > 0.0
    assert np.hypot(np.ptp(run.columns["x_m"]), np.ptp(run.columns["y_m"])) > 1.0
    assert all(np.isfinite(column).all() for column in run.columns.values())


@pytest.mark.parametrize("name", HINGED)
def test_single_precision_goes_the_same_way(runs: dict[str, Trajectory], name: str) -> None:
    single = simulate(read_scene(name).with_run(real="single", duration_s=4.0))
    for column in ("x_m", "y_m", "heading_rad"):
        rows = len(single.time_s)
        assert np.abs(single.columns[column] - runs[name].columns[column][:rows]).max() < 2e-4


def test_the_car_drives_the_circle_of_its_steering_angle(runs: dict[str, Trajectory]) -> None:
    run = runs["f1tenth"]
    v, yaw, left, right = at(run, 5.0, "velocity_body_m_per_s[1]", "yaw_rate_rad_per_s", "hinge_angle_rad[front_left]",
                             "hinge_angle_rad[front_right]")
    assert v / yaw == pytest.approx(0.3302 / math.tan(0.3), rel=1e-9)
    assert 1.0 / math.tan(right) - 1.0 / math.tan(left) == pytest.approx(0.236 / 0.3302, rel=1e-9)  # Ackermann


def test_the_tricycle_turns_by_its_front_wheel_and_goes_straight_again(runs: dict[str, Trajectory]) -> None:
    run = runs["tricycle_agv"]
    v, yaw, angle = at(run, 9.0, "velocity_body_m_per_s[1]", "yaw_rate_rad_per_s", "hinge_angle_rad[front]")
    gain, damping = 100 * 0.07 / 0.6, 100**2 * (0.07**2 / 0.6 + 1e-4)
    assert angle == pytest.approx(5.0 * gain / damping, rel=1e-2)  # 5 V for a second
    assert v / yaw == pytest.approx(1.4 / math.tan(angle), rel=1e-9)
    assert abs(at(run, 20.0, "hinge_angle_rad[front]")[0]) < 1e-6


def test_casters_trail_behind_and_swing_round_when_the_robot_drives_back(runs: dict[str, Trajectory]) -> None:
    names = [f"hinge_angle_rad[{end}_{side}]" for end in ("front", "rear") for side in ("left", "right")]
    ahead, back = at(runs["mir_like"], 4.9, *names), at(runs["mir_like"], 16.0, *names)
    assert max(abs(angle) for angle in ahead) < 1e-6
    assert max(abs(abs(angle) - math.pi) for angle in back) < 1e-6
    assert at(runs["mir_like"], 10.0, "heading_rad")[0] > 2.0  # it turned on the spot
    chair = runs["wheelchair"]
    assert max(abs(angle) for angle in at(chair, 9.0, "hinge_angle_rad[left]", "hinge_angle_rad[right]")) < 0.01
    assert min(abs(angle) for angle in at(chair, 18.0, "hinge_angle_rad[left]", "hinge_angle_rad[right]")) > 2.5


def test_swerve_wheels_have_the_speeds_and_directions_of_the_bodys_motion(runs: dict[str, Trajectory]) -> None:
    run, places = runs["frc_swerve_mk4i"], (0.26 + 0.26j, 0.26 - 0.26j, -0.26 + 0.26j, -0.26 - 0.26j)
    velocity = run.columns_of("velocity_body_m_per_s") @ (1.0, 1.0j)
    hinges, speeds = run.columns_of("hinge_angle_rad").T, run.columns_of("wheel_speed_rad_per_s").T
    for place, hinge, speed in zip(places, hinges, speeds, strict=True):
        there = velocity + 1j * run.columns["yaw_rate_rad_per_s"] * place
        assert np.abs(there - 0.0508 * speed * np.exp(1j * hinge)).max() < 1e-12
    v, yaw = at(run, 6.0, "velocity_body_m_per_s[2]", "yaw_rate_rad_per_s")
    assert yaw / v == pytest.approx(1.2, rel=1e-9)


def test_the_pr2_turns_about_the_centre_of_its_twist(runs: dict[str, Trajectory]) -> None:
    ahead, aside, yaw = at(runs["pr2_base"], 13.0, "velocity_body_m_per_s[1]", "velocity_body_m_per_s[2]",
                           "yaw_rate_rad_per_s")
    assert (ahead / yaw, aside / yaw) == pytest.approx((0.6, -0.061), rel=2e-4)  # of the file's digits


def test_the_loader_turns_about_the_point_where_its_axles_meet(runs: dict[str, Trajectory]) -> None:
    run = runs["wheel_loader"]
    left, right, yaw, angle = at(run, 6.0, "wheel_speed_rad_per_s[1]", "wheel_speed_rad_per_s[2]", "yaw_rate_rad_per_s",
                                 "hinge_angle_rad[rear]")
    assert angle == pytest.approx(0.6, rel=1e-12)
    radius = 1.15 * (1.0 + math.cos(angle)) / math.sin(angle)
    assert abs(0.55 * (left + right) / 2.0 / yaw) == pytest.approx(radius, rel=1e-9)


def test_trailers_of_the_tugger_run_on_the_circles_of_their_geometry() -> None:
    scene = scene_with(tables_of("tugger_train"), run={"duration_s": 60.0, "step_s": 0.02}, input=held(
        voltage_V__1=20.0, voltage_V__2=20.0, steering_angle_rad__front=0.3))
    run, radius = simulate(scene), 1.1 / math.tan(0.3)
    *wheels, yaw = (float(column[-1]) for column in (*run.columns_of("wheel_speed_rad_per_s").T,
                                                    run.columns["yaw_rate_rad_per_s"]))
    assert 0.2 * (wheels[0] + wheels[1]) / 2.0 / yaw == pytest.approx(radius, rel=1e-9)
    angles = [float(column[-1]) for column in run.columns_of("hinge_angle_rad").T]
    for number in range(3):
        before, radius = radius, math.sqrt(radius**2 + 0.5**2 - 1.3**2)
        assert 0.15 * (wheels[3 + 2 * number] + wheels[4 + 2 * number]) / 2.0 / yaw == pytest.approx(radius, rel=1e-6)
        assert angles[1 + number] == pytest.approx(-(math.atan(0.5 / before) + math.atan(1.3 / radius)), rel=1e-6)


@pytest.mark.parametrize(("velocity", "start"), [(0.8, 2.5), (-0.8, 1e-3)])
def test_a_caster_of_a_straight_carriage_follows_its_law_forward_and_in_reverse(velocity: float, start: float) -> None:
    tables = two_wheels(caster=[{**CASTER, "start_angle_rad": start}])
    run = simulate(scene_with(tables, initial={"velocity_body_m_per_s": [velocity, 0.0]},
                              run={"duration_s": 0.5, "step_s": 0.002}))
    exact = 2.0 * np.arctan(math.tan(start / 2.0) * np.exp(-velocity * run.time_s / 0.05))
    assert np.abs(run.columns["hinge_angle_rad[caster_1]"] - exact).max() < 1e-5


def test_a_caster_nearer_to_the_turning_centre_than_its_trail_turns_for_ever() -> None:
    tables = two_wheels(caster=[{**CASTER, "x_m": 0.03, "trail_m": 0.05}])
    tables["vehicle"]["yaw_inertia_kgm2"] = 1e6  # so that a light caster does not slow it
    run = simulate(scene_with(tables, initial={"yaw_rate_rad_per_s": 2.0}, run={"duration_s": 10.0, "step_s": 0.01}))
    period = 2.0 * math.pi / math.sqrt(4.0 - (2.0 * 0.03 / 0.05)**2)
    turns = -run.columns["hinge_angle_rad[caster_1]"] / (2.0 * math.pi)
    first, second = (float(np.interp(number, turns, run.time_s)) for number in (0.5, 1.5))
    assert second - first == pytest.approx(period, rel=1e-4)


def test_twin_wheels_and_an_offset_of_a_caster_change_nothing_but_the_speeds_of_its_wheels() -> None:
    one = simulate(scene_with(two_wheels(caster=[{**CASTER, "start_angle_rad": 1.0}])))
    two = simulate(scene_with(two_wheels(caster=[{**CASTER, "start_angle_rad": 1.0, "twin_m": 0.04}])))
    name = "hinge_angle_rad[caster_1]"
    assert np.abs(one.columns[name] - two.columns[name]).max() < 1e-12
    mean = (two.columns["wheel_speed_rad_per_s[3]"] + two.columns["wheel_speed_rad_per_s[4]"]) / 2.0
    assert np.abs(mean - one.columns["wheel_speed_rad_per_s[3]"]).max() < 1e-9


def test_a_wheel_that_is_steered_and_held_is_a_wheel_at_that_angle() -> None:
    tables, steered = two_wheels(), {"kind": "fixed", "x_m": 0.5, "y_m": 0.0, "driven": False}
    del tables["vehicle"]["wheel"][1]
    fixed = {**tables["vehicle"], "wheel": [*tables["vehicle"]["wheel"], {**steered, "axle_rad": 0.3 - math.pi / 2}]}
    held_one = {**tables["vehicle"], "wheel": [*tables["vehicle"]["wheel"],
                                               {**steered, "steered": "prescribed", "start_angle_rad": 0.3}]}
    push = held(body_force_N__1=3.0)
    rigid, hinged = (simulate(scene_with(tables, vehicle=each, initial={}, input=push)) for each in (fixed, held_one))
    for name in ("x_m", "y_m", "heading_rad", "wheel_angle_rad[2]"):
        assert np.abs(rigid.columns[name] - hinged.columns[name]).max() < 1e-8, name


def on_carriage(tables: dict[str, Any], count: int) -> dict[str, Any]:
    """The same with the first wheels on the carriage by name."""
    named = copy.deepcopy(tables)
    for wheel in named["vehicle"]["wheel"][:count]:
        wheel["body"] = "carriage"
    return named


def test_a_wheel_on_the_carriage_by_name_is_one_without_a_body() -> None:
    tables = tables_of("f1tenth")
    for wheel in tables["vehicle"]["wheel"][:2]:
        wheel["x_m"] = 0.05  # an axle ahead of the origin, which steering must know
    plain, named = (build_scene(each) for each in (tables, on_carriage(tables, 2)))
    assert named.vehicle == plain.vehicle
    runs = [simulate(scene.with_run(duration_s=3.0)).columns for scene in (plain, named)]
    assert all(np.array_equal(column, runs[1][name]) for name, column in runs[0].items())
    one, other = (hinged_numbers(study_hinges(scene)) for scene in (plain, named))
    assert one["limits"] == other["limits"] and one["turns"] == other["turns"]


def test_wheels_on_the_carriage_by_name_make_no_hinges() -> None:
    tables = on_carriage(two_wheels(), 2) | {"initial": {"nu_rad_per_s": [1.0, 0.0, 0.0]}}
    scene = build_scene(tables)  # with a start that vehicles with hinges do not have
    assert not scene.has_hinges and not has_hinges(tables["vehicle"])
    assert not any("body" in wheel for wheel in scene.vehicle["wheel"])


def test_the_loads_of_a_trailer_are_shared_with_its_hitch() -> None:
    run = simulate(read_scene("tugger_train").with_run(duration_s=0.1))
    from laconic.core.articulated import ArticulatedVehicle
    from laconic.simulation.loads import GRAVITY_M_PER_S2, Loads

    motion = ArticulatedVehicle.of(run.scene).plant().motion()
    loads = Loads(run.scene).of(motion)
    assert loads.sum() == pytest.approx(GRAVITY_M_PER_S2 * (1100.0 + 20.0 + 3 * 400.0), rel=1e-12)
    third = 400.0 * GRAVITY_M_PER_S2 * 1.2 / 1.3  # the hitch takes the rest
    assert loads[7] == pytest.approx(third / 2.0, rel=1e-12)
    hitch = 400.0 * GRAVITY_M_PER_S2 - third
    second = (400.0 * GRAVITY_M_PER_S2 * 1.2 + hitch * 1.8) / 1.3
    assert loads[5] + loads[6] == pytest.approx(second, rel=1e-12)


def tipping(**vehicle: float) -> dict[str, Any]:
    tables = tables_of("tricycle_agv")
    tables["vehicle"] |= vehicle
    return tables | {"run": {"duration_s": 0.1, "step_s": 0.01}, "input": []}


def test_a_vehicle_with_hinges_that_tips_is_named_with_what_it_stands_on() -> None:
    run = simulate(build_scene(tipping(com_x_m=-0.4)))
    standing = resting(run)
    assert standing and "it tips: its centre of mass lies" in standing.tips and "from wheel" in standing.tips
    assert run.lifted and summary(run)["lifted"] == {"wheel": run.lifted[0], "time_s": 0.0}
    run = simulate(build_scene(tipping()))
    standing = resting(run)
    assert standing and standing.tips == "" and standing.weight_N > 1000.0 and run.lifted is None


def test_a_trailer_whose_wheel_would_have_to_pull_tips() -> None:
    tables = tables_of("tugger_train") | {"run": {"duration_s": 0.1, "step_s": 0.01}, "input": []}
    tables["vehicle"]["trailer"][-1]["com_x_m"] = 0.3
    standing = resting(simulate(build_scene(tables)))
    assert standing and standing.tips.startswith("third tips: wheel 8 would have to pull with")


def test_a_wheel_that_lifts_on_ground_with_friction_is_reported() -> None:
    tables = tipping(com_x_m=-0.4) | {"ground": {"friction_coefficient": 0.7}}
    del tables["vehicle"]["friction_coefficient"]
    run = simulate(build_scene(tables))
    assert run.lifted and run.lifted[1] <= 0.02


def test_a_carriage_on_supports_needs_no_wheels_to_have_a_friction_coefficient() -> None:
    corners = [{"x_m": x, "y_m": y} for x, y in ((0.3, 0.0), (-0.3, 0.2), (-0.3, -0.2))]
    own = {"mass_kg": 20.0, "yaw_inertia_kgm2": 1.0, "com_z_m": 0.2, "friction_coefficient": 0.5, "support": corners,
           "wheel_radius_m": 0.05, "wheel_inertia_kgm2": 1e-3,
           "body": [{"name": "arm", "hinge": "free", "hinge_x_m": 0.1, "hinge_y_m": 0.0, "mass_kg": 1.0,
                     "yaw_inertia_kgm2": 0.1, "com_x_m": 0.3}]}
    scene = build_scene({"vehicle": own, "run": {"duration_s": 0.1, "step_s": 0.01},
                                 "initial": {"velocity_body_m_per_s": [1.0, 0.0]}})
    assert simulate(scene, ["x_m"]).columns["x_m"][-1] > 0.05
