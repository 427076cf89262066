"""A serial line over a socket: frames come one by one, however the bytes are cut."""

from __future__ import annotations

import errno
import socket
from collections.abc import Iterator
from pathlib import Path

import can
import pytest

from laconic.can.rig.bus_options import read_bus_options
from laconic.can.rig.buses import open_bus
from laconic.can.rig.errors import UNEXPECTED, CannotReach, in_words
from laconic.can.rig.socket_line import SocketLine, frame_reader
from laconic.cli.main import run
from laconic.errors import BadInput

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


# ---- No station of a bus hears itself, on whatever interface.

GROUP, PORT = "239.74.163.9", 43219


def frame(number: int) -> can.Message:
    """One frame like another, but for its identifier."""
    return can.Message(arbitration_id=number, is_extended_id=False, data=b"\1\2")


@pytest.fixture(params=["udp_multicast", "faulty"])
def interface(request: pytest.FixtureRequest) -> str:
    """The network itself, and faults over it."""
    return str(request.param)


def station(interface: str) -> can.BusABC:
    """One more on the network."""
    more = {"under": "udp_multicast"} if interface == "faulty" else {}
    try:
        return open_bus(interface, GROUP, port=PORT, **more)
    except CannotReach as error:
        pytest.skip(f"this machine has no multicast: {error}")


def test_a_station_of_a_network_hears_the_others_and_never_itself(interface: str) -> None:
    with station(interface) as one, station("udp_multicast") as other, \
            can.Bus(interface="udp_multicast", channel=GROUP, port=PORT) as stranger:
        one.send(frame(0x101))
        one.send(frame(0x102))
        other.send(frame(0x101))       # the same frame from somebody else is heard
        stranger.send(frame(0x103))    # from the port that all share
        heard = [one.recv(1.0).arbitration_id for _ in range(2)]
        assert heard == [0x101, 0x103] and one.recv(0.0) is None
        assert [other.recv(1.0).arbitration_id for _ in range(3)] == [0x101, 0x102, 0x103]
        assert [stranger.recv(1.0).arbitration_id for _ in range(3)] == [0x101, 0x102, 0x101]


def test_an_option_that_makes_a_bus_hear_itself_is_refused() -> None:
    with pytest.raises(BadInput, match="receive_own_messages=true: would take frames of its own"):
        read_bus_options(["receive_own_messages=true"], "socketcan")


# ---- What the user reads when a bus cannot be opened or dies: the system's reason or the driver's, nothing of
# Python's.

def caused(error: Exception, cause: Exception) -> Exception:
    error.__cause__ = cause
    return error


WORDS = {
    "the system's": (OSError(errno.ECONNREFUSED, "[Errno 111] Connection refused"), "connection refused"),
    "a text with the system's number": (OSError("could not open port x: [Errno 2] No such file"),
                                        "no such file or directory"),
    "a driver's": (can.CanOperationError("the adapter was unplugged"), "the adapter was unplugged"),
    "a driver's with the system's behind it": (
        caused(can.CanInitializationError("could not open"), PermissionError(errno.EACCES, "x")), "permission denied"),
    "a number that is none": (ValueError("invalid literal for int() with base 10: 'x'"), UNEXPECTED),
    "too few values": (IndexError("list index out of range"), UNEXPECTED),
}


@pytest.mark.parametrize(("error", "words"), WORDS.values(), ids=WORDS)
def test_an_error_of_a_bus_is_told_in_the_systems_or_the_drivers_words(error: Exception, words: str) -> None:
    assert in_words(error) == words


REFUSED = {
    "no such port": (["--interface", "slcan", "--channel", "/dev/no-such-port"], "(no such file or directory)"),
    "nobody listens": (["--interface", "slcan", "--channel", "socket://127.0.0.1:1"], "(connection refused)"),
    "no such interface": (["--interface", "quux", "--channel", "1"], "--interface quux: is not there, or its driver"),
    "settings that it does not accept": (["--interface", "serial", "--channel", "loop://", "--bitrate", "500000",
                                          "--bus-option", "timeout=x"], "--channel loop://: cannot open the bus"),
}


@pytest.mark.parametrize(("options", "words"), REFUSED.values(), ids=REFUSED)
def test_a_bus_that_cannot_be_opened_is_one_line_without_pythons_words(
        options: list[str], words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["rig", "s1", *options]) == 2
    error = capsys.readouterr().err
    assert words in error and error.count("\n") == 1
    assert not any(each in error for each in ("Errno", "Error Code", "invalid literal", "argument"))


@pytest.mark.parametrize(("data", "words"), [(None, "cannot be read (is a directory)"), (b"\xff\xfe", "holds no key"),
                                             (b"12", "holds no key")])
def test_a_key_that_cannot_be_read_is_one_line(data: bytes | None, words: str, tmp_path: Path,
                                               capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path if data is None else tmp_path / "key"
    if data is not None:
        path.write_bytes(data)
    assert run(["rig", "s1", "--interface", "slcan", "--channel", "socket://127.0.0.1:1", "--key", str(path)]) == 2
    error = capsys.readouterr().err
    assert f"--key {path}: {words}" in error and "codec" not in error and error.count("\n") == 1
