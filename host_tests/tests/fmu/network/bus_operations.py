"""Bus operations of FMI-LS-BUS 1.0 for CAN, written and read independently of the FMUs, and one FMU driven by hand."""

from __future__ import annotations

import struct
from collections.abc import Iterable
from pathlib import Path

from laconic.fmu.bus_importer import NetworkFmu

FORMAT_ERROR, TRANSMIT, FD_TRANSMIT, CONFIRM, LOST, ERROR, CONFIGURATION, STATUS = (
    0x01, 0x10, 0x11, 0x20, 0x30, 0x31, 0x40, 0x41)
Operation = tuple[int, bytes]
"""Code and arguments."""


def operation(code: int, arguments: bytes) -> bytes:
    """One operation as bytes."""
    return struct.pack("<II", code, 8 + len(arguments)) + arguments


def frame(identifier: int, data: bytes, *, extended: bool = False) -> bytes:
    """CAN Transmit."""
    return operation(TRANSMIT, struct.pack("<I??H", identifier, extended, False, len(data)) + data)


def fd_frame(identifier: int, data: bytes) -> bytes:
    """CAN FD Transmit with bit rate switch."""
    return operation(FD_TRANSMIT, struct.pack("<I???H", identifier, False, True, False, len(data)) + data)


def of_id(code: int, identifier: int) -> bytes:
    """Confirm or Arbitration Lost."""
    return operation(code, struct.pack("<I", identifier))


def bus_error(identifier: int, *, is_sender: bool, flag: int = 2) -> bytes:
    """A CRC error."""
    return operation(ERROR, struct.pack("<IBB?", identifier, 4, flag, is_sender))


def operations(data: bytes) -> list[Operation]:
    """All operations in a row."""
    found, at = [], 0
    while at < len(data):
        code, length = struct.unpack_from("<II", data, at)
        assert 8 <= length <= len(data) - at
        found.append((code, data[at + 8:at + length]))
        at += length
    return found


def frames_in(found: Iterable[Operation]) -> list[tuple[int, bytes]]:
    """Identifier and data of each frame, of CAN and of CAN FD."""
    rows = []
    for code, arguments in found:
        if code in (TRANSMIT, FD_TRANSMIT):
            head = 8 if code == TRANSMIT else 9
            assert struct.unpack_from("<H", arguments, head - 2)[0] == len(arguments) - head
            rows.append((struct.unpack_from("<I", arguments)[0], arguments[head:]))
    return rows


class ByHand:
    """One FMU without others: a communication point sends what is given and returns what comes."""

    def __init__(self, path: Path, **values: float):
        self.fmu, self.time_s = NetworkFmu(path), 0.0
        for name, value in values.items():
            self.fmu.set(name, value)
        self.fmu.slave.enterInitializationMode(startTime=0.0)
        self.fmu.slave.exitInitializationMode()
        self.first = self.event()

    def __enter__(self) -> ByHand:
        return self

    def __exit__(self, *_: object) -> None:
        self.fmu.close()

    def event(self, **given: bytes) -> dict[str, list[Operation]]:
        """The iterations of one communication point: `given` by terminal is received in the first."""
        sent: dict[str, list[Operation]] = {name: [] for name in self.fmu.terminals}
        for iteration in range(10):
            for name, terminal in self.fmu.terminals.items():
                if self.fmu.ticks(terminal, self.time_s):
                    sent[name] += operations(self.fmu.sent(terminal))
                if iteration == 0 and name in given:
                    self.fmu.receive(terminal, given[name])
            if not self.fmu.slave.updateDiscreteStates()[0]:
                break
            assert iteration < 9
        self.fmu.announce(self.time_s)
        self.fmu.slave.enterStepMode()
        return sent

    def step(self, until_s: float, **given: bytes) -> dict[str, list[Operation]]:
        """Time passes; then what has been sent comes, and what is given is received."""
        self.fmu.slave.doStep(self.time_s, until_s - self.time_s)
        self.time_s = until_s
        self.fmu.slave.enterEventMode()
        return self.event(**given)
