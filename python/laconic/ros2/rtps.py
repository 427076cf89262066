"""Services for clients on Fast DDS and on cyclonedds, by a small RTPS participant of their own.

The former know a response by an identity in the header of its packet: the request's writer and number. cyclonedds
neither shows nor sets it, so these services speak RTPS 2.3 themselves: discovery, and reliable readers and writers.
Requests and responses are whole packets, below 64 KB. Everything is polled.
"""

from __future__ import annotations

import os
import socket
import struct
import time
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from laconic.ros2.packets import (
    ACKNACK,
    ALL_ENDPOINTS,
    DATA,
    GAP,
    HEARTBEAT,
    HERE,
    OF_CYCLONE,
    PORTS,
    PUBLICATIONS,
    SPDP,
    SUBSCRIPTIONS,
    Submessage,
    acknack,
    data,
    gap,
    heartbeat,
    identity_parameters,
    locator,
    number_bytes,
    number_of,
    packet,
    packets_of,
    parameters,
    parameters_of,
    text_parameter,
)

GROUP = "239.255.0.1"
ANNOUNCE_S = 1.0
LEASE_S = 20
REPEAT_S = 0.1            # between heartbeats for what is not acknowledged
MOST_KEPT = 64            # responses of one service, for clients that have lost one
MOST_PACKETS = 256        # in one poll
MOST_PARTICIPANTS = 33    # on this machine alone, as cyclonedds looks for them
MOST_PEERS, MOST_AHEAD = 1000, 4096
VERSIONS = ((0x0015, b"\2\3\0\0"), (0x0016, HERE + b"\0\0"))  # of the protocol, and whose it is


def reader_of(writer: bytes) -> bytes:
    """The reader of a built-in topic, by its writer."""
    return writer[:3] + b"\xc7"


@dataclass
class Peer:
    """Another participant."""

    meta: list[tuple[str, int]]
    user: list[tuple[str, int]]
    vendor: bytes
    until_s: float


@dataclass
class Incoming:
    """What has come of one remote writer."""

    next: int = 1
    ahead: set[int] = field(default_factory=set)
    count: int = 0

    def is_new(self, number: int) -> bool:
        """Takes one in."""
        if number < self.next or number in self.ahead or number > self.next + MOST_AHEAD:
            return False
        self.ahead.add(number)
        self._close_up()
        return True

    def skip(self, until: int) -> None:
        """What lies before a number does not come any more."""
        self.next = max(self.next, until)
        self.ahead = {each for each in self.ahead if each >= self.next}
        self._close_up()

    def _close_up(self) -> None:
        while self.next in self.ahead:
            self.ahead.remove(self.next)
            self.next += 1


@dataclass
class Outgoing:
    """One of our writers: what it keeps, and how far each remote reader has acknowledged."""

    entity: bytes
    kept: deque[tuple[int, bytes]]
    last: int = 0
    count: int = 0
    readers: dict[bytes, int] = field(default_factory=dict)  # by their GUIDs: the next number that each awaits

    def add(self, submessage: Callable[[int], bytes]) -> bytes:
        """Keeps another change."""
        self.last += 1
        made = submessage(self.last)
        self.kept.append((self.last, made))
        return made

    def heartbeat(self, reader: bytes) -> bytes:
        """For one reader."""
        self.count += 1
        first = self.kept[0][0] if self.kept else self.last + 1
        return heartbeat(reader[12:], self.entity, first, self.last, self.count)


@dataclass(frozen=True)
class Guid:
    """Of an endpoint, as entities of cyclonedds have it."""

    bytes: bytes


@dataclass
class Server:
    """One service: its request reader and its response writer."""

    request_topic: str
    response_topic: str
    answer: Callable[[bytes, bool], bytes | None]  # as Service._answered of laconic.ros2.wire
    reader: bytes = b""
    writer: Outgoing = field(default_factory=lambda: Outgoing(b"", deque(maxlen=MOST_KEPT)))


class Services:
    """The participant. `serve` adds services, `start` announces them, `poll` answers."""

    def __init__(self, domain: int, *, is_local: bool, now_s: Callable[[], float] = time.monotonic):
        self.domain, self.is_local, self._now_s = domain, is_local, now_s
        self._base = PORTS.base + PORTS.domain * domain
        self.prefix = HERE + os.urandom(10)
        self.servers: list[Server] = []
        self.peers: dict[bytes, Peer] = {}
        self._incoming: dict[bytes, Incoming] = {}
        self._matched: dict[bytes, set[bytes]] = {}  # by our request readers: the writers of clients
        self._builtin = {entity: Outgoing(entity, deque()) for entity in (PUBLICATIONS, SUBSCRIPTIONS)}
        self._next_s = self._repeat_s = -1.0
        self._meta_port = self._user_port = 0
        self._sockets = self._bound()
        self._address = "127.0.0.1" if is_local else own_address()

    # ---- sockets

    def _bound(self) -> list[socket.socket]:
        """Metatraffic and user traffic by unicast; without `is_local` also the group."""
        host = "127.0.0.1" if self.is_local else ""
        for index in range(MOST_PARTICIPANTS):
            found: list[socket.socket] = []
            try:
                for offset in (PORTS.meta, PORTS.user):
                    found.append(udp())
                    found[-1].bind((host, self._base + offset + PORTS.participant * index))
                self._meta_port, self._user_port = (each.getsockname()[1] for each in found)
                break
            except OSError:
                for each in found:
                    each.close()
        else:
            raise OSError(f"no port of domain {self.domain} is free")
        if not self.is_local:
            group = udp(is_shared=True)
            try:
                group.bind(("", self._base))
                group.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, socket.inet_aton(GROUP) + bytes(4))
                found.append(group)
            except OSError:
                group.close()
        return found

    def _send(self, targets: list[tuple[str, int]], to: bytes, *submessages: bytes) -> None:
        whole = packet(self.prefix, to, submessages)
        for target in targets:
            try:
                self._sockets[0].sendto(whole, target)
            except OSError:
                continue  # a network that is away; announcements and heartbeats come again

    # ---- endpoints

    def serve(self, request: tuple[str, str, str], response: tuple[str, str, str],
              answer: Callable[[bytes, bool], bytes | None]) -> tuple[Guid, Guid]:
        """Adds a service by topic, type and user data of both; returns GUIDs of reader and writer."""
        number = len(self.servers) + 1
        made = Server(request[0], response[0], answer)
        made.reader = struct.pack(">I", number << 8 | 0x04)
        made.writer.entity = struct.pack(">I", number << 8 | 0x03)
        self.servers.append(made)
        for builtin, entity, (topic, kind, user_data) in ((PUBLICATIONS, made.writer.entity, response),
                                                         (SUBSCRIPTIONS, made.reader, request)):
            guid = self.prefix + entity
            content = parameters([
                (0x005A, guid), (0x0070, guid), (0x0050, self.prefix + PORTS.participant_entity),
                (0x0005, text_parameter(topic)), (0x0007, text_parameter(kind)),
                (0x001A, struct.pack("<IiI", 2, 0, 0x19999999)), (0x001D, struct.pack("<I", 0)),
                (0x0040, struct.pack("<Ii", 0, 10)), (0x0073, struct.pack("<IhH", 1, 0, 0)),
                (0x002C, text_parameter(user_data, ends=False)), *VERSIONS])
            self._builtin[builtin].add(lambda number, builtin=builtin, content=content: data(  # type: ignore[misc]
                bytes(4), builtin, number, content))
        return Guid(self.prefix + made.reader), Guid(self.prefix + made.writer.entity)

    def _announcement(self, is_leaving: bool = False) -> bytes:
        guid = self.prefix + PORTS.participant_entity
        where = [(0x0032, locator(self._address, self._meta_port)), (0x0031, locator(self._address, self._user_port))]
        content = parameters([
            *VERSIONS, (0x0050, guid), (0x000F, struct.pack("<I", self.domain)),
            *where, (0x0002, struct.pack("<iI", LEASE_S, 0)), (0x0058, struct.pack("<I", ALL_ENDPOINTS)),
            (0x002C, text_parameter("enclave=/;", ends=False))])
        if is_leaving:
            return data(bytes(4), SPDP, 2, parameters([(0x0050, guid)]), status=3, is_key=True, key=guid)
        return data(bytes(4), SPDP, 1, content)

    def _everybody(self) -> list[tuple[str, int]]:
        if not self.is_local:
            return [(GROUP, self._base)]
        ports = [self._base + PORTS.meta + PORTS.participant * index for index in range(MOST_PARTICIPANTS)]
        return [("127.0.0.1", port) for port in ports if port != self._meta_port]

    # ---- the loop

    def poll(self) -> int:
        """Takes what has come, answers, and repeats what was lost; returns how many requests were answered."""
        answered = 0
        for whole in self._received():
            try:
                for submessage in packets_of(whole):
                    answered += self._take(submessage)
            except (struct.error, ValueError, IndexError):
                continue  # not RTPS, or cut
        now_s = self._now_s()
        if now_s >= self._next_s:
            self._next_s = now_s + ANNOUNCE_S
            self._send(self._everybody(), b"", self._announcement())
            for prefix in [prefix for prefix, peer in self.peers.items() if peer.until_s < now_s]:
                self._forget(prefix)
        if now_s >= self._repeat_s:
            self._repeat_s = now_s + REPEAT_S
            self._remind()
        return answered

    def _received(self) -> Iterator[bytes]:
        for each in self._sockets:
            for _ in range(MOST_PACKETS):
                try:
                    yield each.recv(65536)
                except OSError:
                    break

    def _remind(self) -> None:
        for prefix, peer in self.peers.items():
            waiting = [writer.heartbeat(reader) for writer in self._writers() for reader, awaited
                       in writer.readers.items() if reader[:12] == prefix and awaited <= writer.last]
            for at in range(0, len(waiting), 32):
                self._send(peer.meta, prefix, *waiting[at : at + 32])

    def _writers(self) -> Iterator[Outgoing]:
        yield from self._builtin.values()
        for server in self.servers:
            yield server.writer

    def _take(self, each: Submessage) -> int:
        """One submessage of another participant; 1 where it was a request that is answered."""
        if each.prefix == self.prefix or each.to not in (bytes(12), self.prefix):
            return 0
        if each.kind == DATA:
            return self._data(each)
        if each.prefix not in self.peers:
            return 0
        if each.kind == HEARTBEAT:
            self._heartbeat(each)
        elif each.kind == ACKNACK:
            self._acknack(each)
        elif each.kind == GAP and (state := self._incoming.get(each.prefix + each.writer)) is not None:
            if each.first <= state.next:
                state.skip(each.last)
            for number in range(max(each.first, state.next), min(each.last, state.next + MOST_AHEAD)):
                state.is_new(number)
            for number in each.numbers:
                state.is_new(number)
        return 0

    # ---- discovery

    def _data(self, each: Submessage) -> int:
        if each.writer == SPDP:
            self._met(each)
            return 0
        if each.prefix not in self.peers:
            return 0
        builtin = each.writer in self._builtin
        servers = [server for server in self.servers if server.reader == each.reader] if each.reader != bytes(4) else \
            [server for server in self.servers if each.prefix + each.writer in self._matched.get(server.reader, ())]
        if not builtin and not servers:
            return 0
        state = self._incoming.setdefault(each.prefix + each.writer, Incoming())
        if not state.is_new(each.first):
            return 0
        if builtin:
            self._found(each)
            return 0
        return sum(self._answered(server, each) for server in servers)

    def _met(self, each: Submessage) -> None:
        """Another participant announces itself, or leaves."""
        if each.status & 3:
            self._forget(each.prefix)
            return
        found = parameters_of(each.payload)
        meta, user = ([locator_at for pid, value in found if pid == wanted and (locator_at := address_of(value))]
                      for wanted in (0x0032, 0x0031))
        domains = [number_of(value) for pid, value in found if pid == 0x000F]
        if not meta or (domains and domains[0] != self.domain) or len(self.peers) >= MOST_PEERS:
            return
        lease_s = next((number_of(value) for pid, value in found if pid == 0x0002), 100)
        is_new = each.prefix not in self.peers
        self.peers[each.prefix] = Peer(meta, user or meta, each.vendor, self._now_s() + max(lease_s, 1))
        if is_new:
            for builtin, writer in self._builtin.items():
                reader = each.prefix + reader_of(builtin)
                writer.readers[reader] = 1
                self._send(meta, each.prefix, *[made for _, made in writer.kept][:16], writer.heartbeat(reader))
                self._send(meta, each.prefix, acknack(builtin, reader_of(builtin), 1, (), 1))
            self._send(meta, each.prefix, self._announcement())

    def _forget(self, prefix: bytes) -> None:
        self.peers.pop(prefix, None)
        for writer in self._writers():
            writer.readers = {reader: last for reader, last in writer.readers.items() if reader[:12] != prefix}
        self._incoming = {guid: state for guid, state in self._incoming.items() if guid[:12] != prefix}
        for writers in self._matched.values():
            writers.difference_update([guid for guid in writers if guid[:12] == prefix])

    def _found(self, each: Submessage) -> None:
        """Another endpoint is announced, or goes."""
        found = dict(parameters_of(each.payload))
        guid, topic = found.get(0x005A, b"")[:16], found.get(0x0005, b"")[4:].split(b"\0")[0].decode(errors="replace")
        for server in self.servers if guid[:12] == each.prefix else ():
            if each.writer == SUBSCRIPTIONS:
                if each.status & 3:
                    server.writer.readers.pop(guid, None)
                elif topic == server.response_topic and guid not in server.writer.readers:
                    server.writer.readers[guid] = server.writer.last + 1
                    self._send(self.peers[each.prefix].meta, each.prefix, server.writer.heartbeat(guid))
            elif each.status & 3:
                self._matched.setdefault(server.reader, set()).discard(guid)
            elif topic == server.request_topic:
                self._matched.setdefault(server.reader, set()).add(guid)
                self._send(self.peers[each.prefix].user, each.prefix, acknack(guid[12:], server.reader, 1, (), 1))

    # ---- reliability

    def _heartbeat(self, each: Submessage) -> None:
        guid = each.prefix + each.writer
        readers = [reader_of(each.writer)] if each.writer in self._builtin else [
            server.reader for server in self.servers if guid in self._matched.get(server.reader, ())]
        if not readers:
            return
        state = self._incoming.setdefault(guid, Incoming())
        state.skip(each.first)
        missing = [number for number in range(state.next, min(each.last, state.next + 255) + 1)
                   if number not in state.ahead]
        if missing or not each.is_final:
            state.count += 1
            self._send(self._addresses_of(each.prefix, each.writer), each.prefix,
                       *(acknack(each.writer, reader, state.next, missing, state.count) for reader in readers))

    def _addresses_of(self, prefix: bytes, writer: bytes) -> list[tuple[str, int]]:
        """Where a peer awaits what concerns a writer, its own or ours."""
        peer = self.peers[prefix]
        return peer.meta if writer in self._builtin else peer.user

    def _acknack(self, each: Submessage) -> None:
        guid = each.prefix + each.reader
        for writer in self._writers():
            if writer.entity == each.writer and guid in writer.readers:
                writer.readers[guid] = max(writer.readers[guid], each.first)
                kept = dict(writer.kept)
                again = [kept[number] for number in each.numbers if number in kept]
                gone = [number for number in each.numbers if number not in kept]
                again += [gap(each.reader, writer.entity, gone[0], gone[-1] + 1)] if gone else []
                addresses = self._addresses_of(each.prefix, writer.entity)
                for at in range(0, len(again), 8):
                    self._send(addresses, each.prefix, *again[at : at + 8], writer.heartbeat(guid))

    # ---- requests

    def _answered(self, server: Server, each: Submessage) -> int:
        """Answers a request."""
        response = server.answer(each.payload, self.peers[each.prefix].vendor == OF_CYCLONE)
        if response is None:
            return 0
        client = each.related[:16] if each.related[:16].strip(b"\0") else each.prefix + each.writer
        identity = client + number_bytes(each.first)
        made = server.writer.add(lambda number: data(bytes(4), server.writer.entity, number, response,
                                                     inline=identity_parameters(identity)))
        for reader in server.writer.readers:
            self._send(self.peers[reader[:12]].user, reader[:12], made, server.writer.heartbeat(reader))
        return 1

    def close(self) -> None:
        """Leaves the domain, so that peers know at once."""
        gone = self._announcement(is_leaving=True)
        self._send(self._everybody(), b"", gone)
        for prefix, peer in self.peers.items():
            self._send(peer.meta, prefix, gone)
        for each in self._sockets:
            each.close()


def udp(is_shared: bool = False) -> socket.socket:
    """A socket that never waits."""
    made = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    made.setblocking(False)
    if is_shared:
        made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        if hasattr(socket, "SO_REUSEPORT"):
            made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
    return made


def own_address() -> str:
    """The address of this machine from which the group is reached."""
    with udp() as probe:
        try:
            probe.connect((GROUP, PORTS.base))
            return str(probe.getsockname()[0])
        except OSError:
            return "127.0.0.1"


def address_of(value: bytes) -> tuple[str, int] | None:
    """Host and port of a UDP locator; None for another kind."""
    if len(value) < 24 or value[0] != 1 or not 0 < number_of(value[4:8]) < 65536:
        return None
    return socket.inet_ntoa(value[20:24]), number_of(value[4:8])
