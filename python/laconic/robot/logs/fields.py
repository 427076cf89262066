"""The fields of one topic over a whole recording: how many values, the first, the smallest and the largest, the unit
that they probably have."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from laconic.base.progress import progress_bar
from laconic.errors import BadInput, nearest_of
from laconic.robot.bags.messages import is_bag, parts_of_message
from laconic.robot.bags.samples import AT_ONCE, all_topics, is_ulog, recordings, topic_of, topics_of_ulog
from laconic.robot.logs.for_vehicle import words_of

HEAD = ("field", "values", "first", "smallest", "largest", "probable unit")
TICKS_FROM = 50.0      # whole numbers beyond it are no angles of wheels in rad
LONGEST_TEXT = 24
MOST_OF_LIST = 12
UNITS = [(re.compile(pattern), unit) for pattern, unit in (
    (r"covariance|frame_id|seq$|status", ""),
    (r"\.n(ano)?secs?$", "ns"), (r"\.secs?$", "s"), (r"^ulog .*timestamp", "us"),
    (r"(orientation|rotation|quaternion|\bq)(\.[xyzw]|\[[0-3]\])$", "quaternion"),
    (r"^JointState (position)", "rad"), (r"^JointState (velocity)", "rad/s"), (r"^JointState (effort)", "N·m"),
    (r"^Wrench.*force", "N"), (r"^Wrench.*torque", "N·m"),
    (r"linear_acceleration|^Accel.*linear|accelerometer", "m/s²"), (r"^Accel.*angular", "rad/s²"),
    (r"angular_velocity|gyro|(^Twist|twist).*angular|^ulog .*angular_velocity.*xyz", "rad/s"),
    (r"(^Twist|twist).*linear", "m/s"),
    (r"^Pose2D .*theta$|steering_angle$", "rad"), (r"steering_angle_velocity$", "rad/s"),
    (r"^Ackermann.*speed$", "m/s"), (r"^Ackermann.*acceleration$", "m/s²"), (r"^Ackermann.*jerk$", "m/s³"),
    (r"latitude|longitude|_deg\b", "deg"), (r"altitude", "m"),
    (r"voltage|\bvolts?\b", "V"), (r"current|\bamp", "A"), (r"temperature", "°C"), (r"fluid_pressure", "Pa"),
    (r"^BatteryState (charge|.*capacity)", "Ah"), (r"^MagneticField", "T"),
    (r"^(LaserScan|Range) .*(ranges?|_range)\b", "m"), (r"^LaserScan .*angle", "rad"), (r"^LaserScan .*time", "s"),
    (r"^ulog .*\.v[xyz]$", "m/s"), (r"heading$|yaw$", "rad"),
    (r"\b(position|translation|point|pose|origin)(\.|\[)[xyz012]|^(Point|Pose2D|ulog .*) ?\.?[xyz]$", "m"))]
"""By a message's own type and the path of the field, the first that fits."""
BY_WORDS = {"rpm": "rpm", "rad": "rad", "deg": "deg", "m": "m", "mm": "mm", "cm": "cm", "ms": "ms", "ns": "ns",
            "us": "us", "tick": "tick", "ticks": "tick", "count": "tick", "counts": "tick", "percent": "%"}
PER_SECOND = re.compile(r"_per_s$|_s_?1$")


@dataclass
class Field:
    """One number, or text, of all messages of a topic."""

    name: str
    first: Any
    count: int = 0
    smallest: float | None = None
    largest: float | None = None
    is_whole: bool = True

    def take(self, value: Any) -> None:
        """The value of one message; a text and NaN have no size."""
        self.count += 1
        if isinstance(value, str) or math.isnan(value):
            return
        self.is_whole = self.is_whole and value % 1 == 0
        self.smallest = value if self.smallest is None else min(self.smallest, value)
        self.largest = value if self.largest is None else max(self.largest, value)

    def unit(self, topic: str, kind: str) -> str:
        """What its name, the type of its messages and its values suggest; nothing where they suggest nothing."""
        if isinstance(self.first, (str, bool)):
            return ""
        asked = (f"{kind} {self.name}", f"{kind} {topic}.{self.name}")
        found = next((unit for text in asked for pattern, unit in UNITS if pattern.search(text)), None)
        if found is None:
            words = words_of(self.name.rpartition(".")[2])
            found = next((BY_WORDS[word] for word in reversed(words) if word in BY_WORDS), "")
            found += "/s" if found and PER_SECOND.search(self.name) else ""
        most = max(abs(self.smallest or 0.0), abs(self.largest or 0.0))
        return "tick" if found == "rad" and self.is_whole and most > TICKS_FROM else found

    def row(self, topic: str, kind: str) -> tuple[str, ...]:
        """For people."""
        return (f"{topic}.{self.name}", str(self.count), *map(_text, (self.first, self.smallest, self.largest)),
                self.unit(topic, kind))


@dataclass(frozen=True)
class Fields:
    """All fields of one topic."""

    path: Path
    topic: str
    type: str
    messages: int
    fields: list[Field]
    remarks: list[str]

    @property
    def _kind(self) -> str:
        return self.type.rpartition("/")[2]

    @property
    def notes(self) -> list[str]:
        """What is left out."""
        lists = Counter(each.name.partition("[")[0] for each in self.fields if "[" in each.name)
        is_cut = max(lists.values(), default=0) >= MOST_OF_LIST
        return [*self.remarks, *([f"at most the first {MOST_OF_LIST} values of a list are shown"] if is_cut else [])]

    def lines(self) -> list[str]:
        """For people."""
        table = [HEAD, *(field.row(self.topic, self._kind) for field in self.fields)]
        widths = [max(len(row[index]) for row in table) for index in range(len(HEAD))]
        of_type = "" if self.type == "ulog" else f" ({self.type})"
        return [f"{self.path}: {self.topic}{of_type}, {self.messages} messages", "",
                *("  ".join(f"{cell:{width}}" for cell, width in zip(row, widths, strict=True)).rstrip()
                  for row in table), *(f"note: {each}" for each in self.notes)]

    def as_json(self) -> dict[str, Any]:
        """For JSON."""
        return {"log": str(self.path), "topic": self.topic, "type": self.type, "messages": self.messages,
                "fields": [{"field": f"{self.topic}.{each.name}", "values": each.count, "first": _plain(each.first),
                            "smallest": _plain(each.smallest), "largest": _plain(each.largest),
                            "unit": each.unit(self.topic, self._kind)} for each in self.fields], "notes": self.notes}


def fields_of(path: Path, topic: str) -> Fields:
    """Reads all messages of a topic; BadInput where the log has no topics, not this one, or none that can be read."""
    if not is_bag(path):
        raise BadInput(f"--fields {topic}: {path} has no topics; leave it out")
    return _of_ulog(path, topic) if is_ulog(path) else _of_recording(path, topic)


def _of_ulog(path: Path, topic: str) -> Fields:
    sets = topics_of_ulog(path)
    if topic not in sets:
        raise BadInput(f"{path}: has no topic {topic}; {nearest_of(topic, sets)}")
    found = []
    for name, values in sets[topic].data.items():
        field = Field(name, values[0].item())
        for value in values.tolist():
            field.take(value)
        found.append(field)
    return Fields(path, topic, "ulog", max((each.count for each in found), default=0), found, [])


def _of_recording(path: Path, topic: str) -> Fields:
    found: dict[str, Field] = {}
    count, broken = 0, 0
    with recordings(path) as parts:
        there = topic_of(path, all_topics(parts), topic)
        decode = there.decoder()  # says why it cannot be decoded
        with progress_bar(f"reading {path.name}", there.count or 0) as advance:
            for part in parts:
                for _, _, data in part.messages({there.name}):
                    count += 1
                    if count % AT_ONCE == 0:
                        advance(AT_ONCE)
                    try:
                        message = decode(data)
                    except Exception:  # bytes that are no such message fail in many ways
                        broken += 1
                        continue
                    for name, value in _by_name(message):
                        found.setdefault(name, Field(name, value)).take(value)
        remarks = [remark for part in parts for remark in part.remarks]
    if count == broken:
        raise BadInput(f"{path}: {there.name} has no message that can be decoded; choose another topic")
    if broken:
        remarks.append(f"{broken} of {count} messages cannot be decoded and are left out")
    return Fields(path, there.name, there.type, count - broken, list(found.values()), remarks)


def _by_name(message: Any) -> Iterator[tuple[str, Any]]:
    """The fields of a message; those of lists that go with its names, such as JointState's, by name: the order may
    change from message to message."""
    names = message.get("name") if isinstance(message, dict) else getattr(message, "name", None)
    known = [str(each) for each in names] if isinstance(names, (list, tuple)) else []
    for field, value in parts_of_message(message):
        part = re.fullmatch(r"(\w+)\[(\d+)\]", field)
        if not known or part is None or int(part[2]) >= len(known):
            yield field, value
        elif part[1] != "name":
            yield f"{part[1]}[{known[int(part[2])]}]", value


def _text(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, float):
        return f"{value:.6g}"
    return str(value) if not isinstance(value, str) else value[:LONGEST_TEXT]


def _plain(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value
