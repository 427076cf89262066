"""What a DBC may hold, against bits that are put together here: nested multiplexers, floats, CAN FD, 29-bit frames,
Motorola signals that cross bytes, enumerations, and limits that cut."""

from __future__ import annotations

import struct
from pathlib import Path

import can
import pytest

from laconic.can.dbc_file import load_dbc
from laconic.can.play.map_dbc import DbcMessage
from laconic.can.play.map_file import Joint, Received, Sent
from laconic.can.play.map_messages import Receiver, Sender
from play_support import PLAY, played

DBC = PLAY / "features.dbc"
REALS = 0x18FEF000


def bits(*signals: tuple[int, int, int, bool], length: int = 8) -> bytes:
    """A payload of (first bit as a DBC has it, bits, raw value, Motorola order), bit by bit."""
    payload = bytearray(length)
    for start, count, raw, is_motorola in signals:
        place = start
        for number in range(count):
            shift = count - 1 - number if is_motorola else number
            payload[place // 8] |= (raw >> shift & 1) << place % 8
            place += (1 if not is_motorola else -1 if place % 8 else 15)
    return bytes(payload)


def message(name: str) -> DbcMessage:
    """One message of the DBC."""
    return DbcMessage(DBC, load_dbc(DBC, "--dbc"), f"map: {name}", name)


def receiver(name: str, **targets: str) -> Receiver:
    """A received message with its signals joined."""
    joints = tuple(Joint(f"receive[1].{signal}", signal, model) for signal, model in targets.items())
    return Receiver(Received("receive[1]", name, joints), message(name))


def sender(*joints: Joint) -> Sender:
    """STATE, all pages at once."""
    return Sender(Sent("send[1]", "STATE", joints, None, None, 0.01, pages="together"), message("STATE"))


def test_signals_of_nested_multiplexers_are_taken_from_their_own_pages_alone() -> None:
    nested = receiver("NESTED", Left="voltage_V[1]", Right="voltage_V[2]", Moment="body_moment_Nm",
                      Always="body_force_N[1]")
    always = (56, 8, 7, False)
    left = bits((0, 4, 1, False), (4, 4, 0, False), (8, 16, -250 & 0xFFFF, False), always)
    assert nested.take(left) == ({"voltage_V[1]": -2.5, "body_force_N[1]": 7.0}, None)
    for part in (3, 5, 6):
        right = bits((0, 4, 1, False), (4, 4, part, False), (15, 16, 123, True), always)
        assert nested.take(right) == ({"voltage_V[2]": 1.23, "body_force_N[1]": 7.0}, None)
    moment = bits((0, 4, 2, False), (8, 8, 0xFE, False), always)
    assert nested.take(moment) == ({"body_moment_Nm": -1.0, "body_force_N[1]": 7.0}, None)
    for mode, part in ((1, 4), (3, 0), (0, 3)):
        values, reason = nested.take(bits((0, 4, mode, False), (4, 4, part, False), always))
        assert values == {} and reason == "wrong length or page"


@pytest.mark.parametrize("single, double", [(1.5, -2.25), (-0.1, 1e300), (0.0, 5e-324), (3e38, -1e-300)])
def test_floats_of_32_and_64_bits_in_both_orders_are_taken_as_they_are(single: float, double: float) -> None:
    reals = receiver("REALS", Single="body_force_N[1]", Double="body_moment_Nm")
    payload = struct.pack("<f", single) + struct.pack(">d", double) + bytes(4)
    values, reason = reals.take(payload)
    assert reason is None and values["body_force_N[1]"] == struct.unpack("<f", struct.pack("<f", single))[0]
    assert values["body_moment_Nm"] == double * 2.0 + 1.0


@pytest.mark.parametrize("wrong", [float("nan"), float("inf"), -float("inf")])
def test_a_float_that_is_no_number_is_refused_and_moves_nothing(wrong: float) -> None:
    reals = receiver("REALS", Single="body_force_N[1]", Double="body_moment_Nm")
    values, reason = reals.take(struct.pack("<f", 1.0) + struct.pack(">d", wrong) + bytes(4))
    assert values == {} and reason == "a value that is not finite"


def test_motorola_signals_that_cross_bytes_and_enumerations_are_numbers() -> None:
    crossing = receiver("CROSSING", Twelve="voltage_V[1]", Seven="voltage_V[2]", Gear="body_force_N[2]")
    for twelve, seven, gear in ((-2048, 0, 4), (2047, 127, 1), (-1, 64, 0), (0x555, 42, 7)):
        payload = bits((3, 12, twelve & 0xFFF, True), (18, 7, seven, True), (40, 3, gear, False))
        values, reason = crossing.take(payload)
        assert reason is None
        assert values == {"voltage_V[1]": pytest.approx(0.1 * twelve), "voltage_V[2]": seven - 10.0,
                          "body_force_N[2]": float(gear)}


def test_pages_of_nested_multiplexers_are_sent_with_their_own_signals_and_those_of_every_frame() -> None:
    state = sender(Joint("s1", "X", "x_m"), Joint("s2", "Y", "y_m"), Joint("s3", "Clipped", "heading_rad"),
                   Joint("s4", "Far", "time_s"), Joint("s5", "Kind", "", constant=9))
    read = {"x_m": -123.4567, "y_m": 0.1, "heading_rad": 0.75, "time_s": 1 / 3}
    kind, far = (64, 4, 9, False), struct.pack(">d", 1 / 3)

    def framed(*signals: tuple[int, int, int, bool]) -> bytes:
        plain = bytearray(bits(*signals, kind, length=24))
        plain[16:24] = far
        return bytes(plain)

    y = int.from_bytes(struct.pack("<f", 0.1), "little")
    assert sorted(state.payloads(read.__getitem__)) == sorted([
        framed((0, 8, 1, False), (23, 21, -123457 & 0x1FFFFF, True)),
        framed((0, 8, 2, False), (8, 8, 5, False), (16, 32, y, False)),
        framed((0, 8, 2, False), (8, 8, 3, False), (19, 5, round((0.75 + 4) / 0.5), True))])
    assert state.cut.count == 0


@pytest.mark.parametrize("value, shown", [(-3.0, -3.0), (-3.4, -3.0), (6.0, 6.0), (6.4, 6.0), (1e9, 6.0), (-1e9, -3.0)])
def test_a_value_beyond_the_limits_of_the_dbc_is_cut_to_them_and_counted(value: float, shown: float) -> None:
    state = sender(Joint("s1", "Clipped", "x_m"))
    frame, = state.payloads(lambda _: value)
    assert frame == bits((0, 8, 2, False), (8, 8, 3, False), (19, 5, round((shown + 4) / 0.5), True), length=24)
    assert state.cut.count == (value != shown)


def test_a_frame_of_can_fd_with_29_bits_moves_the_vehicle_and_its_states_are_fd_frames(tmp_path: Path) -> None:
    path = tmp_path / "map.toml"
    path.write_text("""
[[receive]]
message = "REALS"
[[receive.signal]]
name = "Single"
to = "body_force_N[1]"
[[send]]
message = "STATE"
period_s = 0.01
[[send.signal]]
name = "Far"
from = "x_m"
""", encoding="utf-8")
    payload = struct.pack("<f", 2.0) + bytes(12)
    flags = {"is_extended_id": True, "is_fd": True, "data": payload}
    right = can.Message(arbitration_id=REALS, **flags)
    wrong = [can.Message(arbitration_id=REALS & 0x7FF, is_extended_id=False, is_fd=True, data=payload),
             can.Message(arbitration_id=REALS, is_extended_id=True, data=payload[:8])]
    positions = {}
    for name, frame in (("right", right), ("short id", wrong[0]), ("classic", wrong[1])):
        judgement, controller = played("turtlebot3_burger", 0.5, lambda _, frame=frame: [frame],  # type: ignore[misc]
                                       dbc=DBC, map_path=path)
        _, last = controller.of(512)[-1]
        assert last.is_fd and len(last.data) == 24 and judgement.exit_status == 0
        positions[name] = struct.unpack(">d", last.data[16:24])[0]
        assert any("REALS: classic CAN" in note for note in judgement.notes) == (name == "classic")
    assert positions["right"] > 1e-3 and positions["short id"] == positions["classic"] == 0.0
