"""Frames of python-can as the node's C code has them, and back."""

from __future__ import annotations

from typing import Any

import can


class FrameBox:
    """One laconic_frame, used again for every frame that passes."""

    def __init__(self, ffi: Any):
        self.c = ffi.new("laconic_frame *")
        self._bytes = ffi.buffer(self.c.data)

    def fill(self, identifier: int, data: bytes | bytearray, *, fd: bool = False, extended: bool = False,
             remote: bool = False, bit_rate_switch: bool = False) -> Any:
        """The frame with these contents."""
        frame = self.c
        frame.id, frame.length = identifier, len(data)
        frame.extended, frame.remote, frame.fd, frame.bit_rate_switch = extended, remote, fd, bit_rate_switch
        self._bytes[: len(data)] = data
        return frame

    def put(self, message: can.Message) -> Any:
        """The frame from a message; that of a remote frame has its length without data."""
        frame = self.fill(message.arbitration_id, message.data or b"", fd=message.is_fd,
                          extended=message.is_extended_id, remote=message.is_remote_frame,
                          bit_rate_switch=message.bitrate_switch)
        if message.is_remote_frame:
            frame.length = message.dlc
        return frame

    @property
    def data(self) -> bytes:
        """The payload."""
        return bytes(self._bytes[: self.c.length])

    def message(self, timestamp_s: float = 0.0) -> can.Message:
        """The frame as a message."""
        frame = self.c
        remote = bool(frame.remote)
        return can.Message(timestamp=timestamp_s, arbitration_id=frame.id, is_extended_id=bool(frame.extended),
                           is_remote_frame=remote, dlc=frame.length, data=None if remote else self.data,
                           is_fd=bool(frame.fd), bitrate_switch=bool(frame.bit_rate_switch))
