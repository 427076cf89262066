"""The node as a process: its help, and a client that finds another one on the line."""

from __future__ import annotations

import os
import re
import select
import shutil
import signal
import socket
import subprocess
import sys
import threading
from contextlib import ExitStack, suppress
from pathlib import Path

import pytest

from laconic.base.paths import SOURCE_DIR, build_dir, built
from laconic.can.rig import with_parent
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


def test_the_fifth_client_of_a_shared_node_learns_that_four_are_on_it() -> None:
    with node_process("double", ID_BASE, "--shared") as port, ExitStack() as clients:
        for _ in range(4):
            client = clients.enter_context(socket.create_connection(("127.0.0.1", port), timeout=5.0))
            client.sendall(b"V\r")
            assert client.recv(16) == b"V1010\r"
        fifth = clients.enter_context(socket.create_connection(("127.0.0.1", port), timeout=5.0))
        said = fifth.recv(200)
        assert said.startswith(b"\aoccupied") and b"four clients" in said and b"one client" not in said


def test_the_help_of_the_node_tells_who_hears_it_on_a_shared_port() -> None:
    said = subprocess.run([built("bin/laconic-node-double"), "--help"], capture_output=True, text=True).stdout
    words = " ".join(said.partition("--shared  ")[2].partition("--socketcan")[0].split())
    assert "from and to the node itself" in words and "only among clients that have sent it one" in words


@pytest.mark.parametrize("option", [[], ["--shared"]])
def test_every_line_is_answered_also_that_of_a_frame(option: list[str]) -> None:
    with node_process("double", ID_BASE, *option) as port, \
            socket.create_connection(("127.0.0.1", port), timeout=5.0) as client:
        for line, answer in ((b"S6", b"\r"), (b"O", b"\r"), (b"t10083412341200000000", b"\r"), (b"T000000010", b"\r"),
                             (b"t1009", b"\a"), (b"d1001AB", b"\r")):
            client.sendall(line + b"\r")
            assert client.recv(1) == answer


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


# ---- The node compiles without warnings in the shapes that firmware chooses, and refuses those that it cannot
# serve.

FIRMWARE = SOURCE_DIR / "firmware_stub"
STRICT = ("-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Wdouble-promotion", "-Werror",
          "-ffp-contract=off", "-fsyntax-only")
INCLUDES = (SOURCE_DIR / "core_c" / "include", FIRMWARE / "include", FIRMWARE / "node", FIRMWARE / "drives")
COMPILERS = [name for name in ("gcc", "clang") if shutil.which(name)]


def compiled(compiler: str, *definitions: str, only: str = "*.c") -> str:
    """The messages of the compiler about the files of the node."""
    paths = [path for room in ("wire", "node", "drives") for path in sorted((FIRMWARE / room).rglob(only))]
    files = [str(path) for path in paths]
    where = [word for path in INCLUDES for word in ("-I", str(path))]
    where += ["-isystem", str(build_dir() / "firmware_stub" / "wire")]
    done = subprocess.run([compiler, *STRICT, *where, *(f"-D{each}" for each in definitions), *files],
                          capture_output=True, text=True)
    return done.stderr if done.returncode else ""


@pytest.mark.parametrize("compiler", [
    pytest.param(each, marks=[pytest.mark.nightly] if each != COMPILERS[0] else []) for each in COMPILERS])
@pytest.mark.parametrize("definitions", [
    ("LACONIC_NODE_WITH_HINGES=1", "LACONIC_NODE_WITH_ESTIMATE=1", "LACONIC_NODE_WITH_XCP=1"),
    ("LACONIC_SINGLE", "LACONIC_NODE_CAN_FD=0", "LACONIC_MAX_WHEELS=4", "LACONIC_MAX_SUPPORTS=1"),
    *(pytest.param(each, marks=pytest.mark.nightly) for each in (
        (), ("LACONIC_MAX_WHEELS=24", "LACONIC_NODE_WITH_SENSORS=0"),
        ("LACONIC_NODE_WITH_DRIVES=0", "LACONIC_WITH_AXLE_TORQUE=0"),
        ("LACONIC_NODE_WITH_SENSORS=0",), ("LACONIC_NODE_WITH_ESTIMATE=1",),
        ("LACONIC_NODE_WITH_SENSORS=0", "LACONIC_NODE_WITH_ESTIMATE=1", "LACONIC_NODE_WITH_DRIVES=0"),
        ("LACONIC_NODE_WITH_XCP=1",), ("LACONIC_NODE_WITH_HINGES=1", "LACONIC_NODE_WITH_ESTIMATE=1"),
        ("LACONIC_NODE_WITH_XCP=1", "LACONIC_SINGLE", "LACONIC_NODE_WITH_SENSORS=0", "LACONIC_NODE_WITH_DRIVES=0",
         "LACONIC_WITH_FRICTION=0", "LACONIC_NODE_CAN_FD=0"),
        ("LACONIC_NODE_WITH_HINGES=1", "LACONIC_NODE_WITH_SENSORS=0", "LACONIC_NODE_WITH_DRIVES=0",
         "LACONIC_SINGLE")))], ids=" ".join)
def test_the_node_compiles_without_a_warning(compiler: str, definitions: tuple[str, ...]) -> None:
    assert compiled(compiler, *definitions) == ""


@pytest.mark.parametrize("compiler", COMPILERS)
def test_more_wheels_than_the_groups_of_voltage_can_number_do_not_compile(compiler: str) -> None:
    assert "VOLTAGE numbers eight groups of three wheels" in compiled(
        compiler, "LACONIC_MAX_WHEELS=25", only="node_motion.c")


@pytest.mark.parametrize("bodies", [0, 10])
def test_more_hinges_than_steering_can_number_do_not_compile(bodies: int) -> None:
    assert "STEERING numbers nine hinges" in compiled(
        COMPILERS[0], "LACONIC_NODE_WITH_HINGES=1", f"LACONIC_MAX_BODIES={bodies}", only="node.c")


@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("name", ["main.c", "station.c"])
def test_the_host_port_needs_nothing_of_linux_but_for_socketcan(compiler: str, name: str) -> None:
    path = FIRMWARE / "ports" / "host" / name
    where = [word for folder in (*INCLUDES, build_dir() / "firmware_stub" / "wire") for word in ("-I", str(folder))]
    done = subprocess.run([compiler, *STRICT, "-U__linux__", "-H", *where, str(path)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "linux/can" not in done.stderr
    words = set(re.findall(r"\w+", re.sub(r"/\*.*?\*/", "", path.read_text(encoding="utf-8"), flags=re.DOTALL)))
    assert words & {"ppoll", "accept4", "SOCK_NONBLOCK", "SOCK_CLOEXEC", "MSG_NOSIGNAL"} == set()


# ---- A node that the rig or play starts ends with it, also where it is killed, and holds no pipe of the caller.

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
