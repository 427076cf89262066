"""A wrong map gives one clear line that names map, DBC, message and signal, and exit status 2."""

from __future__ import annotations

from pathlib import Path

import pytest

from laconic.cli.main import run
from play_support import DBC, PLAY

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
