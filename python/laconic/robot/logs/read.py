"""Reads one log by a map: columns become quantities at the wheel, in SI units, in the scene's order of wheels.

Files are opened in the folder formats.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from laconic.errors import BadInput
from laconic.robot.bags.samples import check_sizes
from laconic.robot.logs import poses
from laconic.robot.logs.column_map import ColumnMap
from laconic.robot.logs.for_vehicle import spread
from laconic.robot.logs.formats.text_table import metadata_number, metadata_of
from laconic.robot.logs.log import COMMANDED, LEAST_SAMPLES, MEMBERS, PER_WHEEL, STEERING, Counter, Following, Log
from laconic.robot.logs.quantity import COMMAND, OF_ANGLE, YAW_RATE, Quantity, is_by_scene_radius, wheel_unit
from laconic.robot.logs.rows import Sampled, choose
from laconic.robot.logs.sources import Raw, Source, source_of
from laconic.robot.logs.units import LATITUDE, OF_QUANTITY, OF_WHEEL, TICK, of_tread
from laconic.robot.logs.wraps import (
    TURNS,
    continuous,
    doubt_of,
    folded,
    hidden_wraps,
    modulus_of,
    refuse_jumps,
    said_of,
)

HALF_TURN = np.pi
PARTS = ("x", "y", "heading")     # of a pose
MOST = {"pose": 1e9, YAW_RATE: 1e6, STEERING: 1e6, "wheel_angle": 1e15, "wheel_speed": 1e6, "set_speed": 1e6,
        "current": 1e9, "voltage": 1e9, COMMANDED: 1e6}
"""In SI units: beyond it a number is a fault of the log or of the map, whatever the robot."""


def read_log(path: Path, columns: ColumnMap) -> Log:
    """A recorded run; BadInput names the file, line and column that cannot be used."""
    source = source_of(path, columns)
    reader = _Reader(source, columns)
    wheels = [reader.at_wheel(columns.quantities[name]) for name in (*PER_WHEEL, STEERING)
              if name in columns.quantities]
    others = [reader.single(columns.quantities.get(YAW_RATE)), reader.single(columns.quantities.get(COMMANDED)),
              reader.pose(columns.quantities.get("pose"))]
    sampled = [each for each in (*wheels, *others) if each is not None]
    chosen = choose(source.time_s, sampled, source.is_row, source.hold_s, source.lines,
                    tells_gaps=source.tells_gaps)
    time = source.time_s[chosen.rows]
    _check_time(path, time, lambda row: source.place(int(chosen.rows[row])))
    found: dict[str, Any] = {MEMBERS[name]: _spread_by(columns.quantities[name], values)
                             for name, values in chosen.values.items() if name in MEMBERS}
    if columns.group:
        _fill_groups(found)
    _check_widths(path, columns, found)
    if "current_A" in found and columns.quantities["current"].sign_from_set_speed:
        found["current_A"] = _signed(path, found)
    if YAW_RATE in chosen.values:
        found["yaw_rate_rad_per_s"] = chosen.values[YAW_RATE][:, 0]
    if STEERING in chosen.values:
        found |= {"steering_angle_rad": chosen.values[STEERING], "hinge_names": columns.quantities[STEERING].hinges,
                  "asks_hinges": not columns.is_guess}
    if COMMANDED in chosen.values:
        found["speed_m_per_s"] = chosen.values[COMMANDED][:, 0]
    found["following"] = _following(columns)
    remarks = (*source.remarks, *reader.remarks, *chosen.remarks)
    is_ordered = any(quantity.wheels for quantity in columns.quantities.values())
    by_radius = tuple(member for name, member in MEMBERS.items()
                      if member in found and is_by_scene_radius(columns.quantities[name]))
    log = Log(path, columns.name, time - time[0], is_ordered=is_ordered, remarks=remarks, by_radius=by_radius,
              wheel_names=source.wheel_names, column_names=source.column_names,
              counter=reader.counter(columns.quantities.get("wheel_angle"), chosen.rows), **found)
    pose = next((each for each in sampled if each.name == "pose" and each.name in chosen.values), None)
    return log if pose is None else poses.with_pose(log, columns.quantities["pose"], pose, chosen.values["pose"],
                                               source.time_s, chosen.rows)


def _following(columns: ColumnMap) -> Following:
    steering, speed = columns.quantities.get(STEERING), columns.quantities.get(COMMANDED)
    speed_lag_s = 0.0 if speed is None else speed.lag_s
    return Following(speed_lag_s=speed_lag_s) if steering is None else Following(
        steering.kind == COMMAND, steering.lag_s, steering.rate_limit_rad_per_s, steering.curve, speed_lag_s)


class _Reader:
    """Brings the columns of a source to SI units at the wheel, for each of its samples."""

    def __init__(self, source: Source, columns: ColumnMap):
        self.source, self.map = source, columns
        self.remarks: list[str] = []
        self.wraps: list[float] = []  # of the columns with angles of wheels, in their units; NaN: none
        self.said = ""  # the map's wrap
        self._figure = _figures(source.path, columns)

    def _raw(self, quantity: Quantity) -> Raw | None:
        """None for a quantity that may be absent and is blank everywhere."""
        found = self.source.columns(quantity)
        if found is None:
            return None
        values, labels = found
        check_sizes(self.source.path, quantity.name, values, self.source.place, labels)
        for column, label in zip(values.T, labels, strict=True):
            if np.isnan(column).all():
                if quantity.is_optional:
                    self.remarks.append(f"{quantity.name} is left out: {label} is blank on all lines")
                    return None
                raise BadInput(f"{self.source.path}: {quantity.name}: {label} is blank on all lines; record it, or "
                               "take it out of the map")
        count = 3 if quantity.quaternion else len(labels)
        for key in ("scales", "offsets"):
            if len(getattr(quantity, key)) not in (1, count):
                raise BadInput(f"{self.map.path}: {quantity.name}.{key}: has {len(getattr(quantity, key))} entries for "
                               f"{len(labels)} columns; give one for each")
        if quantity.wheels and len(quantity.wheels) != len(quantity.members or labels):
            raise BadInput(f"{self.map.path}: {quantity.name}.wheels: has {len(quantity.wheels)} entries for "
                           f"{len(labels)} columns; give one for each")
        return values, labels

    def _usable(self, quantity: Quantity, values: np.ndarray) -> Sampled:
        """BadInput where a number is too large in SI units, by itself or by units and scales."""
        most = MOST[quantity.name]
        with np.errstate(invalid="ignore"):
            wrong = np.abs(values) > most
        if wrong.any():
            row, column = (int(each) for each in np.argwhere(wrong)[0])
            raise BadInput(f"{self.source.path}: {self.source.place(row)}: {quantity.name} is too large in SI units "
                           f"({self._label(quantity, column, values.shape[1])}{values[row, column]:.3g}, more than "
                           f"{most:g}); correct the line, or the units and scales in the map")
        return Sampled(quantity.name, values, quantity.is_optional, quantity.kind == COMMAND)

    def _label(self, quantity: Quantity, column: int, width: int) -> str:
        """Which column one of the values of a quantity is from."""
        found = self.source.columns(quantity)
        labels = found[1] if found is not None and not quantity.members else []
        if quantity.quaternion or not labels or (len(labels) != width and quantity.name != "pose"):
            labels = list(PARTS[:width]) if quantity.name == "pose" else []
        return f"{labels[column]}: " if column < len(labels) else ""

    def at_wheel(self, quantity: Quantity) -> Sampled | None:
        """A quantity of each wheel."""
        found = self._raw(quantity)
        if found is None:
            return None
        values, labels = found
        unit = quantity.units[0]
        if quantity.name in OF_ANGLE:
            values = self._continuous(quantity, values, labels)
        is_turning = quantity.name in OF_WHEEL or quantity.name in OF_ANGLE
        factor = wheel_unit(quantity, self._figure) if is_turning else OF_QUANTITY[quantity.name][0][unit]
        with np.errstate(over="ignore"):
            out = values * (np.array(quantity.scales) * factor) + np.array(quantity.offsets)
            out = _summed(out) if quantity.kind == "increments" else out
            return self._usable(quantity, self._merged(quantity, out))

    def _continuous(self, quantity: Quantity, values: np.ndarray, labels: Sequence[str]) -> np.ndarray:
        """Angles without the jumps of a counter; BadInput for jumps that the map does not explain."""
        unit, scales = quantity.units[0], np.broadcast_to(quantity.scales, len(labels))
        turn = self._turn(quantity)
        found = values.copy()
        for index, label in enumerate(labels):
            rows = np.flatnonzero(~np.isnan(values[:, index]))
            is_difference = quantity.kind == "increments"
            column = np.cumsum(values[rows, index]) if is_difference else values[rows, index]
            name, place = f"{quantity.name} {label}", partial(_place_of, self.source, rows)
            modulus = modulus_of(quantity.wrap, turn, scales[index])
            said = "" if modulus is None else said_of(quantity.wrap, modulus)
            if quantity.name != STEERING:
                self.wraps.append(np.nan if modulus is None else modulus * abs(scales[index]))
                self.said = said or self.said
            if modulus is not None and is_difference:
                found[rows, index] = folded(values[rows, index], modulus)
                doubt = doubt_of(name, found[rows[1:], index], modulus, place, said)  # the first has none before it
                self.remarks += [doubt] if doubt else []
            elif modulus is not None:
                found[rows, index], doubt = continuous(self.source.path, name, column, modulus, unit, place, said)
                hidden = hidden_wraps(name, column, found[rows, index], self.source.time_s[rows], place,
                                      (modulus, said))
                self.remarks += [each for each in (doubt, hidden) if each]
                if quantity.name == STEERING:  # an absolute encoder above half its range stands on the other side
                    found[rows, index] -= modulus * np.round(found[rows[0], index] / modulus)
            elif quantity.wrap is None:
                refuse_jumps(self.source.path, name, column, turn / abs(scales[index]), place)
        return found

    def counter(self, quantity: Quantity | None, rows: np.ndarray) -> Counter | None:
        """Where angles of wheels begin again, at the wheel and in SI units; None where they never do."""
        if quantity is None or not self.said:
            return None
        wraps = np.array(self.wraps)
        if quantity.members:
            ends = np.cumsum(quantity.members)
            wraps = np.array([part.min() for part in np.split(wraps, ends[:-1])])
        wraps = _spread_by(quantity, np.abs(wraps * wheel_unit(quantity, self._figure))[None, :])
        return Counter(self.said, wraps, partial(_place_of, self.source, rows))

    def _turn(self, quantity: Quantity) -> float:
        """One turn in the numbers of the column; infinite where the radius that makes lengths of it is the scene's."""
        unit = quantity.units[0]
        if unit == TICK:
            return self._figure(quantity.ticks_per_turn)
        length = of_tread(quantity.name, unit)
        if length is None:
            return TURNS[unit]
        if quantity.radius_m is None and quantity.wrap is True:
            raise BadInput(f"{self.map.path}: wheel_angle.wrap: is true, and one turn in {unit} needs radius_m; give "
                           f"it, or the number of {unit} after which the column begins again")
        return np.inf if quantity.radius_m is None else 2.0 * np.pi * quantity.radius_m / length

    def single(self, quantity: Quantity | None) -> Sampled | None:
        """Of a gyro, or a commanded speed."""
        found = None if quantity is None else self._raw(quantity)
        if quantity is None or found is None:
            return None
        if quantity.name == COMMANDED:  # what stands stays: the offset is in the direction of the command
            plain = poses.scaled(replace(quantity, offsets=(0.0,)), found[0])
            return self._usable(quantity, plain + np.sign(plain) * quantity.offsets[0])
        return self._usable(quantity, poses.scaled(quantity, found[0]))

    def pose(self, quantity: Quantity | None) -> Sampled | None:
        """The true pose in the world, or its positions alone."""
        found = None if quantity is None else self._raw(quantity)
        if quantity is None or found is None:
            return None
        values = self._in_si(quantity, found[0])
        if quantity.kind == "absolute":
            if values.shape[1] > 2:
                rows = np.flatnonzero(~np.isnan(values[:, 2]))
                values[rows, 2] = np.unwrap(values[rows, 2])
                values = values if quantity.mount is None else poses.of_robot(values, quantity.mount)
            if quantity.lag_s:
                values = poses.earlier(self.source.time_s, values, quantity.lag_s)
            return self._usable(quantity, values)
        if values.shape[1] > 2:
            self._fold_turns(values)
        if quantity.kind == "increments":
            return self._usable(quantity, _summed(values))
        blank = np.isnan(values).any(axis=1)
        if (blank != np.isnan(values).all(axis=1)).any():
            row = int(np.argmax(blank != np.isnan(values).all(axis=1)))
            raise BadInput(f"{self.source.path}: {self.source.place(row)}: pose has some of its columns alone, and a "
                           "displacement needs all; repair the line")
        return self._usable(quantity, values)

    def _in_si(self, quantity: Quantity, values: np.ndarray) -> np.ndarray:
        """Columns of a pose as x, y and, where it is known, heading."""
        if quantity.quaternion:
            values, remark = poses.with_heading(self.source.path, values, quantity.quaternion, self.source.place)
            self.remarks += [remark] if remark else []
        if LATITUDE in quantity.units or self.source.is_geodetic:
            values, remark = poses.in_metres(values, quantity.units if LATITUDE in quantity.units else (LATITUDE, ""))
            self.remarks.append(remark)
            return values
        return self._merged(quantity, poses.scaled(quantity, values))

    def _merged(self, quantity: Quantity, values: np.ndarray) -> np.ndarray:
        """The mean of the columns that measure one value; angles of wheels, which count from anywhere, are shifted to
        agree before."""
        if not quantity.members:
            return values
        found, first, time = [], 0, self.source.time_s
        for count in quantity.members:
            part = values[:, first:first + count]
            first += count
            if count > 1:
                part = np.column_stack([_filled(time, column) for column in part.T])
                both = part[~np.isnan(part).any(axis=1)]
                if not len(both):
                    raise BadInput(f"{self.source.path}: {quantity.name}: the columns that measure one value are never "
                                   "there at one time; keep one of them in the map")
                if quantity.name == "wheel_angle":
                    part = part - (both.mean(axis=0) - both.mean())
                    both = both - (both.mean(axis=0) - both.mean())
                apart = float(np.ptp(both, axis=1).max())
                size = float(np.ptp(both)) or 1.0
                self.remarks.append(f"{quantity.name} is the mean of {count} sensors, which differ by at most "
                                    f"{apart:.3g}, {100.0 * apart / size:.2g} % of the range")
            found.append(part.mean(axis=1))
        return np.column_stack(found)

    def _fold_turns(self, scaled: np.ndarray) -> None:
        """A difference of two headings that were within one turn is taken the shorter way around."""
        with np.errstate(invalid="ignore"):
            wide = np.abs(scaled[:, 2]) > HALF_TURN
        if wide.any():
            scaled[wide, 2] = np.remainder(scaled[wide, 2] + HALF_TURN, 2.0 * HALF_TURN) - HALF_TURN
            self.remarks.append(f"pose turns by more than half a turn at {int(wide.sum())} samples (the first is "
                                f"{self.source.place(int(np.argmax(wide)))}), which are taken the shorter way around")


def _filled(time_s: np.ndarray, column: np.ndarray) -> np.ndarray:
    """A column at all instants between its first value and its last."""
    there = ~np.isnan(column)
    if there.all() or not there.any():
        return column
    return np.interp(time_s, time_s[there], column[there], left=np.nan, right=np.nan)


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
    return spread(values, [wheel - 1 for wheel in wheels], max(wheels)) if wheels else values


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


def _check_time(path: Path, time: np.ndarray, place: Callable[[int], str]) -> None:
    grows = np.diff(time) > 0.0
    if len(time) < LEAST_SAMPLES:
        raise BadInput(f"{path}: needs at least {LEAST_SAMPLES} samples with increasing time, has {len(time)}; give a "
                       "whole recorded run")
    if not grows.all():
        row = int(np.argmin(grows)) + 1
        raise BadInput(f"{path}: {place(row)}: time does not grow ({time[row - 1]:.9g} s, then {time[row]:.9g} s); "
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
