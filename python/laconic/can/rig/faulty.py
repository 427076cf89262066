"""`faulty`: a python-can interface that puts faults between its user and any other bus.

    can.Bus(interface="faulty", channel="can0", under="socketcan", loss=0.01, seed=7)

`under` names the interface beneath, `channel` and unknown options go to it; the faults are those of
laconic.can.rig.faults.Faults. The entry point `can.interface` offers it to every program that uses python-can.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import can

from laconic.can.rig.echo import deaf_to_itself
from laconic.can.rig.faults import FIELD_TYPES, IN, OUT, FaultModel, faults_from

# On the others the CAN controller makes error frames; one that a program sends would become some data frame.
CARRY_ERROR_FRAMES = ("VirtualBus", "UdpMulticastBus", "ListeningBus")


class FaultyBus(can.BusABC):
    """A bus with faults; `inner` is the bus beneath, `model` makes the faults."""

    def __init__(self, channel: Any = None, under: str = "virtual", inner: can.BusABC | None = None,
                 clock: Callable[[], float] | None = None, **options: Any):
        ours = {name: options.pop(name) for name in list(options) if name in FIELD_TYPES}
        options.pop("interface", None)
        try:
            self.model = FaultModel(faults_from(ours))
        except ValueError as error:
            raise can.CanInitializationError(f"faulty: {error}") from None
        self.inner = inner or deaf_to_itself(can.Bus(interface=under, channel=channel, **options))
        self._carries_error_frames = type(self.inner).__name__ in CARRY_ERROR_FRAMES
        self._now = clock or time.monotonic
        self._start = self._now()
        self._arrived: list[can.Message] = []
        self.channel_info = f"faulty over {self.inner.channel_info}"
        self._can_protocol = self.inner.protocol
        super().__init__(channel=channel)

    def now_s(self) -> float:
        """Seconds since the bus was opened: the time scale of from_s and until_s."""
        return self._now() - self._start

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Hands the frame to the model."""
        self.model.put(msg, OUT, self.now_s())
        self.move()

    def move(self) -> None:
        """Delivers every frame that arrives by now."""
        for direction, message in self.model.take(self.now_s()):
            of_all = message.is_error_frame  # all stations hear it
            if of_all or direction == IN:
                self._arrived.append(message)
            if direction == OUT if not of_all else self._carries_error_frames:
                self.inner.send(message)

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        deadline = None if timeout is None else self._now() + timeout
        while True:
            self.move()
            if self._hears_any():
                self.move()
            if self._arrived:
                return self._arrived.pop(0), False
            left = None if deadline is None else deadline - self._now()
            if left is not None and left <= 0:
                return None, False
            wait = max(0.0, min(self.model.next_s() - self.now_s(), 0.01, left if left is not None else 0.01))
            if (message := self.inner.recv(wait)) is not None:
                self.model.put(message, IN, self.now_s())

    def _hears_any(self) -> bool:
        """Hands the model what waits at the bus beneath; whether there was anything."""
        any_came = False
        while (message := self.inner.recv(0)) is not None:
            self.model.put(message, IN, self.now_s())
            any_came = True
        return any_came

    def let_go(self) -> None:
        """Ends this bus and leaves the one beneath open, for whoever opened that."""
        super().shutdown()

    def shutdown(self) -> None:
        """Closes the bus beneath, too."""
        super().shutdown()
        self.inner.shutdown()

    @property
    def state(self) -> can.BusState:
        """State of the bus beneath."""
        return self.inner.state

    @state.setter
    def state(self, new_state: can.BusState) -> None:
        self.inner.state = new_state
