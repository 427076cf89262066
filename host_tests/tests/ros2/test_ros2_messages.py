"""Types on the wire: hashes against rosbags' definitions, CDR against rosbags' reader, offsets of packed messages."""

from __future__ import annotations

import pytest
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from laconic.ros2.messages import DEFINITIONS, Packed, dds_name, definitions, message_class, new, offsets_of, type_hash

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
