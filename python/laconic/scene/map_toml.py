"""Reads the TOML of a map, in any of the encodings that logs may have."""

from __future__ import annotations

from pathlib import Path

from laconic.base.text_file import NotText, decoded
from laconic.errors import BadInput
from laconic.scene.table import Table, read_toml

TWICE = {"pose": 'keep the table, and write the topic there: topic = "/odom"',
         "imu": "keep one of them; a gyro with more keys is [yaw_rate]",
         "joints": "keep one of them; more about the wheels is said under [wheel_angle]"}
"""What to do about keys that are a topic, or a table that says more."""


def read_map_toml(path: Path) -> Table:
    """The top table of a map; BadInput names the line that is wrong."""
    try:
        return read_toml(path, lambda data: decoded(data).text, TWICE)
    except NotText as why:
        raise BadInput(f"{path}: {why}; give a map as TOML text") from None
