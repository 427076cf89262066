"""No station of a bus hears itself, on whatever interface."""

from __future__ import annotations

import can
import pytest

from laconic.can.rig.bus_options import read_bus_options
from laconic.can.rig.buses import open_bus
from laconic.can.rig.errors import CannotReach
from laconic.errors import BadInput

GROUP, PORT = "239.74.163.9", 43219


def frame(number: int) -> can.Message:
    """One frame like another, but for its identifier."""
    return can.Message(arbitration_id=number, is_extended_id=False, data=b"\1\2")


@pytest.fixture(params=["udp_multicast", "faulty"])
def interface(request: pytest.FixtureRequest) -> str:
    """The network itself, and faults over it."""
    return str(request.param)


def station(interface: str) -> can.BusABC:
    """One more on the network."""
    more = {"under": "udp_multicast"} if interface == "faulty" else {}
    try:
        return open_bus(interface, GROUP, port=PORT, **more)
    except CannotReach as error:
        pytest.skip(f"this machine has no multicast: {error}")


def test_a_station_of_a_network_hears_the_others_and_never_itself(interface: str) -> None:
    with station(interface) as one, station("udp_multicast") as other, \
            can.Bus(interface="udp_multicast", channel=GROUP, port=PORT) as stranger:
        one.send(frame(0x101))
        one.send(frame(0x102))
        other.send(frame(0x101))       # the same frame from somebody else is heard
        stranger.send(frame(0x103))    # from the port that all share
        heard = [one.recv(1.0).arbitration_id for _ in range(2)]
        assert heard == [0x101, 0x103] and one.recv(0.0) is None
        assert [other.recv(1.0).arbitration_id for _ in range(3)] == [0x101, 0x102, 0x103]
        assert [stranger.recv(1.0).arbitration_id for _ in range(3)] == [0x101, 0x102, 0x101]


def test_an_option_that_makes_a_bus_hear_itself_is_refused() -> None:
    with pytest.raises(BadInput, match="receive_own_messages=true: would take frames of its own"):
        read_bus_options(["receive_own_messages=true"], "socketcan")
