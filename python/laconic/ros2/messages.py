"""The ROS 2 types that a robot needs: their fields, their classes for cyclonedds, their hashes, their places in CDR.

A type is written once, in DEFINITIONS. Its class, its hash and the offsets of its numbers follow from there. On the
wire all of them are XCDR1, little endian, of final extensibility.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import re
import struct
from dataclasses import dataclass
from functools import cache
from types import new_class
from typing import Any, ClassVar

try:
    from cyclonedds.idl import IdlStruct
    from cyclonedds.idl import types as idl_types
    from cyclonedds.idl._support import Buffer
    from cyclonedds.idl.annotations import final
    HAS_IDL = True
except ImportError:  # Zenoh needs none
    HAS_IDL = False

MOST_PADDING = 8  # bytes behind a message, by which some middlewares fill it up
DEFINITIONS = """
builtin_interfaces/msg/Time: int32 sec, uint32 nanosec
std_msgs/msg/Header: builtin_interfaces/msg/Time stamp, string frame_id
std_msgs/msg/String: string data
geometry_msgs/msg/Vector3: float64 x, float64 y, float64 z
geometry_msgs/msg/Point: float64 x, float64 y, float64 z
geometry_msgs/msg/Quaternion: float64 x, float64 y, float64 z, float64 w
geometry_msgs/msg/Pose: geometry_msgs/msg/Point position, geometry_msgs/msg/Quaternion orientation
geometry_msgs/msg/PoseWithCovariance: geometry_msgs/msg/Pose pose, float64[36] covariance
geometry_msgs/msg/PoseWithCovarianceStamped: std_msgs/msg/Header header, geometry_msgs/msg/PoseWithCovariance pose
geometry_msgs/msg/Twist: geometry_msgs/msg/Vector3 linear, geometry_msgs/msg/Vector3 angular
geometry_msgs/msg/TwistStamped: std_msgs/msg/Header header, geometry_msgs/msg/Twist twist
geometry_msgs/msg/TwistWithCovariance: geometry_msgs/msg/Twist twist, float64[36] covariance
geometry_msgs/msg/Transform: geometry_msgs/msg/Vector3 translation, geometry_msgs/msg/Quaternion rotation
geometry_msgs/msg/TransformStamped: std_msgs/msg/Header header, string child_frame_id, \
geometry_msgs/msg/Transform transform
ackermann_msgs/msg/AckermannDrive: float32 steering_angle, float32 steering_angle_velocity, float32 speed, \
float32 acceleration, float32 jerk
ackermann_msgs/msg/AckermannDriveStamped: std_msgs/msg/Header header, ackermann_msgs/msg/AckermannDrive drive
tf2_msgs/msg/TFMessage: geometry_msgs/msg/TransformStamped[] transforms
nav_msgs/msg/Odometry: std_msgs/msg/Header header, string child_frame_id, \
geometry_msgs/msg/PoseWithCovariance pose, geometry_msgs/msg/TwistWithCovariance twist
nav_msgs/msg/MapMetaData: builtin_interfaces/msg/Time map_load_time, float32 resolution, uint32 width, \
uint32 height, geometry_msgs/msg/Pose origin
nav_msgs/msg/OccupancyGrid: std_msgs/msg/Header header, nav_msgs/msg/MapMetaData info, int8[] data
sensor_msgs/msg/JointState: std_msgs/msg/Header header, string[] name, float64[] position, float64[] velocity, \
float64[] effort
sensor_msgs/msg/Imu: std_msgs/msg/Header header, geometry_msgs/msg/Quaternion orientation, \
float64[9] orientation_covariance, geometry_msgs/msg/Vector3 angular_velocity, \
float64[9] angular_velocity_covariance, geometry_msgs/msg/Vector3 linear_acceleration, \
float64[9] linear_acceleration_covariance
sensor_msgs/msg/LaserScan: std_msgs/msg/Header header, float32 angle_min, float32 angle_max, \
float32 angle_increment, float32 time_increment, float32 scan_time, float32 range_min, float32 range_max, \
float32[] ranges, float32[] intensities
sensor_msgs/msg/BatteryState: std_msgs/msg/Header header, float32 voltage, float32 temperature, float32 current, \
float32 charge, float32 capacity, float32 design_capacity, float32 percentage, uint8 power_supply_status, \
uint8 power_supply_health, uint8 power_supply_technology, bool present, float32[] cell_voltage, \
float32[] cell_temperature, string location, string serial_number
rosgraph_msgs/msg/Clock: builtin_interfaces/msg/Time clock
diagnostic_msgs/msg/KeyValue: string key, string value
diagnostic_msgs/msg/DiagnosticStatus: byte level, string name, string message, string hardware_id, \
diagnostic_msgs/msg/KeyValue[] values
diagnostic_msgs/msg/DiagnosticArray: std_msgs/msg/Header header, diagnostic_msgs/msg/DiagnosticStatus[] status
rcl_interfaces/msg/ParameterValue: uint8 type, bool bool_value, int64 integer_value, float64 double_value, \
string string_value, byte[] byte_array_value, bool[] bool_array_value, int64[] integer_array_value, \
float64[] double_array_value, string[] string_array_value
rcl_interfaces/msg/Parameter: string name, rcl_interfaces/msg/ParameterValue value
rcl_interfaces/msg/FloatingPointRange: float64 from_value, float64 to_value, float64 step
rcl_interfaces/msg/IntegerRange: int64 from_value, int64 to_value, uint64 step
rcl_interfaces/msg/ParameterDescriptor: string name, uint8 type, string description, \
string additional_constraints, bool read_only, bool dynamic_typing, \
rcl_interfaces/msg/FloatingPointRange[<=1] floating_point_range, rcl_interfaces/msg/IntegerRange[<=1] integer_range
rcl_interfaces/msg/ListParametersResult: string[] names, string[] prefixes
rcl_interfaces/msg/SetParametersResult: bool successful, string reason
rcl_interfaces/srv/GetParameters_Request: string[] names
rcl_interfaces/srv/GetParameters_Response: rcl_interfaces/msg/ParameterValue[] values
rcl_interfaces/srv/GetParameterTypes_Request: string[] names
rcl_interfaces/srv/GetParameterTypes_Response: uint8[] types
rcl_interfaces/srv/DescribeParameters_Request: string[] names
rcl_interfaces/srv/DescribeParameters_Response: rcl_interfaces/msg/ParameterDescriptor[] descriptors
rcl_interfaces/srv/ListParameters_Request: string[] prefixes, uint64 depth
rcl_interfaces/srv/ListParameters_Response: rcl_interfaces/msg/ListParametersResult result
rcl_interfaces/srv/SetParameters_Request: rcl_interfaces/msg/Parameter[] parameters
rcl_interfaces/srv/SetParameters_Response: rcl_interfaces/msg/SetParametersResult[] results
rcl_interfaces/srv/SetParametersAtomically_Request: rcl_interfaces/msg/Parameter[] parameters
rcl_interfaces/srv/SetParametersAtomically_Response: rcl_interfaces/msg/SetParametersResult result
std_srvs/srv/Empty_Request: uint8 structure_needs_at_least_one_member
std_srvs/srv/Empty_Response: uint8 structure_needs_at_least_one_member
robot_localization/srv/SetPose_Request: geometry_msgs/msg/PoseWithCovarianceStamped pose
robot_localization/srv/SetPose_Response: uint8 structure_needs_at_least_one_member
rmw_dds_common/msg/NodeEntitiesInfo: string<=256 node_namespace, string<=256 node_name, \
rmw_dds_common/msg/Gid[] reader_gid_seq, rmw_dds_common/msg/Gid[] writer_gid_seq
rmw_dds_common/msg/ParticipantEntitiesInfo: rmw_dds_common/msg/Gid gid, \
rmw_dds_common/msg/NodeEntitiesInfo[] node_entities_info_seq
"""

GID = "rmw_dds_common/msg/Gid"
GID_FIELDS = {16: "uint8[16] data", 24: "uint8[24] data"}
"""Of a Gid: 24 bytes up to Humble, 16 since Iron. Its .msg file has char, which is uint8 in IDL and in a hash."""

FIELD_TYPES = {"int8": 2, "uint8": 3, "int16": 4, "uint16": 5, "int32": 6, "uint32": 7, "int64": 8, "uint64": 9,
               "float32": 10, "float64": 11, "bool": 15, "byte": 16, "string": 17}
"""Numbers of basic types in a type description (REP 2011)."""
NESTED, BOUNDED_STRING = 1, 21
ARRAY, BOUNDED, UNBOUNDED = 48, 96, 144  # added to the number of an item's type

FORMATS = {"int8": "b", "uint8": "B", "byte": "B", "bool": "?", "int16": "h", "uint16": "H", "int32": "i",
           "uint32": "I", "int64": "q", "uint64": "Q", "float32": "f", "float64": "d"}
MOST_ITEMS = 1 << 24  # of one sequence: no robot has more, and broken lengths end here
CDR_LITTLE = b"\x00\x01\x00\x00"  # XCDR1, little endian
CDR_HEADER = 4  # bytes before the first member, which alignment does not count
IS_UNIT = {"geometry_msgs/msg/Quaternion": {"w": 1.0}}
HEADER_OF_REQUEST = "uint64 client, int64 sequence"
"""What rmw_cyclonedds puts before a request and before its response; it is not part of the type and its hash."""


@dataclass(frozen=True)
class FieldType:
    """The type of one field: an item's type, and how many of them there are."""

    item: str                 # a basic type, or the name of a nested one
    bound: int = 0            # of a string's length
    many: int = 0             # ARRAY, BOUNDED, UNBOUNDED; 0: a single one
    count: int = 0            # items of an array, at most items of a bounded sequence

    @property
    def is_sequence(self) -> bool:
        """Whether their number is written before them."""
        return self.many in (BOUNDED, UNBOUNDED)

    @property
    def is_nested(self) -> bool:
        """Whether the item has fields of its own."""
        return "/" in self.item


FIELD = re.compile(r"(?P<item>[\w/]+)(<=(?P<bound>\d+))?(?P<many>\[(?P<most><=)?(?P<count>\d*)\])? (?P<name>\w+)")
Fields = tuple[tuple[str, FieldType], ...]


def fields_of(text: str) -> Fields:
    """The fields of one definition."""
    found = []
    for each in text.split(","):
        part = FIELD.fullmatch(each.strip())
        assert part is not None, each
        many = 0 if not part["many"] else BOUNDED if part["most"] else ARRAY if part["count"] else UNBOUNDED
        found.append((part["name"], FieldType(part["item"], int(part["bound"] or 0), many, int(part["count"] or 0))))
    return tuple(found)


@cache
def definitions(gid_bytes: int) -> dict[str, Fields]:
    """Every type by its name, with the Gid of a distribution."""
    named = (line.split(": ", 1) for line in DEFINITIONS.strip().splitlines())
    return {name: fields_of(text) for name, text in named} | {GID: fields_of(GID_FIELDS[gid_bytes])}


# ---- classes

def dds_name(name: str) -> str:
    """The type's name on the wire: geometry_msgs::msg::dds_::Twist_."""
    package, kind, last = name.split("/")
    return f"{package}::{kind}::dds_::{last}_"


def message_class(name: str, gid_bytes: int = 16, with_header: bool = False) -> Any:
    """The class of a type, whose instances are zero, empty or without rotation; `with_header`: of a service."""
    return _made(name, gid_bytes if name.startswith("rmw_dds_common/") else 16, with_header)


@cache
def _made(name: str, gid_bytes: int, with_header: bool) -> Any:
    if not HAS_IDL:
        return plain_class(name, gid_bytes)
    fields = (fields_of(HEADER_OF_REQUEST) if with_header else ()) + definitions(gid_bytes)[name]
    unit, body = IS_UNIT.get(name, {}), {}
    annotations = {}
    for field, kind in fields:
        annotations[field] = _idl_type(kind, gid_bytes)
        body[field] = dataclasses.field(default_factory=_fresh(kind, gid_bytes, unit.get(field)))
    body["__annotations__"] = annotations
    short = name.rpartition("/")[2]
    typename = dds_name(name).replace("::", ".")
    made = new_class(short, (IdlStruct,), {"typename": typename}, lambda space: space.update(body))
    made.__module__ = __name__
    made = final(dataclass(made))
    made.__idl__.populate()  # type: ignore[attr-defined]
    made.deserialize = classmethod(_whole)  # type: ignore[attr-defined]
    return made


def _whole(cls: Any, data: Any, *words: Any, **more: Any) -> Any:
    """A message of these bytes; ValueError where bytes are left over, as after a type with more fields."""
    if isinstance(data, Buffer):
        return cls.__idl__.deserialize(data, *words, **more)
    buffer = Buffer(data, align_offset=4)
    found = cls.__idl__.deserialize(buffer, *words, **more)
    if len(data) - buffer.tell() >= MOST_PADDING:
        raise ValueError("bytes are left over")
    return found


@cache
def plain_class(name: str, gid_bytes: int = 16) -> Any:
    """The same class without cyclonedds."""
    body: dict[str, Any] = {"__annotations__": {}, "_fields": definitions(gid_bytes)[name], "_items": {}}
    for field, kind in body["_fields"]:
        item: Any = plain_class(kind.item, gid_bytes) if kind.is_nested else None
        body["__annotations__"][field], body["_items"][field] = Any, item
        fresh = item if kind.is_nested and not kind.many else _fresh(kind, gid_bytes, IS_UNIT.get(name, {}).get(field))
        body[field] = dataclasses.field(default_factory=fresh)
    made = new_class(name.rpartition("/")[2], (Plain,), {}, lambda space: space.update(body))
    return dataclass(made)


def _idl_type(kind: FieldType, gid_bytes: int) -> Any:
    idl: Any = idl_types
    plain = {"byte": idl.uint8, "bool": bool, "string": str}
    item = message_class(kind.item, gid_bytes) if kind.is_nested else plain.get(kind.item) or getattr(idl, kind.item)
    if kind.bound:
        item = idl.bounded_str[kind.bound]
    if kind.many == ARRAY:
        return idl.array[item, kind.count]
    if kind.many:
        return idl.sequence[item, kind.count] if kind.count else idl.sequence[item]
    return item


def _fresh(kind: FieldType, gid_bytes: int, unit: float | None) -> Any:
    """What makes the usual value of a field."""
    if kind.many == ARRAY:
        item = 0.0 if kind.item.startswith("float") else 0
        return lambda: [item] * kind.count
    if kind.many:
        return list
    if kind.is_nested:
        return message_class(kind.item, gid_bytes)
    usual = {"string": "", "bool": False}.get(kind.item, 0.0 if kind.item.startswith("float") else 0)
    return lambda: usual if unit is None else unit


def new(kind: str, /, **values: Any) -> Any:
    """A message; what is not given is zero or empty."""
    return message_class(kind)(**values)


# ---- messages without cyclonedds, which Zenoh does not need

class Plain:
    """A message that writes and reads itself."""

    __idl__: ClassVar[Any] = None
    _fields: ClassVar[Any]
    sample_info: Any

    def serialize(self, use_version_2: bool = False) -> bytes:
        """With its header."""
        out = bytearray()
        _write(self, out)
        return CDR_LITTLE + bytes(out)

    @classmethod
    def deserialize(cls, data: bytes, has_header: bool = True) -> Any:
        """A message of bytes; ValueError for what is not one of this type."""
        start = CDR_HEADER if has_header else 0
        order = "<" if not has_header or data[1:2] == b"\x01" else ">"
        try:
            source = Source(bytes(data[start:]), order)
            found = _read(cls, source)
        except (struct.error, UnicodeDecodeError, IndexError) as error:
            raise ValueError(f"these bytes are no {cls.__name__}") from error
        if len(source.data) - source.at >= MOST_PADDING:
            raise ValueError("bytes are left over")
        return found


class Source:
    """Bytes that are read one after the other."""

    def __init__(self, data: bytes, order: str):
        self.data, self.order, self.at = data, order, 0

    def numbers(self, item: str, count: int) -> tuple[Any, ...]:
        """Numbers of one kind, aligned to their size."""
        form = FORMATS[item]
        size = struct.calcsize(form)
        self.at += -self.at % size
        if count > MOST_ITEMS or self.at + count * size > len(self.data):
            raise struct.error("the bytes end")
        found = struct.unpack_from(f"{self.order}{count}{form}", self.data, self.at)
        self.at += count * size
        return found

    def text(self) -> str:
        """A string."""
        length = self.numbers("uint32", 1)[0]
        if not 0 < length <= len(self.data) - self.at:
            raise struct.error("a text ends beyond the bytes")
        self.at += length
        return self.data[self.at - length : self.at - 1].decode()


def _write(message: Any, out: bytearray) -> None:
    for name, kind in message._fields:
        value = getattr(message, name)
        if not kind.many:
            _write_items(kind, [value], out)
            continue
        if kind.is_sequence:
            _pad(out, 4)
            out += struct.pack("<I", len(value))
        _write_items(kind, value, out)


def _write_items(kind: FieldType, items: Any, out: bytearray) -> None:
    if kind.is_nested:
        for each in items:
            _write(each, out)
    elif kind.item == "string":
        for each in items:
            data = each.encode() + b"\0"
            _pad(out, 4)
            out += struct.pack("<I", len(data)) + data
    elif len(items):
        form = FORMATS[kind.item]
        _pad(out, struct.calcsize(form))
        out += struct.pack(f"<{len(items)}{form}", *items)


def _pad(out: bytearray, size: int) -> None:
    out += bytes(-len(out) % size)


def _read(cls: Any, source: Source) -> Any:
    made = cls()
    for name, kind in cls._fields:
        if not kind.many:
            setattr(made, name, _read_items(kind, source, 1, getattr(made, name).__class__)[0])
            continue
        count = source.numbers("uint32", 1)[0] if kind.is_sequence else kind.count
        if kind.is_sequence and (count > MOST_ITEMS or (kind.count and count > kind.count) or count > len(source.data)):
            raise struct.error("a sequence is too long")
        setattr(made, name, _read_items(kind, source, count, cls._items[name]))
    return made


def _read_items(kind: FieldType, source: Source, count: int, item: Any) -> list[Any]:
    if kind.is_nested:
        return [_read(item, source) for _ in range(count)]
    if kind.item == "string":
        return [source.text() for _ in range(count)]
    return [*source.numbers(kind.item, count)]


# ---- hashes

@cache
def type_hash(name: str, gid_bytes: int = 16) -> str:
    """RIHS01: SHA-256 of the type's description as JSON, with those of all types in it (REP 2011)."""
    known = definitions(gid_bytes)
    if "/srv/" in name and name not in known:
        known = known | service_definitions(name)
    inner: set[str] = set()
    _collect(name, known, inner)
    text = json.dumps({"type_description": _described(name, known),
                       "referenced_type_descriptions": [_described(each, known) for each in sorted(inner)]})
    return f"RIHS01_{hashlib.sha256(text.encode()).hexdigest()}"


def service_definitions(name: str) -> dict[str, Fields]:
    """A service as a type: request, response, and the event that introspection makes of a call (REP 2011)."""
    request, response, event = (f"{name}_{part}" for part in ("Request", "Response", "Event"))
    return {name: fields_of(f"{request} request_message, {response} response_message, {event} event_message"),
            event: fields_of(f"service_msgs/msg/ServiceEventInfo info, {request}[<=1] request, "
                             f"{response}[<=1] response"),
            "service_msgs/msg/ServiceEventInfo": fields_of(
                "uint8 event_type, builtin_interfaces/msg/Time stamp, uint8[16] client_gid, int64 sequence_number")}


def _collect(name: str, known: dict[str, Fields], found: set[str]) -> None:
    for _, kind in known[name]:
        if kind.is_nested and kind.item not in found:
            found.add(kind.item)
            _collect(kind.item, known, found)


def _described(name: str, known: dict[str, Fields]) -> dict[str, Any]:
    return {"type_name": name, "fields": [{"name": field, "type": _numbered(kind)} for field, kind in known[name]]}


def _numbered(kind: FieldType) -> dict[str, Any]:
    number = NESTED if kind.is_nested else BOUNDED_STRING if kind.bound else FIELD_TYPES[kind.item]
    return {"type_id": number + kind.many, "capacity": kind.count, "string_capacity": kind.bound,
            "nested_type_name": kind.item if kind.is_nested else ""}


# ---- messages that are written a thousand times a second

class Packed:
    """A message whose texts and lengths stay: serialized once, then its numbers are put at their places.

    `message` goes to a DataWriter, which takes its bytes from here.
    """

    def __init__(self, name: str, message: Any):
        self.message = message
        self.data = bytearray(message.serialize(use_version_2=False))
        self.data.extend(bytes(-len(self.data) % 4))
        self.offsets = offsets_of(name, message)
        message.serialize = self._serialize

    def _serialize(self, *_: Any, **__: Any) -> bytes:
        return bytes(self.data)

    def slot(self, path: str, form: str) -> Slot:
        """The place of numbers in a row that begins with a member: slot("pose.pose.position", "3d")."""
        return Slot(self.data, self.offsets[path], struct.Struct(f"<{form}"))


class Slot:
    """Numbers at one place of a packed message."""

    def __init__(self, data: bytearray, offset: int, form: struct.Struct):
        self._data, self._offset, self._pack = data, offset, form.pack_into

    def put(self, *values: float) -> None:
        """Writes all numbers of the row."""
        self._pack(self._data, self._offset, *values)


def offsets_of(name: str, message: Any) -> dict[str, int]:
    """Where each member of a message begins in its CDR, by path: {"header.stamp.sec": 4, …}; items count from 0."""
    found: dict[str, int] = {}
    _walk(name, message, "", 0, found)
    return {path: CDR_HEADER + offset for path, offset in found.items()}


def _walk(name: str, message: Any, path: str, at: int, found: dict[str, int]) -> int:
    for field, kind in definitions(16)[name]:
        value, here = getattr(message, field), f"{path}{field}"
        if kind.many in (BOUNDED, UNBOUNDED):
            at = _aligned(at, 4) + 4
        items = list(value) if kind.many else [value]
        for number, item in enumerate(items):
            each = f"{here}[{number}]" if kind.many else here
            at = _item(kind, item, each, at, found)
        if kind.many and items:
            found[here] = found[f"{here}[0]"]
    return at


def _item(kind: FieldType, item: Any, path: str, at: int, found: dict[str, int]) -> int:
    """Enters one item and returns where it ends."""
    if kind.is_nested:
        end = _walk(kind.item, item, f"{path}.", at, found)
        first = next(name for name in found if name.startswith(f"{path}."))
        found[path] = found[first]
        return end
    if kind.item == "string":
        found[path] = _aligned(at, 4)
        return found[path] + 4 + len(item.encode()) + 1
    size = struct.calcsize(FORMATS[kind.item])
    found[path] = _aligned(at, size)
    return found[path] + size


def _aligned(at: int, size: int) -> int:
    return (at + size - 1) // size * size
