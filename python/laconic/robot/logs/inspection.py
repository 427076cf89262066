"""What is in a log, of whatever kind: its columns or topics, what they are taken for, and the map that says so."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from laconic.errors import BadInput
from laconic.robot.bags.messages import GIVE, Recording, Topic, is_bag, parts_of_message
from laconic.robot.bags.samples import (
    TF,
    is_ulog,
    recordings,
    sample_messages,
    topics_in,
)
from laconic.robot.logs.column_map import ColumnMap, map_of
from laconic.robot.logs.for_vehicle import corner_of, places_by_name, words_of
from laconic.robot.logs.formats.bag_source import POSES, own_name, read_mat
from laconic.robot.logs.formats.text_table import number_of, rows_of, text_of
from laconic.robot.logs.guess import STEERED, TRUE, UNTRUE, Guess, guess_table, toml_text
from laconic.robot.logs.recognise import OF_CAN, known_guess
from laconic.scene.table import Table

BEST = ("Odometry", "PoseStamped", "PoseWithCovarianceStamped", "PoseInFrame", "TransformStamped", "Pose2D", "Pose",
        "Transform", "NavSatFix", "PointStamped", "Point", "Vector3Stamped")
NEVER = {"goal", "initialpose", "initial", "target", "plan", "cmd", "command"}
VOLTAGES = "/wheel_voltages"     # of `laconic simulate --bag`
OF_HINGES = "_hinge_joint"       # behind the name of a hinge, as ROS 2 and bags have it
OF_WHEELS = {"wheel", "wheels", "drive", "motor"}


def guess_bag(path: Path) -> tuple[Guess, dict[str, Topic]]:
    """(the usual topics, and what is missing; all topics)."""
    found = Guess({"format": "bag"})
    with recordings(path) as parts:
        topics = topics_in(path, parts)
        remarks = [remark for part in parts for remark in part.remarks]
        if not topics:
            raise BadInput("; ".join([f"{path}: holds no topic", *remarks, GIVE]))
        if is_ulog(path):
            return _of_ulog(found, topics), topics
        _joints(found, parts, topics)
        found.faults += dict.fromkeys([*remarks, *(remark for part in parts for remark in part.remarks)])
    _pose(found, topics)
    _imu(found, topics)
    if VOLTAGES in topics and found.wheels:
        found.entries["voltage"] = {"columns": [f"{VOLTAGES}.data[{index}]" for index in range(len(found.wheels))],
                                    "optional": True}
        found.meaning[VOLTAGES] = "voltage [V]"
    return found, topics


def map_of_bag(path: Path) -> ColumnMap:
    """The map that is guessed where nobody gave one; BadInput says what the recording lacks."""
    guess, _ = guess_bag(path)
    wheels = {"joints", "wheel_angle", "wheel_speed"} & set(guess.entries)
    if not wheels:
        what = guess.missing[0] if guess.missing else "no topic of a usual type"
        raise BadInput(f"{path}: {what}; give its map with --map (`laconic logs {path.name}` shows its topics)")
    found = map_of(Table(path, "", guess.entries))
    quantities = {name: replace(each, wheels=(), is_optional=each.is_optional or name == "yaw_rate")
                  for name, each in found.quantities.items()}
    return replace(found, name="bag", quantities=quantities, is_guess=True, notes=tuple(guess.notes))


def _joints(found: Guess, parts: Sequence[Recording], topics: Mapping[str, Topic]) -> None:
    """The JointState with the most joints that are wheels by their names."""
    names = [name for name, topic in topics.items() if own_name(topic.type) == "JointState" and topic.count != 0]
    ranked: list[tuple[int, int, str, tuple[str, ...], Any]] = []
    for index, (topic, message) in enumerate(sample_messages(parts, names).items()):
        joints = [str(each) for each in (message.get("name", []) if isinstance(message, dict) else message.name)]
        turning = [each for each in joints if not each.endswith(OF_HINGES) and not STEERED & set(words_of(each))]
        wheels = [each for each in turning if OF_WHEELS & set(words_of(each))] or [
            each for each in turning if corner_of(each) != ("", "")] or turning
        score = sum(bool(OF_WHEELS & set(words_of(each))) for each in wheels) + len(wheels)
        ranked.append((-score, index, topic, tuple(wheels), message))
    if not ranked or not min(ranked, key=lambda each: each[:2])[3]:
        found.missing.append("wheels: has no topic of type JointState with names of joints")
        _other_wheels(found, parts, topics)
        return
    _, _, topic, found.wheels, message = min(ranked, key=lambda each: each[:2])
    found.entries |= {"joints": topic, "wheels": list(found.wheels)}
    found.meaning[topic] = f"wheels {', '.join(found.wheels)}"
    _hinges(found, topic, [str(each) for each in (message["name"] if isinstance(message, dict) else message.name)])
    values = list(message["position"] if isinstance(message, dict) else message.position)
    if values and all(float(value) % 1.0 == 0.0 for value in values) and any(abs(value) > 50.0 for value in values):
        found.notes.append(f"joints: the positions of {topic} are whole numbers, which looks like ticks; give them as "
                           f'columns under [wheel_angle], such as "{topic}.position[{found.wheels[0]}]", with unit = '
                           '"tick" and ticks_per_turn')


def _hinges(found: Guess, topic: str, joints: Sequence[str]) -> None:
    """Angles of the scene's hinges by their names, as its own bags have them; else joints that steer."""
    named = [each for each in joints if each.endswith(OF_HINGES)]
    steering = named or [each for each in joints if STEERED & set(words_of(each)) and each not in found.wheels]
    if not steering:
        return
    entry: dict[str, Any] = {"columns": [f"{topic}.position[{each}]" for each in steering], "optional": True}
    if named:
        entry["hinges"] = [each.removesuffix(OF_HINGES) for each in named]
    found.entries["steering_angle"] = entry
    found.meaning[topic] += f"; steering {', '.join(steering)}"


def _other_wheels(found: Guess, parts: Sequence[Recording], topics: Mapping[str, Topic]) -> None:
    """Topics that may hold wheels in a form of their own."""
    names = [name for name in topics if {"wheel", "wheels", "encoder", "encoders", "ticks", "motor", "motors"} & set(
        words_of(name))][:4]
    for name, message in sample_messages(parts, names).items():
        fields = [field for field, value in parts_of_message(message) if isinstance(value, (int, float))
                  and not field.startswith("header")][:3]
        if fields:
            listed = ", ".join(f"{name}.{each}" for each in fields)
            found.notes.append(f"{name} may hold wheels: its fields are {listed}; give them as columns under "
                               "[wheel_angle] or [wheel_speed]")


def _pose(found: Guess, topics: Mapping[str, Topic]) -> None:
    ranked = []
    for index, (name, topic) in enumerate(topics.items()):
        kind, words = own_name(topic.type), set(words_of(name))
        if kind in POSES and topic.count != 0 and not words & NEVER and topic.name != TF:
            score = 3 * len(words & TRUE) - 3 * len(words & UNTRUE)
            ranked.append((-score, BEST.index(kind), index, name))
    if not ranked:
        found.missing.append("pose: has no topic of a type with poses (Odometry, PoseStamped, NavSatFix …)"
                             + ('; frames of /tf are given as frames = ["map", "base_link"] under [pose]'
                                if TF in topics else ""))
        return
    score, _, _, name = min(ranked)
    found.entries["pose"] = name
    found.meaning[name] = "pose"
    if score > 0:
        found.notes.append(f"pose: {name} may be the odometry itself, which is no truth to compare with; name the true "
                           "pose with pose in a map")


def _imu(found: Guess, topics: Mapping[str, Topic]) -> None:
    names = [name for name, topic in topics.items() if own_name(topic.type) == "Imu" and topic.count != 0]
    if names:
        found.entries["imu"] = names[0]
        found.meaning[names[0]] = "yaw_rate"


def _of_ulog(found: Guess, topics: Mapping[str, Topic]) -> Guess:
    """A rover of PX4: its own estimate or GPS as pose, and no wheels that have one name in all versions."""
    if "wheel_encoders" in topics:
        found.entries["wheel_angle"] = {"columns": ["wheel_encoders.wheel_angle[0]", "wheel_encoders.wheel_angle[1]"],
                                        "unit": "rad"}
        found.meaning["wheel_encoders"] = "wheel_angle [rad]"
    else:
        found.missing.append("wheels: has no topic wheel_encoders; name the columns of the wheels under [wheel_angle] "
                             "or [wheel_speed]")
    for name, columns, units in (
            ("vehicle_visual_odometry", ("position[0]", "position[1]", "q[1]", "q[2]", "q[3]", "q[0]"), ["m", "m"]),
            ("vehicle_gps_position", ("latitude_deg", "longitude_deg"), ["latitude", "longitude"]),
            ("vehicle_local_position", ("x", "y", "heading"), ["m", "m", "rad"])):
        if name in topics:
            found.entries["pose"] = {"columns": [f"{name}.{each}" for each in columns], "units": units}
            found.meaning[name] = "pose"
            if units[0] == "m":
                found.entries["pose"]["signs"] = [1, -1, -1]
                found.notes.append("pose: PX4's axes are north, east, down; the signs turn them into x, y and a "
                                   "heading to the left")
            break
    if "vehicle_angular_velocity" in topics:
        found.entries["yaw_rate"] = {"column": "vehicle_angular_velocity.xyz[2]", "sign": -1}
        found.meaning["vehicle_angular_velocity"] = "yaw_rate"
    return found


SEPARATORS = (",", ";", "\t", "|", " ")
LOOKED_AT = 40         # lines, for the form of a text
MOST_ROWS = 50_000     # whose values are looked at
MOST_HEADER_LINES = 30
UNITS = {"s", "ms", "us", "ns", "m", "mm", "cm", "m/s", "rad", "deg", "rad/s", "deg/s", "rpm", "A", "mA", "V", "mV",
         "tick", "ticks", "pix", "pixel", "1", "-", "count", "counts"}


@dataclass(frozen=True)
class Inspection:
    """Rows of a table that shows the log, and the guess."""

    path: Path
    kind: str
    head: tuple[str, ...]
    rows: Sequence[tuple[str, ...]]
    guess: Guess

    def map_text(self) -> str:
        """The guessed map as a file."""
        return toml_text(self.guess, self.path.name.partition(".")[0] or self.path.name)

    def lines(self, out: Path | None) -> list[str]:
        """For people."""
        table: list[tuple[str, ...]] = [self.head, *self.rows]
        widths = [max(len(row[index]) for row in table) for index in range(len(self.head))]
        lines = [f"{self.path}: {self.kind}", ""]
        lines += ["  ".join(f"{cell:{width}}" for cell, width in zip(row, widths, strict=True)).rstrip()
                  for row in table]
        for title, given in (("missing", self.guess.missing), ("note", self.guess.notes)):
            lines += ["", *(f"{title}: {each}" for each in given)] if given else []
        lines += ["", f"wrote {out}" if out is not None else "the map to begin with (-o MAP.toml writes it):"]
        shown = [] if out is not None else ["", *(f"    {each}".rstrip() for each in self.map_text().splitlines())]
        return [*lines, *shown]

    def as_json(self) -> dict[str, Any]:
        """For JSON."""
        return {"log": str(self.path), "kind": self.kind,
                "columns": [dict(zip(self.head, row, strict=True)) for row in self.rows], "map": self.guess.entries,
                "missing": self.guess.missing, "notes": self.guess.notes}


def inspect(path: Path, wheels: Sequence[Mapping[str, Any]] | None = None) -> Inspection:
    """Looks at a log; `wheels`: those of the scene, so that names become places."""
    if is_bag(path):
        found = _of_bag(path)
    elif path.is_dir():
        raise BadInput(f"{path}: is a folder and no recording; give one of its logs")
    elif path.suffix.lower() == ".mat":
        found = _of_mat(path)
    elif path.name.lower().endswith(OF_CAN):
        found = _of_can(path)
    else:
        found = _of_text(path)
    if wheels is not None:
        _assign(found.guess, wheels)
    return found


def _assign(guess: Guess, wheels: Sequence[Mapping[str, Any]]) -> None:
    """The wheels of the scene by their names, written into the map."""
    if not guess.wheels:
        return
    if len(guess.wheels) == sum(wheel.get("driven", True) for wheel in wheels) == 1:
        return  # the only driven wheel
    places = places_by_name(guess.wheels, wheels)
    if places is None:
        guess.notes.append(f"the names {', '.join(guess.wheels)} do not say which of the scene's {len(wheels)} wheels "
                           "they are; give wheels in the map")
        return
    if "joints" in guess.entries:
        if len(places) == len(wheels):
            guess.entries["wheels"] = [guess.wheels[places.index(index)] for index in range(len(wheels))]
        return
    for table in guess.entries.values():
        if isinstance(table, dict) and len(table.get("columns", ())) == len(places) and "unit" in table:
            table["wheels"] = [place + 1 for place in places]


def _of_bag(path: Path) -> Inspection:
    guess, topics = guess_bag(path)
    guess.notes += guess.faults
    rows = [(topic.name, topic.type or "–", "–" if topic.count is None else str(topic.count),
             guess.meaning.get(topic.name, "")) for topic in topics.values()]
    return Inspection(path, "a recording of topics", ("topic", "type", "messages", "taken for"), rows, guess)


def _of_mat(path: Path) -> Inspection:
    vectors = read_mat(path)
    length = Counter(map(len, vectors.values())).most_common(1)[0][0]
    guess = guess_table({name: each for name, each in vectors.items() if len(each) == length}, {})
    guess.entries = {"format": "mat", **guess.entries}
    if len({len(each) for each in vectors.values()}) > 1:
        guess.notes.append(f"vectors of another length than {length} are not looked at; a quantity with instants "
                           'of its own has time = "NAME"')
    return Inspection(path, "a MATLAB file", COLUMNS, _rows(vectors, {}, guess), guess)


COLUMNS = ("column", "values", "from", "to", "taken for")


def _rows(columns: Mapping[str, np.ndarray], texts: Mapping[str, str], guess: Guess) -> list[tuple[str, ...]]:
    rows: list[tuple[str, ...]] = []
    for name, values in columns.items():
        there = values[~np.isnan(values)]
        ends = (f"{there.min():.6g}", f"{there.max():.6g}") if len(there) else ("", "")
        rows.append((name, str(len(there)), *ends, guess.meaning.get(name, "")))
    return rows + [(name, "text", text[:24], "", guess.meaning.get(name, "")) for name, text in texts.items()]


def _of_can(path: Path) -> Inspection:
    """Frames by their identifiers; what is in them is in a DBC."""
    from laconic.robot.logs.formats.can_frames import read_frames

    count = Counter(f"0x{frame.arbitration_id:X}" for frame in read_frames(path).frames)
    guess = Guess({"format": "can"}, missing=["dbc: the DBC file that names the signals; then columns are "
                                              "MESSAGE.signal"])
    rows = [(name, str(number), "") for name, number in sorted(count.items(), key=lambda each: int(each[0], 16))]
    return Inspection(path, "a log of CAN frames", ("identifier", "frames", "taken for"), rows, guess)


def _of_text(path: Path) -> Inspection:
    """A text: its separator, its lines of names, its columns."""
    text = text_of(path)
    lines = [line for line in text.lines[:LOOKED_AT + MOST_HEADER_LINES] if line.strip()]
    if not lines:
        raise BadInput(f"{path}: is empty, so it has no samples; give a recorded run")
    separator, decimal = _separator(lines)
    rows = [row for _, row in rows_of(path, text, separator)][:MOST_ROWS]
    rows = [row for row in rows if any(cell.strip() for cell in row)]
    head = next((index for index, row in enumerate(rows[:MOST_HEADER_LINES]) if _is_data(row, decimal)), None)
    if head is None:
        raise BadInput(f"{path}: has no line of numbers among its first {MOST_HEADER_LINES}; give a recorded run "
                       "as CSV")
    width = max(len(row) for row in rows[head:])
    names_line = next((index + 1 for index in range(head - 1, -1, -1) if len(rows[index]) >= len(rows[head]) - 1), 0)
    names = [name.strip() for name in rows[names_line - 1]] if names_line else []
    titles = [names[index] if index < len(names) and names[index] and names.count(names[index]) == 1 else str(index + 1)
              for index in range(width)]
    columns, texts = _columns(rows[head:], titles, decimal)
    if (known := known_guess(path, titles)) is not None:
        return Inspection(path, _kind(len(rows) - head, separator), COLUMNS, _rows(columns, texts, known), known)
    labels = _with_units(titles, rows[:head], width)
    guess = guess_table({labels[name]: values for name, values in columns.items()}, texts)
    plain = {label: name for name, label in labels.items()}
    guess.meaning = {plain.get(label, label): what for label, what in guess.meaning.items()}
    guess.wheels = tuple(plain.get(label, label) for label in guess.wheels)
    form = {key: value for key, value, usual in (("separator", separator, ","), ("decimal", decimal, "."),
                                                 ("header_lines", head, 1), ("names_line", names_line, min(1, head)))
            if value != usual}
    guess.entries = form | {key: _by_number(table, names, plain) for key, table in guess.entries.items()}
    words = Counter(row[0].strip() for row in rows[head:])
    if len(words) <= 20 and all(re.fullmatch(r"[A-Za-z_]\w*", word) for word in words) and len(words) > 1:
        guess.notes.append(f"the first column holds words ({', '.join(list(words)[:5])}): keyword_column = 1, and rows "
                           "under each quantity says whose lines are its own")
    return Inspection(path, _kind(len(rows) - head, separator), COLUMNS, _rows(columns, texts, guess), guess)


def _kind(count: int, separator: str) -> str:
    return f"text, {count} lines, separated by {separator!r}"


def _with_units(titles: Sequence[str], head: Sequence[Sequence[str]], width: int) -> dict[str, str]:
    """Each column's name with its unit, where a line of the head has units."""
    units = next((row for row in head if sum(cell.strip(" []()") in UNITS for cell in row) * 2 > len(row)), None)
    cells = [cell.strip(" []()") for cell in units] if units else []
    return {title: f"{title} {cells[index]}" if index < len(cells) and cells[index] not in ("", title) else title
            for index, title in enumerate(titles[:width])}


def _by_number(table: dict[str, Any], names: Sequence[str], plain: Mapping[str, str]) -> dict[str, Any]:
    """Columns by their own names, and those without one by their number."""
    def one(label: str) -> str | int:
        name = plain.get(label, label)
        return name if name in names else int(name)

    return {key: [one(each) for each in value] if key == "columns" else one(value) if key == "column" else value
            for key, value in table.items()}


def _separator(lines: Sequence[str]) -> tuple[str, str]:
    """The sign that divides most lines into the same number of cells, and the sign before decimals."""
    def score(sign: str) -> tuple[int, int]:
        counts = Counter(line.count(sign) for line in lines if sign in line)
        number, often = counts.most_common(1)[0] if counts else (0, 0)
        return (often if number else 0, number)

    found = max(SEPARATORS, key=lambda sign: (score(sign)[0], score(sign)[1] if sign != " " else 0))
    found = found if score(found)[0] else ","
    decimals = sum(bool(re.search(r"\d,\d", line)) for line in lines)
    return found, "," if found != "," and decimals > len(lines) // 2 else "."


def _is_data(row: Sequence[str], decimal: str) -> bool:
    cells = [cell.strip() for cell in row if cell.strip()]
    return sum(_number(cell, decimal) is not None for cell in cells) * 2 >= len(cells) and any(
        _number(cell, decimal) is not None for cell in cells)


def _number(text: str, decimal: str) -> float | None:
    try:
        return number_of(text.strip(), decimal)
    except ValueError:
        return None


def _columns(rows: Sequence[Sequence[str]], titles: Sequence[str],
             decimal: str) -> tuple[dict[str, np.ndarray], dict[str, str]]:
    """(columns of numbers, an example of each that is text)."""
    columns, texts = {}, {}
    for index, title in enumerate(titles):
        cells = [row[index].strip() if index < len(row) else "" for row in rows]
        filled = [cell for cell in cells if cell]
        numbers = [_number(cell, decimal) for cell in filled[:LOOKED_AT]]
        if filled and sum(number is None for number in numbers) > len(numbers) // 2:
            texts[title] = filled[0]
        else:
            values = [_number(cell, decimal) for cell in cells]
            columns[title] = np.array([np.nan if value is None else value for value in values])
    return columns, texts
