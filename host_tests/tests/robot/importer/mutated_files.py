"""Robots' files with something broken, by a seed: an attribute gone, a number that is none, a tag for another."""

from __future__ import annotations

import random
import re
from collections.abc import Callable

from made_up_robots import FOUR_WHEELS, MJCF, SDF, TWO_WHEELS, inertial, joint, link, robot, wheel

NUMBERS = ("", "nan", "inf", "-1", "0", "1e400", "0_1", "ten", "1 2", "0x10", "1e-320", "-0", "3.14", "${x}", "1,5")
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


def mutated(seed: int) -> tuple[str, str]:
    """The name and the text of a file with one to three things broken."""
    chance = random.Random(seed)
    name, text = ROBOTS[seed % len(ROBOTS)]
    for _ in range(chance.randint(1, 3)):
        text = chance.choice((without_attribute, with_number, with_tag, without_element, twice))(text, chance)
    return name, text


def without_attribute(text: str, chance: random.Random) -> str:
    """An attribute gone."""
    return _replaced(text, r'\s[\w:]+="[^"]*"', lambda _: "", chance)


def with_number(text: str, chance: random.Random) -> str:
    """Another number in an attribute or an element."""
    return _replaced(text, r"(?<=[\">\s])-?\d[\d.e+-]*(?=[\"<\s])", lambda _: chance.choice(NUMBERS), chance)


def with_tag(text: str, chance: random.Random) -> str:
    """The name of an element taken for another."""
    tags = sorted(set(re.findall(r"<(\w[\w:]*)", text)))
    one, other = chance.choice(tags), chance.choice(tags)
    return _replaced(text, rf"<{one}\b[^>]*/>|<{one}\b[^>]*>.*?</{one}>",
                     lambda found: re.sub(rf"(</?){one}\b", rf"\1{other}", found), chance)


def without_element(text: str, chance: random.Random) -> str:
    """An element gone."""
    return _replaced(text, r"<(\w[\w:]*)\b[^>]*/>|<(\w[\w:]*)\b[^>]*>[^<]*</\2>", lambda _: "", chance)


def twice(text: str, chance: random.Random) -> str:
    """An element that stands twice."""
    return _replaced(text, r"<(\w[\w:]*)\b[^>]*/>|<(\w[\w:]*)\b[^>]*>[^<]*</\2>", lambda found: found + found, chance)


def _replaced(text: str, pattern: str, change: Callable[[str], str], chance: random.Random) -> str:
    places = list(re.finditer(pattern, text, re.DOTALL))
    if not places:
        return text
    place = chance.choice(places)
    return text[: place.start()] + change(place[0]) + text[place.end():]
