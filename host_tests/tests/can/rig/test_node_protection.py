"""Protection of frames: the shipping C against independent implementations and against every small error."""

from __future__ import annotations

import random

import crccheck
import e2e.p02
import e2e.p05
import pytest

from laconic.can.rig.node_library import E2E_STATUS, node_library

NODE = node_library("double")
LIB, FFI = NODE.lib, NODE.ffi
COUNTING_IDS = bytes(range(1, 17))


def p22(data: bytes, ids: bytes) -> object:
    """What plain profile 22 begins and ends with."""
    return FFI.new("laconic_e2e_ends *", [0xFF, ids[data[1] & 15]])[0]


def p05(data_id: int) -> object:
    """What plain profile 5 begins and ends with."""
    return FFI.new("laconic_e2e_ends *", [0xFFFF, data_id])[0]


def crc8(data: bytes) -> int:
    """CRC-8H2F of a whole message by the node's code."""
    return LIB.laconic_crc8(0xFF, data, len(data)) ^ 0xFF


def random_payloads(count: int, length: int, seed: int = 5) -> list[bytearray]:
    """The same every time."""
    source = random.Random(seed)
    return [bytearray(source.randbytes(length)) for _ in range(count)]


@pytest.mark.parametrize("text, value", [("00000000", 0x12), ("F20183", 0xC2), ("0FAA0055", 0xC6),
                                         (b"123456789".hex(), 0xDF)])
def test_crc8h2f_gives_the_published_values(text: str, value: int) -> None:
    assert crc8(bytes.fromhex(text)) == value


def test_the_three_checksums_agree_with_crccheck() -> None:
    for data in (bytes(p) for length in (0, 1, 7, 64) for p in random_payloads(20, length, seed=length)):
        assert crc8(data) == crccheck.crc.Crc8Autosar.calc(data)
        assert LIB.laconic_crc16(0xFFFF, data, len(data)) == crccheck.crc.Crc16CcittFalse.calc(data)
        assert LIB.laconic_crc32(0xFFFFFFFF, data, len(data)) ^ 0xFFFFFFFF == crccheck.crc.Crc32.calc(data)


def test_profile_2_of_an_all_zero_frame_gives_the_published_bytes() -> None:
    headers = []
    for counter in [*range(1, 16), 0]:
        data = bytearray([0, counter, 0, 0, 0, 0, 0, 0])
        LIB.laconic_e2e_p22_protect(FFI.from_buffer(data), 8, p22(data, COUNTING_IDS), counter)
        headers.append(bytes(data[:2]).hex())
    assert headers[:4] == ["1b01", "9802", "3103", "0d04"] and headers[-1].endswith("00")


def test_profile_2_agrees_with_autosar_e2e_and_keeps_the_upper_half_of_byte_1() -> None:
    ids = bytes(random.Random(2).randbytes(16))
    for data in random_payloads(200, 8):
        counter, theirs = data[1] & 15, bytearray(data)
        e2e.p02.e2e_p02_protect(theirs, ids, length=8, increment_counter=False)
        upper = data[1] >> 4
        LIB.laconic_e2e_p22_protect(FFI.from_buffer(data), 8, p22(data, ids), counter)
        assert data == theirs and data[1] >> 4 == upper
        assert LIB.laconic_e2e_p22_crc_is_right(bytes(data), 8, p22(data, ids))
        data[5] ^= 4
        assert not LIB.laconic_e2e_p22_crc_is_right(bytes(data), 8, p22(data, ids))
        assert not e2e.p02.e2e_p02_check(data, ids, length=8)


@pytest.mark.parametrize("length", [3, 48, 64])
def test_profile_5_agrees_with_autosar_e2e(length: int) -> None:
    for data in random_payloads(100, length):
        data_id, theirs = int.from_bytes(data[:2], "big"), bytearray(data)
        e2e.p05.e2e_p05_protect(theirs, data_id, length=length, increment_counter=False)
        LIB.laconic_e2e_p05_protect(FFI.from_buffer(data), length, p05(data_id), data[2])
        assert data == theirs
        assert LIB.laconic_e2e_p05_crc_is_right(bytes(data), length, p05(data_id))
        assert not LIB.laconic_e2e_p05_crc_is_right(bytes(data), length, p05(data_id ^ 1))


def census(max_delta: int) -> tuple[list[int], list[int]]:
    """(found by CRC, found by counter, accepted) over all errors of 1 to 3 bits: counter kept, counter changed."""
    kept, changed = [0, 0, 0], [0, 0, 0]
    frames = random_payloads(16, 8, seed=22)
    for counter, data in enumerate(frames):
        data[1] = data[1] & 0xF0 | counter
        LIB.laconic_e2e_p22_protect(FFI.from_buffer(data), 8, p22(data, COUNTING_IDS), counter)
        found = FFI.new("laconic_error_census *")
        LIB.laconic_library_census(found, bytes(data), COUNTING_IDS, max_delta)
        kept = [a + b for a, b in zip(kept, found.counter_kept, strict=True)]
        changed = [a + b for a, b in zip(changed, found.counter_changed, strict=True)]
    return kept, changed


def test_every_error_of_one_two_or_three_bits_is_found_at_max_delta_counter_1() -> None:
    kept, changed = census(1)
    every = 16 * (64 + 64 * 63 // 2 + 64 * 63 * 62 // 6)
    assert sum(kept) + sum(changed) == every
    assert kept == [sum(kept), 0, 0]          # counter unchanged: the CRC finds all
    assert changed[2] == 0                    # counter changed: CRC or counter


def test_the_residual_of_larger_deltas_stays_what_is_documented(capsys: pytest.CaptureFixture[str]) -> None:
    residuals = {delta: census(delta)[1] for delta in (1, 2, 3, 5, 14)}
    with capsys.disabled():
        for delta, (by_crc, by_counter, accepted) in residuals.items():
            print(f"\n  MaxDeltaCounter {delta:2d}: of {by_crc + by_counter + accepted} errors that change the counter "
                  f"{accepted} pass ({accepted / (by_crc + by_counter + accepted):.1e})", end="")
    rates = [accepted / sum(counts) for *counts, accepted in residuals.values() if sum(counts)]
    assert rates == sorted(rates) and rates[0] == 0 and rates[-1] < 1 / 128


def statuses(frames: list[tuple[bool, int]], max_delta: int = 1, mask: int = 15) -> list[str]:
    """The outcomes of a fresh receiver for pairs (CRC right?, counter), one after the other."""
    receiver = NODE.receiver()
    return [E2E_STATUS[LIB.laconic_e2e_check(receiver, right, counter, mask, max_delta)] for right, counter in frames]


def test_the_status_machine_reports_what_happened() -> None:
    assert statuses([(True, 7), (True, 8), (True, 8), (True, 11), (False, 9), (True, 9)]) == [
        "ok", "ok", "repeated", "wrong sequence", "error", "ok"]
    assert statuses([(True, 14), (True, 1)], max_delta=3) == ["ok", "ok some lost"]
    assert statuses([(True, 254), (True, 255), (True, 0)], mask=255) == ["ok", "ok", "ok"]


def test_a_rejected_frame_never_rewinds_the_counter() -> None:
    old_burst = [(True, 3), (True, 4)]
    assert statuses([(True, 9), *old_burst, (True, 10)]) == ["ok", "wrong sequence", "wrong sequence", "ok"]
    assert statuses([(True, 9), (False, 3), (True, 10)]) == ["ok", "error", "ok"]


def test_a_sender_that_restarted_is_taken_again_after_three_frames_in_a_row() -> None:
    assert statuses([(True, 9), (True, 1), (True, 2), (True, 3), (True, 4)]) == [
        "ok", "wrong sequence", "wrong sequence", "ok", "ok"]
