"""Robots' files with something broken: each gives a scene with wheels that runs, or one line, within 20 seconds.

    python host_tests/assurance/run.py imports --files 200
    python host_tests/assurance/run.py imports --first 2000 --files 1000 --folder my_robots

The seed of a file is its number. The folder has further robots; each file of it is broken in turn with the small ones.
"""

from __future__ import annotations

import argparse
import random
import re
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "support"))
from laconic.errors import BadInput, Refused
from laconic.robot.importer import Answers, import_robot
from laconic.scene import read_scene
from laconic.simulation import simulate
from made_up_robots import FOUR_WHEELS, MJCF, SDF, TWO_WHEELS, inertial, joint, link, robot, wheel

LONGEST_S = 20.0
OF_PYTHON = re.compile(r"object has no|Traceback|NoneType|invalid literal|could not convert|out of range|unpack|"
                       r"subscriptable|\b[A-Z]\w+Error\b|unexpected [A-Z]|recursion")
ENDINGS = (".urdf", ".xacro", ".sdf", ".xml", ".world", ".mjcf")
NUMBERS = ("", "nan", "inf", "-1", "0", "1e308", "1e400", "0_1", "ten", "1 2", "0x10", "1e-320", "-0", "3.14", "${x}",
           "1,5")
UNITS = (1000.0, 0.001, 57.29577951308232, 0.017453292519943295)
NUMBER = r"(?<=[\">\s])-?\d[\d.e+-]*(?=[\"<\s])"
ELEMENT = r"<(\w[\w:]*)\b[^>]*/>|<(\w[\w:]*)\b[^>]*>[^<]*</\2>"
STEERED = robot(TWO_WHEELS, link("fork", inertial(0.1, (1e-4,) * 3)),
                joint("steer", "revolute", "base", "fork", "0.2 0 0", axis="0 0 1",
                      more='<limit lower="-1" upper="1" effort="1" velocity="1"/>'),
                wheel("front", "fork", "0 0 -0.05"),
                '<transmission name="t"><joint name="steer"/><mechanicalReduction>7</mechanicalReduction>'
                "</transmission>"
                '<gazebo reference="left_link"><mu1>1</mu1><mu2>0</mu2><fdir1>1 1 0</fdir1></gazebo>'
                '<ros2_control name="c" type="system"><joint name="left"><command_interface name="velocity"/></joint>'
                "</ros2_control>")
XACRO = ('<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:property name="half" value="0.2"/>'
         '<xacro:macro name="base" params="kg:=5">' + link("base", inertial(5.0, (0.1, 0.1, 0.08))).replace(
             'value="5.0"', 'value="${kg}"') + '</xacro:macro><xacro:base/><xacro:if value="true">'
         + wheel("left", "base", "0 ${half} -0.05") + "</xacro:if>" + wheel("right", "base", "0 ${-half} -0.05")
         + "</robot>")
SURFACE = ("<surface><friction><ode><mu>1</mu><mu2>0</mu2><fdir1>1 1 0</fdir1></ode></friction></surface></collision>"
           "</link>")
ROBOTS = (("robot.urdf", robot(FOUR_WHEELS)), ("robot.urdf", STEERED), ("robot.sdf", SDF.replace(
    "</collision></link>", SURFACE)), ("robot.xml", MJCF), ("robot.xacro", XACRO))

Robots = Sequence[tuple[str, str]]
"""Name and text of each file."""


def broken(seed: int, robots: Robots = ROBOTS) -> tuple[str, str]:
    """The name and the text of a file with one to three things broken."""
    chance = random.Random(seed)
    name, text = robots[seed % len(robots)]
    for _ in range(chance.randint(1, 3)):
        text = chance.choice(KINDS)(text, chance)
    return name, text


def without_attribute(text: str, chance: random.Random) -> str:
    """An attribute gone."""
    return _replaced(text, r'\s[\w:]+="[^"]*"', lambda _: "", chance)


def with_attribute(text: str, chance: random.Random) -> str:
    """An attribute by another name."""
    return _replaced(text, r'(?<=\s)[\w:]+(?=="[^"]*")', lambda found: found[:-1], chance)


def with_number(text: str, chance: random.Random) -> str:
    """Another number in an attribute or an element."""
    return _replaced(text, NUMBER, lambda _: chance.choice(NUMBERS), chance)


def in_another_unit(text: str, chance: random.Random) -> str:
    """Every number of one element or attribute in another unit: millimetres, degrees."""
    def scaled(found: str) -> str:
        factor = chance.choice(UNITS)
        return re.sub(NUMBER, lambda each: f"{float(each[0]) * factor:.9g}" if _is_number(each[0]) else each[0], found)

    return _replaced(text, r'"[^"<>]*\d[^"<>]*"|>[^<>]*\d[^<>]*<', scaled, chance)


def with_tag(text: str, chance: random.Random) -> str:
    """The name of an element taken for another."""
    tags = sorted(set(re.findall(r"<(\w[\w:]*)", text)))
    one, other = chance.choice(tags), chance.choice(tags)
    return _replaced(text, rf"<{one}\b[^>]*/>|<{one}\b[^>]*>.*?</{one}>",
                     lambda found: re.sub(rf"(</?){one}\b", rf"\1{other}", found), chance)


def without_element(text: str, chance: random.Random) -> str:
    """An element gone."""
    return _replaced(text, ELEMENT, lambda _: "", chance)


def twice(text: str, chance: random.Random) -> str:
    """An element that stands twice."""
    return _replaced(text, ELEMENT, lambda found: found + found, chance)


def cut_off(text: str, chance: random.Random) -> str:
    """The end gone; seldom, since little is left to judge."""
    return text[: chance.randrange(len(text))] if text and chance.random() < 0.3 else text


KINDS = (without_attribute, with_attribute, with_number, with_number, in_another_unit, with_tag, without_element, twice,
         cut_off)


def _is_number(text: str) -> bool:
    return re.fullmatch(r"-?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?", text) is not None


def _replaced(text: str, pattern: str, change: Callable[[str], str], chance: random.Random) -> str:
    places = list(re.finditer(pattern, text, re.DOTALL))
    if not places:
        return text
    place = chance.choice(places)
    return text[: place.start()] + change(place[0]) + text[place.end():]


def outcome(path: Path) -> tuple[str, str]:
    """What became of a file, and its words: "scene", "refused" or a fault."""
    began = time.perf_counter()
    try:
        found = import_robot(path, Answers(rollers={"": "none"}, friction_coefficient=0.5))
        if not found.wheels:
            return "no wheel", ""
        kind, words = "scene", ""
        scene_path = path.with_suffix(".toml")
        scene_path.write_text(found.text, encoding="utf-8")
        simulate(read_scene(scene_path))
    except BadInput as refused:
        kind, words = "refused", str(refused)
        if not words.startswith(("--", f"{path}: ")) or "\n" in words or OF_PYTHON.search(words):
            kind = "not one line of ours"
    except Refused as refused:  # by a step of the scene, such as for numbers beyond the range
        kind, words = "scene", str(refused)
    except Exception as error:  # the fault that is looked for
        kind, words = "traceback", f"{type(error).__name__}: {error}"
    took_s = time.perf_counter() - began
    return ("too long", f"{took_s:.0f} s") if took_s > LONGEST_S else (kind, words)


def campaign(numbers: range, robots: Robots, folder: Path, tell: Callable[[str], None] = print) -> Counter[str]:
    """How the files of these numbers ended; every fault is told with its number."""
    ends: Counter[str] = Counter()
    for number in numbers:
        name, text = broken(number, robots)
        (folder / name).write_text(text, encoding="utf-8")
        end, words = outcome(folder / name)
        ends[end] += 1
        if end not in ("scene", "refused"):
            tell(f"file {number} ({name}): {end}: {words[:300]}")
    return ends


def robots_in(folder: Path) -> list[tuple[str, str]]:
    """The robots' files of a folder."""
    paths = sorted(path for path in folder.rglob("*") if path.suffix in ENDINGS and path.is_file())
    return [(path.name, path.read_text(encoding="utf-8", errors="replace")) for path in paths]


def arguments(parser: argparse.ArgumentParser) -> None:
    """The options."""
    parser.add_argument("--files", type=int, default=200)
    parser.add_argument("--first", type=int, default=0, help="number of the first file")
    parser.add_argument("--folder", type=Path, help="with further robots")


def run(given: argparse.Namespace) -> bool:
    """Prints how many files ended how; whether none has a fault."""
    robots = [*ROBOTS, *(robots_in(given.folder) if given.folder else ())]
    with tempfile.TemporaryDirectory() as folder:
        ends = campaign(range(given.first, given.first + given.files), robots, Path(folder))
    print(", ".join(f"{end}: {count}" for end, count in ends.most_common()))
    return set(ends) <= {"scene", "refused"}
