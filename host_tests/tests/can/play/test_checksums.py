"""Counters and checksums of maps: each by its name, against implementations that are not ours, in both directions."""

from __future__ import annotations

import random
from pathlib import Path

import e2e.p01
import e2e.p02
import e2e.p05
import e2e.p11
import pytest
from crccheck.crc import Crc8Autosar, Crc8Base, Crc8SaeJ1850, Crc16CcittFalse

from laconic.can.dbc_file import load_dbc
from laconic.can.play.checksums import CHECKSUMS, Checksum
from laconic.can.play.map_dbc import DbcMessage
from laconic.can.play.map_file import Conversion, Counter, Joint, Received, Sent
from laconic.can.play.map_messages import Receiver, Sender
from laconic.errors import BadInput

IDS = tuple(range(16, 32))
DBC = """VERSION ""
BU_: A
BO_ 1600 GUARDED: 8 A
 SG_ Check : {check} (1,0) [0|0] "" A
 SG_ Count : {count} (1,0) [0|0] "" A
 SG_ Value : {value} (0.5,0) [0|0] "" A
 SG_ Float : {other} (1,0) [0|0] "" A
"""
BYTE_0, WORD_0, LAST = "0|8@1+", "0|16@1+", "40|8@1+"
COUNT_1, COUNT_2 = "8|4@1+", "16|8@1+"


def message_of(tmp_path: Path, check: str, count: str, value: str = "55|16@0-", other: str = "24|16@1-"
               ) -> DbcMessage:
    path = tmp_path / "guarded.dbc"
    path.write_text(DBC.format(check=check, count=count, value=value, other=other), encoding="utf-8")
    return DbcMessage(path, load_dbc(path, "--dbc"), "map: send[1]", "GUARDED")


def pair(message: DbcMessage, checksum: Checksum) -> tuple[Sender, Receiver]:
    """Both ends of one message."""
    counter = Counter("Count")
    sent = Joint("send[1].signal[1]", "Value", "x_m", Conversion())
    received = Joint("receive[1].signal[1]", "Value", "body_moment_Nm")
    return (Sender(Sent("send[1]", "GUARDED", (sent,), counter, checksum, 0.01), message),
            Receiver(Received("receive[1]", "GUARDED", (received,), counter, checksum), message))


def frames_of(sender: Sender, count: int) -> list[bytes]:
    """The next payloads, with changing values."""
    chance = random.Random(5)
    return [next(iter(sender.payloads(lambda _: chance.uniform(-1000.0, 1000.0)))) for _ in range(count)]


class Crc8D5(Crc8Base):  # type: ignore[misc]
    """By a second implementation."""

    _poly, _initvalue = 0xD5, 0xFF


class Crc8OfProfile1(Crc8Base):  # type: ignore[misc]
    """SAE J1850 without its initial and final value, as AUTOSAR's profiles 1 and 11 have it."""

    _poly = 0x1D


def cut(frame: bytes, at: int) -> bytes:
    return frame[:at] + frame[at + 1 :]


CASES = {
    "xor": (LAST, lambda f: f[5] == f[0] ^ f[1] ^ f[2] ^ f[3] ^ f[4] ^ f[6] ^ f[7]),
    "sum": (LAST, lambda f: f[5] == sum(cut(f, 5)) & 255),
    "sum-inverted": (LAST, lambda f: f[5] == 255 - (sum(cut(f, 5)) & 255)),
    "sum-with-id": (LAST, lambda f: f[5] == sum(cut(f, 5)) + 0x06 + 0x40 + 8 & 255),
    "crc8-sae-j1850": (LAST, lambda f: f[5] == Crc8SaeJ1850.calc(cut(f, 5) + b"\x17")),
    "crc8-h2f": (LAST, lambda f: f[5] == Crc8Autosar.calc(cut(f, 5) + b"\x17")),
    "crc8-d5": (LAST, lambda f: f[5] == Crc8D5.calc(cut(f, 5) + b"\x17")),
    "crc16-ccitt-false": (WORD_0, lambda f: int.from_bytes(f[:2], "little") == Crc16CcittFalse.calc(f[2:] + b"\x17")),
    "e2e-profile-1": (BYTE_0, lambda f: e2e.p01.e2e_p01_check(bytearray(f), 0x1234)),
    "e2e-profile-2": (BYTE_0, lambda f: e2e.p02.e2e_p02_check(bytearray(f), bytes(IDS))),
    "e2e-profile-5": (WORD_0, lambda f: e2e.p05.e2e_p05_check(bytearray(f), 0x1234)),
    "e2e-profile-11": (BYTE_0, lambda f: e2e.p11.e2e_p11_check(bytearray(f), 0x1234))}


@pytest.mark.parametrize("kind", CASES)
def test_a_checksum_is_that_of_its_name_and_a_frame_with_a_wrong_bit_is_refused(kind: str, tmp_path: Path) -> None:
    check, is_right = CASES[kind]
    after = b"\x17" if kind.startswith("crc") else b""
    ids = IDS if kind == "e2e-profile-2" else (0x1234,) if kind.startswith("e2e") else ()
    message = message_of(tmp_path, check, COUNT_2 if check == WORD_0 else COUNT_1)
    sender, receiver = pair(message, Checksum("Check", kind, after, ids))
    frames = frames_of(sender, 20)
    assert all(is_right(frame) for frame in frames)
    assert all(receiver.take(frame)[1] is None for frame in frames)
    for bit in range(64):
        spoilt = bytearray(frames[-1])
        spoilt[bit // 8] ^= 1 << bit % 8
        assert receiver.take(bytes(spoilt))[1] == "wrong checksum", bit


def low_and_high(data_id: int) -> bytes:
    return data_id.to_bytes(2, "little")


E2E_BY_HAND = {  # from AUTOSAR's layout: over the payload without its CRC, the data id where the profile has it
    "e2e-profile-1": lambda f: f[0] == Crc8OfProfile1.calc(low_and_high(0x1234) + f[1:]),
    "e2e-profile-2": lambda f: f[0] == Crc8Autosar.calc(f[1:] + bytes([IDS[f[1] & 15]])),
    "e2e-profile-5": lambda f: f[:2] == low_and_high(Crc16CcittFalse.calc(f[2:] + low_and_high(0x1234))),
    "e2e-profile-11": lambda f: f[0] == Crc8OfProfile1.calc(low_and_high(0x1234) + f[1:])}


@pytest.mark.parametrize("kind", E2E_BY_HAND)
def test_e2e_profiles_are_those_of_a_second_implementation(kind: str, tmp_path: Path) -> None:
    check, _ = CASES[kind]
    ids = IDS if kind == "e2e-profile-2" else (0x1234,)
    sender, _ = pair(message_of(tmp_path, check, COUNT_2 if check == WORD_0 else COUNT_1),
                     Checksum("Check", kind, b"", ids))
    assert all(E2E_BY_HAND[kind](frame) for frame in frames_of(sender, 40))


def test_comma_s_body_has_its_crc_from_the_last_byte_to_the_first(tmp_path: Path) -> None:
    """The last CRC is that of a long division by hand."""
    message = message_of(tmp_path, "56|8@1+", COUNT_1, value="23|16@0-", other="32|16@1-")
    sender, receiver = pair(message, Checksum("Check", "crc8-d5", last_first=True))
    for frame in frames_of(sender, 20):
        assert frame[7] == Crc8D5.calc(frame[6::-1]) and receiver.take(frame)[1] is None
    assert Checksum("Check", "crc8-d5", last_first=True).of(b"\x00\x64\xff\x9c\x00\x01\x00\x00", 0x250, slice(7, 8)) \
        == 0xD2


def test_every_checksum_has_its_case() -> None:
    assert set(CASES) == set(CHECKSUMS)


def test_a_value_passes_both_ways_within_half_of_its_resolution(tmp_path: Path) -> None:
    sender, receiver = pair(message_of(tmp_path, LAST, COUNT_1), Checksum("Check", "xor"))
    for value in (-1000.3, -0.2, 0.0, 0.3, 16383.4):
        frame, = sender.payloads(lambda _, value=value: value)  # type: ignore[misc]
        values, reason = receiver.take(frame)
        assert reason is None and abs(values["body_moment_Nm"] - value) <= 0.25


def test_a_value_that_does_not_fit_is_cut_to_its_range_and_counted(tmp_path: Path) -> None:
    sender, receiver = pair(message_of(tmp_path, LAST, COUNT_1), Checksum("Check", "xor"))
    frame, = sender.payloads(lambda _: 1e9)
    assert receiver.take(frame)[0]["body_moment_Nm"] == 16383.5 and sender.cut.count == 1


def test_a_counter_that_does_not_count_is_refused_and_is_the_next_reference(tmp_path: Path) -> None:
    message = message_of(tmp_path, LAST, COUNT_1)
    checksum = Checksum("Check", "xor")
    sender, _ = pair(message, checksum)
    joint = Joint("receive[1].signal[1]", "Value", "body_moment_Nm")
    receiver = Receiver(Received("receive[1]", "GUARDED", (joint,), Counter("Count", None, 2), checksum), message)
    frames = frames_of(sender, 40)
    reasons = [receiver.take(frames[number])[1] for number in (0, 1, 1, 3, 4, 7, 8, 16, 17, 19)]
    assert reasons == [None, None, "repeated", None, None, "wrong count", None, "wrong count", None, None]


def test_a_signal_that_holds_no_checksum_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="needs 16 in whole bytes"):
        pair(message_of(tmp_path, LAST, COUNT_1), Checksum("Check", "crc16-ccitt-false"))
