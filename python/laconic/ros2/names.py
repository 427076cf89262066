"""What all middlewares share: names, quality of service, faces of participants and nodes, and publishers of messages
whose texts stay while their numbers change."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from laconic.errors import BadInput
from laconic.ros2.messages import Packed, new

try:
    from cyclonedds.core import DDSException
except ImportError:  # Zenoh needs none
    class DDSException(Exception):  # type: ignore[no-redef]
        """What no reader raises then."""

ODOMETRY, TRANSFORM = "nav_msgs/msg/Odometry", "geometry_msgs/msg/TransformStamped"
SURE, UNSURE, NOT_KNOWN = 1e-3, 1e-2, 1e6  # variances of odometry: along and across, yaw rate, out of the plane
NANO = 10**9
MOST_DOMAIN = 232  # beyond it the ports of UDP end
NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
BEST_EFFORT, OTHER_FIELDS = "best effort", "other fields"  # why a publisher is not heard
MOST_AT_ONCE = 64  # messages of one reader in one poll


@dataclass(frozen=True)
class Quality:
    """Quality of service by ROS's names; writers offer RELIABLE, which matches every reader."""

    depth: int = 10
    is_latched: bool = False


USUAL, LATCHED, TRANSFORMS = Quality(), Quality(depth=1, is_latched=True), Quality(depth=100)


def check_name(option: str, name: str) -> str:
    """A namespace or a name with a leading slash; BadInput for what ROS does not allow."""
    parts = name.strip("/").split("/") if name.strip("/") else []
    if "//" in name or not all(NAME.fullmatch(part) for part in parts):
        raise BadInput(f"{option}: {name} is not a name of ROS; give letters, digits and _ that begin with a letter, "
                       "such as robot1")
    return "/" + "/".join(parts)


def check_domain(domain: int) -> None:
    """BadInput for a number that is no domain."""
    if not 0 <= domain <= MOST_DOMAIN:
        raise BadInput(f"--domain: {domain} is not a domain; give 0 to {MOST_DOMAIN}")


def topic_name(prefix: str, namespace: str, topic: str, suffix: str = "") -> str:
    """The DDS name of a topic or service: rt/robot1/odom; a name with a leading slash is not in the namespace."""
    full = topic if topic.startswith("/") else f"{namespace.rstrip('/')}/{topic}"
    return f"{prefix}{full}{suffix}"


class RosNode(Protocol):
    """A node of any middleware."""

    name: str
    namespace: str

    @property
    def full_name(self) -> str:
        """With its namespace: /robot1/laconic."""

    @property
    def services(self) -> Sequence[RosService]:
        """Of this node."""

    def publisher(self, topic: str, message: str, quality: Quality = ...) -> Any:
        """What `sent` writes to."""

    def subscription(self, topic: str, message: str, quality: Quality = ...) -> Any:
        """What `polled` reads from."""

    def service(self, name: str, kind: str, answer: Callable[[Any], Any]) -> RosService:
        """A service of a type such as std_srvs/srv/Empty; `answer` makes the response's values of a request."""


class RosService(Protocol):
    """A service of any middleware."""

    def poll(self, wrong: Callable[[str], None]) -> int:
        """Answers what has come, and returns how many requests that were."""


class Middleware(Protocol):
    """A participant, session or context of any middleware."""

    def node(self, name: str, namespace: str = "/") -> RosNode:
        """Another node."""

    @property
    def nodes(self) -> Sequence[RosNode]:
        """All of them."""

    def announce(self) -> None:
        """Tells the graph of nodes and endpoints."""

    def answer(self) -> None:
        """Works on requests that no node polls."""

    def namesakes(self) -> set[str]:
        """Full names of nodes of others that are ours, too."""

    def remarks(self) -> Iterator[str]:
        """Lines on the way to others that have changed since the last call."""

    def new_writers(self) -> Iterator[tuple[str, str, str]]:
        """Topics and types, by their names in DDS, of publishers that have come since the last call; then of those
        whose type has our name and that are not heard all the same, with the reason."""

    def close(self) -> None:
        """Leaves, so that peers know at once."""


def polled(reader: Any, wrong: Callable[[], None] = lambda: None, most: int = MOST_AT_ONCE) -> list[Any]:
    """What has come since the last poll, at most so many; calls `wrong` for each message that cannot be read."""
    found = []
    for _ in range(most):
        try:
            taken = reader.take(N=1)
        except DDSException:
            break
        except Exception:  # whatever cyclonedds raises for bytes that are not this type
            wrong()
            continue
        if not taken:
            break
        if hasattr(taken[0], "__idl__"):  # no news of a writer that has gone
            found.append(taken[0])
    return found


def sent(writer: Any, message: Any) -> bool:
    """Writes a message; False where a reader does not keep up, so that the message is left out."""
    try:
        writer.write(message)
    except DDSException:
        return False
    return True


def ros_type(name: str) -> str:
    """The ROS name of a type on the wire; as it is where it is not ROS's."""
    parts = name.split("::")
    is_ros = len(parts) == 4 and parts[2] == "dds_" and parts[3].endswith("_")
    return f"{parts[0]}/{parts[1]}/{parts[3][:-1]}" if is_ros else name


# ---- publishers

class Out:
    """A publisher of a packed message with a stamp."""

    def __init__(self, node: RosNode, topic: str, kind: str, message: Any, quality: Quality = USUAL,
                 stamps: Sequence[str] = ("header.stamp",)):
        self.packed = Packed(kind, message)
        self._writer, self._message = node.publisher(topic, kind, quality), self.packed.message
        self._stamps = [self.packed.slot(path, "iI") for path in stamps]
        self.left_out = 0

    def write(self, stamp: tuple[int, int]) -> None:
        """Sends it as it is now."""
        for each in self._stamps:
            each.put(*stamp)
        self.left_out += not sent(self._writer, self._message)


class OdometryOut:
    """A publisher of nav_msgs/Odometry."""

    def __init__(self, node: RosNode, topic: str, frame: str, child: str, variance: float, quality: Quality):
        message = new(ODOMETRY, child_frame_id=child)
        message.header.frame_id = frame
        if variance:
            for part in (message.pose, message.twist):
                part.covariance[0::7] = [SURE, SURE, NOT_KNOWN, NOT_KNOWN, NOT_KNOWN, UNSURE]
        self.out = Out(node, topic, ODOMETRY, message, quality)
        self._place = self.out.packed.slot("pose.pose.position", "2d")
        self._turn = self.out.packed.slot("pose.pose.orientation.z", "2d")
        self._velocity = self.out.packed.slot("twist.twist.linear", "2d")
        self._rate = self.out.packed.slot("twist.twist.angular.z", "d")

    def write(self, stamp: tuple[int, int], pose: tuple[float, float, float],
              velocity: tuple[float, float, float]) -> None:
        """Sends a pose, and a velocity in the child's axes."""
        self._place.put(pose[0], pose[1])
        self._turn.put(*upright(pose[2]))
        self._velocity.put(velocity[0], velocity[1])
        self._rate.put(velocity[2])
        self.out.write(stamp)


def upright(yaw_rad: float) -> tuple[float, float]:
    """z and w of the quaternion of a turn about the vertical; x and y are 0."""
    return math.sin(0.5 * yaw_rad), math.cos(0.5 * yaw_rad)


def transform(parent: str, child: str, x_m: float = 0.0, y_m: float = 0.0, yaw_rad: float = 0.0) -> Any:
    """A TransformStamped at time 0."""
    made = new(TRANSFORM, child_frame_id=child)
    made.header.frame_id = parent
    made.transform.translation.x, made.transform.translation.y = x_m, y_m
    made.transform.rotation.z, made.transform.rotation.w = upright(yaw_rad)
    return made


def between(outer: tuple[float, float, float], inner: tuple[float, float, float]) -> tuple[float, float, float]:
    """The pose of the second's frame in the first's, from one body's pose in both."""
    yaw = outer[2] - inner[2]
    sine, cosine = math.sin(yaw), math.cos(yaw)
    return (outer[0] - cosine * inner[0] + sine * inner[1], outer[1] - sine * inner[0] - cosine * inner[1], yaw)


def diagnostics(statuses: Iterable[Any], stamp_ns: int) -> Any:
    """A diagnostic_msgs/DiagnosticArray."""
    made = new("diagnostic_msgs/msg/DiagnosticArray", status=list(statuses))
    made.header.stamp.sec, made.header.stamp.nanosec = divmod(stamp_ns, NANO)
    return made
