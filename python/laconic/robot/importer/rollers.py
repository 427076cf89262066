"""The kind of each wheel: by the rollers that the file has, else by what the user says.

A wheel without rollers in the file is plain only if all such wheels could roll together; else the file leaves
something out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from laconic.errors import BadInput
from laconic.robot.importer.answers import Answers, answer
from laconic.robot.importer.axle_lines import lines_of, nearly_meet
from laconic.robot.importer.placement import rotation_about
from laconic.robot.importer.surfaces import grips_along
from laconic.robot.importer.wheel_shape import ROLLERS_AT_LEAST
from laconic.robot.importer.wheels import FoundWheel
from laconic.scene.axle_lines import WITHIN_RAD, common_line, grouped, meeting_point, misses_by

SAME_RAD = np.radians(2.0)
FLAT = 0.5  # of a direction's length in the ground's plane, at least, for one of rollers
MECANUM = {45.0, -45.0}


@dataclass(frozen=True)
class Kind:
    """As a scene has it, with the reason."""

    kind: str
    roller_deg: float | None
    why: str
    is_told: bool = True


def kinds_of(where: str, wheels: Sequence[FoundWheel], answers: Answers) -> list[Kind]:
    """One for each wheel; BadInput asks where nothing tells."""
    found = [_said(wheel, wheels, answers) or _seen(where, wheel) or _by_friction(wheel) for wheel in wheels]
    plain = [wheel for wheel, kind in zip(wheels, found, strict=True) if kind is None]
    doubt = hindered(plain) if plain and len(plain) == len(wheels) else ""
    if doubt:
        names = ", ".join(wheel.name for wheel in plain)
        raise BadInput(f"{where}: the axles of {names} {doubt}")
    return [kind or Kind("fixed", None, "assumption: a plain wheel, as the file shows no rollers", False)
            for kind in found]


def hindered(wheels: Sequence[FoundWheel]) -> str:
    """Why such wheels, were they plain, would not drive the robot, and what to say instead; empty where they would."""
    if miss := _miss(wheels):
        return (f"do not meet in one point ({miss}), and the file shows no rollers; give --rollers omni, --rollers "
                "mecanum, --rollers JOINT=DEGREES, or --rollers none with --friction for wheels that skid")
    if are_around_their_axles_point(wheels):
        return ("meet in one point between the wheels, so plain ones could turn the robot on the spot alone, and the "
                "file shows no rollers; give --rollers omni, --rollers JOINT=DEGREES, or --rollers none")
    return ""


def _miss(wheels: Sequence[FoundWheel]) -> str:
    """Which axle keeps plain wheels from turning the robot without slip, and by how much; empty where all are one line
    or meet in one point."""
    lines = lines_of(wheels)
    if common_line(lines):
        return ""
    point = meeting_point(lines)
    if point is None:
        (one, line), *others = ((group[0], line) for group, line in grouped(lines))
        other, offset = max(((index, line.offset_of(each.point)) for index, each in others), key=lambda each: each[1])
        return f"that of {wheels[other].name} lies {offset:.3g} m beside that of {wheels[one].name}, parallel to it"
    if nearly_meet(lines, point):
        return ""
    worst, distance = misses_by(lines, point)
    return f"that of {wheels[worst].name} passes the nearest such point at {distance:.3g} m"


def are_around_their_axles_point(wheels: Sequence[FoundWheel]) -> bool:
    """Whether the axle lines meet in one point with wheels on all sides of it, as those of omni wheels do."""
    lines = lines_of(wheels)
    if len(wheels) < 3 or common_line(lines) or (point := meeting_point(lines)) is None:
        return False
    off = np.array([line.point - point for line in lines])
    angles = np.sort(np.arctan2(off[:, 1], off[:, 0]))
    return bool(np.diff([*angles, angles[0] + 2.0 * np.pi]).max() < np.pi - WITHIN_RAD)


def _said(wheel: FoundWheel, wheels: Sequence[FoundWheel], answers: Answers) -> Kind | None:
    said = answer(answers.rollers, wheel.name)
    if said is None:
        return None
    why = "said with --rollers"
    if said == "none":
        return Kind("fixed", None, why)
    if said == "omni":
        return Kind("omni", None, why)
    if said == "mecanum":
        return Kind("mecanum", _crossed(wheel, wheels), why + ", an X seen from above")
    return _kind_of(np.radians(float(said)), why)


def _crossed(wheel: FoundWheel, wheels: Sequence[FoundWheel]) -> float:
    """The roller angle of the usual four: the rollers that touch the ground lie as the sides of a diamond around the
    robot's middle, so those on top, which are seen from above, form an X."""
    centre = np.mean([each.hub_m[:2] for each in wheels], axis=0)
    x, y = wheel.hub_m[:2] - centre
    if len(wheels) != 4 or abs(wheel.axle[0]) > 0.01 or min(abs(x), abs(y)) < 1e-3:
        raise BadInput("--rollers mecanum: is for four wheels at the corners with axles across; give --rollers "
                       "JOINT=DEGREES for "
                       "each wheel, the angle from its axle to the roller that touches the ground")
    roller = -np.pi / 4.0 if x * y > 0.0 else np.pi / 4.0
    return _within(np.degrees(roller - wheel.axle_rad))


def _seen(where: str, wheel: FoundWheel) -> Kind | None:
    """By the rollers of the file, each turned to where it touches the ground."""
    if len(wheel.rollers) < ROLLERS_AT_LEAST:
        return None
    angles = []
    for roller in wheel.rollers:
        off = roller.point_m - wheel.hub_m
        off = off - wheel.axle * (off @ wheel.axle)
        if np.linalg.norm(off) < 1e-6:
            raise BadInput(f"{where}: a roller of {wheel.name} lies on its axle; give --rollers {wheel.name}=DEGREES")
        down, side = -off[2], off @ np.cross(wheel.axle, [0.0, 0.0, -1.0])
        axis = rotation_about(wheel.axle, -np.arctan2(side, down)) @ roller.axis
        angles.append(2.0 * (np.arctan2(axis[1], axis[0]) - wheel.axle_rad))  # twice: an axis has no sense
    mean = np.angle(np.mean(np.exp(1j * np.array(angles)))) / 2.0
    spread = np.abs(np.angle(np.exp(1j * (np.array(angles) - 2.0 * mean)))).max() / 2.0
    if spread > SAME_RAD:
        raise BadInput(f"{where}: rollers of {wheel.name} differ in angle by {np.degrees(spread):.0f}°; give --rollers "
                       f"{wheel.name}=DEGREES")
    return _kind_of(mean, f"by the {len(wheel.rollers)} rollers of the file")


def _by_friction(wheel: FoundWheel) -> Kind | None:
    """A surface that grips in one direction alone is that of rollers which lie in it."""
    surface = wheel.surface
    if surface is None or surface.direction is None or (is_along := grips_along(surface)) is None:
        return None
    flat = surface.direction[:2]
    if np.linalg.norm(flat) < FLAT:
        return None
    roller = np.arctan2(flat[1], flat[0]) + (0.0 if is_along else np.pi / 2.0)
    degrees = _within(float(np.degrees(roller - wheel.axle_rad)))
    if abs(degrees) < np.degrees(SAME_RAD):
        return None  # such a wheel would push nothing
    degrees = next((each for each in MECANUM if abs(degrees - each) <= np.degrees(WITHIN_RAD)), degrees)
    return _kind_of(np.radians(degrees), "by the direction without friction that the file gives (fdir1)")


def _kind_of(roller_rad: float, why: str) -> Kind:
    degrees = _within(np.degrees(roller_rad))
    if abs(abs(degrees) - 90.0) < np.degrees(SAME_RAD):
        return Kind("omni", None, why)
    return Kind("mecanum", degrees, why)


def _within(degrees: float) -> float:
    """In (−90, 90], because an axis has no sense."""
    return float(90.0 - (90.0 - degrees) % 180.0)
