"""A node that the rig or play starts ends with it, also where it is killed, and holds no pipe of the caller."""

from __future__ import annotations

import os
import select
import signal
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from laconic.base.paths import built
from laconic.can.rig import with_parent

LONGEST_S = 60.0
NODE = """
import signal, sys
from laconic.can.rig.buses import node_process
with node_process() as port:
    print(port, flush=True)
    signal.pause()
"""
OTHER = """
import os, signal, subprocess, sys
subprocess.Popen([sys.executable, sys.argv[1], str(os.getpid()), sys.executable, "-c",
                  "print('begun', flush=True); import signal; signal.pause()"])
signal.pause()
"""


def killed_while_it_waits(code: str, *arguments: str) -> tuple[str, str]:
    """What a program prints until its child is there; the first and what came after it was killed. The pipe ends only
    when nobody holds it any more, the child included."""
    with subprocess.Popen([sys.executable, "-c", code, *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True) as caller:
        assert caller.stdout is not None
        first = caller.stdout.readline()
        caller.send_signal(signal.SIGKILL)
        rest, _ = caller.communicate(timeout=LONGEST_S)
    return first, rest


def test_a_node_ends_when_the_program_that_started_it_is_killed() -> None:
    port, rest = killed_while_it_waits(NODE)
    assert int(port) > 0 and rest == ""
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.1", int(port)))


@pytest.mark.skipif(sys.platform != "linux", reason="Linux alone sends that signal")
def test_an_emulated_board_ends_when_the_program_that_started_it_is_killed() -> None:
    assert killed_while_it_waits(OTHER, with_parent.__file__) == ("begun\n", "")


@pytest.mark.skipif(sys.platform != "linux", reason="Linux alone sends that signal")
def test_a_board_whose_parent_has_ended_before_does_not_begin() -> None:
    ran = subprocess.run([sys.executable, with_parent.__file__, "1" if os.getpid() != 1 else "2", "echo", "begun"],
                         capture_output=True, text=True, check=True)
    assert ran.stdout == ""


@pytest.mark.parametrize("command", [["rig", "robotino2", "--board", "process", "--steps", "100000000"],
                                     ["play", "canopen_agv", "--listen", "0", "--board", "process"]])
def test_a_command_that_is_killed_leaves_no_node(command: list[str], tmp_path: Path) -> None:
    """The node stands for itself in the test: it opens a FIFO, so that the test knows when it began and ended."""
    mark = tmp_path / "mark"
    os.mkfifo(mark)
    (tmp_path / "bin").mkdir()
    for each in ("lib", "CMakeCache.txt"):
        (tmp_path / each).symlink_to(built("lib").parent / each)
    node = tmp_path / "bin" / "laconic-node-double"
    node.write_text(f'#!/bin/sh\nexec 9>"{mark}"\nexec "{built("bin/laconic-node-double")}" "$@"\n')
    node.chmod(0o755)
    end = os.open(mark, os.O_RDONLY | os.O_NONBLOCK)
    with subprocess.Popen([sys.executable, "-m", "laconic", *command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          env=os.environ | {"LACONIC_BUILD_DIR": str(tmp_path)}) as caller:
        wait_until_opened(mark)
        caller.send_signal(signal.SIGKILL)
        caller.communicate(timeout=LONGEST_S)
    assert select.select([end], [], [], LONGEST_S)[0] and os.read(end, 1) == b""
    os.close(end)


def wait_until_opened(mark: Path) -> None:
    """Until the node has the FIFO: an opening to read that waits for it."""
    os.close(os.open(mark, os.O_RDONLY))


def test_a_node_whose_input_ends_stays_unless_it_is_asked_to_go() -> None:
    program = built("bin/laconic-node-double")
    with subprocess.Popen([program], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True) as node:
        assert node.stdout is not None
        port = int(node.stdout.readline().rpartition(":")[2])
        with socket.create_connection(("127.0.0.1", port), timeout=LONGEST_S) as client:
            client.sendall(b"V\r")
            assert client.recv(16) == b"V1010\r"
        node.terminate()
    with subprocess.Popen([program, "--with-parent"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as node:
        assert node.stdin is not None and node.stdout is not None
        node.stdin.write("what it is sent has no meaning")
        node.stdin.flush()
        port = int(node.stdout.readline().rpartition(":")[2])
        with socket.create_connection(("127.0.0.1", port), timeout=LONGEST_S) as client:
            client.sendall(b"V\r")
            assert client.recv(16) == b"V1010\r"
        node.stdin.close()
        assert node.wait(LONGEST_S) == 0


def test_a_node_on_an_interface_has_no_parent_to_watch() -> None:
    ran = subprocess.run([built("bin/laconic-node-double"), "--with-parent", "--socketcan", "can0"],
                         capture_output=True, text=True)
    assert ran.returncode == 2 and ran.stderr == ("laconic-node: --with-parent: watches a node on a port; leave it out "
                                                  "with --socketcan\n")
