"""Seeds for the fuzz targets: a few dozen inputs each, made anew with every run. Coverage leads on from them."""

from __future__ import annotations

import random
from pathlib import Path

COUNT = 24
LINES = (b"O\r", b"L\r", b"C\r", b"S6\r", b"V\r", b"N\r", b"F\r", b"Y2\r", b"t10080102030405060708\r",
         b"T123456788AABBCCDD\r", b"r1234\r", b"R1FFFFFFF0\r",
         b"d0609" + 24 * b"A5" + b"\r", b"D1234567F" + 64 * b"0F" + b"\r", b"b1111FF\r")
RECORDS = {"frames": (10, 32), "canopen": (12, 16), "loader": (7, 64)}
"""Of targets whose inputs are records: their bytes, and how many choices their first byte has."""


def write(target: str, most_bytes: int, folder: Path) -> None:
    """The same ones each time."""
    source = random.Random(target)
    for number in range(COUNT):
        (folder / f"seed-{number:02}").write_bytes(seed(target, source, most_bytes)[:most_bytes])


def seed(target: str, source: random.Random, most_bytes: int) -> bytes:
    """One input."""
    if target == "slcan":
        return b"1O\r" + b"".join(source.choice(LINES) for _ in range(source.randrange(1, 12)))
    if target in RECORDS:
        length, choices = RECORDS[target]
        return b"".join(bytes([source.randrange(choices)]) + source.randbytes(length - 1)
                        for _ in range(most_bytes // length))
    if target in ("odrive", "moteus", "robomaster"):
        return b"".join(drive(source) for _ in range(12))
    # numbers mostly from the tables of usual ones
    return bytes(source.randrange(128) if source.random() < 0.7 else source.randrange(256)
                 for _ in range(source.randrange(8, most_bytes)))


def drive(source: random.Random) -> bytes:
    """Steps, or a frame to a drive."""
    if source.random() < 0.4:
        return bytes([128 + source.randrange(128)])
    length, number = source.randrange(9), source.choice((1, 2)) << source.choice((0, 5)) | source.randrange(32)
    return bytes([length]) + number.to_bytes(4, "little") + source.randbytes(length)
