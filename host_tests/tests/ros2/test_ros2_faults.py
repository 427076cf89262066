"""Faults, parameters, services and the loopback of robots on the wire, by a peer in the same process."""

from __future__ import annotations

import math
import os
import re
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cyclonedds._clayer import ddspy_write
from cyclonedds.builtin import BuiltinTopicDcpsPublication
from cyclonedds.core import DDSException
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.annotations import final
from cyclonedds.idl.types import float64
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.topic import Topic

import laconic
from laconic.errors import BadInput
from laconic.ros2 import wire
from laconic.ros2.lines import LibraryLines, kind_of, library_lines
from laconic.ros2.maps import Map
from laconic.ros2.messages import message_class, new, plain_class, type_hash
from laconic.ros2.names import LATCHED, USUAL, polled
from laconic.ros2.wire import Participant
from laconic.scene import Scene, read_scene
from ros2_support import DOMAIN, announced, last, rig_of

TWIST = "geometry_msgs/msg/Twist"
ODOMETRY, TF = "nav_msgs/msg/Odometry", "tf2_msgs/msg/TFMessage"
QUIET_DOMAIN = 73  # where no other writers come and go


def steady() -> Scene:
    """The burger with its centre of mass behind the axle: its ball carries load, so that a stop does not lift it."""
    burger = read_scene("turtlebot3_burger")
    return replace(burger, vehicle={**burger.vehicle, "com_x_m": -0.02})


def yaw_of(rotation: Any) -> float:
    return 2.0 * math.atan2(rotation.z, rotation.w)


# ---- faults: one line each, and the robot stops

def test_broken_packets_are_one_kind_of_line_whatever_their_bytes() -> None:
    kinds = {kind_of(f"malformed packet received from vendor 1.16 length {n} state parse:{what} <52545053 0{n}> 0x{n}")
             for n, what in ((140, "HEARTBEAT"), (108, "shortmsg"))}
    assert len(kinds) == 1 and kind_of("writer 1:2 blocked for too long") not in kinds


def test_silence_stops_the_robot() -> None:
    with rig_of(steady()) as rig:
        rig.drive(50, 0.2)
        rig.turn(24)                        # as long as the watchdog waits
        assert rig.session.base.look()[0].velocity[0] == pytest.approx(0.2, abs=1e-3)
        rig.turn(40)
        assert abs(rig.session.base.look()[0].velocity[0]) < 1e-3
        assert rig.lines == ["/laconic: cmd_vel was silent for 0.5 s, so the robot stops"]


def test_a_stop_lifts_the_ball_that_carries_nothing_and_the_line_says_so() -> None:
    with rig_of() as rig:
        rig.drive(50, 0.2)
        rig.drive(60, 0.0)
        assert len(rig.lines) == 1
        assert re.fullmatch(r"/laconic: support 1 lifts at 1\.\d+ s \(normal load -0\.\d+ N; [\d.]+ % of the run\); "
                            "command less, or give base.acceleration_limit_m_per_s2", rig.lines[0])


def test_a_stop_command_and_silence_after_it_are_no_event() -> None:
    with rig_of(steady()) as rig:
        rig.drive(50, 0.2)
        rig.drive(1, 0.0)
        rig.turn(60)
        assert rig.lines == []


@pytest.mark.parametrize("number", [float("nan"), float("-inf"), 1e300])
def test_a_command_that_is_not_finite_is_ignored_and_told(number: float) -> None:
    with rig_of(steady()) as rig:
        rig.drive(20, 0.1)
        rig.drive(60, number)
        assert abs(rig.session.base.look()[0].velocity[0]) < 1e-3  # the watchdog heard nothing new
        assert [line.partition(": ")[2][:47] for line in rig.lines] == [
            "a command on cmd_vel has a number that is infin", "cmd_vel was silent for 0.5 s, so the robot stop"]
        assert rig.session.told.counts["/laconic: not finite"] == 60


def test_commanders_on_two_topics_are_told_with_both() -> None:
    with rig_of("f1tenth") as rig:
        kind = "ackermann_msgs/msg/AckermannDriveStamped"
        one, other = rig.node.publisher("cmd_vel", TWIST), rig.node.publisher("drive", kind)

        def both() -> None:
            one.write(rig.twist(0.05))
            other.write(new(kind))

        rig.turn(10, both)
        assert rig.lines == ["/laconic: two publishers command the robot, on cmd_vel and drive, at once; the last "
                             "command counts, so stop one of them"]


def test_a_publisher_whose_type_has_other_fields_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    @final
    @dataclass
    class Twist(IdlStruct, typename="geometry_msgs.msg.dds_.Twist_"):
        speed: float64

    monkeypatch.setattr(wire, "MATCH_S", 0.0)
    with rig_of(domain=QUIET_DOMAIN) as rig:
        writer = DataWriter(rig.peer.publisher, Topic(rig.peer.dds, "rt/cmd_vel", Twist), qos=rig.peer._qos(
            DataWriter, TWIST, USUAL, ""))
        rig.turn(60, lambda: writer.write(Twist(1.0)))
        assert rig.lines == ["/laconic: a publisher on cmd_vel sends geometry_msgs/msg/Twist with other fields than "
                             "ROS has, which is not heard; build it of the definition of ROS"]
        assert rig.session.base.look()[0].x_m == 0.0
        assert sum(rig.session.told.counts.values()) == 1


def test_a_publisher_that_came_and_went_is_no_event(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(wire, "MATCH_S", 0.0)
    with rig_of(domain=QUIET_DOMAIN) as rig:
        rig.turn()
        rig.node.publisher("cmd_vel", TWIST).__del__()
        rig.turn(60)
        assert rig.lines == []


def test_a_publisher_that_offers_best_effort_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(wire, "MATCH_S", 0.0)
    with rig_of(domain=QUIET_DOMAIN) as rig:
        rig.drive(30, 0.0)  # one that matches is no event
        qos = Qos(Policy.Reliability.BestEffort, Policy.DataRepresentation(use_cdrv0_representation=True))
        writer = DataWriter(rig.peer.publisher, rig.peer._topics["rt/cmd_vel", TWIST], qos=qos)
        rig.turn(60)
        assert not writer.get_matched_subscriptions()
        assert rig.lines == ["/laconic: a publisher on cmd_vel offers best effort, which is not heard; make it "
                             "reliable"]


def test_bytes_behind_a_message_make_it_another_type_and_padding_does_not() -> None:
    data = new(TWIST).serialize(use_version_2=False)
    for cls in (message_class(TWIST), plain_class(TWIST)):
        assert cls.deserialize(data + bytes(3)).linear.x == 0.0
        with pytest.raises(ValueError, match="bytes are left over"):
            cls.deserialize(data + bytes(8))


def test_longer_bytes_on_cmd_vel_move_nothing_and_are_counted() -> None:
    with rig_of() as rig:
        writer = rig.node.publisher("cmd_vel", TWIST)
        data = rig.twist(0.2).serialize(use_version_2=False) + bytes(40)
        rig.turn(30, lambda: ddspy_write(writer._ref, bytes(data)))
        assert rig.lines == ["/laconic: a message on cmd_vel cannot be read as its type and is ignored"]
        assert rig.session.told.counts == {"/laconic: unreadable": 30}
        assert rig.session.base.look()[0].x_m == 0.0


def test_lines_of_the_library_are_limited_and_counted(tmp_path: Path) -> None:
    path = tmp_path / "lines"
    path.touch()
    with rig_of() as rig:
        rig.session.library = LibraryLines(path)
        for cycle in range(60):
            with path.open("a") as file:
                file.write(f"17959285{cycle}.54 [77]       recv: data(application, vendor 1.16): 110d93c:b66a #{cycle}"
                           ": deserialization rt/cmd_vel/geometry_msgs::msg::dds_::Twist_ failed (unknown)\n"
                           f"17959285{cycle}.55 [77]       recv: no room for {cycle}\n")
            rig.turn()
        assert rig.lines == ["/laconic: a message on cmd_vel cannot be read as its type and is ignored",
                             "the library of the wire: no room for 0"]
        assert sorted(rig.session.told.counts) == ["/laconic: unreadable", "no room for …"]
        assert min(rig.session.told.counts.values()) > 50


def test_what_libraries_print_is_taken_until_the_command_ends(capfd: pytest.CaptureFixture[str]) -> None:
    said: list[str] = []
    with library_lines(said.append) as library:
        os.write(2, b"17.5 [3]  recv: one\n")
        assert library is not None and library.take() == ["one"] and library.take() == []
        os.write(2, b"two 1\ntwo 2\n")
    os.write(2, b"three\n")
    assert said == ["two …"] and capfd.readouterr().err == "three\n"


def test_two_commanders_are_told_and_the_last_counts() -> None:
    with rig_of() as rig:
        one, other = (rig.node.publisher("cmd_vel", TWIST) for _ in range(2))

        def both() -> None:
            one.write(rig.twist(0.05))
            other.write(rig.twist(0.1))

        rig.turn(60, both)
        assert rig.lines == ["/laconic: two publishers command cmd_vel at once; the last command counts, so stop one "
                             "of them"]
        assert rig.session.base.look()[0].velocity[0] == pytest.approx(0.1, abs=1e-3)


def test_a_publisher_of_another_type_is_told() -> None:
    with rig_of() as rig:
        rig.node.publisher("cmd_vel", "std_msgs/msg/String").write(new("std_msgs/msg/String", data="go"))
        rig.turn(60)
        assert rig.lines == ["/laconic: a publisher on cmd_vel sends std_msgs/msg/String, which is not heard; send "
                             "Twist or TwistStamped"]
        assert rig.session.base.look()[0].x_m == 0.0


def test_what_a_command_asks_in_vain_is_told() -> None:
    with rig_of() as rig:
        writer, message = rig.node.publisher("cmd_vel", TWIST), rig.twist(0.5, 0.3)
        message.linear.z = 1.0
        rig.turn(10, lambda: writer.write(message))
        assert [line.removeprefix("/laconic: ") for line in rig.lines] == [
            "a command on cmd_vel has linear.z, angular.x or angular.y, which a robot on the ground leaves out",
            "cmd_vel: linear.y = 0.3 is impossible for these wheels and becomes 0",
            "cmd_vel: a speed of 0.5 m/s is limited to 0.22 m/s"]


def test_a_peer_that_goes_and_comes_again_drives_again() -> None:
    with rig_of() as rig:
        rig.drive(30, 0.1)
        rig.peer.close()
        rig.turn(80)
        assert abs(rig.session.base.look()[0].velocity[0]) < 1e-3
        with Participant(DOMAIN, is_local=True) as again:
            rig.node = again.node("peer")
            rig.drive(60, 0.1)
        assert rig.session.base.look()[0].velocity[0] == pytest.approx(0.1, abs=1e-3)


def test_messages_that_raise_in_the_reader_are_counted_and_passed_over() -> None:
    class Reader:
        def __init__(self) -> None:
            self.left = ["bad", "good", "bad"]

        def take(self, N: int) -> list[Any]:  # noqa: N803
            if not self.left:
                return []
            if self.left.pop(0) == "bad":
                raise ValueError("bytes of another type")
            return [new(TWIST)]

    wrong: list[int] = []
    assert len(polled(Reader(), lambda: wrong.append(1))) == 1
    assert len(wrong) == 2


def test_a_refused_step_is_told_and_reset_puts_the_robot_back() -> None:
    scene = read_scene("robotino2")
    scene = replace(scene, base=laconic.scene.base.BaseTable(gain_Vs_per_rad=1e306))
    with rig_of(scene) as rig:
        rig.drive(5, 0.5)
        assert len(rig.lines) == 1 and "the robot stands until reset or set_pose" in rig.lines[0]
        assert rig.session.refusals
        rig.call("/laconic/reset", "std_srvs/srv/Empty")
        assert not rig.session.refusals and rig.session.base.look()[0].x_m == 0.0


# ---- parameters and services

def test_parameters_are_listed_and_read() -> None:
    with rig_of(is_sim_time=True) as rig:
        kind = "rcl_interfaces/srv/"
        names = rig.call("/laconic/list_parameters", f"{kind}ListParameters").result.names
        assert "use_sim_time" in names and sorted(names) == list(names)
        values = rig.call("/laconic/get_parameters", f"{kind}GetParameters",
                          names=["use_sim_time", "rate_hz", "scene", "nothing"]).values
        assert [each.type for each in values] == [1, 3, 4, 0]
        assert (values[0].bool_value, values[1].double_value, values[2].string_value) == (
            True, 50.0, "TurtleBot3 Burger")
        types = rig.call("/laconic/get_parameter_types", f"{kind}GetParameterTypes", names=["watchdog_s"]).types
        assert list(types) == [3]
        described = rig.call("/laconic/describe_parameters", f"{kind}DescribeParameters",
                             names=["watchdog_s", "scene"]).descriptors
        assert [each.read_only for each in described] == [False, True]


def test_the_watchdog_is_the_parameter_that_can_be_set() -> None:
    def parameter(name: str, **value: Any) -> Any:
        return new("rcl_interfaces/msg/Parameter", name=name, value=new("rcl_interfaces/msg/ParameterValue", **value))

    with rig_of() as rig:
        given = [parameter("watchdog_s", type=3, double_value=0.2), parameter("scene", type=4, string_value="x"),
                 parameter("watchdog_s", type=3, double_value=float("nan")),
                 parameter("use_sim_time", type=1, bool_value=False), parameter("other", type=1)]
        results = rig.call("/laconic/set_parameters", "rcl_interfaces/srv/SetParameters", parameters=given).results
        assert [each.successful for each in results] == [True, False, False, True, False]
        assert rig.session.robots[0].watchdog_s == 0.2
        whole = rig.call("/laconic/set_parameters_atomically", "rcl_interfaces/srv/SetParametersAtomically",
                         parameters=[parameter("watchdog_s", type=3, double_value=0.9), given[1]]).result
        assert not whole.successful and rig.session.robots[0].watchdog_s == 0.2


@pytest.mark.parametrize("services_for", [("cyclonedds",), ("cyclonedds", "fastrtps")])
def test_reset_and_set_pose(services_for: tuple[str, ...]) -> None:
    with rig_of(services_for=services_for) as rig:
        rig.drive(50, 0.2)
        pose = new("geometry_msgs/msg/PoseWithCovarianceStamped")
        pose.pose.pose.position.x, pose.pose.pose.position.y = 2.0, -1.0
        pose.pose.pose.orientation.z = pose.pose.pose.orientation.w = math.sqrt(0.5)
        rig.call("/laconic/set_pose", "robot_localization/srv/SetPose", pose=pose)
        seen = rig.session.base.look()[0]
        assert (seen.x_m, seen.y_m, seen.heading_rad) == pytest.approx((2.0, -1.0, math.pi / 2))
        assert rig.session.base.odometry[0].x_m > 0.1
        rig.call("/laconic/reset", "std_srvs/srv/Empty")
        assert rig.session.base.look()[0].x_m == rig.session.base.odometry[0].x_m == 0.0


def test_a_request_that_cannot_be_read_is_told() -> None:
    with rig_of(services_for=("fastrtps",)) as rig:
        service = next(each for each in rig.session.robots[0].node.services if each.name.endswith("set_pose"))
        assert service._answered(b"\x00\x01\x00\x00" + b"\xff" * 40, False) is None
        rig.turn(2)
        assert rig.lines == ["/laconic: laconic/set_pose: a request that cannot be read is ignored"]


def test_services_have_the_hashes_of_their_messages() -> None:
    with rig_of() as rig:
        found = announced(rig.peer, BuiltinTopicDcpsPublication)
        reply = found["rr/laconic/get_parametersReply"]
        assert reply.type_name == "rcl_interfaces::srv::dds_::GetParameters_Response_"
        data = bytes(reply.qos[Policy.Userdata].data).decode()
        assert re.fullmatch(rf"serviceid=[0-9a-f]{{16}};typehash="
                            rf"{type_hash('rcl_interfaces/srv/GetParameters_Response')};", data)


# ---- loopback

def box_map(folder: Path) -> Path:
    """A room of 4 m by 2 m with walls, cells of 5 cm, its lower left corner at (-2, -1)."""
    cells = np.full((40, 80), 254, np.uint8)
    cells[0, :] = cells[-1, :] = cells[:, 0] = cells[:, -1] = 0
    (folder / "room.pgm").write_bytes(b"P5\n80 40\n255\n" + cells.tobytes())
    path = folder / "room.yaml"
    path.write_text("image: room.pgm\nresolution: 0.05\norigin: [-2.0, -1.0, 0.0]\nnegate: 0\n"
                    "occupied_thresh: 0.65\nfree_thresh: 0.196\nmode: trinary  # as map_saver writes\n")
    return path


def test_loopback_localizes_by_the_true_pose() -> None:
    scene = replace(read_scene("turtlebot3_burger"), base=laconic.scene.base.BaseTable(believed_size=0.8))
    with rig_of(scene, is_loopback=True) as rig:
        reader, truths = rig.node.subscription("/tf", TF), rig.node.subscription("/ground_truth/odom", ODOMETRY)
        pose = new("geometry_msgs/msg/PoseWithCovarianceStamped")
        pose.pose.pose.position.x, pose.pose.pose.orientation.z, pose.pose.pose.orientation.w = 1.0, 0.6, 0.8
        rig.node.publisher("/initialpose", "geometry_msgs/msg/PoseWithCovarianceStamped").write(pose)
        rig.drive(100, 0.2, 0.5)
        to_base, to_odom = last(reader).transforms
        assert (to_odom.header.frame_id, to_odom.child_frame_id) == ("map", "odom")
        yaw, there = yaw_of(to_odom.transform.rotation), to_odom.transform.translation
        here, truth = to_base.transform.translation, last(truths).pose.pose
        x = there.x + math.cos(yaw) * here.x - math.sin(yaw) * here.y
        y = there.y + math.sin(yaw) * here.x + math.cos(yaw) * here.y
        assert (x, y) == pytest.approx((truth.position.x, truth.position.y), abs=1e-12)
        assert math.sin(yaw + yaw_of(to_base.transform.rotation) - yaw_of(truth.orientation)) == pytest.approx(0.0)
        assert abs(yaw - 2.0 * math.atan2(0.6, 0.8)) > 0.05  # the odometry has drifted, and map → odom makes up for it


def test_the_scan_shows_the_walls_of_the_map(tmp_path: Path) -> None:
    with rig_of(is_loopback=True, map_file=box_map(tmp_path)) as rig:
        grid = last(rig.node.subscription("/map", "nav_msgs/msg/OccupancyGrid", LATCHED))
        assert (grid.info.width, grid.info.height, grid.info.origin.position.x) == (80, 40, -2.0)
        assert set(grid.data) == {0, 100}
        reader = rig.node.subscription("/scan", "sensor_msgs/msg/LaserScan")
        rig.session.base.place(0, 0.5, 0.0, math.pi / 2)
        rig.turn(11)
        scans = polled(reader)
        assert len(scans) == 3  # ten a second
        scan = scans[-1]
        at = {round(math.degrees(scan.angle_min + number * scan.angle_increment)): distance
              for number, distance in enumerate(scan.ranges)}
        for degrees, distance in ((0, 0.95), (90, 2.45), (-90, 1.45), (-180, 0.95)):
            assert at[degrees] == pytest.approx(distance, abs=0.06)


@pytest.mark.parametrize("frame, lines", [
    ("map", []), ("/map", []), ("", ["/laconic: initialpose names no frame, and is taken as one in map"]),
    ("odom", ["/laconic: initialpose is in the frame odom and is ignored; give it in map, or name that frame with "
              "--frame map="])])
def test_an_initial_pose_is_one_in_the_map(frame: str, lines: list[str]) -> None:
    with rig_of(is_loopback=True) as rig:
        pose = new("geometry_msgs/msg/PoseWithCovarianceStamped")
        pose.header.frame_id, pose.pose.pose.position.x, pose.pose.pose.orientation.w = frame, 2.0, 1.0
        rig.node.publisher("/initialpose", "geometry_msgs/msg/PoseWithCovarianceStamped").write(pose)
        rig.turn(2)
        assert [line for line in rig.lines if " puts the robot at " not in line] == lines
        assert rig.session.base.look()[0].x_m == (0.0 if frame == "odom" else 2.0)


@pytest.mark.parametrize("place, yaw", [(math.nan, 1.0), (1e300, 1.0), (0.0, 1e300), (0.0, math.inf), (0.0, 0.0)])
def test_a_pose_that_cannot_be_is_told_and_ignored(place: float, yaw: float) -> None:
    with rig_of(is_loopback=True) as rig:
        pose = new("geometry_msgs/msg/PoseWithCovarianceStamped")
        pose.pose.pose.position.x, pose.pose.pose.orientation.z, pose.pose.pose.orientation.w = place, yaw, 0.0
        rig.node.publisher("/initialpose", "geometry_msgs/msg/PoseWithCovarianceStamped").write(pose)
        rig.turn(2)
        assert rig.lines == ["/laconic: initialpose has a pose that is infinite, NaN, beyond 1e+06 or without a yaw, "
                             "and is ignored"]
        assert rig.session.base.look()[0].x_m == 0.0


def test_outside_the_map_a_scan_hits_nothing(tmp_path: Path) -> None:
    world = Map.read(box_map(tmp_path))
    assert np.isinf(world.ranges(50.0, 50.0, np.array([0.0, 1.0]))).all()


@pytest.mark.parametrize("old, new_text, message", [
    ("room.pgm", "other.png", "other.png: cannot be read"), ("resolution: 0.05", "resolution: -1", "resolution: is -1"),
    ("[-2.0, -1.0, 0.0]", "[0, 0, 0.5]", "origin: has the yaw 0.5"), ("image: room.pgm", "", "image: is missing"),
    ("[-2.0, -1.0, 0.0]", "here", "origin: is here"), ("0.65", "much", "occupied_thresh: is much")])
def test_a_wrong_map_is_one_line(tmp_path: Path, old: str, new_text: str, message: str) -> None:
    path = box_map(tmp_path)
    path.write_text(path.read_text().replace(old, new_text))
    with pytest.raises(BadInput, match=re.escape(message)):
        Map.read(path)


def test_a_peer_that_does_not_keep_up_costs_messages_and_not_the_run() -> None:
    class Full:
        def write(self, _: Any) -> None:
            raise DDSException(DDSException.DDS_RETCODE_TIMEOUT, "the history is full")

    with rig_of() as rig:
        rig.drive(10, 0.1)
        rig.session.robots[0]._imu._writer = Full()
        rig.turn(120)
        assert rig.lines[-1].startswith("/laconic: a peer does not keep up, so ")
        assert rig.session.robots[0].left_out() == 120
        assert rig.session.cycles == 130


def test_random_bytes_end_no_run_and_drive_at_most_as_commands(tmp_path: Path) -> None:
    rng = np.random.default_rng(39)
    with rig_of(is_loopback=True) as rig:
        topics = {"cmd_vel": TWIST, "/cmd_vel": "geometry_msgs/msg/TwistStamped",
                  "initialpose": "geometry_msgs/msg/PoseWithCovarianceStamped"}
        writers = [rig.node.publisher(topic, kind) for topic, kind in topics.items()]
        for service, kind in (("set_parameters", "rcl_interfaces/srv/SetParameters"),
                              ("get_parameters", "rcl_interfaces/srv/GetParameters"), ("reset", "std_srvs/srv/Empty"),
                              ("set_pose", "robot_localization/srv/SetPose")):
            writers.append(rig.peer._endpoint(DataWriter, f"rq/laconic/{service}Request", f"{kind}_Request", USUAL,
                                              of_service="clientid=1;"))

        def noise() -> None:
            for writer in writers:
                data = rng.integers(0, 256, rng.integers(0, 200), np.uint8).tobytes()
                data = data if rng.random() < 0.5 else bytes(len(data))[:-8] + data[-8:]
                ddspy_write(writer._ref, b"\x00\x01\x00\x00" + data + bytes(-len(data) % 4))

        rig.turn(400, noise)
        seen = rig.session.base.look()[0]
        assert rig.session.cycles == 400 and np.isfinite([seen.x_m, seen.y_m, *seen.velocity]).all()
        assert math.hypot(*seen.velocity[:2]) < 0.25
        rig.call("/laconic/reset", "std_srvs/srv/Empty")
        rig.drive(60, 0.1)
        assert rig.session.base.look()[0].velocity[0] == pytest.approx(0.1, abs=1e-3)
