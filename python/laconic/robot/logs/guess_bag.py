"""Which topics of a recording are wheels, pose and gyro, by their types and names."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from laconic.errors import BadInput
from laconic.robot.bags.messages import Topic, parts_of_message
from laconic.robot.bags.samples import TF, all_topics, is_ulog, recordings, sample_messages
from laconic.robot.logs.bag_source import POSES, own_name
from laconic.robot.logs.column_map import ColumnMap, map_of
from laconic.robot.logs.for_vehicle import corner_of
from laconic.robot.logs.guess import TRUE, UNTRUE, Guess, words_of
from laconic.scene.table import Table

BEST = ("Odometry", "PoseStamped", "PoseWithCovarianceStamped", "PoseInFrame", "TransformStamped", "Pose2D", "Pose",
        "Transform", "NavSatFix", "PointStamped", "Point", "Vector3Stamped")
NEVER = {"goal", "initialpose", "initial", "target", "plan", "cmd", "command"}
VOLTAGES = "/wheel_voltages"     # of `laconic simulate --bag`
OF_WHEELS = {"wheel", "wheels", "drive", "motor"}


def topics_in(path: Path) -> dict[str, Topic]:
    """All topics by name; of a ULog with the number of their samples."""
    if is_ulog(path):
        from laconic.robot.bags.samples import topics_of_ulog

        return {name: Topic(name, "", len(each.data["timestamp"]), lambda: bytes)
                for name, each in sorted(topics_of_ulog(path).items())}
    with recordings(path) as parts:
        return all_topics(parts)


def guess_bag(path: Path) -> Guess:
    """The usual topics, and what is missing."""
    topics = topics_in(path)
    found = Guess({"format": "bag"})
    if is_ulog(path):
        return _of_ulog(found, topics)
    _joints(found, path, topics)
    _pose(found, topics)
    _imu(found, topics)
    if VOLTAGES in topics and found.wheels:
        found.entries["voltage"] = {"columns": [f"{VOLTAGES}.data[{index}]" for index in range(len(found.wheels))],
                                    "optional": True}
        found.meaning[VOLTAGES] = "voltage [V]"
    return found


def map_of_bag(path: Path) -> ColumnMap:
    """The map that is guessed where nobody gave one; BadInput says what the recording lacks."""
    guess = guess_bag(path)
    wheels = {"joints", "wheel_angle", "wheel_speed"} & set(guess.entries)
    if not wheels:
        what = guess.missing[0] if guess.missing else "no topic of a usual type"
        raise BadInput(f"{path}: {what}; give its map with --map (`laconic logs {path.name}` shows its topics)")
    found = map_of(Table(path, "", guess.entries))
    quantities = {name: replace(each, wheels=(), is_optional=each.is_optional or name == "yaw_rate")
                  for name, each in found.quantities.items()}
    return replace(found, name="bag", quantities=quantities, is_guess=True, notes=tuple(guess.notes))


def _joints(found: Guess, path: Path, topics: Mapping[str, Topic]) -> None:
    """The JointState with the most joints that are wheels by their names."""
    names = [name for name, topic in topics.items() if own_name(topic.type) == "JointState" and topic.count != 0]
    ranked: list[tuple[int, int, str, tuple[str, ...], Any]] = []
    for index, (topic, message) in enumerate(sample_messages(path, names).items()):
        joints = [str(each) for each in (message.get("name", []) if isinstance(message, dict) else message.name)]
        wheels = [each for each in joints if OF_WHEELS & set(words_of(each))] or [
            each for each in joints if corner_of(each) != ("", "")] or joints
        score = sum(bool(OF_WHEELS & set(words_of(each))) for each in wheels) + len(wheels)
        ranked.append((-score, index, topic, tuple(wheels), message))
    if not ranked or not min(ranked, key=lambda each: each[:2])[3]:
        found.missing.append("wheels: has no topic of type JointState with names of joints")
        _other_wheels(found, path, topics)
        return
    _, _, topic, found.wheels, message = min(ranked, key=lambda each: each[:2])
    found.entries |= {"joints": topic, "wheels": list(found.wheels)}
    found.meaning[topic] = f"wheels {', '.join(found.wheels)}"
    values = list(message["position"] if isinstance(message, dict) else message.position)
    if values and all(float(value) % 1.0 == 0.0 for value in values) and any(abs(value) > 50.0 for value in values):
        found.notes.append(f"joints: the positions of {topic} are whole numbers, which looks like ticks; give them as "
                           f'columns under [wheel_angle], such as "{topic}.position[{found.wheels[0]}]", with unit = '
                           '"tick" and ticks_per_turn')


def _other_wheels(found: Guess, path: Path, topics: Mapping[str, Topic]) -> None:
    """Topics that may hold wheels in a form of their own."""
    names = [name for name in topics if {"wheel", "wheels", "encoder", "encoders", "ticks", "motor", "motors"} & set(
        words_of(name))][:4]
    for name, message in sample_messages(path, names).items():
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
