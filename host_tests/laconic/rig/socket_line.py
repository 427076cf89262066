"""A serial line over a socket that is read in large chunks.

pyserial's socket:// handler asks the system twice for every byte, which limits python-can's slcan to a few hundred
frames a second; this class replaces it and has the methods that slcan calls.
"""

from __future__ import annotations

import select
import socket
from collections.abc import Callable
from contextlib import suppress
from typing import Any


class SocketLine:
    """A serial port with the methods that slcan calls."""

    def __init__(self, line: socket.socket, timeout_s: float, forget: Callable[[], None]):
        self._socket, self.timeout, self._forget = line, timeout_s, forget
        self.write_timeout: float | None = None
        self._buffer, self._at = b"", 0
        line.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        line.setblocking(True)

    @property
    def in_waiting(self) -> int:
        """Bytes that can be read at once."""
        if self._at >= len(self._buffer):
            self._fill(0.0)
        return len(self._buffer) - self._at

    def _fill(self, timeout_s: float) -> None:
        if select.select([self._socket], [], [], timeout_s)[0]:
            before, self._buffer, self._at = self._buffer, self._socket.recv(65536), 0
            if not self._buffer:
                raise OSError(closed_with(before))

    def read(self, size: int = 1) -> bytes:
        """Up to `size` bytes; none when none come within the timeout."""
        if self._at >= len(self._buffer):
            self._fill(self.timeout)
        found = self._buffer[self._at : self._at + size]
        self._at += len(found)
        return found

    def write(self, data: bytes) -> int:
        """Sends all of it."""
        try:
            self._socket.sendall(data)
        except (BrokenPipeError, ConnectionResetError):
            raise OSError(closed_with(self._rest_of_input())) from None
        return len(data)

    def _rest_of_input(self) -> bytes:
        """Bytes received before the other end closed the connection."""
        rest = self._buffer[self._at :]
        with suppress(OSError):
            while select.select([self._socket], [], [], 0.0)[0] and (more := self._socket.recv(65536)):
                rest += more
        return rest

    def flush(self) -> None:
        """Does nothing: write() keeps nothing back."""

    def reset_input_buffer(self) -> None:
        """Discards the bytes received."""
        while self.in_waiting:
            self._at = len(self._buffer)

    def fileno(self) -> int:
        """For select."""
        return self._socket.fileno()

    def close(self) -> None:
        """Ends the connection, at once: pyserial's own close sleeps for 0.3 s."""
        self._forget()
        self._socket.close()


def closed_with(last: bytes) -> str:
    """Message for a closed connection; text after a BELL, the error sign of SLCAN, gives the reason."""
    _, bell, words = last.rpartition(b"\a")
    text = words.strip().decode("ascii", "replace") if bell else ""
    return "the other end has closed the connection" + (f" because: {text}" if text else "")


def read_in_chunks(bus: Any) -> None:
    """Puts a SocketLine under an slcan bus that runs over a socket; leaves any other bus alone."""
    port: Any = getattr(bus, "serialPortOrig", None)
    line = getattr(port, "_socket", None)
    if isinstance(line, socket.socket):

        def forget() -> None:
            port._socket, port.is_open = None, False

        bus.serialPortOrig = SocketLine(line, port.timeout or 0.001, forget)
