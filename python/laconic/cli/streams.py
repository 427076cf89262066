"""stdout that reports why a write fails, warnings on stderr, and signals that end a command in order.

Python turns a reader that has closed the pipe into exceptions that libraries catch and take for failures of their own;
here it is one that nothing but the command line catches.
"""

from __future__ import annotations

import atexit
import io
import os
import signal
import sys
import threading
from _thread import interrupt_main
from types import FrameType
from typing import Any

import click

from laconic.errors import BadInput, reason_of

ENDING_SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP")
SHELL_SIGNAL = 128  # a shell reports 128 + signal for a process that a signal ended
MAIN_THREAD = threading.main_thread().ident or 0
AGAIN_S = 0.01      # until a stop that was ignored is raised again
SIGPIPE = 13        # on every system that has it; Windows has not


class ReaderGone(BaseException):
    """Nobody reads stdout any more. It derives from BaseException, which libraries do not catch."""


class Stopped(KeyboardInterrupt):
    """A signal ends the command; the cleaning up after Ctrl-C follows every signal, and a second one cuts it short."""

    most = 2                 # raised; further signals end the process where it is
    raised: list[int] = []   # noqa: RUF012 (of the process: it counts all of them)

    def __init__(self, number: int = signal.SIGINT):
        super().__init__()
        self.number = number


class Stdout(io.FileIO):
    """The raw stdout; a write that fails is ReaderGone or BadInput."""

    def write(self, data: object) -> int:
        """As FileIO."""
        try:
            return super().write(data)  # type: ignore[arg-type]
        except BrokenPipeError:
            self.silence()
            raise ReaderGone from None
        except OSError as error:
            self.silence()
            raise BadInput(f"stdout: cannot be written ({reason_of(error)}); redirect it to another place") from None

    def silence(self) -> None:
        """Discards the text in buffers, which Python would write at the end of the process."""
        os.dup2(os.open(os.devnull, os.O_WRONLY), self.fileno())


def guard() -> None:
    """Installs our stdout and signal handlers; only for the process of the command line."""
    open_standard()
    encoding = getattr(sys.stdout, "encoding", "utf-8")
    raw = Stdout(1, "w", closefd=False)
    sys.stdout = io.TextIOWrapper(io.BufferedWriter(raw), encoding, "backslashreplace", line_buffering=raw.isatty())
    hear_signals()
    atexit.register(answer_signals, stop_at_once, signal.SIG_IGN)  # nothing is left that could take long
    sys.unraisablehook = stop_again


def hear_signals() -> None:
    """Lets signals end the command in order. A shell without job control starts background jobs with SIGINT ignored,
    and Python would leave it so: `kill -INT` and launch files could not end them. nohup's SIGHUP stays ignored."""
    for name in ENDING_SIGNALS:
        number = getattr(signal, name, None)
        if number is not None and (name != "SIGHUP" or signal.getsignal(number) is not signal.SIG_IGN):
            signal.signal(number, stop)


def let_signals_end() -> None:
    """The command is over: a signal now ends the process at once and without a word, with the status of that signal."""
    answer_signals(stop, stop_at_once)


def answer_signals(before: Any, now: Any) -> None:
    """Gives those signals that have the one handler the other."""
    for number in (getattr(signal, name, None) for name in ENDING_SIGNALS):
        if number is not None and signal.getsignal(number) is before:
            signal.signal(number, now)


def open_standard() -> None:
    """Opens those of 0, 1 and 2 that the caller has closed, in this order, so that no file of ours takes their place.

    stdout is opened for reading: writing to it then fails with a reason. What goes to a closed stderr is lost.
    """
    for number, mode in enumerate((os.O_RDONLY, os.O_RDONLY, os.O_WRONLY)):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, mode)
    if sys.stderr is None:
        sys.stderr = open(2, "w", closefd=False)  # noqa: SIM115 (open as long as the process lives)


def warn(message: str) -> None:
    """One line on stderr that changes no exit status."""
    click.echo(f"laconic: warning: {message}", err=True)


def stop(number: int, _: FrameType | None) -> None:
    """Handles a signal: raises Stopped with its number."""
    if len(Stopped.raised) >= Stopped.most:
        stop_at_once(number, None)
    Stopped.raised.append(number)
    raise Stopped(number)


def stop_at_once(number: int, _: FrameType | None) -> None:
    """Handles a signal: ends the process as if no line of it were left."""
    os._exit(SHELL_SIGNAL + number)


def stop_again(ignored: sys.UnraisableHookArgs) -> None:
    """Raises a stop anew that fell into a place whose exceptions Python ignores, as a finalizer or the collector's
    callbacks; it would be lost there. Other ignored exceptions are told as Python tells them."""
    if not isinstance(ignored.exc_value, Stopped):
        sys.__unraisablehook__(ignored)
        return
    Stopped.raised.clear()
    again = threading.Timer(AGAIN_S, signal_main, [ignored.exc_value.number])
    again.daemon = True
    again.start()


def signal_main(number: int) -> None:
    """Gives a signal to the main thread, out of a wait, too, where the system can."""
    if hasattr(signal, "pthread_kill"):
        signal.pthread_kill(MAIN_THREAD, number)
    else:
        interrupt_main(signal.Signals(number))


def stop_status(stopped: BaseException) -> tuple[str, int]:
    """The message and the exit status of a command that a signal has ended."""
    number = getattr(stopped, "number", signal.SIGINT)
    who = "the user" if number == signal.SIGINT else signal.Signals(number).name
    return f"stopped by {who}", SHELL_SIGNAL + number
