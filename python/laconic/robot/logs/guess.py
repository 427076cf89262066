"""What a log probably holds, by the names and the values of its columns: a map to begin with, and what it lacks."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from laconic.robot.logs.for_vehicle import corner_of, words_of
from laconic.robot.logs.units import LATITUDE, LONGITUDE
from laconic.robot.logs.wraps import wrap_of
from laconic.scene.scene_text import value_text

FEWEST_WHEELS, MOST_WHEELS = 2, 8
HALF_TURN_DEG = 50.0
FEWEST_ROWS = 20  # in which nanoseconds are never all below a millisecond
STEPS = 20.0      # of a usual size in the range of a column that counts on
TIMES = ("t", "time", "timestamp", "stamp", "clock", "sec", "secs", "seconds")
TRUE = {"true", "truth", "gt", "mocap", "vicon", "optitrack", "tracker", "marker", "camera", "ground", "qualisys",
        "gps", "utm", "uwb", "beacon", "leica", "reference", "pose"}
UNTRUE = {"odom", "odometry", "est", "estimate", "estimated", "pred", "predicted", "set", "cmd", "command", "ref",
          "target", "goal", "filtered", "ekf"}
NOT_A_PLACE = {"vel", "velocity", "twist", "speed", "acc", "accel", "acceleration", "angular", "linear", "orientation",
               "covariance", "quaternion", "gyro", "mag", "imu", "force", "torque", "wheel", "setvel", "v", "w", "a",
               "pix", "pixel"}
HEADINGS = {"yaw", "theta", "heading", "psi", "phi", "th", "ang", "angle", "bearing"}
ASKED = {"set", "cmd", "command", "commanded", "ref", "reference", "target", "desired", "setpoint", "setvel", "goal"}
LENGTHS = {"m": "m", "mm": "mm", "cm": "cm", "meter": "m", "meters": "m"}
ANGLES = {"rad": "rad", "deg": "deg", "degree": "deg", "degrees": "deg", "radians": "rad", "turns": "turn"}
TICKS = {"tick", "ticks", "count", "counts", "enc", "encoder", "encoders", "pulse", "pulses", "counter", "qei"}
SPEEDS = {"vel", "velocity", "speed", "omega", "w", "rpm", "rate", "spd"}
ANGLES_OF_WHEELS = {"angle", "pos", "position", "rot", "rotation", "phi", "theta", "joint", "rad", "deg"}
OF_WHEELS = {"wheel", "wheels", "motor", "m", "drive", "axle"} | TICKS | SPEEDS | ANGLES_OF_WHEELS
OF_QUATERNIONS = {"orientation", "quaternion", "quat", "q", "rotation", "rot"}
NOT_A_HEADING = {"wheel", "wheels", "motor", "drive", "axle", "gyro", "rate", "steering", "steer", "delta", "joint"} | \
    TICKS | SPEEDS
OF_BODIES = {"nu", "zeta", "body", "hinge", "hinges"}   # velocities and angles that are not of wheels
STEERED = {"steer", "steering", "steered", "delta"}


@dataclass
class Guess:
    """A map as tables of TOML, what each column was taken for, and what is missing or uncertain."""

    entries: dict[str, Any] = field(default_factory=dict)
    meaning: dict[str, str] = field(default_factory=dict)
    missing: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    wheels: tuple[str, ...] = ()      # names of the wheels' columns or joints
    faults: list[str] = field(default_factory=list)  # of the file itself


def guess_table(columns: Mapping[str, np.ndarray], texts: Mapping[str, str]) -> Guess:
    """Of a table: columns of numbers (NaN: blank), and examples of those with text."""
    found = Guess()
    _time(found, columns, texts)
    left = {name: values for name, values in columns.items() if name not in found.meaning}
    _pose(found, left)
    left = {name: values for name, values in left.items() if name not in found.meaning}
    _yaw_rate(found, left)
    left = {name: values for name, values in left.items() if name not in found.meaning}
    _wheels(found, left)
    _steering(found, {name: values for name, values in left.items() if name not in found.meaning})
    return found


def _steering(found: Guess, columns: Mapping[str, np.ndarray]) -> None:
    """Angles of steered wheels, and the only wheel that drives beside them."""
    steered = [name for name in columns if STEERED & set(words_of(name))
               and not {"rate", "vel", "velocity", "speed", "current", "voltage"} & set(words_of(name))]
    sure = [name for name in steered if set(words_of(name)) & STEERED != {"delta"}]
    if not sure:
        if steered:
            found.notes.append(f"{', '.join(steered[:4])}: may be angles of steering; name them under "
                               "[steering_angle], for a scene with steered wheels")
        return
    words = set(words_of(sure[0]))
    largest = float(max(np.nanmax(np.abs(columns[name]), initial=0.0) for name in sure))
    unit = "tick" if words & TICKS else next((ANGLES[word] for word in words if word in ANGLES), "") or (
        "deg" if largest > HALF_TURN_DEG else "rad")
    _enter(found, columns, "steering_angle", unit, sure)
    entry = found.entries["steering_angle"]
    if words & ASKED:
        entry["kind"] = "command"
    if unit == "tick" and "wrap" not in entry and (wraps := [size for name in sure if (size := _begins_again(
            columns[name]))]):
        entry["wrap"] = max(wraps)
        found.notes.append(f"steering_angle: jumps across its whole range, so it probably begins again after "
                           f"{max(wraps)}; correct wrap if the encoder has another size")
    found.notes.append(f"{', '.join(sure)}: taken for angles of the scene's steered hinges in their order, to the left "
                       "above 0; hinges = [...] names them, offset and sign correct them")
    if {"wheel_angle", "wheel_speed"} & set(found.entries):
        return
    lone = [name for name in columns if name not in sure and not set(words_of(name)) & (ASKED | {"set", "torque"})
            and {"traction", "drive", "driven", "wheel", "motor"} & set(words_of(name))]
    for name in lone:
        quantity = _quantity([word for word in words_of(name) if word not in ("traction", "driven")],
                             [columns[name]])
        if quantity is not None and quantity[0] in ("wheel_angle", "wheel_speed"):
            _enter(found, columns, quantity[0], quantity[1], [name])
            found.missing = [each for each in found.missing if not each.startswith("wheels:")]
            return
    asked = [name for name in columns if set(words_of(name)) & ASKED and set(words_of(name)) & {"speed", "vel"}
             and not set(words_of(name)) & {"yaw", "angular", "left", "right"}]
    if len(asked) == 1:
        found.entries["speed"] = {"column": asked[0]}
        found.meaning[asked[0]] = "speed [m/s]"
        found.missing = [each for each in found.missing if not each.startswith("wheels:")]
        found.notes.append(f"speed: {asked[0]} is taken for the commanded speed of the fixed axle, in m/s")


def _begins_again(values: np.ndarray) -> int | None:
    """The size of an absolute encoder that jumps from its one end to the other."""
    there = values[~np.isnan(values)]
    if len(there) < 2 or there.min() < 0.0 or np.abs(np.diff(there)).max() < 0.5 * np.ptp(there) or there.max() < 64.0:
        return None
    return 1 << int(there.max()).bit_length()


def _time(found: Guess, columns: Mapping[str, np.ndarray], texts: Mapping[str, str]) -> None:
    """Seconds and nanoseconds, a date, or one column."""
    by_words = {name: words_of(name) for name in columns}
    for name, words in by_words.items():
        if words and words[-1] in ("nsec", "nanosec", "nsecs", "nanoseconds", "ns"):
            mate = next((other for other, others in by_words.items() if others[:-1] == words[:-1] and others
                         and others[-1] in ("sec", "secs", "seconds", "s")), None)
            if mate is not None:
                most = float(np.nanmax(np.abs(columns[name]), initial=0.0))
                unit = "us" if 1e3 <= most < 1e6 and len(columns[name]) > FEWEST_ROWS else "ns"
                found.entries["time"] = {"columns": [mate, name], "units": ["s", unit]}
                found.meaning |= {mate: "time [s]", name: f"time [{unit}]"}
                if unit != "ns":
                    found.notes.append(f"time: {name} is always less than 10^6, so it is taken for {unit}")
                return
    from laconic.robot.logs.sources import is_date

    dates = [name for name, text in texts.items() if is_date(text)]
    if dates:
        found.entries["time"] = {"column": dates[0], "unit": "iso"}
        found.meaning[dates[0]] = "time [iso]"
        return
    ranked = sorted((rank, index, name) for index, (name, values) in enumerate(columns.items())
                    if (rank := _rank_of_time(by_words[name], values)) is not None)
    if not ranked:
        found.missing.append("time: no column grows from line to line; name it under [time]")
        return
    name = ranked[0][2]
    unit, is_sure = _unit_of_time(by_words[name], columns[name])
    found.entries["time"] = {"column": name, "unit": unit}
    found.meaning[name] = f"time [{unit}]"
    if not is_sure:
        found.notes.append(f"time: {name} has no unit in its name, and its steps look like {unit}")


def _rank_of_time(words: Sequence[str], values: np.ndarray) -> int | None:
    """0 for a name that says time, 1 for a first column that grows; None for what cannot be time."""
    there = values[~np.isnan(values)]
    if len(there) < 2 or not (np.diff(there) > 0.0).all():
        return None
    return 0 if set(words) & set(TIMES) else 1


def _unit_of_time(words: Sequence[str], values: np.ndarray) -> tuple[str, bool]:
    for word in reversed(words):
        if word in ("s", "ms", "us", "ns", "min"):
            return word, True
        if word in ("sec", "secs", "seconds"):
            return "s", True
    size = float(np.nanmax(np.abs(values)))
    for unit, least in (("ns", 1e17), ("us", 1e14), ("ms", 1e11), ("s", 1e8)):
        if size > least:
            return unit, True
    step = float(np.nanmedian(np.diff(values[~np.isnan(values)])))
    is_whole = bool((values[~np.isnan(values)] % 1.0 == 0.0).all())
    return ("ns" if step >= 1e5 else "us" if step >= 2e3 else "ms") if is_whole and step >= 1.0 else "s", False


def _pose(found: Guess, columns: Mapping[str, np.ndarray]) -> None:
    """x and y of one place, with the heading that has the most of its name in common."""
    by_words = {name: words_of(name) for name in columns}
    pairs: list[tuple[int, int, str, str, list[str], str]] = []
    for name, words in by_words.items():
        stem, unit = _without_unit(words)
        if stem and stem[-1] in ("x", "lat", "latitude", "px", "posx", "xpos"):
            other = {"x": "y", "lat": "lon", "latitude": "longitude", "px": "py", "posx": "posy",
                     "xpos": "ypos"}[stem[-1]]
            mates = [mate for mate, its in by_words.items() if _without_unit(its)[0] in (
                [*stem[:-1], other], [*stem[:-1], "lng" if other == "lon" else other])]
            if mates and not set(stem[:-1]) & NOT_A_PLACE:
                score = len(set(stem) & TRUE) - 2 * len(set(stem) & UNTRUE)
                pairs.append((-score, len(pairs), name, mates[0], stem, unit))
    if not pairs:
        found.missing.append("pose: no columns x and y of a true place; without it only `replay --inputs voltages` and "
                             "a gyro judge a model")
        return
    score, _, x, y, stem, unit = min(pairs)
    if stem[-1].startswith("lat"):
        found.entries["pose"] = {"columns": [x, y], "units": [LATITUDE, LONGITUDE]}
        found.meaning |= {x: "pose latitude", y: "pose longitude"}
        return
    units = [unit or "m"] * 2
    if not unit:
        found.notes.append(f"pose: {x} and {y} have no unit in their names; m is taken")
    if score > 0:
        found.notes.append(f"pose: {x} and {y} may be the odometry itself, which is no truth to compare with")
    quaternion = _quaternion(by_words, stem)
    heading = _heading(columns, by_words, stem)
    found.meaning |= {x: f"pose x [{units[0]}]", y: f"pose y [{units[1]}]"}
    if quaternion:
        found.entries["pose"] = {"columns": [x, y, *quaternion], "units": units}
        found.meaning |= dict.fromkeys(quaternion, "pose quaternion")
    elif heading is not None:
        name, angle = heading
        found.entries["pose"] = {"columns": [x, y, name], "units": [*units, angle]}
        found.meaning[name] = f"pose heading [{angle}]"
    else:
        found.entries["pose"] = {"columns": [x, y], "units": units}
        found.notes.append("pose: no heading was found, so positions alone are compared")


def _without_unit(words: Sequence[str]) -> tuple[list[str], str]:
    """(the words without a unit of length at the end, that unit)."""
    if len(words) > 1 and words[-1] in LENGTHS:
        return list(words[:-1]), LENGTHS[words[-1]]
    return list(words), ""


def _common(one: Sequence[str], other: Sequence[str]) -> int:
    return len(set(one) & set(other))


def _quaternion(by_words: Mapping[str, Sequence[str]], stem: Sequence[str]) -> list[str]:
    """Four columns x, y, z, w of a quaternion, those whose names have the most in common with the place."""
    groups: dict[tuple[str, ...], dict[str, str]] = {}
    for name, words in by_words.items():
        last = words[-1] if words else ""
        if re.fullmatch(r"q[xyzw]", last):
            groups.setdefault((*words[:-1], "q"), {})[last[1]] = name
        elif last in ("x", "y", "z", "w") and OF_QUATERNIONS & set(words[:-1]):
            groups.setdefault(tuple(words[:-1]), {})[last] = name
    whole = [(-_common(key, stem), index, group) for index, (key, group) in enumerate(groups.items())
             if len(group) == 4]
    return [min(whole)[2][part] for part in "xyzw"] if whole else []


def _heading(columns: Mapping[str, np.ndarray], by_words: Mapping[str, Sequence[str]],
             stem: Sequence[str]) -> tuple[str, str] | None:
    """(column, unit)."""
    ranked = []
    for index, (name, words) in enumerate(by_words.items()):
        if HEADINGS & set(words) and not NOT_A_HEADING & set(words) and corner_of(name) == ("", ""):
            is_strong = bool(set(words) & {"yaw", "theta", "heading", "psi"})
            score = _common(words, stem) + 2 * is_strong + len(set(words) & TRUE) - 2 * len(set(words) & UNTRUE)
            ranked.append((-score, index, name))
    if not ranked:
        return None
    name = min(ranked)[2]
    unit = next((ANGLES[word] for word in reversed(by_words[name]) if word in ANGLES), "")
    size = float(np.nanmax(np.abs(columns[name]), initial=0.0))
    return name, unit or ("deg" if size > HALF_TURN_DEG else "rad")


def _yaw_rate(found: Guess, columns: Mapping[str, np.ndarray]) -> None:
    for name in columns:
        words = words_of(name)
        joined = " ".join(words)
        if re.search(r"\b(gyro z|gz|yaw rate|yawrate|angular velocity z|wz|gyroz)\b", joined) \
                and not set(words) & (ASKED | UNTRUE):
            unit = "deg/s" if {"deg", "dps"} & set(words) else "rad/s"
            found.entries["yaw_rate"] = {"column": name, "unit": unit}
            found.meaning[name] = f"yaw_rate [{unit}]"
            return


def _wheels(found: Guess, columns: Mapping[str, np.ndarray]) -> None:
    """Groups of columns whose names differ by a corner or a number alone."""
    groups: dict[tuple[str, ...], list[tuple[str, str]]] = {}
    for name in columns:
        if (key := _stem(name)) is not None:
            groups.setdefault(key[0], []).append((key[1], name))
    for stem, members in groups.items():
        names = [name for _, name in members]
        marks = [mark for mark, _ in members]
        if not FEWEST_WHEELS <= len(names) <= MOST_WHEELS or len(set(marks)) < len(marks):
            continue
        if marks[0].isdigit():
            names = [name for _, name in sorted(members, key=lambda each: int(each[0]))]
        quantity = _quantity(stem, [columns[name] for name in names])
        if quantity is None or quantity[0] in found.entries:
            continue
        _enter(found, columns, quantity[0], quantity[1], names)
    if not {"wheel_angle", "wheel_speed", "voltage"} & set(found.entries):
        found.missing.append("wheels: no group of columns looks like angles, ticks or speeds of wheels; name them "
                             "under [wheel_angle] or [wheel_speed]")


def _enter(found: Guess, columns: Mapping[str, np.ndarray], quantity: str, unit: str, names: list[str]) -> None:
    entry: dict[str, Any] = {"columns": names, "unit": unit}
    if unit in ("tick", "tick/s"):
        found.missing.append(f"{quantity}.ticks_per_turn: how many ticks are one turn of the encoder (and gear_ratio, "
                             "the turns of the encoder for one of the wheel, where it is not 1)")
    if unit in ("m", "m/s"):
        found.notes.append(f"{quantity}: metres become angles by the scene's radius; radius_m gives another one")
    if quantity in ("wheel_angle", "steering_angle"):
        values = [columns[name][~np.isnan(columns[name])] for name in names]
        wraps = [wrap for each in values if (wrap := wrap_of(each, unit)) is not None]
        if quantity == "wheel_angle" and unit == "tick" and not wraps and all(map(_are_increments, values)):
            entry["kind"] = "increments"
            found.notes.append(f"{quantity}: the columns look like ticks since the row before; take kind out if they "
                               "are counters")
        elif wraps:
            entry["wrap"] = int(max(wraps)) if max(wraps) % 1.0 == 0.0 else max(wraps)
            most = max(float(np.ptp(each)) for each in values)
            found.notes.append(f"{quantity}: the columns begin again, probably after {max(wraps):.9g}, as they span "
                               f"{most:.9g}; correct wrap if the counter has another size")
    found.entries[quantity] = entry
    found.meaning |= dict.fromkeys(names, f"{quantity} [{unit}]")
    if quantity != "steering_angle":
        found.wheels = found.wheels or tuple(names)


def _stem(name: str) -> tuple[tuple[str, ...], str] | None:
    """(the words that a wheel's column has in common with those of others, its corner or number)."""
    words = words_of(name)
    corner = "".join(corner_of(name))
    if corner:
        rest = [word for word in words if word not in ("front", "rear", "back", "left", "right", "fl", "fr", "rl", "rr",
                                                       "bl", "br", "lf", "rf", "lr", "lb", "rb", "l", "r")]
        return tuple(rest), corner
    numbers = [word for word in words if word.isdigit()]
    common = tuple(word for word in words if not word.isdigit())
    return (common, numbers[0]) if len(numbers) == 1 and common else None


def _quantity(stem: Sequence[str], values: Sequence[np.ndarray]) -> tuple[str, str] | None:
    """(quantity, unit) of a group of columns; None where it is none."""
    words = set(stem)
    text = " ".join(stem)
    if words & (STEERED | OF_BODIES) or words & {"covariance", "orientation", "acc", "accel", "mag", "range", "ranges"}:
        return None
    if words & {"current", "currents", "cur", "amps", "ampere", "ma"}:
        return "current", "mA" if "ma" in words else "A"
    if words & {"voltage", "volt", "volts", "mv"}:
        return "voltage", "mV" if "mv" in words else "V"
    is_asked = bool(words & ASKED)
    if "rpm" in words:
        return ("set_speed" if is_asked else "wheel_speed"), "rpm"
    is_speed = bool(words & SPEEDS) or "per s" in text or is_asked or any("vel" in word for word in words)
    if words & TICKS:
        return ("wheel_speed", "tick/s") if is_speed else ("wheel_angle", "tick")
    if is_speed:
        unit = "m/s" if re.search(r"\b(m per s|mps|m s)\b", text) else "deg/s" if "deg" in words else "rad/s"
        return ("set_speed" if is_asked else "wheel_speed"), unit
    if words & {"dist", "distance", "travel", "travelled", "odo"}:
        return "wheel_angle", next((LENGTHS[word] for word in words if word in LENGTHS), "m")
    if words & ANGLES_OF_WHEELS:
        is_whole = not words & set(ANGLES) and _are_whole(values)
        return "wheel_angle", "tick" if is_whole else next((ANGLES[word] for word in stem if word in ANGLES), "rad")
    if not words or words & OF_WHEELS:
        return "wheel_angle", "tick" if _are_whole(values) else "rad"
    return None


def _are_whole(values: Sequence[np.ndarray]) -> bool:
    return all(bool((each[~np.isnan(each)] % 1.0 == 0.0).all()) for each in values) and any(
        float(np.nanmax(np.abs(each), initial=0.0)) > 1.0 for each in values)


def _are_increments(values: np.ndarray) -> bool:
    """Whether a column is far more likely to hold differences: it goes to and fro about the size of its steps."""
    steps = np.abs(np.diff(values))
    moving = steps[steps > 0.0]
    return bool(len(moving)) and float(np.ptp(values)) < STEPS * float(np.median(moving)) and len(values) > 2 * STEPS


def toml_text(guess: Guess, name: str) -> str:
    """The map as a file, with what is missing as comments."""
    lines = [f"name = {value_text(name)}"]
    lines += [f"{key} = {value_text(value)}" for key, value in guess.entries.items() if not isinstance(value, dict)]
    for key, table in guess.entries.items():
        if isinstance(table, dict):
            lines += ["", f"[{key}]", *(f"{inner} = {value_text(value)}" for inner, value in table.items())]
            lines += ["# ticks_per_turn =     # missing: ticks for one turn of the encoder" for each in guess.missing
                      if each.startswith(f"{key}.ticks_per_turn")]
    lines += ["", *(f"# missing: {each}" for each in guess.missing if ".ticks_per_turn" not in each),
              *(f"# {each}" for each in guess.notes)]
    return "\n".join(lines).rstrip() + "\n"
