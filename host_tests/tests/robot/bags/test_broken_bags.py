"""Recordings and maps that are broken anywhere: one line or a result that is reported, never a fault of the program,
and no more memory than a whole one takes."""

from __future__ import annotations

import json
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
