"""Recordings as one table of samples: topics joined by the stamps of their headers, vectors of a MATLAB file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from laconic.errors import BadInput, nearest_of, reason_of, shown
from laconic.robot.bags.messages import Recording, Topic
from laconic.robot.bags.samples import (
    TF,
    Frames,
    Samples,
    all_topics,
    read_samples,
    recordings,
    sample_messages,
    topic_of,
    topics_in,
)
from laconic.robot.logs.column_map import ColumnMap
from laconic.robot.logs.log import LEAST_SAMPLES, PER_WHEEL
from laconic.robot.logs.quantity import Column, Quantity
from laconic.robot.logs.sources import Raw, Source, checked_time, doubt_of_rest, numbered
from laconic.robot.logs.units import ISO, TIME

HDF5_MAGIC = b"\x89HDF"
MOST_COLUMNS = 64     # of one matrix
GIVE = "give a MATLAB file with vectors of numbers"


def read_mat(path: Path) -> dict[str, np.ndarray]:
    """All vectors and the columns of matrices, by name[number]; BadInput for a file that cannot be read."""
    try:
        with path.open("rb") as file:
            begin = file.read(520)
    except OSError as error:
        raise BadInput(f"{path}: cannot be read ({reason_of(error)}); {GIVE}") from None
    found: dict[str, np.ndarray] = {}
    for name, value in (_of_hdf5(path) if HDF5_MAGIC in begin else _of_version_5(path)).items():
        _collect(name, value, found)
    if not found:
        raise BadInput(f"{path}: holds no vector of numbers; save time, wheels and pose as plain arrays, or as fields "
                       "of a structure")
    return found


def _of_version_5(path: Path) -> Mapping[str, Any]:
    from scipy.io import loadmat

    try:
        content: dict[str, Any] = loadmat(str(path), simplify_cells=True)
    except Exception:  # of the library: broken bytes have many kinds of errors
        raise BadInput(f"{path}: is no MATLAB file that can be read; {GIVE}") from None
    return {name: value for name, value in content.items() if not name.startswith("__")}


def _of_hdf5(path: Path) -> Mapping[str, Any]:
    """Version 7.3."""
    import h5py

    found: dict[str, Any] = {}

    def take(name: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset) and item.dtype.kind in "fiub" and not name.startswith("#"):
            found[name.replace("/", ".")] = np.asarray(item).T

    try:
        with h5py.File(path, "r") as file:
            file.visititems(take)
    except Exception:  # of the library: broken bytes have many kinds of errors
        raise BadInput(f"{path}: is no MATLAB file that can be read; {GIVE}") from None
    return found


def _collect(name: str, value: Any, found: dict[str, np.ndarray]) -> None:
    if isinstance(value, dict):
        for key, inner in value.items():
            _collect(f"{name}.{key}", inner, found)
        return
    if not isinstance(value, np.ndarray) or value.dtype.kind not in "fiub":
        return
    if value.ndim == 2 and 1 in value.shape:
        value = value.ravel()
    if value.ndim == 1 and len(value) > 1:
        found[name] = value.astype(float)
    elif value.ndim == 2:
        table = value if value.shape[0] >= value.shape[1] else value.T
        for index in range(min(table.shape[1], MOST_COLUMNS)):
            found[f"{name}[{index + 1}]"] = table[:, index].astype(float)


def mat_source(path: Path, columns: ColumnMap) -> Source:
    """A MATLAB file by a map; a quantity with a time of its own is joined to the others."""
    vectors = read_mat(path)
    of_time = columns.quantities["time"]
    main = _seconds(path, of_time, [_vector(path, vectors, each, "time") for each in of_time.columns])
    rows = list(map(str, range(1, len(main) + 1)))
    main = checked_time(path, of_time, main, [int(row) for row in rows])
    others = {each.name: _own_time(path, vectors, of_time, each) for each in columns.quantities.values() if each.time}
    instants = np.unique(np.concatenate([main, *others.values()]))

    def raw(quantity: Quantity) -> Raw | None:
        names = numbered(quantity, vectors)
        if quantity.is_optional and (not names or any(str(name) not in vectors for name in names)):
            return None
        own = others.get(quantity.name, main)
        found = np.full((len(instants), len(names)), np.nan)
        for index, name in enumerate(names):
            vector = _vector(path, vectors, name, quantity.name)
            if len(vector) != len(own):
                raise BadInput(f"{path}: {name} (for {quantity.name}) has {len(vector)} values and its time {len(own)}"
                               f"; give time under [{quantity.name}] in the map, the name of its own instants")
            found[np.searchsorted(instants, own), index] = vector
        return found, [repr(str(name)) for name in names]

    is_row = np.isin(instants, main) if others else None
    parts = [_vector(path, vectors, each, "time") for each in of_time.columns]
    doubts = doubt_of_rest(of_time, parts) if len(parts) == 2 else []
    return Source(path, instants - instants[0], raw, lambda row: f"sample {row + 1}", is_row,
                  lines=lambda given: f"{len(given)} samples are", tells_gaps=bool(others), remarks=tuple(doubts))


def _own_time(path: Path, vectors: Mapping[str, np.ndarray], of_time: Quantity, quantity: Quantity) -> np.ndarray:
    found = _seconds(path, of_time, [_vector(path, vectors, quantity.time, quantity.name)])
    return checked_time(path, of_time, found, list(range(1, len(found) + 1)))


def _seconds(path: Path, of_time: Quantity, vectors: list[np.ndarray]) -> np.ndarray:
    if of_time.units[0] == ISO:
        raise BadInput(f"{path}: time: numbers are no dates; give unit as one of {', '.join(TIME)}")
    if len({len(each) for each in vectors}) > 1 or len(vectors[0]) < LEAST_SAMPLES:
        raise BadInput(f"{path}: time has {len(vectors[0])} samples; needs at least {LEAST_SAMPLES} in each column")
    parts = [each * TIME[unit] for each, unit in zip(vectors, of_time.units, strict=False)]
    found: np.ndarray = sum(parts[1:], parts[0]) * of_time.scales[0]
    if not np.isfinite(found).all():
        raise BadInput(f"{path}: time is not finite in places; remove those samples")
    return found


def _vector(path: Path, vectors: Mapping[str, np.ndarray], name: Column, quantity: str) -> np.ndarray:
    found = vectors.get(str(name))
    if found is None:
        some = ", ".join(list(vectors)[:20]) + (" …" if len(vectors) > 20 else "")
        raise BadInput(f"{path}: has no vector {shown(name)} (for {quantity}); correct the map "
                       f"({nearest_of(str(name), vectors, f'it has {some}')})")
    return found


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
    with recordings(path) as parts:
        return _source(path, columns, parts)


def _source(path: Path, columns: ColumnMap, parts: Sequence[Recording]) -> Source:
    wanted: dict[str, list[str]] = {}
    frames: list[Frames] = []
    places, is_geodetic = {}, False
    known = topics_in(path, parts)
    for quantity in columns.quantities.values():
        if quantity.name == "time" or (quantity.is_optional and not _is_there(quantity, known)):
            continue
        names = list(map(str, quantity.columns))
        if quantity.topic:
            names, kind = _of_topic(path, quantity.topic, known)
            is_geodetic = is_geodetic or kind == GEODETIC
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
    read = read_samples(path, parts, wanted, frames)
    topics, clock = _on_one_clock({**read.topics, **{_key(pair): each for pair, each in read.frames.items()}},
                                  columns.stamps)
    _check_fields(path, parts, columns, places, topics)
    return _joined(path, columns, places, topics, is_geodetic, (*columns.notes, *read.remarks, *clock))


def _key(pair: Frames) -> str:
    return " ".join((TF, *pair))


def _is_there(quantity: Quantity, known: Mapping[str, Topic]) -> bool:
    topics = [quantity.topic] if quantity.topic else [TF] if quantity.frames else [
        split_column(str(column))[0] for column in quantity.columns]
    return all(topic in known or f"/{topic}" in known for topic in topics)


def _of_topic(path: Path, topic: str, known: Mapping[str, Topic]) -> tuple[list[str], str]:
    """(the columns of a pose by the type of its messages, that type's own name)."""
    whole = topic_of(path, known, topic).type
    kind = own_name(whole)
    if kind not in POSES:
        raise BadInput(f"{path}: {topic} is of type {whole or 'unknown'}, in which no pose is known; give its fields "
                       f'as columns under [pose] in the map, such as "{topic}.pose.position.x"')
    return [f"{topic}.{field}" for field in POSES[kind]], kind


def _on_one_clock(topics: dict[str, Samples], stamps: str) -> tuple[dict[str, Samples], list[str]]:
    """All topics on the clock of their headers; on the recorder's where the map asks for it or headers disagree."""
    if stamps == "arrival":
        return _by_arrival(topics), []
    begin, end = (pick(edge(each.stamp_ns) for each in topics.values()) for pick, edge in (
        (max, np.min), (min, np.max)))
    if begin <= end:
        unstamped = [name for name, each in topics.items() if not each.has_stamps]
        if unstamped and len(unstamped) < len(topics):
            return topics, [f"{', '.join(unstamped)}: its messages have no time stamps, so the times of recording are "
                            "used; publish a type with a header if recording is late"]
        return topics, []
    by_arrival = _by_arrival(topics)
    begin, end = (pick(edge(each.stamp_ns) for each in by_arrival.values()) for pick, edge in (
        (max, np.min), (min, np.max)))
    if begin > end:
        return topics, []  # the rows will say that they share no time
    return by_arrival, ["the time stamps of the topics have no time in common, so the times of recording are used; "
                        "synchronise the clocks of the computers"]


def _by_arrival(topics: Mapping[str, Samples]) -> dict[str, Samples]:
    return {name: each.by_arrival() for name, each in topics.items()}


def _check_fields(path: Path, parts: Sequence[Recording], columns: ColumnMap, places: dict[str, Place],
                  topics: dict[str, Samples]) -> None:
    """BadInput for a field that no message has; joints may be in angles or in speeds."""
    blank: dict[str, tuple[str, bool]] = {}
    for name, place in places.items():
        for (topic, index), label in zip(place.columns, place.labels, strict=not place.frames):
            if np.isnan(topics[topic].values[:, index]).all():
                blank.setdefault(name, (label, index not in topics[topic].never))
    for name, (label, is_there) in blank.items():
        if columns.quantities[name].is_optional and any(other in places and other not in blank for other in PER_WHEEL):
            continue
        topic, field = split_column(label)
        if is_there:
            valid = "pose" if name == "pose" else "value"
            raise BadInput(f"{path}: {topic} holds no valid {valid}: {field} is NaN or a quaternion of length 0 in "
                           f"all {len(topics[topic].values)} messages; name another topic or field in the map, or "
                           "record it anew")
        joint = field.partition("[")[2].rstrip("]")
        known = all_topics(parts)  # none of a ULog, whose topics have no names of joints
        own = [topic_of(path, known, topic).name] if known else []
        message = next(iter(sample_messages(parts, own).values()), None)
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
    are_joints = leading in PER_WHEEL and not any(name.isdigit() or "." in name for name in names)
    return Source(path, time_s, raw, lambda row: f"the message of {main} at {time_s[row]:.6g} s", is_row,
                  lines=lambda rows: f"{len(rows)} messages of {main} are", remarks=tuple(filter(None, told)),
                  wheel_names=names if columns.is_guess and leading in PER_WHEEL else (), is_geodetic=is_geodetic,
                  column_names=names if are_joints and not columns.is_guess else (), tells_gaps=False)


def _age(samples: Samples, is_main: bool) -> str:
    """How often a topic comes and how old its messages are."""
    apart = np.diff(samples.stamp_ns) / 1e9
    age = (samples.arrival_ns - samples.stamp_ns) / 1e9
    if not len(apart):
        return f"{samples.topic}: 1 message"
    text = (f"{samples.topic}: {len(age)} messages, {np.median(apart):.3g} s apart in the median and "
            f"{apart.max():.3g} s at most; ")
    text += "each message is one row of the run" if is_main else (
        f"assigned to the rows by their {'time stamps' if samples.has_stamps else 'times of recording'}")
    if samples.has_stamps and np.abs(age).max() > OFTEN:
        text += f"; recorded {np.median(age):.3g} s after their stamps in the median, {age.max():.3g} s at most"
    return text
