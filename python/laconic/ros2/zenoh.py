"""A session of Zenoh as rmw_zenoh makes it: keys, liveliness tokens as the graph, attachments, queries as services.

Everything is polled from one thread. Experimental: tried against PyPI's zenoh-ros2-sdk, and not against ROS itself.
"""

from __future__ import annotations

import hashlib
import os
import struct
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import zenoh
from zenoh.ext import CacheConfig, HistoryConfig, declare_advanced_publisher, declare_advanced_subscriber
from zenoh.handlers import FifoChannel, RingChannel

from laconic.errors import BadInput
from laconic.ros2 import USUAL_DISTRIBUTION, WITHOUT_HASHES
from laconic.ros2.messages import dds_name, message_class, type_hash
from laconic.ros2.names import MOST_AT_ONCE, OTHER_FIELDS, USUAL, Quality, check_domain, topic_name

USUAL_ROUTER = "tcp/localhost:7447"  # where peers expect one
SETTINGS = "ZENOH_SESSION_CONFIG_URI"
ATTACHMENT = struct.Struct("<qqB16s")
NODE, PUBLISHER, SUBSCRIPTION, SERVER = "NN", "MP", "MS", "SS"
SPACE = "@ros2_lv"
PARTS_OF_TOKEN = 13
MOST_WAITING = 256
RETRY = '{"period_init_ms": 1000, "period_max_ms": 1000, "period_increase_factor": 1}'
LINK_S = 1.0  # within which a session finds a router that is there


def mangled(name: str) -> str:
    """A name as a part of a key, where / ends a part."""
    return name.replace("/", "%") or "%"


def attachment(sequence: int, gid: bytes) -> bytes:
    """What a message carries: its number, the time, and who sent it."""
    return ATTACHMENT.pack(sequence, time.time_ns(), len(gid), gid)


def attached(data: Any) -> tuple[int, bytes]:
    """Number and sender of an attachment; zeros where there is none."""
    found = b"" if data is None else bytes(data)
    if len(found) < ATTACHMENT.size:
        return 0, bytes(16)
    number, _, _, gid = ATTACHMENT.unpack_from(found)
    return number, gid


def quality_part(quality: Quality) -> str:
    """Quality of service as a token has it: what is not RELIABLE, VOLATILE, KEEP_LAST 42 and without ends."""
    return f":{1 if quality.is_latched else ''}:,{quality.depth}:,:,:,,"


def config_of(router: str, listen: str, is_local: bool) -> Any:
    """The file that ZENOH_SESSION_CONFIG_URI names, else a peer as rmw_zenoh has it."""
    if os.environ.get(SETTINGS):
        try:
            return zenoh.Config.from_file(os.environ[SETTINGS])
        except Exception:  # zenoh has no common class for what it raises here
            raise BadInput(f"{SETTINGS}: {os.environ[SETTINGS]} cannot be read as a configuration of Zenoh; mend it or "
                           "unset the variable") from None
    made = zenoh.Config()
    own = listen or ("tcp/127.0.0.1:0" if is_local else "tcp/[::]:0")
    for key, value in (("mode", '"peer"'), ("connect/endpoints", f'["{router}"]'), ("connect/timeout_ms", "-1"),
                       ("connect/exit_on_failure", "false"), ("connect/retry", RETRY),
                       ("listen/endpoints", f'["{own}"]'), ("scouting/multicast/enabled", "false"),
                       ("timestamping/enabled", "true")):
        try:
            made.insert_json5(key, value)
        except Exception:
            raise BadInput(f"--router: {router} is not an endpoint of Zenoh; give one such as {USUAL_ROUTER}") from None
    return made


class Writer:
    """A publisher."""

    def __init__(self, context: Context, topic: str, message: str, quality: Quality, token: str):
        session, key = context.session, context.key(topic, message, type_hash(message))
        drop = zenoh.CongestionControl.DROP  # rather than wait for a peer that does not keep up
        self._publisher: Any = declare_advanced_publisher(
            session, key, cache=CacheConfig(max_samples=quality.depth), publisher_detection=True,
            congestion_control=drop) if quality.is_latched else session.declare_publisher(key, congestion_control=drop)
        self._gid, self._sequence = hashlib.md5(token.encode(), usedforsecurity=False).digest(), 0

    def write(self, message: Any) -> None:
        """Sends a message."""
        self._sequence += 1
        self._publisher.put(message.serialize(use_version_2=False), attachment=attachment(self._sequence, self._gid))


class Reader:
    """A subscription, for `polled`."""

    def __init__(self, context: Context, topic: str, message: str, quality: Quality):
        self._class = message_class(message)
        key = context.key(topic, message, type_hash(message))
        channel: Any = RingChannel(quality.depth)
        self._subscriber: Any = declare_advanced_subscriber(
            context.session, key, channel, history=HistoryConfig(detect_late_publishers=True)) if quality.is_latched \
            else context.session.declare_subscriber(key, channel)

    def take(self, N: int = 1) -> list[Any]:  # noqa: N803
        """At most one message, whatever the number; raises what cyclonedds does for bytes that are not this type."""
        sample = self._subscriber.try_recv()
        if sample is None or sample.kind != zenoh.SampleKind.PUT:
            return []
        made = self._class.deserialize(bytes(sample.payload))
        _, gid = attached(sample.attachment)
        made.sample_info = SimpleNamespace(publication_handle=int.from_bytes(gid[:8], "little"))
        return [made]


class ZenohService:
    """A service: queries in, replies out."""

    def __init__(self, context: Context, topic: str, name: str, kind: str, answer: Callable[[Any], Any]):
        self.name, self._answer = name, answer
        self._request, self._response = (message_class(f"{kind}_{part}") for part in ("Request", "Response"))
        self._key = context.key(topic, kind, type_hash(kind))
        self._queries: Any = context.session.declare_queryable(self._key, FifoChannel(MOST_WAITING),
                                                               complete=True)

    def poll(self, wrong: Callable[[str], None]) -> int:
        """Answers what has come, and returns how many requests that were."""
        count = 0
        for _ in range(MOST_AT_ONCE):
            query = self._queries.try_recv()
            if query is None:
                break
            with query:
                count += self._take(query, wrong)
        return count

    def _take(self, query: Any, wrong: Callable[[str], None]) -> int:
        try:
            request = self._request.deserialize(bytes(query.payload or b""))
        except Exception:  # as in Reader.take
            wrong(f"{self.name}: a request that cannot be read is ignored")
            return 0
        number, gid = attached(query.attachment)
        response = self._response(**self._answer(request))
        query.reply(self._key, response.serialize(use_version_2=False), attachment=attachment(number, gid))
        return 1


@dataclass
class ZenohNode:
    """One node: publishers, subscriptions and services in its namespace."""

    context: Context
    name: str
    namespace: str
    number: int
    services: list[ZenohService] = field(default_factory=list)

    @property
    def full_name(self) -> str:
        """With its namespace: /robot1/laconic."""
        return topic_name("", self.namespace, self.name)

    def _full(self, topic: str) -> str:
        return topic_name("", self.namespace, topic)

    def publisher(self, topic: str, message: str, quality: Quality = USUAL) -> Writer:
        """What `sent` writes to."""
        token = self.context.token(self, PUBLISHER, self._full(topic), message, quality)
        return self.context.kept(Writer(self.context, self._full(topic), message, quality, token))

    def subscription(self, topic: str, message: str, quality: Quality = USUAL) -> Reader:
        """What `polled` reads from."""
        self.context.token(self, SUBSCRIPTION, self._full(topic), message, quality)
        self.context._hashes[dds_name(message)] = type_hash(message)
        return self.context.kept(Reader(self.context, self._full(topic), message, quality))

    def service(self, name: str, kind: str, answer: Callable[[Any], Any]) -> ZenohService:
        """A service of a type such as std_srvs/srv/Empty; `answer` makes the response's values of a request."""
        self.context.token(self, SERVER, self._full(name), kind, USUAL)
        self.services.append(ZenohService(self.context, self._full(name), name, kind, answer))
        return self.services[-1]


class Context:
    """One session, the nodes in it, and what the graph says of others."""

    def __init__(self, domain: int, distribution: str = USUAL_DISTRIBUTION, *, is_local: bool = False,
                 announces: bool = True, router: str = USUAL_ROUTER, listen: str = ""):
        check_domain(domain)
        self.domain, self.announces, self.has_hashes = domain, announces, distribution not in WITHOUT_HASHES
        zenoh.init_log_from_env_or("error")
        try:
            self.session = zenoh.open(config_of(router, listen, is_local))
        except zenoh.ZError:
            raise BadInput(f"--router: no session of Zenoh opens with {router}; give an endpoint such as "
                           f"{USUAL_ROUTER}, or check {SETTINGS}") from None
        self.id, self._next = str(self.session.info.zid()), 0
        self.nodes, self._entities = list[ZenohNode](), list[Any]()
        self._hashes: dict[str, str] = {}  # of what is heard, by the types' names in DDS
        self._graph: Any = self.session.liveliness().declare_subscriber(
            f"{SPACE}/{domain}/**", FifoChannel(4096), history=True)
        self._namesakes, self._seen = set[str](), list[tuple[str, str, str]]()
        self._where = os.environ.get(SETTINGS) or router
        self._was_linked = self._is_missed = False
        self._until_s = time.monotonic() + LINK_S

    def kept(self, entity: Any) -> Any:
        """The same, which lives as long as the session."""
        self._entities.append(entity)
        return entity

    def node(self, name: str, namespace: str = "/") -> ZenohNode:
        """Another node."""
        made = ZenohNode(self, name, namespace, self._next)
        self.nodes.append(made)
        self.token(made, NODE)
        return made

    def key(self, topic: str, kind: str, known_hash: str) -> str:
        """Where messages of a topic go."""
        return f"{self.domain}/{topic.strip('/')}/{dds_name(kind)}/{self._hash(known_hash)}"

    def _hash(self, known_hash: str) -> str:
        return known_hash if self.has_hashes else "TypeHashNotSupported"

    def token(self, node: ZenohNode, what: str, topic: str = "", kind: str = "", quality: Quality = USUAL) -> str:
        """Announces an entity while the session lives; returns its key."""
        number, self._next = self._next, self._next + 1
        parts = [SPACE, str(self.domain), self.id, str(node.number), str(number), what, "%",
                 mangled(node.namespace if node.namespace != "/" else ""), node.name]
        if topic:
            parts += [mangled(topic), dds_name(kind), self._hash(type_hash(kind)), quality_part(quality)]
        made = "/".join(parts)
        if self.announces:
            self.kept(self.session.liveliness().declare_token(made))
        return made

    # ---- the graph

    def announce(self) -> None:
        """Nothing: tokens announce each entity as it is made."""

    def answer(self) -> None:
        """Nothing: services are polled one by one."""

    def _look(self) -> None:
        """Reads tokens of others that have come."""
        for _ in range(MOST_AT_ONCE * 16):
            sample = self._graph.try_recv()
            if sample is None:
                break
            parts = str(sample.key_expr).split("/")
            if sample.kind != zenoh.SampleKind.PUT or len(parts) < 9 or parts[2] == self.id:
                continue
            if parts[5] == NODE:
                self._namesakes.add(f"{parts[7].replace('%', '/').rstrip('/')}/{parts[8]}")
            elif parts[5] == PUBLISHER and len(parts) >= PARTS_OF_TOKEN:
                topic, kind, known = f"rt{parts[9].replace('%', '/')}", parts[10], parts[11]
                self._seen.append((topic, kind, ""))
                if known != self._hash(self._hashes.get(kind, known)):
                    self._seen.append((topic, kind, OTHER_FIELDS))

    def namesakes(self) -> set[str]:
        """Full names of nodes that another session has announced and that are ours, too."""
        self._look()
        found = self._namesakes & {node.full_name for node in self.nodes}
        self._namesakes.clear()
        return found

    def remarks(self) -> Iterator[str]:
        """A line each time that the first link to a router or peer comes, or the last one goes."""
        is_linked = bool([*self.session.info.routers_zid(), *self.session.info.peers_zid()])
        if is_linked and self._is_missed:
            yield f"connected to Zenoh at {self._where}"
        elif not is_linked and not self._is_missed and time.monotonic() >= self._until_s:
            yield (f"the Zenoh router at {self._where} is gone; will connect when it comes again"
                   if self._was_linked else f"no Zenoh router at {self._where} yet; will connect when it comes")
            self._is_missed = True
        self._was_linked, self._is_missed = self._was_linked or is_linked, self._is_missed and not is_linked

    def new_writers(self) -> Iterator[tuple[str, str, str]]:
        """As Middleware.new_writers."""
        self._look()
        found, self._seen = self._seen, []
        yield from found

    def close(self) -> None:
        """Closes the session, so that peers know at once."""
        self._entities.clear()
        self.session.close()  # type: ignore[no-untyped-call]
