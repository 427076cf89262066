"""CAN logs as other programs record them: several channels, both kinds of identifiers, remote and error frames."""

from __future__ import annotations

import json
import struct

import can
import numpy as np
import pytest

from laconic.can.dbc_file import load_dbc
from laconic.can.rig.logs import read_log
from laconic.cli.main import run
from laconic.robot.logs import gather_logs
from laconic.robot.logs.can_signals import Bits, Words
from laconic.robot.logs.formats.can_frames import read_frames
from log_support import (
    ASC_HEAD,
    DBC,
    WHEELS,
    asc,
    asc_lines,
    blf,
    candump,
    frames,
    mapped,
    motion,
    path_error,
    refused_log,
    replayed,
)

SMALL = 1e-5


def other_robot(k: int, time: float) -> tuple[float, int, bytes]:
    """A frame with the wheels' identifier and nothing but zeros."""
    return time + 3e-5, WHEELS, bytes(8)


def with_other() -> tuple[list[tuple[float, int, bytes]], list[int]]:
    """The run and another robot's frames, and the channel of each."""
    found, channels = [], []
    for k, frame in enumerate(frames()):
        found.append(frame)
        channels.append(1)
        if frame[1] == WHEELS:
            found.append(other_robot(k, frame[0]))
            channels.append(2)
    return found, channels


def trc(path, given, channels):
    lines = [f"{k} {1e3 * time:.3f} DT {channels[k]} {identifier:04X} Rx - {len(data)} "
             f"{' '.join(f'{byte:02X}' for byte in data)}" for k, (time, identifier, data) in enumerate(given)]
    path.write_text(";$FILEVERSION=2.1\n;$COLUMNS=N,O,T,B,I,d,R,L,D\n" + "\n".join(lines) + "\n")
    return path


def several(kind, folder, given, channels):
    """A log with several channels; how the format names the first one."""
    if kind == "asc":
        return asc(folder / "run.asc", asc_lines(given, lambda k: channels[k])), "1"
    if kind == "log":
        return candump(folder / "run.log", given, lambda k: f"can{channels[k] - 1}"), '"can0"'
    if kind == "trc":
        return trc(folder / "run.trc", given, channels), "1"
    path = folder / "run.blf"
    with can.BLFWriter(path) as writer:
        for k, (time, identifier, data) in enumerate(given):
            writer.on_message_received(can.Message(timestamp=1.7e9 + time, arbitration_id=identifier, data=data,
                                                   is_extended_id=False, channel=channels[k] - 1))
    return path, "1"


@pytest.mark.parametrize("kind", ["asc", "log", "trc", "blf"])
def test_an_identifier_on_two_channels_is_refused_until_the_map_names_one(kind, tmp_path, capsys):
    log, first = several(kind, tmp_path, *with_other())
    error = refused_log(capsys, log, mapped(tmp_path))
    assert "WHEELS (0x101, 11 bits) comes on the channels" in error and f"channel = {first}" in error
    right = mapped(tmp_path, change=[('format = "can"', f'format = "can"\nchannel = {first}')])
    assert path_error(capsys, log, right) < SMALL
    wrong = mapped(tmp_path, change=[('format = "can"', 'format = "can"\nchannel = 7')])
    assert "does not come on the channel 7, but on" in refused_log(capsys, log, wrong)


def test_each_quantity_may_have_a_channel_of_its_own(tmp_path, capsys):
    given = frames()
    log = asc(tmp_path / "run.asc", asc_lines(given, lambda k: 1 if given[k][1] == WHEELS else 4))
    assert path_error(capsys, log, mapped(tmp_path)) < SMALL  # no identifier is on two
    own = mapped(tmp_path, change=[("[wheel_angle]", "[wheel_angle]\nchannel = 1"), ("[pose]", "[pose]\nchannel = 4")])
    assert path_error(capsys, log, own) < SMALL
    other = mapped(tmp_path, change=[("[pose]", "[pose]\nchannel = 1")])
    assert "POSE (0x202, 11 bits) does not come on the channel 1, but on 4" in refused_log(capsys, log, other)


@pytest.mark.parametrize("kind", ["asc", "log", "blf"])
def test_equal_devices_on_two_buses_are_columns_of_one_quantity(kind, tmp_path, capsys):
    given, channels = [], []
    for time, identifier, data in frames():
        if identifier == WHEELS:  # each drive sends its angle as L, on a bus of its own
            given += [(time, WHEELS, data[:4] + bytes(4)), (time + 2e-5, WHEELS, data[4:] + bytes(4))]
            channels += [1, 2]
        else:
            given.append((time, identifier, data))
            channels.append(1)
    log, _ = several(kind, tmp_path, given, channels)
    buses = '["can0", "can1"]' if kind == "log" else "[1, 2]"
    twice = ('"WHEELS.L", "WHEELS.R"', '"WHEELS.L", "WHEELS.L"')
    both = mapped(tmp_path, change=[twice, ("[wheel_angle]", f"[wheel_angle]\nchannels = {buses}")])
    assert path_error(capsys, log, both) < SMALL
    crossed = mapped(tmp_path, change=[twice, ("[wheel_angle]",
                                               f"[wheel_angle]\nwheels = [2, 1]\nchannels = {buses}")])
    assert path_error(capsys, log, crossed) > 0.1
    error = refused_log(capsys, log, mapped(tmp_path, change=[('"WHEELS.L", "WHEELS.R"', '"WHEELS.L", "POSE.X"')]))
    assert f"equal devices on several need channels = {buses} under their quantity" in error


@pytest.mark.parametrize(("columns", "more", "words"), [
    ('"WHEELS.L", "WHEELS.L"', "",
     "names 'WHEELS.L' twice; give each column once, or channels = [1, 2] for equal devices on two buses"),
    ('"WHEELS.L", "WHEELS.L"', "channels = [1, 1]", "names 'WHEELS.L' twice on channel 1; give each column once"),
    ('"WHEELS.L", "WHEELS.R"', "channels = [1, 2, 3]", "channels: has 3 entries; give 2, one for each column"),
    ('"WHEELS.L", "WHEELS.R"', 'channels = [1, ""]', "channels: holds ''; give channels as the log writes them"),
    ('"WHEELS.L", "WHEELS.R"', "channel = 1\nchannels = [1, 1]", "channels: is given besides channel; keep one"),
    ('"WHEELS.L", "WHEELS.L"', "channels = [1, 7]", "WHEELS (0x101, 11 bits) does not come on the channel 7, but on")])
def test_channels_that_cannot_be_are_named(columns, more, words, tmp_path, capsys):
    log = asc(tmp_path / "run.asc", asc_lines(frames()))
    mapping = mapped(tmp_path, change=[('"WHEELS.L", "WHEELS.R"', columns),
                                       ("[wheel_angle]", f"[wheel_angle]\n{more}")])
    assert words in refused_log(capsys, log, mapping)


def test_the_same_number_with_29_bits_is_another_message(tmp_path, capsys):
    lines = asc_lines(frames())
    stranger = [f"{line.split()[0]} 1 101x Rx d 8 00 00 00 00 00 00 00 00" for line in lines if " 101 " in line]
    log = asc(tmp_path / "run.asc", [line for pair in zip(lines[::2], stranger, lines[1::2], strict=True)
                                     for line in pair])
    assert path_error(capsys, log, mapped(tmp_path)) < SMALL
    alone = asc(tmp_path / "alone.asc", [line for line in lines if " 202 " in line] + stranger)
    error = refused_log(capsys, alone, mapped(tmp_path))
    assert "holds no frame WHEELS (0x101, 11 bits) (0x101 with 29 bits, which it has, is another message)" in error
    extended = mapped(tmp_path, dbc=DBC.replace("257", str(257 | 1 << 31)))
    log = candump(tmp_path / "run.log", frames())
    assert "holds no frame WHEELS (0x101, 29 bits) (0x101 with 11 bits" in refused_log(capsys, log, extended)


REMOTE = {"asc": "0.000050 1 101 Rx r 8", "log": "(1700000000.000050) can0 101#R8"}
ERROR = {"asc": "0.000060 1 ErrorFrame", "log": "(1700000000.000060) can0 20000088#0000000000000000"}


@pytest.mark.parametrize("kind", ["asc", "log"])
def test_remote_and_error_frames_carry_no_signals(kind, tmp_path, capsys):
    log, _ = several(kind, tmp_path, frames(), [1] * 1000)
    lines = log.read_text().splitlines()
    at = next(k for k, line in enumerate(lines) if "202" in line)
    log.write_text("\n".join([*lines[:at], REMOTE[kind], ERROR[kind], *lines[at:]]) + "\n")
    found = replayed(capsys, log, mapped(tmp_path))
    assert found["runs"][0]["path_error"] < SMALL and found["remarks"] == []
    only = [line for line in lines if "101" not in line] + [REMOTE[kind]]
    log.write_text("\n".join(only) + "\n")
    assert "holds no frame WHEELS (0x101, 11 bits) with data, only remote frames" in refused_log(
        capsys, log, mapped(tmp_path))


def test_frames_that_are_too_short_are_left_out_and_counted(tmp_path, capsys):
    lines = asc_lines(frames())
    lines.insert(9, "0.200050 1 101 Rx d 4 00 00 00 00")
    lines.insert(15, "0.300150 1 101 Rx d 0")
    found = replayed(capsys, asc(tmp_path / "run.asc", lines), mapped(tmp_path))
    assert found["runs"][0]["path_error"] < SMALL
    assert found["remarks"] == ["run: 2 frames of WHEELS left out: 4 instead of 8 bytes (line 13, the first)"]
    every = [line.replace("d 8", "d 4") for line in asc_lines(frames()) if " 101 " in line]
    poses = [line for line in asc_lines(frames()) if " 202 " in line]
    error = refused_log(capsys, asc(tmp_path / "run.asc", every + poses), mapped(tmp_path))
    assert "all 80 frames of WHEELS (0x101, 11 bits) are shorter than its 8 bytes" in error


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_a_number_that_is_not_finite_names_the_frame(value, tmp_path, capsys):
    given = frames()
    given[20] = (given[20][0], WHEELS, struct.pack("<ff", given[20][0], value))
    error = refused_log(capsys, asc(tmp_path / "run.asc", asc_lines(given)), mapped(tmp_path))
    assert "run.asc: line 24: WHEELS.R is not finite; remove the frame" in error
    assert "frame 21: WHEELS.R is not finite" in refused_log(capsys, blf(tmp_path / "run.blf", given), mapped(tmp_path))
    one = mapped(tmp_path, change=[('"WHEELS.L", "WHEELS.R"', '"WHEELS.L"')])
    assert "has 1 wheels, the scene 2" in refused_log(capsys, tmp_path / "run.asc", one)  # what is not used may be NaN


@pytest.mark.parametrize("value", [float("nan"), -1.0, 0.5, 1e9])
def test_a_group_that_no_vehicle_has_is_named(value, tmp_path, capsys):
    dbc = DBC.replace("WHEELS: 8", "WHEELS: 12").replace("BO_ 514", ' SG_ G : 64|32@1- (1,0) [0|0] "" A\nBO_ 514')
    given = [(time, identifier, data + struct.pack("<f", value if k == 20 else 0.0) if identifier == WHEELS else data)
             for k, (time, identifier, data) in enumerate(frames())]
    with can.Logger(tmp_path / "run.log") as writer:
        for time, identifier, data in given:
            writer(can.Message(timestamp=time, arbitration_id=identifier, is_extended_id=False, data=data,
                               is_fd=len(data) > 8))
    mapping = mapped(tmp_path, dbc=dbc + "SIG_VALTYPE_ 257 G : 1;\n", change=[
        ('format = "can"', 'format = "can"\ngroup = "G"')])
    assert f"line 21: WHEELS.G is {value:g}, which is not a group of wheels" in refused_log(
        capsys, tmp_path / "run.log", mapping)


# --------------------------------------------------------------------------------------------- pages

PAGED = DBC.replace(""" SG_ L : 0|32@1- (1,0) [0|0] "rad" A
 SG_ R : 32|32@1- (1,0) [0|0] "rad" A""", """ SG_ Page M : 0|8@1+ (1,0) [0|0] "" A
 SG_ L m0 : 8|32@1- (1,0) [0|0] "rad" A
 SG_ R m1 : 8|32@1- (1,0) [0|0] "rad" A""")


def page(number: int, value: float) -> bytes:
    return bytes([number]) + struct.pack("<f", value) + bytes(3)


def paged(period_s: float, offset_s: float):
    """Pages 0 and 1 in turn, `offset_s` apart, each with the angle of its instant, and poses with page 0."""
    found = []
    for time, left, _, *pose in motion(100, period_s):
        later = motion(2, 1.0)[1, 2] * (time + offset_s)
        found += [(time, WHEELS, page(0, left)), (time + offset_s, WHEELS, page(1, later))]
        found.append(frames(np.array([[time, 0.0, 0.0, *pose]]))[1])
    return sorted(found)


@pytest.mark.parametrize("offset_s", [1e-3, 0.025, 0.049])
def test_pages_that_come_apart_are_brought_to_one_instant(offset_s, tmp_path, capsys):
    log = asc(tmp_path / "run.asc", asc_lines(paged(0.05, offset_s)))
    assert path_error(capsys, log, mapped(tmp_path, dbc=PAGED)) < 2e-4  # 0.02 rad of one wheel would be 3e-3


def test_a_page_that_never_comes_is_named(tmp_path, capsys):
    given = [frame for frame in paged(0.05, 0.025) if frame[1] != WHEELS or frame[2][0] == 0]
    error = refused_log(capsys, asc(tmp_path / "run.asc", asc_lines(given)), mapped(tmp_path, dbc=PAGED))
    assert "holds no frame of WHEELS with R, the page with Page = 1; record it" in error


def test_a_page_that_the_dbc_does_not_have_is_not_needed(tmp_path, capsys):
    given = sorted([*paged(0.05, 0.025), *((0.05 * k + 0.01, WHEELS, page(7, 3.0)) for k in range(100))])
    log = asc(tmp_path / "run.asc", asc_lines(given))
    assert path_error(capsys, log, mapped(tmp_path, dbc=PAGED)) < 2e-4


def test_increments_of_a_fast_message_are_not_lost_between_slow_poses(tmp_path, capsys):
    rows = motion(400, 0.01)
    steps = np.diff(rows[:, 1:3], axis=0, prepend=rows[:1, 1:3])
    given = frames(np.column_stack([rows[:, 0], steps, rows[:, 3:]]))
    slow = [frame for k, frame in enumerate(given) if frame[1] == WHEELS or k // 2 % 10 == 0]
    log = asc(tmp_path / "run.asc", asc_lines(slow))
    summed = mapped(tmp_path, change=[("[wheel_angle]", '[wheel_angle]\nkind = "increments"')])
    assert path_error(capsys, log, summed) < 1e-3


# ------------------------------------------------------------------------------------- forms of a log


def test_an_asc_log_without_a_head_keeps_its_first_frame(tmp_path):
    lines = asc_lines(frames())
    for number, head in enumerate(("", "// a comment\n", ASC_HEAD, "date Sat Jan 3 10:00:00 2026\nbase hex\n",
                                   "no internal events logged\n", ASC_HEAD + "Begin Triggerblock\n")):
        found = read_frames(asc(tmp_path / f"{number}.asc", lines, head)).frames
        assert len(found) == len(lines) and found[0].arbitration_id == WHEELS
        assert found[0].place == f"line {head.count(chr(10)) + 1}"


def test_relative_times_and_decimal_bytes_are_the_same_log(tmp_path):
    lines = asc_lines(frames(), base=10)
    times = [0.0, *np.diff([float(line.split()[0]) for line in lines])]
    relative = [f"{time:.6f} {line.split(maxsplit=1)[1]}" for time, line in zip(times, lines, strict=True)]
    relative.insert(6, "0.000000 Start of measurement")
    log = asc(tmp_path / "run.asc", relative, "base dec  timestamps relative\nno internal events logged\n")
    plain, other = gather_one(asc(tmp_path / "plain.asc", asc_lines(frames())), mapped(tmp_path)), gather_one(
        log, mapped(tmp_path))
    assert np.array_equal(plain.wheel_angle_rad, other.wheel_angle_rad) and np.array_equal(plain.pose, other.pose)
    assert other.time_s == pytest.approx(plain.time_s, abs=1e-9)


def gather_one(log, mapping):
    (found,), _ = gather_logs([log], mapping)
    return found


def test_each_form_of_one_run_is_the_same_run(tmp_path):
    given, mapping = frames(), mapped(tmp_path)
    printed = tmp_path / "printed.log"
    printed.write_text("".join(f" ({1.7e9 + time:.6f})  can0  {identifier:03X}   [{len(data)}]  "
                               f"{data.hex(' ').upper()}\n" for time, identifier, data in given))
    old = tmp_path / "old.trc"
    old.write_text("".join(f"  {k}) {1e3 * time:.1f} {identifier:04X} {len(data)} {data.hex(' ').upper()}\n"
                           for k, (time, identifier, data) in enumerate(given)))
    logs = [asc(tmp_path / "a.asc", asc_lines(given)), blf(tmp_path / "b.blf", given),
            candump(tmp_path / "c.log", given), printed, trc(tmp_path / "d.trc", given, [1] * len(given)), old]
    unnamed = tmp_path / "named-otherwise.txt"
    unnamed.write_bytes(logs[2].read_bytes())
    runs = [gather_one(log, mapping) for log in [*logs, unnamed]]
    for each in runs[1:]:
        assert np.array_equal(each.wheel_angle_rad, runs[0].wheel_angle_rad)
        assert np.array_equal(each.pose, runs[0].pose)
        assert each.time_s == pytest.approx(runs[0].time_s, abs=1e-6)


def test_frames_of_two_interfaces_out_of_order_are_sorted_and_a_clock_that_is_set_back_is_named(tmp_path, capsys):
    given = frames()
    given[10], given[11] = given[11], given[10]
    found = replayed(capsys, candump(tmp_path / "run.log", given), mapped(tmp_path))
    assert found["runs"][0]["path_error"] < SMALL
    assert found["remarks"] == [
        "run: 1 frames are not in the order of their times, by 0.0001 s at most, and are sorted"]
    late = [(time - 1.5 * (k > 80), *rest) for k, (time, *rest) in enumerate(frames())]
    log = candump(tmp_path / "run.log", late)
    assert "line 82: time goes back by 1.4" in refused_log(capsys, log, mapped(tmp_path))


def test_can_fd_frames_of_every_format_are_read(tmp_path):
    data = bytes(range(12))
    message = can.Message(timestamp=1.7e9, arbitration_id=0x123, is_extended_id=True, is_fd=True, bitrate_switch=True,
                          data=data, channel=0)
    for name in ("run.asc", "run.blf", "run.log"):
        with can.Logger(tmp_path / name) as writer:
            writer(message)
        frame, = read_frames(tmp_path / name).frames
        assert (frame.arbitration_id, frame.is_extended_id, frame.is_fd, bytes(frame.data)) == (0x123, True, True, data)


def test_signals_are_taken_out_of_frames_as_the_library_does_it(tmp_path):
    path = tmp_path / "all.dbc"
    path.write_text("""BO_ 1 ALL: 24 A
 SG_ a : 3|5@1+ (1,0) [0|0] "" A
 SG_ b : 8|13@1- (0.5,-3) [0|0] "" A
 SG_ c : 27|12@0- (2,0) [0|0] "" A
 SG_ d : 47|16@0+ (1,0) [0|0] "" A
 SG_ e : 64|64@1- (1,0) [0|0] "" A
 SG_ f : 135|32@0- (0.1,1) [0|0] "" A
 SG_ g : 160|16@1- (1,0) [0|0] "" A
SIG_VALTYPE_ 1 e : 2;
SIG_VALTYPE_ 1 f : 1;
""")
    message = load_dbc(path, "all").messages[0].c
    random = np.random.default_rng(1)
    for _ in range(50):
        data = random.bytes(24)
        wanted = message.decode(data, decode_choices=False)
        for signal in message.signals:
            bits = Bits(signal, 24)
            assert bits.value(Words(data).of(bits)) == pytest.approx(float(wanted[signal.name]), nan_ok=True, rel=1e-15)


# ------------------------------------------------------------------------------------ the rig's replay


def test_a_rigs_log_with_two_channels_is_judged_by_the_one_that_is_named(tmp_path, capsys):
    path = tmp_path / "run.asc"
    assert run(["rig", "s1", "--steps", "20", "--log", str(path)]) == 0
    lines = path.read_text().splitlines()
    doubled = []
    for line in lines:
        doubled.append(line)
        parts = line.split()
        if len(parts) > 4 and parts[3] in ("Rx", "Tx"):
            doubled.append(line.replace(f" {parts[1]} ", " 9 ", 1).replace(parts[-1], "55"))
            doubled.append(f"{parts[0]} {parts[1]} {parts[2]}x Rx d 8 00 00 00 00 00 00 00 00")
            doubled.append(f"{parts[0]} {parts[1]} {parts[2]} Rx r 8")
    path.write_text("\n".join(doubled) + "\n")
    channel = next(line.split()[1] for line in lines if " Rx " in line or " Tx " in line)
    capsys.readouterr()
    assert run(["rig", "s1", "--replay", str(path)]) == 2
    error = capsys.readouterr().err
    assert f"come on the channels {channel} and 9; give --channel {channel}" in error and error.count("\n") == 1
    assert run(["rig", "s1", "--replay", str(path), "--channel", channel, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["verdicts"]
    assert run(["rig", "s1", "--replay", str(path), "--channel", "5"]) == 2
    assert "--channel 5" in capsys.readouterr().err


def test_frames_of_another_length_are_left_out_of_a_rigs_replay_and_reported(tmp_path, capsys):
    path = tmp_path / "run.asc"
    assert run(["rig", "s1", "--steps", "20", "--log", str(path)]) == 0
    frame = next(each for each in read_log(path) if each.is_rx and each.dlc == 8)
    line = path.read_text().splitlines()[int(frame.place.split()[1]) - 1]
    head, _, rest = line.partition(" d 8")
    text = path.read_text().replace(line, f"{line}\n{head} d 4 {' '.join(rest.split()[:4])}", 1)
    path.write_text(text)
    capsys.readouterr()
    assert run(["rig", "s1", "--replay", str(path), "--json"]) == 0
    assert any("left out: of another length" in note for note in json.loads(capsys.readouterr().out)["notes"])


def test_a_log_as_mf4_names_the_package_that_it_needs(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("laconic.robot.logs.formats.can_frames.importlib.util.find_spec", lambda _: None)
    monkeypatch.setattr("importlib.metadata.requires", lambda _: ["asammdf>=8 ; extra == 'mf4'"])
    assert run(["rig", "turtlebot3_burger", "--steps", "10", "--log", str(tmp_path / "run.mf4")]) == 2
    assert 'asammdf, which is not installed; pip install "laconic[mf4]"' in capsys.readouterr().err


@pytest.mark.nightly
def test_a_log_as_mf4_holds_the_frames_of_the_log_as_blf(tmp_path, capfd):
    pytest.importorskip("asammdf")
    logs = [tmp_path / f"run.{ending}" for ending in ("mf4", "blf")]
    assert run(["rig", "turtlebot3_burger", "--steps", "50", *(f"--log={path}" for path in logs)]) == 0
    of_mf4, of_blf = ([(each.arbitration_id, bytes(each.data)) for each in read_frames(path).frames] for path in logs)
    assert of_mf4 == of_blf and len(of_mf4) > 100
    (tmp_path / "cut.mf4").write_bytes(logs[0].read_bytes()[:3000])
    assert run(["replay", str(tmp_path / "cut.mf4"), "turtlebot3_burger", "--map", "rig"]) == 2
    assert "Traceback" not in capfd.readouterr().err
