"""Logs, maps and DBC files with random faults: a result, or one line and exit status 2; no traceback, and soon."""

from __future__ import annotations

import random
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from laconic.can.play.map_file import read_map
from laconic.can.play.map_join import join
from laconic.cli.main import run
from laconic.errors import BadInput
from log_support import (
    CAN_MAP,
    DBC,
    OF_PYTHON,
    SCENE,
    TEXT_MAP,
    asc,
    asc_lines,
    blf,
    candump,
    csv,
    frames,
    mapped,
    motion,
)
from play_support import DBC as TRANSPORTER
from play_support import PLAY

SEED, ROUNDS, LONGEST_S = 20, 6, 10.0
WORDS = (b"", b"nan", b"-1", b"99999999999999999999", b"1e400", b"inf", b"\0", b"\xff\xfe", b'"', b"[", b"=", b",,,",
         b"#", b"\n", b"0x10", b"true", b"1.5", b"M", b"m3", b"|", b"\xc3", b"\r", b"x" * 300)
VALUES = (b"-1", b"0", b"2", b"1e308", b"inf", b"nan", b"true", b"false", b'"x"', b"[]", b"[1, 2]", b"[1, -1]", b"{}",
          b"99999999999999999999", b'["x", "y"]', b"[[1]]", b'"tick"', b'"deg"', b"1979-05-27", b'"increments"', b"64")
LINES = (b"wrap = true", b"wrap = 3", b"scale = -2", b"signs = [1, -1]", b"wheels = [2, 1]", b"optional = true",
         b'unit = "deg"', b'kind = "increments"', b"offset = 1e300", b"channel = 1", b"gear_ratio = 1e-300",
         b"decimal = ','",
         b'point = "centre_of_mass"', b"[metadata]\nfile = \"run.csv\"", b"names_line = 0", b"header_lines = 9",
         b"BO_ 300 X: 8 A", b' SG_ Z m1 : 0|8@1+ (1,0) [0|0] "" A', b"SIG_VALTYPE_ 257 L : 2;", b"")
OPTIONAL = '[yaw_rate]\ncolumn = "yaw"\noptional = true\n'


def changed(data: bytes, source: random.Random) -> bytes:
    """A few places replaced, removed, repeated or exchanged; now and then the end is missing."""
    out = bytearray(data)
    for _ in range(source.choice((1, 1, 2, 5))):
        at = source.randrange(len(out) + 1)
        kind = source.randrange(9)
        if kind == 0 and out:
            out[at % len(out)] = source.randrange(256)
        elif kind == 1:
            out[at:at + source.randrange(1, 20)] = source.choice(WORDS)
        elif kind == 2:
            out[at:at] = out[at:at + source.randrange(1, 200)]
        elif kind == 3:
            del out[at:at + source.randrange(1, 200)]
        elif kind == 4:
            other = source.randrange(len(out) + 1)
            out[at:at] = out[other:other + source.randrange(1, 60)]
        elif kind == 5:
            between = source.choice((b" ", b",", b"|", b"\n"))
            words = bytes(out).split(between)
            words[source.randrange(len(words))] = source.choice(WORDS)
            out = bytearray(between.join(words))
        else:
            lines = bytes(out).split(b"\n")
            at = source.randrange(len(lines))
            head, equals, _ = lines[at].partition(b"=")
            lines[at] = head + equals + b" " + source.choice(VALUES) if equals else source.choice(LINES)
            out = bytearray(b"\n".join(lines))
    return bytes(out[:source.randrange(len(out) + 1)] if source.random() < 0.1 else out)


def replay(log: Path) -> Callable[[Path], list[str]]:
    return lambda folder: ["replay", str(log), SCENE, "--map", str(folder / "map.toml"), "--inputs", "wheel-speeds"]


def of_text(folder: Path) -> tuple[list[Path], Callable[[Path], list[str]]]:
    log = csv(folder / "run.csv", motion(30))
    return [log, mapped(folder, TEXT_MAP + OPTIONAL)], replay(log)


def of_bus(folder: Path, log: Path) -> tuple[list[Path], Callable[[Path], list[str]]]:
    return [log, mapped(folder, CAN_MAP, DBC), folder / "robot.dbc"], replay(log)


KINDS = {"text": of_text,
         "asc": lambda folder: of_bus(folder, asc(folder / "run.asc", asc_lines(frames(motion(30))))),
         "candump": lambda folder: of_bus(folder, candump(folder / "run.log", frames(motion(30)))),
         "blf": lambda folder: of_bus(folder, blf(folder / "run.blf", frames(motion(30))))}


def check_command(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> bool:
    """Whether it was refused; by one line, without a traceback, soon."""
    began = time.monotonic()
    status, (_, error) = run(arguments), capsys.readouterr()
    assert time.monotonic() - began < LONGEST_S
    assert status in (0, 2) and error.count("\n") == (status == 2), error
    assert not any(word in error for word in OF_PYTHON), error
    return status == 2


def mutated_replays(kind: str, folder: Path, seed: int, rounds: int, capsys: pytest.CaptureFixture[str]) -> int:
    """How many of the changed inputs are refused."""
    source, refused = random.Random(f"{kind} {seed}"), 0
    files, arguments = KINDS[kind](folder)
    whole = [path.read_bytes() for path in files]
    for number in range(rounds * len(files)):
        for path, data in zip(files, whole, strict=True):
            path.write_bytes(data)
        path, data = files[number % len(files)], whole[number % len(files)]
        path.write_bytes(changed(data, source))
        refused += check_command(arguments(folder), capsys)
    return refused


def mutated_maps(folder: Path, seed: int, rounds: int) -> int:
    """How many of the changed maps and DBC files of `laconic play` are refused."""
    source, refused = random.Random(seed), 0
    mapping, dbc = folder / "m.toml", folder / "d.dbc"
    whole = {mapping: (PLAY / "transporter.toml").read_bytes(), dbc: TRANSPORTER.read_bytes()}
    for number in range(2 * rounds):
        for path, data in whole.items():
            path.write_bytes(data)
        path = (mapping, dbc)[number % 2]
        path.write_bytes(changed(whole[path], source))
        began = time.monotonic()
        try:
            joined = join(read_map(mapping, 2), dbc)
            for sender in joined.senders:
                list(sender.payloads(lambda _: source.uniform(-1e9, 1e9)))
            for receiver in joined.receivers.values():
                receiver.take(source.randbytes(source.randrange(9)))
        except BadInput as error:
            refused += 1
            found = str(error)
        else:
            found = ""
        assert not any(word in found for word in OF_PYTHON), found
        assert time.monotonic() - began < LONGEST_S
    return refused


@pytest.mark.parametrize("kind", KINDS)
def test_a_log_a_map_or_a_dbc_file_with_random_faults_is_a_result_or_one_line(kind, tmp_path, capsys):
    assert 0 < mutated_replays(kind, tmp_path, SEED, ROUNDS, capsys) < 3 * ROUNDS


def test_a_map_of_play_with_random_faults_is_joined_or_one_line(tmp_path):
    assert 0 < mutated_maps(tmp_path, SEED, 5 * ROUNDS) < 10 * ROUNDS
