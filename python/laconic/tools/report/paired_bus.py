"""Two ends of a bus in one thread, for cases by the hundred in virtual time: python-can's virtual bus copies each frame
deeply and locks a queue for each look at it."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager

import can


class PairedBus(can.BusABC):
    """One end; what it sends waits at the other, and a look at it never blocks."""

    channel_info = "paired bus"

    def __init__(self) -> None:
        super().__init__(channel=self.channel_info)
        self._arrived: deque[can.Message] = deque()
        self._other = self

    def join(self, other: PairedBus) -> None:
        """From now on they are two ends of the same bus."""
        self._other, other._other = other, self

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """The frame is at the other end at once; neither end changes it."""
        self._other._arrived.append(msg)

    def recv(self, timeout: float | None = None) -> can.Message | None:
        """The next frame; None where none waits, whatever the timeout: no other thread could send one meanwhile."""
        return self._arrived.popleft() if self._arrived else None


@contextmanager
def paired_buses() -> Iterator[tuple[PairedBus, PairedBus]]:
    """Both ends of one bus."""
    with PairedBus() as near, PairedBus() as far:
        near.join(far)
        yield near, far
