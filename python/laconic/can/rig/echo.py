"""A station of python-can's `udp_multicast` that does not hear itself.

The network gives a program its own frames back, and python-can hands them on as somebody else's. All programs of a
machine share one port, so the address of a frame does not tell whose it is. This station sends from a port of its own:
what comes from there is its echo.
"""

from __future__ import annotations

import socket
import time
from typing import Any, TypeVar

import can

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
