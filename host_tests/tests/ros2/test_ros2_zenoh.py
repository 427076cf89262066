"""Zenoh: keys, tokens and attachments as rmw_zenoh has them, and a robot between two sessions on this machine."""

from __future__ import annotations

import socket
import struct
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import pytest
from test_ros2_messages import MESSAGES, fill

from laconic.cli.main import run
from laconic.errors import BadInput
from laconic.ros2 import messages
from laconic.ros2.cdr import Plain
from laconic.ros2.messages import definitions, message_class, new, plain_class, type_hash
from laconic.ros2.names import LATCHED, Quality, polled
from laconic.ros2.session import Ros2Options, Session
from laconic.scene import read_scene

zenoh = pytest.importorskip("zenoh")

from laconic.ros2.zenoh import Context, attached, attachment, mangled, quality_part  # noqa: E402

DOMAIN = 76
LONGEST_S = 20.0
TWIST, ODOMETRY = "geometry_msgs/msg/Twist", "nav_msgs/msg/Odometry"


def free_ports(count: int) -> list[int]:
    sockets = [socket.create_server(("127.0.0.1", 0)) for _ in range(count)]
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports


@contextmanager
def peers(**options: Any) -> Iterator[tuple[Session, Context, list[str]]]:
    """A robot, and a session of another that it knows by its address."""
    ours, other = (f"tcp/127.0.0.1:{port}" for port in free_ports(2))
    lines: list[str] = []
    peer = Context(DOMAIN, is_local=True, router=ours, listen=other)
    given = Ros2Options(**{"domain": DOMAIN, "is_local": True, "services_for": ("zenoh",), "router": other,
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


def test_keys_tokens_and_attachments_are_those_of_rmw_zenoh() -> None:
    context = Context(2, is_local=True, router=f"tcp/127.0.0.1:{free_ports(1)[0]}")
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
    assert mangled("") == "%" and quality_part(LATCHED) == ":1:,1:,:,:,,"
    data = attachment(5, bytes(range(16)))
    assert len(data) == 33 and struct.unpack_from("<q", data)[0] == 5 and data[16] == 16
    assert attached(data) == (5, bytes(range(16))) and attached(b"short") == attached(None) == (0, bytes(16))


# ---- a robot

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


def test_a_service_answers_with_number_and_sender_of_the_request() -> None:
    with peers() as (session, peer, _):
        kind = "rcl_interfaces/srv/GetParameters"
        request = new(f"{kind}_Request", names=["scene"]).serialize(use_version_2=False)
        replies: list[Any] = []
        key = peer.key("laconic/get_parameters", kind, type_hash(kind))

        def ask() -> bool:
            peer.session.get(key, replies.append, payload=request, attachment=attachment(9, b"client of sixteen"[:16]))
            session.cycle()
            return bool(replies)

        reply = until(session, lambda: ask() and replies)[0].ok
        values = message_class(f"{kind}_Response").deserialize(bytes(reply.payload)).values
        assert values[0].string_value == "TurtleBot3 Burger"
        assert attached(reply.attachment) == (9, b"client of sixteen"[:16])


def test_tokens_of_others_tell_of_namesakes_and_wrong_types() -> None:
    with peers() as (session, peer, lines):
        peer.node("laconic").publisher("cmd_vel", "std_msgs/msg/String")
        until(session, lambda: len(lines) == 2)
        assert sorted(lines) == [
            "/laconic: a publisher on cmd_vel sends std_msgs/msg/String, which is not heard; send Twist or "
            "TwistStamped",
            f"another node is called /laconic in domain {DOMAIN}; give --namespace or --domain"]


def test_bytes_of_another_type_are_told_and_move_nothing() -> None:
    with peers(is_stamped=False) as (session, peer, lines):
        publisher = peer.session.declare_publisher(peer.key("cmd_vel", TWIST, type_hash(TWIST)))

        def send() -> bool:
            publisher.put(b"\x00\x01\x00\x00short")
            return bool(lines)

        until(session, send)
        assert lines == ["/laconic: a message on cmd_vel cannot be read as its type and is ignored"]
        assert session.base.look()[0].x_m == 0.0


def test_what_is_no_endpoint_is_one_line(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    words = ["ros2", "robotino2", "--rmw", "zenoh", "--local", "--domain", str(DOMAIN), "--duration", "0.1"]
    assert run([*words, "--router", "nonsense"]) == 2
    assert capsys.readouterr().err.startswith("laconic: --router: ")
    monkeypatch.setenv("ZENOH_SESSION_CONFIG_URI", "/nowhere.json5")
    with pytest.raises(BadInput, match="ZENOH_SESSION_CONFIG_URI: /nowhere.json5 cannot be read"):
        Context(DOMAIN)


def test_zenoh_needs_no_cyclonedds() -> None:
    code = ("import sys; sys.modules['cyclonedds'] = None\n"
            "from laconic.cli.main import run\n"
            f"sys.exit(run(['ros2', 'f1tenth', '--rmw', 'zenoh', '--local', '--domain', '{DOMAIN}', '--router', "
            f"'tcp/127.0.0.1:{free_ports(1)[0]}', '--duration', '0.2']))")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "10 cycles of 20 ms" in done.stdout
