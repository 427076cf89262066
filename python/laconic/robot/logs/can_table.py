"""A CAN log as a table: one sample for each frame that the map needs, decoded by a DBC.

A row is complete when each signal that must be there has come anew; a frame or a page brings its own signals. A frame
is matched by its identifier, by the bits of the identifier (11 or 29), and by its channel. Frames that are shorter than
their message are left out and counted; remote frames and error frames carry no signals.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from laconic.base.paths import SOURCE_DIR
from laconic.can.dbc_file import Dbc, DbcEntry, load_dbc
from laconic.errors import BadInput, nearest_of
from laconic.robot.logs.can_signals import Wanted, float_fault
from laconic.robot.logs.column_map import ColumnMap
from laconic.robot.logs.formats.can_frames import LoggedFrame, read_frames
from laconic.robot.logs.quantity import NUMBERED, Quantity

OWN_DBC = SOURCE_DIR / "firmware_stub" / "laconic.dbc"
SAME_INSTANT = 0.1       # of the rows' period: signals of so near frames are of one instant
MOST_GROUPS = 1000       # of wheels
DISORDER_S = 0.1         # by which frames of a log may be out of order, as those of several interfaces are
BITS = {False: "11 bits", True: "29 bits"}

Key = tuple[str, str]
"""A channel (empty: the only one) and "MESSAGE.signal"."""


@dataclass(frozen=True)
class CanTable:
    """A sample for each frame; a signal that a frame does not have is NaN there."""

    time_s: np.ndarray
    places: list[str]
    values: dict[Key, np.ndarray]
    is_row: np.ndarray
    hold_s: float
    remarks: tuple[str, ...]
    channel: str

    def names_on(self, channel: str) -> list[str]:
        """The signals that come on a channel, as "MESSAGE.signal"."""
        return [name for each, name in self.values if each == channel]

    def column(self, quantity: Quantity, index: int, name: str) -> np.ndarray | None:
        """A signal on the channel of a quantity's column; None where it does not come."""
        return self.values.get((quantity.channel_of(index, self.channel), name))


@dataclass
class Want:
    """One message on one channel: its signals that the map takes."""

    entry: DbcEntry
    channel: str
    signals: Wanted
    needed: list[str]                 # signals that must be there
    group: str                        # the signal that says which wheels a frame is of; empty: none
    heard: set[str] = field(default_factory=set)      # channels on which it came
    names: dict[int, dict[str, str]] = field(default_factory=dict)   # of each group: signal → "MESSAGE.signal"
    shares: dict[tuple[int, tuple[str, ...]], frozenset[str]] = field(default_factory=dict)
    short: list[tuple[str, int]] = field(default_factory=list)  # places and lengths of frames that are too short
    frames: int = 0

    @property
    def title(self) -> str:
        """How messages name it."""
        return f"{self.entry.name} (0x{self.entry.frame_id:X}, {BITS[self.entry.is_extended_frame]})"

    def names_in(self, group: int) -> dict[str, str]:
        """The signals of a group of wheels as "MESSAGE.signal"."""
        if group not in self.names:
            self.names[group] = {name: counted_name(self, name, group) for name in self.signals.names}
        return self.names[group]

    def needed_of(self, group: int, there: tuple[str, ...]) -> frozenset[str]:
        """What a frame with these signals brings of what must be there."""
        if (group, there) not in self.shares:
            names = self.names_in(group)
            self.shares[group, there] = frozenset(names[name] for name in there if name in self.needed)
        return self.shares[group, there]


def database_of(columns: ColumnMap) -> Dbc:
    """The DBC that a map names: beside the map, or the project's own by its name."""
    beside = columns.path.parent / columns.dbc
    path = OWN_DBC if not beside.exists() and columns.dbc == OWN_DBC.name else beside
    return load_dbc(path, f"{columns.path}: dbc: {path}")


def signal_names(columns: ColumnMap, quantity: Quantity, database: Dbc) -> list[tuple[str, DbcEntry, str]]:
    """The signals of a quantity with their channels; a name with # stands for all that the message has."""
    found: list[tuple[str, DbcEntry, str]] = []
    for index, column in enumerate(map(str, quantity.columns)):
        channel = quantity.channel_of(index, columns.channel)
        name, signal = column.split(".")
        entry = _message(columns, quantity, database, name)
        known = [each.name for each in entry.c.signals]
        numbered = (signal.replace(NUMBERED, str(n)) for n in range(1, len(known) + 1))
        there = [each for each in dict.fromkeys(numbered) if each in known]
        if not there:
            raise BadInput(f"{columns.path}: {quantity.name}.columns: {name} has no signal {signal!r}; "
                           f"{nearest_of(signal, known) if known else 'it has none'}")
        if twice := next((each for each in there if known.count(each) > 1), None):
            raise BadInput(f"{columns.path}: {quantity.name}.columns: {name} has two signals {twice} in the DBC; "
                           "rename one of them there")
        found += [(channel, entry, each) for each in there]
    return found


def _message(columns: ColumnMap, quantity: Quantity, database: Dbc, name: str) -> DbcEntry:
    """A message that the DBC has once, and without a fault."""
    where = f"{columns.path}: {quantity.name}.columns"
    entry = database.named(name, f"{where}: the DBC")
    if sum(each.name == name for each in database.messages) > 1:
        raise BadInput(f"{where}: {name} is in the DBC twice; rename one of them there")
    database.check(entry)
    if odd := float_fault({each.name: each for each in entry.c.signals}):
        raise BadInput(f"{where}: {name} has {odd} as a float, and not of 16, 32 or 64 bits; correct the DBC")
    return entry


def read_can(path: Path, columns: ColumnMap) -> CanTable:
    """A sample for each frame of the map's messages; BadInput where one of these does not come."""
    wants = _wants(columns, database_of(columns))
    recorded = read_frames(path)
    samples = list(_samples(path, columns, recorded.frames, wants))
    _check_there(path, columns, wants, recorded.frames)
    remarks = [*recorded.remarks, *_short(wants)]
    if disorder := _disorder(path, samples):
        remarks.append(disorder)
        samples.sort(key=lambda sample: sample.time_s)
    return _table(path, columns, samples, wants, tuple(remarks))


def _wants(columns: ColumnMap, database: Dbc) -> list[Want]:
    names: dict[tuple[str, str], list[tuple[DbcEntry, str, bool]]] = {}
    for quantity in columns.quantities.values():
        for channel, entry, signal in signal_names(columns, quantity, database):
            names.setdefault((channel, entry.name), []).append((entry, signal, quantity.is_optional))
    found = []
    for (channel, _), each in names.items():
        entry = each[0][0]
        group = columns.group if columns.group in [signal.name for signal in entry.c.signals] else ""
        wanted = Wanted(entry.c, dict.fromkeys(signal for _, signal, _ in each))
        needed = list(dict.fromkeys(signal for _, signal, is_optional in each if not is_optional))
        found.append(Want(entry, channel, wanted, needed, group))
    return found


# ------------------------------------------------------------------------------------------ frames


@dataclass(slots=True)
class Sample:
    """What one frame says."""

    time_s: float
    place: str
    channel: str
    values: dict[str, float]
    needed: frozenset[str]


def _samples(path: Path, columns: ColumnMap, frames: Sequence[LoggedFrame], wants: Sequence[Want]) -> Iterator[Sample]:
    by_id: dict[tuple[int, bool], list[Want]] = {}
    for want in wants:
        by_id.setdefault((want.entry.frame_id, want.entry.is_extended_frame), []).append(want)
    for frame in frames:
        if frame.is_remote_frame or frame.is_error_frame:
            continue
        for want in by_id.get((frame.arbitration_id, frame.is_extended_id), ()):
            channel = "" if frame.channel is None else str(frame.channel)
            want.heard.add(channel)
            if want.channel not in ("", channel):
                continue
            want.frames += 1
            data = bytes(frame.data)
            if len(data) < want.entry.c.length:
                want.short.append((frame.place, len(data)))
                continue
            yield _sample(path, frame, want, data)


def _sample(path: Path, frame: LoggedFrame, want: Want, data: bytes) -> Sample:
    """A frame's signals; in a group the signals' numbers go on counting. BadInput for a number that is not finite."""
    which = _group_of(path, frame, want, data) if want.group else 0
    values, names = want.signals.values(data), want.names_in(which)
    if not math.isfinite(sum(values.values())):
        name = next((name for name, value in values.items() if not math.isfinite(value)), None)
        if name is not None:
            raise BadInput(f"{path}: {frame.place}: {want.entry.name}.{name} is not finite; remove the frame or repair "
                           "it")
    needed = want.needed_of(which, tuple(values))
    return Sample(frame.timestamp, frame.place, want.channel,
                  {names[name]: value for name, value in values.items()}, needed)


def _group_of(path: Path, frame: LoggedFrame, want: Want, data: bytes) -> int:
    """Which wheels a frame is of, counted from 0; BadInput for a group that no vehicle has."""
    value = want.signals.one(want.group, data)
    if not 0.0 <= value < MOST_GROUPS or value != int(value):
        raise BadInput(f"{path}: {frame.place}: {want.entry.name}.{want.group} is {value:g}, which is not a group of "
                       "wheels, counted from 0; correct group in the map")
    return int(value)


def counted_name(want: Want, signal: str, group: int) -> str:
    """ "MESSAGE.signal"; the signals of further groups count on from those of the first."""
    stem = signal.rstrip("0123456789")
    if stem == signal or not group:
        return f"{want.entry.name}.{signal}"
    per_group = sum(each.name.rstrip("0123456789") == stem for each in want.entry.c.signals)
    return f"{want.entry.name}.{stem}{int(signal[len(stem):]) + group * per_group}"


def _check_there(path: Path, columns: ColumnMap, wants: Sequence[Want], frames: Sequence[LoggedFrame]) -> None:
    """BadInput for a message that comes on several channels, on another one, or not at all."""
    for want in wants:
        heard = sorted(want.heard)
        if not want.channel and len(heard) > 1:
            raise BadInput(f"{path}: {want.title} comes on the channels {', '.join(heard[:-1])} and {heard[-1]}; give "
                           f"the right one in the map {columns.path}, such as channel = {_as_toml(heard[0])}"
                           f"; equal devices on several need channels = [{', '.join(map(_as_toml, heard))}] under "
                           "their quantity")
        if not want.needed or want.frames > len(want.short):
            continue
        if want.short:
            place, length = want.short[0]
            raise BadInput(f"{path}: all {len(want.short)} frames of {want.title} are shorter than its "
                           f"{want.entry.c.length} bytes (the first, {place}, has {length}); correct the map's dbc")
        if heard:
            raise BadInput(f"{path}: {want.title} does not come on the channel {want.channel}, but on "
                           f"{' and '.join(heard)}; correct channel in the map {columns.path}")
        raise BadInput(f"{path}: holds no frame {want.title}{_other(want, frames)}; record it, or correct the map's "
                       "dbc")


def _as_toml(channel: str) -> str:
    return channel if channel.isdecimal() else f'"{channel}"'


def _other(want: Want, frames: Sequence[LoggedFrame]) -> str:
    """What a log has instead of a message: the same number with other bits is another identifier."""
    entry = want.entry
    same = [frame for frame in frames if frame.arbitration_id == entry.frame_id and not frame.is_error_frame]
    if any(frame.is_extended_id != entry.is_extended_frame for frame in same):
        other = not entry.is_extended_frame
        return f" (0x{entry.frame_id:X} with {BITS[other]}, which it has, is another message)"
    return " with data, only remote frames of it" if same else ""


def _short(wants: Sequence[Want]) -> Iterator[str]:
    for want in wants:
        if want.short:
            count, (place, length) = len(want.short), want.short[0]
            yield (f"{count} {'frame' if count == 1 else 'frames'} of {want.entry.name} left out: {length} instead of "
                   f"{want.entry.c.length} bytes ({place}{', the first' if count > 1 else ''})")


def _disorder(path: Path, samples: Sequence[Sample]) -> str | None:
    """A remark on frames that are not in the order of their times; BadInput for a clock that was set back."""
    times = np.array([sample.time_s for sample in samples])
    back = np.maximum.accumulate(times) - times if len(times) else times
    if not (back > 0.0).any():
        return None
    worst = int(np.argmax(back))
    if back[worst] > DISORDER_S:
        raise BadInput(f"{path}: {samples[worst].place}: time goes back by {back[worst]:.6g} s; cut the log there, or "
                       "record it with one clock")
    return (f"{int((back > 0.0).sum())} frames are not in the order of their times, by {back[worst]:.2g} s at most, "
            "and are sorted")


# -------------------------------------------------------------------------------------------- rows


def _table(path: Path, columns: ColumnMap, samples: Sequence[Sample], wants: Sequence[Want],
           remarks: tuple[str, ...]) -> CanTable:
    keys = list(dict.fromkeys((sample.channel, name) for sample in samples for name in sample.values))
    _check_pages(path, wants, set(keys))
    values = {key: np.full(len(samples), np.nan) for key in keys}
    for index, sample in enumerate(samples):
        for name, value in sample.values.items():
            values[sample.channel, name][index] = value
    is_row = np.array(_rounds(samples), dtype=bool)
    time = np.array([sample.time_s for sample in samples])
    if not is_row.any():
        raise BadInput(f"{path}: holds no whole round of its frames{_rarest(samples)}; give a longer log")
    period_s = float(np.median(np.diff(time[is_row]))) if is_row.sum() > 1 else 0.0
    return CanTable(time, [sample.place for sample in samples], values, is_row, SAME_INSTANT * period_s, remarks,
                    columns.channel)


def _check_pages(path: Path, wants: Sequence[Want], found: set[Key]) -> None:
    """BadInput for a signal that no frame has, as its page never came."""
    for want in wants:
        for name in want.needed:
            if (want.channel, f"{want.entry.name}.{name}") not in found and not want.group:
                raise BadInput(f"{path}: holds no frame of {want.entry.name} with {name}"
                               f"{want.signals.page_of(name)}; record it, or correct the map's dbc")


def _rounds(samples: Sequence[Sample]) -> list[bool]:
    """Which samples complete a round: every signal that must be there has come since the row before."""
    needed = {(sample.channel, name) for sample in samples for name in sample.needed}
    fresh: set[Key] = set()
    found = []
    for sample in samples:
        fresh.update((sample.channel, name) for name in sample.needed)
        is_complete = needed <= fresh
        found.append(is_complete)
        if is_complete:
            fresh = set()
    return found


def _rarest(samples: Sequence[Sample]) -> str:
    """The signal that comes least often."""
    count = Counter(name for sample in samples for name in sample.needed)
    name = min(count, key=lambda each: count[each], default="")
    return f" ({name} comes {count[name]} times)" if name else ""
