"""Errors on a bus, with messages for the user."""

from __future__ import annotations

import os
import re
import signal

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
