"""Errors on a bus, with messages for the user.

Signals during a run. The first one is kept until the rig waits for a frame, so that no frame and no log entry is cut
in two and what was judged so far is reported; a second one ends the run at once.
"""

from __future__ import annotations

import os
import re
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType, TracebackType
from typing import Any

import can

from laconic.errors import BadInput, LaconicError, ResultFails, reason_of


class CannotReach(BadInput):
    """The bus could not be opened, or no node answers on it."""


class NodeSilent(ResultFails):
    """An answer that was due did not come."""


class NodeRefused(ResultFails):
    """The node answered with a refusal."""

    def __init__(self, command: str, status: str, field: str, item: int, state: str):
        where = f", {field}" if field != "none" else ""
        where += f" {item}" if item else ""
        remedy = "; it contains other methods, choose one with --method" if status == "method unknown" else ""
        super().__init__(f"the node refuses {command}: {status}{where} (its state: {state}){remedy}")
        self.command, self.status, self.field, self.item, self.state = command, status, field, item, state


class BusDied(ResultFails):
    """Sending or receiving failed in the middle of a run."""


UNEXPECTED = "its driver received something that it does not understand"


def in_words(error: BaseException) -> str:
    """The system's reason, or what a driver states; an exception of Python's own has no words for a user."""
    chain = [error]
    while (cause := chain[-1].__cause__) is not None:
        chain.append(cause)
    for each in reversed(chain):
        if isinstance(each, OSError) and not isinstance(each, can.CanError):
            return _of_system(each)
    return next((str(each.args[0]) for each in chain if isinstance(each, can.CanError) and each.args), UNEXPECTED)


def _of_system(error: OSError) -> str:
    """By the number of the error; a library may have it in its own text alone."""
    found = re.search(r"\[Errno (\d+)\]", str(error))
    number = error.errno or (int(found[1]) if found else 0)
    return os.strerror(number).lower() if number > 0 else reason_of(error)


class RunEnds(ResultFails):
    """A limit or a stop of a hinge ends the run of the scene."""


class Interrupted(LaconicError):
    """A signal has ended the run; the exit status is the shell's for that signal: 130 for SIGINT, 143 for SIGTERM."""

    def __init__(self, number: int):
        super().__init__(f"interrupted by {signal.Signals(number).name}")
        self.exit_status = 128 + number


ENDINGS = (BusDied, NodeSilent, NodeRefused, RunEnds, Interrupted)  # of a run before its last step


ENDING = ("SIGINT", "SIGTERM", "SIGHUP")  # Windows has no SIGHUP


class Interruption:
    """Catches the signals that end a program, in the main thread; in other threads it does nothing."""

    def __init__(self) -> None:
        self.number = 0
        self._before: dict[int, Any] = {}
        self._shields = 0

    def __enter__(self) -> Interruption:
        if threading.current_thread() is threading.main_thread():
            numbers = [getattr(signal, name) for name in ENDING if hasattr(signal, name)]
            self._before = {number: signal.signal(number, self._take) for number in numbers
                            if signal.getsignal(number) is not signal.SIG_IGN}  # nohup ignores SIGHUP: it stays ignored
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _take(self, number: int, frame: FrameType | None) -> None:
        again, self.number = bool(self.number), self.number or number
        if again and not self._shields:
            raise Interrupted(self.number)

    def check(self) -> None:
        """Interrupted if a signal has come."""
        if self.number and not self._shields:
            raise Interrupted(self.number)

    @contextmanager
    def shielded(self) -> Iterator[None]:
        """No signal interrupts this context. It brings the node to rest, which has timeouts of its own."""
        self._shields += 1
        try:
            yield
        finally:
            self._shields -= 1
