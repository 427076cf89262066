"""Types on the wire: hashes against rosbags' definitions, CDR against rosbags' reader, offsets of packed messages.

Then packets of services, against a hand-made client: discovery, identities, what is lost, and wrong bytes.
"""

from __future__ import annotations

import os
import random
import socket
import struct
from collections.abc import Iterator
from typing import Any

import pytest
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from laconic.ros2.messages import DEFINITIONS, Packed, dds_name, definitions, message_class, new, offsets_of, type_hash
from laconic.ros2.packets import (
    ACKNACK,
    DATA,
    GAP,
    OF_CYCLONE,
    OF_FAST,
    PORTS,
    PUBLICATIONS,
    SPDP,
    SUBSCRIPTIONS,
    Submessage,
    acknack,
    data,
    gap,
    heartbeat,
    identity_parameters,
    locator,
    packet,
    packets_of,
    parameters,
    text_parameter,
)
from laconic.ros2.rtps import MOST_KEPT, Services

STORES = {"jazzy": get_typestore(Stores.ROS2_JAZZY), "humble": get_typestore(Stores.ROS2_HUMBLE)}
ACKERMANN = """float32 steering_angle
float32 steering_angle_velocity
float32 speed
float32 acceleration
float32 jerk
"""
for store in STORES.values():  # the package is released apart from the distributions
    store.register(get_types_from_msg(ACKERMANN, "ackermann_msgs/msg/AckermannDrive"))
    store.register(get_types_from_msg("std_msgs/Header header\nAckermannDrive drive\n",
                                      "ackermann_msgs/msg/AckermannDriveStamped"))
OF_GRAPH = "rmw_dds_common/"  # rosbags hashes the char of its .msg file; ROS hashes the uint8 that IDL makes of it
MESSAGES = [name for name in definitions(16) if "/msg/" in name and not name.startswith(OF_GRAPH)]


@pytest.mark.parametrize("name", MESSAGES)
def test_hash_is_that_of_rosbags(name: str) -> None:
    for store in STORES.values():
        assert type_hash(name) == store.hash_rihs01(name)


def test_hash_of_the_graph_is_that_of_ros() -> None:
    name = "rmw_dds_common/msg/ParticipantEntitiesInfo"
    assert type_hash(name) == "RIHS01_91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e"


def test_every_field_has_its_place_in_rosbags() -> None:
    for name in MESSAGES:
        _, fields = STORES["jazzy"].fielddefs[name]
        assert [field for field, _ in fields] == [field for field, _ in definitions(16)[name]], name


@pytest.mark.parametrize("name", MESSAGES)
def test_rosbags_reads_what_is_written(name: str) -> None:
    filled = fill(name, iter(range(1, 10_000)))
    data = filled.serialize(use_version_2=False)
    assert bytes(data[:4]) == b"\x00\x01\x00\x00"  # XCDR1, little endian
    store = STORES["jazzy"]
    read = store.deserialize_cdr(bytes(data), name)
    written = store.serialize_cdr(read, name)
    assert bytes(written).rstrip(b"\0") == bytes(data).rstrip(b"\0")
    assert message_class(name).deserialize(bytes(written)) == message_class(name).deserialize(bytes(data))


def fill(name: str, numbers: object) -> object:
    """A message without two equal numbers."""
    made = message_class(name)()
    for field, kind in definitions(16)[name]:
        count = kind.count if kind.many == 48 else 1 if kind.count else 2
        items = [item(kind, numbers) for _ in range(count)] if kind.many else item(kind, numbers)
        setattr(made, field, items)
    return made


def item(kind: object, numbers: object) -> object:
    number = next(numbers)
    if kind.is_nested:
        return fill(kind.item, numbers)
    usual = {"string": f"text {number}", "bool": True}
    return usual.get(kind.item, float(number) if kind.item.startswith("float") else number % 120)


def test_names_are_mangled_as_ros_does() -> None:
    assert dds_name("geometry_msgs/msg/Twist") == "geometry_msgs::msg::dds_::Twist_"
    assert dds_name("std_srvs/srv/Empty_Request") == "std_srvs::srv::dds_::Empty_Request_"
    assert message_class("nav_msgs/msg/Odometry").__idl_typename__ == "nav_msgs.msg.dds_.Odometry_"


def test_a_gid_is_as_long_as_the_distribution_has_it() -> None:
    name = "rmw_dds_common/msg/ParticipantEntitiesInfo"
    assert len(message_class(name, 24)().serialize()) - len(message_class(name, 16)().serialize()) == 8


def test_packed_numbers_are_where_a_reader_finds_them() -> None:
    name = "sensor_msgs/msg/JointState"
    packed = Packed(name, new(name, name=["left", "right_one"], position=[0.0, 0.0], velocity=[0.0, 0.0]))
    packed.slot("header.stamp", "iI").put(-5, 7)
    packed.slot("position", "2d").put(1.5, -2.5)
    packed.slot("velocity", "2d").put(3.0, 4.0)
    read = message_class(name).deserialize(packed.message.serialize())
    assert (read.header.stamp.sec, read.header.stamp.nanosec) == (-5, 7)
    assert (list(read.position), list(read.velocity), list(read.name)) == ([1.5, -2.5], [3.0, 4.0],
                                                                          ["left", "right_one"])


@pytest.mark.parametrize("name", MESSAGES)
def test_every_offset_leads_to_its_member(name: str) -> None:
    made = fill(name, iter(range(1, 10_000)))
    data = bytes(made.serialize(use_version_2=False))
    for path, offset in offsets_of(name, made).items():
        value = made
        for part in path.replace("]", "").replace("[", ".").split("."):
            value = value[int(part)] if part.isdigit() else getattr(value, part)
        if isinstance(value, float) and not path.endswith("]"):
            assert value in (numbers_at(data, offset, "d"), numbers_at(data, offset, "f")), path
        if isinstance(value, str):
            length = int(numbers_at(data, offset, "I"))
            assert data[offset + 4 : offset + 3 + length].decode() == value, path


def numbers_at(data: bytes, offset: int, form: str) -> float:
    import struct

    return struct.unpack_from(f"<{form}", data + bytes(8), offset)[0]


def test_each_type_is_defined_once() -> None:
    names = [line.partition(":")[0] for line in DEFINITIONS.strip().splitlines()]
    assert len(names) == len(set(names))


# ---- packets of services

DOMAIN = 91
WRITER, READER = b"\x00\x00\x01\x03", b"\x00\x00\x02\x04"
TYPE = "std_srvs::srv::dds_::Empty_"


class Client:
    """A participant that speaks to one other, by its metatraffic port."""

    def __init__(self, services: Services, vendor: bytes = OF_FAST):
        self.services, self.prefix = services, vendor + os.urandom(10)
        self.vendor = vendor
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", 0))
        self.socket.setblocking(False)
        self.port = self.socket.getsockname()[1]

    def send(self, *submessages: bytes) -> list[Submessage]:
        whole = bytearray(packet(self.prefix, b"", submessages))
        whole[6:8] = self.vendor
        return self.raw(bytes(whole))

    def raw(self, whole: bytes) -> list[Submessage]:
        """Sends bytes, lets the services work, and reads what they answer."""
        self.socket.sendto(whole, ("127.0.0.1", self.services._meta_port))
        self.services.poll()
        return self.heard()

    def heard(self) -> list[Submessage]:
        found: list[Submessage] = []
        while True:
            try:
                found += packets_of(self.socket.recv(65536))
            except BlockingIOError:
                return found

    def announced(self, status: int = 0, domain: int = DOMAIN) -> bytes:
        where = [(pid, locator("127.0.0.1", self.port)) for pid in (0x0032, 0x0031)]
        return data(bytes(4), SPDP, 1, parameters([(0x000F, struct.pack("<I", domain)), *where]), status=status)

    def join(self) -> list[Submessage]:
        """Announces itself, a request writer and a response reader."""
        found = self.send(self.announced())
        for builtin, entity, topic in ((PUBLICATIONS, WRITER, "rq/resetRequest"), (SUBSCRIPTIONS, READER,
                                                                                    "rr/resetReply")):
            content = parameters([(0x005A, self.prefix + entity), (0x0005, text_parameter(topic))])
            found += self.send(data(bytes(4), builtin, 1, content))
        return found

    def request(self, number: int, payload: bytes, reader: bytes = b"") -> bytes:
        """A request, which names the client's reader where it has one."""
        inline = identity_parameters(reader + bytes(8)) if reader else b""
        return data(bytes(4), WRITER, number, payload, inline=inline)


@pytest.fixture
def services() -> Iterator[Services]:
    made = Services(DOMAIN, is_local=True, now_s=lambda: 0.0)
    made.heard = []  # type: ignore[attr-defined]

    def answer(request: bytes, has_header: bool) -> bytes | None:
        made.heard.append((request, has_header))  # type: ignore[attr-defined]
        return b"\x00\x01\x00\x00" + request[::-1] if request[-1:] != b"?" else None

    made.serve(("rq/resetRequest", f"{TYPE}Request_", ""), ("rr/resetReply", f"{TYPE}Response_", ""), answer)
    yield made
    made.close()


def of_kind(found: list[Submessage], kind: int, writer: bytes = b"") -> list[Submessage]:
    return [each for each in found if each.kind == kind and (not writer or each.writer == writer)]


def response(found: list[Submessage], services: Services) -> list[Submessage]:
    return of_kind(found, DATA, services.servers[0].writer.entity)


def test_a_client_is_told_of_both_endpoints(services: Services) -> None:
    found = Client(services).join()
    for builtin, topic in ((PUBLICATIONS, b"rr/resetReply\0"), (SUBSCRIPTIONS, b"rq/resetRequest\0")):
        assert any(topic in each.payload for each in of_kind(found, DATA, builtin))


@pytest.mark.parametrize("has_reader", [True, False])
def test_a_response_names_client_and_request(services: Services, has_reader: bool) -> None:
    client = Client(services)
    client.join()
    reader = client.prefix + READER
    found = response(client.send(client.request(1, b"\x00\x01\x00\x00abcd", reader if has_reader else b"")), services)
    assert [each.payload[4:] for each in found] == [b"dcba\x00\x00\x01\x00"]
    guid = reader if has_reader else client.prefix + WRITER
    assert found[0].related == guid + struct.pack("<iI", 0, 1)


def test_a_request_that_comes_twice_is_answered_once(services: Services) -> None:
    client = Client(services)
    client.join()
    request = client.request(1, b"\x00\x01\x00\x00abcd")
    assert len(response(client.send(request, request), services)) == 1
    assert response(client.send(request), services) == []


def test_a_lost_response_comes_again_and_a_forgotten_one_is_given_up(services: Services) -> None:
    client = Client(services)
    client.join()
    writer = services.servers[0].writer.entity
    for number in range(1, MOST_KEPT + 3):
        client.send(client.request(number, b"\x00\x01\x00\x00abcd"))
    found = client.send(acknack(writer, READER, 2, [2, 5], 1))
    assert [each.first for each in response(found, services)] == [5]
    assert [(each.first, each.last) for each in of_kind(found, GAP)] == [(2, 3)]


def test_a_lost_request_is_asked_for(services: Services) -> None:
    client = Client(services)
    client.join()
    client.send(client.request(2, b"\x00\x01\x00\x00abcd"))
    found = of_kind(client.send(heartbeat(bytes(4), WRITER, 1, 3, 1)), ACKNACK)
    assert [(each.first, [*each.numbers]) for each in found] == [(1, [1, 3])]
    client.send(gap(bytes(4), WRITER, 1, 2), client.request(3, b"\x00\x01\x00\x00abcd"))
    found = of_kind(client.send(heartbeat(bytes(4), WRITER, 1, 3, 2)), ACKNACK)
    assert [(each.first, [*each.numbers]) for each in found] == [(4, [])]


def test_a_request_of_cyclonedds_is_known_by_its_vendor(services: Services) -> None:
    client = Client(services, OF_CYCLONE)
    client.join()
    assert len(response(client.send(client.request(1, b"\x00\x01\x00\x00abcd")), services)) == 1
    assert services.heard == [(b"\x00\x01\x00\x00abcd", True)]  # type: ignore[attr-defined]


def test_requests_of_strangers_are_not_heard(services: Services) -> None:
    stranger = Client(services)
    assert stranger.send(stranger.request(1, b"\x00\x01\x00\x00abcd")) == []
    assert services.heard == []  # type: ignore[attr-defined]


def test_a_request_that_cannot_be_read_is_not_answered(services: Services) -> None:
    client = Client(services)
    client.join()
    assert response(client.send(client.request(1, b"\x00\x01\x00\x00abc?")), services) == []
    assert len(response(client.send(client.request(2, b"\x00\x01\x00\x00abcd")), services)) == 1


def test_a_client_that_leaves_or_falls_silent_is_forgotten(services: Services) -> None:
    client = Client(services)
    client.join()
    assert client.prefix in services.peers
    client.send(client.announced(status=3))
    assert services.peers == {} and services.servers[0].writer.readers == {}
    client.join()
    services._now_s = lambda: 1000.0
    services.poll()
    assert services.peers == {}


def test_participants_of_another_domain_are_left_out(services: Services) -> None:
    client = Client(services)
    client.send(client.announced(domain=DOMAIN + 1))
    assert services.peers == {}


def test_two_programs_find_ports_side_by_side(services: Services) -> None:
    other = Services(DOMAIN, is_local=True)
    assert other._meta_port == services._meta_port + PORTS.participant
    other.poll()
    services.poll()
    assert other.prefix in services.peers
    other.close()
    services.poll()
    assert services.peers == {}


def test_bytes_that_are_not_rtps_or_half_of_it_end_nothing(services: Services) -> None:
    rng, client = random.Random(39), Client(services)
    client.join()
    good: list[Any] = [client.announced(), client.request(7, b"\x00\x01\x00\x00abcd", client.prefix + READER),
                       heartbeat(bytes(4), WRITER, 1, 1 << 40, 1), acknack(WRITER, READER, 1, [1, 200], 1),
                       gap(bytes(4), WRITER, 1, 1 << 60)]
    good.append(data(bytes(4), SUBSCRIPTIONS, 2, parameters([(0x005A, os.urandom(16)), (0x0005, text_parameter(
        "rr/resetReply"))])))
    for _ in range(3000):
        whole = bytearray(packet(client.prefix, b"", rng.sample(good, rng.randint(1, 4))))
        for _ in range(rng.randint(0, 6)):
            whole[rng.randrange(len(whole))] = rng.randrange(256)
        client.raw(bytes(whole[: rng.randint(0, len(whole))] if rng.random() < 0.3 else whole))
    again = Client(services)
    again.join()
    assert len(response(again.send(again.request(1, b"\x00\x01\x00\x00abcd")), services)) == 1
