"""Small recordings of a robot with two wheels, as other programs write them."""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_typestore

RADIUS_M, HALF_TRACK_M = 0.033, 0.08
START_NS = 1_700_000_000_000_000_000
SCENE = """name = "two wheels"
[vehicle]
mass_kg = 2.0
yaw_inertia_kgm2 = 0.02
wheel_radius_m = 0.033
wheel_inertia_kgm2 = 1e-4
motor_gain_Nm_per_V = 0.05
motor_damping_Nms = 0.005
[[vehicle.wheel]]
kind = "fixed"
x_m = 0.0
y_m = 0.08
axle_deg = -90.0
[[vehicle.wheel]]
kind = "fixed"
x_m = 0.0
y_m = -0.08
axle_deg = -90.0
[run]
duration_s = 4.0
step_s = 0.01
method = "auto"
"""


def scene_of(folder: Path, old: str = "", new: str = "") -> Path:
    """The robot as a scene."""
    path = folder / "robot.toml"
    path.write_text(SCENE.replace(old, new) if old else SCENE)
    return path


def wheels_at(time_s: float) -> tuple[float, float]:
    """Angles of the left and the right wheel."""
    return 6.0 * time_s, 9.0 * time_s


def pose_at(time_s: float) -> tuple[float, float, float]:
    """On a circle, as wheels of these angles roll without slip."""
    left, right = (RADIUS_M * angle for angle in wheels_at(time_s))
    heading, way = (right - left) / (2.0 * HALF_TRACK_M), 0.5 * (left + right)
    radius = way / heading if heading else 0.0
    return radius * math.sin(heading), radius * (1.0 - math.cos(heading)), heading


class Messages:
    """Messages of the usual types, for ROS 1 or ROS 2."""

    def __init__(self, is_ros1: bool = False):
        self.store = get_typestore(Stores.ROS1_NOETIC if is_ros1 else Stores.ROS2_JAZZY)
        self.is_ros1, self.types = is_ros1, self.store.types

    def header(self, stamp_ns: int, frame: str = "") -> Any:
        stamp = self.types["builtin_interfaces/msg/Time"](stamp_ns // 10**9, stamp_ns % 10**9)
        more = {"seq": 0} if self.is_ros1 else {}
        return self.types["std_msgs/msg/Header"](stamp=stamp, frame_id=frame, **more)

    def joints(self, stamp_ns: int, names: Sequence[str], angles: Sequence[float]) -> Any:
        return self.types["sensor_msgs/msg/JointState"](
            self.header(stamp_ns), list(names), np.array(angles, float), np.zeros(0), np.zeros(0))

    def quaternion(self, heading: float) -> Any:
        return self.types["geometry_msgs/msg/Quaternion"](0.0, 0.0, math.sin(heading / 2), math.cos(heading / 2))

    def pose(self, stamp_ns: int, x: float, y: float, heading: float) -> Any:
        point = self.types["geometry_msgs/msg/Point"](x, y, 0.0)
        return self.types["geometry_msgs/msg/PoseStamped"](
            self.header(stamp_ns, "map"), self.types["geometry_msgs/msg/Pose"](point, self.quaternion(heading)))

    def transform(self, stamp_ns: int, parent: str, child: str, x: float, y: float, heading: float) -> Any:
        return self.types["tf2_msgs/msg/TFMessage"]([self.types["geometry_msgs/msg/TransformStamped"](
            self.header(stamp_ns, parent), child, self.types["geometry_msgs/msg/Transform"](
                self.types["geometry_msgs/msg/Vector3"](x, y, 0.0), self.quaternion(heading)))])

    def fix(self, stamp_ns: int, latitude: float, longitude: float) -> Any:
        status = self.types["sensor_msgs/msg/NavSatStatus"](0, 1)
        return self.types["sensor_msgs/msg/NavSatFix"](self.header(stamp_ns), status, latitude, longitude, 0.0,
                                                       np.zeros(9), 0)

    def image(self, stamp_ns: int, size: int) -> Any:
        return self.types["sensor_msgs/msg/CompressedImage"](self.header(stamp_ns), "jpeg", np.zeros(size, np.uint8))


Row = tuple[int, str, str, Any]
"""Instant of arrival, topic, type, message."""


def drive(messages: Messages, *, late_ns: int = 0, names: Sequence[str] = ("left_wheel", "right_wheel"),
          truth: Callable[..., list[Row]] | None = None, seconds: float = 4.0) -> list[Row]:
    """Joints at 50 Hz, the true pose at 31 Hz, which arrives later than its stamps say."""
    rows: list[Row] = []
    for k in range(round(50 * seconds)):
        stamp = START_NS + 20_000_000 * k
        rows.append((stamp, "/joint_states", "sensor_msgs/msg/JointState",
                     messages.joints(stamp, names, wheels_at(0.02 * k))))
    for k in range(round(31 * seconds)):
        stamp = START_NS + round(1e9 * k / 31)
        time_s = (stamp - START_NS) / 1e9
        rows += truth(stamp, time_s) if truth else [
            (stamp + late_ns, "/mocap/pose", "geometry_msgs/msg/PoseStamped", messages.pose(stamp, *pose_at(time_s)))]
    return sorted(rows, key=lambda row: row[0])


def rosbag1(path: Path, rows: Sequence[Row], messages: Messages) -> Path:
    """As ROS 1 records it."""
    with Writer1(path) as bag:
        connections: dict[str, Any] = {}
        for stamp, topic, kind, message in rows:
            if topic not in connections:
                connections[topic] = bag.add_connection(topic, kind, typestore=messages.store)
            bag.write(connections[topic], stamp, messages.store.serialize_ros1(message, kind))
    return path


def rosbag2(path: Path, rows: Sequence[Row], messages: Messages,
            storage: StoragePlugin = StoragePlugin.SQLITE3) -> Path:
    """As ROS 2 records it."""
    with Writer2(path, version=9, storage_plugin=storage) as bag:
        connections: dict[str, Any] = {}
        for stamp, topic, kind, message in rows:
            if topic not in connections:
                connections[topic] = bag.add_connection(topic, kind, typestore=messages.store)
            bag.write(connections[topic], stamp, messages.store.serialize_cdr(message, kind))
    return path


def ulog(path: Path, topics: dict[str, tuple[Sequence[str], np.ndarray]]) -> Path:
    """A ULog: the first column of each topic is its time in seconds, all others are floats of 64 bits."""
    def record(kind: bytes, body: bytes) -> bytes:
        return struct.pack("<HB", len(body), kind[0]) + body

    data = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0)
    body = b""
    for key, (name, (fields, table)) in enumerate(topics.items()):
        text = f"{name}:uint64_t timestamp;{''.join(f'double {field};' for field in fields)}"
        data += record(b"F", text.encode())
        body += record(b"A", struct.pack("<BH", 0, key) + name.encode())
        for row in table:
            body += record(b"D", struct.pack(f"<HQ{len(fields)}d", key, round(1e6 * row[0]) + 1, *row[1:]))
    path.write_bytes(data + body)
    return path
