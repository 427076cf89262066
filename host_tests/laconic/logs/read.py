"""Reads one log by a map: columns become quantities at the wheel, in SI units, in the scene's order of wheels."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from laconic.errors import BadInput, shown
from laconic.logs.column_map import NUMBERED, YAW_RATE, Column, ColumnMap, Quantity, angle_unit
from laconic.logs.log import LEAST_SAMPLES, PER_WHEEL, Log, wheels_of
from laconic.logs.text_table import TextTable, metadata_number, metadata_of, read_text
from laconic.logs.units import OF_QUANTITY, SPEED

MEMBERS = {"set_speed": "set_speed_rad_per_s", "wheel_angle": "wheel_angle_rad", "wheel_speed": "wheel_speed_rad_per_s",
           "current": "current_A", "voltage": "voltage_V"}
Columns = Callable[[Quantity], np.ndarray | None]


def read_log(path: Path, columns: ColumnMap) -> Log:
    """A recorded run; BadInput names the file, line and column that cannot be used."""
    if columns.format == "can":
        time, source = _can_source(path, columns)
        lines = None
    else:
        table = read_text(path, columns)
        time, source, lines = _text_source(table, columns)
    _check_time(path, time, lines)
    figure = _figures(path, columns)
    found: dict[str, Any] = {}
    for name in PER_WHEEL:
        if name in columns.quantities:
            found[MEMBERS[name]] = _at_wheel(columns.quantities[name], source, figure)
    if columns.group:
        _fill_groups(found)
    _check_widths(path, columns, found)
    if columns.quantities.get("current") and columns.quantities["current"].sign_from_set_speed:
        found["current_A"] = _signed(path, found)
    if YAW_RATE in columns.quantities and (rate := source(columns.quantities[YAW_RATE])) is not None:
        found["yaw_rate_rad_per_s"] = _scaled(columns.quantities[YAW_RATE], rate)[:, 0]
    is_ordered = any(quantity.wheels for quantity in columns.quantities.values())
    log = Log(path, columns.name, time - time[0], is_ordered=is_ordered, **found)
    return _with_pose(log, columns, source)


def for_wheels(log: Log, wheels: Sequence[Mapping[str, Any]]) -> Log:
    """The log for a vehicle with these wheels; BadInput where it has another number of them.

    A wheel without a motor may have no encoder either: its columns are NaN then. Frames on a bus have room for more
    wheels than there are; those beyond the vehicle's must be silent.
    """
    there, count = wheels_of(log), len(wheels)
    if there == count:
        return log
    parts = {member: getattr(log, member) for member in MEMBERS.values() if getattr(log, member) is not None}
    if there > count and log.map_name == "rig" and all(not value[:, count:].any() for value in parts.values()):
        return replace(log, **{member: value[:, :count] for member, value in parts.items()})
    driven = [index for index, wheel in enumerate(wheels) if wheel.get("driven", True)]
    places = list(range(there)) if log.is_ordered else driven
    if there != len(places) or not set(driven) <= set(places) <= set(range(count)):
        raise BadInput(f"{log.path}: has {there} wheels, the scene {count}; give the scene of the recorded robot, or "
                       "driven = false for a wheel that the log has not")
    spread: dict[str, Any] = {member: _spread(value, places, count) for member, value in parts.items()}
    return replace(log, **spread)


def _spread(values: np.ndarray, places: Sequence[int], count: int) -> np.ndarray:
    """Columns at their places among so many; the others are NaN."""
    found = np.full((len(values), count), np.nan)
    found[:, places] = values
    return found


def _text_source(table: TextTable, columns: ColumnMap) -> tuple[np.ndarray, Columns, list[int]]:
    def source(quantity: Quantity) -> np.ndarray | None:
        wanted = _numbered(quantity, table.names)
        if quantity.first:
            wanted = tuple(range(quantity.first, len(table.rows[0]) + 1))
            if not wanted:
                raise BadInput(f"{table.path}: line {table.lines[0]}: has {len(table.rows[0])} columns, none from "
                               f"{quantity.first} on for {quantity.name}; correct the column map with --map")
            _check_even(table)
        if quantity.is_optional and (not wanted or any(isinstance(c, str) and c not in table.names for c in wanted)):
            return None
        return table.numbers([table.index_of(column, quantity.name) for column in wanted], quantity.name)

    time = source(columns.quantities["time"])
    assert time is not None
    return _scaled(columns.quantities["time"], time)[:, 0], source, table.lines


def _check_even(table: TextTable) -> None:
    width = len(table.rows[0])
    for line, row in zip(table.lines, table.rows, strict=True):
        if len(row) != width:
            raise BadInput(f"{table.path}: line {line}: has {len(row)} columns, the first line {width}; remove the "
                           "line or repair it")


def _numbered(quantity: Quantity, names: list[str]) -> tuple[Column, ...]:
    """The columns; a name with # stands for those of wheel 1, 2 … as far as they are there."""
    column = quantity.columns[0] if len(quantity.columns) == 1 else None
    if not isinstance(column, str) or NUMBERED not in column:
        return quantity.columns
    found: list[Column] = []
    while (name := column.replace(NUMBERED, str(len(found) + 1))) in names:
        found.append(name)
    if not found and not quantity.is_optional:
        return (column.replace(NUMBERED, "1"),)
    return tuple(found)


def _can_source(path: Path, columns: ColumnMap) -> tuple[np.ndarray, Columns]:
    from laconic.logs.can_table import read_can  # brings cantools, which takes a while

    table = read_can(path, columns)

    def source(quantity: Quantity) -> np.ndarray | None:
        names = [str(name) for name in _numbered(quantity, list(table.values))]
        if not names or any(name not in table.values for name in names):
            if quantity.is_optional:
                return None
            raise BadInput(f"{path}: has no signal {shown(quantity.columns[0])} (for {quantity.name}); correct the map")
        return np.column_stack([table.values[name] for name in names])

    return table.time_s, source


def _figures(path: Path, columns: ColumnMap) -> Callable[[Any], float]:
    """A number of the map, or the row of the metadata file that it names."""
    file = path.parent / columns.metadata
    rows: dict[str, list[str]] = {}

    def figure(value: Any) -> float:
        if not isinstance(value, str):
            return float(value)
        if not rows:
            rows.update(metadata_of(file))
        return metadata_number(file, rows, value)

    return figure


def _scaled(quantity: Quantity, values: np.ndarray) -> np.ndarray:
    """By the units and scales of columns that are no angles or speeds of a wheel."""
    units = [known[unit] for unit, known in zip(quantity.units, OF_QUANTITY[quantity.name], strict=True)]
    factor = np.array(quantity.scales) * np.array(units)
    return values * factor + np.array(quantity.offsets)


def _at_wheel(quantity: Quantity, source: Columns, figure: Callable[[Any], float]) -> np.ndarray | None:
    values = source(quantity)
    if values is None:
        return None
    unit = quantity.units[0]
    if quantity.name == "wheel_angle":
        factor = angle_unit(quantity, unit, figure)
    elif quantity.name in ("wheel_speed", "set_speed"):
        factor = SPEED[unit] / figure(quantity.gear_ratio)
    else:
        factor = OF_QUANTITY[quantity.name][0][unit]
    out = values * (np.array(quantity.scales) * factor) + np.array(quantity.offsets)
    if quantity.kind == "increments":
        out[0] = 0.0  # since a line that is not there
        out = np.cumsum(out, axis=0)
    return _spread(out, [wheel - 1 for wheel in quantity.wheels], max(quantity.wheels)) if quantity.wheels else out


def _check_time(path: Path, time: np.ndarray, lines: list[int] | None) -> None:
    grows = np.diff(time) > 0.0
    if len(time) < LEAST_SAMPLES:
        raise BadInput(f"{path}: needs at least {LEAST_SAMPLES} samples with increasing time, has {len(time)}; give a "
                       "whole recorded run")
    if not grows.all():
        row = int(np.argmin(grows)) + 1
        where = f"line {lines[row]}" if lines else f"row {row + 1}"
        raise BadInput(f"{path}: {where}: time does not grow ({time[row - 1]:.9g} s, then {time[row]:.9g} s); needs "
                       f"at least {LEAST_SAMPLES} samples with increasing time, so remove the line or repair it")


def _fill_groups(found: dict[str, Any]) -> None:
    """A group of wheels of which no frame came is zero, as the node takes it."""
    width = max((value.shape[1] for value in found.values() if value is not None), default=0)
    for member, value in found.items():
        if value is not None:
            found[member] = np.pad(value, ((0, 0), (0, width - value.shape[1])))


def _check_widths(path: Path, columns: ColumnMap, found: dict[str, Any]) -> None:
    widths = {name: found[member].shape[1] for name, member in MEMBERS.items() if found.get(member) is not None}
    first = next(iter(widths), None)
    for name, width in widths.items():
        if first is not None and width != widths[first]:
            raise BadInput(f"{path}: has {widths[first]} columns of {first} and {width} of {name}; give each for every "
                           f"wheel in the map {columns.path}")


def _signed(path: Path, found: dict[str, Any]) -> np.ndarray:
    speed = found.get("set_speed_rad_per_s")
    if speed is None:
        raise BadInput(f"{path}: current: has its sign from set_speed, which the map does not name; add set_speed")
    quiet = 1e-3 * max(float(np.abs(speed).max()), 1e-300)
    sign = np.where(np.abs(speed) > quiet, np.sign(speed), 0.0)
    signed: np.ndarray = np.abs(found["current_A"]) * sign
    return signed


def _with_pose(log: Log, columns: ColumnMap, source: Columns) -> Log:
    quantity = columns.quantities.get("pose")
    values = source(quantity) if quantity else None
    if quantity is None or values is None:
        return log
    scaled = _scaled(quantity, values)
    if quantity.kind == "absolute":
        scaled[:, 2] = np.unwrap(scaled[:, 2])
        return replace(log, pose=scaled, pose_point=quantity.point)
    if quantity.kind == "increments":
        scaled[0] = 0.0
        return replace(log, pose=np.cumsum(scaled, axis=0), pose_point=quantity.point)
    return replace(log, pose=placed(scaled), pose_point=quantity.point, moved=np.cumsum(scaled, axis=0))


def placed(moved: np.ndarray) -> np.ndarray:
    """Poses from displacements in the body's frame: each begins in the frame of the sample before."""
    steps = np.vstack([np.zeros(3), moved[1:]])
    heading = np.cumsum(steps[:, 2])
    before = heading - steps[:, 2]
    cos, sin = np.cos(before), np.sin(before)
    return np.column_stack([np.cumsum(cos * steps[:, 0] - sin * steps[:, 1]),
                            np.cumsum(sin * steps[:, 0] + cos * steps[:, 1]), heading])
