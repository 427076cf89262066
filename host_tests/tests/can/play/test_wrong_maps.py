"""A wrong map gives one clear line that names map, DBC, message and signal, and exit status 2."""

from __future__ import annotations

from pathlib import Path

import pytest

from laconic.cli.main import run
from play_support import DBC, PLAY, Codec, played

GOOD = (PLAY / "transporter.toml").read_text(encoding="utf-8")
OF_SPEED = 'from = "wheel_speed_rad_per_s[1]"'
SEND_POSE = '[[send]]\nmessage = "POSE"'
AGAIN = '[[receive]]\nmessage = "WHEEL_COMMAND"\n[[receive.signal]]\nname = "VoltageLeft"\nto = "body_moment_Nm"\n'
LEFT = 'name = "VoltageLeft"\nto = "voltage_V[1]"\n'
# what is changed in the good map, and what the line must contain
BAD = {
    "unknown message": (('"WHEEL_COMMAND"', '"WHEEL_COMAND"'),
        ("receive[1].message", "transporter.dbc", "did you mean WHEEL_COMMAND?")),
    "unknown signal": (('"VoltageLeft"', '"VoltageLef"'),
        ("signal[1].name", "WHEEL_COMMAND has no signal 'VoltageLef'", "did you mean VoltageLeft?")),
    "unknown sent signal": (('"CountLeft"', '"CountLft"'),
        ("send[1].signal[1].name", "WHEEL_STATE", "did you mean CountLeft?")),
    "unknown input": (("voltage_V[1]", "voltag_V[1]"),
        ("receive[1].signal[1].to", "voltag_V[1]", "did you mean voltage_V[1]?")),
    "a wheel too many": (("voltage_V[2]", "voltage_V[3]"), ("signal[2].to", "voltage_V[3]", "voltage_V[2]")),
    "unknown output": (("wheel_angle_rad[1]", "wheel_angel_rad[1]"),
        ("send[1].signal[1].from", "did you mean wheel_angle_rad[1]?")),
    "output without its index": (('"velocity_body_m_per_s[1]"', '"velocity_body_m_per_s"'),
        ("velocity_body_m_per_s[1] to velocity_body_m_per_s[2]",)),
    "an output as input": (("voltage_V[1]", "wheel_speed_rad_per_s[1]"), ("signal[1].to", "no input")),
    "unknown key": (("sign = -1                    #", "sgn = -1 #"), ("signal[2].sgn", "no known key")),
    "unknown key of a message": (("timeout_s = 0.1", "timeout = 0.1"), ("receive[1].timeout:", "no known key")),
    "sign of 2": (("sign = -1                    #", "sign = 2 #"), ("signal[2].sign", "1 or -1")),
    "scale of 0": ((LEFT, LEFT + "scale = 0\n"), ("signal[1].scale", "is 0")),
    "scale as text": ((LEFT, LEFT + 'scale = "1"\n'), ("signal[1].scale", "not a number")),
    "scale not finite": ((LEFT, LEFT + "scale = nan\n"), ("signal[1].scale", "finite")),
    "gear of 0": (("gear = 10", "gear = 0"), ("send[1].signal[1].gear", "is 0")),
    "gear of a voltage": ((LEFT, LEFT + "gear = 10\n"), ("signal[1].gear", "voltage_V[1]", "does not turn")),
    "counts below 0": (("counts_per_turn = 4096\ngear", "counts_per_turn = -4096\ngear"),
        ("counts_per_turn", "above 0")),
    "counts of a speed": ((OF_SPEED, f"{OF_SPEED}\ncounts_per_turn = 9"),
        ("send[1].signal[3].counts_per_turn", "no angle")),
    "wrap at 1": (("wrap = 1000", "wrap = 1"), ("signal[2].wrap", "from 2 to 2^64")),
    "wrap beyond all numbers": (("wrap = 1000", "wrap = 1" + "0" * 400), ("signal[2].wrap", "is beyond 2^64")),
    "wrap beyond the signal": (("wrap = 1000", "wrap = 1000000000"), ("signal[2].wrap", "holds no more than")),
    "wrap of a number": (("wrap = 1000", "wrap = 0.5"), ("signal[2].wrap", "whole number")),
    "neither period nor request": (("period_s = 0.01", ""), ("send[1].period_s", "on_request")),
    "both period and request": (("period_s = 0.01", 'period_s = 0.01\non_request = "remote"'),
        ("send[1].period_s", "keep one")),
    "period of 0": (("period_s = 0.01", "period_s = 0"), ("send[1].period_s", "above 0")),
    "period below the step": (("period_s = 0.01", "period_s = 0.0001"),
        ("send[1].period_s", "WHEEL_STATE", "--step")),
    "request by nothing": (('"ASK_POSE"', '"ASK"'), ("send[2].on_request", "no message 'ASK'", "ASK_POSE")),
    "timeout below 0": (("timeout_s = 0.1", "timeout_s = -1"), ("receive[1].timeout_s", "above 0")),
    "unknown end": (('"zero"', '"stop"'), ("receive[1].at_timeout", "hold")),
    "end without a timeout": (("timeout_s = 0.1\n", ""), ("receive[1].at_timeout", "timeout_s")),
    "counter nowhere": (('signal = "Counter"', 'signal = "Count"'),
        ("counter.signal", "WHEEL_COMMAND has no signal 'Count'")),
    "counter too large": (("modulo = 15", "modulo = 17"), ("counter.modulo", "4 bits for Alive", "16 or less")),
    "counter of 1": (("modulo = 15", "modulo = 1"), ("counter.modulo", "2 or more")),
    "counter on a page": (('signal = "Alive"', 'signal = "CountLeft"'),
        ("counter.signal", "CountLeft", "every frame")),
    "steps of a sent counter": (("modulo = 15", "modulo = 15, max_delta = 2"),
        ("send[1].counter.max_delta", "controller")),
    "unknown checksum": (('"crc8-sae-j1850"', '"crc8-j1850"'), ("checksum.kind", "did you mean crc8-sae-j1850?")),
    "checksum too narrow": (('signal = "Checksum"', 'signal = "Counter"'), ("checksum.kind", "4 bits for Counter")),
    "checksum nowhere": (('signal = "Checksum"', 'signal = "Crc"'), ("checksum.signal", "no signal 'Crc'")),
    "bytes after a sum": (('kind = "xor"', 'kind = "xor", after = [1]'), ("checksum.after", "crc8-h2f")),
    "E2E in the last byte": (('kind = "crc8-sae-j1850"', 'kind = "e2e-profile-11", data_id = 1'),
        ("checksum.kind", "byte 7", "byte 0")),
    "order of a sum": (('kind = "xor"', 'kind = "xor", order = "last first"'), ("checksum.order", "crc8-d5")),
    "unknown order": (('kind = "crc8-sae-j1850"', 'kind = "crc8-sae-j1850", order = "backwards"'),
                      ("checksum.order", "last first")),
    "E2E without an id": (('kind = "crc8-sae-j1850"', 'kind = "e2e-profile-1"'), ("checksum.data_id", "missing")),
    "E2E with one id of sixteen": (('kind = "xor"', 'kind = "e2e-profile-2", data_id = [1]'),
        ("checksum.data_id", "sixteen")),
    "one input twice": (("voltage_V[2]", "voltage_V[1]"),
        ("signal[2].to", "WHEEL_COMMAND.VoltageRight", "VoltageLeft sets already")),
    "one message twice": ((SEND_POSE, f"{AGAIN}{SEND_POSE}"),
        ("receive[2].message", "received twice")),
    "one signal twice": (('name = "CountRight"', 'name = "CountLeft"'), ("signal[2].name", "CountLeft twice")),
    "heard and sent": (('message = "POSE"', 'message = "WHEEL_COMMAND"'),
        ("send[2].message", "received in this map, too")),
    "constant and output": (("value = -2", 'value = -2\nfrom = "x_m"'), ("signal[2].from", "keep one")),
    "neither constant nor output": (("value = -2", ""), ("signal[2].from", "missing")),
    "constant out of range": (("value = -2", "value = 40000"),
        ("send[3].signal[2].value", "SHORT_SPEED cannot hold 40000 in Real")),
    "output of a multiplexer": (('name = "CountLeft"', 'name = "Page"'),
        ("signal[1].from", "Page as its multiplexer")),
    "page that is not joined": ((OF_SPEED, f'{OF_SPEED}\n[[send.signal]]\nname = "Page"\nvalue = 0'),
        ("send[1].signal", "WHEEL_STATE has no", "multiplexer")),
    "drive output without drives": (("wheel_speed_rad_per_s[2]", "drive_speed_rad_per_s[2]"),
        ("send[1].signal[4].from", "SpeedRight", "no signal is a target")),
    "enable without drives": ((LEFT, 'name = "VoltageLeft"\nto = "drive_enable"\n'),
        ("signal[1].to", "VoltageLeft", "drive_speed_rad_per_s[1]")),
    "voltage beside drives": ((LEFT, 'name = "VoltageLeft"\nto = "drive_speed_rad_per_s[1]"\n'),
        ("signal[2].to", "VoltageRight", "replace the motors")),
    "first instant below 0": (("period_s = 0.01", "period_s = 0.01\nfirst_s = -1"), ("send[1].first_s", "0 or more")),
    "no TOML": (("[[receive]]", "[[receive]"), ("valid TOML",)),
    "empty": ((GOOD, ""), ("receive", "missing"))}


def line_of(map_path: Path, capsys: pytest.CaptureFixture[str], *more: str, dbc: Path = DBC) -> str:
    """The one line on stderr."""
    arguments = ["play", "turtlebot3_burger", "--listen", "0", "--duration", "0.01", "--dbc", str(dbc)]
    assert run([*arguments, "--map", str(map_path), *more]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    return error


@pytest.mark.parametrize("name", BAD)
def test_a_wrong_map_is_refused_in_one_line_that_names_what_is_wrong(name: str, tmp_path: Path,
                                                                    capsys: pytest.CaptureFixture[str]) -> None:
    (old, new), words = BAD[name]
    assert old in GOOD
    path = tmp_path / "wrong.toml"
    path.write_text(GOOD.replace(old, new, 1), encoding="utf-8")
    error = line_of(path, capsys)
    assert str(path) in error and all(word in error for word in words), error


def test_there_are_at_least_forty_wrong_maps() -> None:
    assert len(BAD) >= 40


def test_a_file_that_is_no_dbc_is_refused_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "no.dbc"
    path.write_text("BO_ nonsense", encoding="utf-8")
    assert "--dbc" in line_of(PLAY / "transporter.toml", capsys, dbc=path)
    assert "cannot be read" in line_of(PLAY / "transporter.toml", capsys, dbc=tmp_path / "missing.dbc")


def test_a_voltage_on_a_wheel_without_a_motor_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["play", "example_two_wheel_sizes", "--listen", "0", "--duration", "0.01", "--dbc", str(DBC), "--map",
                str(_with_wheel_3(tmp_path))]) == 2
    error = capsys.readouterr().err
    assert "voltage_V[3]" in error and "no motor" in error and error.count("\n") == 1


def _with_wheel_3(tmp_path: Path) -> Path:
    path = tmp_path / "map.toml"
    path.write_text(GOOD.replace("voltage_V[2]", "voltage_V[3]"), encoding="utf-8")
    return path


# ---- Maps whose parts are in each other's way, DBC files that contradict themselves: one line each, before a bus
# opens.

MAP = """[[receive]]
message = "WHEEL_COMMAND"
[[receive.signal]]
name = "VoltageLeft"
to = "voltage_V[1]"
[[send]]
message = "WHEEL_STATE"
period_s = 0.01
[[send.signal]]
name = "SpeedLeft"
from = "wheel_speed_rad_per_s[1]"
"""
SEND, RECEIVE = "period_s = 0.01", 'message = "WHEEL_COMMAND"'
MORE = '[[send]]\nmessage = "{}"\n{}\n[[send.signal]]\nname = "{}"\nfrom = "{}"\n'
AT_0 = ("SG_ VoltageLeft : 7|16", "SG_ VoltageLeft : 55|16"), ("SG_ Checksum : 63|8", "SG_ Checksum : 7|8")
E2E = f'{RECEIVE}\nchecksum = {{ signal = "Checksum", kind = "e2e-profile-11", data_id = 1 }}'
LOOP = """BO_ 546 LOOP: 8 VEHICLE
 SG_ A m0M : 0|8@1+ (1,0) [0|0] "" CONTROLLER
 SG_ B m0M : 8|8@1+ (1,0) [0|0] "" CONTROLLER

SG_MUL_VAL_ 546 A B 0-0;
SG_MUL_VAL_ 546 B A 0-0;

"""
# what is changed in the map, what in the DBC, and what the line must contain
CONTRADICTORY = {
    "asked for by what it sends": ([(SEND, 'on_request = "WHEEL_STATE"')], [],
        ("send[1].on_request", "sends itself", '"remote"')),
    "asked for by another that it sends": (
        [("", MORE.format("POSE", 'on_request = "WHEEL_STATE"', "X", "x_m"))], [], ("send[2].on_request", "POSE")),
    "asked for by nothing": ([(SEND, SEND + '\non_request = ""')], [], ("send[1].on_request", "is empty; give a name")),
    "from nothing": ([('from = "wheel_speed_rad_per_s[1]"', 'value = 1.0\nfrom = ""')], [],
        ("signal[1].from", "is empty; give a name")),
    "pages of a message that has none": ([("", MORE.format("POSE", 'period_s = 0.02\npages = "together"', "X", "x_m"))],
        [], ("send[2].pages", "has no effect on a message without a multiplexer")),
    "place of a force that is not there": ([('"voltage_V[1]"', '"world_force_point_m[2]"')], [],
        ("signal[1].to", "where a world force acts, and no signal sets one; join one to world_force_N[1]")),
    "sent twice": ([("", MORE.format("WHEEL_STATE", "period_s = 0.02", "SpeedRight", "time_s"))], [],
        ("send[2].message", "sent twice", "send[1]")),
    "counter that is joined": (
        [(SEND, SEND + '\ncounter = { signal = "Alive" }'), ('"SpeedLeft"', '"Alive"')], [],
        ("signal[1].name", "Alive as its counter")),
    "checksum that is joined": (
        [(SEND, SEND + '\nchecksum = { signal = "Check", kind = "xor" }'), ('"SpeedLeft"', '"Check"')], [],
        ("signal[1].name", "Check as its checksum")),
    "counter that is the checksum": (
        [(SEND, SEND + '\ncounter = { signal = "Check" }\nchecksum = { signal = "Check", kind = "xor" }')], [],
        ("checksum.signal", "give two signals")),
    "counter that is the multiplexer": ([(SEND, SEND + '\ncounter = { signal = "Page" }')], [],
        ("counter.signal", "multiplexer")),
    "checksum that is the multiplexer": ([(SEND, SEND + '\nchecksum = { signal = "Page", kind = "xor" }')], [],
        ("checksum.signal", "multiplexer")),
    "counter that takes every step": (
        [(RECEIVE, RECEIVE + '\ncounter = { signal = "Counter", max_delta = 16 }')], [],
        ("counter.max_delta", "16 counts", "every frame would pass")),
    "E2E without its counter": ([(RECEIVE, E2E)], AT_0, ("receive[1].counter", "e2e-profile-11 needs")),
    "E2E with its counter elsewhere": ([(RECEIVE, E2E + '\ncounter = { signal = "Counter" }')], AT_0,
        ("counter.signal", "Counter elsewhere", "4 bits from bit 8")),
    "two messages of one name": ([], [("BO_ 290 ASK_POSE", "BO_ 290 WHEEL_COMMAND")], ("receive[1].message", "twice")),
    "two messages of one identifier": ([], [("BO_ 290 ASK_POSE", "BO_ 288 ASK_POSE")],
        ("receive[1].message", "identifier of ASK_POSE")),
    "two signals of one name": ([], [("SG_ CountRight m1", "SG_ CountLeft m1")],
        ("send[1].message", "two signals CountLeft")),
    "nine bytes without CAN FD": ([], [("WHEEL_COMMAND: 8", "WHEEL_COMMAND: 9")],
        ("receive[1].message", "9 bytes", "VFrameFormat")),
    "more bits than the message": ([], [("WHEEL_COMMAND: 8", "WHEEL_COMMAND: 3")],
        ("--dbc", "VoltageRight does not fit")),
    "signals on one another": ([], [("VoltageRight : 23|16", "VoltageRight : 15|16")], ("--dbc", "overlapping")),
    "a received signal without scale": ([], [("(0.001,0) [-32|32]", "(0,0) [-32|32]")],
        ("receive[1].signal[1].name", "scale 0 for VoltageLeft")),
    "a sent signal without scale": ([], [("SpeedLeft m2 : 15|16@0- (0.01,0)", "SpeedLeft m2 : 15|16@0- (0,0)")],
        ("send[1].signal[1].name", "scale 0 for SpeedLeft")),
    "a float of 4 bits": ([], [("BO_ 290", "SIG_VALTYPE_ 288 Counter : 1;\n\nBO_ 290")],
        ("receive[1].message", "Counter as a float of 4 bits")),
    "multiplexers that select each other": (
        [('"WHEEL_STATE"', '"LOOP"'), ('"SpeedLeft"', '"A"')], [("BO_ 290", f"{LOOP}BO_ 290")],
        ("send[1].message", "select each other")),
    "an identifier of twelve bits": ([], [("BO_ 288", "BO_ 3000")], ("--dbc", "more than 11 bits"))}


@pytest.mark.parametrize("name", CONTRADICTORY)
def test_a_contradiction_is_refused_in_one_line(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    of_map, of_dbc, words = CONTRADICTORY[name]
    map_text, dbc_text = MAP, DBC.read_text(encoding="utf-8")
    for old, new in of_map:
        map_text = map_text.replace(old, new, 1) if old else map_text + new
    for old, new in of_dbc:
        assert old in dbc_text, old
        dbc_text = dbc_text.replace(old, new, 1)
    (tmp_path / "m.toml").write_text(map_text, encoding="utf-8")
    (tmp_path / "d.dbc").write_text(dbc_text, encoding="utf-8")
    assert run(["play", "turtlebot3_burger", "--listen", "0", "--duration", "0.01", "--dbc", str(tmp_path / "d.dbc"),
                "--map", str(tmp_path / "m.toml")]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and "unexpected" not in error and all(word in error for word in words), error


def test_parts_of_a_message_with_different_pages_may_come_at_different_times(tmp_path: Path) -> None:
    path = tmp_path / "m.toml"
    path.write_text(MAP + MORE.format("WHEEL_STATE", "period_s = 0.1", "CountLeft", "time_s"), encoding="utf-8")
    codec = Codec()
    judgement, controller = played("turtlebot3_burger", 1.0, lambda _: [codec.command(3.0, 3.0)], dbc=DBC,
                                   map_path=path)
    pages = [codec.decode(message)["Page"] for _, message in controller.of(544)]
    assert judgement.exit_status == 0 and pages.count(2) >= 99 and 9 <= pages.count(0) <= 10


def test_a_joined_signal_of_every_frame_alone_sends_a_page_that_the_dbc_has(tmp_path: Path) -> None:
    path = tmp_path / "m.toml"
    path.write_text(MAP.replace('"SpeedLeft"', '"Alive"').replace("wheel_speed_rad_per_s[1]", "time_s"),
                    encoding="utf-8")
    codec = Codec()
    _, controller = played("turtlebot3_burger", 0.2, lambda _: [codec.command(3.0, 3.0)], dbc=DBC, map_path=path)
    assert {codec.decode(message)["Page"] for _, message in controller.of(544)} == {0}


def test_a_value_beyond_every_number_is_cut_and_told(tmp_path: Path) -> None:
    path = tmp_path / "m.toml"
    path.write_text(MAP + "scale = 1e308\ngear = 1e308\n", encoding="utf-8")
    codec = Codec()
    judgement, controller = played("turtlebot3_burger", 0.3, lambda _: [codec.command(6.0, 6.0)], dbc=DBC,
                                   map_path=path)
    assert judgement.exit_status == 0 and any("cut to their signal's range" in note for note in judgement.notes)
    assert codec.decode(controller.of(544)[-1][1])["SpeedLeft"] == pytest.approx(327.67)
