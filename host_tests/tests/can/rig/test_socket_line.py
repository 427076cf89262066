"""A serial line over a socket: frames come one by one, however the bytes are cut."""

from __future__ import annotations

import socket
from collections.abc import Iterator

import can
import pytest

from laconic.can.rig.socket_line import SocketLine, frame_reader

Ends = tuple[SocketLine, socket.socket]


@pytest.fixture
def ends() -> Iterator[Ends]:
    with socket.create_server(("127.0.0.1", 0)) as server, \
            socket.create_connection(server.getsockname()) as near, server.accept()[0] as far:
        yield SocketLine(near, 1.0, lambda: None), far


def test_frames_of_one_chunk_come_one_by_one_and_one_that_is_cut_comes_whole(ends: Ends) -> None:
    line, far = ends
    read = frame_reader(line, bytearray())
    far.sendall(b"t1232AABB\rt1")
    assert read(1.0) == "t1232AABB\r"
    far.sendall(b"241CC\r\at1250\r")
    assert [read(1.0) for _ in range(3)] == ["t1241CC\r", "\a", "t1250\r"]


def test_a_look_without_waiting_waits_for_no_frame_that_may_come(ends: Ends) -> None:
    line, far = ends
    line.timeout = 3600.0
    read = frame_reader(line, bytearray())
    assert read(0.0) is None  # a bus of many frames would keep a loop of such looks for ever
    far.sendall(b"t1250\r")
    assert read(1.0) == "t1250\r" and read(0.0) is None


def test_frames_behind_acknowledgements_come_at_the_first_look(ends: Ends) -> None:
    line, far = ends
    read = frame_reader(line, bytearray())
    far.sendall(b"\r\rt1250\r\rt1260\r\r")
    assert read(1.0) == "t1250\r"
    assert [read(0.0), read(0.0)] == ["t1260\r", None]


def test_a_flush_forgets_the_beginning_of_a_frame(ends: Ends) -> None:
    line, far = ends
    begun = bytearray()
    read = frame_reader(line, begun)
    line.timeout = 0.001
    far.sendall(b"t12")
    assert read(1.0 / 64) is None and begun == b"t12"
    begun.clear()  # as slcan's flush does
    far.sendall(b"t1250\r")
    assert read(1.0) == "t1250\r"


def test_the_end_of_the_connection_is_an_error_of_the_bus(ends: Ends) -> None:
    line, far = ends
    far.sendall(b"\aout of order")
    far.close()
    read = frame_reader(line, bytearray())
    assert read(1.0) == "\a"
    with pytest.raises(can.CanOperationError):
        [read(1.0) for _ in range(2)]
