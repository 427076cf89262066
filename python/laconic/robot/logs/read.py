"""Reads one log by a map: columns become quantities at the wheel, in SI units, in the scene's order of wheels."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from laconic.errors import BadInput
from laconic.robot.logs.column_map import NUMBERED, YAW_RATE, Column, ColumnMap, Quantity, angle_unit
from laconic.robot.logs.log import LEAST_SAMPLES, PER_WHEEL, Log, wheels_of
from laconic.robot.logs.rows import Sampled, choose, fresh
from laconic.robot.logs.text_table import TextTable, metadata_number, metadata_of, read_text
from laconic.robot.logs.units import OF_QUANTITY, SPEED, TICK
from laconic.robot.logs.wraps import TURNS, continuous, modulus_of, refuse_jumps

MEMBERS = {"set_speed": "set_speed_rad_per_s", "wheel_angle": "wheel_angle_rad", "wheel_speed": "wheel_speed_rad_per_s",
           "current": "current_A", "voltage": "voltage_V"}
HALF_TURN = np.pi

Raw = tuple[np.ndarray, list[str]]
"""The columns of a quantity as they are recorded, NaN where nothing is, and their names for messages."""


@dataclass(frozen=True)
class Source:
    """A table of samples, each at its instant; quantities of one table may be recorded at different ones."""

    path: Path
    time_s: np.ndarray
    columns: Callable[[Quantity], Raw | None]
    place: Callable[[int], str]                 # names a sample
    is_row: np.ndarray | None = None            # which samples become rows; None: all
    hold_s: float = 0.0                         # a younger sample is taken as it is
    lines: Callable[[np.ndarray], str] | None = None   # names samples for remarks
    remarks: tuple[str, ...] = ()


def read_log(path: Path, columns: ColumnMap) -> Log:
    """A recorded run; BadInput names the file, line and column that cannot be used."""
    source = _can_source(path, columns) if columns.format == "can" else _text_source(path, columns)
    reader = _Reader(source, columns)
    wheels = [reader.at_wheel(columns.quantities[name]) for name in PER_WHEEL if name in columns.quantities]
    others = [reader.yaw_rate(columns.quantities.get(YAW_RATE)), reader.pose(columns.quantities.get("pose"))]
    sampled = [each for each in (*wheels, *others) if each is not None]
    chosen = choose(source.time_s, sampled, source.is_row, source.hold_s, source.lines)
    time = source.time_s[chosen.rows]
    _check_time(path, time, [source.place(int(row)) for row in chosen.rows])
    found: dict[str, Any] = {MEMBERS[name]: _spread_by(columns.quantities[name], values)
                             for name, values in chosen.values.items() if name in MEMBERS}
    if columns.group:
        _fill_groups(found)
    _check_widths(path, columns, found)
    if "current_A" in found and columns.quantities["current"].sign_from_set_speed:
        found["current_A"] = _signed(path, found)
    if YAW_RATE in chosen.values:
        found["yaw_rate_rad_per_s"] = chosen.values[YAW_RATE][:, 0]
    remarks = (*source.remarks, *reader.remarks, *chosen.remarks)
    is_ordered = any(quantity.wheels for quantity in columns.quantities.values())
    log = Log(path, columns.name, time - time[0], is_ordered=is_ordered, remarks=remarks, **found)
    pose = next((each for each in sampled if each.name == "pose" and each.name in chosen.values), None)
    return log if pose is None else _with_pose(log, columns.quantities["pose"], pose, chosen.values["pose"],
                                               source.time_s, chosen.rows)


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


def _text_source(path: Path, columns: ColumnMap) -> Source:
    table = read_text(path, columns)

    def raw(quantity: Quantity) -> Raw | None:
        wanted = _numbered(quantity, table.names)
        if quantity.first:
            wanted = tuple(range(quantity.first, len(table.rows[0]) + 1))
            if not wanted:
                raise BadInput(f"{table.path}: line {table.lines[0]}: has {len(table.rows[0])} columns, none from "
                               f"{quantity.first} on for {quantity.name}; correct the column map with --map")
            _check_even(table)
        if quantity.is_optional and (not wanted or any(isinstance(c, str) and c not in table.names for c in wanted)):
            return None
        indices = table.indices_of(wanted, quantity.name)
        return (table.numbers(indices, quantity.name, may_be_blank=quantity.name != "time"),
                [table.label(index) for index in indices])

    found = raw(columns.quantities["time"])
    assert found is not None
    time = _time(path, columns.quantities["time"], found[0][:, 0], table.lines)
    return Source(path, time, raw, lambda row: f"line {table.lines[row]}",
                  lines=lambda rows: _lines(table, rows), remarks=table.remarks)


def _time(path: Path, quantity: Quantity, values: np.ndarray, lines: Sequence[int]) -> np.ndarray:
    """In seconds; BadInput for a line whose time does not grow."""
    factor = quantity.scales[0] * OF_QUANTITY["time"][0][quantity.units[0]]
    if isinstance(quantity.wrap, float):
        values = values[:1] + np.concatenate([[0.0], np.cumsum(np.mod(np.diff(values), quantity.wrap))])
    time: np.ndarray = values * factor
    grows = np.diff(time) > 0.0
    if not grows.all():
        row = int(np.argmin(grows)) + 1
        begins_again = quantity.wrap is None and values[row - 1] - values[row] > 0.5 * np.ptp(values)
        wrap = "; a clock that begins again needs wrap under [time] in the map" if begins_again else ""
        raise BadInput(f"{path}: line {lines[row]}: time does not grow ({time[row - 1]:.9g} s, then {time[row]:.9g} "
                       f"s); needs at least {LEAST_SAMPLES} samples with increasing time, so remove the line or repair "
                       f"it{wrap}")
    return time


def _lines(table: TextTable, rows: np.ndarray) -> str:
    """Lines in words: "line 2 is", "lines 2 to 5 and 9 are"."""
    runs = np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1)
    words = [str(table.lines[run[0]]) if len(run) == 1 else f"{table.lines[run[0]]} to {table.lines[run[-1]]}"
             for run in runs]
    parts = words if len(words) < 4 else [*words[:2], f"{len(words) - 2} other stretches"]
    if len(rows) == 1:
        return f"line {words[0]} is"
    return f"lines {' and '.join([', '.join(parts[:-1]), parts[-1]] if len(parts) > 1 else parts)} are"


def _check_even(table: TextTable) -> None:
    width = len(table.rows[0])
    for line, row in zip(table.lines, table.rows, strict=True):
        if len(row) != width:
            raise BadInput(f"{table.path}: line {line}: has {len(row)} columns, the first line {width}; remove the "
                           "line or repair it")


def _numbered(quantity: Quantity, names: Sequence[str]) -> tuple[Column, ...]:
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


def _can_source(path: Path, columns: ColumnMap) -> Source:
    from laconic.robot.logs.can_table import read_can  # brings cantools, which takes a while

    table = read_can(path, columns)

    def raw(quantity: Quantity) -> Raw | None:
        names = [str(name) for name in _numbered(quantity, table.names_on(quantity.channel_of(0, table.channel)))]
        found = [(name, column) for index, name in enumerate(names)
                 if (column := table.column(quantity, index, name)) is not None]
        if not found or len(found) < len(names):
            if quantity.is_optional:
                return None
            raise BadInput(f"{path}: has no signal {quantity.columns[0]!r} (for {quantity.name}); correct the map")
        return np.column_stack([column for _, column in found]), _labels(quantity, names)

    return Source(path, table.time_s, raw, lambda row: table.places[row], table.is_row, table.hold_s,
                  remarks=table.remarks)


def _labels(quantity: Quantity, names: Sequence[str]) -> list[str]:
    """The signals, with their channels where these differ."""
    if len(quantity.channels) < 2:
        return list(names)
    return [f"{name} on channel {channel}" for name, channel in zip(names, quantity.channels, strict=True)]


class _Reader:
    """Brings the columns of a source to SI units at the wheel, for each of its samples."""

    def __init__(self, source: Source, columns: ColumnMap):
        self.source, self.map = source, columns
        self.remarks: list[str] = []
        self._figure = _figures(source.path, columns)

    def _raw(self, quantity: Quantity) -> Raw | None:
        """None for a quantity that may be absent and is blank everywhere."""
        found = self.source.columns(quantity)
        if found is None:
            return None
        values, labels = found
        for column, label in zip(values.T, labels, strict=True):
            if np.isnan(column).all():
                if quantity.is_optional:
                    self.remarks.append(f"{quantity.name} is left out: {label} is blank on all lines")
                    return None
                raise BadInput(f"{self.source.path}: {quantity.name}: {label} is blank on all lines; record it, or "
                               "take it out of the map")
        for key in ("scales", "offsets"):
            if len(getattr(quantity, key)) not in (1, len(labels)):
                raise BadInput(f"{self.map.path}: {quantity.name}.{key}: has {len(getattr(quantity, key))} entries for "
                               f"{len(labels)} columns; give one for each")
        if quantity.wheels and len(quantity.wheels) != len(labels):
            raise BadInput(f"{self.map.path}: {quantity.name}.wheels: has {len(quantity.wheels)} entries for "
                           f"{len(labels)} columns; give one for each")
        return values, labels

    def _usable(self, quantity: Quantity, values: np.ndarray) -> Sampled:
        """BadInput where units and scales make a number too large."""
        if np.isinf(values).any():
            row = int(np.argmax(np.isinf(values).any(axis=1)))
            raise BadInput(f"{self.source.path}: {self.source.place(row)}: {quantity.name} is too large in SI units; "
                           "correct the line, or the units and scales in the map")
        return Sampled(quantity.name, values, quantity.is_optional)

    def at_wheel(self, quantity: Quantity) -> Sampled | None:
        """A quantity of each wheel."""
        found = self._raw(quantity)
        if found is None:
            return None
        values, labels = found
        unit = quantity.units[0]
        if quantity.name == "wheel_angle":
            values = self._continuous(quantity, values, labels)
            factor = angle_unit(quantity, unit, self._figure)
        elif quantity.name in ("wheel_speed", "set_speed"):
            factor = SPEED[unit] / self._figure(quantity.gear_ratio)
        else:
            factor = OF_QUANTITY[quantity.name][0][unit]
        with np.errstate(over="ignore"):
            out = values * (np.array(quantity.scales) * factor) + np.array(quantity.offsets)
            return self._usable(quantity, _summed(out) if quantity.kind == "increments" else out)

    def _continuous(self, quantity: Quantity, values: np.ndarray, labels: Sequence[str]) -> np.ndarray:
        """Angles without the jumps of a counter; BadInput for jumps that the map does not explain."""
        unit, scales = quantity.units[0], np.broadcast_to(quantity.scales, len(labels))
        turn = self._figure(quantity.ticks_per_turn) if unit == TICK else TURNS[unit]
        found = values.copy()
        for index, label in enumerate(labels):
            rows = np.flatnonzero(~np.isnan(values[:, index]))
            is_difference = quantity.kind == "increments"
            column = np.cumsum(values[rows, index]) if is_difference else values[rows, index]
            name, place = f"{quantity.name} {label}", partial(_place_of, self.source, rows)
            modulus = modulus_of(unit, quantity.wrap, turn, scales[index])
            if modulus is not None and is_difference:
                found[rows, index] = np.remainder(values[rows, index] + 0.5 * modulus, modulus) - 0.5 * modulus
            elif modulus is not None:
                found[rows, index], doubt = continuous(self.source.path, name, column, modulus, unit, place)
                self.remarks += [doubt] if doubt else []
            elif quantity.wrap is None:
                refuse_jumps(self.source.path, name, column, turn / abs(scales[index]), place)
        return found

    def yaw_rate(self, quantity: Quantity | None) -> Sampled | None:
        """Of a gyro."""
        found = None if quantity is None else self._raw(quantity)
        return None if quantity is None or found is None else self._usable(quantity, _scaled(quantity, found[0]))

    def pose(self, quantity: Quantity | None) -> Sampled | None:
        """The true pose in the world, or its positions alone."""
        found = None if quantity is None else self._raw(quantity)
        if quantity is None or found is None:
            return None
        scaled = _scaled(quantity, found[0])
        if quantity.kind == "absolute":
            if scaled.shape[1] > 2:
                rows = np.flatnonzero(~np.isnan(scaled[:, 2]))
                scaled[rows, 2] = np.unwrap(scaled[rows, 2])
            return self._usable(quantity, scaled)
        if scaled.shape[1] > 2:
            self._fold_turns(scaled)
        if quantity.kind == "increments":
            return self._usable(quantity, _summed(scaled))
        blank = np.isnan(scaled).any(axis=1)
        if (blank != np.isnan(scaled).all(axis=1)).any():
            row = int(np.argmax(blank != np.isnan(scaled).all(axis=1)))
            raise BadInput(f"{self.source.path}: {self.source.place(row)}: pose has some of its columns alone, and a "
                           "displacement needs all; repair the line")
        return self._usable(quantity, scaled)

    def _fold_turns(self, scaled: np.ndarray) -> None:
        """A difference of two headings that were within one turn is taken the shorter way around."""
        with np.errstate(invalid="ignore"):
            wide = np.abs(scaled[:, 2]) > HALF_TURN
        if wide.any():
            scaled[wide, 2] = np.remainder(scaled[wide, 2] + HALF_TURN, 2.0 * HALF_TURN) - HALF_TURN
            self.remarks.append(f"pose turns by more than half a turn at {int(wide.sum())} samples (the first is "
                                f"{self.source.place(int(np.argmax(wide)))}), which are taken the shorter way around")


def _place_of(source: Source, rows: np.ndarray, index: int) -> str:
    return source.place(int(rows[index]))


def _summed(increments: np.ndarray) -> np.ndarray:
    """Increments since the sample before, summed; the first one is since a sample that is not there."""
    found = increments.copy()
    for column in found.T:
        rows = np.flatnonzero(~np.isnan(column))
        column[rows[:1]] = 0.0
        column[rows] = np.cumsum(column[rows])
    return found


def _spread_by(quantity: Quantity, values: np.ndarray) -> np.ndarray:
    """Columns at the wheels that the map names."""
    wheels = quantity.wheels
    return _spread(values, [wheel - 1 for wheel in wheels], max(wheels)) if wheels else values


def _figures(path: Path, columns: ColumnMap) -> Callable[[Any], float]:
    """A number of the map, or the row of the metadata file that it names."""
    file = path.parent / columns.metadata
    rows: dict[str, list[list[str]]] = {}

    def figure(value: Any) -> float:
        if not isinstance(value, str):
            return float(value)
        if not rows:
            rows.update(metadata_of(file))
        return metadata_number(file, rows, value)

    return figure


def _scaled(quantity: Quantity, values: np.ndarray) -> np.ndarray:
    """By the units and scales of columns that are no angles or speeds of a wheel."""
    units = [known[unit] for unit, known in zip(quantity.units, OF_QUANTITY[quantity.name], strict=False)]
    factor = np.array(quantity.scales) * np.array(units)
    with np.errstate(over="ignore"):
        found: np.ndarray = values * factor + np.array(quantity.offsets)
        return found


def _check_time(path: Path, time: np.ndarray, places: Sequence[str]) -> None:
    grows = np.diff(time) > 0.0
    if len(time) < LEAST_SAMPLES:
        raise BadInput(f"{path}: needs at least {LEAST_SAMPLES} samples with increasing time, has {len(time)}; give a "
                       "whole recorded run")
    if not grows.all():
        row = int(np.argmin(grows)) + 1
        raise BadInput(f"{path}: {places[row]}: time does not grow ({time[row - 1]:.9g} s, then {time[row]:.9g} s); "
                       f"needs at least {LEAST_SAMPLES} samples with increasing time, so remove it or repair it")


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


def _with_pose(log: Log, quantity: Quantity, sampled: Sampled, values: np.ndarray, time_s: np.ndarray,
               rows: np.ndarray) -> Log:
    """The log with its true pose; a heading that was not recorded is NaN."""
    log = replace(log, pose_point=quantity.point, pose_rows=fresh(sampled.values, rows))
    if quantity.kind == "body-increments":
        moved, poses = _placed_at(sampled.values, time_s, rows)
        return replace(log, pose=poses, moved=moved)
    if values.shape[1] == 2:
        values = np.column_stack([values, np.full(len(values), np.nan)])
    return replace(log, pose=values)


def _placed_at(scaled: np.ndarray, time_s: np.ndarray, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(displacements summed, poses) at rows, from displacements at some samples in the frame of the one before."""
    there = np.flatnonzero(~np.isnan(scaled[:, 0]))
    summed, poses = np.cumsum(scaled[there], axis=0), placed(scaled[there])
    if np.array_equal(rows, there):
        return summed, poses
    return _at_times(time_s[rows], time_s[there], summed), _at_times(time_s[rows], time_s[there], poses)


def _at_times(wanted_s: np.ndarray, known_s: np.ndarray, values: np.ndarray) -> np.ndarray:
    return np.column_stack([np.interp(wanted_s, known_s, column) for column in values.T])


def placed(moved: np.ndarray) -> np.ndarray:
    """Poses from displacements in the body's frame: each begins in the frame of the sample before."""
    steps = np.vstack([np.zeros(3), moved[1:]])
    heading = np.cumsum(steps[:, 2])
    before = heading - steps[:, 2]
    cos, sin = np.cos(before), np.sin(before)
    return np.column_stack([np.cumsum(cos * steps[:, 0] - sin * steps[:, 1]),
                            np.cumsum(sin * steps[:, 0] + cos * steps[:, 1]), heading])
