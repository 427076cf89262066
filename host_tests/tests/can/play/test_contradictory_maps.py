"""Maps whose parts are in each other's way, DBC files that contradict themselves: one line each, before a bus opens."""

from __future__ import annotations

from pathlib import Path

import pytest

from laconic.cli.main import run
from play_support import DBC, Codec, played

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
BAD = {
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


@pytest.mark.parametrize("name", BAD)
def test_a_contradiction_is_refused_in_one_line(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    of_map, of_dbc, words = BAD[name]
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
