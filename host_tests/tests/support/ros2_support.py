"""A session of `laconic ros2` in virtual time, and a peer in the same process, whose messages arrive as they are sent.

Traffic stays on this machine. Each test room has a domain of its own.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from cyclonedds.builtin import BuiltinDataReader

from laconic.ros2.messages import message_class, new
from laconic.ros2.names import USUAL, polled, topic_name
from laconic.ros2.session import Clock, Ros2Options, Session
from laconic.ros2.wire import Node, Participant
from laconic.scene import Scene, read_scene

DOMAIN = 77
WALL_NS = 1_700_000_000 * 10**9


class Virtual:
    """Clocks that stand still until somebody sleeps."""

    def __init__(self) -> None:
        self.time_s, self.wall_offset_ns, self.overslept_s = 0.0, WALL_NS, 0.0

    def sleep(self, seconds: float) -> None:
        self.time_s += seconds + self.overslept_s
        self.overslept_s = 0.0

    def wall_ns(self) -> int:
        return self.wall_offset_ns + round(self.time_s * 1e9)

    def clock(self) -> Clock:
        return Clock(lambda: self.time_s, self.wall_ns, self.sleep)


class Rig:
    """A session and a peer."""

    def __init__(self, session: Session, peer: Participant, time: Virtual, lines: list[str]):
        self.session, self.peer, self.time, self.lines = session, peer, time, lines
        self.node: Node = peer.node("peer")
        self._drivers: dict[Any, Any] = {}

    def turn(self, cycles: int = 1, each: Callable[[], None] = lambda: None) -> None:
        """Cycles, one period apart."""
        for _ in range(cycles):
            each()
            self.session.cycle()
            self.time.time_s += self.session.period_s

    def twist(self, ahead: float = 0.0, left: float = 0.0, yaw_rate: float = 0.0) -> Any:
        message = new("geometry_msgs/msg/Twist")
        message.linear.x, message.linear.y, message.angular.z = ahead, left, yaw_rate
        return message

    def drive(self, cycles: int, ahead: float, yaw_rate: float = 0.0, topic: str = "cmd_vel") -> None:
        """Commands in each cycle."""
        key, message = (self.node.participant.dds.guid, topic), self.twist(ahead, 0.0, yaw_rate)
        if key not in self._drivers:
            self._drivers[key] = self.node.publisher(topic, "geometry_msgs/msg/Twist")
        writer = self._drivers[key]
        self.turn(cycles, lambda: writer.write(message))

    def call(self, service: str, kind: str, **values: Any) -> Any:
        """A request of a client as rmw_cyclonedds makes it, and the response."""
        request, response = f"{kind}_Request", f"{kind}_Response"
        make, participant = self.peer._endpoint, self.peer
        from cyclonedds.pub import DataWriter
        from cyclonedds.sub import DataReader

        writer = make(DataWriter, topic_name("rq", "/", service, "Request"), request, USUAL, of_service="clientid=1;")
        reader = make(DataReader, topic_name("rr", "/", service, "Reply"), response, USUAL, of_service="clientid=1;")
        others = getattr(self.session.participant, "others", None)
        end = time.monotonic() + 10.0
        while others is not None and not (writer.get_matched_subscriptions() and reader.get_matched_publications()):
            assert time.monotonic() < end, "the service is not found"
            self.turn()  # discovery takes real time
        writer.write(message_class(request, participant.gid_bytes, True)(client=41, sequence=7, **values))
        self.turn(2)
        while not (found := polled(reader)) and others is not None and time.monotonic() < end:
            self.turn()
        assert [(each.client, each.sequence) for each in found] == [(41, 7)]
        return found[0]


@contextmanager
def rig_of(scene: str | Scene = "turtlebot3_burger", **options: Any) -> Iterator[Rig]:
    """A rig of a scene, whose session and peer leave the domain at the end."""
    virtual, lines = Virtual(), list[str]()
    given = Ros2Options(**{"domain": DOMAIN, "is_local": True, "services_for": ("cyclonedds",), **options})
    made = scene if isinstance(scene, Scene) else read_scene(scene)
    with Session(made, given, lines.append, virtual.clock()) as session, \
            Participant(given.domain, given.distribution, is_local=True) as peer:
        yield Rig(session, peer, virtual, lines)


def last(reader: Any) -> Any:
    """The newest message."""
    return polled(reader, most=1000)[-1]


def announced(participant: Participant, topic: Any) -> dict[str, Any]:
    """Endpoints by the names of their topics, as discovery has them."""
    found = BuiltinDataReader(participant.dds, topic).take(N=500)
    return {each.topic_name: each for each in found if hasattr(each, "topic_name") and each.topic_name}
