"""Vehicles with hinges on the wire: cars, swerve drives, tricycles, loaders, robots with casters and trailers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import laconic
from laconic.errors import BadInput
from laconic.ros2.chassis import Chassis
from laconic.ros2.hinged import HingedBase, base_of
from laconic.ros2.messages import new
from laconic.ros2.session import write_record
from laconic.scene import build_scene, read_scene
from laconic.scene.base import BaseTable
from laconic.scene.ground import slips
from laconic.scene.hinges import rigid_scene_names
from laconic.scene.scene_tables import scene_tables
from laconic.simulation.articulated import kept_signals_with_hinges
from ros2_support import Rig, last, rig_of

HINGED = sorted(name for name in {*laconic.scene_names()} - {*rigid_scene_names()}
                if not slips(laconic.read_scene(name).vehicle))
COMMANDS = {"f1tenth": (1.0, 0.0, 0.8), "tugger_train": (1.0, 0.0, 0.3), "tricycle_agv": (0.5, 0.0, 0.3),
            "wheelchair": (0.5, 0.0, 0.4), "mir_like": (0.4, 0.0, -0.3), "wheel_loader": (1.0, 0.0, 0.2),
            "frc_swerve_mk4i": (0.3, 1.0, 0.5), "pr2_base": (0.1, -0.3, 0.4)}
CAR_START_M = -0.17145  # of the rear axle: the centre of mass starts at 0
CARS = ("f1tenth", "tugger_train", "tricycle_agv", "wheel_loader")
ACKERMANN, JOINTS = "ackermann_msgs/msg/AckermannDriveStamped", "sensor_msgs/msg/JointState"


def by_day(*names: str, of: Sequence[str] = HINGED) -> pytest.MarkDecorator:
    """These scenes in every run, the others at night."""
    return pytest.mark.parametrize("name", [name if name in names else pytest.param(name, marks=pytest.mark.nightly)
                                            for name in of])


def hinged_base(scene: Any, robots: int = 1) -> HingedBase:
    found = base_of(read_scene(scene) if isinstance(scene, str) else scene, robots)
    assert isinstance(found, HingedBase)
    return found


def driven(base: HingedBase, seconds: float, *command: float) -> list[str]:
    remarks = base.command(0, *command)
    for _ in range(round(seconds / 0.02)):
        assert base.advance(round(0.02 / base.step_s)) == []
        base.look()
    return remarks


def drive_by_angle(rig: Rig, cycles: int, topic: str = "ackermann_cmd", **values: float) -> None:
    writer, message = rig.node.publisher(topic, ACKERMANN), new(ACKERMANN)
    for name, value in values.items():
        setattr(message.drive, name, value)
    rig.turn(cycles, lambda: writer.write(message))


# ---- motion and odometry

def test_every_scene_with_hinges_is_driven_here() -> None:
    assert sorted(COMMANDS) == HINGED


@by_day("f1tenth", "frc_swerve_mk4i", "mir_like", "tugger_train")
def test_a_vehicle_with_hinges_reaches_the_commanded_velocity(name: str) -> None:
    base = hinged_base(name)
    assert driven(base, 3.0, *COMMANDS[name]) == []
    assert base.look()[0].velocity == pytest.approx(COMMANDS[name], abs=2e-3)


@pytest.mark.parametrize("speed_m_per_s", [0.5, 3.0])
def test_the_built_in_car_starts_and_stops_within_the_grip_of_its_wheels(speed_m_per_s: float) -> None:
    base = hinged_base("f1tenth")
    for command in ((speed_m_per_s, 0.0, 0.0), (0.0, 0.0, 0.0)):
        driven(base, 2.5, *command)
        assert base.motion.grip(0) == ""
    without = hinged_base(replace(read_scene("f1tenth"), base=None))
    driven(without, 0.1, speed_m_per_s, 0.0, 0.0)
    assert "wheels would slip: the ground had to hold" in without.motion.grip(0)


@by_day("f1tenth", "frc_swerve_mk4i", "tricycle_agv", "wheelchair")
def test_odometry_of_wheels_and_steering_is_the_motion(name: str) -> None:
    base = hinged_base(name)
    start = base.look()[0]
    driven(base, 2.0, *COMMANDS[name])
    seen, believed = base.look()[0], base.odometry[0]
    assert (believed.x_m, believed.y_m, believed.heading_rad) == pytest.approx(
        (seen.x_m - start.x_m, seen.y_m - start.y_m, seen.heading_rad - start.heading_rad), abs=2e-3)


@pytest.mark.parametrize("name", HINGED)
def test_nothing_with_hinges_moves_without_a_command(name: str) -> None:
    base = hinged_base(name)
    before = base.look()[0]
    base.advance(100)
    after = base.look()[0]
    assert (after.x_m, after.y_m, after.heading_rad, *after.hinge_rad) == pytest.approx(
        (before.x_m, before.y_m, before.heading_rad, *before.hinge_rad))


@pytest.mark.parametrize("name", HINGED)
def test_the_chassis_has_the_wheel_speeds_of_the_core(name: str) -> None:
    base = hinged_base(name)
    driven(base, 0.5, *COMMANDS[name])  # while the hinges still turn
    seen, motion = base.look()[0], base.motion.robots[0].motion
    rolling, sliding = Chassis(base.scene, 1.0).rows(motion.hinge_angle_rad)
    moving = np.concatenate([seen.velocity, motion.hinge_rate_rad_per_s])
    assert rolling @ moving == pytest.approx(motion.wheel_speed_rad_per_s, abs=1e-9)
    assert sliding @ moving == pytest.approx(np.zeros(len(sliding)), abs=1e-9)


def test_a_car_reverses_along_the_same_circle() -> None:
    base = hinged_base("f1tenth")
    driven(base, 2.0, -1.0, 0.0, 0.8)
    assert base.look()[0].velocity == pytest.approx((-1.0, 0.0, 0.8), abs=2e-3)
    assert max(base.look()[0].hinge_rad) < 0.0  # to the right, as it turns left in reverse


def test_a_car_that_cannot_turn_so_tightly_keeps_its_speed() -> None:
    base = hinged_base("f1tenth")
    remarks = driven(base, 3.0, 1.0, 0.0, 9.0)
    assert len(remarks) == 1 and remarks[0].startswith("angular.z = 9 is impossible for these wheels and becomes 1.16")
    seen = base.look()[0]
    assert seen.velocity[0] == pytest.approx(1.0, abs=2e-3) and seen.velocity[2] == pytest.approx(1.163, abs=3e-3)
    assert max(seen.hinge_rad) == pytest.approx(0.4189, abs=1e-5)


def test_a_car_does_not_turn_on_the_spot_and_a_tricycle_does() -> None:
    assert "angular.z = 0.5 is impossible for these wheels and becomes 0" in driven(hinged_base("f1tenth"), 0.1, 0.0,
                                                                                    0.0, 0.5)
    tables = scene_tables("tugger_train").with_values({"vehicle.wheel[3].stop_high_rad": 1.6,
                                                       "vehicle.wheel[3].stop_low_rad": -1.6})
    del tables.entries["vehicle"]["trailer"], tables.entries["input"]
    base = hinged_base(tables.scene())
    driven(base, 4.0, 0.0, 0.0, 0.5)
    assert base.look()[0].velocity == pytest.approx((0.0, 0.0, 0.5), abs=2e-3)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("name", ["f1tenth", "frc_swerve_mk4i", "tricycle_agv"])
def test_the_smallest_of_all_commands_is_a_command(name: str) -> None:
    base = hinged_base(name)
    for command in ((5e-324, 0.0, 0.0), (0.0, 0.0, 5e-324), (1e-200, 1e-200, 1e-200), (0.2, 0.0, 0.0)):
        driven(base, 0.5, *command)
    assert base.look()[0].velocity[0] == pytest.approx(0.2, abs=0.02)


def test_a_swerve_drive_turns_its_wheels_the_shorter_way() -> None:
    base = hinged_base("frc_swerve_mk4i")
    driven(base, 1.0, 0.5, 0.0, 0.0)
    driven(base, 1.0, -0.5, 0.02, 0.0)
    seen = base.look()[0]
    assert max(map(abs, seen.hinge_rad)) < 0.1 and seen.velocity == pytest.approx((-0.5, 0.02, 0.0), abs=2e-3)


@pytest.mark.parametrize("first, second", [((0.0, 0.0, 1.0), (0.5, 0.5, 0.5)), ((0.3, 0.3, 1.0), (-0.3, -0.3, 1.0)),
                                           *(pytest.param(*each, marks=pytest.mark.nightly) for each in (
                                               ((0.0, 0.0, -1.0), (0.5, -0.5, 0.6)),
                                               ((0.5, 0.0, 0.0), (0.0, 0.0, 1.0))))])
def test_a_swerve_drive_keeps_turning_centres_out_of_its_wheels(first: tuple[float, ...], second: tuple[float, ...]
                                                                ) -> None:
    base = hinged_base("frc_swerve_mk4i")
    for command in (first, second, first):
        assert driven(base, 1.5, *command) == []
        assert base.look()[0].velocity == pytest.approx(command, abs=5e-3)


def test_a_turning_centre_in_a_wheel_is_moved_and_told() -> None:
    base = hinged_base("frc_swerve_mk4i")
    assert driven(base, 3.0, 0.26, -0.26, 1.0) == ["a turning centre in a steered wheel is moved beside it"]
    assert base.look()[0].velocity == pytest.approx((0.26, -0.26, 1.0), abs=0.02)


def test_a_wrong_wheelbase_makes_a_car_turn_less_than_it_believes() -> None:
    base = hinged_base(replace(read_scene("f1tenth"), base=BaseTable(believed_size=0.8)))
    driven(base, 3.0, 1.0, 0.0, 0.8)
    assert base.odometry[0].velocity == pytest.approx((1.0, 0.0, 0.8), abs=3e-3)
    assert base.look()[0].velocity[2] == pytest.approx(0.8 * 0.8, abs=3e-3)


def test_limits_of_speed_acceleration_and_steering_hold() -> None:
    table = BaseTable(speed_limit_m_per_s=0.8, acceleration_limit_m_per_s2=0.5, steering_rate_limit_rad_per_s=0.2)
    base = hinged_base(replace(read_scene("f1tenth"), base=table))
    assert driven(base, 0.5, 1.0, 0.0, 1.0)[-1] == "a speed of 1 m/s is limited to 0.8 m/s"
    seen = base.look()[0]
    assert seen.velocity[0] == pytest.approx(0.25, abs=0.05) and max(seen.hinge_rad) == pytest.approx(0.1, abs=2e-3)


def test_a_steering_motor_keeps_its_voltage_limit() -> None:
    base = hinged_base(replace(read_scene("tricycle_agv"), base=BaseTable(steering_voltage_limit_V=3.0)))
    base.record, base.is_recording = [], True
    driven(base, 3.0, 0.5, 0.0, 0.3)
    at = base.signals.index("hinge_voltage_V[front]")
    assert np.abs(np.array(base.record)[:, at]).max() == 3.0
    assert base.look()[0].velocity[2] == pytest.approx(0.3, abs=2e-3)


def test_placing_and_reset_put_the_hinges_back() -> None:
    base = hinged_base("tugger_train")
    ends = []
    for _ in range(2):
        driven(base, 1.0, 0.5, 0.0, 0.2)
        seen = base.look()[0]
        ends.append((seen.x_m, seen.y_m, seen.heading_rad, *seen.hinge_rad))
        base.reset(0)
    assert ends[0] == ends[1]
    base.place(0, 3.0, -2.0, 1.0)
    seen = base.look()[0]
    assert (seen.x_m, seen.y_m, seen.heading_rad) == pytest.approx((3.0, -2.0, 1.0))
    assert [*seen.hinge_rad] == [0.0] * 4 and seen.velocity == (0.0, 0.0, 0.0)


def test_several_vehicles_with_hinges_have_the_bits_of_one() -> None:
    one, many = hinged_base("f1tenth"), hinged_base("f1tenth", 2)
    one.command(0, 0.5, 0.0, 0.3)
    many.command(1, 0.5, 0.0, 0.3)
    one.advance(100)
    many.advance(100)
    assert one.look()[0].hinge_rad == many.look()[1].hinge_rad and one.look()[0].x_m == many.look()[1].x_m > 0.0
    assert many.look()[0].x_m == CAR_START_M


def test_a_hinge_at_its_stop_is_told_and_the_robot_stands() -> None:
    tables = scene_tables("tugger_train").with_values({"vehicle.trailer[1].stop_high_rad": 0.05,
                                                       "vehicle.trailer[1].stop_low_rad": -0.05})
    with rig_of(tables.scene()) as rig:
        rig.drive(200, 1.0, 0.4)
        assert any("(first): comes to its stop at -0.05 rad" in line and "stands until reset" in line
                   for line in rig.lines)
        rig.call("/laconic/reset", "std_srvs/srv/Empty")
        assert not rig.session.refusals


# ---- the wire

def test_a_car_follows_ackermann_commands_and_its_watchdog_stops_it() -> None:
    with rig_of("f1tenth") as rig:
        drive_by_angle(rig, 100, speed=1.0, steering_angle=0.2)
        assert rig.session.base.look()[0].velocity == pytest.approx((1.0, 0.0, math.tan(0.2) / 0.3302), abs=2e-3)
        rig.turn(110)
        assert abs(rig.session.base.look()[0].velocity[0]) < 1e-3
        assert rig.lines == ["/laconic: ackermann_cmd was silent for 0.5 s, so the robot stops"]


def test_a_car_steers_while_it_stands() -> None:
    with rig_of("f1tenth") as rig:
        drive_by_angle(rig, 30, "drive", steering_angle=0.3)
        seen = rig.session.base.look()[0]
        assert math.tan(min(seen.hinge_rad)) < math.tan(0.3) < math.tan(max(seen.hinge_rad))
        assert (seen.x_m, seen.y_m) == pytest.approx((0.0, 0.0), abs=1e-9)


@by_day("f1tenth", "wheel_loader", of=CARS)
def test_a_steering_angle_is_that_of_a_wheel_on_the_middle_line(name: str) -> None:
    base = hinged_base(name)
    base_m = base.believed.wheelbase_m
    assert base_m is not None
    assert base.ackermann(0, 0.5, 0.15) == []
    base.advance(round(3.0 / base.step_s))
    seen = base.look()[0]
    assert seen.velocity[2] == pytest.approx(0.5 * math.tan(0.15) / base_m, abs=2e-3)


def test_limits_of_an_ackermann_command_are_kept_and_told() -> None:
    with rig_of("f1tenth") as rig:
        drive_by_angle(rig, 25, speed=1.0, acceleration=0.5, steering_angle=0.9, steering_angle_velocity=0.1, jerk=1.0)
        seen = rig.session.base.look()[0]
        assert seen.velocity[0] == pytest.approx(0.25, abs=0.05) and 0.0 < max(seen.hinge_rad) < 0.06
        assert [line.partition(": ")[2] for line in rig.lines] == [
            "a command on ackermann_cmd limits the jerk, which the base leaves out",
            "ackermann_cmd: a steering angle of 0.9 rad is limited to 0.366753 rad"]


@pytest.mark.parametrize("value", [float("nan"), float("inf"), 2.0])
def test_an_ackermann_command_that_cannot_be_is_ignored(value: float) -> None:
    with rig_of("f1tenth") as rig:
        drive_by_angle(rig, 10, speed=1.0, steering_angle=value)
        assert rig.session.base.look()[0].x_m == 0.0
        assert len(rig.lines) == 1 and "or an angle of a right angle or more, and is ignored" in rig.lines[0]


@pytest.mark.parametrize("field", ["acceleration", "steering_angle_velocity", "jerk"])
def test_a_limit_below_0_is_refused_by_name(field: str) -> None:
    with rig_of("f1tenth") as rig:
        drive_by_angle(rig, 10, speed=1.0, **{field: -1.0})
        assert rig.session.base.look()[0].x_m == 0.0
        assert rig.lines == [f"/laconic: a command on ackermann_cmd has {field} = -1, and is ignored; give limits "
                             "above 0, for both ways, or 0 for those of the scene"]


@pytest.mark.parametrize("name", ["f1tenth", "canopen_agv"])
def test_odometry_and_truth_begin_at_one_pose_of_the_base(name: str) -> None:
    with rig_of(name) as rig:
        odoms, truths = (rig.node.subscription(topic, "nav_msgs/msg/Odometry")
                         for topic in ("odom", "ground_truth/odom"))
        rig.turn()
        places = [(each.pose.pose.position.x, each.pose.pose.position.y) for each in (last(odoms), last(truths))]
        assert places == [(0.0, 0.0), (0.0, 0.0)]
        rig.drive(60, 0.5, 0.2)
        here, truth = last(odoms).pose.pose.position, last(truths).pose.pose.position
        assert (here.x, here.y) == pytest.approx((truth.x, truth.y), abs=2e-3) and truth.x > 0.3
        rig.call("/laconic/reset", "std_srvs/srv/Empty")
        assert rig.session.base.look()[0].x_m == 0.0


def test_a_trailer_that_folds_is_told_once() -> None:
    with rig_of("tugger_train") as rig:
        rig.drive(700, -1.0, 0.1)
        told = [line for line in rig.lines if " folds" in line]
        assert told and len(told) == len({*told}) and told[0].startswith("/laconic: ")
        assert "its hinge angle is beyond 90°; a real one would hit what draws it" in told[0]


def test_ackermann_commands_of_what_is_no_car_are_told() -> None:
    with rig_of("mir_like") as rig:
        drive_by_angle(rig, 40, speed=1.0)
        assert rig.lines == ["/laconic: a publisher on ackermann_cmd sends ackermann_msgs/msg/AckermannDriveStamped, "
                             "which is for cars with a fixed axle and steered wheels; send Twist on cmd_vel"]


def test_joint_states_and_transforms_show_the_hinges() -> None:
    with rig_of("tugger_train") as rig:
        joints, transforms = rig.node.subscription("joint_states", JOINTS), rig.node.subscription(
            "/tf", "tf2_msgs/msg/TFMessage")
        rig.drive(150, 1.0, 0.3)
        state, links = last(joints), last(transforms).transforms
        assert list(state.name)[-4:] == ["front_hinge_joint", "first_hinge_joint", "second_hinge_joint",
                                         "third_hinge_joint"]
        seen = rig.session.base.look()[0]
        assert list(state.position) == [*seen.angle_rad, *seen.hinge_rad]
        assert list(state.velocity) == [*seen.speed_rad_per_s, *seen.hinge_rate_rad_per_s]
        assert [(each.header.frame_id, each.child_frame_id) for each in links] == [
            ("odom", "base_link"), ("base_link", "first"), ("first", "second"), ("second", "third")]
        assert 2.0 * math.asin(links[1].transform.rotation.z) == pytest.approx(seen.hinge_rad[1])
        assert links[2].transform.translation.x == -1.8


@by_day("f1tenth", "tugger_train", "frc_swerve_mk4i",
        of=("f1tenth", "tugger_train", "tricycle_agv", "frc_swerve_mk4i", "wheelchair"))
def test_a_recorded_run_with_hinges_has_the_bits_of_simulate(name: str, tmp_path: Path) -> None:
    path = tmp_path / "recorded.toml"
    with rig_of(name, record=path) as rig:
        rig.drive(40, 0.8, 0.6)
        rig.turn(40)                        # the watchdog stops it
        rig.drive(30, -0.4, 0.9)
        steps = write_record(rig.session)
        assert steps == 110 * rig.session.steps
        motion = rig.session.base.motion.robots[0].motion
    scene = laconic.read_scene(path)
    run = laconic.simulate(scene, kept_signals_with_hinges(scene, ()))
    for name, values in (("wheel_angle_rad", motion.wheel_angle_rad), ("wheel_speed_rad_per_s",
                                                                       motion.wheel_speed_rad_per_s)):
        assert [float(run.columns[f"{name}[{i}]"][-1]) for i in range(1, len(values) + 1)] == values.tolist()
    assert [float(run.columns[f"hinge_angle_rad[{each.name}]"][-1]) for each in scene.hinges] == \
        motion.hinge_angle_rad.tolist()
    assert (run.columns["x_m"][-1], run.columns["heading_rad"][-1]) == (motion.x_m, motion.heading_rad)
    assert abs(motion.x_m) > 0.1


# ---- [base]

@pytest.mark.parametrize("table, message", [
    ({"joint_names": ["a", "b"]}, "base.joint_names: needs a name of its own for each of the 4 wheels; give 4 "
                                      "names, or 6"),
    ({"steering_rate_limit_rad_per_s": 0.0}, "base.steering_rate_limit_rad_per_s: is 0; give a value above 0")])
def test_a_wrong_base_table_of_a_car_is_one_line(table: dict[str, Any], message: str) -> None:
    with pytest.raises(BadInput, match=message):
        build_scene(scene_tables("f1tenth").entries | {"base": table})


def test_a_base_table_names_the_hinges_too() -> None:
    names = ["rl", "rr", "fl", "fr", "left", "right"]
    scene = build_scene(scene_tables("f1tenth").entries | {"base": {"joint_names": names}})
    assert hinged_base(scene).joint_names == names
    with pytest.raises(BadInput, match="steering_voltage_limit_V: has no effect: no wheel of this vehicle is steered"):
        build_scene(scene_tables("robotino2").entries | {"base": {"steering_voltage_limit_V": 1.0}})


def test_ground_with_friction_is_not_taken_for_ideal_ground() -> None:
    scene = read_scene("f1tenth")
    slippery = replace(scene, vehicle=scene.vehicle | {"ground": {"friction_coefficient": 0.5}})
    with pytest.raises(BadInput, match="ground.friction_coefficient: laconic ros2 drives vehicles with hinges"):
        base_of(slippery)


def test_a_robot_whose_driven_wheels_hang_on_casters_is_refused() -> None:
    tables = scene_tables("mir_like").with_values({"vehicle.wheel[*].driven": False, "vehicle.caster[1].driven": True})
    tables.entries.pop("input", None)
    with pytest.raises(BadInput, match="no driven wheel is on the carriage or on what steers"):
        base_of(tables.scene())
