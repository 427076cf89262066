"""A run as topics, named as `laconic ros2` names them: what the wheels tell (/odom, /tf), the motion itself
(/ground_truth/odom), joints, gyro and voltages."""

from __future__ import annotations

import math
import sqlite3
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from laconic.base.outputs import claims, make_folder
from laconic.errors import BadInput, reason_of
from laconic.robot.bags.messages import store
from laconic.robot.logs.for_vehicle import carriage_alone, wheels_on_carriage
from laconic.robot.replay.rolling import Rolling, centre_of_mass, path_of, rolling_of
from laconic.ros2 import FRAMES
from laconic.scene import Scene
from laconic.scene.base import joint_names

COMMITTED_AT_ONCE = 2000       # messages
BYTES_OF_CHUNK = 1 << 18
DISTRIBUTION = "jazzy"
TABLES = """
CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);
CREATE TABLE metadata(id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL, metadata TEXT NOT NULL);
CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT NOT NULL,
    offered_qos_profiles TEXT NOT NULL, type_description_hash TEXT NOT NULL);
CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, encoding TEXT NOT NULL,
    encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL);
CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL,
    data BLOB NOT NULL);
CREATE INDEX timestamp_idx ON messages (timestamp ASC);
"""


def definition_of(kind: str) -> tuple[str, str]:
    """(text of the definition of a type and all that is in it, hash of the type)."""
    return store().generate_msgdef(kind, ros_version=2)[0], store().hash_rihs01(kind)


class BagWriter(Protocol):
    """An open recording."""

    path: Path

    def write(self, topic: str, kind: str, stamp_ns: int, message: Any) -> None:
        """A message of a topic, whose type is stated with its first one."""
        ...

    def close(self) -> None:
        """Completes the files."""
        ...


OF_OTHERS = (".bag", ".db3", ".ulg", ".ulog", ".zstd", ".mf4", ".csv", ".txt", ".json", ".yaml", ".mat", ".rrd", ".blf",
             ".asc", ".log", ".zip", ".gz", ".h5")
"""Endings of files: a folder with such a name would be taken for one."""


def check_bag(option: str, path: Path) -> None:
    """BadInput for a name of a file that is not written, and for a folder that holds something already; files are
    checked as all outputs are."""
    if path.name.lower().endswith(OF_OTHERS) and not path.is_dir():
        raise BadInput(f"{option} {path}: {path.suffix} is not written; choose NAME.mcap for one file, or a name "
                       "without an ending for the folder of a rosbag2")
    if path.suffix.lower() != ".mcap" and path.is_dir() and any(path.iterdir()):
        raise BadInput(f"{option} {path}: is a folder that holds files already; choose a new folder, or a name that "
                       "ends in .mcap")


@contextmanager
def open_bag(path: Path, storage: str | None = None) -> Iterator[BagWriter]:
    """A new recording by its name; it is completed whatever happens on the way. `storage` of a folder: sqlite3 (without
    it) or mcap."""
    check_bag("--bag", path)
    claims().write(path)
    try:
        make_folder(path.parent if path.suffix.lower() == ".mcap" else path)
        writer: BagWriter = McapBag(path) if path.suffix.lower() == ".mcap" else \
            McapFolder(path) if storage == "mcap" else Rosbag2(path)
        try:
            yield writer
        finally:
            writer.close()
    except (OSError, sqlite3.Error) as error:
        raise _refused(path, error) from None


def _refused(path: Path, error: OSError | sqlite3.Error) -> BadInput:
    reason = reason_of(error) if isinstance(error, OSError) else str(error)
    return BadInput(f"--bag {path}: cannot be written ({reason}); choose another path")


class McapBag:
    """One MCAP with the profile of ROS 2."""

    def __init__(self, path: Path):
        from mcap.writer import CompressionType, Writer

        self.path = path
        self._file = path.open("wb")
        self._writer = Writer(self._file, chunk_size=BYTES_OF_CHUNK, compression=CompressionType.ZSTD)
        self._writer.start(profile="ros2", library="laconic")
        self._schemas: dict[str, int] = {}
        self._channels: dict[str, int] = {}

    def write(self, topic: str, kind: str, stamp_ns: int, message: Any) -> None:
        """A message of a topic."""
        if topic not in self._channels:
            if kind not in self._schemas:
                text, _ = definition_of(kind)
                self._schemas[kind] = self._writer.register_schema(kind, "ros2msg", text.encode())
            self._channels[topic] = self._writer.register_channel(topic, "cdr", self._schemas[kind],
                                                                  {"offered_qos_profiles": ""})
        self._writer.add_message(self._channels[topic], stamp_ns, bytes(store().serialize_cdr(message, kind)), stamp_ns)

    def close(self) -> None:
        """Writes the index and closes the file."""
        try:
            self._writer.finish()  # type: ignore[no-untyped-call]
        finally:
            self._file.close()


@dataclass
class Metadata:
    """What metadata.yaml of a rosbag2 states."""

    storage: str
    file: str
    topics: dict[str, str] = field(default_factory=dict)   # with their types
    counts: dict[str, int] = field(default_factory=dict)
    first_ns: int = 2**63 - 1
    last_ns: int = 0

    def take(self, topic: str, kind: str, stamp_ns: int) -> None:
        """A message was written."""
        self.topics.setdefault(topic, kind)
        self.counts[topic] = self.counts.get(topic, 0) + 1
        self.first_ns, self.last_ns = min(self.first_ns, stamp_ns), max(self.last_ns, stamp_ns)

    def text(self) -> str:
        """The file."""
        total = sum(self.counts.values())
        first = self.first_ns if total else 0
        span = self.last_ns - first
        head = ["rosbag2_bagfile_information:", "  version: 8", f"  storage_identifier: {self.storage}",
                *_span("  ", first, span), f"  message_count: {total}", "  topics_with_message_count:"]
        for topic, kind in self.topics.items():
            head += ["    - topic_metadata:", f"        name: {topic}", f"        type: {kind}",
                     "        serialization_format: cdr", "        offered_qos_profiles: []",
                     f"        type_description_hash: {definition_of(kind)[1]}",
                     f"      message_count: {self.counts[topic]}"]
        name = self.file.replace('"', '\\"')
        return "\n".join([
            *head, '  compression_format: ""', '  compression_mode: ""', "  relative_file_paths:", f'    - "{name}"',
            "  files:", f'    - path: "{name}"', *_span("      ", first, span), f"      message_count: {total}",
            "  custom_data: ~", f"  ros_distro: {DISTRIBUTION}", ""])


class McapFolder:
    """A rosbag2 whose one file is an MCAP."""

    def __init__(self, path: Path):
        self.path = path
        self._metadata = Metadata("mcap", f"{path.resolve().name}_0.mcap")
        self._bag = McapBag(path / self._metadata.file)

    def write(self, topic: str, kind: str, stamp_ns: int, message: Any) -> None:
        """A message of a topic."""
        self._bag.write(topic, kind, stamp_ns, message)
        self._metadata.take(topic, kind, stamp_ns)

    def close(self) -> None:
        """Writes metadata.yaml and closes the file."""
        self._bag.close()
        (self.path / "metadata.yaml").write_text(self._metadata.text(), encoding="utf-8")


class Rosbag2:
    """A folder with one SQLite file and metadata.yaml."""

    def __init__(self, path: Path):
        self.path = path
        self._metadata = Metadata("sqlite3", f"{path.resolve().name}_0.db3")
        self._base = sqlite3.connect(path / self._metadata.file)
        self._base.executescript(TABLES)
        self._base.execute("INSERT INTO schema VALUES (4, ?)", (DISTRIBUTION,))
        self._keys: dict[str, int] = {}
        self._pending = 0
        self._base.commit()

    def write(self, topic: str, kind: str, stamp_ns: int, message: Any) -> None:
        """A message of a topic."""
        if topic not in self._keys:
            self._add(topic, kind)
        self._base.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)",
                           (self._keys[topic], stamp_ns, bytes(store().serialize_cdr(message, kind))))
        self._metadata.take(topic, kind, stamp_ns)
        self._pending += 1
        if self._pending >= COMMITTED_AT_ONCE:
            self._base.commit()
            self._pending = 0

    def _add(self, topic: str, kind: str) -> None:
        text, digest = definition_of(kind)
        if kind not in self._metadata.topics.values():
            self._base.execute("INSERT INTO message_definitions(topic_type, encoding, encoded_message_definition, "
                               "type_description_hash) VALUES (?, 'ros2msg', ?, ?)", (kind, text, digest))
        cursor = self._base.execute("INSERT INTO topics(name, type, serialization_format, offered_qos_profiles, "
                                    "type_description_hash) VALUES (?, ?, 'cdr', '', ?)", (topic, kind, digest))
        assert cursor.lastrowid is not None
        self._keys[topic] = cursor.lastrowid

    def close(self) -> None:
        """Writes metadata.yaml and closes the file."""
        text = self._metadata.text()
        self._base.execute("INSERT INTO metadata(metadata_version, metadata) VALUES (8, ?)", (text,))
        self._base.commit()
        self._base.close()
        (self.path / "metadata.yaml").write_text(text, encoding="utf-8")


def _span(indent: str, first_ns: int, length_ns: int) -> list[str]:
    return [f"{indent}duration:", f"{indent}  nanoseconds: {length_ns}", f"{indent}starting_time:",
            f"{indent}  nanoseconds_since_epoch: {first_ns}"]


ODOM, BASE, MAP, IMU = (FRAMES[name] for name in ("odom", "base", "map", "imu"))
ODOMETRY, TRANSFORMS = "nav_msgs/msg/Odometry", "tf2_msgs/msg/TFMessage"
JOINTS, IMU_TYPE, NUMBERS = "sensor_msgs/msg/JointState", "sensor_msgs/msg/Imu", "std_msgs/msg/Float64MultiArray"
HINGE_ANGLE, HINGE_RATE = "hinge_angle_rad", "hinge_rate_rad_per_s"
UNKNOWN_VARIANCE = -1.0        # in the first place of a covariance: that quantity is not measured


def needed_signals(scene: Scene) -> tuple[str, ...]:
    """The signals of a run that its topics are made of."""
    from laconic.simulation.run import input_signals, sensor_signals

    names = ["x_m", "y_m", "heading_rad", "yaw_rate_rad_per_s", "velocity_body_m_per_s[1]", "velocity_body_m_per_s[2]"]
    names += [f"{name}[{hinge.name}]" for hinge in scene.hinges for name in (HINGE_ANGLE, HINGE_RATE)]
    for wheel in range(1, scene.wheel_count + 1):
        names += [f"wheel_angle_rad[{wheel}]", f"wheel_speed_rad_per_s[{wheel}]"]
    voltages = [each for each in input_signals(scene) if each.startswith("voltage_V")]
    shown = () if scene.has_hinges else sensor_signals(scene)
    return (*names, *voltages, *(each for each in shown if each.startswith("imu_")))


class RunTopics:
    """Makes messages of a run's signals, instant by instant."""

    def __init__(self, scene: Scene, bag: BagWriter):
        self.scene, self.bag = scene, bag
        self.types = store().types
        self.joints = joint_names(scene.base, scene.wheel_count, [hinge.name for hinge in scene.hinges])
        core, carriage = scene.core(), carriage_alone(scene.vehicle)
        self._centre = centre_of_mass(core, core.vehicle(carriage))
        self._rolling = _rolling(scene, carriage)
        self._on_carriage = wheels_on_carriage(scene.vehicle)
        self._has_begun = False
        self._angles: np.ndarray | None = None
        self._odom: np.ndarray | None = None
        self._before_s = 0.0

    @property
    def remarks(self) -> tuple[str, ...]:
        """What the recording lacks."""
        if self._rolling is not None:
            return ()
        return (f"--bag {self.bag.path}: has no /odom and no /tf, as the wheels do not determine the motion",)

    def take(self, time_s: float, signals: Mapping[str, float]) -> None:
        """One instant; what of the signals is not there leaves out its topic."""
        stamp_ns = round(time_s * 1e9)
        stamp = self.types["builtin_interfaces/msg/Time"](stamp_ns // 10**9, stamp_ns % 10**9)
        if not self._has_begun:
            self._fixed_frames(stamp_ns, stamp)
        if "x_m" in signals:
            self._ground_truth(stamp_ns, stamp, signals)
        angles = self._of_wheels(signals, "wheel_angle_rad")
        speeds = self._of_wheels(signals, "wheel_speed_rad_per_s")
        if angles is not None or speeds is not None:
            nothing = np.zeros(0)
            self.bag.write("/joint_states", JOINTS, stamp_ns, self.types[JOINTS](
                self._header(stamp, ""), self.joints, nothing if angles is None else
                np.append(angles, self._of_hinges(signals, HINGE_ANGLE)), nothing if speeds is None else
                np.append(speeds, self._of_hinges(signals, HINGE_RATE)), nothing))
        if angles is not None and self._rolling is not None:
            self._odometry(stamp_ns, stamp, time_s, angles[self._on_carriage], signals)
        rate = signals.get("imu_yaw_rate_rad_per_s", signals.get("yaw_rate_rad_per_s"))
        if rate is not None:
            self._imu(stamp_ns, stamp, rate, signals)
        voltages = self._of_wheels(signals, "voltage_V")
        if voltages is not None:
            layout = self.types["std_msgs/msg/MultiArrayLayout"]([], 0)
            self.bag.write("/wheel_voltages", NUMBERS, stamp_ns, self.types[NUMBERS](layout, voltages))

    def _of_wheels(self, signals: Mapping[str, float], name: str) -> np.ndarray | None:
        values = [signals.get(f"{name}[{number}]") for number in range(1, self.scene.wheel_count + 1)]
        return np.array(values, float) if values and None not in values else None

    def _fixed_frames(self, stamp_ns: int, stamp: Any) -> None:
        """Where the IMU is on the robot."""
        self._has_begun = True
        table = self.scene.sensors.imu or {}
        place = self.types["geometry_msgs/msg/Vector3"](table.get("x_m", 0.0), table.get("y_m", 0.0), 0.0)
        self.bag.write("/tf_static", TRANSFORMS, stamp_ns, self.types[TRANSFORMS]([
            self.types["geometry_msgs/msg/TransformStamped"](self._header(stamp, BASE), IMU, self.types[
                "geometry_msgs/msg/Transform"](place, self._quaternion(table.get("heading_rad", 0.0))))]))

    def _of_hinges(self, signals: Mapping[str, float], name: str) -> list[float]:
        return [signals.get(f"{name}[{hinge.name}]", math.nan) for hinge in self.scene.hinges]

    def _header(self, stamp: Any, frame: str) -> Any:
        return self.types["std_msgs/msg/Header"](stamp, frame)

    def _quaternion(self, heading: float) -> Any:
        return self.types["geometry_msgs/msg/Quaternion"](0.0, 0.0, math.sin(0.5 * heading), math.cos(0.5 * heading))

    def _ground_truth(self, stamp_ns: int, stamp: Any, signals: Mapping[str, float]) -> None:
        pose = self._of_origin(signals)
        (x, y), rate = self._centre, signals.get("yaw_rate_rad_per_s", 0.0)
        ahead, left = (signals.get(f"velocity_body_m_per_s[{number}]", 0.0) for number in (1, 2))
        velocity = (ahead + rate * y, left - rate * x, rate)
        self._write_odometry("/ground_truth/odom", MAP, stamp_ns, stamp, pose, velocity)

    def _of_origin(self, signals: Mapping[str, float]) -> np.ndarray:
        """The pose of the body's frame; the signals are of the centre of mass."""
        heading = signals["heading_rad"]
        (x, y), cos, sin = self._centre, math.cos(heading), math.sin(heading)
        return np.array([signals["x_m"] - cos * x + sin * y, signals["y_m"] - sin * x - cos * y, heading])

    def _odometry(self, stamp_ns: int, stamp: Any, time_s: float, angles: np.ndarray,
                  signals: Mapping[str, float]) -> None:
        """The motion that the wheels tell, from the first true pose on."""
        assert self._rolling is not None
        twist = np.zeros(3)
        if self._angles is None or self._odom is None:
            self._odom = self._of_origin(signals) if "x_m" in signals else np.zeros(3)
        else:
            moved = self._rolling.moved((angles - self._angles)[None, :])
            self._odom = path_of(moved, self._odom)[1]
            twist = moved[0] / (time_s - self._before_s) if time_s > self._before_s else twist
        self._angles, self._before_s = angles, time_s
        x, y, heading = map(float, self._odom)
        self._write_odometry("/odom", ODOM, stamp_ns, stamp, self._odom, twist)
        transform = self.types["geometry_msgs/msg/TransformStamped"](
            self._header(stamp, ODOM), BASE, self.types["geometry_msgs/msg/Transform"](
                self.types["geometry_msgs/msg/Vector3"](x, y, 0.0), self._quaternion(heading)))
        self.bag.write("/tf", TRANSFORMS, stamp_ns, self.types[TRANSFORMS]([transform]))

    def _write_odometry(self, topic: str, frame: str, stamp_ns: int, stamp: Any, pose: np.ndarray,
                        velocity: Sequence[float] | np.ndarray) -> None:
        types = self.types
        x, y, heading = map(float, pose)
        ahead, left, turning = map(float, velocity)
        vector, point = types["geometry_msgs/msg/Vector3"], types["geometry_msgs/msg/Point"]
        placed = types["geometry_msgs/msg/Pose"](point(x, y, 0.0), self._quaternion(heading))
        twist = types["geometry_msgs/msg/Twist"](vector(ahead, left, 0.0), vector(0.0, 0.0, turning))
        self.bag.write(topic, ODOMETRY, stamp_ns, types[ODOMETRY](
            self._header(stamp, frame), BASE, types["geometry_msgs/msg/PoseWithCovariance"](placed, np.zeros(36)),
            types["geometry_msgs/msg/TwistWithCovariance"](twist, np.zeros(36))))

    def _imu(self, stamp_ns: int, stamp: Any, rate: float, signals: Mapping[str, float]) -> None:
        """As the scene's IMU shows it; without one the yaw rate itself, and no acceleration."""
        vector = self.types["geometry_msgs/msg/Vector3"]
        unknown, known = np.zeros(9), np.zeros(9)
        unknown[0] = UNKNOWN_VARIANCE
        ahead, left = (signals.get(f"imu_acceleration_m_per_s2[{number}]") for number in (1, 2))
        self.bag.write("/imu", IMU_TYPE, stamp_ns, self.types[IMU_TYPE](
            self._header(stamp, IMU), self._quaternion(0.0), unknown, vector(0.0, 0.0, float(rate)), known,
            vector(float(ahead or 0.0), float(left or 0.0), 0.0), unknown if ahead is None else known))


def _rolling(scene: Scene, carriage: Mapping[str, Any]) -> Rolling | None:
    """None where the wheels of the carriage do not determine the motion: then there is no odometry."""
    if not carriage["wheel"]:
        return None
    try:
        return rolling_of(scene.core(), carriage, scene.path)
    except BadInput:
        return None
