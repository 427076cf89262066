"""Robots on the wire, heard and driven by a peer in the same process, in virtual time; then the command itself."""

from __future__ import annotations

import json
import math
import os
import re
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication, BuiltinTopicDcpsSubscription
from cyclonedds.qos import Policy

import laconic
import made_up_robots
from laconic.base.extras import extra_of
from laconic.cli.main import run
from laconic.errors import BadInput
from laconic.ros2.messages import new, type_hash
from laconic.ros2.names import LATCHED, Quality, check_name, polled, ros_type
from laconic.ros2.packets import HERE
from laconic.ros2.session import Ros2Options, Session, write_record
from laconic.scene import build_scene, read_scene
from laconic.scene.scene_tables import scene_tables
from ros2_support import DOMAIN, WALL_NS, announced, last, rig_of

TWIST = "geometry_msgs/msg/Twist"
ODOMETRY, TF = "nav_msgs/msg/Odometry", "tf2_msgs/msg/TFMessage"
USUAL_TOPICS = {"rt/odom": ODOMETRY, "rt/ground_truth/odom": ODOMETRY, "rt/tf": TF, "rt/tf_static": TF,
                "rt/joint_states": "sensor_msgs/msg/JointState", "rt/imu": "sensor_msgs/msg/Imu",
                "rt/diagnostics": "diagnostic_msgs/msg/DiagnosticArray"}


def yaw_of(rotation: Any) -> float:
    return 2.0 * math.atan2(rotation.z, rotation.w)


# ---- topics

def test_a_driven_robot_is_heard_on_every_topic() -> None:
    with rig_of() as rig:
        readers = {name: rig.node.subscription(name.removeprefix("rt"), kind) for name, kind in USUAL_TOPICS.items()
                   if name not in ("rt/tf_static", "rt/diagnostics")}
        rig.drive(150, 0.2, 0.5)
        found = {name: last(reader) for name, reader in readers.items()}
        seen = rig.session.base.look()[0]
        stamp = WALL_NS + round(149 * 0.02 * 1e9)
        odom, truth = found["rt/odom"], found["rt/ground_truth/odom"]
        assert odom.header.stamp.sec * 10**9 + odom.header.stamp.nanosec == stamp
        assert (odom.header.frame_id, odom.child_frame_id) == ("odom", "base_link")
        assert (truth.header.frame_id, truth.child_frame_id) == ("map", "base_link")
        assert (truth.pose.pose.position.x, truth.pose.pose.position.y) == (seen.x_m, seen.y_m)
        assert yaw_of(odom.pose.pose.orientation) == pytest.approx(seen.heading_rad, abs=1e-6)
        assert odom.twist.twist.linear.x == pytest.approx(0.2, abs=1e-3)
        link = found["rt/tf"].transforms[0]
        assert (link.header.frame_id, link.child_frame_id) == ("odom", "base_link")
        assert link.transform.translation.x == odom.pose.pose.position.x
        joints = found["rt/joint_states"]
        assert list(joints.name) == ["wheel_left_joint", "wheel_right_joint"]
        assert list(joints.position) == seen.angle_rad and list(joints.velocity) == seen.speed_rad_per_s
        imu = found["rt/imu"]
        assert imu.angular_velocity.z == pytest.approx(0.5, abs=1e-3)
        assert imu.linear_acceleration.y == pytest.approx(0.1, abs=1e-3)  # to the centre of the curve
        assert imu.linear_acceleration.z == 9.80665


@pytest.mark.parametrize("kind", ["Twist", "TwistStamped"])
def test_both_kinds_of_command_are_heard(kind: str) -> None:
    with rig_of() as rig:
        writer = rig.node.publisher("cmd_vel", f"geometry_msgs/msg/{kind}")
        message = rig.twist(0.1) if kind == "Twist" else new("geometry_msgs/msg/TwistStamped", twist=rig.twist(0.1))
        rig.turn(60, lambda: writer.write(message))
        assert rig.session.base.look()[0].velocity[0] == pytest.approx(0.1, abs=1e-3)


def test_stamped_hears_no_plain_twist() -> None:
    with rig_of(is_stamped=True) as rig:
        rig.drive(30, 0.1)
        assert rig.session.base.look()[0].x_m == 0.0
        assert rig.lines == ["/laconic: a publisher on cmd_vel sends geometry_msgs/msg/Twist, which is not heard; send "
                             "TwistStamped"]


def test_unstamped_has_one_type_on_the_topic() -> None:
    with rig_of(is_stamped=False) as rig:
        readers = BuiltinDataReader(rig.peer.dds, BuiltinTopicDcpsSubscription).take(N=500)
        types = {each.type_name for each in readers if getattr(each, "topic_name", "") == "rt/cmd_vel"}
        assert types == {"geometry_msgs::msg::dds_::Twist_"}
        rig.drive(60, 0.1)
        assert rig.session.base.look()[0].velocity[0] == pytest.approx(0.1, abs=1e-3)


def test_who_comes_late_gets_what_is_latched(tmp_path: Path) -> None:
    urdf = tmp_path / "robot.urdf"
    urdf.write_text('<robot name="r"><joint name="wheel_left_joint"/><joint name="wheel_right_joint"/></robot>')
    with rig_of(urdf=urdf) as rig:
        rig.turn(5)
        static = last(rig.node.subscription("/tf_static", TF, LATCHED))
        frames = [(each.header.frame_id, each.child_frame_id) for each in static.transforms]
        assert frames == [("base_link", "imu_link")]
        text = last(rig.node.subscription("/robot_description", "std_msgs/msg/String", LATCHED))
        assert text.data == urdf.read_text()
        assert rig.lines == []


def test_a_urdf_with_other_joints_is_told(tmp_path: Path) -> None:
    urdf = tmp_path / "robot.urdf"
    urdf.write_text('<robot name="r"><joint name="left"/></robot>')
    with rig_of(urdf=urdf) as rig:
        assert rig.lines == [f"{urdf}: has no joint wheel_left_joint, wheel_right_joint; give its wheel joints in the "
                             "scene, as [base] joint_names"]


def test_a_supply_has_a_battery_state() -> None:
    with rig_of("skid_steer") as rig:
        reader = rig.node.subscription("battery_state", "sensor_msgs/msg/BatteryState")
        rig.drive(20, 0.3)
        state = last(reader)
        assert state.present and 20.0 < state.voltage <= 24.0 and state.current < 0.0
        assert math.isnan(state.percentage)


def test_diagnostics_tell_of_slip_and_commands() -> None:
    with rig_of("skid_steer") as rig:
        reader = rig.node.subscription("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray")
        rig.drive(120, 0.3, 0.6)
        status = last(reader).status[0]
        assert status.name == "/laconic: base" and status.level == 1 and "wheels slip" in status.message
        assert int({each.key: each.value for each in status.values}["commands"]) > 90


def test_the_terminal_tells_of_slip_and_of_a_limit_that_holds() -> None:
    with rig_of("skid_steer") as rig:
        rig.drive(120, 0.3, 0.6)
        assert [line.partition(":")[0] for line in rig.lines if "wheels slip: " in line] == ["/laconic"]
    scene = read_scene("turtlebot3_burger")
    with rig_of(replace(scene, base=replace(scene.base, voltage_limit_V=2.0))) as rig:
        rig.drive(120, 0.2)
        assert [line for line in rig.lines if "limit" in line] == [
            "/laconic: wheels 1 and 2 are at their limit of 2 V (base.voltage_limit_V), so the robot follows more "
            "slowly than commanded; command less, give base.acceleration_limit_m_per_s2, or raise the limit"]


def test_other_frames_by_name() -> None:
    with rig_of(frames=("base=base_footprint", "odom=odometry")) as rig:
        reader = rig.node.subscription("odom", ODOMETRY)
        rig.turn()
        odom = last(reader)
        assert (odom.header.frame_id, odom.child_frame_id) == ("odometry", "base_footprint")


# ---- names, quality of service, graph

@pytest.mark.parametrize("distribution", ["humble", "jazzy", "kilted"])
def test_writers_are_announced_as_ros_does(distribution: str) -> None:
    with rig_of(distribution=distribution) as rig:
        found = announced(rig.peer, BuiltinTopicDcpsPublication)
        for name, kind in USUAL_TOPICS.items():
            package, _, last_name = kind.split("/")
            writer = found[name]
            assert writer.type_name == f"{package}::msg::dds_::{last_name}_"
            assert isinstance(writer.qos[Policy.Reliability], Policy.Reliability.Reliable)
            latched = writer.qos[Policy.Durability] == Policy.Durability.TransientLocal
            assert latched == (name == "rt/tf_static")
            assert not writer.qos[Policy.WriterDataLifecycle].autodispose
            data = writer.qos[Policy.Userdata].data if Policy.Userdata in writer.qos else b""
            assert data == (b"" if distribution == "humble" else f"typehash={type_hash(kind)};".encode())


def test_the_participant_has_an_enclave() -> None:
    with rig_of() as rig:
        qos = rig.session.participant.dds.get_qos()
        assert bytes(qos[Policy.Userdata].data) == b"enclave=/;"


@pytest.mark.parametrize("distribution, bytes_of_gid", [("humble", 24), ("jazzy", 16)])
def test_the_graph_has_node_and_endpoints(distribution: str, bytes_of_gid: int) -> None:
    with rig_of(distribution=distribution, namespace="/floor1", services_for=("fastrtps",)) as rig:
        infos = polled(rig.peer._others)
        info = next(each for each in infos if each.node_entities_info_seq and
                    each.node_entities_info_seq[0].node_name == "laconic")
        node = info.node_entities_info_seq[0]
        assert node.node_namespace == "/floor1"
        assert len(info.gid.data) == bytes_of_gid
        writers = announced(rig.peer, BuiltinTopicDcpsPublication).values()
        readers = announced(rig.peer, BuiltinTopicDcpsSubscription).values()
        known = {bytes(each.key.bytes) for each in (*writers, *readers)}
        gids = [bytes(each.data)[:16] for each in (*node.writer_gid_seq, *node.reader_gid_seq)]
        assert sum(gid[:2] == HERE for gid in gids) == 16  # services for Fast DDS, by a participant of their own
        gids = [gid for gid in gids if gid[:2] != HERE]
        assert len(gids) == 9 and len(set(gids)) == len(gids)
        assert sum(gid in known for gid in gids) >= len(gids) - 1  # two readers share the name of cmd_vel


def test_without_discovery_info_there_is_no_node() -> None:
    with rig_of(announces=False) as rig:
        assert all(not each.node_entities_info_seq or each.node_entities_info_seq[0].node_name != "laconic"
                   for each in polled(rig.peer._others))


def test_a_namesake_is_told_once() -> None:
    with rig_of() as rig:
        rig.peer.node("laconic")
        rig.peer.announce()
        rig.turn(60)
        assert rig.lines == [f"another node is called /laconic in domain {DOMAIN}; give --namespace or --domain"]


def test_names_that_ros_does_not_allow_are_refused() -> None:
    assert check_name("--namespace", "fleet/a_1/") == "/fleet/a_1"
    for name in ("1robot", "a b", "a//b", "rob-ot"):
        with pytest.raises(BadInput, match="is not a name of ROS"):
            check_name("--namespace", name)
    assert ros_type("std_msgs::msg::dds_::String_") == "std_msgs/msg/String"
    assert ros_type("Plain") == "Plain"


# ---- several robots

def test_each_of_several_robots_hears_its_own_commands() -> None:
    with rig_of(robots=3, namespace="/fleet") as rig:
        readers = [rig.node.subscription(f"/fleet/robot{number}/odom", ODOMETRY) for number in (1, 2, 3)]
        rig.drive(60, 0.1, topic="/fleet/robot2/cmd_vel")
        ends = [last(reader).pose.pose.position.x for reader in readers]
        assert ends[0] == ends[2] == 0.0 and ends[1] > 0.05
        places = [seen.y_m for seen in rig.session.base.look()]
        assert places == [0.0, 1.0, 2.0]


def test_transforms_stay_in_the_namespace_or_are_shared() -> None:
    with rig_of(robots=2) as rig:
        reader = rig.node.subscription("/robot1/tf", TF)
        rig.turn()
        assert last(reader).transforms[0].child_frame_id == "base_link"
    with rig_of(robots=2, shares_tf=True) as rig:
        reader = rig.node.subscription("/tf", TF)
        rig.turn()
        assert {each.transforms[0].child_frame_id for each in polled(reader)} == {"robot1/base_link",
                                                                                 "robot2/base_link"}


# ---- time

def test_simulated_time_is_on_the_clock_and_in_all_stamps() -> None:
    with rig_of(is_sim_time=True, speed=4.0) as rig:
        clocks, odoms = rig.node.subscription("/clock", "rosgraph_msgs/msg/Clock"), rig.node.subscription(
            "odom", ODOMETRY)
        rig.turn(10)
        assert [each.clock.nanosec for each in polled(clocks)] == [20_000_000 * n for n in range(1, 11)]
        assert [each.header.stamp.nanosec for each in polled(odoms)] == [20_000_000 * n for n in range(1, 11)]


def test_the_loop_runs_as_fast_as_it_shall() -> None:
    with rig_of(is_sim_time=True, speed=4.0, duration_s=2.0) as rig:
        rig.session.run()
        assert rig.session.cycles == 100
        assert rig.time.time_s == pytest.approx(99 * 0.02 / 4.0)


def test_a_machine_that_sleeps_is_told_and_not_made_up_for() -> None:
    with rig_of(duration_s=1.0) as rig:
        rig.time.overslept_s = 30.0
        rig.session.run()
        assert rig.session.cycles == 50
        assert rig.lines == ["the machine was 30 s too late for a cycle; the robot's time stood still meanwhile"]
        assert rig.session.lateness.skipped_s == pytest.approx(30.0)


@pytest.mark.nightly
def test_a_long_run_prints_a_line_each_minute() -> None:
    with rig_of(rate_Hz=10.0, duration_s=130.0) as rig:
        rig.session.run()
        assert rig.lines == [f"{seconds} s of the robot's time: 0 commands heard, 0 cycles late"
                             for seconds in (60, 120)]


@pytest.mark.parametrize("jump_s", [-3600.0, 10.0])
def test_a_jump_of_the_system_clock_is_told_and_changes_no_motion(jump_s: float) -> None:
    ends = []
    for jump in (0.0, jump_s):
        with rig_of() as rig:
            reader = rig.node.subscription("odom", ODOMETRY, Quality(100))
            rig.drive(20, 0.1)
            rig.time.wall_offset_ns += round(jump * 1e9)
            rig.drive(20, 0.1)
            ends.append(rig.session.base.look()[0].x_m)
            stamps = [each.header.stamp.sec for each in polled(reader, most=100)]
            assert stamps[-1] - stamps[0] == pytest.approx(jump, abs=2)
            told = [line for line in rig.lines if "clock jumped" in line]
            assert len(told) == (1 if jump else 0)
    assert ends[0] == ends[1] > 0.0


@pytest.mark.parametrize("rate, message", [(300.0, "--rate: a period of 0.00333333 s is not a whole number of steps"),
                                           (0.0, "--rate: 0 Hz"), (5000.0, "give 1000 Hz"),
                                           (float("nan"), "--rate: nan")])
def test_a_rate_that_does_not_fit_is_refused(rate: float, message: str) -> None:
    with pytest.raises(BadInput, match=re.escape(message)):
        Session(read_scene("turtlebot3_burger"), Ros2Options(rate_Hz=rate, domain=DOMAIN, is_local=True))


@pytest.mark.parametrize("options, message", [
    ({"robots": 0}, "--robots: 0"), ({"speed": 2.0}, "--speed: 2 needs stamps of simulated time; add --sim-time"),
    ({"duration_s": -1.0}, "--duration: -1"), ({"map_file": Path("m.yaml")}, "--map: has a meaning with --loopback"),
    ({"frames": ("wheel=x",)}, "--frame: wheel=x is not NAME=FRAME"), ({"domain": 300}, "--domain: 300 is not"),
    ({"frames": ("base=odom",)}, "--frame: base and odom are both called odom; give each frame a name of its own"),
    ({"speed": 1e6, "is_sim_time": True}, "--speed: 1e+06 is more than any machine can; give at most 1000"),
    ({"urdf": Path(__file__)}, "test_ros2_session.py: is no URDF, which is XML"),
    ({"robots": 2, "record": Path("r.toml")}, "--record: keeps the run of one robot")])
def test_options_that_cannot_be_are_one_line(options: dict[str, Any], message: str) -> None:
    with pytest.raises(BadInput, match=re.escape(message)), rig_of(**options):
        pass


# ---- the same bits

@pytest.mark.parametrize("name", ["turtlebot3_burger", "robotino2", "skid_steer"])
def test_a_recorded_run_has_the_bits_of_simulate(name: str, tmp_path: Path) -> None:
    path = tmp_path / "recorded.toml"
    with rig_of(name, record=path) as rig:
        rig.drive(30, 0.15, 0.6)
        rig.turn(40)                        # the watchdog stops it
        rig.drive(10, -0.1)
        assert write_record(rig.session) == 80 * 20
        row = rig.session.base.motion.robots[0].plant.row()
    run = laconic.simulate(laconic.read_scene(path), ("nu_rad_per_s", "x_m", "y_m", "heading_rad",
                                                      "wheel_speed_rad_per_s", "wheel_angle_rad"))
    assert np.array([column[-1] for column in run.columns.values()]).tobytes() == row.tobytes()


def test_a_placed_robot_ends_the_record(tmp_path: Path) -> None:
    path = tmp_path / "recorded.toml"
    with rig_of(record=path) as rig:
        rig.drive(10, 0.1)
        rig.session.base.place(0, 1.0, 1.0, 0.0)
        rig.drive(10, 0.1)
        assert write_record(rig.session) == 10 * 20


def test_an_imported_robot_has_the_joints_of_its_urdf(tmp_path: Path) -> None:
    urdf, path = tmp_path / "two.urdf", tmp_path / "two.toml"
    urdf.write_text(made_up_robots.robot(made_up_robots.TWO_WHEELS))
    assert run(["import", str(urdf), "-o", str(path)]) == 0
    with rig_of(read_scene(path), urdf=urdf) as rig:
        reader = rig.node.subscription("joint_states", "sensor_msgs/msg/JointState")
        rig.drive(100, 0.2)
        joints = last(reader)
        assert list(joints.name) == ["left", "right"] and rig.lines == []
        assert min(joints.velocity) > 3.0  # the joints turn about +y, so ahead is positive


def test_on_a_slope_the_imu_shows_gravity_along_and_across_the_ground() -> None:
    tables = scene_tables("skid_steer").entries
    tables["ground"]["slope_deg"] = 10.0
    with rig_of(build_scene(tables)) as rig:
        reader = rig.node.subscription("imu", "sensor_msgs/msg/Imu")
        rig.turn(20)
        felt = last(reader).linear_acceleration
        assert (felt.x, felt.z) == pytest.approx((9.80665 * math.sin(math.radians(10.0)),
                                                  9.80665 * math.cos(math.radians(10.0))), rel=1e-3)


# ---- the command

LOCAL = ["--local", "--domain", "79"]


def test_a_run_ends_after_its_duration_with_figures(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["ros2", "robotino2", *LOCAL, "--duration", "0.2", "--json"]) == 0
    printed = capsys.readouterr()
    figures = json.loads(printed.out)
    assert figures["cycles"] == 10 and figures["messages"] == 50 and figures["commands"] == 0
    assert figures["final"] == {"x_m": 0.0, "y_m": 0.0, "heading_rad": 0.0}
    assert "hears Twist or TwistStamped on /cmd_vel" in printed.err


@pytest.mark.parametrize("words, message", [
    (["--router", "tcp/host:1"], "--router: has a meaning with --rmw zenoh alone; leave it out, or add --rmw zenoh"),
    (["--stamped", "--unstamped"], "--stamped --unstamped: exclude each other; give one of them")])
def test_options_that_do_not_go_together_are_one_line(words: list[str], message: str, monkeypatch: pytest.MonkeyPatch,
                                                      capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.delenv("RMW_IMPLEMENTATION", raising=False)
    assert run(["ros2", "robotino2", *LOCAL, "--duration", "0.1", *words]) == 2
    assert capsys.readouterr().err == f"laconic: {message}\n"


def test_an_xml_file_that_describes_no_robot_is_refused(tmp_path: Path) -> None:
    for text in ("<sdf><model/></sdf>", "<robot name='r'/>"):
        path = tmp_path / "other.urdf"
        path.write_text(text)
        with pytest.raises(BadInput, match=r"other.urdf: is no URDF; give the file with <robot>"), rig_of(urdf=path):
            pass


def test_the_last_poses_of_several_robots_have_names(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["ros2", "robotino2", *LOCAL, "--duration", "0.04", "--robots", "7"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.partition(" at x")[0] for line in lines if " at x = " in line] == [
        f"/robot{number}/laconic" for number in range(1, 6)]
    assert lines[-1] == "and 2 more robots; --json lists all of them"


def test_a_speed_that_cannot_be_reached_is_told_once_and_the_reached_one_at_the_end(
        capsys: pytest.CaptureFixture[str]) -> None:
    with rig_of(is_sim_time=True, speed=1000.0, duration_s=1.0) as rig:
        rig.time.overslept_s = 30.0
        rig.session.run()
        assert rig.lines == ["--speed 1000 is more than this machine can, so the robot runs as fast as it can; the "
                             "figures at the end state how fast"]
    assert run(["ros2", "robotino2", *LOCAL, "--duration", "0.2", "--sim-time", "--speed", "1000"]) == 0
    assert " times as fast as the clock, " in capsys.readouterr().out


@pytest.mark.parametrize(("scene", "moves"), [("paper_caster", True), ("turtlebot3_burger", False)])
def test_a_scene_that_starts_in_motion_says_so(scene: str, moves: bool, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["ros2", scene, *LOCAL, "--duration", "0.04"]) == 0
    assert ("the robot moves without a command" in capsys.readouterr().out) == moves


def test_a_car_says_what_drives_it(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["ros2", "f1tenth", *LOCAL, "--duration", "0.1"]) == 0
    assert "hears Twist or TwistStamped on /cmd_vel and AckermannDriveStamped on ackermann_cmd and drive" in \
        capsys.readouterr().out


@pytest.mark.parametrize(("scene", "words", "example"), [
    ("f1tenth", [],
     "/ackermann_cmd ackermann_msgs/msg/AckermannDriveStamped '{drive: {speed: 0.5, steering_angle: 0.1}}'"),
    ("robotino2", [], "/cmd_vel geometry_msgs/msg/Twist '{linear: {x: 0.1}, angular: {z: 0.5}}'"),
    ("robotino2", ["--stamped"],
     "/cmd_vel geometry_msgs/msg/TwistStamped '{twist: {linear: {x: 0.1}, angular: {z: 0.5}}}'")])
def test_the_line_that_drives_it_can_be_pasted(scene: str, words: list[str], example: str,
                                               capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["ros2", scene, *LOCAL, "--duration", "0.04", *words]) == 0
    printed = capsys.readouterr().out
    assert f"drive it: ros2 topic pub -r 10 {example}\n" in printed and "..." not in printed
    assert "A command without ROS" in printed


def test_a_run_without_a_command_says_that_no_publisher_was_found(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["ros2", "robotino2", *LOCAL, "--duration", "0.04"]) == 0
    assert "no command was heard: no publisher of a command that it hears was found; check" in capsys.readouterr().out
    with rig_of() as rig:
        rig.drive(2, 0.0)
        figures = rig.session.figures()
        assert figures["found_publisher"] and figures["commands"] == 2


def test_the_last_line_says_whose_pose_it_is(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["ros2", "robotino2", *LOCAL, "--duration", "0.04", "--frame", "base=base_footprint"]) == 0
    assert "heading 0.0000 rad (of base_footprint)" in capsys.readouterr().out


COMMANDER = """
import sys, time
from cyclonedds.domain import DomainParticipant
from laconic.ros2.messages import dds_name, message_class
from cyclonedds.pub import DataWriter
from cyclonedds.topic import Topic
kind = message_class("geometry_msgs/msg/Twist")
me = DomainParticipant(79)
writer = DataWriter(me, Topic(me, "rt/cmd_vel", kind))
print("there", flush=True)
while True:
    writer.write(kind())
    time.sleep(0.02)
"""


def test_a_cyclone_program_with_the_printed_setting_is_heard_by_a_local_robot() -> None:
    robot = [sys.executable, "-m", "laconic", "ros2", "robotino2", *LOCAL, "--duration", "4"]
    with subprocess.Popen(robot, stdout=subprocess.PIPE, text=True) as running:
        assert running.stdout is not None
        lines = [running.stdout.readline() for _ in range(3)]
        found = re.search("CYCLONEDDS_URI='(.*?)'", "".join(lines))
        assert found is not None
        with subprocess.Popen([sys.executable, "-c", COMMANDER], env={**os.environ, "CYCLONEDDS_URI": found[1]},
                              stdout=subprocess.DEVNULL) as peer:
            said = running.stdout.read()
            peer.kill()
    assert re.search(r", [1-9]\d* commands heard", said)


def test_a_record_is_a_scene(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "run.toml"
    assert run(["ros2", "turtlebot3_burger", *LOCAL, "--duration", "0.1", "--record", str(path)]) == 0
    assert f"wrote {path}: 100 steps" in capsys.readouterr().out
    scene = laconic.read_scene(path)
    assert scene.run.duration_s == pytest.approx(0.1) and scene.inputs == ()  # nothing moved, so no voltage acted


def test_the_environment_names_domain_and_distribution(monkeypatch: pytest.MonkeyPatch,
                                                       capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", "80")
    monkeypatch.setenv("ROS_DISTRO", "humble")
    assert run(["ros2", "robotino2", "--local", "--duration", "0.1"]) == 0
    assert "in domain 80," in capsys.readouterr().out
    monkeypatch.setenv("ROS_DOMAIN_ID", "home")
    assert run(["ros2", "robotino2", "--local"]) == 2
    assert "ROS_DOMAIN_ID: home is not a whole number" in capsys.readouterr().err


@pytest.mark.parametrize("words, of_environment, cyclone, fast", [
    ([], "", False, True), (["--rmw", "fastrtps"], "", False, True), ([], "rmw_fastrtps_cpp", False, True),
    ([], "rmw_other", False, True), (["--rmw", "cyclonedds"], "rmw_fastrtps_cpp", True, False)])
def test_services_are_for_both_unless_cyclonedds_is_named(words: list[str], of_environment: str, cyclone: bool,
                                                          fast: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RMW_IMPLEMENTATION", of_environment)
    made: list[Session] = []
    monkeypatch.setattr(Session, "run", lambda session: made.append(session))
    assert run(["ros2", "robotino2", *LOCAL, *words]) == 0
    node = made[0].robots[0].node
    assert (bool(node.services[0].reader), bool(node.other_readers)) == (cyclone, fast)


def test_without_its_package_the_extra_is_named() -> None:
    code = ("import sys; sys.modules['cyclonedds'] = None\n"
            "from laconic.cli.main import run\n"
            "sys.exit(run(['ros2', 'robotino2']))")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 2
    assert done.stderr.startswith("laconic: ") and done.stderr.count("\n") == 1 and "cyclonedds" in done.stderr
    assert extra_of("cyclonedds") == "ros2"


def test_its_help_needs_no_package() -> None:
    code = ("import sys; sys.modules['cyclonedds'] = None\n"
            "from laconic.cli.main import run\n"
            "sys.exit(run(['ros2', '--help']))")
    assert subprocess.run([sys.executable, "-c", code], capture_output=True).returncode == 0


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
@pytest.mark.parametrize("number", [signal.SIGINT, pytest.param(signal.SIGTERM, marks=pytest.mark.nightly)])
def test_a_signal_ends_the_run_in_order_also_in_the_background(number: int) -> None:
    words = [sys.executable, "-m", "laconic", "ros2", "robotino2", *LOCAL, "--json"]
    before = signal.signal(number, signal.SIG_IGN)  # as a shell without job control starts a job with &
    try:
        process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    finally:
        signal.signal(number, before)
    try:
        assert process.stderr is not None
        assert "Festo Robotino 2" in process.stderr.readline()  # it runs
        process.send_signal(number)
        out, err = process.communicate(timeout=30)
    finally:
        process.kill()
    assert process.returncode == 0
    assert "stopped by the user" in err and json.loads(out)["robots"] == 1
