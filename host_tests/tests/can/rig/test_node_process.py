"""The node as a process: its help, and a client that finds another one on the line."""

from __future__ import annotations

import socket
import subprocess
import threading
from contextlib import suppress

import pytest

from laconic.base.paths import built
from laconic.can.rig.buses import connected, node_process
from laconic.can.rig.wire import ID_BASE
from laconic.cli.main import run
from laconic.scene import read_scene


@pytest.mark.parametrize("real", ["double", "single"])
@pytest.mark.parametrize("flag", ["--help", "-h"])
def test_the_node_reports_how_it_is_started(real: str, flag: str) -> None:
    ran = subprocess.run([built(f"bin/laconic-node-{real}"), "--port", "x", flag], capture_output=True, text=True)
    assert ran.returncode == 0 and ran.stderr == ""
    assert all(word in ran.stdout for word in ("usage:", "--port", "--id-base", "--bitrate", "--once", "laconic rig"))


def test_a_wrong_option_of_the_node_is_one_line_that_names_it() -> None:
    ran = subprocess.run([built("bin/laconic-node-double"), "--prot", "1"], capture_output=True, text=True)
    assert ran.returncode == 2 and ran.stderr.count("\n") == 1 and "--prot" in ran.stderr and "--help" in ran.stderr


def test_a_second_client_learns_that_the_line_is_occupied_and_the_first_is_not_disturbed() -> None:
    with node_process() as port, socket.create_connection(("127.0.0.1", port)) as first:
        first.sendall(b"V\r")
        assert first.recv(16) == b"V1010\r"
        with socket.create_connection(("127.0.0.1", port), timeout=10.0) as second, second.makefile("rb") as line:
            assert line.read(9) == b"\aoccupied"  # at once, for a person
            second.sendall(b"O\r")
            assert line.read().count(b"\aoccupied") == 1  # again, for who has flushed the line; then it ends
        first.sendall(b"V\r")
        assert first.recv(16) == b"V1010\r"


def test_a_rig_that_is_the_second_client_names_why_it_cannot_reach_the_node(capsys: pytest.CaptureFixture[str]) -> None:
    with node_process() as port, socket.create_connection(("127.0.0.1", port)) as first:
        first.sendall(b"V\r")
        first.recv(16)
        assert run(["rig", "s1", "--interface", "slcan", "--channel", f"socket://127.0.0.1:{port}"]) == 2
        error = capsys.readouterr().err
        assert error.count("\n") == 1 and "occupied" in error


def test_a_client_that_floods_a_shared_port_keeps_nobody_from_the_node() -> None:
    with node_process("double", ID_BASE, "--shared") as port, \
            connected("slcan", f"socket://127.0.0.1:{port}") as rig, \
            socket.create_connection(("127.0.0.1", port)) as flooder:
        begun, ended = threading.Event(), threading.Event()

        def flood() -> None:
            with suppress(OSError):
                flooder.sendall(b"S8\rO\r")
                while not ended.is_set():
                    flooder.sendall(10_000 * b"t20080400040004000400\r")
                    begun.set()

        thread = threading.Thread(target=flood, daemon=True)
        thread.start()
        begun.wait(5.0)
        scene = read_scene("turtlebot3_burger")
        rig.open()
        rig.load(scene.plant(scene.core()), scene.c_start(scene.core()))
        assert rig.state == "ready"
        ended.set()
        flooder.shutdown(socket.SHUT_RDWR)
        thread.join(5.0)


def test_a_controller_that_comes_before_the_rig_does_not_keep_it_from_the_node() -> None:
    with node_process("double", ID_BASE, "--shared") as port, \
            socket.create_connection(("127.0.0.1", port)) as first:
        first.sendall(b"S8\rO\rV\r")
        assert first.recv(100)  # it is served
        with connected("slcan", f"socket://127.0.0.1:{port}") as rig:
            assert rig.open().real == "double"
            rig.control("BEGIN")
            first.settimeout(0.3)
            with suppress(TimeoutError):
                while True:
                    assert b"t68B" not in first.recv(4096).partition(b"\r")[2]  # RESULT is for the rig alone
