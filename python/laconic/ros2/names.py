"""What all middlewares share: names, quality of service, and the faces of a participant and of its nodes."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from laconic.errors import BadInput

try:
    from cyclonedds.core import DDSException
except ImportError:  # Zenoh needs none
    class DDSException(Exception):  # type: ignore[no-redef]
        """What no reader raises then."""

MOST_DOMAIN = 232  # beyond it the ports of UDP end
NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
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

    def new_writers(self) -> Iterator[tuple[str, str]]:
        """Topics and types, by their names in DDS, of publishers that have come since the last call."""

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
