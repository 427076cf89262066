"""The base without a wire: commands in, motion and odometry out, in virtual time."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import laconic
from laconic.errors import BadInput
from laconic.ros2.base import Base
from laconic.ros2.motion import Lanes, Singles
from laconic.scene import build_scene, read_scene
from laconic.scene.base import BaseTable
from laconic.scene.hinges import rigid_scene_names
from laconic.scene.scene_tables import scene_tables

ROBOTS = ("turtlebot3_burger", "robotino2", "kuka_youbot", "canopen_agv", "optiodom_omni4")
OMNI = ("robotino2", "kuka_youbot", "optiodom_omni4")


def driven(base: Base, seconds: float, *command: float, every: int = 20) -> None:
    base.command(0, *command)
    for _ in range(round(seconds / base.step_s / every)):
        assert base.advance(every) == []
        base.look()


@pytest.mark.parametrize("name", ROBOTS)
def test_a_base_reaches_the_commanded_velocity(name: str) -> None:
    base = Base(read_scene(name))
    driven(base, 2.0, 0.2, 0.0, 0.4)
    assert base.look()[0].velocity == pytest.approx((0.2, 0.0, 0.4), abs=1e-4)


@pytest.mark.parametrize("name", OMNI)
def test_an_omni_base_goes_sideways(name: str) -> None:
    base = Base(read_scene(name))
    assert base.command(0, 0.0, 0.15, 0.0) == []
    driven(base, 2.0, 0.0, 0.15, 0.0)
    assert base.look()[0].velocity == pytest.approx((0.0, 0.15, 0.0), abs=1e-4)


@pytest.mark.parametrize("name", ROBOTS)
def test_nothing_moves_without_a_command(name: str) -> None:
    base = Base(read_scene(name))
    before = base.look()[0]
    base.advance(500)
    after = base.look()[0]
    assert (after.x_m, after.y_m, after.heading_rad) == (before.x_m, before.y_m, before.heading_rad)
    assert base.odometry[0].x_m == 0.0


@pytest.mark.parametrize("name", ROBOTS)
def test_odometry_on_ideal_ground_is_the_motion(name: str) -> None:
    base = Base(read_scene(name))
    start = base.look()[0]
    driven(base, 3.0, 0.2, 0.0, 0.5)
    seen, believed = base.look()[0], base.odometry[0]
    assert believed.x_m == pytest.approx(seen.x_m - start.x_m, abs=1e-4)
    assert believed.y_m == pytest.approx(seen.y_m - start.y_m, abs=1e-4)
    assert believed.heading_rad == pytest.approx(seen.heading_rad, abs=1e-9)


def test_odometry_of_a_base_that_slips_differs_from_the_motion() -> None:
    base = Base(read_scene("skid_steer"))
    driven(base, 3.0, 0.3, 0.0, 0.6)
    assert base.odometry[0].heading_rad > 1.2 * base.look()[0].heading_rad > 0.1
    assert "wheels slip" in base.motion.grip(0)


def test_a_wrong_radius_makes_it_drive_further_than_it_believes() -> None:
    scene = read_scene("turtlebot3_burger")
    base = Base(replace(scene, base=BaseTable(believed_radius_m=(0.030, 0.030))))
    driven(base, 4.0, 0.2, 0.0, 0.0)
    seen, believed = base.look()[0], base.odometry[0]
    assert seen.velocity[0] == pytest.approx(0.2 * 0.033 / 0.030, rel=1e-6)
    assert seen.x_m == pytest.approx(believed.x_m * 0.033 / 0.030, rel=1e-6)


def test_a_wrong_track_makes_it_turn_less_than_it_believes() -> None:
    base = Base(replace(read_scene("turtlebot3_burger"), base=BaseTable(believed_size=0.9)))
    driven(base, 4.0, 0.1, 0.0, 0.5)
    assert base.look()[0].heading_rad == pytest.approx(0.9 * base.odometry[0].heading_rad, rel=1e-6)


def test_odometry_has_the_resolution_of_the_encoders() -> None:
    tables = scene_tables("turtlebot3_burger").entries | {"sensors": {"encoder": {"counts_per_turn": 60, "wrap": 50}}}
    base = Base(build_scene(tables))
    driven(base, 6.0, 0.2, 0.0, 0.0)
    seen, believed = base.look()[0], base.odometry[0]
    count_m = 2.0 * math.pi * 0.033 / 60
    assert believed.x_m / count_m == pytest.approx(round(believed.x_m / count_m), abs=1e-6)
    assert 0.0 <= seen.x_m - believed.x_m < count_m + 1e-9
    assert believed.x_m > 3 * 50 * count_m  # the counters have wrapped


def test_limits_hold_and_are_told() -> None:
    table = BaseTable(speed_limit_m_per_s=0.2, yaw_rate_limit_rad_per_s=1.0, acceleration_limit_m_per_s2=0.5)
    base = Base(replace(read_scene("turtlebot3_burger"), base=table))
    remarks = base.command(0, 0.4, 0.1, 3.0)
    assert [remark.split(" = ")[0].split(" of")[0] for remark in remarks] == ["linear.y", "a speed", "a yaw rate"]
    base.advance(200)
    assert base.look()[0].velocity[0] == pytest.approx(0.1, abs=0.03)  # by 0.5 m/s² after 0.2 s, with the loop's lag
    base.advance(2000)
    assert base.look()[0].velocity == pytest.approx((0.2, 0.0, 1.0), abs=1e-6)


def test_a_voltage_limit_holds_without_windup() -> None:
    base = Base(replace(read_scene("turtlebot3_burger"), base=BaseTable(voltage_limit_V=3.0)))
    base.record, base.is_recording = [], True
    driven(base, 3.0, 0.5, 0.0, 0.0)
    assert np.abs(base.record).max() == 3.0
    assert base.limited[:, 0].any()
    driven(base, 0.5, 0.02, 0.0, 0.0)
    assert base.look()[0].velocity[0] == pytest.approx(0.02, abs=1e-3)


def test_the_bits_of_several_are_those_of_one() -> None:
    scene = read_scene("robotino2")
    one, many = Base(scene), Base(scene, 5)
    assert isinstance(one.motion, Singles) and isinstance(many.motion, Lanes)
    for robot in range(5):
        many.command(robot, 0.1 * robot, 0.05, 0.3)
    one.command(0, 0.1 * 4, 0.05, 0.3)
    for _ in range(50):
        one.advance(20)
        many.advance(20)
        seen, same = one.look()[0], many.look()[4]
        assert (seen.x_m, seen.y_m, seen.heading_rad, seen.velocity, seen.angle_rad, seen.speed_rad_per_s) == (
            same.x_m, same.y_m, same.heading_rad, same.velocity, same.angle_rad, same.speed_rad_per_s)


def test_robots_with_friction_run_side_by_side() -> None:
    base = Base(read_scene("skid_steer"), 2)
    assert isinstance(base.motion, Singles)
    base.command(1, 0.3, 0.0, 0.0)
    base.advance(1000)
    still, moving = base.look()
    assert abs(still.x_m - moving.x_m) > 0.2
    assert still.supply is not None and moving.supply is not None
    assert moving.supply[1] > still.supply[1] >= 0.0


@pytest.mark.parametrize("robots", [1, 3])
def test_placing_moves_the_robot_and_not_its_odometry(robots: int) -> None:
    base = Base(read_scene("canopen_agv"), robots)
    driven(base, 1.0, 0.2, 0.0, 0.0)
    before = base.odometry[0].x_m
    base.place(0, 3.0, -2.0, 1.0)
    seen = base.look()[0]
    assert (seen.x_m, seen.y_m, seen.heading_rad) == pytest.approx((3.0, -2.0, 1.0), abs=1e-12)
    assert base.odometry[0].x_m == before
    base.advance(100)
    assert base.look()[0].velocity == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("robots", [1, 3])
def test_reset_gives_the_same_bits_again(robots: int) -> None:
    base = Base(read_scene("robotino2"), robots)
    ends = []
    for _ in range(2):
        driven(base, 1.0, 0.2, 0.1, 0.3)
        seen = base.look()[0]
        ends.append((seen.x_m, seen.y_m, seen.heading_rad, base.odometry[0].x_m))
        base.reset(0)
    assert ends[0] == ends[1]


def test_a_refused_step_leaves_the_others_running() -> None:
    base = Base(replace(read_scene("robotino2"), base=BaseTable(gain_Vs_per_rad=1e306)), 2)
    base.command(0, 0.5, 0.0, 0.0)
    refused = base.advance(10)
    assert [robot for robot, _ in refused] == [0]
    assert np.isfinite(base.look()[1].x_m)
    base.reset(0)
    assert base.look()[0].x_m == base.look()[1].x_m


def test_an_arc_is_integrated_exactly() -> None:
    base = Base(read_scene("turtlebot3_burger"))
    odometry = base._new_odometry()
    rates = base.beliefs.rows @ np.array([0.3, 0.0, 0.7])
    for second in range(4):  # coarse looks at a motion of constant velocity
        odometry.see(rates * second, 1.0 if second else 0.0)
    assert odometry.x_m == pytest.approx(0.3 / 0.7 * math.sin(2.1), abs=1e-12)
    assert odometry.y_m == pytest.approx(0.3 / 0.7 * (1.0 - math.cos(2.1)), abs=1e-12)


def test_a_robot_whose_wheels_all_idle_is_refused(tmp_path: Path) -> None:
    tables = scene_tables("turtlebot3_burger").with_values({"vehicle.wheel[*].driven": False})
    del tables.entries["input"]
    with pytest.raises(BadInput, match="none is driven"):
        Base(tables.scene())


@pytest.mark.parametrize("table, message", [
    ({"gain_Nms_per_rad": 1.0}, "base.gain_Nms_per_rad: has no effect: the vehicle has a motor"),
    ({"believed_radius_m": [0.03]}, "base.believed_radius_m"),
    ({"believed_radius_m": -1.0}, "base.believed_radius_m: is -1; give a value above 0"),
    ({"joint_names": ["a", "a"]}, "base.joint_names: needs a name of its own for each of the 2 wheels"),
    ({"watchdog_s": 0.0}, "base.watchdog_s: is 0; give a value above 0"),
    ({"watchdog": 1.0}, "base.watchdog: is no known key here"),
])
def test_a_wrong_base_table_is_one_line(table: dict, message: str) -> None:
    tables = scene_tables("turtlebot3_burger").entries | {"base": table}
    with pytest.raises(BadInput, match=message):
        build_scene(tables)


def test_a_vehicle_without_a_motor_takes_torques() -> None:
    tables = scene_tables("canopen_agv").entries
    assert Base(build_scene(tables | {"base": {"torque_limit_Nm": 5.0}})).loop.signal == "axle_torque_Nm"
    with pytest.raises(BadInput, match="base.voltage_limit_V: has no effect: the vehicle has no motor"):
        build_scene(tables | {"base": {"voltage_limit_V": 5.0}})


def test_gains_of_the_scene_are_used() -> None:
    scene = read_scene("turtlebot3_burger")
    base = Base(replace(scene, base=BaseTable(gain_Vs_per_rad=0.5, integral_gain_V_per_rad=3.0)))
    assert base.loop.gain.ravel().tolist() == [0.5, 0.5]
    assert base.loop.integral_gain.ravel().tolist() == [3.0, 3.0]


def test_scenes_without_a_base_table_have_none() -> None:
    assert laconic.read_scene("robotino2").base is None


def test_a_locked_wheel_does_not_count_in_the_odometry() -> None:
    tables = scene_tables("optiodom_omni4").with_values({"vehicle.wheel[4].locked": True})
    tables.entries.pop("input", None)
    base = Base(tables.scene())
    start = base.look()[0]
    driven(base, 2.0, 0.1, 0.1, 0.2)
    seen, believed = base.look()[0], base.odometry[0]
    assert base.motion.measured.tolist() == [True, True, True, False]
    assert believed.heading_rad == pytest.approx(seen.heading_rad, abs=1e-6)
    assert math.hypot(believed.x_m, believed.y_m) == pytest.approx(math.hypot(seen.x_m - start.x_m,
                                                                              seen.y_m - start.y_m), abs=1e-4)


@pytest.mark.parametrize("name", rigid_scene_names())
def test_every_scene_without_hinges_drives(name: str) -> None:
    base = Base(read_scene(name))
    base.command(0, 0.1, 0.0, 0.2)
    assert base.advance(200) == []
    assert np.isfinite([*base.look()[0].velocity, base.odometry[0].x_m]).all()


def test_a_base_in_single_precision_follows_too() -> None:
    for robots in (1, 2):
        base = Base(read_scene("robotino2").with_run(real="single"), robots)
        driven(base, 2.0, 0.2, 0.1, 0.3)
        assert base.look()[0].velocity == pytest.approx((0.2, 0.1, 0.3), abs=1e-3)


def test_a_base_whose_origin_is_not_its_centre_of_mass_turns_about_the_origin() -> None:
    base = Base(read_scene("canopen_agv"))
    driven(base, 4.0, 0.0, 0.0, 0.5)
    seen, start = base.look()[0], Base(read_scene("canopen_agv")).look()[0]
    assert (seen.x_m, seen.y_m) == pytest.approx((start.x_m, start.y_m), abs=1e-3)
    assert seen.heading_rad > 1.5
