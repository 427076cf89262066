"""Runs that are interrupted: the node comes to rest, what was judged is kept, logs are whole, the next run works."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from xml.etree import ElementTree

import can
import pytest

from laconic.base.paths import built
from laconic.can.rig import run as one_run
from laconic.can.rig.boards import own_node
from laconic.can.rig.buses import connected, node_process
from laconic.can.rig.free_judge import Free
from laconic.can.rig.judge import Scaled
from laconic.can.rig.lockstep import load_scene
from laconic.can.rig.logs import read_log, was_closed
from laconic.can.rig.wire import wire
from laconic.cli.main import run
from laconic.scene import read_scene

MODES = {"lockstep": [], "same bits": ["--same-bits"], "free run": ["--free-run", "--watchdog", "0"]}
LAST = 30  # the step or cycle in which the signal comes


@pytest.fixture(scope="module")
def port() -> Iterator[int]:
    """A node process for all runs of this file."""
    with node_process() as number:
        yield number


def on(port: int) -> list[str]:
    """The options that lead to it."""
    return ["--interface", "slcan", "--channel", f"socket://127.0.0.1:{port}"]


def at_step(monkeypatch: pytest.MonkeyPatch, happens: Callable[[], None], last: int = LAST) -> None:
    """Lets something happen in the middle of the next run, in which one call of `moved` is one step or cycle."""
    moves = 0

    @contextmanager
    def counting(*_: object) -> Iterator[Callable[[float], None]]:
        def counted(_: float) -> None:
            nonlocal moves
            moves += 1
            if moves == last:
                happens()

        yield counted

    monkeypatch.setattr(one_run, "shown", counting)


def state_of(port: int, capsys: pytest.CaptureFixture[str]) -> str:
    """In which state --stop finds the node."""
    capsys.readouterr()
    assert run(["rig", "--stop", *on(port), "--json"]) == 0
    return json.loads(capsys.readouterr().out)["found"]


@pytest.mark.parametrize("mode, number, status", [
    ("lockstep", signal.SIGINT, 130), ("lockstep", signal.SIGTERM, 143), ("same bits", signal.SIGINT, 130),
    ("free run", signal.SIGTERM, 143)])
def test_an_interrupted_run_leaves_the_node_at_rest_and_the_next_one_works(
        mode: str, number: int, status: int, port: int, monkeypatch: pytest.MonkeyPatch,
        capsys: pytest.CaptureFixture[str]) -> None:
    with monkeypatch.context() as patch:
        at_step(patch, lambda: os.kill(os.getpid(), number))
        assert run(["rig", "s1", *on(port), *MODES[mode], "--steps", "100000"]) == status
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and signal.Signals(number).name in error and "the node is at rest" in error
    assert state_of(port, capsys) == "ready"
    assert run(["rig", "s1", *on(port), "--steps", "5"]) == 0
    assert signal.getsignal(number) is not None and "Interruption" not in repr(signal.getsignal(number))


@pytest.mark.parametrize("mode, step", [("lockstep", LAST), ("same bits", LAST), ("free run", 10 * LAST)])
def test_an_interrupted_run_reports_every_verdict_up_to_its_last_step_as_json_and_to_ci(
        mode: str, step: int, port: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
        capsys: pytest.CaptureFixture[str]) -> None:
    at_step(monkeypatch, lambda: os.kill(os.getpid(), signal.SIGTERM))
    assert run(["rig", "s1", *on(port), *MODES[mode], "--steps", "100000", "--json", "--junit",
                str(tmp_path / "run.xml")]) == 143
    result = json.loads(capsys.readouterr().out)
    first, *others = result["verdicts"]
    assert first["name"] == "run" and "SIGTERM" in first["detail"] and "of 100000" in first["detail"]
    by_run_or_machine = ("steps", "clock")  # too few, as it was stopped; behind the clock on a busy machine
    assert len(others) >= 5 and [each for each in others
                                 if not each["passed"] and each["name"] not in by_run_or_machine] == []
    assert abs(result["figures"]["last_step"] - step) <= (0 if mode != "free run" else 150)
    suite = ElementTree.parse(tmp_path / "run.xml").getroot()
    assert int(suite.get("tests")) == len(result["verdicts"]) and int(suite.get("failures")) >= 1


def test_a_node_that_dies_in_lockstep_leaves_the_verdicts_of_the_steps_before(
        monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    with subprocess.Popen([built("bin/laconic-node-double")], stdout=subprocess.PIPE, text=True) as node:
        number = int(node.stdout.readline().rpartition(":")[2])
        at_step(monkeypatch, node.kill)
        assert run(["rig", "s1", *on(number), "--steps", "1000", "--json"]) == 1
    result = json.loads(capsys.readouterr().out)
    assert LAST <= result["figures"]["last_step"] <= LAST + 1 and result["figures"]["steps_wanted"] == 1000
    assert [each["name"] for each in result["verdicts"] if not each["passed"]] == ["run"]
    assert any("could not be stopped" in note for note in result["notes"])


def raising(step: int, what: str) -> list[str]:
    """`laconic` as a process that does something in a step of its run."""
    program = ("import os, signal, sys\nfrom contextlib import nullcontext\nfrom laconic.cli.main import main\n"
               "from laconic.can.rig import run\ndef moved(_, seen=[]):\n seen.append(0)\n"
               f" len(seen) == {step} and {what}\nrun.shown = lambda *_: nullcontext(moved)\nmain(sys.argv[1:])\n")
    return [sys.executable, "-c", program]


def test_ctrl_c_reaches_the_rig_and_not_the_node_that_it_has_started() -> None:
    program = raising(LAST, "os.killpg(0, signal.SIGINT)")  # as a terminal does it, to all in the foreground
    done = subprocess.run([*program, "rig", "s1", "--board", "process", "--steps", "100000"], capture_output=True,
                          text=True, start_new_session=True)
    assert done.returncode == 130 and "the node is at rest" in done.stderr and "Traceback" not in done.stderr


def test_a_signal_ends_the_wait_for_a_node_that_is_silent(capsys: pytest.CaptureFixture[str]) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server, ThreadPoolExecutor() as pool:
        def answer_nothing() -> None:
            line, _ = server.accept()
            with line:
                line.recv(64)
                os.kill(os.getpid(), signal.SIGTERM)
                while line.recv(64):
                    pass

        ending = pool.submit(answer_nothing)
        assert run(["rig", "s1", *on(server.getsockname()[1])]) == 143
        ending.result()
    assert "after step 0" in capsys.readouterr().err


@pytest.mark.parametrize("mode", ["lockstep", "free run"])
def test_a_stop_that_is_lost_again_and_again_still_reaches_the_node(mode: str) -> None:
    scene = read_scene("s1")
    with own_node("virtual", "double") as node:
        lost, send = [], node.link.bus.send
        control, stop = wire()["CONTROL"], wire().number("CONTROL", "command", "STOP")

        def lossy(message: can.Message, timeout: float | None = None) -> None:
            is_stop = (message.arbitration_id == node.link.id_base + control.offset
                       and control.unpack(message.data)["command"] == stop)
            if is_stop and len(lost) < 4:
                lost.append(message)
            else:
                send(message)

        node.link.bus.send = lossy
        trial = Scaled(node, scene, 20, {}) if mode == "lockstep" else Free(node, scene, 0.1, 100, 0, {})
        trial.drive()
        assert len(lost) == 4 and trial.ending is None
        assert node.link.pump.__self__.node.inspect()["state"] == "ready"


def test_a_process_that_is_terminated_leaves_whole_logs_and_a_node_at_rest(port: int, tmp_path: Path,
                                                                           capsys: pytest.CaptureFixture[str]) -> None:
    logs = [tmp_path / "run.blf", tmp_path / "run.asc"]
    program = raising(800, "os.kill(os.getpid(), signal.SIGTERM)")
    done = subprocess.run([*program, "rig", "s1", *on(port), "--steps", "100000",
                           *(word for path in logs for word in ("--log", str(path)))], capture_output=True, text=True)
    assert done.returncode == 143 and "Traceback" not in done.stderr
    blf, asc = [[(m.arbitration_id, bytes(m.data)) for m in read_log(path)] for path in logs]
    assert blf == asc and len(blf) > 3200 and all(was_closed(path) for path in logs)
    assert state_of(port, capsys) == "ready"


def test_a_run_that_raises_anything_leaves_the_node_at_rest(port: int, monkeypatch: pytest.MonkeyPatch,
                                                            capsys: pytest.CaptureFixture[str]) -> None:
    def fail() -> None:
        raise RuntimeError("a fault of our own")

    at_step(monkeypatch, fail)
    assert run(["rig", "s1", *on(port), "--free-run", "--watchdog", "0"]) == 2
    assert "unexpected fault of the program (test_rig_interrupted.py:" in capsys.readouterr().err
    assert state_of(port, capsys) == "ready"


@pytest.mark.parametrize("flag, state", [("--stop", "ready"), ("--reset", "ready")])
def test_a_node_that_somebody_has_left_running_is_stopped_by_command(flag: str, state: str, port: int,
                                                                      capsys: pytest.CaptureFixture[str]) -> None:
    leave_running(port)
    assert run(["rig", flag, *on(port)]) == 0
    assert "found in state free run, now " + state in capsys.readouterr().out


def test_a_run_recovers_a_node_that_it_finds_running_with_a_note(
        port: int, capsys: pytest.CaptureFixture[str]) -> None:
    leave_running(port)
    assert run(["rig", "s1", *on(port), "--steps", "10", "--json"]) == 0
    assert "found in state free run" in json.loads(capsys.readouterr().out)["notes"][0]


def leave_running(port: int) -> None:
    """A rig that died: its node drives on, without watchdog."""
    with connected("slcan", f"socket://127.0.0.1:{port}") as node:
        load_scene(node, read_scene("s1"))
        node.start_free_run(100, 0)


def test_a_stop_of_a_node_that_is_occupied_is_status_2_for_it_was_not_reached(
        port: int, capsys: pytest.CaptureFixture[str]) -> None:
    with connected("slcan", f"socket://127.0.0.1:{port}") as first:
        first.open()
        assert run(["rig", "--stop", *on(port)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and "no node could be reached" in error and "occupied" in error
