"""Publishers of messages whose texts stay while their numbers change, and the geometry that they show."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

from laconic.ros2.messages import Packed, new
from laconic.ros2.names import USUAL, Quality, RosNode, sent

ODOMETRY, TRANSFORM = "nav_msgs/msg/Odometry", "geometry_msgs/msg/TransformStamped"
SURE, UNSURE, NOT_KNOWN = 1e-3, 1e-2, 1e6  # variances of odometry: along and across, yaw rate, out of the plane
NANO = 10**9


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
