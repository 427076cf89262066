"""A CAN bus that other processes join over TCP: SLCAN on a port of this machine, by the node's own C code.

    python-can's `slcan` at socket://127.0.0.1:PORT   ⇄   ListeningBus   ⇄   the vehicle

Whoever connects is one more station of the bus: it gets all frames, those of other clients included.
"""

from __future__ import annotations

import selectors
import socket
import time
from collections import deque
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

import can

from laconic.can.rig.node_library import node_library
from laconic.can.rig.wire import FrameBox
from laconic.errors import BadInput, reason_of

LARGEST_PORT = 65535
MOST_CLIENTS = 8
MOST_WAITING = 1 << 12    # bytes that a connection has not taken; then frames for it are lost, as of a full buffer
MOST_IN_KERNEL = 1 << 12  # bytes of it that the system keeps unsent: megabytes else, frames of a minute ago
FRAME, REPLY = 1, 2     # LACONIC_SLCAN_…
NO_FLAGS, BUS_ERROR = b"F00\r", b"F80\r"  # answers to SLCAN's F: bit 7 says that the bus had an error since the last F


class Client:
    """One connection: its SLCAN state and the bytes that wait to be sent."""

    def __init__(self, line: socket.socket):
        self.line = line
        self.library = node_library("double")
        ffi = self.library.ffi
        self._slcan, self._text = ffi.new("laconic_slcan *"), ffi.new("char[160]")
        self._line_bytes = ffi.buffer(self._text)
        self.library.lib.laconic_slcan_init(self._slcan, b"\0")
        self.waiting = bytearray()
        self.lost = 0         # frames that it did not read in time
        self.longest_s = 0.0  # for so long its connection took nothing
        self.has_error = False
        self._stuck_since: float | None = None

    def frames(self, data: bytes, box: FrameBox) -> Iterator[can.Message]:
        """The frames in the bytes received; answers to their lines and to commands wait to be sent."""
        feed = self.library.lib.laconic_slcan_feed
        for byte in data:
            event = feed(self._slcan, bytes((byte,)), box.c)
            if event in (FRAME, REPLY) and len(self.waiting) <= MOST_WAITING:
                self.waiting += self._reply()
            if event == FRAME:
                yield box.message(time.time())

    def _reply(self) -> bytes:
        """An answer to a command; SLCAN has no error frames, but a flag that tells of them once."""
        text = self.library.ffi.string(self._slcan.reply)
        if text != NO_FLAGS or not self.has_error:
            return bytes(text)
        self.has_error = False
        return BUS_ERROR

    def write(self, frame: Any) -> None:
        """One frame more waits to be sent; none while the client has not opened its channel."""
        if len(self.waiting) > MOST_WAITING:
            self.lost += 1
            return
        length = self.library.lib.laconic_slcan_write(self._slcan, frame, self._text)
        self.waiting += self._line_bytes[:length]

    def flush(self) -> None:
        """Sends what the connection takes now."""
        if not self.waiting:
            return
        try:
            del self.waiting[: self.line.send(self.waiting)]
            self._stuck_since = None
        except BlockingIOError:  # it does not read; its bytes wait
            now_s = time.monotonic()
            self._stuck_since = now_s if self._stuck_since is None else self._stuck_since
            self.longest_s = max(self.longest_s, now_s - self._stuck_since)


class ListeningBus(can.BusABC):
    """The bus; `port` is the one that it listens at. Port 0: any free one."""

    def __init__(self, channel: Any = 0, **_: Any):
        self._selector = selectors.SelectSelector()  # waits in microseconds; others round up to milliseconds
        self._listener = listening_socket(int(channel))
        self.port = int(self._listener.getsockname()[1])
        self._selector.register(self._listener, selectors.EVENT_READ)
        self._clients: dict[socket.socket, Client] = {}
        self._arrived: deque[can.Message] = deque()
        self._box = FrameBox(node_library("double").ffi)
        self.joined = 0  # clients so far
        self._left: list[Client] = []
        self.channel_info = f"SLCAN at socket://127.0.0.1:{self.port}"
        super().__init__(channel=channel)

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """To all clients."""
        if msg.is_error_frame:
            for client in self._clients.values():
                client.has_error = True
            return
        self._to_clients(self._box.put(msg))
        self._flush()

    def _to_clients(self, frame: Any, sender: Client | None = None) -> None:
        for client in self._clients.values():
            if client is not sender:
                client.write(frame)

    def _flush(self) -> None:
        for client in list(self._clients.values()):
            try:
                client.flush()
            except OSError:
                self._leaves(client)

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        deadline = None if timeout is None else time.monotonic() + timeout
        while not self._arrived:
            left = None if deadline is None else deadline - time.monotonic()
            for key, _ in self._selector.select(left if left is None or left > 0.0 else 0.0):
                if key.fileobj is self._listener:
                    self._joins()
                else:
                    self._read(self._clients[key.fileobj])  # type: ignore[index]
            self._flush()
            if left is not None and left <= 0.0:
                break
        return (self._arrived.popleft() if self._arrived else None), False

    def _joins(self) -> None:
        try:
            line, _ = self._listener.accept()
        except OSError:
            return  # it has gone again
        if len(self._clients) == MOST_CLIENTS:
            with suppress(OSError):  # it may have gone again
                line.send(b"\aoccupied: this bus has as many clients as it takes\r")
            line.close()
            return
        line.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        if hasattr(socket, "TCP_NOTSENT_LOWAT"):
            line.setsockopt(socket.IPPROTO_TCP, socket.TCP_NOTSENT_LOWAT, MOST_IN_KERNEL)
        line.setblocking(False)
        self._clients[line] = Client(line)
        self.joined += 1
        self._selector.register(line, selectors.EVENT_READ)

    def _read(self, client: Client) -> None:
        try:
            data = client.line.recv(65536)
        except BlockingIOError:
            return
        except OSError:
            data = b""
        if not data:
            self._leaves(client)
            return
        for message in client.frames(data, self._box):
            self._arrived.append(message)
            self._to_clients(self._box.c, client)

    def _leaves(self, client: Client) -> None:
        if self._clients.pop(client.line, None) is not None:
            if client.lost:
                self._left.append(client)
            self._selector.unregister(client.line)
            client.line.close()

    def not_taken(self) -> tuple[int, float]:
        """Frames that clients did not read in time, and the longest time [s] for which one of these read nothing."""
        slow = [each for each in (*self._left, *self._clients.values()) if each.lost]
        return sum(each.lost for each in slow), max((each.longest_s for each in slow), default=0.0)

    def shutdown(self) -> None:
        """Ends all connections and gives the port back."""
        super().shutdown()
        for client in list(self._clients.values()):
            self._leaves(client)
        self._selector.close()
        self._listener.close()


def listening_socket(port: int) -> socket.socket:
    """A socket that listens on this machine alone; BadInput where the port cannot be had."""
    if not 0 <= port <= LARGEST_PORT:
        raise BadInput(f"--listen {port}: no TCP port; give a number from 0 (any free one) to {LARGEST_PORT}")
    listener = socket.socket()
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listener.bind(("127.0.0.1", port))
        listener.listen(MOST_CLIENTS)
    except OSError as error:
        listener.close()
        raise BadInput(f"--listen {port}: cannot listen there ({reason_of(error)}); choose another port, or 0 for any "
                       "free one") from None
    listener.setblocking(False)
    return listener
