"""Signals during a run. The first one is kept until the rig waits for a frame, so that no frame and no log entry is cut
in two and what was judged so far is reported; a second one ends the run at once."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType, TracebackType
from typing import Any

from laconic.can.rig.errors import Interrupted

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
