"""Reads a recorded run: a CSV file and a small TOML file that maps its columns."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from laconic.errors import BadInput, reason_of
from laconic.scene.table import Table, read_toml

DEFAULT_MAP = Path(__file__).with_name("robotino2.toml")
SMOOTHING = 2  # samples to either side for a speed from positions


@dataclass(frozen=True)
class ColumnMap:
    """The columns of each quantity, and the factors to SI units at the wheel."""

    separator: str
    header_lines: int
    names_line: int
    columns: dict[str, tuple[tuple[str, ...], np.ndarray]]
    sign_from_set_speed: bool


@dataclass(frozen=True)
class Recording:
    """One run; one row per sample, wheels in columns, everything at the wheel and in SI units."""

    name: str
    time_s: np.ndarray
    set_speed_rad_per_s: np.ndarray
    wheel_angle_rad: np.ndarray
    wheel_speed_rad_per_s: np.ndarray  # as recorded (quantised)
    current_A: np.ndarray              # signed: positive drives the wheel forward
    camera: np.ndarray | None          # x, y [m], angle [rad]: summed displacements in the robot's frame

    @property
    def smooth_speed_rad_per_s(self) -> np.ndarray:
        """Wheel speeds from the positions, over a few samples."""
        k, t, angle = SMOOTHING, self.time_s, self.wheel_angle_rad
        ahead = np.minimum(np.arange(len(t)) + k, len(t) - 1)
        behind = np.maximum(np.arange(len(t)) - k, 0)
        return (angle[ahead] - angle[behind]) / (t[ahead] - t[behind])[:, None]


def read_map(path: Path) -> ColumnMap:
    """A column map; BadInput names the file and the key that is wrong."""
    table = read_toml(path)
    columns = {"time": _columns(table.table("time", required=True), one=True)}
    wheels = None
    for name in ("set_speed", "wheel_angle", "wheel_speed", "current"):
        columns[name] = _columns(table.table(name, required=True), wheels, extra=("sign_from_set_speed",))
        wheels = len(columns[name][0])
    if table.has("camera"):
        columns["camera"] = _columns(table.table("camera"), 3)
    signed = table.table("current").flag("sign_from_set_speed", False)
    found = ColumnMap(table.text("separator", ","), table.whole("header_lines", 1), table.whole("names_line", 1),
                      columns, signed)
    table.done()
    if len(found.separator) != 1:
        table.fail("separator", f"is {found.separator!r}; give one character")
    if not 1 <= found.names_line <= found.header_lines:
        raise BadInput(f"{path}: names_line: is {found.names_line}; give a line from 1 to header_lines")
    return found


def _columns(table: Table, count: int | None = None, *, one: bool = False,
             extra: tuple[str, ...] = ()) -> tuple[tuple[str, ...], np.ndarray]:
    names = (table.text("column"),) if one else table.texts("columns", ...)
    if not names or len(names) != (count or len(names)):
        table.fail("columns", f"has {len(names)} entries; give {count or 'one for each wheel'}")
    if table.has("scales"):
        scale = np.array(table.numbers("scales", len(names)))
    else:
        scale = np.full(len(names), table.number("scale", 1.0))
    for key in extra:
        table.has(key)
    table.done()
    return names, scale


def read_log(path: Path, columns: ColumnMap) -> Recording:
    """A recorded run; BadInput names the file, line and column that cannot be used."""
    head, rows = _rows(path, columns)
    values = {name: _values(path, columns, head, rows, name) for name in columns.columns}
    time = values["time"][:, 0]
    if len(time) < 10 or not (np.diff(time) > 0.0).all():
        raise BadInput(f"{path}: needs at least 10 samples with increasing time; give a whole recorded run")
    current, speed = values["current"], values["set_speed"]
    if columns.sign_from_set_speed:
        quiet = 1e-3 * max(float(np.abs(speed).max()), 1e-300)
        current = np.abs(current) * np.where(np.abs(speed) > quiet, np.sign(speed), 0.0)
    camera = np.cumsum(values["camera"], axis=0) if "camera" in values else None
    return Recording(path.stem, time - time[0], speed, values["wheel_angle"], values["wheel_speed"], current, camera)


def _rows(path: Path, columns: ColumnMap) -> tuple[list[str], list[list[str]]]:
    try:
        with path.open(newline="") as file:
            lines = list(csv.reader(file, delimiter=columns.separator))
    except OSError as error:
        raise BadInput(f"{path}: cannot be read ({reason_of(error)}); give the path of a recorded run") from None
    except (UnicodeDecodeError, csv.Error):
        raise BadInput(f"{path}: is no CSV text; give a recorded run as CSV") from None
    if len(lines) <= columns.header_lines:
        raise BadInput(f"{path}: has no samples after {columns.header_lines} header lines; give a recorded run")
    return [name.strip() for name in lines[columns.names_line - 1]], [r for r in lines[columns.header_lines:] if any(r)]


def _values(path: Path, columns: ColumnMap, head: list[str], rows: list[list[Any]], name: str) -> np.ndarray:
    wanted, scale = columns.columns[name]
    missing = [column for column in wanted if column not in head]
    if missing:
        raise BadInput(f"{path}: has no column {missing[0]!r} (for {name}); correct the column map with --map")
    indices = [head.index(column) for column in wanted]
    out = np.empty((len(rows), len(indices)))
    for number, row in enumerate(rows):
        try:
            out[number] = [float(row[index]) for index in indices]
        except (ValueError, IndexError):
            line = number + columns.header_lines + 1
            raise BadInput(f"{path}: line {line}: no number for {name}; remove the line or repair it") from None
    if not np.isfinite(out).all():
        line = int(np.argmax(~np.isfinite(out).all(axis=1))) + columns.header_lines + 1
        raise BadInput(f"{path}: line {line}: {name} is not finite; remove the line or repair it")
    return out * scale
