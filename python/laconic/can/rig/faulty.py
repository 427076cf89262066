"""`faulty`: a python-can interface that puts faults between its user and any other bus.

    can.Bus(interface="faulty", channel="can0", under="socketcan", loss=0.01, seed=7)

`under` names the interface beneath, `channel` and unknown options go to it; the faults are those of
laconic.can.rig.faults.Faults. The entry point `can.interface` offers it to every program that uses python-can.

A station of python-can's `udp_multicast` that does not hear itself.

The network gives a program its own frames back, and python-can hands them on as somebody else's. All programs of a
machine share one port, so the address of a frame does not tell whose it is. This station sends from a port of its own:
what comes from there is its echo.
"""

from __future__ import annotations

import socket
import time
from collections.abc import Callable
from typing import Any, TypeVar

import can

from laconic.can.rig.faults import FIELD_TYPES, IN, OUT, FaultModel, faults_from

Bus = TypeVar("Bus", bound=can.BusABC)


def deaf_to_itself(bus: Bus) -> Bus:
    """The same bus, whose `recv` leaves out what its `send` sent; other interfaces do so already."""
    network: Any = getattr(bus, "_multicast", None)
    if network is not None:
        bus._multicast = OwnPort(network)  # type: ignore[attr-defined]
    return bus


class OwnPort:
    """Has the methods that UdpMulticastBus calls; `network` receives, a socket beside it sends."""

    def __init__(self, network: Any):
        self._network = network
        is_4 = network.ip_version == 4
        self._out = socket.socket(socket.AF_INET if is_4 else socket.AF_INET6, socket.SOCK_DGRAM)
        try:
            self._out.setsockopt(*((socket.IPPROTO_IP, socket.IP_MULTICAST_TTL) if is_4 else
                                   (socket.IPPROTO_IPV6, socket.IPV6_MULTICAST_HOPS)), network.hop_limit)
            self._out.connect((network.group, network.port))
        except OSError:
            self._out.close()
            network.shutdown()
            raise
        self._own = self._out.getsockname()[:2]

    def send(self, data: bytes, timeout: float | None = None) -> None:
        """To all stations."""
        self._out.settimeout(timeout)
        try:
            self._out.send(data)
        except OSError as error:
            raise can.CanOperationError(f"cannot send to {self._network.group}: {error}") from error

    def recv(self, timeout: float | None = None) -> Any:
        """Data, sender and time of the next datagram of another station; None: none came in time."""
        deadline_s = None if timeout is None else time.monotonic() + timeout
        while (found := self._network.recv(timeout)) is not None and found[1][:2] == self._own:
            timeout = None if deadline_s is None else max(0.0, deadline_s - time.monotonic())
        return found

    def fileno(self) -> int:
        """Of the socket that receives."""
        return int(self._network.fileno())

    def shutdown(self) -> None:
        """Closes both sockets."""
        self._out.close()
        self._network.shutdown()


# On the others the CAN controller makes error frames; one that a program sends would become some data frame.
CARRY_ERROR_FRAMES = ("VirtualBus", "PairedBus", "UdpMulticastBus", "ListeningBus")


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
