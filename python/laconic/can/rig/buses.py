"""Ways to a node: a bus of python-can, a node in this process in virtual time, a node in a process of its own."""

from __future__ import annotations

import logging
import re
import subprocess
import time
import traceback
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any

import can

from laconic.base.paths import built
from laconic.can.rig.client import NodeClient
from laconic.can.rig.errors import CannotReach, in_words
from laconic.can.rig.faulty import deaf_to_itself
from laconic.can.rig.link import Clock, Link
from laconic.can.rig.node_library import LibraryNode
from laconic.can.rig.socket_line import read_in_chunks
from laconic.can.rig.wire import ID_BASE
from laconic.errors import BadInput, shown

LARGEST_PORT = 65535


def open_bus(interface: str, channel: str | None, *, bitrate: int | None = None, **options: Any) -> can.BusABC:
    """A python-can bus; CannotReach names the interface, the channel and a remedy."""
    is_socket = str(channel).startswith("socket://")
    port = re.fullmatch(r"socket://[^/]+:(\d{1,9})(\D.*)?", str(channel))
    if is_socket and not (port and 0 < int(port[1]) <= LARGEST_PORT):
        raise BadInput(f"--channel {channel}: names no port; give socket://HOST:PORT, PORT from 1 to {LARGEST_PORT}")
    if interface == "slcan" and is_socket:
        options.setdefault("sleep_after_open", 0.02)
    if bitrate is not None:
        options["bitrate"] = bitrate
    try:
        bus = deaf_to_itself(can.Bus(interface=interface, channel=channel, **options))
    except can.CanInterfaceNotImplementedError:
        raise BadInput(f"--interface {interface}: is not there, or its driver is not installed; python-can has "
                       f"{', '.join(sorted(can.VALID_INTERFACES))}") from None
    except (can.CanError, OSError, ValueError, TypeError) as error:
        let_go(error)
        if channel is None:
            raise BadInput(f"--interface {interface}: cannot be opened without --channel; give can0, /dev/ttyACM0, "
                           "socket://127.0.0.1:PORT or another one") from None
        if not isinstance(error, (can.CanError, OSError)):
            raise CannotReach(f"--interface {interface} --channel {channel}: cannot open the bus by these settings; "
                              "check --channel, --bitrate and --bus-option") from None
        raise CannotReach(f"--interface {interface} --channel {channel}: cannot open the bus ({in_words(error)}); "
                          "check that the node or adapter is there and no other program uses it") from None
    read_in_chunks(bus)
    return bus


def let_go(error: Exception) -> None:
    """Ends a bus that was not opened to its end, here and without python-can's word that nobody has shut it down."""
    log = logging.getLogger("can.bus")
    was, log.disabled = log.disabled, True
    try:
        traceback.clear_frames(error.__traceback__)
    finally:
        log.disabled = was


class PairedBus(can.BusABC):
    """One of the two ends of a bus within this process, both used by one thread: what it sends waits at the other.

    python-can's virtual bus copies each frame deeply, and locks a queue for each look at it.
    """

    channel_info = "paired bus"

    def __init__(self) -> None:
        super().__init__(channel=self.channel_info)
        self._arrived: deque[can.Message] = deque()
        self._other = self

    def join(self, other: PairedBus) -> None:
        """From now on they are two ends of the same bus."""
        self._other, other._other = other, self

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """The frame is at the other end at once; neither end changes it."""
        if self._is_shutdown:
            raise can.CanOperationError("this end of the bus was shut down")
        self._other._arrived.append(msg)

    def recv(self, timeout: float | None = None) -> can.Message | None:
        """The next frame; None where none waits, whatever the timeout: no other thread could send one meanwhile."""
        return self._arrived.popleft() if self._arrived else None


@contextmanager
def paired_buses() -> Iterator[tuple[PairedBus, PairedBus]]:
    """Both ends of one bus."""
    with PairedBus() as near, PairedBus() as far:
        near.join(far)
        yield near, far


class VirtualClock(Clock):
    """A clock that advances only while the rig waits."""

    def __init__(self) -> None:
        self.time_us = 0

    def now_us(self) -> int:
        return self.time_us

    def calendar_s(self) -> float:
        """Virtual time begins in 1970, so that a log has the same bytes each time."""
        return 0.0

    def pass_time(self, microseconds: int) -> None:
        self.time_us += microseconds


class NodeOnBus:
    """A node in this process at the other end of a bus; `pump` gives it the frames received and sends its answers."""

    def __init__(self, node: LibraryNode, bus: can.BusABC, clock: Clock):
        self.node, self.bus, self.clock = node, bus, clock

    def pump(self) -> bool:
        """True iff anything happened; else time moves on to the node's next event."""
        node, bus, now = self.node, self.bus, self.clock.now_us()
        busy = False
        while (message := bus.recv(0)) is not None:
            self.deliver(message)
            busy = self.send_all() or busy
        node.tick(now)
        busy = self.send_all() or busy
        if not busy:
            self.clock.pass_time(max(1, min(node.idle_us(now), 1000)))
        return busy

    def deliver(self, message: can.Message) -> None:
        """A frame reaches the node."""
        now = self.clock.now_us()
        self.node.give(message, now)
        self.node.tick(now)

    def sent_frame(self, message: can.Message) -> None:
        """A frame leaves the node; its time, which other interfaces give, marks it as received."""
        message.timestamp = time.time()
        self.bus.send(message)

    def send_all(self) -> bool:
        """Sends the frames of the node; whether there was one."""
        sent = False
        while (message := self.node.take_message()) is not None:
            self.sent_frame(message)
            sent = True
        return sent


@contextmanager
def node_in_process(real: str = "double", id_base: int = ID_BASE, clock: Clock | None = None,
                    **node_options: Any) -> Iterator[tuple[NodeClient, NodeOnBus]]:
    """A node in this process, in virtual time unless there is a clock; with its end."""
    clock = clock or VirtualClock()
    with paired_buses() as (ours, its):
        end = NodeOnBus(LibraryNode(real, id_base, now_us=clock.now_us(), **node_options), its, clock)
        yield NodeClient(Link(ours, id_base, clock=clock, pump=end.pump)), end


@contextmanager
def virtual_node(real: str = "double", id_base: int = ID_BASE, **node_options: Any) -> Iterator[NodeClient]:
    """A node in this process, in virtual time."""
    with node_in_process(real, id_base, **node_options) as (client, _):
        yield client


@contextmanager
def node_process(real: str = "double", id_base: int = ID_BASE, *arguments: str,
                 last_words: list[str] | None = None) -> Iterator[int]:
    """A node in a process of its own; yields its TCP port. `last_words` gets what it prints at its end.

    It also ends with this process, however that ends: it reads a pipe whose other end is here.
    """
    program = built(f"bin/laconic-node-{real}")
    command = [str(program), "--id-base", hex(id_base), "--with-parent", *arguments]
    # in another session: Ctrl-C goes to the rig only, which brings the node to rest before it ends it
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
                          start_new_session=True) as process:
        try:
            line = process.stdout.readline() if process.stdout else ""
            found = re.search(r":(\d+)", line)
            if not found:
                raise CannotReach(f"{program}: did not start (its output: {shown(line.strip())})")
            yield int(found.group(1))
        finally:
            process.terminate()
            if last_words is not None and process.stdout is not None:
                last_words.append(process.stdout.read())


@contextmanager
def connected(interface: str, channel: str | None, id_base: int = ID_BASE, *, key: bytes | None = None,
              **options: Any) -> Iterator[NodeClient]:
    """A client on a bus that python-can opens; with a key, of a node that takes commands with codes alone."""
    bus = open_bus(interface, channel, **options)
    try:
        yield NodeClient(Link(bus, id_base, key=key))
    finally:
        with suppress(can.CanError, OSError):
            bus.shutdown()


@contextmanager
def process_node(real: str = "double", id_base: int = ID_BASE) -> Iterator[NodeClient]:
    """A node in a process of its own, over SLCAN on a TCP socket."""
    with node_process(real, id_base) as port, connected("slcan", f"socket://127.0.0.1:{port}", id_base) as client:
        yield client
