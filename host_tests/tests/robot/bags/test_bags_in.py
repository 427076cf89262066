"""Recordings of topics as they come: rosbag1, rosbag2, MCAP, ULog and MATLAB files replay by a map, or by none."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from mcap.writer import Writer as McapWriter
from rosbags.rosbag2 import StoragePlugin
from scipy.io import savemat

from bag_support import (
    HALF_TRACK_M,
    RADIUS_M,
    SCENE,
    START_NS,
    Messages,
    drive,
    pose_at,
    rosbag1,
    rosbag2,
    scene_of,
    ulog,
    wheels_at,
)
from laconic.cli.main import run
from laconic.robot.bags.messages import decoder_of
from laconic.robot.bags.samples import heading_of
from laconic.robot.logs import gather_logs
from laconic.robot.logs.fields import Field

USUAL = """name = "bag"
format = "bag"
joints = "/joint_states"
wheels = ["left_wheel", "right_wheel"]
"""


def test_the_heading_of_a_tilted_robot_is_where_its_x_axis_points() -> None:
    for roll, pitch, yaw in ((0.0, 0.0, 2.0), (0.2, -0.3, 0.7), (-0.4, 0.25, -2.8)):
        half = [(math.cos(angle / 2), math.sin(angle / 2)) for angle in (roll, pitch, yaw)]
        (cr, sr), (cp, sp), (cy, sy) = half
        x, y, z, w = (sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy,
                      cr * cp * cy + sr * sp * sy)
        assert heading_of({"x": x, "y": y, "z": z, "w": w}) == pytest.approx(yaw, abs=1e-12)


def replayed(capsys, *arguments) -> dict:
    assert run(["replay", *map(str, arguments), "--json"]) == 0, capsys.readouterr().err
    return json.loads(capsys.readouterr().out)


def refused(capsys, *arguments) -> str:
    assert run(["replay", *map(str, arguments)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and "Traceback" not in error
    return error


def path_error(capsys, *arguments) -> float:
    return replayed(capsys, *arguments)["runs"][0]["path_error"]


def mapped(folder, text):
    path = folder / "map.toml"
    path.write_text(text)
    return path


CONTAINERS = {
    "rosbag1": lambda folder, rows, messages: rosbag1(folder / "run.bag", rows, messages),
    "rosbag2 in SQLite": lambda folder, rows, messages: rosbag2(folder / "run", rows, messages),
    "rosbag2 in MCAP": lambda folder, rows, messages: rosbag2(folder / "run", rows, messages, StoragePlugin.MCAP)}


@pytest.mark.parametrize("container", CONTAINERS)
def test_usual_topics_need_no_map_and_are_joined_by_their_stamps(container, tmp_path, capsys):
    messages = Messages(is_ros1=container == "rosbag1")
    log = CONTAINERS[container](tmp_path, drive(messages, late_ns=70_000_000), messages)
    found = replayed(capsys, log, scene_of(tmp_path))
    assert found["runs"][0]["path_error"] < 2e-5
    remarks = " ".join(found["remarks"])
    assert "the names assign left_wheel to wheel 1, right_wheel to wheel 2 of the scene" in remarks
    assert "/mocap/pose: 124 messages" in remarks and "recorded 0.07 s after their stamps" in remarks


def test_the_order_of_the_wheels_comes_from_their_names(tmp_path, capsys):
    messages = Messages()
    rows = drive(messages, names=("right_wheel_joint", "left_wheel_joint"))
    for _, topic, _, message in rows:
        if topic == "/joint_states":
            message.position[:] = message.position[::-1].copy()
    assert path_error(capsys, rosbag2(tmp_path / "run", rows, messages), scene_of(tmp_path)) < 2e-5


def test_a_table_of_wheel_angles_says_more_of_the_joints_than_their_names(tmp_path, capsys):
    messages = Messages()
    rows = drive(messages)
    for _, topic, _, message in rows:
        if topic == "/joint_states":
            message.position[:] = np.array([-5.0, 5.0]) * message.position
            message.velocity = np.zeros(0)
    log, scene = rosbag2(tmp_path / "run", rows, messages), scene_of(tmp_path)
    text = f'{USUAL}pose = "/mocap/pose"\n[wheel_angle]\n'
    mapping = mapped(tmp_path, text + "signs = [-1, 1]\ngear_ratio = 5\n")
    assert path_error(capsys, log, scene, "--map", mapping) < 2e-5
    error = refused(capsys, log, scene, "--map", mapped(tmp_path, text + "nonsense = 3\n"))
    assert "wheel_angle.nonsense: is no known key here" in error


@pytest.mark.parametrize("stamps,late_s", [("header", 0.0), ("arrival", 0.3)])
def test_a_map_chooses_whose_instants_count(stamps, late_s, tmp_path):
    messages = Messages()
    log = rosbag2(tmp_path / "run", drive(messages, late_ns=300_000_000), messages)
    (read,), _ = gather_logs([log], mapped(tmp_path, f'{USUAL}pose = "/mocap/pose"\nstamps = "{stamps}"\n'))
    first_s = 0.3 if late_s else 0.0
    assert read.column_names == ("left_wheel", "right_wheel")
    assert read.pose[50] == pytest.approx(pose_at(first_s + 1.0 - late_s), abs=1e-4)


def test_frames_of_tf_are_a_pose_through_their_chain(tmp_path, capsys):
    messages = Messages()

    def truth(stamp, time_s):
        x, y, heading = pose_at(time_s)
        return [(stamp, "/tf", "tf2_msgs/msg/TFMessage", messages.transform(stamp, "odom", "base_link", x, y, heading))]

    rows = [*drive(messages, truth=truth), (START_NS, "/tf_static", "tf2_msgs/msg/TFMessage", messages.transform(
        START_NS, "map", "odom", 3.0, -1.0, 0.7))]
    log = rosbag2(tmp_path / "run", sorted(rows, key=lambda row: row[0]), messages)
    mapping = mapped(tmp_path, f'{USUAL}[pose]\nframes = ["map", "base_link"]\n')
    assert path_error(capsys, log, scene_of(tmp_path), "--map", mapping) < 2e-5
    (read,), _ = gather_logs([log], mapping)
    assert read.pose[0] == pytest.approx([3.0, -1.0, 0.7], abs=1e-9)
    assert "no chain of transforms" in refused(capsys, log, tmp_path / "robot.toml", "--map", mapped(
        tmp_path, f'{USUAL}[pose]\nframes = ["base_link", "map"]\n'))


def test_satellite_fixes_are_positions_without_a_heading(tmp_path, capsys):
    messages, earth_m = Messages(), 6378137.0

    def truth(stamp, time_s):
        x, y, _ = pose_at(time_s)
        size = 1.0 - 6.69437999014e-3 * math.sin(math.radians(50.0)) ** 2
        north = math.degrees(y / (earth_m * (1.0 - 6.69437999014e-3) / size**1.5))
        east = math.degrees(x / (earth_m / math.sqrt(size) * math.cos(math.radians(50.0))))
        return [(stamp, "/fix", "sensor_msgs/msg/NavSatFix", messages.fix(stamp, 50.0 + north, 8.0 + east))]

    log = rosbag2(tmp_path / "run", drive(messages, truth=truth), messages)
    found = replayed(capsys, log, scene_of(tmp_path))
    assert found["runs"][0]["path_error"] < 1e-4 and found["runs"][0]["heading_error_rad"] is None
    assert any("latitude 50.0000000°" in each for each in found["remarks"])


def test_unused_topics_are_not_decoded(tmp_path, capsys, monkeypatch):
    messages = Messages()
    rows = drive(messages)
    rows += [(START_NS + k, "/camera", "sensor_msgs/msg/CompressedImage", messages.image(START_NS + k, 1000))
             for k in range(20)]
    log = rosbag2(tmp_path / "run", sorted(rows, key=lambda row: row[0]), messages)
    decoded = []
    monkeypatch.setattr("laconic.robot.bags.containers.decoder_of",
                        lambda path, topic, *rest: decoded.append(topic) or decoder_of(path, topic, *rest))
    assert path_error(capsys, log, scene_of(tmp_path)) < 2e-5
    assert set(decoded) == {"/joint_states", "/mocap/pose"}


def test_ticks_of_a_type_of_its_own_are_columns_by_field(tmp_path, capsys):
    messages = Messages()
    numbers = messages.types["std_msgs/msg/Int32MultiArray"]
    layout = messages.types["std_msgs/msg/MultiArrayLayout"]([], 0)
    rows = [row for row in drive(messages) if row[1] != "/joint_states"]
    for k in range(200):
        ticks = [round(4096 * 20 * angle / math.tau) for angle in wheels_at(0.02 * k)]
        counters = [(each + 32768) % 65536 - 32768 for each in ticks]
        rows.append((START_NS + 20_000_000 * k, "/ticks", "std_msgs/msg/Int32MultiArray",
                     numbers(layout, np.array(counters, np.int32))))
    log = rosbag2(tmp_path / "run", sorted(rows, key=lambda row: row[0]), messages)
    scene = scene_of(tmp_path)
    assert "no topic of type JointState" in refused(capsys, log, scene)
    text = ('format = "bag"\npose = "/mocap/pose"\n[wheel_angle]\ncolumns = ["/ticks.data[0]", "/ticks.data[1]"]\n'
            'unit = "tick"\nticks_per_turn = 4096\ngear_ratio = 20\n')
    assert "give wrap = 65536" in refused(capsys, log, scene, "--map", mapped(tmp_path, text))
    found = replayed(capsys, log, scene, "--map", mapped(tmp_path, f"{text}wrap = 65536\n"))
    assert found["runs"][0]["path_error"] < 2e-5
    assert any("/ticks: its messages have no time stamps, so the times of recording are used" in each
               for each in found["remarks"])


def test_json_in_an_mcap_is_read(tmp_path, capsys):
    log = tmp_path / "run.mcap"
    with log.open("wb") as file:
        writer = McapWriter(file)
        writer.start()
        schema = writer.register_schema("foxglove.PoseInFrame", "jsonschema", b"{}")
        wheels = writer.register_channel("/wheels", "json", 0)
        pose = writer.register_channel("/truth", "json", schema)
        for k in range(200):
            stamp, (left, right), (x, y, heading) = START_NS + 20_000_000 * k, wheels_at(0.02 * k), pose_at(0.02 * k)
            writer.add_message(wheels, stamp, json.dumps({"left": left, "right": right}).encode(), stamp)
            writer.add_message(pose, stamp, json.dumps({
                "timestamp": {"sec": stamp // 10**9, "nsec": stamp % 10**9},
                "pose": {"position": {"x": x, "y": y, "z": 0}, "orientation": {
                    "x": 0, "y": 0, "z": math.sin(heading / 2), "w": math.cos(heading / 2)}}}).encode(), stamp)
        writer.finish()
    mapping = mapped(tmp_path, 'format = "bag"\npose = "/truth"\n[wheel_angle]\ncolumns = ["/wheels.left", '
                     '"/wheels.right"]\n')
    assert path_error(capsys, log, scene_of(tmp_path), "--map", mapping) < 1e-9


def table(seconds: float = 4.0) -> np.ndarray:
    """Rows of time, wheels, pose."""
    return np.array([[0.02 * k, *wheels_at(0.02 * k), *pose_at(0.02 * k)] for k in range(round(50 * seconds))])


def test_a_ulog_replays_by_its_topics(tmp_path, capsys):
    rows = table()
    pose = np.column_stack([rows[:, 0] + 0.003, rows[:, 3], -rows[:, 4], -rows[:, 5]])
    log = ulog(tmp_path / "run.ulg", {"wheels": (("left", "right"), rows[:, :3]),
                                      "vehicle_local_position": (("x", "y", "heading"), pose)})
    columns = ", ".join(f'"vehicle_local_position.{each}"' for each in ("x", "y", "heading"))
    mapping = mapped(tmp_path, 'format = "bag"\n[wheel_angle]\ncolumns = ["wheels.left", "wheels.right"]\n[pose]\n'
                     f"columns = [{columns}]\nsigns = [1, -1, -1]\nlag_s = 0.003\n")
    assert path_error(capsys, log, scene_of(tmp_path), "--map", mapping) < 1e-4
    assert run(["logs", str(log)]) == 0
    assert "signs = [1, -1, -1]" in capsys.readouterr().out


@pytest.mark.parametrize("version", ["5", "7.3"])
def test_a_matlab_file_replays_by_its_vectors(version, tmp_path, capsys):
    rows, log = table(), tmp_path / "run.mat"
    fields = {"t": rows[:, 0], "left": rows[:, 1], "right": rows[:, 2]}
    truth = {"t": rows[::3, 0], "pose": rows[::3, 3:6]}
    if version == "5":
        savemat(log, {"enc": fields, "mocap": truth})
    else:
        import h5py
        with h5py.File(log, "w", userblock_size=512) as file:
            for group, members in (("enc", fields), ("mocap", truth)):
                for name, values in members.items():
                    file[f"{group}/{name}"] = np.atleast_2d(values.T if values.ndim > 1 else values)
    columns = ", ".join(f'"mocap.pose[{number}]"' for number in (1, 2, 3))
    mapping = mapped(tmp_path, 'format = "mat"\n[time]\ncolumn = "enc.t"\n[wheel_angle]\ncolumns = ["enc.left", '
                     f'"enc.right"]\n[pose]\ntime = "mocap.t"\ncolumns = [{columns}]\n')
    assert path_error(capsys, log, scene_of(tmp_path), "--map", mapping) < 1e-4
    assert "needs its map" in refused(capsys, log, tmp_path / "robot.toml")


def test_an_empty_topic_or_field_is_one_line(tmp_path, capsys):
    messages = Messages()
    log, scene = rosbag2(tmp_path / "run", drive(messages), messages), scene_of(tmp_path)
    for text, words in (
            (f'{USUAL}pose = "/mocap/pos"\n', "did you mean /mocap/pose?"),
            (USUAL.replace("left_wheel", "left_whel"), "has no joint left_whel; correct the map (did you mean left_w"),
            (f'{USUAL}pose = "/joint_states"\n', "is of type sensor_msgs/msg/JointState, in which no pose is known"),
            (f'{USUAL}[pose]\ncolumns = ["/mocap/pose.x", "/mocap/pose.y"]\n', "has no number in its field x"),
            ('format = "bag"\njoints = "/joint_states"\n', "wheels: is missing"),
            (f'{USUAL}separator = ";"\n', 'has a meaning only with format = "text"')):
        assert words in refused(capsys, log, scene, "--map", mapped(tmp_path, text))


def test_a_topic_without_its_slash_and_a_pose_that_a_ulog_has_not_are_one_line(tmp_path, capsys):
    log = rosbag1(tmp_path / "run.bag", drive(Messages(is_ros1=True)), Messages(is_ros1=True))
    scene = scene_of(tmp_path)
    text = USUAL.replace("/joint", "joint").replace("left_wheel", "left_whel") + 'pose = "mocap/pose"'
    error = refused(capsys, log, scene, "--map", mapped(tmp_path, text))
    assert "has no joint left_whel; correct the map" in error
    of_px4 = ulog(tmp_path / "rover.ulg", {"odometry": (["x", "y"], table()[:, :3])})
    error = refused(capsys, of_px4, scene, "--map", mapped(tmp_path, 'format = "bag"\npose = "odometri"\n'))
    assert "has no topic odometri; correct the map (did you mean odometry?)" in error


@pytest.mark.parametrize("kind", ["rosbag1", "ulog"])
def test_a_recording_is_opened_once_for_all_questions(kind, tmp_path, capsys, monkeypatch):
    from laconic.robot.bags import samples

    log = ulog(tmp_path / "run.ulg", {"odometry": (["x", "y"], table()[:, :3])}) if kind == "ulog" else rosbag1(
        tmp_path / "run.bag", drive(Messages(is_ros1=True)), Messages(is_ros1=True))
    opened = []

    def noted(open_one):
        return lambda path, *names: (opened.append(path), open_one(path, *names))[1]

    for name in ("opened", "load_ulog"):
        monkeypatch.setattr(samples, name, noted(getattr(samples, name)))
    assert run(["logs", str(log)]) == 0
    assert len(opened) == 1
    if kind == "rosbag1":
        gather_logs([log], mapped(tmp_path, USUAL + 'pose = "/mocap/pose"'))
        assert len(opened) == 2
        assert run(["logs", str(log), "--fields", "/mocap/pose"]) == 0
        assert len(opened) == 3
        gather_logs([log])  # guessed first, then read
        assert len(opened) == 5


def test_a_missing_package_is_named_with_its_extra(tmp_path, capsys, monkeypatch):
    messages = Messages()
    log = rosbag2(tmp_path / "run", drive(messages), messages)
    import sys
    for name in [each for each in sys.modules if each.partition(".")[0] == "rosbags"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "rosbags", None)
    from laconic.robot.bags.messages import _store_of
    _store_of.cache_clear()
    monkeypatch.setattr("importlib.metadata.requires", lambda _: ['rosbags>=0.10; extra == "bags"'])
    assert 'pip install "laconic[bags]"' in refused(capsys, log, scene_of(tmp_path))


def test_what_is_in_a_bag_is_shown_with_a_map_to_begin_with(tmp_path, capsys):
    log = rosbag1(tmp_path / "run.bag", drive(Messages(is_ros1=True)), Messages(is_ros1=True))
    scene = scene_of(tmp_path)
    assert run(["logs", str(log), "--scene", str(scene), "-o", str(tmp_path / "map.toml")]) == 0
    shown = capsys.readouterr().out
    assert "/mocap/pose" in shown and "wheels left_wheel, right_wheel" in shown
    assert path_error(capsys, log, scene, "--map", tmp_path / "map.toml") < 2e-5


@pytest.mark.parametrize("is_ulog", [False, True])
def test_the_fields_of_a_topic_are_shown_with_their_ranges_over_the_whole_recording(is_ulog, tmp_path, capsys):
    messages, topic = Messages(), "/joint_states"
    rows = drive(messages)
    log = rosbag2(tmp_path / "run", rows, messages)
    angles = np.array([list(message.position) for _, name, _, message in rows if name == topic])
    if is_ulog:
        topic = "wheel_encoders"
        stamps = 0.02 * np.arange(len(angles))
        log = ulog(tmp_path / "run.ulg", {topic: (("wheel_angle_rad[0]", "wheel_angle_rad[1]"),
                                                  np.column_stack([stamps, angles]))})
    assert run(["logs", str(log), "--fields", topic, "--json"]) == 0, capsys.readouterr().err
    found = json.loads(capsys.readouterr().out)
    fields = {each["field"]: each for each in found["fields"]}
    for index, joint in enumerate(("left_wheel", "right_wheel")):
        field = fields[f"{topic}.wheel_angle_rad[{index}]" if is_ulog else f"{topic}.position[{joint}]"]
        assert (field["values"], field["unit"]) == (len(angles), "rad")
        assert [field[key] for key in ("first", "smallest", "largest")] == pytest.approx(
            [angles[0, index], angles[:, index].min(), angles[:, index].max()], rel=1e-6)
    assert run(["logs", str(log), "--fields", topic]) == 0
    shown = capsys.readouterr().out
    assert f"{len(angles)} messages" in shown and "smallest" in shown and f"{angles[:, 0].max():.6g}" in shown


@pytest.mark.parametrize(("kind", "name", "values", "unit"), [
    ("JointState", "position[front]", (0, 4096), "tick"), ("JointState", "position[front]", (0.0, 3.5), "rad"),
    ("Odometry", "twist.twist.angular.z", (0.1,), "rad/s"), ("Odometry", "pose.covariance[0]", (0.1,), ""),
    ("Odometry", "pose.pose.position.x", (0.1,), "m"), ("Imu", "linear_acceleration.x", (9.8,), "m/s²"),
    ("NavSatFix", "latitude", (49.1,), "deg"), ("BatteryState", "voltage", (12.1,), "V"),
    ("Drive", "speed_m_per_s", (1.0,), "m/s"), ("Drive", "rpm", (1.0,), "rpm"), ("Drive", "x", (1.0,), ""),
    ("Imu", "header.stamp.nanosec", (5,), "ns"), ("AckermannDrive", "steering_angle", (0.2,), "rad")])
def test_the_unit_of_a_field_comes_from_type_name_and_values(kind, name, values, unit):
    field = Field(name, values[0])
    for value in values:
        field.take(value)
    assert field.unit("/topic", kind) == unit


def test_the_scene_of_these_tests_has_the_wheels_of_their_motion():
    assert f"{RADIUS_M}" in SCENE and f"y_m = {HALF_TRACK_M}" in SCENE


@pytest.mark.parametrize(("lines", "words"), [
    ('pose = "/mocap/pose"\n[pose]\nlag_s = 0.1\n',
     'pose: is given twice, on lines 5 and 6; keep the table, and write the topic there: topic = "/odom"'),
    ('pose = "/mocap/pose"\npose.lag_s = 0.1\n', 'pose: is given twice, on lines 5 and 6; keep the table'),
    ('imu = "/imu"\n[yaw_rate]\ncolumn = "/imu.x"\n', "yaw_rate: is given besides imu; keep the table"),
    ("[wheel_angle]\nsign = 1\n[pose]\n[wheel_angle]\n", "wheel_angle: is given twice, on lines 5 and 8; keep one"),
    ("[wheel_angle]\nsign = 1\nsign = -1\n", "wheel_angle.sign: is given twice, on lines 6 and 7; keep one")])
def test_what_a_map_says_twice_is_named_with_its_remedy(lines, words, tmp_path, capsys):
    messages = Messages()
    log = rosbag2(tmp_path / "run", drive(messages), messages)
    assert words in refused(capsys, log, scene_of(tmp_path), "--map", mapped(tmp_path, f"{USUAL}{lines}"))
