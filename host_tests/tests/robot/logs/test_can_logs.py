"""The log of a rig is read through a DBC: rounds of frames become rows, groups of wheels become wheels.

A CAN log that is broken is one line, soon, with the place in the file; nothing of it is an exception of Python's.
"""

from __future__ import annotations

import gzip
import struct
import zlib
from pathlib import Path

import can
import numpy as np
import pytest

from laconic.can.rig.wire import ID_BASE, wire
from laconic.cli.main import run
from laconic.robot.logs import gather_logs
from laconic.robot.logs.column_map import MAPS
from laconic.robot.logs.for_vehicle import for_wheels
from log_support import (
    SCENE,
    asc,
    asc_lines,
    blf,
    candump,
    frames,
    mapped,
    path_error,
    refused,
    refused_log,
    replayed,
)

WHEELS, ROWS = 4, 40


def frame(name: str, **raw: int) -> can.Message:
    found = wire()[name]
    return can.Message(arbitration_id=ID_BASE + found.offset, data=found.pack(**raw), is_extended_id=False)


def written(path):
    """Four wheels in two groups, a pose and now and then a voltage."""
    with can.Logger(str(path)) as log:
        for k in range(ROWS):
            sent = [frame("POSE", x=2 * k, y=-k, heading=(100 * k + 31000) % 62832 - 31416),
                    frame("WHEEL_SPEED", group=0, wheel_speed_1=k, wheel_speed_2=-k, wheel_speed_3=7),
                    frame("WHEEL_SPEED", group=1, wheel_speed_1=3 * k)]
            if k % 10 == 0:
                sent.insert(0, frame("VOLTAGE", group=0, voltage_1=500))
            for number, message in enumerate(sent):
                message.timestamp = 1000.0 + 0.01 * k + 1e-4 * number
                log.on_message_received(message)
    return path


@pytest.mark.parametrize("ending", [".blf", ".asc"])
def test_a_rigs_log_becomes_rows_with_all_groups_of_wheels(ending, tmp_path):
    (log,), skipped = gather_logs([written(tmp_path / f"run{ending}")])
    log, k = for_wheels(log, [{}] * WHEELS), np.arange(ROWS)
    assert skipped == [] and log.map_name == "rig" and log.pose_point == "centre_of_mass"
    assert log.wheel_speed_rad_per_s == pytest.approx(0.005 * np.column_stack([k, -k, 7 + 0 * k, 3 * k]))
    assert log.pose[:, 0] == pytest.approx(0.002 * k)
    assert np.diff(log.pose[:, 2]) == pytest.approx(0.01 * np.ones(ROWS - 1), abs=1e-3)  # unwrapped
    assert np.diff(log.time_s) == pytest.approx(0.01 * np.ones(ROWS - 1), abs=2e-3)
    assert log.rotation_rad()[1, 0] == pytest.approx(0.005 * 1.5 * (log.time_s[2] - log.time_s[1]))


def test_wheels_that_the_scene_has_not_must_be_silent(tmp_path, capsys):
    path = written(tmp_path / "run.blf")
    assert run(["replay", str(path), "optiodom_omni3"]) == 2
    assert "has 6 wheels, the scene 3" in capsys.readouterr().err


WRONG = {
    "a message that is none": ("WHEEL_SPEED.", "WHEEL_SPEEDS.", "the DBC has no message 'WHEEL_SPEEDS'"),
    "a signal that is none": ("POSE.heading", "POSE.angle", "POSE has no signal 'angle'"),
    "a column without message": ('"POSE.x"', '"x"', "pose.columns: holds 'x'; give MESSAGE.signal"),
    "no DBC": ('dbc = "laconic.dbc"', "", "dbc: is missing"),
    "a DBC that is not there": ("laconic.dbc", "robot.dbc", "robot.dbc cannot be read"),
}


@pytest.mark.parametrize(("old", "new", "words"), WRONG.values(), ids=WRONG)
def test_a_map_that_the_dbc_does_not_know_is_one_line(old, new, words, tmp_path, capsys):
    path, mapped = written(tmp_path / "run.blf"), tmp_path / "map.toml"
    mapped.write_text((MAPS / "rig.toml").read_text().replace(old, new))
    assert run(["replay", str(path), "optiodom_omni4", "--map", str(mapped)]) == 2
    err = capsys.readouterr().err
    assert words in err and err.count("\n") == 1


HEAD = 144


def unpacked(data: bytes) -> bytes:
    """The objects of a BLF of python-can."""
    at, found = HEAD, b""
    while data[at:at + 4] == b"LOBJ":
        _, _, _, size, kind = struct.unpack_from("<4sHHLL", data, at)
        assert kind == 10
        found += zlib.decompress(data[at + 32:at + size])
        at += size + size % 4
    return found


def packed(head: bytes, objects: bytes, parts: int = 1) -> bytes:
    """A BLF of these objects, which go on from container to container."""
    found, length = b"", -(-len(objects) // parts)
    for k in range(parts):
        part = objects[k * length:(k + 1) * length]
        body = zlib.compress(part)
        one = struct.pack("<4sHHLL", b"LOBJ", 16, 1, 32 + len(body), 10) + struct.pack("<H6xL4x", 2, len(part)) + body
        found += one + bytes(len(one) % 4)
    return with_size(head, HEAD + len(found)) + found


def with_size(head: bytes, size: int) -> bytes:
    return head[:16] + struct.pack("<Q", size) + head[24:HEAD]


@pytest.fixture
def whole(tmp_path: Path) -> bytes:
    return blf(tmp_path / "whole.blf", frames()).read_bytes()


def test_objects_that_go_on_in_the_next_container_and_those_outside_of_one_are_read(whole, tmp_path, capsys):
    objects, log = unpacked(whole), tmp_path / "run.blf"
    for data in (packed(whole, objects), packed(whole, objects, 7), with_size(whole, HEAD + len(objects)) + objects):
        log.write_bytes(data)
        assert path_error(capsys, log, mapped(tmp_path)) < 1e-5


def broken(objects: bytes, offset: int, data: bytes) -> bytes:
    at = objects.find(b"LOBJ", len(objects) // 2) + offset
    return objects[:at] + data + objects[at + len(data):]


FAULTS = {
    "an object of size 0": (8, bytes(4), "states the size 0, so nothing behind it can be read"),
    "an object of size 3": (8, struct.pack("<L", 3), "states the size 3"),
    "an object without its mark": (0, b"XOBJ", "no object begins there"),
    "an object that is too long": (8, struct.pack("<L", 1 << 30), "is cut off within an object"),
    "an object that is too short": (8, struct.pack("<L", 17), "byte"),
    "a header that is longer than all": (4, struct.pack("<H", 9999), "states the size"),
}


@pytest.mark.parametrize(("offset", "data", "words"), FAULTS.values(), ids=FAULTS)
@pytest.mark.parametrize("inside", [True, False])
def test_a_broken_object_of_a_blf_is_named_by_its_byte(offset, data, words, inside, whole, tmp_path, capsys):
    objects, log = broken(unpacked(whole), offset, data), tmp_path / "run.blf"
    log.write_bytes(packed(whole, objects) if inside else with_size(whole, HEAD + len(objects)) + objects)
    error = refused_log(capsys, log, mapped(tmp_path))
    assert (words in error or "is cut off" in error) and str(log) in error
    assert str(log) in refused(capsys, "rig", "s1", "--replay", log)


HEADS = {
    "empty": (lambda data: b"", "does not begin as a BLF"),
    "a few bytes": (lambda data: data[:40], "is cut off within its head, after 40 bytes"),
    "another kind": (lambda data: b"\x7fELF" + data[4:], "does not begin as a BLF"),
    "a head beyond the file": (lambda data: data[:4] + struct.pack("<L", 1 << 31) + data[8:], "states a head of"),
    "cut off": (lambda data: data[:-100], "is cut off: "),
    "a container of another packing": (lambda data: data[:HEAD + 16] + b"\x09" + data[HEAD + 17:], "in the way 9"),
    "a container that cannot be unpacked": (lambda data: data[:HEAD + 40] + bytes(30) + data[HEAD + 70:], "unpacked"),
    "a container of another size": (lambda data: data[:HEAD + 24] + b"\x07\0\0\0" + data[HEAD + 28:], "states 7 bytes"),
    "no date": (lambda data: data[:40] + bytes(16) + data[56:], None),
    "zero bytes at its end": (lambda data: data + bytes(4096), None),
}


@pytest.mark.parametrize(("change", "words"), HEADS.values(), ids=HEADS)
def test_a_broken_head_or_container_of_a_blf_is_one_line(change, words, whole, tmp_path, capsys):
    log = tmp_path / "run.blf"
    log.write_bytes(change(whole))
    if words is None:
        assert path_error(capsys, log, mapped(tmp_path)) < 1e-5
    else:
        assert words in refused_log(capsys, log, mapped(tmp_path))


def line_of(lines: list[str], number: int, text: str) -> list[str]:
    return [*lines[:number - 1], text, *lines[number:]]


ASC = {
    "too few bytes": ("0.1 1 101 Rx d 8 00 11", "line 9: has 2 of the frame's 8 bytes"),
    "a byte that is none": ("0.1 1 101 Rx d 2 0G 11", "line 9: its bytes '0G 11' cannot be understood"),
    "a byte of three digits": ("0.1 1 101 Rx d 1 111", "line 9: its bytes"),
    "an identifier that is none": ("0.1 1 Speed Rx d 1 11", "line 9: 'Speed' is not an identifier"),
    "an identifier of 30 bits": ("0.1 1 20000000x Rx d 1 11", "line 9: '20000000' is not an identifier"),
    "a length that is none": ("0.1 1 101 Rx d x 11", "line 9: 'x' is not a length"),
    "neither data nor remote": ("0.1 1 101 Rx q 1 11", "line 9: 'q' is neither d nor r"),
    "a direction that is none": ("0.1 1 101 Rz d 1 11", None),
    "no time": ("zero 1 101 Rx d 1 11", "line 9: 'zero' is not a time"),
    "a channel that is none": ("0.1 one 101 Rx d 1 11", "line 9: 'one' is not a channel"),
    "cut off": ("0.1 1 101 Rx", "line 9: '' is neither d nor r"),
    "CAN FD that is cut off": ("0.1 CANFD 1 Rx", "line 9: is cut off"),
    "CAN FD of two lengths": ("0.1 CANFD 1 Rx 101 1 0 9 13 " + "00 " * 13, "states 13 bytes and the code of 12"),
}


@pytest.mark.parametrize(("line", "words"), ASC.values(), ids=ASC)
def test_a_line_of_an_asc_log_that_cannot_be_understood_is_named(line, words, tmp_path, capsys):
    log = asc(tmp_path / "run.asc", line_of(asc_lines(frames()), 6, line))
    error = refused_log(capsys, log, mapped(tmp_path)) if words else run(
        ["replay", str(log), SCENE, "--map", str(mapped(tmp_path)), "--inputs", "wheel-speeds"])
    assert words is None or words in error


def test_other_events_of_an_asc_log_are_skipped(tmp_path, capsys):
    others = [
        "// 0.1 1 101 Rx d 8 broken", "0.0 Start of measurement", "0.1 1 Statistic: D 0 R 0 XD 0 XR 0 E 0 O 0 B 0%",
        "0.1 CAN 1 Status:chip status error active", "0.1 J1939TP FEE3p 6 0 0 - Rx d 2 A0 0F", "",
        "0.1 SV: 1 0 1 ::angle = 3", "0.1 Li 33 Tx 8 00 00 00 00 00 00 00 00 checksum = 55",
        "0.1 1 101 TxRq d 8 00", "0.1 CANFD 1 ErrorFrame 0 0 0"]
    lines = asc_lines(frames())
    log = asc(tmp_path / "run.asc", [*lines[:8], *others[:-1], *lines[8:], "End TriggerBlock"])
    assert path_error(capsys, log, mapped(tmp_path)) < 1e-5


CANDUMP = {
    "three parts": ("(1700000000.1) can0", "line 6: '' is not a frame"),
    "no time": ("can0 101#0011", "line 6: begins with no time"),
    "half a byte": ("(1700000000.1) can0 101#001", "line 6: has half a byte at its end"),
    "a byte that is none": ("(1700000000.1) can0 101#00XY", "line 6: its bytes '00 XY'"),
    "nine bytes": ("(1700000000.1) can0 101#" + "00" * 9, "line 6: has 9 bytes, at most 8"),
    "an identifier that is none": ("(1700000000.1) can0 1XY#00", "line 6: '1XY#00' is not a frame"),
    "five words": ("(1700000000.1) can0 101#00 and more", "line 6: '101#00 and more' is not a frame"),
    "a long identifier": ("(1700000000.1) can0 123456789#00", "line 6: '123456789' is not an identifier"),
}


@pytest.mark.parametrize(("line", "words"), CANDUMP.values(), ids=CANDUMP)
def test_a_line_of_candump_that_cannot_be_understood_is_named(line, words, tmp_path, capsys):
    log = candump(tmp_path / "run.log", frames())
    log.write_text("\n".join(line_of(log.read_text().splitlines(), 6, line)) + "\n")
    assert words in refused_log(capsys, log, mapped(tmp_path))
    assert words in refused(capsys, "rig", "s1", "--replay", log)


TRC = {
    "another version": (";$FILEVERSION=9.9", "version 9.9 is not known"),
    "no identifier": (";$COLUMNS=N,O,T,D", "lacks a column that a frame needs"),
    "cut off": ("1 0.1 DT", "is cut off"),
    "no time": ("1 x DT 1 0101 Rx - 1 11", "'x' is not a time"),
    "no such type": ("1 0.1 QQ 1 0101 Rx - 1 11", "'QQ' is not a type"),
    "too few bytes": ("1 0.1 DT 1 0101 Rx - 2 11", "has 1 of the frame's 2 bytes"),
}


@pytest.mark.parametrize(("line", "words"), TRC.values(), ids=TRC)
def test_a_line_of_a_trc_log_that_cannot_be_understood_is_named(line, words, tmp_path, capsys):
    log = tmp_path / "run.trc"
    log.write_text(f";$FILEVERSION=2.1\n;$COLUMNS=N,O,T,B,I,d,R,L,D\n{line}\n")
    error = refused_log(capsys, log, mapped(tmp_path))
    assert "line 3: " in error and words in error


@pytest.mark.parametrize("name", ["run.db", "run.csv", "run.dat", "run.txt"])
def test_a_log_of_another_kind_that_cannot_be_read_is_one_line(name, tmp_path, capsys):
    log = tmp_path / name
    log.write_text("what is this\n" * 50)
    assert "cannot be understood as a CAN log from its beginning; give a CAN log" in refused_log(
        capsys, log, mapped(tmp_path))
    assert str(log) in refused(capsys, "rig", "s1", "--replay", log)


def test_a_loss_of_power_leaves_the_frames_before_it(tmp_path, capsys):
    log = candump(tmp_path / "run.log", frames())
    log.write_bytes(log.read_bytes()[:-7] + bytes(512))
    found = replayed(capsys, log, mapped(tmp_path))
    assert found["runs"][0]["path_error"] < 1e-5
    assert found["remarks"] == ["run: ends in 512 zero bytes, as after a loss of power; they and line 160, which they "
                                "cut, are left out"]


def test_a_packed_log_is_the_log_and_a_broken_one_is_one_line(tmp_path, capsys):
    plain, log = asc(tmp_path / "plain.asc", asc_lines(frames())), tmp_path / "run.asc.gz"
    log.write_bytes(gzip.compress(plain.read_bytes()))
    assert path_error(capsys, log, mapped(tmp_path)) < 1e-5
    log.write_bytes(gzip.compress(plain.read_bytes())[:-20])
    assert "is packed by gzip but broken (its end is missing)" in refused_log(capsys, log, mapped(tmp_path))
