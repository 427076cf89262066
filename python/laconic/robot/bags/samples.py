"""The columns of topics: every message is one sample at the instant of its header, or of its arrival without one."""

from __future__ import annotations

import io
import math
from array import array
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, redirect_stdout
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from laconic.base.progress import progress_bar
from laconic.errors import BadInput, nearest_of
from laconic.robot.bags.containers import opened
from laconic.robot.bags.messages import GIVE, ULOG_MAGIC, Recording, Topic, field_of, first_bytes, parts_of, stamp_ns

CLOCK = "timestamp"


def load_ulog(path: Path, names: Sequence[str] | None = None) -> Any:
    """The file, with the data of some topics alone; BadInput for one that cannot be read."""
    from pyulog import ULog

    try:
        with redirect_stdout(io.StringIO()):  # it prints warnings of its own, and states the same as file_corruption
            return ULog(str(path), names, disable_str_exceptions=True)
    except Exception:  # of the library: broken bytes have many kinds of errors
        raise BadInput(f"{path}: is no ULog that can be read; {GIVE}") from None


def name_of(dataset: Any) -> str:
    """vehicle_odometry, and its second instance vehicle_odometry#1."""
    return dataset.name + (f"#{dataset.multi_id}" if dataset.multi_id else "")


def read_ulog(path: Path, wanted: Mapping[str, Sequence[str]]) -> Found:
    """Some fields of some topics."""
    log = load_ulog(path, [name.partition("#")[0] for name in wanted])
    sets = {name_of(each): each for each in log.data_list}
    found = {}
    for name, fields in wanted.items():
        if name not in sets:
            known = sets or {each.message_name for each in load_ulog(path).logged_messages}
            raise BadInput(f"{path}: has no topic {name}; correct the map "
                           f"({nearest_of(name, known, f'it has {chr(44).join(sorted(known)[:20])}')})")
        data = sets[name].data
        columns = [np.asarray(data[each], float) if each in data else None for each in fields]
        missing = next((each for each, column in zip(fields, columns, strict=True) if column is None), None)
        if missing is not None:
            raise BadInput(f"{path}: {name} has no field {missing}; {nearest_of(missing, data)}")
        stamp = np.asarray(data[CLOCK], np.int64) * 1000
        stamp, first = np.unique(stamp, return_index=True)
        values = np.column_stack([each for each in columns if each is not None])[first] if columns else \
            np.zeros((len(stamp), 0))
        found[name] = Samples(name, stamp, stamp, values, True)
    remarks = [f"{path.name}: {len(log.dropouts)} dropouts"] if log.dropouts else []
    if log.file_corruption:
        remarks.append(f"{path.name} is broken in places; what can be read is taken")
    return Found(found, {}, tuple(remarks))


def topics_of_ulog(path: Path) -> dict[str, Any]:
    """All topics by name, each with its dataset."""
    return {name_of(each): each for each in load_ulog(path).data_list}


TF, TF_STATIC = "/tf", "/tf_static"
MOST_NS = 1 << 62       # about the year 2116
MOST = 1e100            # in any unit
AT_ONCE = 512          # messages between two moves of the progress bar

Frames = tuple[str, str]
"""Parent and child: the pose of the one in the other."""


@dataclass(frozen=True)
class Samples:
    """Some fields of a topic, in the order of their stamps."""

    topic: str
    stamp_ns: np.ndarray        # of the headers, or of arrival
    arrival_ns: np.ndarray
    values: np.ndarray          # samples × columns; NaN: the message has no such field
    has_stamps: bool            # in the headers
    remarks: tuple[str, ...] = ()
    never: frozenset[int] = frozenset()    # columns whose field no message has

    def by_arrival(self) -> Samples:
        """At the instants at which the messages were recorded."""
        order = np.argsort(self.arrival_ns, kind="stable")
        return replace(self, stamp_ns=self.arrival_ns[order], arrival_ns=self.arrival_ns[order],
                       values=self.values[order], has_stamps=False)


@dataclass
class _Columns:
    """Collects the fields of one topic."""

    topic: str
    fields: Sequence[Callable[[Any], Any]]
    stamps: array[int] = field(default_factory=lambda: array("q"))
    arrivals: array[int] = field(default_factory=lambda: array("q"))
    values: array[float] = field(default_factory=lambda: array("d"))
    is_stamped: array[int] = field(default_factory=lambda: array("b"))
    absent: Counter[int] = field(default_factory=Counter)   # messages without each field
    short: Counter[int] = field(default_factory=Counter)    # messages whose list ends before it

    def take(self, arrival: int, message: Any) -> None:
        """A message."""
        stamp = stamp_ns(message)
        instant = stamp or arrival
        if not -MOST_NS < min(instant, arrival) <= max(instant, arrival) < MOST_NS:
            raise ValueError(instant)
        values = [self._number(index, one, message) for index, one in enumerate(self.fields)]
        self.is_stamped.append(stamp is not None and (stamp != 0 or arrival == 0))
        self.stamps.append(instant)
        self.arrivals.append(arrival)
        self.values.extend(values)

    def _number(self, index: int, take: Callable[[Any], Any], message: Any) -> float:
        """A field as a number; of a quaternion its heading; NaN where the message has no such field, which is noted."""
        try:
            value = take(message)
            if isinstance(value, (int, float)):  # of nearly all fields: it shall not be looked at for a quaternion
                return float(value)
            return heading_of(value) if _is_quaternion(value) else float(value)
        except IndexError:
            self.short[index] += 1
        except (AttributeError, KeyError, TypeError, ValueError, OverflowError):
            pass
        self.absent[index] += 1
        return math.nan

    def _doubts(self, values: np.ndarray) -> list[str]:
        """Remarks on messages that have a field, but no value in it."""
        short = max(self.short.values(), default=0)
        nan = max((int(np.isnan(column).sum()) - self.absent[index] for index, column in enumerate(values.T)),
                  default=0)
        return [f"{self.topic}: {count} of {len(values)} messages {words}" for count, words in (
            (short, "have fewer values than names or places in the map; what they lack is left out"),
            (nan, "hold NaN, or a quaternion of length 0; those values are left out")) if 0 < count]

    def samples(self) -> Samples:
        """All of them, sorted; of two with one stamp the later one counts."""
        stamps, arrivals = np.array(self.stamps, np.int64), np.array(self.arrivals, np.int64)
        values = np.array(self.values, float).reshape(len(stamps), len(self.fields))
        keep = np.array(self.is_stamped, bool)
        has_stamps = bool(keep.any())
        remarks = self._doubts(values)
        never = frozenset(index for index, count in self.absent.items() if count == len(values))
        if has_stamps and not keep.all():
            remarks.append(f"{self.topic}: {int((~keep).sum())} of {len(keep)} messages have no stamp and are left out")
            stamps, arrivals, values = stamps[keep], arrivals[keep], values[keep]
        order = np.argsort(stamps, kind="stable")
        if (np.diff(order) < 0).any():
            remarks.append(f"{self.topic}: messages are not in the order of their stamps and were sorted")
        stamps, arrivals, values = stamps[order], arrivals[order], values[order]
        last = np.append(np.diff(stamps) > 0, True)[:len(stamps)]
        if not last.all():
            remarks.append(f"{self.topic}: {int((~last).sum())} messages have the stamp of another one and are left "
                           "out")
        return Samples(self.topic, stamps[last], arrivals[last], values[last], has_stamps, tuple(remarks), never)


def _is_quaternion(value: Any) -> bool:
    return all(name in value for name in "xyzw") if isinstance(value, dict) else all(
        hasattr(value, name) for name in "xyzw")


def heading_of(quaternion: Any) -> float:
    """About the vertical axis; NaN for one of no length."""
    x, y, z, w = (float(quaternion[name] if isinstance(quaternion, dict) else getattr(quaternion, name))
                  for name in "xyzw")
    if not x * x + y * y + z * z + w * w > 0.0:
        return math.nan
    return math.atan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z)


@dataclass
class _Frames:
    """Collects transforms between frames, for a chain of them."""

    edges: dict[tuple[str, str], _Columns] = field(default_factory=dict)

    def take(self, arrival: int, message: Any) -> None:
        """A message of /tf or /tf_static."""
        for each in message["transforms"] if isinstance(message, dict) else message.transforms:
            parent, child = (str(take(each)).lstrip("/") for take in (PARENT, CHILD))
            edge = self.edges.setdefault((parent, child), _Columns(f"{TF} {parent} → {child}", TRANSFORM))
            edge.take(arrival, each)

    def between(self, path: Path, parent: str, child: str) -> Samples:
        """The pose of a frame in another one; BadInput where no chain of transforms joins them."""
        names = {name for edge in self.edges for name in edge}
        for name in (parent, child):
            if name not in names:
                raise BadInput(f"{path}: {TF} has no frame {name}; {nearest_of(name, names, None)}")
        above = {child_of: parent_of for parent_of, child_of in self.edges}
        chain, at = list[Frames](), child
        while at != parent:
            if at not in above or len(chain) > len(above):
                raise BadInput(f"{path}: {TF} joins the frames {parent} and {child} by no chain of transforms; name "
                               "two frames of which one carries the other")
            chain.append((above[at], at))
            at = above[at]
        return chained([_whole(path, self.edges[edge].samples()) for edge in reversed(chain)], parent, child)


PARENT, CHILD = field_of("header.frame_id"), field_of("child_frame_id")
TRANSFORM_NAMES = ("x", "y", "rotation")
TRANSFORM = tuple(map(field_of, ("transform.translation.x", "transform.translation.y", "transform.rotation")))


def _whole(path: Path, samples: Samples) -> Samples:
    """The transforms that are numbers; BadInput where none is, or where one is too large for any map."""
    check_sizes(path, samples.topic, samples.values, lambda row: f"its transform {row + 1}", TRANSFORM_NAMES)
    there = ~np.isnan(samples.values).any(axis=1)
    if not there.any():
        raise BadInput(f"{path}: {samples.topic}: none of its {len(there)} transforms is a valid pose (NaN, or a "
                       "quaternion of length 0); name other frames in the map")
    return replace(samples, stamp_ns=samples.stamp_ns[there], arrival_ns=samples.arrival_ns[there],
                   values=samples.values[there])


def check_sizes(path: Path, name: str, values: np.ndarray, place: Callable[[int], str],
                labels: Sequence[str]) -> None:
    """BadInput for a number that no sensor states, by its row and column: sums of its squares would overflow."""
    with np.errstate(invalid="ignore"):
        wrong = np.abs(values) > MOST
    if wrong.any():
        row, column = (int(each) for each in np.argwhere(wrong)[0])
        more = int(wrong.any(axis=1).sum()) - 1
        raise BadInput(f"{path}: {place(row)}: {name} {labels[min(column, len(labels) - 1)]} is "
                       f"{values[row, column]:g}, which no sensor states{f', and so are {more} others' if more else ''}"
                       "; remove these samples, or record the topic anew")


def chained(edges: Sequence[Samples], parent: str, child: str) -> Samples:
    """Transforms one after another, at the instants of the one that comes most often; the others are interpolated, or
    held where they come once."""
    leading = max(edges, key=lambda each: len(each.stamp_ns))
    time = leading.stamp_ns
    found = np.zeros((len(time), 3))
    for each in edges:
        local = np.column_stack([each.values[:, :2], np.unwrap(each.values[:, 2])])
        at = local if each is leading else np.column_stack([
            np.interp((time - time[0]).astype(float), (each.stamp_ns - time[0]).astype(float), column)
            for column in local.T])
        cos, sin = np.cos(found[:, 2]), np.sin(found[:, 2])
        found = np.column_stack([found[:, 0] + cos * at[:, 0] - sin * at[:, 1],
                                 found[:, 1] + sin * at[:, 0] + cos * at[:, 1], found[:, 2] + at[:, 2]])
    remarks = tuple(remark for each in edges for remark in each.remarks)
    return replace(leading, topic=f"{TF} {parent} → {child}", values=found, remarks=remarks)


@dataclass(frozen=True)
class Found:
    """What was read: the samples of each topic, and of each pair of frames."""

    topics: dict[str, Samples]
    frames: dict[Frames, Samples]
    remarks: tuple[str, ...]


def read_samples(path: Path, parts: Sequence[Recording], wanted: Mapping[str, Sequence[str]],
                 frames: Sequence[Frames] = ()) -> Found:
    """Some fields of some topics, read message by message; BadInput names the topic that is not there or empty."""
    if is_ulog(path):
        return read_ulog(path, wanted)
    topics = all_topics(parts)
    names = [topic_of(path, topics, name).name for name in wanted]
    collectors: dict[str, _Columns | _Frames] = {
        name: _Columns(name, [field_of(each) for each in fields])
        for name, fields in zip(names, wanted.values(), strict=True)}
    transforms = _Frames()
    if frames:
        collectors |= {name: transforms for name in (TF, TF_STATIC) if name in topics}
    if frames and TF not in topics and TF_STATIC not in topics:
        topic_of(path, topics, TF)
    remarks = _collect(path, parts, topics, collectors)
    found = {}
    for given, name in zip(wanted, names, strict=True):
        columns = collectors[name]
        assert isinstance(columns, _Columns)
        found[given] = columns.samples()
        if not len(found[given].stamp_ns):
            raise BadInput(f"{path}: {name} has no message; leave it out of the map, or give a recording with some")
    return Found(found, {pair: transforms.between(path, *pair) for pair in frames}, remarks)


def _collect(path: Path, parts: Sequence[Recording], topics: Mapping[str, Topic],
             collectors: Mapping[str, _Columns | _Frames]) -> tuple[str, ...]:
    """Gives each message to the collector of its topic; what cannot be decoded is counted."""
    decoders = {name: topics[name].decoder() for name in collectors}
    broken: dict[str, int] = {}
    total = sum(topics[name].count or 0 for name in collectors)
    with progress_bar(f"reading {path.name}", total) as advance:
        pending = 0
        for part in parts:
            for name, arrival, data in part.messages(set(collectors)):
                pending += 1
                if pending == AT_ONCE:
                    advance(pending)
                    pending = 0
                try:
                    collectors[name].take(arrival, decoders[name](data))
                except Exception:  # bytes that are no such message fail in many ways, and none of them is ours
                    broken[name] = broken.get(name, 0) + 1
    remarks = [remark for part in parts for remark in part.remarks]
    return (*remarks, *(f"{name}: {count} messages cannot be decoded and are left out"
                        for name, count in broken.items()))


def is_ulog(path: Path) -> bool:
    """Whether a file is a ULog, whose topics are read by a library of its own."""
    return path.is_file() and first_bytes(path).startswith(ULOG_MAGIC)


@contextmanager
def recordings(path: Path) -> Iterator[list[Recording]]:
    """The files of a recording, open, for all questions about it; none of a ULog, which is read by a library of its
    own."""
    found: list[Recording] = []
    if is_ulog(path):
        yield found
        return
    try:
        for part in parts_of(path):
            found.append(opened(part))
        if not found:
            raise BadInput(f"{path}: holds no file of a recording; {GIVE}")
        yield found
    finally:
        for each in found:
            each.close()


def all_topics(parts: Sequence[Recording]) -> dict[str, Topic]:
    """The topics of all files, with all of their messages."""
    found: dict[str, Topic] = {}
    for part in parts:
        for name, topic in part.topics.items():
            before = found.get(name)
            count = None if topic.count is None else topic.count + ((before.count or 0) if before else 0)
            found[name] = replace(topic if before is None else before, count=count)
    return found


def topics_in(path: Path, parts: Sequence[Recording]) -> dict[str, Topic]:
    """All topics by name; of a ULog without types, with the number of their samples."""
    if not is_ulog(path):
        return all_topics(parts)
    return {name: Topic(name, "", len(each.data.get(CLOCK, ())), lambda: bytes)
            for name, each in sorted(topics_of_ulog(path).items())}


def topic_of(path: Path, topics: Mapping[str, Topic], name: str) -> Topic:
    """A topic by its name, with or without its first slash; BadInput names the nearest one."""
    found = topics.get(name) or topics.get(f"/{name}")
    if found is None:
        listed = ", ".join(sorted(topics)[:20]) + (" …" if len(topics) > 20 else "")
        raise BadInput(f"{path}: has no topic {name}; correct the map "
                       f"({nearest_of(name, topics, f'it has {listed}' if topics else 'it has no topic')})")
    return found


def sample_messages(parts: Sequence[Recording], names: Sequence[str]) -> dict[str, Any]:
    """The first message of some topics that can be decoded, to see their fields."""
    found: dict[str, Any] = {}
    topics = all_topics(parts)
    decoders = {}
    for name in names:
        try:
            decoders[name] = topics[name].decoder()
        except BadInput:
            continue
    for part in parts:
        for name in list(decoders):
            for _, _, data in part.messages({name}):
                try:
                    found[name] = decoders.pop(name)(data)
                except Exception:  # bytes that are no such message
                    decoders.pop(name, None)
                break
    return found
