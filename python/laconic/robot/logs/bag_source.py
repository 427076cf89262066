"""The topics of a recording as one table of samples, joined by the stamps of their headers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from laconic.errors import BadInput, nearest_of
from laconic.robot.bags.samples import (
    TF,
    Frames,
    Samples,
    all_topics,
    is_ulog,
    read_samples,
    recordings,
    sample_messages,
    topic_of,
)
from laconic.robot.logs.column_map import ColumnMap
from laconic.robot.logs.log import PER_WHEEL
from laconic.robot.logs.quantity import Quantity
from laconic.robot.logs.sources import Raw, Source

POSES = {
    "Odometry": ("pose.pose.position.x", "pose.pose.position.y", "pose.pose.orientation"),
    "PoseWithCovarianceStamped": ("pose.pose.position.x", "pose.pose.position.y", "pose.pose.orientation"),
    "PoseStamped": ("pose.position.x", "pose.position.y", "pose.orientation"),
    "PoseInFrame": ("pose.position.x", "pose.position.y", "pose.orientation"),
    "Pose": ("position.x", "position.y", "orientation"),
    "TransformStamped": ("transform.translation.x", "transform.translation.y", "transform.rotation"),
    "Transform": ("translation.x", "translation.y", "rotation"),
    "Pose2D": ("x", "y", "theta"),
    "PointStamped": ("point.x", "point.y"),
    "Point": ("x", "y"),
    "Vector3Stamped": ("vector.x", "vector.y"),
    "NavSatFix": ("latitude", "longitude"),
}
"""Where the pose is in messages of each type, by the type's own name; two fields are positions without a heading."""
GEODETIC = "NavSatFix"
OFTEN = 1e-3      # s: an age that is worth a word


def own_name(type_name: str) -> str:
    """The name of a type without its package: geometry_msgs/msg/PoseStamped is PoseStamped."""
    return type_name.replace(".", "/").rpartition("/")[2]


def split_column(column: str) -> tuple[str, str]:
    """The topic and the field of /topic.field[index]."""
    topic, _, field = column.partition(".")
    return topic, field


@dataclass(frozen=True)
class Place:
    """Where the columns of a quantity are: (topic, index of its column) each, or a pair of frames."""

    columns: tuple[tuple[str, int], ...] = ()
    frames: Frames | None = None
    labels: tuple[str, ...] = ()


def bag_source(path: Path, columns: ColumnMap) -> Source:
    """A recording of topics by a map; BadInput names the topic or field that is not there."""
    wanted: dict[str, list[str]] = {}
    frames: list[Frames] = []
    places, is_geodetic = {}, False
    types = _types(path, columns)
    for quantity in columns.quantities.values():
        if quantity.name == "time" or (quantity.is_optional and not _is_there(quantity, types)):
            continue
        names = list(map(str, quantity.columns))
        if quantity.topic:
            names = _of_topic(path, columns, quantity.topic, types)
            is_geodetic = is_geodetic or own_name(types[_known(path, quantity.topic, types)]) == GEODETIC
        if quantity.frames:
            frames.append((quantity.frames[0], quantity.frames[1]))
            places[quantity.name] = Place((), frames[-1], tuple(f"{TF} {part}" for part in ("x", "y", "heading")))
            continue
        found = []
        for name in names:
            topic, field = split_column(name)
            fields = wanted.setdefault(topic, [])
            if field not in fields:
                fields.append(field)
            found.append((topic, fields.index(field)))
        places[quantity.name] = Place(tuple(found), None, tuple(names))
    read = read_samples(path, wanted, frames)
    topics, clock = _on_one_clock({**read.topics, **{_key(pair): each for pair, each in read.frames.items()}},
                                  columns.stamps)
    _check_fields(path, columns, places, topics)
    return _joined(path, columns, places, topics, is_geodetic, (*columns.notes, *read.remarks, *clock))


def _key(pair: Frames) -> str:
    return " ".join((TF, *pair))


def _types(path: Path, columns: ColumnMap) -> dict[str, str]:
    """The type of each topic; of a ULog the topics have none."""
    if is_ulog(path):
        from laconic.robot.bags.samples import topics_of_ulog

        return dict.fromkeys(topics_of_ulog(path), "")
    with recordings(path) as parts:
        return {name: topic.type for name, topic in all_topics(parts).items()}


def _is_there(quantity: Quantity, types: dict[str, str]) -> bool:
    topics = [quantity.topic] if quantity.topic else [TF] if quantity.frames else [
        split_column(str(column))[0] for column in quantity.columns]
    return all(topic in types or f"/{topic}" in types for topic in topics)


def _known(path: Path, name: str, types: dict[str, str]) -> str:
    if name in types or f"/{name}" in types:
        return name if name in types else f"/{name}"
    with recordings(path) as parts:
        return topic_of(path, all_topics(parts), name).name


def _of_topic(path: Path, columns: ColumnMap, topic: str, types: dict[str, str]) -> list[str]:
    """The columns of a pose by the type of its messages."""
    kind = own_name(types[_known(path, topic, types)])
    if kind not in POSES:
        raise BadInput(f"{path}: {topic} is of type {types[_known(path, topic, types)] or 'unknown'}, in which no pose "
                       "is known; give its fields as columns under [pose] in the map, such as "
                       f'"{topic}.pose.position.x"')
    return [f"{topic}.{field}" for field in POSES[kind]]


def _on_one_clock(topics: dict[str, Samples], stamps: str) -> tuple[dict[str, Samples], list[str]]:
    """All topics on the clock of their headers; on the recorder's where the map asks for it or headers disagree."""
    by_arrival = {name: each.by_arrival() for name, each in topics.items()}
    if stamps == "arrival":
        return by_arrival, []
    begin, end = (pick(edge(each.stamp_ns) for each in topics.values()) for pick, edge in (
        (max, np.min), (min, np.max)))
    if begin <= end:
        unstamped = [name for name, each in topics.items() if not each.has_stamps]
        if unstamped and len(unstamped) < len(topics):
            return topics, [f"{', '.join(unstamped)}: messages have no stamps, and the instants of their arrival count"]
        return topics, []
    begin, end = (pick(edge(each.stamp_ns) for each in by_arrival.values()) for pick, edge in (
        (max, np.min), (min, np.max)))
    if begin > end:
        return topics, []  # the rows will say that they share no time
    return by_arrival, ["the stamps of the topics are on clocks that share no time, so the instants of arrival count"]


def _check_fields(path: Path, columns: ColumnMap, places: dict[str, Place], topics: dict[str, Samples]) -> None:
    """BadInput for a field that no message has; joints may be in angles or in speeds."""
    blank: dict[str, str] = {}
    for name, place in places.items():
        for (topic, index), label in zip(place.columns, place.labels, strict=not place.frames):
            if np.isnan(topics[topic].values[:, index]).all():
                blank.setdefault(name, label)
    for name, label in blank.items():
        if columns.quantities[name].is_optional and any(other in places and other not in blank for other in PER_WHEEL):
            continue
        topic, field = split_column(label)
        joint = field.partition("[")[2].rstrip("]")
        message = None if is_ulog(path) else sample_messages(path, [topic]).get(topic)
        names = [str(each) for each in getattr(message, "name", [])] if joint and not joint.isdigit() else []
        if names:
            raise BadInput(f"{path}: {topic} has no joint {joint}; correct the map "
                           f"({nearest_of(joint, names, f'it has {chr(44).join(names[:20])}')})")
        if not columns.quantities[name].is_optional or name in PER_WHEEL:
            raise BadInput(f"{path}: {topic} has no number in its field {field or '(none)'} (for {name}); correct the "
                           "map; `laconic logs` shows what there is")


def _joined(path: Path, columns: ColumnMap, places: dict[str, Place], topics: dict[str, Samples], is_geodetic: bool,
            remarks: Sequence[str]) -> Source:
    """All instants at which a topic has a message; the wheels' messages become the rows of the log."""
    instants = np.unique(np.concatenate([each.stamp_ns for each in topics.values()]))
    time_s = (instants - instants[0]) / 1e9
    rows_of = {name: np.searchsorted(instants, each.stamp_ns) for name, each in topics.items()}
    leading = next((name for name in (*PER_WHEEL, *columns.quantities) if name in places), "")
    first = places[leading]
    main = _key(first.frames) if first.frames else first.columns[0][0]
    is_row = np.full(len(instants), False)
    is_row[rows_of[main]] = True
    if first.columns:
        values = topics[main].values[:, first.columns[0][1]]
        is_row[rows_of[main][np.isnan(values)]] = np.isnan(values).all()

    def raw(quantity: Quantity) -> Raw | None:
        place = places.get(quantity.name)
        if place is None:
            return None
        found = np.full((len(instants), 3 if place.frames else len(place.columns)), np.nan)
        if place.frames:
            found[rows_of[_key(place.frames)]] = topics[_key(place.frames)].values
        for column, (topic, index) in enumerate(place.columns):
            found[rows_of[topic], column] = topics[topic].values[:, index]
        if quantity.is_optional and np.isnan(found).all(axis=0).any():
            return None
        return found, list(place.labels)

    told = [*remarks, *(remark for each in topics.values() for remark in each.remarks),
            *(_age(each, name == main) for name, each in topics.items())]
    names = tuple(label.partition("[")[2].rstrip("]") or label for label in first.labels)
    return Source(path, time_s, raw, lambda row: f"the message of {main} at {time_s[row]:.6g} s", is_row,
                  lines=lambda rows: f"{len(rows)} messages of {main} are", remarks=tuple(filter(None, told)),
                  wheel_names=names if columns.is_guess and leading in PER_WHEEL else (), is_geodetic=is_geodetic,
                  tells_gaps=False)


def _age(samples: Samples, is_main: bool) -> str:
    """How often a topic comes and how old its messages are."""
    apart = np.diff(samples.stamp_ns) / 1e9
    age = (samples.arrival_ns - samples.stamp_ns) / 1e9
    if not len(apart):
        return f"{samples.topic}: 1 message"
    how = "each of them one row" if is_main else "joined to the rows by their stamps"
    text = (f"{samples.topic}: {len(age)} messages, {how}, {np.median(apart):.3g} s apart in the median and "
            f"{apart.max():.3g} s at most")
    if samples.has_stamps and np.abs(age).max() > OFTEN:
        text += f"; recorded {np.median(age):.3g} s after their stamps in the median, {age.max():.3g} s at most"
    return text
