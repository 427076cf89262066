"""A serial line over a socket that is read in large chunks.

pyserial's socket:// handler asks the system twice for every byte, which limits python-can's slcan to a few hundred
frames a second; this class replaces it and has the methods that slcan calls.
"""

from __future__ import annotations

import re
import select
import socket
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from can.exceptions import error_check

END_OF_FRAME = re.compile(rb"[\r\a]")  # SLCAN's, and of an answer: OK or an error
ACKNOWLEDGEMENT = "\r"  # of a line that was sent


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

    def read_frame(self, wait_s: float) -> bytes:
        """Up to and with the end of a frame, or what there is of it; none when none come within so many seconds."""
        if self._at >= len(self._buffer):
            self._fill(wait_s)
        start, end = self._at, END_OF_FRAME.search(self._buffer, self._at)
        self._at = end.end() if end else len(self._buffer)
        return self._buffer[start : self._at]

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
        bus._read = frame_reader(bus.serialPortOrig, bus._buffer)


def frame_reader(line: SocketLine, begun: bytearray) -> Callable[[float | None], str | None]:
    """In place of slcan's own reader, which asks for each byte by itself: gives the next frame, None when none comes in
    time. Acknowledgements are passed over. `begun`: slcan's bytes of a frame whose end has not come yet."""
    def read(timeout_s: float | None) -> str | None:
        deadline_s = None if timeout_s is None else time.monotonic() + timeout_s
        with error_check("Could not read from serial device"):
            while True:
                left_s = line.timeout if deadline_s is None else max(deadline_s - time.monotonic(), 0.0)
                part = line.read_frame(min(left_s, line.timeout))
                begun.extend(part)
                if END_OF_FRAME.match(part[-1:]):
                    whole = begun.decode()
                    begun.clear()
                    if whole == ACKNOWLEDGEMENT:  # slcan would take it for the absence of a frame
                        continue
                    return whole
                if deadline_s is not None and time.monotonic() >= deadline_s:
                    return None

    return read
