"""Faults of drives by order: PARAMETER frames with DRIVE_FAULTS, sent while the node plays. Nothing waits for the
answers, since the controller's frames must not wait either."""

from __future__ import annotations

from collections import deque

import can

from laconic.can.rig.client import REPEAT_S, NodeClient
from laconic.can.rig.wire import wire
from laconic.errors import LaconicError, ResultFails

FIELD = "DRIVE_FAULTS"
PATIENCE_US = 2_000_000  # without an answer for so long the node may or may not have acted


class Orders:
    """One order after the other: each is sent again until it is answered, and the node acts on it once."""

    def __init__(self, client: NodeClient):
        self.client = client
        self.failure: LaconicError | None = None
        self._waiting: deque[tuple[int, int]] = deque()
        self._message: can.Message | None = None
        self._request = 0
        self._first_us = self._last_us = 0

    def give(self, wheel: int, faults: int) -> None:
        """All faults by order of a wheel's drive from now on."""
        self._waiting.append((wheel, faults))

    def go_on(self, now_us: int) -> None:
        """Sends what is due."""
        if self._message is None and self._waiting:
            self._message, self._first_us = self._next(*self._waiting[0]), now_us
        elif self._message is None or now_us - self._last_us < 1e6 * REPEAT_S:
            return
        if now_us - self._first_us > PATIENCE_US:
            self._fails("the node does not answer")
            return
        self._last_us = now_us
        self.client.link.send_message(self._message)

    def _next(self, wheel: int, faults: int) -> can.Message:
        frame = wire()["PARAMETER"]
        data = frame.pack(field=wire().number("PARAMETER", "field", FIELD), item=wheel, value=faults)
        self._request = self.client.link.session.protect(frame, data) & 15
        return self.client.link.message(frame, data)

    def take(self, result: dict[str, int]) -> None:
        """A RESULT has come."""
        if self._message is None or result["request"] != self._request:
            return
        if wire().choice("RESULT", "command", result["command"]) != "parameter":
            return
        if result["status"]:
            self._fails(f"the node refuses: {wire().choice('RESULT', 'status', result['status'])}")
            return
        self._waiting.popleft()
        self._message = None

    def _fails(self, why: str) -> None:
        self.failure = ResultFails(f"a fault of the drive of wheel {self._waiting[0][0]} could not be ordered: {why}")
        self._message = None
        self._waiting.clear()
