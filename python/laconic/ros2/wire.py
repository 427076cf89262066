"""A participant as a ROS 2 middleware makes it: names, quality of service, type hashes, the graph, services.

DDS is PyPI's cyclonedds. Everything is polled from one thread, so that a run does not depend on callbacks.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication
from cyclonedds.core import DDSException, InstanceState
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.pub import DataWriter, Publisher
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader, Subscriber
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from laconic.errors import BadInput
from laconic.ros2 import GID_BYTES, USUAL_DISTRIBUTION, WITHOUT_HASHES
from laconic.ros2.messages import dds_name, message_class, type_hash
from laconic.ros2.names import (
    BEST_EFFORT,
    LATCHED,
    MOST_AT_ONCE,
    OTHER_FIELDS,
    USUAL,
    Quality,
    check_domain,
    polled,
    sent,
    topic_name,
)
from laconic.ros2.rtps import Guid, Services

HEADER_BYTES = 20  # of a request of rmw_cyclonedds: encapsulation, client and number
MATCH_S = 2.0  # within which a writer matches: it is asked for the fields of its type meanwhile
MOST_WRITERS = 10_000
HANDLES = 2**64  # cyclonedds gives handles with a sign in one place and without in another
MOST_WAIT = duration(microseconds=100)  # of a writer for a reader that does not keep up

THIS_MACHINE = """<CycloneDDS><Domain Id="any"><General><Interfaces><NetworkInterface name="lo" multicast="false"/>
</Interfaces><AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>
<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex><Peers><Peer Address="127.0.0.1"/></Peers></Discovery></Domain>
</CycloneDDS>"""
"""Discovery by unicast on this machine alone, as ROS 2 does for ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST."""

BY_NAMES = """<CycloneDDS><Domain Id="any"><Compatibility><IgnoreTypeInformation>1.15</IgnoreTypeInformation>
</Compatibility></Domain></CycloneDDS>"""
"""Types of Fast DDS (vendor 1.15) are compared by their names, as ROS does. From version 3 on, with ROS 2 Kilted, it
also describes them. cyclonedds cannot read its sequences and arrays, so that those endpoints would not match."""

_DOMAINS: dict[int, Domain] = {}  # of this process, which may configure each of them once


def settings(is_local: bool) -> str:
    """What configures a domain: CYCLONEDDS_URI, and what we add."""
    given = [] if is_local else [each for each in [os.environ.get("CYCLONEDDS_URI", "")] if each]
    return ",".join([*given, *([THIS_MACHINE] if is_local else []), BY_NAMES])


def is_alive(found: Any) -> bool:
    """Whether an endpoint was there when it was read."""
    return bool(found.sample_info.valid_data and found.sample_info.instance_state == InstanceState.Alive)


def is_best_effort(qos: Qos) -> bool:
    """Whether a writer offers less than a reader of ours asks for."""
    return Policy.Reliability in qos and isinstance(qos[Policy.Reliability], type(Policy.Reliability.BestEffort))


class Participant:
    """One DDS participant, the nodes in it, and their entry in the graph."""

    def __init__(self, domain: int, distribution: str = USUAL_DISTRIBUTION, *, is_local: bool = False,
                 announces: bool = True, middlewares: Sequence[str] = ("cyclonedds",)):
        check_domain(domain)
        self.gid_bytes, self.domain = GID_BYTES[distribution], domain
        self.has_hashes, self.announces = distribution not in WITHOUT_HASHES, announces
        try:
            if domain not in _DOMAINS:
                _DOMAINS[domain] = Domain(domain, settings(is_local))
            self.dds = DomainParticipant(domain, qos=Qos(Policy.Userdata(b"enclave=/;")))
        except DDSException:
            raise BadInput(f"--domain: no participant can join domain {domain}; check the network and CYCLONEDDS_URI, "
                           "or give --local for this machine alone") from None
        self.publisher, self.subscriber = Publisher(self.dds), Subscriber(self.dds)
        self.nodes: list[Node] = []
        self._topics: dict[tuple[str, str], Any] = {}
        self._readers: dict[tuple[str, str], list[Any]] = {}  # by topic and type on the wire
        self._unmatched: dict[int, tuple[Any, float]] = {}    # writers for them, and until when they may match
        self._entities: list[Any] = [self.publisher, self.subscriber]
        graph = "rmw_dds_common/msg/ParticipantEntitiesInfo"
        self._graph = self._endpoint(DataWriter, "ros_discovery_info", graph, LATCHED) if announces else None
        self._others = self._endpoint(DataReader, "ros_discovery_info", graph, Quality(100, is_latched=True))
        self._writers = BuiltinDataReader(self.dds, BuiltinTopicDcpsPublication)
        self.others: Services | None = None  # for clients on Fast DDS and on cyclonedds
        if "fastrtps" in middlewares:
            try:
                self.others = Services(domain, is_local=is_local)
            except OSError:
                self.close()
                raise BadInput(f"--domain: domain {domain} has no free port for services; give another domain, or "
                               "--rmw cyclonedds") from None

    def node(self, name: str, namespace: str = "/") -> Node:
        """Another node of this participant."""
        self.nodes.append(Node(self, name, namespace))
        return self.nodes[-1]

    def message(self, kind: str, /, **values: Any) -> Any:
        """A message with this distribution's Gid."""
        return message_class(kind, self.gid_bytes)(**values)

    # ---- endpoints

    def _endpoint(self, kind: Any, wire_name: str, message: str, quality: Quality, *, of_service: str = "") -> Any:
        cls = message_class(message, self.gid_bytes, bool(of_service))
        key = (wire_name, message)
        if key not in self._topics:
            self._topics[key] = Topic(self.dds, wire_name, cls)
        owner = self.publisher if kind is DataWriter else self.subscriber
        endpoint = kind(owner, self._topics[key], qos=self._qos(kind, message, quality, of_service))
        self._entities.append(endpoint)
        if kind is DataReader:
            self._readers.setdefault((wire_name, dds_name(message)), []).append(endpoint)
        return endpoint

    def _qos(self, kind: Any, message: str, quality: Quality, of_service: str) -> Qos:
        history = Policy.History.KeepLast(quality.depth)
        policies = [
            history, Policy.DataRepresentation(use_cdrv0_representation=True),
            Policy.Reliability.Reliable(MOST_WAIT),
            Policy.Durability.TransientLocal if quality.is_latched else Policy.Durability.Volatile]
        if kind is DataWriter:
            policies.append(Policy.WriterDataLifecycle(autodispose=False))
            if quality.is_latched:
                policies.append(Policy.DurabilityService(0, history, -1, -1, -1))
        user_data = of_service + self.hash_of(message)
        if user_data:
            policies.append(Policy.Userdata(user_data.encode()))
        return Qos(*policies)

    def hash_of(self, message: str) -> str:
        """What an endpoint's user data says of its type."""
        return f"typehash={type_hash(message, self.gid_bytes)};" if self.has_hashes else ""

    # ---- the graph

    def gid(self, entity: Any) -> Any:
        """The Gid of an entity."""
        data = [*(entity.bytes if isinstance(entity, Guid) else entity.guid.bytes)] + [0] * (self.gid_bytes - 16)
        return self.message("rmw_dds_common/msg/Gid", data=data)

    def announce(self) -> None:
        """Tells the graph which nodes there are, and which endpoints are theirs."""
        if self._graph is None:
            return
        nodes = [self.message(
            "rmw_dds_common/msg/NodeEntitiesInfo", node_namespace=node.namespace, node_name=node.name,
            reader_gid_seq=[self.gid(each) for each in (*node.readers, *node.other_readers)],
            writer_gid_seq=[self.gid(each) for each in (*node.writers, *node.other_writers)])
            for node in self.nodes]
        sent(self._graph, self.message("rmw_dds_common/msg/ParticipantEntitiesInfo", gid=self.gid(self.dds),
                                       node_entities_info_seq=nodes))

    def answer(self) -> None:
        """Answers requests of clients on Fast DDS that have come."""
        if self.others is not None:
            self.others.poll()

    def namesakes(self) -> set[str]:
        """Full names of nodes that another participant has announced and that are ours, too."""
        ours, found = {node.full_name for node in self.nodes}, set()
        own = bytes(self.dds.guid.bytes)
        for info in polled(self._others):
            if bytes(info.gid.data)[:16] != own:
                names = {topic_name("", each.node_namespace, each.node_name) for each in info.node_entities_info_seq}
                found |= names & ours
        return found

    def remarks(self) -> Iterator[str]:
        """Nothing: peers come and go without a router."""
        return iter(())

    def new_writers(self) -> Iterator[tuple[str, str, str]]:
        """As Middleware.new_writers; whether a writer matches is known some time after it has come."""
        for each in self._writers.take(N=MOST_AT_ONCE):
            handle = each.sample_info.instance_handle % HANDLES
            self._unmatched.pop(handle, None)
            if getattr(each.sample_info, "valid_data", False):
                yield each.topic_name, each.type_name, ""
                if (each.topic_name, each.type_name) in self._readers and is_alive(each):
                    self._unmatched[handle] = (each, time.monotonic() + MATCH_S)
        matched = {key: {handle % HANDLES for reader in readers for handle in reader.get_matched_publications()}
                   for key, readers in self._readers.items()} if self._unmatched else {}
        for handle, (each, until_s) in list(self._unmatched.items()):
            key = each.topic_name, each.type_name
            if handle in matched[key] or time.monotonic() >= until_s:
                del self._unmatched[handle]
                if handle not in matched[key] and self._is_there(handle):
                    yield *key, BEST_EFFORT if is_best_effort(each.qos) else OTHER_FIELDS

    def _is_there(self, handle: int) -> bool:
        """Whether a writer has not gone meanwhile."""
        found = BuiltinDataReader(self.dds, BuiltinTopicDcpsPublication).take(N=MOST_WRITERS)
        return any(each.sample_info.instance_handle % HANDLES == handle and is_alive(each) for each in found)

    def close(self) -> None:
        """Leaves the domain, so that peers know at once."""
        if self.others is not None:
            self.others.close()
            self.others = None
        for entity in [*reversed(self._entities), self._writers, *self._topics.values(), self.dds]:
            entity.__del__()
        self._entities.clear()
        self._topics.clear()

    def __enter__(self) -> Participant:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


@dataclass
class Node:
    """One node: publishers, subscriptions and services in its namespace."""

    participant: Participant
    name: str
    namespace: str = "/"
    readers: list[Any] = field(default_factory=list)
    writers: list[Any] = field(default_factory=list)
    services: list[Service] = field(default_factory=list)
    other_readers: list[Guid] = field(default_factory=list)  # of the services for Fast DDS
    other_writers: list[Guid] = field(default_factory=list)

    @property
    def full_name(self) -> str:
        """With its namespace: /robot1/laconic."""
        return topic_name("", self.namespace, self.name)

    def publisher(self, topic: str, message: str, quality: Quality = USUAL) -> Any:
        """A DataWriter."""
        wire_name = topic_name("rt", self.namespace, topic)
        self.writers.append(self.participant._endpoint(DataWriter, wire_name, message, quality))
        return self.writers[-1]

    def subscription(self, topic: str, message: str, quality: Quality = USUAL) -> Any:
        """A DataReader, for `polled`."""
        wire_name = topic_name("rt", self.namespace, topic)
        self.readers.append(self.participant._endpoint(DataReader, wire_name, message, quality))
        return self.readers[-1]

    def service(self, name: str, kind: str, answer: Callable[[Any], Any]) -> Service:
        """A service of a type such as std_srvs/srv/Empty; `answer` makes the response's values of a request."""
        made = Service(self, name, kind, answer)
        self.services.append(made)
        return made


class Service:
    """Requests in, responses out.

    For rmw_cyclonedds client and number stand before the content. rmw_fastrtps has them in the headers of its packets,
    which cyclonedds does not give to programs, so that `Services` answers both.
    """

    def __init__(self, node: Node, name: str, kind: str, answer: Callable[[Any], Any]):
        self.name, self.answer = name, answer
        self._request, self._response = f"{kind}_Request", f"{kind}_Response"
        participant, pair = node.participant, f"serviceid={os.urandom(8).hex()};"
        topics = topic_name("rq", node.namespace, name, "Request"), topic_name("rr", node.namespace, name, "Reply")
        self.reader = self.writer = None
        self.unreadable = 0
        if participant.others is None:
            make = partial(participant._endpoint, quality=USUAL, of_service=pair)
            self.reader = make(DataReader, topics[0], self._request)
            self.writer = make(DataWriter, topics[1], self._response)
            node.readers.append(self.reader)
            node.writers.append(self.writer)
        self._respond = message_class(self._response, participant.gid_bytes, True)
        if participant.others is not None:
            request, response = ((topic, dds_name(each), pair + participant.hash_of(each))
                                 for topic, each in zip(topics, (self._request, self._response), strict=True))
            reader, writer = participant.others.serve(request, response, self._answered)
            node.other_readers.append(reader)
            node.other_writers.append(writer)

    def _answered(self, request: bytes, has_header: bool) -> bytes | None:
        """The CDR of a response to that of a request; None for one that cannot be read. `has_header`: of cyclonedds."""
        start, whose = (HEADER_BYTES, request[4:HEADER_BYTES]) if has_header else (4, b"")
        try:
            values = self.answer(message_class(self._request).deserialize(request[:4] + request[start:]))
        except Exception:  # whatever cyclonedds raises for bytes that are not this type
            self.unreadable += 1
            return None
        made = bytes(message_class(self._response)(**values).serialize(use_version_2=False))
        return made[:4] + whose + made[4:]

    def poll(self, wrong: Callable[[str], None]) -> int:
        """Answers what has come, and returns how many requests that were."""
        text = f"{self.name}: a request that cannot be read is ignored"
        for _ in range(self.unreadable):
            wrong(text)
        self.unreadable, count = 0, 0
        for request in polled(self.reader, lambda: wrong(text)) if self.reader is not None else ():
            values = self.answer(request)
            sent(self.writer, self._respond(client=request.client, sequence=request.sequence, **values))
            count += 1
        return count
