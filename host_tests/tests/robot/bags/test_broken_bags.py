"""Recordings and maps that are broken anywhere: one line or a result that is reported, never a fault of the program,
and no more memory than a whole one takes."""

from __future__ import annotations

import json
import math
import os
import random
import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from bag_support import Messages, drive, pose_at, rosbag1, rosbag2, scene_of, ulog, wheels_at
from laconic.cli.main import run

MAP = """name = "bag"
format = "bag"
joints = "/joint_states"
wheels = ["left_wheel", "right_wheel"]
stamps = "header"
[pose]
topic = "/mocap/pose"
mount = { x_m = 0.0, y_m = 0.0 }
lag_s = 0.0
"""
OF_ULOG = """format = "bag"
[wheel_angle]
columns = ["wheels.left", "wheels.right"]
[pose]
columns = ["pose.x", "pose.y", "pose.yaw"]
"""
OF_MAT = """format = "mat"
[time]
column = "t"
[wheel_angle]
columns = ["left", "right"]
[pose]
columns = ["pose[1]", "pose[2]", "pose[3]"]
"""
SAMPLE, NIGHTLY = range(6), range(6, 46)
MEMORY = 1 << 30      # bytes of addresses, beside what the libraries map


def whole(folder: Path, kind: str) -> tuple[Path, str]:
    """A recording that is whole, and its map."""
    table = np.array([[0.02 * k, *wheels_at(0.02 * k), *pose_at(0.02 * k)] for k in range(100)])
    if kind == "mat":
        savemat(folder / "run.mat", {"t": table[:, 0], "left": table[:, 1], "right": table[:, 2], "pose": table[:, 3:]})
        return folder / "run.mat", OF_MAT
    if kind == "ulog":
        return ulog(folder / "run.ulg", {"wheels": (("left", "right"), table[:, :3]), "pose": (
            ("x", "y", "yaw"), table[:, [0, 3, 4, 5]])}), OF_ULOG
    messages = Messages(is_ros1=kind == "bag")
    rows = drive(messages, seconds=2.0)
    if kind == "bag":
        return rosbag1(folder / "run.bag", rows, messages), MAP
    if kind == "db3":
        return rosbag2(folder / "run", rows, messages) / "run.db3", MAP
    from rosbags.rosbag2 import StoragePlugin
    return rosbag2(folder / "run", rows, messages, StoragePlugin.MCAP) / "run.mcap", MAP


def mutated(data: bytes, chance: random.Random) -> bytes:
    """Other bytes at some places, a piece that is missing, doubled, zero or cut off."""
    found = bytearray(data)
    for _ in range(chance.choice((1, 1, 3, 20))):
        at, size = chance.randrange(len(found)), chance.choice((1, 4, 8, 64, 4096))
        kind = chance.randrange(6)
        if kind == 0:
            found[at] = chance.randrange(256)
        elif kind == 1:
            found[at:at + 8] = chance.choice((b"\xff" * 8, b"\x00" * 8, b"\xff\xff\xff\x7f" * 2))
        elif kind == 2:
            del found[at:at + size]
        elif kind == 3:
            found[at:at] = found[at:at + size]
        elif kind == 4:
            found[at:at + size] = bytes(len(found[at:at + size]))
        else:
            del found[at:]
        if len(found) < 2:
            return bytes(found)
    return bytes(found)


KINDS = ("bag", "db3", "mcap", "ulog", "mat")


def attacked(folder: Path, kind: str, seed: int) -> list[str]:
    """The words of a replay of a recording that is broken by this seed."""
    chance = random.Random(f"{kind} {seed}")
    path, text = whole(folder, kind)
    path.write_bytes(mutated(path.read_bytes(), chance))
    (folder / "map.toml").write_text(text)
    return ["replay", str(path), str(scene_of(folder)), "--map", str(folder / "map.toml"), "--json"]


def judged(status: int, out: str, error: str) -> None:
    assert status in (0, 2), error
    assert "unexpected fault" not in error and "Traceback" not in error
    if status == 0:
        assert "runs" in json.loads(out)
    else:
        lines = [line for line in error.splitlines() if line]
        assert len(lines) == 1 and lines[0].startswith("laconic: "), error


@pytest.mark.parametrize("seed", SAMPLE)
@pytest.mark.parametrize("kind", KINDS)
def test_a_broken_recording_is_one_line_or_reported(kind, seed, tmp_path, capsys):
    status = run(attacked(tmp_path, kind, seed))
    judged(status, *capsys.readouterr())


@pytest.mark.nightly
@pytest.mark.parametrize("seed", NIGHTLY)
@pytest.mark.parametrize("kind", KINDS)
def test_many_broken_recordings_take_no_more_memory_than_a_whole_one(kind, seed, tmp_path):
    command = [sys.executable, "-m", "laconic", *attacked(tmp_path, kind, seed)]
    limit = MEMORY + 3 * MEMORY
    found = subprocess.run(command, capture_output=True, text=True, timeout=100, check=False, env=os.environ,
                           preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)))
    judged(found.returncode, found.stdout, found.stderr)


def mapped_by(change: Callable[[str, random.Random], str], seed: int) -> str:
    return change(MAP, random.Random(seed))


def of_lines(text: str, chance: random.Random) -> str:
    """Lines that are missing, doubled, in another order or cut."""
    lines = text.splitlines()
    at = chance.randrange(len(lines))
    kind = chance.randrange(4)
    if kind == 0:
        del lines[at]
    elif kind == 1:
        lines.insert(at, lines[at])
    elif kind == 2:
        chance.shuffle(lines)
    else:
        lines[at] = lines[at][:chance.randrange(len(lines[at]) + 1)]
    return "\n".join(lines) + "\n"


def of_values(text: str, chance: random.Random) -> str:
    """Another value for a key."""
    lines = text.splitlines()
    keys = [index for index, line in enumerate(lines) if "=" in line]
    at = chance.choice(keys)
    value = chance.choice(('""', "0", "-1", "1e999", "true", "[]", '["a", "a"]', "{}", '"/none"', "[[]]", '["x", 3]',
                           "nan", '"\\u0007"', "99999999999999999999"))
    lines[at] = f"{lines[at].partition('=')[0]}= {value}"
    return "\n".join(lines) + "\n"


@pytest.fixture(scope="module")
def bag(tmp_path_factory):
    return whole(tmp_path_factory.mktemp("whole"), "mcap")[0]


@pytest.mark.parametrize("change", [of_lines, of_values])
@pytest.mark.parametrize("seed", range(20))
def test_a_broken_map_is_one_line_or_a_map(change, seed, bag, tmp_path, capsys):
    mapping = tmp_path / "map.toml"
    mapping.write_text(mapped_by(change, seed))
    status = run(["replay", str(bag), str(scene_of(tmp_path)), "--map", str(mapping), "--json"])
    judged(status, *capsys.readouterr())


@pytest.mark.parametrize("content,words", [
    (b"", "is empty"), (b"#ROSBAG V1.2\n", "is a rosbag of version 1.2"), (b"#ROSBAG V2.0\n", "index is broken"),
    (b"SQLite format 3\0" + bytes(100), "is no rosbag2 that can be read"), (b"\x89MCAP0\r\n", "no topic"),
    (b"\x28\xb5\x2f\xfd" + bytes(20), "is packed by zstd, but broken"), (b"ULog\x01\x12\x35", "ULog")])
def test_a_file_that_only_begins_like_a_recording_is_one_line(content, words, tmp_path, capsys):
    log = tmp_path / "run.mcap"
    log.write_bytes(content)
    assert run(["replay", str(log), str(scene_of(tmp_path))]) == 2
    error = capsys.readouterr().err
    assert words in error and error.count("\n") == 1
    assert run(["logs", str(log)]) in (0, 2)
    assert "unexpected fault" not in capsys.readouterr().err


def test_a_chunk_that_claims_to_be_huge_is_refused_before_it_is_unpacked(tmp_path, capsys):
    path, _ = whole(tmp_path, "mcap")
    data = bytearray(path.read_bytes())
    at = data.index(b"\x06", 20)
    data[at + 9 + 16:at + 9 + 24] = (1 << 40).to_bytes(8, "little")
    path.write_bytes(bytes(data))
    assert run(["replay", str(path), str(scene_of(tmp_path))]) == 2
    assert f"has a chunk of {1 << 40} bytes" in capsys.readouterr().err


def flipped(path: Path, at: int) -> None:
    """Another bit in one byte."""
    data = bytearray(path.read_bytes())
    data[at] ^= 0x10
    path.write_bytes(bytes(data))


def told(capsys: pytest.CaptureFixture[str], path: Path) -> str:
    """What a replay states beside its numbers."""
    status = run(["replay", str(path), str(scene_of(path.parent)), "--json"])
    found = capsys.readouterr()
    judged(status, *found)
    return " ".join(json.loads(found.out)["remarks"]) if status == 0 else found.err


def mcap(path: Path, *, is_chunked: bool = True) -> Path:
    """The usual drive as an MCAP without compression, in several chunks."""
    from mcap.writer import CompressionType, Writer

    messages = Messages()
    with path.open("wb") as file:
        writer = Writer(file, chunk_size=4000, compression=CompressionType.NONE, use_chunking=is_chunked,
                        enable_data_crcs=True)
        writer.start("ros2")
        channels: dict[str, int] = {}
        for stamp, topic, kind, message in drive(messages):
            if topic not in channels:
                text = messages.store.generate_msgdef(kind, ros_version=2)[0]
                channels[topic] = writer.register_channel(topic, "cdr", writer.register_schema(
                    kind, "ros2msg", text.encode()))
            writer.add_message(channels[topic], stamp, bytes(messages.store.serialize_cdr(message, kind)), stamp)
        writer.finish()
    return path


def test_a_flipped_byte_in_a_chunk_is_found_by_its_checksum(tmp_path, capsys):
    path = mcap(tmp_path / "run.mcap")
    assert "checksum" not in told(capsys, path)
    at = path.read_bytes().index(b"left_wheel", 12_000)
    flipped(path, at + 40)
    assert "has a wrong checksum, so a byte in it is not as it was recorded; it is left out" in told(capsys, path)
    path.write_bytes(path.read_bytes()[:-200])  # without its index
    assert "of run.mcap has a wrong checksum" in told(capsys, path)
    assert run(["logs", str(path)]) == 0
    assert "of run.mcap has a wrong checksum" in capsys.readouterr().out


def test_many_chunks_with_wrong_checksums_are_one_line(tmp_path, capsys):
    path = mcap(tmp_path / "run.mcap")
    for start in (4_000, 12_000, 20_000):
        flipped(path, path.read_bytes().index(b"left_wheel", start) + 40)
    remarks = told(capsys, path)
    assert remarks.count("wrong checksum") == 1 and "and so are 2 others" in remarks


def test_a_flipped_byte_beside_chunks_and_in_the_index_is_found_by_its_checksum(tmp_path, capsys):
    path = mcap(tmp_path / "plain.mcap", is_chunked=False)
    flipped(path, path.read_bytes().index(b"left_wheel", 12_000) + 40)
    assert "plain.mcap has a wrong checksum" in told(capsys, path)
    path = mcap(tmp_path / "index.mcap")
    flipped(path, path.read_bytes().rindex(b"/joint_states") + 3)
    remarks = told(capsys, path)
    assert "the index at the end of index.mcap is broken" in remarks


def test_the_rows_of_a_cut_sqlite_file_that_can_be_read_are_read(tmp_path, capsys):
    path, _ = whole(tmp_path, "db3")
    data = path.read_bytes()
    path.write_bytes(data[:int(0.8 * len(data))])
    (path.parent / "metadata.yaml").unlink()
    remarks = told(capsys, path)
    assert "run.db3 is cut off or broken: " in remarks and "messages of the topics that are used can be read" in remarks
    assert run(["logs", str(path)]) == 0
    assert "/joint_states" in capsys.readouterr().out


def test_a_broken_page_of_a_sqlite_file_costs_its_own_rows_alone(tmp_path, capsys):
    path, _ = whole(tmp_path, "db3")
    data = bytearray(path.read_bytes())
    page = data.index(b"left_wheel", len(data) // 2) // 4096
    data[4096 * page:4096 * page + 64] = b"\xff" * 64
    path.write_bytes(bytes(data))
    remarks = told(capsys, path)
    taken, lost = (int(remarks.partition(word)[0].split()[-1]) for word in (" messages of the topics", " between them"))
    assert taken + lost == 162 and 0 < lost < 60


def test_a_recording_without_a_topic_is_one_line(tmp_path, capsys):
    path = tmp_path / "run.mcap"
    path.write_bytes(mcap(tmp_path / "whole.mcap").read_bytes()[:30])
    assert run(["logs", str(path)]) == 2
    found = capsys.readouterr()
    assert "holds no topic; run.mcap was not closed or is broken" in found.err and found.err.count("\n") == 1
    assert not found.out


def changed(folder: Path, change: Callable[[Messages, int, str, object], None]) -> Path:
    """The usual drive with other messages: `change` gets the number of each in its topic."""
    messages, numbers = Messages(), dict[str, int]()
    rows = drive(messages)
    for _, topic, _, message in rows:
        numbers[topic] = numbers.get(topic, -1) + 1
        change(messages, numbers[topic], topic, message)
    return rosbag2(folder / "run", rows, messages)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("value", [1e200, 1e20, math.inf, -math.inf])
@pytest.mark.parametrize("part", ["position", "orientation"])
def test_an_absurd_pose_is_refused_by_its_message_and_field(part, value, tmp_path, capsys):
    def change(_, number, topic, message):
        if topic == "/mocap/pose" and number == 20:
            setattr(getattr(message.pose, part), "y" if part == "position" else "w", value)

    if part == "orientation" and math.isfinite(value):
        value = math.inf
    path = changed(tmp_path, change)
    assert run(["replay", str(path), str(scene_of(tmp_path))]) in ((2,) if part == "position" else (0, 2))
    error = capsys.readouterr().err
    if part == "position":
        assert "at 0.645161 s" in error and "pose.position.y" in error and error.count("\n") == 1


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(("value", "words"), [
    ("1e200", "line 12: pose 'y' is 1e+200"), ("1e12", "line 12: pose is too large")])
def test_an_absurd_pose_of_a_table_is_refused_by_its_line_and_column(value, words, tmp_path, capsys):
    rows = [[f"{0.02 * k:g}", *map(str, wheels_at(0.02 * k)), *map(str, pose_at(0.02 * k))] for k in range(50)]
    rows[10][4] = value
    (tmp_path / "run.csv").write_text("\n".join(["t,left,right,x,y,yaw", *map(",".join, rows)]) + "\n")
    (tmp_path / "map.toml").write_text('[time]\ncolumn = "t"\n[wheel_angle]\ncolumns = ["left", "right"]\n[pose]\n'
                                       'columns = ["x", "y", "yaw"]\n')
    assert run(["replay", str(tmp_path / "run.csv"), str(scene_of(tmp_path)), "--map", str(tmp_path / "map.toml")]) == 2
    error = capsys.readouterr().err
    assert words in error and "'y'" in error and error.count("\n") == 1


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("value", [1e200, math.inf, math.nan])
def test_a_transform_that_is_no_number_is_refused_or_counted(value, tmp_path, capsys):
    messages = Messages()

    def truth(stamp, time_s):
        x, y, heading = pose_at(time_s)
        return [(stamp, "/tf", "tf2_msgs/msg/TFMessage", messages.transform(
            stamp, "map", "base_link", value if 0.99 < time_s < 1.01 else x, y, heading))]

    path = rosbag2(tmp_path / "run", drive(messages, truth=truth), messages)
    (tmp_path / "map.toml").write_text(MAP.partition("stamps")[0] + '[pose]\nframes = ["map", "base_link"]\n')
    status = run(["replay", str(path), str(scene_of(tmp_path)), "--map", str(tmp_path / "map.toml"), "--json"])
    found = capsys.readouterr()
    judged(status, *found)
    assert status == (0 if math.isnan(value) else 2)
    if math.isnan(value):
        assert "1 of 124 messages hold NaN" in found.out and json.loads(found.out)["runs"][0]["path_error"] < 1e-4
    else:
        assert "/tf map → base_link x is" in found.err


@pytest.mark.parametrize("part", ["position", "orientation"])
def test_poses_that_are_nan_throughout_are_the_fault_of_their_topic(part, tmp_path, capsys):
    def change(_, number, topic, message):
        if topic == "/mocap/pose":
            for name in "xyzw"[:3 if part == "position" else 4]:
                setattr(getattr(message.pose, part), name, math.nan if part == "position" else 0.0)

    assert run(["replay", str(changed(tmp_path, change)), str(scene_of(tmp_path))]) == 2
    error = capsys.readouterr().err
    assert "/mocap/pose holds no valid pose" in error and "all 124 messages" in error and error.count("\n") == 1


def test_joint_states_with_fewer_values_than_names_are_counted(tmp_path, capsys):
    def change(_, number, topic, message):
        if topic == "/joint_states" and number in (40, 60, 61):
            message.position = message.position[:number % 2]

    path = changed(tmp_path, change)
    assert "/joint_states: 1 of 200 messages have fewer values than names" in told(capsys, path)


def test_single_poses_without_a_value_are_counted(tmp_path, capsys):
    def change(_, number, topic, message):
        if topic == "/mocap/pose" and number in (40, 60):
            message.pose.orientation.w = message.pose.orientation.z = 0.0

    assert "/mocap/pose: 2 of 124 messages hold NaN, or a quaternion of length 0" in told(capsys, changed(
        tmp_path, change))
