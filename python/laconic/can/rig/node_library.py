"""The node's C code as a shared library: protection for the link, and a node in this process."""

from __future__ import annotations

from functools import cache
from typing import Any

import can

from laconic.base.paths import declarations, library
from laconic.can.rig.wire import ID_BASE, FrameBox


class NodeLibrary:
    """The C functions of one scalar type."""

    def __init__(self, real: str):
        self.real, self.ffi = real, declarations("laconic_node_cdef")
        self.lib: Any = self.ffi.dlopen(str(library(f"laconic_node_{real}")))

    def protect_plain(self, offset: int, data: bytearray, counter: int) -> None:
        """Writes counter and CRC into a payload, by the profile alone."""
        self.lib.laconic_protect_plain(offset, self.ffi.from_buffer(data), counter & 255)

    def protect_keyed(self, offset: int, data: bytearray, key: int, count: int) -> None:
        """Writes counter and CRC into a payload, by key and count."""
        self.lib.laconic_protect_keyed(offset, self.ffi.from_buffer(data), key, count & 0xFFFFFFFF)

    def plain_is_right(self, offset: int, data: bytes | bytearray) -> bool:
        """Whether the CRC belongs to the payload, which has the length of its frame."""
        return self.lib.laconic_plain_is_right(offset, self.ffi.from_buffer(data))

    def keyed_is_right(self, offset: int, data: bytes | bytearray, key: int, count: int) -> bool:
        """Whether the CRC belongs to the payload for this key and count."""
        return self.lib.laconic_keyed_is_right(offset, self.ffi.from_buffer(data), key, count & 0xFFFFFFFF)

    def receiver(self) -> Any:
        """A fresh laconic_e2e_receiver."""
        return self.ffi.new("laconic_e2e_receiver *")


@cache
def node_library(real: str = "double") -> NodeLibrary:
    """The library, loaded once."""
    return NodeLibrary(real)


E2E_STATUS = ("ok", "ok some lost", "repeated", "wrong sequence", "error", "no new data")
NODE_STATES = ("empty", "ready", "lockstep", "free run", "timeout", "fault", "drives")


class LibraryNode:
    """A node in this process. It has no clock: the caller passes the time."""

    def __init__(self, real: str = "double", id_base: int = ID_BASE, can_fd: bool = True, nonce_seed: int = 0,
                 now_us: int = 0):
        self.library = node_library(real)
        ffi, lib = self.library.ffi, self.library.lib
        self._memory = ffi.new("uint64_t[]", (lib.laconic_library_node_size() + 7) // 8)
        self.c = ffi.cast("struct laconic_node *", self._memory)
        self.frame = FrameBox(ffi)
        self._view = ffi.new("laconic_library_view *")
        self._view_bytes = ffi.buffer(self._view)
        self._counter_names = dir(self._view.counters)
        self._on_frame, self._on_tick = lib.laconic_node_on_frame, lib.laconic_node_on_tick
        self._next, self._busy = lib.laconic_node_next_frame, lib.laconic_node_is_busy
        self.restart(id_base, can_fd, now_us, nonce_seed)

    def restart(self, id_base: int = ID_BASE, can_fd: bool = True, now_us: int = 0, nonce_seed: int = 0) -> None:
        """Initializes the node as after power-up."""
        if not self.library.lib.laconic_library_node_init(self.c, id_base, can_fd, nonce_seed, now_us & 0xFFFFFFFF):
            raise ValueError(f"ID base 0x{id_base:X} is no multiple of 32 from 0 to 0x7E0")

    def on_frame(self, arbitration_id: int, data: bytes, now_us: int, *, fd: bool = False, extended: bool = False,
                 remote: bool = False) -> None:
        """Gives the node a received frame."""
        frame = self.frame.fill(arbitration_id, data, fd=fd, extended=extended, remote=remote)
        self._on_frame(self.c, frame, now_us & 0xFFFFFFFF)

    def give(self, message: can.Message, now_us: int) -> None:
        """Gives the node a frame of the bus as it is."""
        self._on_frame(self.c, self.frame.put(message), now_us & 0xFFFFFFFF)

    def tick(self, now_us: int) -> None:
        """Takes all steps that are due at this time."""
        self._on_tick(self.c, now_us & 0xFFFFFFFF)
        while self._busy(self.c):
            self._on_tick(self.c, now_us & 0xFFFFFFFF)

    def snapshot(self) -> bytes:
        """What `inspect` reads, as bytes: differs where that differs."""
        self.library.lib.laconic_library_inspect(self.c, self._view)
        return bytes(self._view_bytes)

    def inspect(self) -> dict[str, Any]:
        """State, steps, voltages and counters, for tests."""
        view = self._view
        self.library.lib.laconic_library_inspect(self.c, view)
        counters = {name: getattr(view.counters, name) for name in self._counter_names}
        return {"state": NODE_STATES[view.state], "deaf": view.deaf, "steps": view.steps,
                "voltage_V": list(view.voltage_V), **counters}

    def motion(self) -> Any:
        """Where the vehicle is and how fast: a laconic_library_motion."""
        found = self.library.ffi.new("laconic_library_motion *")
        self.library.lib.laconic_library_motion_of(self.c, found)
        return found

    def idle_us(self, now_us: int) -> int:
        """Microseconds until the node has something to do."""
        return int(self.library.lib.laconic_node_idle_us(self.c, now_us & 0xFFFFFFFF))

    def take_frame(self) -> tuple[int, bytes, bool] | None:
        """The next frame to send: identifier, payload, whether it is FD."""
        if not self._next(self.c, self.frame.c):
            return None
        return self.frame.c.id, self.frame.data, bool(self.frame.c.fd)

    def take_message(self) -> can.Message | None:
        """The next frame to send as a message of the bus."""
        return self.frame.message() if self._next(self.c, self.frame.c) else None
