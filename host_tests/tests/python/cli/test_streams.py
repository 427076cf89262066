"""How a command ends when stdout or a signal ends it: one line at most, no traceback, and no verdict."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from laconic.cli import main as cli

pytestmark = pytest.mark.skipif(os.name != "posix", reason="pipes and signals of POSIX")


def started(script: str, **more: object) -> subprocess.CompletedProcess[str]:
    """Python in a process of its own; stderr as text."""
    return subprocess.run([sys.executable, "-c", script], stderr=subprocess.PIPE, text=True, check=False, **more)


def main_with(command: str, before: str = "") -> str:
    """A script that runs a command line."""
    return f"import os, signal, sys; from laconic.cli.main import main; {before}\nmain({command.split()!r})"


RICH = """
import laconic.cli.commands.benchmark as benchmark
from rich.console import Console
benchmark.command.callback = lambda **_: [Console().print(line) for line in range(100_000)] and 0
"""
"""A command with much output by rich, which has ways of its own with pipes."""


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
@pytest.mark.parametrize("command, before", [
    pytest.param("simulate s1", "", marks=pytest.mark.nightly), ("simulate s1 --out -", ""), ("benchmark step", RICH)])
def test_a_full_stdout_is_one_line(command, before):
    with Path("/dev/full").open("w") as full:
        done = started(main_with(command, before), stdout=full)
    assert done.stderr == "laconic: stdout: cannot be written (no space left on device); redirect it to another place\n"
    assert done.returncode == 2


@pytest.mark.parametrize("command, before", [("simulate s1 --out -", ""), ("benchmark step", RICH)])
def test_a_reader_that_goes_is_no_verdict(command, before):
    reader, writer = os.pipe()
    os.close(reader)
    done = started(main_with(command, before), stdout=writer)
    os.close(writer)
    assert done.stderr == ""
    assert done.returncode == 141


def test_a_closed_stdout_is_one_line():
    done = started(main_with("simulate s1", "os.close(1); sys.stdout = None"), stdout=subprocess.DEVNULL)
    assert "stdout: cannot be written" in done.stderr and done.stderr.count("\n") == 1
    assert done.returncode == 2


@pytest.mark.parametrize("name, status, words", [
    ("SIGINT", 130, "stopped by the user"), ("SIGHUP", 129, "stopped by SIGHUP"),
    pytest.param("SIGTERM", 143, "stopped by SIGTERM", marks=pytest.mark.nightly)])
def test_a_signal_is_one_line_and_leaves_no_half_file(name, status, words, tmp_path):
    out = tmp_path / "run.csv"
    out.write_text("before")
    stop = f"import pathlib; pathlib.Path.replace = lambda *_: os.kill(os.getpid(), signal.{name})"  # all is written
    done = started(main_with(f"simulate s1 --out {out}", stop), stdout=subprocess.DEVNULL)
    assert done.returncode == status
    assert words in done.stderr and done.stderr.count("\n") == 1
    assert out.read_text() == "before"
    assert [each.name for each in tmp_path.iterdir()] == ["run.csv"]


def test_letters_that_stdout_does_not_know_are_no_error():
    done = started(main_with("benchmark step", RICH.replace("range(100_000)", "'ν'")), stdout=subprocess.PIPE,
                   env={**os.environ, "PYTHONIOENCODING": "ascii"})
    assert (done.returncode, done.stdout, done.stderr) == (0, "\\u03bd\n", "")


@pytest.mark.parametrize("error, words", [
    (OSError(5, "Input/output error", "some.file"), "some.file: input/output error"),
    (BrokenPipeError(32, "Broken pipe"), "broken pipe"),
    (ModuleNotFoundError("No module named 'x'", name="x"), "no x; build again"),
    (MemoryError(), "not enough memory"),
    (ZeroDivisionError("float division\nby zero"), "unexpected fault of the program (test_streams.py:"),
    (RecursionError("deep"), "unexpected fault of the program (test_")], ids=lambda e: type(e).__name__)
def test_any_error_is_one_line_and_status_2(error, words, monkeypatch, capsys):
    def fails(*_: object) -> None:
        raise error

    import laconic.cli.commands.simulate as command

    monkeypatch.setattr(command, "read_scene", fails)
    assert cli.run(["simulate", "s1"]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert words in printed.err and printed.err.startswith("laconic: ") and printed.err.count("\n") == 1
    monkeypatch.setenv("LACONIC_TRACEBACK", "1")
    assert cli.run(["simulate", "s1"]) == 2
    assert "Traceback" in capsys.readouterr().err


def test_ctrl_c_is_one_line_and_status_130(monkeypatch, capsys):
    import laconic.cli.commands.simulate as command

    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(command, "read_scene", stop)
    assert cli.run(["simulate", "s1"]) == 130 == 128 + signal.SIGINT
    assert capsys.readouterr().err == "laconic: stopped by the user\n"


@pytest.mark.parametrize("module", ["click", "numpy"])  # of every command; of this one
def test_ctrl_c_while_modules_are_read_is_one_line(tmp_path, module):
    stop = "import os, signal, time\nos.kill(os.getpid(), signal.SIGINT)\ntime.sleep(20.0)\n"
    (tmp_path / f"{module}.py").write_text(stop)
    done = subprocess.run([sys.executable, "-m", "laconic", "simulate", "s1"], env=os.environ | {
        "PYTHONPATH": str(tmp_path)}, capture_output=True, text=True)
    assert (done.returncode, done.stderr, done.stdout) == (130, "laconic: stopped by the user\n", "")


SWALLOWED = """
import laconic.cli.commands.benchmark as benchmark, time
class Final:
    def __del__(self):
        os.kill(os.getpid(), signal.SIGTERM)
        for _ in range(1000): pass  # here Python raises what the handler raises, and ignores it
def work(**_):
    Final()
    time.sleep(60)
benchmark.command.callback = work
"""


def test_a_stop_that_falls_where_python_ignores_exceptions_is_not_lost():
    done = started(main_with("benchmark step", SWALLOWED), stdout=subprocess.DEVNULL, timeout=30)
    assert done.stderr == "laconic: stopped by SIGTERM\n"
    assert done.returncode == 128 + signal.SIGTERM


AGAIN = """
import laconic.cli.commands.benchmark as benchmark, laconic.cli.main as command_line
def work(**_):
    os.kill(os.getpid(), signal.SIGINT)
benchmark.command.callback = work
told = command_line.{0}
def {0}(*given):
    found = told(*given)
    os.kill(os.getpid(), signal.SIGINT)
    return found
command_line.{0} = {0}
"""


@pytest.mark.parametrize("while_it", ["fail", "let_signals_end"])
def test_a_second_ctrl_c_while_the_first_ends_the_command_is_no_traceback(while_it):
    done = started(main_with("benchmark step", AGAIN.format(while_it)), stdout=subprocess.DEVNULL, timeout=30)
    assert done.stderr == "laconic: stopped by the user\n"
    assert done.returncode == 130


AT_EXIT = """
import laconic.cli.commands.benchmark as benchmark, threading
def work(**_):
    threading.Thread(target=lambda: [threading.Event().wait(0.2), os.kill(os.getpid(), signal.SIGINT)]).start()
    os.kill(os.getpid(), signal.SIGINT)
benchmark.command.callback = work
class Last:
    def __del__(self, kill=os.kill, pid=os.getpid(), number=signal.SIGINT):
        kill(pid, number)
sys.last_of_all = Last()
"""


@pytest.mark.parametrize("left_out", ["sys.last_of_all = Last()", "threading.Event().wait(0.2), "])
def test_a_second_ctrl_c_while_python_ends_leaves_the_status(left_out):
    done = started(main_with("benchmark step", AT_EXIT.replace(left_out, "")), stdout=subprocess.DEVNULL, timeout=30)
    assert (done.returncode, done.stderr) == (130, "laconic: stopped by the user\n")


MANY = """
import laconic.cli.commands.benchmark as benchmark
def work(**_):
    try:
        os.kill(os.getpid(), signal.SIGINT)
    finally:
        try:
            os.kill(os.getpid(), signal.SIGINT)
        finally:
            os.kill(os.getpid(), signal.SIGINT)
benchmark.command.callback = work
"""


def test_a_third_ctrl_c_ends_whatever_still_cleans_up():
    done = started(main_with("benchmark step", MANY), stdout=subprocess.DEVNULL, timeout=30)
    assert (done.returncode, done.stderr) == (130, "")
