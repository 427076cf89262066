"""The robot against other implementations: a C++ peer on Fast DDS as ROS 2's middleware makes it, and Zenoh.

The peer needs Debian's libfastrtps-dev and fastddsgen. Its code is generated from IDL and compiled when sources change.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import socket
import struct
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest
from test_ros2_messages import MESSAGES, fill

from laconic.base.paths import build_dir
from laconic.cli.main import run as command
from laconic.errors import BadInput
from laconic.ros2 import messages
from laconic.ros2.messages import Plain, definitions, message_class, new, plain_class, type_hash
from laconic.ros2.names import LATCHED, Quality, polled
from laconic.ros2.session import Ros2Options, Session
from laconic.scene import read_scene

HERE = Path(__file__).parent / "fastdds"
DOMAIN = 78
TOOLS = ("fastddsgen", "g++")
HEADER = Path("/usr/include/fastdds/dds/domain/DomainParticipant.hpp")

IS_THERE = all(map(shutil.which, TOOLS)) and HEADER.exists()


def with_peer(test: Any) -> Any:
    """A test that needs the peer, and seconds of real time."""
    for mark in (pytest.mark.nightly, pytest.mark.timeout(300), pytest.mark.skipif(
            not IS_THERE, reason="libfastrtps-dev and fastddsgen are not there")):
        test = mark(test)
    return test


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


@with_peer
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


@with_peer
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


@with_peer
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


@with_peer
def test_bytes_of_another_type_move_nothing(peer: Path) -> None:
    with robot() as process:
        found = heard(peer, 4.0, "garbage")
        summary = ended(process)
    assert found["sent"] > 100 and found["odom"]["count"] > 50
    assert found["odom_end"][:2] == [0.0, 0.0]
    assert summary["final"] == {"x_m": 0.0, "y_m": 0.0, "heading_rad": 0.0}


@with_peer
def test_the_robot_stops_when_the_peer_is_gone(peer: Path) -> None:
    with robot("--duration", "7") as process:
        heard(peer, 2.5, "twist")
        summary = ended(process, stop=False)
    assert summary["events"] == {"/laconic: watchdog": 1}
    assert 0.1 < summary["final"]["x_m"] < 0.7


@with_peer
def test_none_of_a_thousand_messages_a_second_is_lost(peer: Path) -> None:
    with robot("--rate", "1000") as process:
        found = heard(peer, 10.0, "twist")
        summary = ended(process)
    assert summary["period_s"] == 0.001
    for name in ("odom", "tf", "joint_states", "imu"):
        assert found[name]["count"] > 5000 and found[name]["lost"] == 0, found[name]


# ---- Zenoh

ZENOH_DOMAIN = 76
LONGEST_S = 20.0
TWIST, ODOMETRY = "geometry_msgs/msg/Twist", "nav_msgs/msg/Odometry"


zenoh = pytest.importorskip("laconic.ros2.zenoh") if find_spec("zenoh") else None
with_zenoh = pytest.mark.skipif(zenoh is None, reason="eclipse-zenoh is not there")


def free_ports(count: int) -> list[int]:
    sockets = [socket.create_server(("127.0.0.1", 0)) for _ in range(count)]
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports


@contextmanager
def peers(**options: Any) -> Iterator[tuple[Session, Any, list[str]]]:
    """A robot, and a session of another that it knows by its address."""
    ours, other = (f"tcp/127.0.0.1:{port}" for port in free_ports(2))
    lines: list[str] = []
    peer = zenoh.Context(ZENOH_DOMAIN, is_local=True, router=ours, listen=other)
    given = Ros2Options(**{"domain": ZENOH_DOMAIN, "is_local": True, "services_for": ("zenoh",), "router": other,
                           "listen": ours, **options})
    try:
        with Session(read_scene("turtlebot3_burger"), given, lines.append) as session:
            yield session, peer, lines
    finally:
        peer.close()


def until(session: Session, is_so: Callable[[], Any]) -> Any:
    """Cycles until something has arrived; what comes over threads of Zenoh has no virtual time."""
    end = time.monotonic() + LONGEST_S
    while time.monotonic() < end:
        session.cycle()
        if found := is_so():
            return found
    raise AssertionError("nothing arrived")


# ---- the wire

def test_a_type_without_cyclonedds_has_the_same_bytes() -> None:
    for name in MESSAGES:
        filled = fill(name, iter(range(1, 10_000)))
        data = bytes(filled.serialize(use_version_2=False))
        read = plain_class(name).deserialize(data)
        assert isinstance(read, Plain) and read.serialize() == data, name
        assert plain_class(name)().serialize() == bytes(message_class(name)().serialize(use_version_2=False)), name


def test_bytes_that_are_cut_are_refused_without_cyclonedds() -> None:
    for name in MESSAGES:
        data = bytes(fill(name, iter(range(1, 10_000))).serialize(use_version_2=False))
        for length in range(4, len(data) - 8, max(1, len(data) // 40)):
            with pytest.raises(ValueError, match="these bytes are no"):
                plain_class(name).deserialize(data[:length])
    with pytest.raises(ValueError, match="these bytes are no JointState"):
        plain_class("sensor_msgs/msg/JointState").deserialize(b"\x00\x01\x00\x00" + b"\xff" * 64)


def test_big_endian_is_read_without_cyclonedds() -> None:
    data = b"\x00\x00\x00\x00" + struct.pack(">3d", 1.0, 2.0, 3.0)
    found = plain_class("geometry_msgs/msg/Vector3").deserialize(data)
    assert (found.x, found.y, found.z) == (1.0, 2.0, 3.0)


def test_the_hash_of_a_service_is_that_of_ros(monkeypatch: pytest.MonkeyPatch) -> None:
    known = definitions(16) | {
        "example_interfaces/srv/AddTwoInts_Request": messages.fields_of("int64 a, int64 b"),
        "example_interfaces/srv/AddTwoInts_Response": messages.fields_of("int64 sum")}
    monkeypatch.setattr(messages, "definitions", lambda _: known)
    assert type_hash.__wrapped__("example_interfaces/srv/AddTwoInts") == (  # type: ignore[attr-defined]
        "RIHS01_e118de6bf5eeb66a2491b5bda11202e7b68f198d6f67922cf30364858239c81a")


@with_zenoh
def test_keys_tokens_and_attachments_are_those_of_rmw_zenoh() -> None:
    context = zenoh.Context(2, is_local=True, router=f"tcp/127.0.0.1:{free_ports(1)[0]}")
    try:
        node = context.node("talker", "/floor1")
        known = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
        assert type_hash("std_msgs/msg/String") == known
        assert context.key("/floor1/chatter", "std_msgs/msg/String", known) == (
            f"2/floor1/chatter/std_msgs::msg::dds_::String_/{known}")
        assert context.token(node, "MP", "/floor1/chatter", "std_msgs/msg/String", Quality(7)) == (
            f"@ros2_lv/2/{context.id}/0/1/MP/%/%floor1/talker/%floor1%chatter/std_msgs::msg::dds_::String_/{known}/"
            "::,7:,:,:,,")
    finally:
        context.close()
    assert zenoh.mangled("") == "%" and zenoh.quality_part(LATCHED) == ":1:,1:,:,:,,"
    data = zenoh.attachment(5, bytes(range(16)))
    assert len(data) == 33 and struct.unpack_from("<q", data)[0] == 5 and data[16] == 16
    assert zenoh.attached(data) == (5, bytes(range(16)))
    assert zenoh.attached(b"short") == zenoh.attached(None) == (0, bytes(16))


# ---- a robot

@with_zenoh
def test_a_peer_drives_the_robot_and_hears_it() -> None:
    with peers() as (session, peer, _):
        node = peer.node("peer")
        commands, odometry = node.publisher("cmd_vel", TWIST), node.subscription("odom", ODOMETRY)
        fixed = node.subscription("tf_static", "tf2_msgs/msg/TFMessage", LATCHED)
        twist = new(TWIST)
        twist.linear.x = 0.1
        found: list[Any] = []

        def is_driven() -> bool:
            commands.write(twist)
            found.extend(polled(odometry))
            return bool(found) and found[-1].twist.twist.linear.x > 0.09

        until(session, is_driven)
        assert found[-1].child_frame_id == "base_link"
        assert until(session, lambda: polled(fixed))[0].transforms[0].child_frame_id == "imu_link"


@with_zenoh
def test_a_service_answers_with_number_and_sender_of_the_request() -> None:
    with peers() as (session, peer, _):
        kind = "rcl_interfaces/srv/GetParameters"
        request = new(f"{kind}_Request", names=["scene"]).serialize(use_version_2=False)
        replies: list[Any] = []
        key = peer.key("laconic/get_parameters", kind, type_hash(kind))

        def ask() -> bool:
            peer.session.get(key, replies.append, payload=request,
                             attachment=zenoh.attachment(9, b"client of sixteen"[:16]))
            session.cycle()
            return bool(replies)

        reply = until(session, lambda: ask() and replies)[0].ok
        values = message_class(f"{kind}_Response").deserialize(bytes(reply.payload)).values
        assert values[0].string_value == "TurtleBot3 Burger"
        assert zenoh.attached(reply.attachment) == (9, b"client of sixteen"[:16])


@with_zenoh
def test_tokens_of_others_tell_of_namesakes_and_wrong_types() -> None:
    with peers() as (session, peer, lines):
        peer.node("laconic").publisher("cmd_vel", "std_msgs/msg/String")
        until(session, lambda: len(lines) == 2)
        assert sorted(lines) == [
            "/laconic: a publisher on cmd_vel sends std_msgs/msg/String, which is not heard; send Twist or "
            "TwistStamped",
            f"another node is called /laconic in domain {ZENOH_DOMAIN}; give --namespace or --domain"]


@with_zenoh
def test_a_token_of_our_type_with_other_fields_is_told() -> None:
    with peers() as (session, peer, lines):
        token = peer.token(peer.node("peer"), zenoh.PUBLISHER, "/cmd_vel", TWIST)
        other = token.replace(type_hash(TWIST), "RIHS01_" + 64 * "0")
        peer.kept(peer.session.liveliness().declare_token(other))
        until(session, lambda: bool(lines))
        assert lines == ["/laconic: a publisher on cmd_vel sends geometry_msgs/msg/Twist with other fields than ROS "
                         "has, which is not heard; build it of the definition of ROS"]


@with_zenoh
def test_a_router_that_comes_late_and_goes_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(zenoh, "LINK_S", 0.0)
    where = f"tcp/127.0.0.1:{free_ports(1)[0]}"
    context, lines = zenoh.Context(ZENOH_DOMAIN, is_local=True, router=where), list[str]()

    def more_lines(count: int) -> None:
        end = time.monotonic() + LONGEST_S
        while len(lines) < count and time.monotonic() < end:
            lines.extend(context.remarks())
            time.sleep(0.01)  # while threads of Zenoh work

    try:
        lines += [*context.remarks(), *context.remarks()]
        router = zenoh.Context(ZENOH_DOMAIN, is_local=True, router="tcp/127.0.0.1:1", listen=where)
        try:
            more_lines(2)
        finally:
            router.close()
        more_lines(3)
        assert lines == [f"no Zenoh router at {where} yet; will connect when it comes",
                         f"connected to Zenoh at {where}",
                         f"the Zenoh router at {where} is gone; will connect when it comes again"]
    finally:
        context.close()


@with_zenoh
def test_bytes_of_another_type_are_told_and_move_nothing() -> None:
    with peers(is_stamped=False) as (session, peer, lines):
        publisher = peer.session.declare_publisher(peer.key("cmd_vel", TWIST, type_hash(TWIST)))

        def send() -> bool:
            publisher.put(b"\x00\x01\x00\x00short")
            return bool(lines)

        until(session, send)
        assert lines == ["/laconic: a message on cmd_vel cannot be read as its type and is ignored"]
        assert session.base.look()[0].x_m == 0.0


@with_zenoh
def test_what_is_no_endpoint_is_one_line(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    words = ["ros2", "robotino2", "--rmw", "zenoh", "--local", "--domain", str(ZENOH_DOMAIN), "--duration", "0.1"]
    assert command([*words, "--router", "nonsense"]) == 2
    assert capsys.readouterr().err.startswith("laconic: --router: ")
    monkeypatch.setenv("ZENOH_SESSION_CONFIG_URI", "/nowhere.json5")
    with pytest.raises(BadInput, match="ZENOH_SESSION_CONFIG_URI: /nowhere.json5 cannot be read"):
        zenoh.Context(ZENOH_DOMAIN)


@with_zenoh
def test_zenoh_needs_no_cyclonedds() -> None:
    code = ("import sys; sys.modules['cyclonedds'] = None\n"
            "from laconic.cli.main import run\n"
            f"sys.exit(run(['ros2', 'f1tenth', '--rmw', 'zenoh', '--local', '--domain', '{ZENOH_DOMAIN}', '--router', "
            f"'tcp/127.0.0.1:{free_ports(1)[0]}', '--duration', '0.2']))")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "10 cycles of 20 ms" in done.stdout
