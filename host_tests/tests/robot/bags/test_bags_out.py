"""A run as a recording: read by others, back with the same numbers, readable after an early end."""

from __future__ import annotations

import json
import os
import sqlite3
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader

import laconic
from bag_support import SCENE
from laconic.cli.main import run
from laconic.robot.bags.run_topics import RunTopics, needed_signals, open_bag

INPUT = '[[input]]\nsignal = "voltage_V[{}]"\nkind = "steps"\nt_s = [0.0, 1.5, 3.0]\nvalue = {}\n'
NAMES = ("run", "run.mcap")
STORED = (*NAMES, "folder of mcap")


def driven(folder: Path, old: str = "", new: str = "") -> Path:
    path = folder / "robot.toml"
    text = SCENE + INPUT.format(1, "[2.0, 1.0, 2.5]") + INPUT.format(2, "[2.5, 3.0, 1.5]")
    path.write_text(text.replace(old, new, 1) if old else text)
    return path


def recorded(folder: Path, name: str, scene: Path | None = None) -> Path:
    bag = folder / name
    storage = ["--storage", "mcap"] if name == "folder of mcap" else []
    assert run(["simulate", str(scene or driven(folder)), "--bag", str(bag), *storage]) == 0
    return bag


@pytest.mark.parametrize("name", NAMES)
def test_a_run_comes_back_with_the_errors_of_its_table(name, tmp_path, capsys):
    """Rolling from sample to sample takes the speed as constant, which is the whole error: 0.0006 %."""
    bag, table = tmp_path / name, tmp_path / "run.csv"
    assert run(["simulate", str(driven(tmp_path)), "--bag", str(bag), "--out", str(table)]) == 0
    errors = []
    for log in (bag, table):
        capsys.readouterr()
        assert run(["replay", str(log), str(tmp_path / "robot.toml"), "--inputs", "wheel-speeds", "--json"]) == 0
        errors.append(json.loads(capsys.readouterr().out)["runs"][0])
    assert errors[0]["path_error"] == pytest.approx(errors[1]["path_error"], abs=1e-12)
    assert errors[0]["path_error"] < 1e-5
    assert errors[0]["heading_error_rad"] < 1e-9


@pytest.mark.parametrize("name", STORED)
def test_identify_finds_the_wheels_of_the_robot_that_was_recorded(name, tmp_path, capsys):
    other = driven(tmp_path, 'kind = "fixed"', 'kind = "fixed"\nradius_m = 0.034')
    bag = recorded(tmp_path, name, other)
    capsys.readouterr()
    assert run(["identify", str(bag), "--scene", str(driven(tmp_path)), "--json"]) == 0
    left, right, distance = json.loads(capsys.readouterr().out)["parameters"]
    for found, true in ((left, 0.034), (right, 0.033), (distance, 1.0)):
        assert found["low"] <= true <= found["high"] and abs(found["value"] - true) < 1e-4 * true


@pytest.mark.parametrize("name", STORED)
def test_other_readers_find_the_names_types_and_numbers_of_the_run(name, tmp_path):
    bag = recorded(tmp_path, name)
    trajectory = laconic.simulate(laconic.read_scene(str(tmp_path / "robot.toml")))
    with AnyReader([bag]) as reader:
        kinds = {each.topic: each.msgtype for each in reader.connections}
        messages = {topic: [reader.deserialize(data, each.msgtype) for each, _, data in reader.messages(
            [one for one in reader.connections if one.topic == topic])] for topic in kinds}
    assert len(messages.pop("/tf_static")) == 1 and kinds.pop("/tf_static") == kinds["/tf"]
    assert kinds == {"/ground_truth/odom": "nav_msgs/msg/Odometry", "/odom": "nav_msgs/msg/Odometry",
                     "/joint_states": "sensor_msgs/msg/JointState", "/tf": "tf2_msgs/msg/TFMessage",
                     "/imu": "sensor_msgs/msg/Imu", "/wheel_voltages": "std_msgs/msg/Float64MultiArray"}
    assert {len(each) for each in messages.values()} == {len(trajectory.time_s)}
    truth, joints = messages["/ground_truth/odom"], messages["/joint_states"]
    assert (truth[0].header.frame_id, truth[0].child_frame_id) == ("map", "base_link")
    assert [each.pose.pose.position.x for each in truth] == trajectory.columns["x_m"].tolist()
    assert [each.position[1] for each in joints] == trajectory.columns["wheel_angle_rad[2]"].tolist()
    stamps = [each.header.stamp.sec + 1e-9 * each.header.stamp.nanosec for each in truth]
    assert np.allclose(stamps, trajectory.time_s, atol=1e-9)
    odometry, speed = messages["/odom"], trajectory.columns["velocity_body_m_per_s[1]"]
    assert odometry[-1].pose.pose.position.y == pytest.approx(truth[-1].pose.pose.position.y, abs=1e-4)
    assert truth[99].twist.twist.linear.x == speed[99]


def test_the_velocity_of_the_truth_is_that_of_its_own_position(tmp_path):
    """Both are of the frame base_link, however far the mass is from it."""
    bag = recorded(tmp_path, "run.mcap", driven(tmp_path, "[vehicle]\n", "[vehicle]\ncom_x_m = 0.2\ncom_y_m = 0.1\n"))
    with AnyReader([bag]) as reader:
        chosen = [one for one in reader.connections if one.topic == "/ground_truth/odom"]
        truth = [reader.deserialize(data, each.msgtype) for each, _, data in reader.messages(chosen)]
    time_s = np.array([each.header.stamp.sec + 1e-9 * each.header.stamp.nanosec for each in truth])
    place = np.array([[each.pose.pose.position.x, each.pose.pose.position.y] for each in truth])
    heading = np.array([2 * np.arctan2(each.pose.pose.orientation.z, each.pose.pose.orientation.w) for each in truth])
    speed = np.gradient(place, time_s, axis=0)
    ahead = np.cos(heading) * speed[:, 0] + np.sin(heading) * speed[:, 1]
    left = np.cos(heading) * speed[:, 1] - np.sin(heading) * speed[:, 0]
    steady = slice(100, 145)  # a step of the voltages is at 1.5 s
    assert ahead[steady] == pytest.approx([each.twist.twist.linear.x for each in truth[steady]], abs=1e-4)
    assert left[steady] == pytest.approx([each.twist.twist.linear.y for each in truth[steady]], abs=1e-4)
    assert max(abs(each.twist.twist.angular.z) for each in truth[steady]) > 0.1


def test_the_reader_of_mcap_for_ros_2_reads_it(tmp_path):
    bag = recorded(tmp_path, "run.mcap")
    with bag.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        found = [message for *_, message in reader.iter_decoded_messages(topics=["/joint_states"])]
    assert len(found) == 401 and list(found[0].name) == ["wheel_1_joint", "wheel_2_joint"]


def test_a_folder_with_files_is_not_written_to(tmp_path, capsys):
    bag = recorded(tmp_path, "run")
    before = {each.name: each.read_bytes() for each in bag.iterdir()}
    assert run(["simulate", str(tmp_path / "robot.toml"), "--bag", str(bag)]) == 2
    assert "is a folder that holds files already" in capsys.readouterr().err
    assert {each.name: each.read_bytes() for each in bag.iterdir()} == before


@pytest.mark.parametrize("name", NAMES)
def test_a_recorder_that_was_killed_leaves_what_was_written(name, tmp_path, capsys):
    """The process dies without a chance to close its files."""
    bag, scene = tmp_path / name, driven(tmp_path)
    code = (f"import os, pathlib, laconic\nfrom laconic.robot.bags.run_topics import RunTopics, needed_signals\n"
            f"from laconic.robot.bags.run_topics import open_bag\nscene = laconic.read_scene({str(scene)!r})\n"
            "run = laconic.simulate(scene, needed_signals(scene))\n"
            f"with open_bag(pathlib.Path({str(bag)!r})) as bag:\n    topics = RunTopics(scene, bag)\n"
            "    for k, time_s in enumerate(run.time_s[:400]):\n"
            "        topics.take(time_s, {name: float(each[k]) for name, each in run.columns.items()})\n"
            "    os._exit(9)\n")
    assert subprocess.run([sys.executable, "-c", code], env=os.environ, check=False).returncode == 9
    assert run(["replay", str(bag), str(scene), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["runs"][0]["path_error"] < 1e-5
    if name.endswith(".mcap"):
        assert any("was not closed" in each for each in found["remarks"])


def test_a_rosbag_without_its_metadata_is_read(tmp_path, capsys):
    bag = recorded(tmp_path, "run")
    (bag / "metadata.yaml").unlink()
    capsys.readouterr()
    assert run(["replay", str(bag / "run_0.db3"), str(tmp_path / "robot.toml"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["runs"][0]["path_error"] < 1e-5
    assert sqlite3.connect(bag / "run_0.db3").execute("SELECT schema_version FROM schema").fetchall() == [(4,)]


def test_a_scene_without_odometry_states_so(tmp_path, capsys):
    text = driven(tmp_path).read_text()
    body = text[:text.index("[[vehicle.wheel]]")]
    (tmp_path / "none.toml").write_text(f"{body}[run]\nduration_s = 1.0\nstep_s = 0.1\n")
    assert run(["simulate", str(tmp_path / "none.toml"), "--bag", str(tmp_path / "run.mcap")]) == 0
    assert "has no /odom and no /tf" in capsys.readouterr().err


@pytest.mark.parametrize("scene, steps", [("", 400), pytest.param("turtlebot3_burger", 2500,
                                                                  marks=pytest.mark.nightly)])
@pytest.mark.parametrize("mode", ["--lockstep", "--free-run"])
def test_a_rig_writes_what_its_node_sends(mode, scene, steps, tmp_path, capsys):
    bag, scene = tmp_path / "run.mcap", scene or str(driven(tmp_path))
    assert run(["rig", scene, mode, "--steps", str(steps), "--bag", str(bag), "--json"]) == 0
    capsys.readouterr()
    assert run(["replay", str(bag), scene, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["runs"][0]["path_error"] < 0.03  # millimetres of POSE over some centimetres
    assert any("/joint_states: " in each for each in found["remarks"])


def test_raw_frames_have_no_signals_for_a_bag(tmp_path, capsys):
    assert run(["rig", "turtlebot3_burger", "--same-bits", "--bag", str(tmp_path / "run.mcap")]) == 2
    assert "needs frames with signals" in capsys.readouterr().err


def test_a_played_vehicle_is_written_while_it_plays(tmp_path, capsys):
    bag = tmp_path / "run"
    options = ["--listen", "0", "--drives", "odrive", "--duration", "0.3"]
    assert run(["play", "robotino2", *options, "--bag", str(bag)]) == 0
    capsys.readouterr()
    assert run(["logs", str(bag), "--json"]) == 0
    shown = {each["topic"]: each["messages"] for each in json.loads(capsys.readouterr().out)["columns"]}
    assert set(shown) == {"/ground_truth/odom", "/joint_states", "/odom", "/tf", "/tf_static", "/imu"}
    assert int(shown["/odom"]) > 5


@pytest.mark.parametrize("name", NAMES)
def test_a_run_that_is_stopped_while_it_is_written_leaves_a_whole_recording(name, tmp_path, capsys):
    scene, bag = laconic.read_scene(str(driven(tmp_path))), tmp_path / name
    trajectory = laconic.simulate(scene, needed_signals(scene))

    def write() -> None:
        with open_bag(bag) as writer:
            topics = RunTopics(scene, writer)
            for k, time_s in enumerate(trajectory.time_s):
                topics.take(time_s, {name: float(each[k]) for name, each in trajectory.columns.items()})
                if k == 200:
                    raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write()
    assert run(["logs", str(bag), "--json"]) == 0
    shown = {each["topic"]: each["messages"] for each in json.loads(capsys.readouterr().out)["columns"]}
    assert shown.pop("/tf_static") == "1" and set(shown.values()) == {"201"}


def test_joints_have_the_names_that_the_base_of_the_scene_gives_them(tmp_path):
    scene = driven(tmp_path)
    scene.write_text(scene.read_text() + '[base]\njoint_names = ["left_wheel_joint", "right_wheel_joint"]\n')
    bag = recorded(tmp_path, "run.mcap", scene)
    with bag.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        found = [message for *_, message in reader.iter_decoded_messages(topics=["/joint_states"])]
    assert list(found[0].name) == ["left_wheel_joint", "right_wheel_joint"]


STEERED_MAP = """format = "bag"
[wheel_angle]
columns = ["/joint_states.position[wheel_1_joint]"]
[steering_angle]
columns = ["/joint_states.position[front_hinge_joint]"]
[pose]
topic = "/ground_truth/odom"
"""


def test_a_steered_run_comes_back_by_its_steering_angles(tmp_path, capsys):
    bag, columns = tmp_path / "run.mcap", tmp_path / "map.toml"
    columns.write_text(STEERED_MAP)
    assert run(["simulate", "tricycle_agv", "--bag", str(bag)]) == 0
    capsys.readouterr()
    assert run(["replay", str(bag), "tricycle_agv", "--map", str(columns), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["runs"][0]
    assert found["path_error"] < 1e-4 and found["heading_error_rad"] < 2e-4


@pytest.mark.parametrize("name", ["run.bag", "run.DB3", "run.ulg", "run.mcap.zstd", "run.csv"])
def test_a_name_of_a_file_that_is_not_written_is_refused_with_those_that_are(name, tmp_path, capsys):
    assert run(["simulate", "s1", "--bag", str(tmp_path / name)]) == 2
    error = capsys.readouterr().err
    assert "is not written; choose NAME.mcap for one file, or a name without an ending" in error
    assert error.count("\n") == 1 and not (tmp_path / name).exists()


@pytest.mark.parametrize("scene", ["kuka_youbot", pytest.param("optiodom_omni3", marks=pytest.mark.nightly),
                                   "paper_differential_drive"])
def test_a_simulated_bag_is_not_said_to_lack_something(scene, tmp_path, capsys):
    bag = recorded(tmp_path, "run.mcap", Path(scene))
    capsys.readouterr()
    assert run(["identify", str(bag), "--scene", scene, "--json", "-o", str(tmp_path / "fitted.toml")]) == 0
    found = json.loads(capsys.readouterr().out)
    words = " ".join(found["words"])
    assert "lacks something" not in words and "err alike" not in words
    assert all(each["low"] <= each["nominal"] <= each["high"] for each in found["parameters"])
    assert "/wheel_voltages: its messages have no time stamps" in words  # and it is not said to be joined by them
    joined, = (each for each in found["words"] if "/wheel_voltages" in each and "assigned" in each)
    assert "assigned to the rows by their times of recording" in joined


def test_an_audit_of_a_simulated_bag_says_that_the_scene_is_right(tmp_path, capsys):
    bag = recorded(tmp_path, "run.mcap", Path("kuka_youbot"))
    capsys.readouterr()
    assert run(["audit", str(bag), "kuka_youbot"]) == 0
    page = capsys.readouterr().out
    assert "no more than sampling and rounding of the logs make: the scene's numbers are right" in page
    assert "lacks something" not in page.partition("## What the fit states")[2] and "slip or drag there" not in page


@pytest.mark.parametrize("scene", [pytest.param("tricycle_agv", marks=pytest.mark.nightly), "f1tenth"])
def test_a_bag_of_a_steered_vehicle_replays_and_is_audited_without_a_map(scene, tmp_path, capsys):
    bag = recorded(tmp_path, "run.mcap", Path(scene))
    capsys.readouterr()
    assert run(["logs", str(bag), "--scene", scene]) == 0
    assert "_hinge_joint]" in capsys.readouterr().out
    assert run(["replay", str(bag), scene, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["runs"][0]["path_error"] < 1e-3
    assert run(["audit", str(bag), scene, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["found"] <= found["nominal"] < 1e-3
