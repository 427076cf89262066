"""Packets of RTPS 2.3 to and from bytes, as far as services need them. We write little endian and read both."""

from __future__ import annotations

import socket
import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from types import SimpleNamespace

HERE = b"\x01\x3f"                     # of vendors, which no other has; also the first bytes of our GUIDs
OF_CYCLONE, OF_FAST = b"\x01\x10", b"\x01\x0f"
SPDP, PUBLICATIONS, SUBSCRIPTIONS = b"\x00\x01\x00\xc2", b"\x00\x00\x03\xc2", b"\x00\x00\x04\xc2"  # writers
ALL_ENDPOINTS = 0x3F                   # writers and readers of these three
PORTS = SimpleNamespace(base=7400, domain=250, meta=10, user=11, participant=2, participant_entity=b"\x00\x00\x01\xc1")
ACKNACK, HEARTBEAT, GAP, TIME, SOURCE, TARGET, DATA = 0x06, 0x07, 0x08, 0x09, 0x0C, 0x0E, 0x15
LITTLE, FINAL = 1, 2                   # flags
WITH_INLINE, WITH_DATA, WITH_KEY = 2, 4, 8
SENTINEL, STATUS, KEY_HASH = 0x0001, 0x0071, 0x0070
RELATED = (0x0083, 0x800F)             # the identity of the request: of the standard, and of older Fast DDS
MOST_NUMBERS = 256


@dataclass
class Submessage:
    """One of those that are read: who sent it to whom, and what of it is used."""

    kind: int
    vendor: bytes
    prefix: bytes                       # of the sender
    to: bytes                           # prefix of the receiver; 0: everybody
    reader: bytes = bytes(4)
    writer: bytes = bytes(4)
    first: int = 0                      # DATA: its number; HEARTBEAT, GAP: the first; ACKNACK: the next awaited
    last: int = 0                       # HEARTBEAT: the last; GAP: the number behind its first stretch
    numbers: Sequence[int] = ()         # ACKNACK: what is asked for; GAP: further ones
    payload: bytes = b""                # DATA: with its four bytes of encapsulation
    related: bytes = b""                # DATA: GUID and number of an identity
    status: int = 0                     # DATA: 1 disposed, 2 unregistered
    is_final: bool = False


# ---- writing

def packet(prefix: bytes, to: bytes, submessages: Sequence[bytes]) -> bytes:
    """A whole packet, to one participant or to everybody."""
    target = struct.pack("<BBH", TARGET, LITTLE, 12) + to if to else b""
    return b"RTPS\x02\x03" + HERE + prefix + target + b"".join(submessages)


def _submessage(kind: int, flags: int, body: bytes) -> bytes:
    body += bytes(-len(body) % 4)
    return struct.pack("<BBH", kind, flags | LITTLE, len(body)) + body


def number_bytes(value: int) -> bytes:
    """The number of a change."""
    return struct.pack("<iI", value >> 32, value & 0xFFFFFFFF)


def data(reader: bytes, writer: bytes, number: int, payload: bytes, *, inline: bytes = b"", status: int = 0,
         is_key: bool = False, key: bytes = b"") -> bytes:
    """One change of a writer."""
    if status:
        inline += struct.pack("<HHBBBB", STATUS, 4, 0, 0, 0, status)
    if key:
        inline += struct.pack("<HH", KEY_HASH, 16) + key
    inline += struct.pack("<HH", SENTINEL, 0) if inline else b""
    flags = (WITH_INLINE if inline else 0) | (WITH_KEY if is_key else WITH_DATA)
    head = struct.pack("<HH", 0, 16) + reader + writer + number_bytes(number)
    return _submessage(DATA, flags, head + inline + payload)


def heartbeat(reader: bytes, writer: bytes, first: int, last: int, count: int) -> bytes:
    """What a writer has; its reader answers."""
    numbers = number_bytes(first) + number_bytes(last) + struct.pack("<i", count)
    return _submessage(HEARTBEAT, 0, reader + writer + numbers)


def _numbers(base: int, numbers: Sequence[int]) -> bytes:
    """A set of numbers from `base` on."""
    if not numbers:
        return number_bytes(base) + struct.pack("<I", 0)
    count = numbers[-1] - base + 1
    words = [0] * ((count + 31) // 32)
    for each in numbers:
        words[(each - base) // 32] |= 1 << (31 - (each - base) % 32)
    return number_bytes(base) + struct.pack(f"<I{len(words)}I", count, *words)


def acknack(writer: bytes, reader: bytes, awaited: int, missing: Sequence[int], count: int) -> bytes:
    """What a reader has, and what it asks for again."""
    flags = 0 if missing or awaited == 1 else FINAL
    return _submessage(ACKNACK, flags, reader + writer + _numbers(awaited, missing) + struct.pack("<i", count))


def gap(reader: bytes, writer: bytes, first: int, behind: int) -> bytes:
    """Numbers that do not come any more."""
    return _submessage(GAP, 0, reader + writer + number_bytes(first) + _numbers(behind, ()))


def parameters(entries: Sequence[tuple[int, bytes]]) -> bytes:
    """A list of parameters with its encapsulation."""
    found = [struct.pack("<HH", pid, len(value) + -len(value) % 4) + value + bytes(-len(value) % 4)
             for pid, value in entries]
    return b"\x00\x03\x00\x00" + b"".join(found) + struct.pack("<HH", SENTINEL, 0)


def identity_parameters(identity: bytes) -> bytes:
    """Inline, without an end: the request that a response belongs to."""
    return b"".join(struct.pack("<HH", pid, len(identity)) + identity for pid in RELATED)


def text_parameter(text: str, ends: bool = True) -> bytes:
    """A string, or a sequence of bytes without the zero at its end."""
    content = text.encode() + (b"\0" if ends else b"")
    return struct.pack("<I", len(content)) + content


def locator(address: str, port: int) -> bytes:
    """UDP over IPv4."""
    return struct.pack("<iI", 1, port) + bytes(12) + socket.inet_aton(address)


# ---- reading

def number_of(value: bytes) -> int:
    """A 32-bit number that `parameters_of` has made little endian."""
    return int(struct.unpack_from("<I", value)[0])


def parameters_of(payload: bytes) -> list[tuple[int, bytes]]:
    """Entries of a list; of one in big endian the numbers that we use are turned."""
    is_little = payload[1] & 1
    return [(pid, value if is_little else _turned(value)) for pid, value, _ in _entries(payload, 4, is_little)]


def _turned(value: bytes) -> bytes:
    """The first words of a value in the other order: lengths of texts, kinds and ports of locators, durations."""
    count = 1 if len(value) not in (8, 24) else 2
    return b"".join(value[at : at + 4][::-1] for at in range(0, 4 * count, 4)) + value[4 * count :] \
        if len(value) != 16 else value  # a GUID is bytes


def _entries(payload: bytes, at: int, is_little: int) -> Iterator[tuple[int, bytes, int]]:
    form = "<HH" if is_little else ">HH"
    while at + 4 <= len(payload):
        pid, length = struct.unpack_from(form, payload, at)
        at += 4 + length
        if pid == SENTINEL:
            yield pid, b"", at - length
            return
        if at > len(payload):
            raise ValueError("a parameter is cut")
        yield pid, payload[at - length : at], at
    raise ValueError("a list of parameters has no end")


def packets_of(whole: bytes) -> Iterator[Submessage]:
    """Submessages of a packet that services use; ValueError or struct.error for what is not RTPS."""
    if whole[:4] != b"RTPS" or len(whole) < 20:
        raise ValueError("not RTPS")
    vendor, prefix, to, at = whole[6:8], whole[8:20], bytes(12), 20
    while at + 4 <= len(whole):
        kind, flags = whole[at], whole[at + 1]
        order = "<" if flags & LITTLE else ">"
        length = struct.unpack_from(f"{order}H", whole, at + 2)[0] or (len(whole) - at - 4 if kind != TIME else 0)
        body = whole[at + 4 : at + 4 + length]
        at += 4 + length
        if kind == TARGET:
            to = body[:12]
        elif kind == SOURCE:
            vendor, prefix = body[6:8], body[8:20]
        elif kind in (ACKNACK, HEARTBEAT, GAP, DATA):
            made = Submessage(kind, vendor, prefix, to, is_final=bool(flags & FINAL))
            (_read_data if kind == DATA else _read_other)(made, body, flags, order)
            yield made


def _wide(order: str, body: bytes, at: int) -> int:
    high, low = struct.unpack_from(f"{order}iI", body, at)
    return int(high) << 32 | int(low)


def _read_data(made: Submessage, body: bytes, flags: int, order: str) -> None:
    at = 4 + struct.unpack_from(f"{order}H", body, 2)[0]
    made.reader, made.writer, made.first = body[4:8], body[8:12], _wide(order, body, 12)
    if flags & WITH_INLINE:
        for pid, value, behind in _entries(body, at, flags & LITTLE):
            at = behind
            if pid == STATUS:
                made.status = value[3]
            elif pid in RELATED and len(value) >= 24:
                made.related = value[:24]
    if flags & (WITH_DATA | WITH_KEY):
        made.payload = body[at:]


def _read_other(made: Submessage, body: bytes, flags: int, order: str) -> None:
    made.reader, made.writer, made.first = body[:4], body[4:8], _wide(order, body, 8)
    if made.kind == HEARTBEAT:
        made.last = _wide(order, body, 16)
    elif made.kind == ACKNACK:
        made.numbers = _set_at(order, body, 8)
    else:
        made.last, made.numbers = _wide(order, body, 16), _set_at(order, body, 16)


def _set_at(order: str, body: bytes, at: int) -> list[int]:
    base, count = _wide(order, body, at), min(struct.unpack_from(f"{order}I", body, at + 8)[0], MOST_NUMBERS)
    words = struct.unpack_from(f"{order}{(count + 31) // 32}I", body, at + 12)
    return [base + each for each in range(count) if words[each // 32] >> (31 - each % 32) & 1]
