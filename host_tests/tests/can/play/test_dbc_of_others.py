"""DBC files of others: only messages that a map uses are judged, numbers stay exact, impossible counts move nothing."""

from __future__ import annotations

import struct
from pathlib import Path

import can
import cantools
import pytest

from laconic.can.dbc_file import load_dbc
from laconic.can.play.map_dbc import DbcMessage
from laconic.can.play.map_file import Counter, Joint, Received, Sent, read_map
from laconic.can.play.map_messages import Receiver, Sender
from laconic.cli.main import run
from laconic.errors import BadInput
from log_support import CAN_MAP, asc, asc_lines, frames, mapped, path_error, refused_log
from play_support import DBC as TRANSPORTER
from play_support import PLAY, played

BASE = """VERSION ""
NS_ :
{timing}
BU_: ECU ROBOT
BO_ 256 CMD: 8 ECU
 SG_ VL : 0|16@1- (0.001,0) [0|0] "V" ROBOT
 SG_ VR : 16|16@1- (0.001,0) [0|0] "V" ROBOT
 SG_ CNT : 32|4@1+ (1,0) [0|15] "" ROBOT
BO_ 257 STATE: 8 ROBOT
 SG_ WL : 0|16@1- (0.01,0) [0|0] "rad/s" ECU
{more}
"""
MAP = """[[receive]]
message = "CMD"
[[receive.signal]]
name = "VL"
to = "voltage_V[1]"
[[send]]
message = "STATE"
period_s = 0.1
[[send.signal]]
name = "WL"
from = "wheel_speed_rad_per_s[1]"
"""


def text_of(more: str = "", timing: str = "BS_:") -> str:
    return BASE.format(timing=timing, more=more)


def dbc_in(folder: Path, text: str | bytes) -> Path:
    path = folder / "d.dbc"
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path


def moved(folder: Path, text: str | bytes, mapping: str = MAP) -> float:
    """The last speed that the vehicle sends for 5 V on its left wheel."""
    (folder / "m.toml").write_text(mapping)
    command = can.Message(arbitration_id=0x100, is_extended_id=False, data=struct.pack("<hh4x", 5000, 0))
    judgement, controller = played("turtlebot3_burger", 0.3, lambda _: [command], dbc=dbc_in(folder, text),
                                   map_path=folder / "m.toml")
    assert judgement.exit_status == 0, judgement.notes
    return 0.01 * struct.unpack("<h", controller.of(0x101)[-1][1].data[:2])[0]


UNUSED = {
    "an overlap": 'BO_ 300 OTHER: 8 ECU\n SG_ A : 0|8@1+ (1,0) [0|0] "" ROBOT\n SG_ B : 4|8@1+ (1,0) [0|0] "" ROBOT',
    "a signal that does not fit": 'BO_ 300 OTHER: 2 ECU\n SG_ A : 60|8@1+ (1,0) [0|0] "" ROBOT',
    "a signal without bits": 'BO_ 300 OTHER: 2 ECU\n SG_ A : 0|0@1+ (1,0) [0|0] "" ROBOT',
    "values of a message that is not there": 'VAL_ 999 Gone 0 "a" 1 "b" ;',
    "a decimal without its 0": 'BO_ 300 OTHER: 8 ECU\n SG_ A : 0|8@1+ (.25,0) [0|0] "" ROBOT',
    "an identifier of 17 bits": 'BO_ 74000 OTHER: 8 ECU\n SG_ A : 0|8@1+ (1,0) [0|0] "" ROBOT',
    "an identifier of 32 bits": 'BO_ 4294967295 OTHER: 8 ECU\n SG_ A : 0|8@1+ (1,0) [0|0] "" ROBOT',
    "a signal that nobody understands": 'BO_ 300 OTHER: 8 ECU\n SG_ A : what is this',
    "a message that nobody understands": 'BO_ OTHER\n SG_ A : 0|8@1+ (1,0) [0|0] "" ROBOT',
    "two messages of one name": 'BO_ 300 OTHER: 8 ECU\nBO_ 301 OTHER: 8 ECU',
    "two messages of one identifier": 'BO_ 300 OTHER: 8 ECU\nBO_ 300 ANOTHER: 8 ECU',
    "a page without multiplexer": 'BO_ 300 OTHER: 8 ECU\n SG_ A m1 : 0|8@1+ (1,0) [0|0] "" ROBOT',
    "pages without end": 'BO_ 300 OTHER: 8 ECU\n SG_ M M : 0|32@1+ (1,0) [0|0] "" ROBOT\n SG_ A m1 : 32|8@1+ (1,0) '
                         '[0|0] "" ROBOT\nSG_MUL_VAL_ 300 A M 0-4294967295;',
    "a start value in words": 'BO_ 300 OTHER: 8 ECU\n SG_ A : 0|8@1+ (1,0) [0|0] "" ROBOT\nBA_DEF_ SG_ '
                              '"GenSigStartValue" STRING ;\nBA_ "GenSigStartValue" SG_ 300 A "on";',
    "an attribute that is not defined": 'BA_ "Nothing" BO_ 300 5;',
    "keywords within a comment": 'CM_ BO_ 256 "was\nBO_ 256 CMD: 2 ECU\n SG_ VL : 0|8@1+ (9,0) [0|0] \\"V\\" '
                                 'ROBOT\nonce";',
    "sections of other tools": 'EV_ X: 0 [0|1] "" 0 1 DUMMY_NODE_VECTOR0 Y;\nSIG_GROUP_ 256 G 1 : VL;\nCAT_ 5;\nweird',
}


@pytest.fixture(scope="module")
def as_without(tmp_path_factory):
    """How fast the wheel turns without any fault in the file."""
    return moved(tmp_path_factory.mktemp("whole"), text_of())


@pytest.mark.parametrize("more", UNUSED.values(), ids=UNUSED)
def test_a_fault_in_what_the_map_does_not_use_is_no_fault_of_the_file(more, as_without, tmp_path):
    assert moved(tmp_path, text_of(more)) == as_without > 0.1


@pytest.mark.parametrize("timing", ["BS_: 500000 : 0,0", "BS_:500000:0,0", "BS_ :", ""])
def test_any_form_of_the_bit_timing_is_skipped(timing, tmp_path):
    assert moved(tmp_path, text_of(timing=timing)) > 0.1


def test_every_encoding_of_a_dbc_is_the_same_file(tmp_path):
    text = text_of('BO_ 300 OTHER: 8 ECU\n SG_ T : 0|8@1- (1,0) [-40|110] "°C" ROBOT')
    speeds = {moved(tmp_path, data) for data in (
        text.encode(), text.encode("utf-8-sig"), text.encode("utf-16"), text.encode("utf-16-le"), text.encode("cp1252"),
        text.replace("\n", "\r\n").encode(), text.replace("\n", "\r").encode(), text.encode() + bytes(99))}
    assert len(speeds) == 1 and speeds.pop() > 0.1


USED = {
    "an overlap": ("VR : 16|16", "VR : 15|16", "signals VL and VR are overlapping (line 7)"),
    "a signal that does not fit": ("VR : 16|16", "VR : 56|16", "signal VR does not fit in 8 bytes (line 7)"),
    "a signal that is longer than all": ("VR : 16|16", "VR : 16|99999999999999999999", "does not fit in 8 bytes"),
    "a signal without bits": ("VR : 16|16", "VR : 16|0", "signal VR has no bits (line 7)"),
    "a signal that nobody understands": ("VR : 16|16@1-", "VR : 16|16@7-", "line 7, signal VR, cannot be understood"),
    "an identifier of 12 bits": ("BO_ 256", "BO_ 4000", "its identifier 4000 has more than 11 bits (line 5)"),
    "a message of 65 bytes": ("CMD: 8", "CMD: 65", "it has 65 bytes, a frame at most 64"),
    "a page without multiplexer": ("VR : 16", "VR m3 : 16", "signal VR is on a page, with no multiplexer (line 7)"),
    "a limit that is none": ("[0|15]", "[a|15]", "signal CNT has the limit 'a' (line 8)"),
}


@pytest.mark.parametrize(("old", "new", "words"), USED.values(), ids=USED)
def test_a_fault_in_a_message_that_the_map_uses_is_named_with_its_line(old, new, words, tmp_path, capsys):
    dbc = dbc_in(tmp_path, text_of().replace(old, new))
    (tmp_path / "m.toml").write_text(MAP)
    assert run(["play", "turtlebot3_burger", "--listen", "0", "--duration", "0.01", "--dbc", str(dbc), "--map",
                str(tmp_path / "m.toml")]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and f"--dbc {dbc}: message CMD has a fault: " in error and words in error
    assert "; correct the DBC" in error


def test_the_map_of_a_log_is_judged_by_its_own_messages_too(tmp_path, capsys):
    log = asc(tmp_path / "run.asc", asc_lines(frames()))
    mapping = mapped(tmp_path, CAN_MAP)
    text = (tmp_path / "robot.dbc").read_text()
    (tmp_path / "robot.dbc").write_text(text + UNUSED["an overlap"])
    assert path_error(capsys, log, mapping) < 1e-5
    (tmp_path / "robot.dbc").write_text(text.replace("R : 32|32", "R : 30|32"))
    assert "message WHEELS has a fault: signals L and R are overlapping" in refused_log(capsys, log, mapping)
    (tmp_path / "robot.dbc").write_text(text + "BO_ 600 WHEELS: 8 A\n")
    assert "WHEELS is in the DBC twice" in refused_log(capsys, log, mapping)


NONE = {"empty": b"", "a scene": b"[vehicle]\nmass_kg = 1\n", "bytes": bytes(range(256)) * 9, "zeros": bytes(999),
        "a word": b"BO_ nonsense", "a list of keywords": b"NS_ :\n BO_\n SG_\n"}


@pytest.mark.parametrize("data", NONE.values(), ids=NONE)
def test_a_file_that_describes_no_message_is_one_line(data, tmp_path):
    with pytest.raises(BadInput, match="x is no DBC file|x line 1 holds a zero byte"):
        load_dbc(dbc_in(tmp_path, data), "x")


def test_a_text_that_does_not_end_is_named_where_it_hides_a_message(tmp_path):
    text = text_of().replace('"V" ROBOT\n SG_ CNT', '"V ROBOT\n SG_ CNT').replace('"rad/s"', "rad")
    dbc = load_dbc(dbc_in(tmp_path, text), "x")
    with pytest.raises(BadInput, match=r"has no message 'STATE' \(line \d+ begins a text in quotes that has no end\)"):
        dbc.named("STATE", "m.toml: message: d.dbc")


@pytest.mark.parametrize("path", [TRANSPORTER, PLAY / "features.dbc"], ids=lambda path: path.name)
def test_messages_are_those_that_the_library_reads(path):
    ours, theirs = load_dbc(path, "x").messages, cantools.database.load_file(path).messages
    assert [each.name for each in ours] == [each.name for each in theirs]
    for one, other in zip(ours, theirs, strict=True):
        assert (one.c.frame_id, one.c.is_extended_frame, one.c.length, one.c.is_fd) == (
            other.frame_id, other.is_extended_frame, other.length, other.is_fd)
        for a, b in zip(one.c.signals, other.signals, strict=True):
            for name in ("name", "start", "length", "byte_order", "is_signed", "scale", "offset", "minimum", "maximum",
                         "is_float", "raw_initial", "is_multiplexer", "multiplexer_ids", "multiplexer_signal"):
                assert getattr(a, name) == getattr(b, name), (one.name, a.name, name)


def test_long_names_of_attributes_are_the_names(tmp_path):
    text = text_of('BA_DEF_ BO_ "SystemMessageLongSymbol" STRING ;\nBA_ "SystemMessageLongSymbol" BO_ 256 "'
                   'COMMAND_OF_THE_CONTROLLER_TO_BOTH_WHEELS";\nBA_ "SystemSignalLongSymbol" SG_ 256 VL "VoltageLeft";')
    mapping = MAP.replace('"CMD"', '"COMMAND_OF_THE_CONTROLLER_TO_BOTH_WHEELS"').replace('"VL"', '"VoltageLeft"')
    assert moved(tmp_path, text, mapping) > 0.1


# ------------------------------------------------------------------------------------ exact numbers

BIG = text_of('BO_ 258 BIG: 8 ROBOT\n SG_ Q : 0|64@1{sign} ({scale},{offset}) [0|0] "" ECU\n{kind}')


def constant(folder: Path, value: str, scale: str = "1", offset: str = "0", sign: str = "+", kind: str = "") -> bytes:
    """What a message sends whose only signal is constant."""
    text = BIG.format(sign=sign, scale=scale, offset=offset, kind=kind)
    path = folder / "m.toml"
    path.write_text(f'[[send]]\nmessage = "BIG"\nperiod_s = 0.1\n[[send.signal]]\nname = "Q"\nvalue = {value}\n')
    given, = read_map(path, 2).sent
    dbc = dbc_in(folder, text)
    payload, = Sender(given, DbcMessage(dbc, load_dbc(dbc, "x"), "m", "BIG")).payloads(lambda _: 0.0)
    return payload


EXACT = {"beyond 2^53": ("9007199254740993", "1", "0", "+", 9007199254740993),
         "the largest": ("18446744073709551615", "1", "0", "+", 2**64 - 1),
         "the least": ("-9223372036854775808", "1", "0", "-", 1 << 63),
         "with an offset": ("9007199254740993", "1", "1000000000000000000", "-", 2**64 + 9007199254740993 - 10**18),
         "in tenths": ("0.3", "0.1", "0", "+", 3),
         "in thousandths": ("-12.345", "0.001", "-100", "+", 87655),
         "a whole number as a decimal": ("5.0", "1", "0", "+", 5)}


@pytest.mark.parametrize(("value", "scale", "offset", "sign", "raw"), EXACT.values(), ids=EXACT)
def test_a_constant_is_sent_with_all_of_its_digits_or_refused(value, scale, offset, sign, raw, tmp_path):
    assert int.from_bytes(constant(tmp_path, value, scale, offset, sign), "little") == raw


BEYOND = {"one more than the bits hold": ("18446744073709551616", "1", "cannot hold 18446744073709551616 in Q; give a"),
          "between two values": ("0.35", "0.1", "cannot hold 0.35 in Q, whose values are 0.3 and 0.4 there; give one"),
          "a whole number between two": ("3", "2", "cannot hold 3 in Q, whose values are 2 and 4 there"),
          "a decimal beyond 2^53": ("9007199254740993.0", "1", "may have lost digits; write it as a whole number"),
          "below all": ("-1", "1", "cannot hold -1 in Q; give a value of its range")}


@pytest.mark.parametrize(("value", "scale", "words"), BEYOND.values(), ids=BEYOND)
def test_a_constant_that_the_signal_does_not_have_is_refused(value, scale, words, tmp_path):
    with pytest.raises(BadInput) as refused:
        constant(tmp_path, value, scale)
    assert words in str(refused.value)


def test_a_whole_number_in_a_floating_point_signal_is_exact_or_refused(tmp_path):
    double = "SIG_VALTYPE_ 258 Q : 2;"
    assert struct.unpack("<d", constant(tmp_path, "9007199254740994", kind=double))[0] == 9007199254740994
    assert struct.unpack("<d", constant(tmp_path, "0.1", kind=double))[0] == 0.1
    with pytest.raises(BadInput, match="cannot hold 9007199254740993 in Q, whose values are 9007199254740992 and"):
        constant(tmp_path, "9007199254740993", kind=double)


def test_a_wrap_beyond_2_to_the_53_keeps_all_of_its_digits(tmp_path):
    dbc = dbc_in(tmp_path, BIG.format(sign="+", scale=1, offset=0, kind=""))
    wrap = 9007199254740993
    path = tmp_path / "m.toml"
    path.write_text(f'[[send]]\nmessage = "BIG"\nperiod_s = 0.1\n[[send.signal]]\nname = "Q"\nfrom = "time_s"\n'
                    f"wrap = {wrap}\n")
    sent = Sender(read_map(path, 2).sent[0], DbcMessage(dbc, load_dbc(dbc, "x"), "m", "BIG"))
    payload, = sent.payloads(lambda _: 2.0**54)
    assert int.from_bytes(payload, "little") == 2**54 % wrap


def test_a_value_beyond_64_bits_is_cut_to_the_largest_that_they_hold(tmp_path):
    dbc = dbc_in(tmp_path, BIG.format(sign="+", scale=1, offset=0, kind=""))
    sent = Sender(Sent("send[1]", "BIG", (Joint("s", "Q", "x_m"),), period_s=0.1),
                  DbcMessage(dbc, load_dbc(dbc, "x"), "m", "BIG"))
    payload, = sent.payloads(lambda _: 1e30)
    assert payload == b"\xff" * 8 and sent.cut.count == 1


def test_a_start_value_that_its_bits_cannot_hold_is_refused_where_the_message_is_sent(tmp_path):
    start = 'BA_DEF_ SG_ "GenSigStartValue" INT 0 99999;\nBA_ "GenSigStartValue" SG_ {} {};'
    dbc = dbc_in(tmp_path, text_of('BO_ 258 MORE: 8 ROBOT\n SG_ A : 0|8@1+ (1,0) [0|0] "" ECU\n SG_ B : 8|8@1+ (1,0) '
                                   '[0|0] "" ECU\n' + start.format("258 B", 300)))
    with pytest.raises(BadInput, match="has the start value 300 for B, which its 8 bits cannot hold"):
        Sender(Sent("send[1]", "MORE", (Joint("s", "A", "x_m"),), period_s=0.1),
               DbcMessage(dbc, load_dbc(dbc, "x"), "m", "MORE"))


# ------------------------------------------------------------------------------------------- counters


def counting(folder: Path, counts: list[int], modulo: int | None = 15, max_delta: int | None = 1,
             sign: str = "+") -> list[str | None]:
    dbc = dbc_in(folder, text_of().replace("CNT : 32|4@1+", f"CNT : 32|4@1{sign}"))
    receiver = Receiver(Received("receive[1]", "CMD", (Joint("s", "VL", "voltage_V[1]"),),
                                 Counter("CNT", modulo, max_delta)), DbcMessage(dbc, load_dbc(dbc, "x"), "m", "CMD"))
    return [receiver.take(struct.pack("<hhB3x", 5000, 0, count))[1] for count in counts]


@pytest.mark.parametrize("sign", ["+", "-"])
def test_a_count_that_the_counter_never_has_moves_nothing(sign, tmp_path):
    assert counting(tmp_path, [13, 14, 0, 1, 15, 2, 3], sign=sign) == [None] * 4 + ["impossible count", None, None]
    assert counting(tmp_path, [15, 15, 4, 15, 4, 5], sign=sign) == [
        "impossible count", "impossible count", None, "impossible count", "repeated", None]
    assert counting(tmp_path, [0, 9, 10, 11, 1], modulo=10, max_delta=None) == [
        None, None, "impossible count", "impossible count", None]


def test_every_count_of_a_counter_that_uses_all_of_its_bits_is_possible(tmp_path):
    assert counting(tmp_path, [*range(16), 0], modulo=None) == [None] * 17
    assert counting(tmp_path, [5, 6, 7, 1, 2], modulo=16, max_delta=3) == [None, None, None, "wrong count", None]
