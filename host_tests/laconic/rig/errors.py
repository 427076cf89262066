"""Errors on a bus, with messages for the user."""

from __future__ import annotations

import signal

from laconic.errors import BadInput, LaconicError, ResultFails, words_of


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


def in_words(error: BaseException) -> str:
    """The message of a library, and after it that of the system error that caused it."""
    text, last = words_of(error, "for a reason that the library does not give"), error
    while last.__cause__ is not None:
        last = last.__cause__
    reason = words_of(last, "")
    return text if reason in text or str(last) in text else f"{text}: {reason}"


class Interrupted(LaconicError):
    """A signal has ended the run; the exit status is the shell's for that signal: 130 for SIGINT, 143 for SIGTERM."""

    def __init__(self, number: int):
        super().__init__(f"interrupted by {signal.Signals(number).name}")
        self.exit_status = 128 + number


ENDINGS = (BusDied, NodeSilent, NodeRefused, Interrupted)  # of a run before its last step
