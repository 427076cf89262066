"""A made-up run of a robot with two wheels on a circle, as logs of other programs have it: text, ASC, BLF, candump."""

from __future__ import annotations

import json
import struct
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import can
import numpy as np

from laconic.cli.main import run

SCENE = "turtlebot3_burger"
RADIUS_M, TRACK_M = 0.033, 0.16
SPEED_M_PER_S, YAW_RAD_PER_S = 0.15, 0.25
WHEELS, POSE = 0x101, 0x202
CAN_MAP = """name = "two wheels"
format = "can"
dbc = "robot.dbc"
[wheel_angle]
columns = ["WHEELS.L", "WHEELS.R"]
[pose]
columns = ["POSE.X", "POSE.Y", "POSE.A"]
"""
DBC = """VERSION ""
NS_ :
BS_:
BU_: A
BO_ 257 WHEELS: 8 A
 SG_ L : 0|32@1- (1,0) [0|0] "rad" A
 SG_ R : 32|32@1- (1,0) [0|0] "rad" A
BO_ 514 POSE: 8 A
 SG_ X : 0|24@1- (1e-6,0) [0|0] "m" A
 SG_ Y : 24|24@1- (1e-6,0) [0|0] "m" A
 SG_ A : 48|16@1- (0.0001,0) [0|0] "rad" A
SIG_VALTYPE_ 257 L : 1;
SIG_VALTYPE_ 257 R : 1;
"""
TEXT_MAP = """name = "two wheels"
[time]
column = "t"
[wheel_angle]
columns = ["left", "right"]
[pose]
columns = ["x", "y", "yaw"]
"""


def motion(count: int = 80, period_s: float = 0.05) -> np.ndarray:
    """Rows of time, angles of the left and right wheel, x, y, heading."""
    time = period_s * np.arange(count)
    turn = YAW_RAD_PER_S * time
    radius = SPEED_M_PER_S / YAW_RAD_PER_S
    wheels = [(SPEED_M_PER_S + side * 0.5 * TRACK_M * YAW_RAD_PER_S) / RADIUS_M * time for side in (-1.0, 1.0)]
    return np.column_stack([time, *wheels, radius * np.sin(turn), radius * (1.0 - np.cos(turn)), turn])


Frame = tuple[float, int, bytes]
"""Time, identifier, bytes."""


def frames(rows: np.ndarray | None = None) -> list[Frame]:
    """WHEELS and 0.1 ms later POSE for each row."""
    found: list[Frame] = []
    for time, left, right, x, y, heading in motion() if rows is None else rows:
        found.append((float(time), WHEELS, struct.pack("<ff", left, right)))
        word = (round(x * 1e6) & 0xFFFFFF) | (round(y * 1e6) & 0xFFFFFF) << 24 | (round(heading * 1e4) & 0xFFFF) << 48
        found.append((float(time) + 1e-4, POSE, word.to_bytes(8, "little")))
    return found


ASC_HEAD = "date Sat Jan 3 10:00:00.000 2026\nbase hex  timestamps absolute\ninternal events logged\n"


def asc_lines(given: Iterable[Frame], channel: Callable[[int], int] = lambda _: 1, base: int = 16) -> list[str]:
    """Lines of an ASC log, without its head."""
    number = "{:02X}" if base == 16 else "{}"
    return [f"{time:.6f} {channel(k)} {number.format(identifier)} Rx d {len(data)} "
            f"{' '.join(number.format(byte) for byte in data)}" for k, (time, identifier, data) in enumerate(given)]


def asc(path: Path, lines: Iterable[str], head: str = ASC_HEAD) -> Path:
    path.write_text(head + "".join(f"{line}\n" for line in lines))
    return path


def candump(path: Path, given: Iterable[Frame], interface: Callable[[int], str] = lambda _: "can0") -> Path:
    path.write_text("".join(f"({1.7e9 + time:.6f}) {interface(k)} {identifier:03X}#{data.hex().upper()}\n"
                            for k, (time, identifier, data) in enumerate(given)))
    return path


def blf(path: Path, given: Iterable[Frame], **how: object) -> Path:
    with can.BLFWriter(path) as writer:
        for time, identifier, data in given:
            writer.on_message_received(can.Message(timestamp=1.7e9 + time, arbitration_id=identifier, data=data,
                                                   is_extended_id=False, **{"channel": 0, **how}))
    return path


def mapped(folder: Path, text: str = CAN_MAP, dbc: str | None = DBC, change: Sequence[tuple[str, str]] = ()) -> Path:
    """A map with its DBC beside it."""
    for old, new in change:
        assert old in text, old
        text = text.replace(old, new)
    if dbc is not None:
        (folder / "robot.dbc").write_text(dbc)
    path = folder / "map.toml"
    path.write_text(text)
    return path


HEAD = ("t", "left", "right", "x", "y", "yaw")


def csv(path: Path, rows: np.ndarray | Sequence[Sequence[object]], head: Sequence[str] = HEAD) -> Path:
    lines = [",".join("" if cell is None else f"{cell:.13g}" if isinstance(cell, float) else str(cell) for cell in row)
             for row in (rows.tolist() if isinstance(rows, np.ndarray) else rows)]
    path.write_text("\n".join([",".join(head), *lines]) + "\n")
    return path


def replayed(capsys: object, log: Path, mapping: Path, *more: str) -> dict[str, object]:
    """Numbers of `laconic replay` with the wheels' rotation."""
    status = run(["replay", str(log), SCENE, "--map", str(mapping), "--inputs", "wheel-speeds", "--json", *more])
    out, err = capsys.readouterr()  # type: ignore[attr-defined]
    assert status == 0, err
    return json.loads(out)


def path_error(capsys: object, log: Path, mapping: Path) -> float:
    """Of the one run."""
    return replayed(capsys, log, mapping)["runs"][0]["path_error"]  # type: ignore[index, no-any-return]


OF_PYTHON = ("Error", "Traceback", "unexpected", "to unpack", "invalid literal", "codec")


def refused(capsys: object, *arguments: object) -> str:
    """The one line of a command that refuses its input; it is never the text of a Python exception."""
    assert run([str(each) for each in arguments]) == 2
    out, err = capsys.readouterr()  # type: ignore[attr-defined]
    assert out == "" and err.count("\n") == 1, err
    assert not any(word in err for word in OF_PYTHON)
    return err


def refused_log(capsys: object, log: Path, mapping: Path) -> str:
    return refused(capsys, "replay", log, SCENE, "--map", mapping, "--inputs", "wheel-speeds")
