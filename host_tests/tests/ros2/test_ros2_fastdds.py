"""The robot against another DDS implementation: a C++ peer on Fast DDS, made as ROS 2's middleware for it is.

It needs Debian's libfastrtps-dev and fastddsgen. Its code is generated from IDL and compiled when the sources change.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from laconic.base.paths import build_dir
from laconic.ros2.messages import type_hash

HERE = Path(__file__).parent / "fastdds"
DOMAIN = 78
TOOLS = ("fastddsgen", "g++")
HEADER = Path("/usr/include/fastdds/dds/domain/DomainParticipant.hpp")

pytestmark = [pytest.mark.nightly, pytest.mark.timeout(300), pytest.mark.skipif(
    not (all(map(shutil.which, TOOLS)) and HEADER.exists()), reason="libfastrtps-dev and fastddsgen are not there")]


@pytest.fixture(scope="module")
def peer() -> Path:
    """The compiled peer."""
    sources = [HERE / "peer.idl", HERE / "peer.cpp"]
    state = hashlib.sha256(b"".join(each.read_bytes() for each in sources)).hexdigest()[:16]
    folder = build_dir() / "ros2_peer" / state
    program = folder / "peer"
    if not program.exists():
        folder.mkdir(parents=True, exist_ok=True)
        for each in sources:
            shutil.copy(each, folder)
        run(["fastddsgen", "-replace", "peer.idl"], folder)
        made = [each.name for each in folder.glob("*.cxx")]
        run(["g++", "-std=c++14", "-O1", "-w", "-o", "peer.new", "peer.cpp", *made, "-lfastrtps", "-lfastcdr",
             "-lpthread"], folder)
        (folder / "peer.new").replace(program)
    return program


def run(words: list[str], folder: Path) -> None:
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, timeout=250)
    assert done.returncode == 0, done.stderr[-3000:]


@contextmanager
def robot(*options: str) -> Iterator[subprocess.Popen[str]]:
    """`laconic ros2` in a process of its own, which is ended by SIGINT."""
    words = [sys.executable, "-m", "laconic", "ros2", "turtlebot3_burger", "--local", "--domain", str(DOMAIN), "--json",
             *options]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        assert process.stderr is not None
        process.stderr.readline()
        yield process
    finally:
        process.kill()
        process.communicate()


def heard(program: Path, seconds: float, kind: str, ahead: float = 0.2, yaw_rate: float = 0.4) -> Any:
    """What the peer saw in so many seconds."""
    words = [str(program), str(DOMAIN), str(seconds), "50", kind, str(ahead), str(yaw_rate)]
    done = subprocess.run(words, capture_output=True, text=True, timeout=seconds + 60,
                          env=os.environ | {"FASTDDS_STATISTICS": ""})
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def ended(process: subprocess.Popen[str], stop: bool = True) -> Any:
    """The summary of a robot."""
    import signal

    if stop:
        process.send_signal(signal.SIGINT)
    out, _ = process.communicate(timeout=30)
    assert process.returncode == 0
    return json.loads(out)


@pytest.mark.parametrize("kind", ["twist", "stamped"])
def test_the_peer_drives_the_robot_and_hears_every_topic(peer: Path, kind: str) -> None:
    with robot() as process:
        found = heard(peer, 4.0, kind)
        summary = ended(process)
    assert found["odom_end"][2] == pytest.approx(0.2, abs=1e-3) and found["odom_end"][3] == pytest.approx(0.4, abs=1e-3)
    assert found["imu_end"] == pytest.approx([0.4, 9.80665], abs=1e-3)
    assert found["joint_names"] == ["wheel_left_joint", "wheel_right_joint"]
    assert found["joint_velocity"] == pytest.approx([(0.2 - 0.08 * 0.4) / 0.033, (0.2 + 0.08 * 0.4) / 0.033], abs=0.02)
    assert found["frames"] == ["odom", "base_link"]
    for name in ("odom", "ground_truth", "tf", "joint_states", "imu"):
        assert found[name]["count"] > 100 and found[name]["lost"] == 0, name
    assert found["tf_static"]["count"] == 1
    assert summary["commands"] > 100 and summary["events"] == {}


def test_the_peer_reads_graph_types_and_hashes(peer: Path) -> None:
    with robot() as process:
        found = heard(peer, 2.0, "none")
        ended(process)
    namespace, name, readers, writers = found["nodes"][0]
    assert (namespace, name) == ("/", "laconic") and readers > 8 and writers > 12
    for topic, kind in (("rt/odom", "nav_msgs/msg/Odometry"), ("rt/tf", "tf2_msgs/msg/TFMessage"),
                        ("rt/joint_states", "sensor_msgs/msg/JointState")):
        wire = kind.replace("/msg/", "::msg::dds_::") + "_"
        assert found["endpoints"][f"writer {topic} {wire}"] == f"typehash={type_hash(kind)};|reliable|volatile"
    latched = found["endpoints"]["writer rt/tf_static tf2_msgs::msg::dds_::TFMessage_"]
    assert latched.endswith("|reliable|latched")
    for last in ("Twist", "TwistStamped"):
        assert f"reader rt/cmd_vel geometry_msgs::msg::dds_::{last}_" in found["endpoints"]


@pytest.mark.parametrize("options", [(), ("--rmw", "fastrtps")])
def test_the_peer_calls_a_service_as_rmw_fastrtps_does(peer: Path, options: tuple[str, ...]) -> None:
    with robot(*options) as process:
        found = heard(peer, 5.0, "call")
        ended(process)
    assert found["requests"] > 50 and found["of_others"] == 0
    answers = {number: types for number, *types in found["answers"]}
    assert len(answers) == len(found["answers"]) > found["requests"] - 20  # the last may be on their way
    assert sorted(answers) == [*range(1, len(answers) + 1)]
    assert answers[1] == [1, 3, 4, 0] and answers[2] == [1, 3, 4]


def test_bytes_of_another_type_move_nothing(peer: Path) -> None:
    with robot() as process:
        found = heard(peer, 4.0, "garbage")
        summary = ended(process)
    assert found["sent"] > 100 and found["odom"]["count"] > 50
    assert found["odom_end"][:2] == [0.0, 0.0]
    assert summary["final"] == {"x_m": 0.0, "y_m": 0.0, "heading_rad": 0.0}


def test_the_robot_stops_when_the_peer_is_gone(peer: Path) -> None:
    with robot("--duration", "7") as process:
        heard(peer, 2.5, "twist")
        summary = ended(process, stop=False)
    assert summary["events"] == {"/laconic: watchdog": 1}
    assert 0.1 < summary["final"]["x_m"] < 0.7


def test_none_of_a_thousand_messages_a_second_is_lost(peer: Path) -> None:
    with robot("--rate", "1000") as process:
        found = heard(peer, 10.0, "twist")
        summary = ended(process)
    assert summary["period_s"] == 0.001
    for name in ("odom", "tf", "joint_states", "imu"):
        assert found[name]["count"] > 5000 and found[name]["lost"] == 0, found[name]
