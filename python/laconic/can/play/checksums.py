"""Checksums of messages by their usual names.

The checksum's own bits count as zero in sums, and its byte is left out of a CRC, which takes the others from the first
to the last, or with `order = "last first"` the other way round, and then the bytes of `after`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import reduce

import e2e.crc
import e2e.p01
import e2e.p02
import e2e.p05
import e2e.p11

from laconic.scene.table import Table

E2E_WIDTHS = {"e2e-profile-1": 8, "e2e-profile-2": 8, "e2e-profile-5": 16, "e2e-profile-11": 8}
E2E_COUNTERS = {"e2e-profile-1": (8, 4), "e2e-profile-2": (8, 4), "e2e-profile-5": (16, 8), "e2e-profile-11": (8, 4)}
"""First bit and bits of the counter, where AUTOSAR's usual offset 0 puts it."""
COUNTS_TO_14 = ("e2e-profile-1", "e2e-profile-11")  # a counter of 15 is no counter there
WIDTHS: Mapping[str, int] = {"crc8-sae-j1850": 8, "crc8-h2f": 8, "crc8-d5": 8, "crc16-ccitt-false": 16,
                             **E2E_WIDTHS}
"""Bits of the checksums whose signal must have so many, and whole bytes; sums take what their signal has."""
SUMS = ("xor", "sum", "sum-inverted", "sum-with-id")
CHECKSUMS = (*SUMS, *WIDTHS)


@dataclass(frozen=True)
class Checksum:
    """A checksum by its name; `after`: bytes that follow the payload in a CRC; `data_id` or sixteen of them for E2E."""

    signal: str
    kind: str
    after: bytes = b""
    data_ids: tuple[int, ...] = ()
    last_first: bool = False

    @property
    def width(self) -> int | None:
        """The bits that its signal must have; None: any number."""
        return WIDTHS.get(self.kind)

    def of(self, payload: bytes, identifier: int, at: slice) -> int:
        """The checksum of a payload whose own checksum bits are zero; `at`: its bytes, as many as the width needs."""
        if self.kind in SUMS:
            return _sum(self.kind, payload, identifier)
        if self.kind in E2E_WIDTHS:
            return self._e2e(payload, at)
        rest = payload[: at.start] + payload[at.stop :]
        return CRCS[self.kind]((rest[::-1] if self.last_first else rest) + self.after)

    def _e2e(self, payload: bytes, at: slice) -> int:
        """As AUTOSAR protects the payload; the counter in it stays."""
        data, first = bytearray(payload), self.data_ids[0]
        if self.kind == "e2e-profile-2":
            e2e.p02.e2e_p02_protect(data, bytes(self.data_ids), increment_counter=False)
        elif self.kind == "e2e-profile-1":
            e2e.p01.e2e_p01_protect(data, first, increment_counter=False)
        elif self.kind == "e2e-profile-11":
            e2e.p11.e2e_p11_protect(data, first, increment_counter=False)
        else:
            e2e.p05.e2e_p05_protect(data, first, increment_counter=False)
        return int.from_bytes(data[at], "little")


def _sum(kind: str, payload: bytes, identifier: int) -> int:
    """Sums of bytes; with the identifier as Toyota has it: its bytes and the length are added."""
    if kind == "xor":
        return reduce(lambda a, b: a ^ b, payload, 0)
    total = sum(payload)
    if kind == "sum-with-id":
        return total + sum(identifier.to_bytes(4, "big")) + len(payload)
    return ~total if kind == "sum-inverted" else total


def _crc8_d5(data: bytes) -> int:
    """Polynomial 0xD5, beginning with 0xFF, as comma's body and pedal have it."""
    crc = 0xFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc << 1) ^ (0x1D5 if crc & 0x80 else 0)
    return crc


CRCS: Mapping[str, Callable[[bytes], int]] = {
    "crc8-sae-j1850": e2e.crc.calculate_crc8, "crc8-h2f": e2e.crc.calculate_crc8_h2f,
    "crc8-d5": _crc8_d5, "crc16-ccitt-false": e2e.crc.calculate_crc16}
ORDERS = ("first first", "last first")


def read_checksum(table: Table) -> Checksum:
    """`checksum = { signal, kind, … }` of a message in a map."""
    signal, kind = table.text("signal"), table.choice("kind", CHECKSUMS)
    after = bytes(_whole(table, "after", 255)) if table.has("after") else b""
    if after and kind not in CRCS:
        table.fail("after", f"is for {', '.join(CRCS)}; take it out")
    last_first = table.has("order") and table.choice("order", ORDERS) == "last first"
    if last_first and kind not in CRCS:
        table.fail("order", f"is for {', '.join(CRCS)}; take it out")
    ids = _ids(table, kind)
    table.done()
    return Checksum(signal, kind, after, ids, last_first)


def _ids(table: Table, kind: str) -> tuple[int, ...]:
    """The data id of an E2E profile; profile 2 has sixteen."""
    if kind not in E2E_WIDTHS:
        if table.has("data_id"):
            table.fail("data_id", f"is for {', '.join(E2E_WIDTHS)}; take it out, or give its bytes as after")
        return ()
    if kind == "e2e-profile-2":
        ids = _whole(table, "data_id", 255)
        if len(ids) != 16:
            table.fail("data_id", f"has {len(ids)} entries; e2e-profile-2 has sixteen, one for each value of the "
                       "counter")
        return ids
    given = table.whole("data_id")
    if not 0 <= given <= 0xFFFF:
        table.fail("data_id", f"is {given}; give a number of 16 bits")
    return (given,)


def _whole(table: Table, key: str, largest: int) -> tuple[int, ...]:
    values = table.value(key, ..., (list,), "a list of whole numbers")
    for value in values:
        if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value <= largest:
            table.fail(key, f"holds {str(value).lower()}; give whole numbers from 0 to {largest}")
    return tuple(values)
