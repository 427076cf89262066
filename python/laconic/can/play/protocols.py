"""The protocols of drives as the host knows them: node ids, the identifiers that they use, and the usual motor; and the
kinds of faults that drives have on purpose, with their bits in the order to a node."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

from laconic.scene.drives import DRIVE_PROTOCOLS

STALL, BUS_OFF, SILENT, ERROR_FRAMES = "stall", "bus-off", "silent", "error-frames"
ORDERS = {STALL: 1024, "encoder": 1, "temperature": 4, "overspeed": 8, "supply": 16, BUS_OFF: 256, SILENT: 512}
OF_DRIVE = tuple(kind for kind, bit in ORDERS.items() if bit < 256)  # LACONIC_DRIVE_FAULT_…; the rest ORDER_…
OF_WHEEL = (STALL, *OF_DRIVE)  # what concerns no bus
KINDS = (*ORDERS, ERROR_FRAMES)

Identifiers = Callable[[int], frozenset[int]]


@dataclass(frozen=True)
class DriveProtocol:
    """One protocol; `usual` are the settings of a drive that neither the scene nor its motor gives."""

    name: str
    first_id: int                      # of the usual node ids, which count up from here
    smallest_id: int
    largest_id: int
    identifiers: Identifiers           # 11-bit identifiers that a drive with this node id sends or listens to
    has_sign_of_life: bool             # a frame that it sends to show that it is alive, not only when it is asked
    usual: Mapping[str, float] = field(default_factory=dict)
    why_usual: str = ""

    @property
    def why_no_watchdog(self) -> str:
        """How a drive watches its controller where a time in its settings does not say so."""
        return "its heartbeat consumer, object 1016h, is set by the controller" if self.name == "canopen" else ""

    @property
    def number(self) -> int:
        """On the wire, in DRIVE_PROTOCOL."""
        return DRIVE_PROTOCOLS.index(self.name) + 1


def _canopen(node_id: int) -> frozenset[int]:
    """NMT, SYNC and EMCY, four PDOs each way, SDO and heartbeat (CiA 301, table of the predefined connection set)."""
    return frozenset({0x000, 0x080, *(base + node_id for base in range(0x080, 0x680, 0x080)), 0x700 + node_id})


def _odrive(node_id: int) -> frozenset[int]:
    """32 messages each."""
    return frozenset(range(node_id << 5, (node_id + 1) << 5))


def _robomaster(node_id: int) -> frozenset[int]:
    """Commands for four drives each, and one feedback."""
    return frozenset({0x200, 0x1FF, 0x200 + node_id})


def _moteus(node_id: int) -> frozenset[int]:
    """From and to a controller with id 0; a command that wants a reply has a 29-bit identifier."""
    return frozenset({node_id, node_id << 8} & set(range(0x800)))


M3508_GEAR = 3591.0 / 187.0
PROTOCOLS: Mapping[str, DriveProtocol] = {each.name: each for each in (
    DriveProtocol("canopen", 1, 1, 127, _canopen, True,
                  {"encoder_counts": 4096, "gear_ratio": 1.0, "torque_constant_Nm_per_A": 0.05,
                   "current_limit_A": 10.0}, "an assumption: CANopen names no motor"),
    DriveProtocol("odrive", 0, 0, 62, _odrive, True,
                  {"encoder_counts": 8192, "gear_ratio": 1.0, "torque_constant_Nm_per_A": 8.27 / 270.0,
                   "current_limit_A": 10.0, "supply_V": 24.0}, "an ODrive v3.6 with its D5065 motor of 270 rpm/V"),
    DriveProtocol("robomaster", 1, 1, 8, _robomaster, True,
                  {"encoder_counts": 8192, "gear_ratio": M3508_GEAR, "torque_constant_Nm_per_A": 0.3 / M3508_GEAR,
                   "current_limit_A": 20.0, "supply_V": 24.0, "winding_resistance_ohm": 0.194},
                  "a C620 with its M3508"),
    DriveProtocol("robomaster-c610", 1, 1, 8, _robomaster, True,
                  {"encoder_counts": 8192, "gear_ratio": 36.0, "torque_constant_Nm_per_A": 0.18 / 36.0,
                   "current_limit_A": 10.0, "supply_V": 24.0, "winding_resistance_ohm": 0.461},
                  "a C610 with its M2006"),
    DriveProtocol("moteus", 1, 1, 126, _moteus, False,
                  {"encoder_counts": 16384, "gear_ratio": 1.0, "torque_constant_Nm_per_A": 30.0 / math.pi / 330.0,
                   "current_limit_A": 20.0, "supply_V": 24.0}, "a moteus r4.11 with its motor of 330 rpm/V"))}
OF_MAP = replace(PROTOCOLS["canopen"], name="dbc", why_usual="an assumption: a map names no motor")
"""Drives whose targets are signals of a DBC; its numbers are those of no protocol."""
