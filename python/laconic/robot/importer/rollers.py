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
from laconic.robot.importer.placement import Array, rotation_about
from laconic.robot.importer.wheel_parts import ROLLERS_AT_LEAST
from laconic.robot.importer.wheels import FoundWheel

SAME_RAD = np.radians(2.0)
MEETS_M = 1e-3
MEETS_RAD = np.radians(0.1)


@dataclass(frozen=True)
class Kind:
    """As a scene has it, with the reason."""

    kind: str
    roller_deg: float | None
    why: str
    is_told: bool = True


def kinds_of(where: str, wheels: Sequence[FoundWheel], answers: Answers) -> list[Kind]:
    """One for each wheel; BadInput asks where nothing tells."""
    found = [_said(wheel, wheels, answers) or _seen(where, wheel) for wheel in wheels]
    plain = [wheel for wheel, kind in zip(wheels, found, strict=True) if kind is None]
    doubt = hindered(plain) if len(plain) == len(wheels) else ""
    if doubt:
        names = ", ".join(wheel.name for wheel in plain)
        raise BadInput(f"{where}: the axles of {names} {doubt}")
    return [kind or Kind("fixed", None, "assumption: a plain wheel, as the file shows no rollers", False)
            for kind in found]


def hindered(wheels: Sequence[FoundWheel]) -> str:
    """Why such wheels, were they plain, would not drive the robot, and what to say instead; empty where they would."""
    if not roll_together(wheels):
        return ("do not meet in one point, and the file shows no rollers; give --rollers omni, --rollers mecanum, "
                "--rollers JOINT=DEGREES, or --rollers none with --friction for wheels that skid")
    if are_around_their_axles_point(wheels):
        return ("meet in one point between the wheels, so plain ones could turn the robot on the spot alone, and the "
                "file shows no rollers; give --rollers omni, --rollers JOINT=DEGREES, or --rollers none")
    return ""


def are_around_their_axles_point(wheels: Sequence[FoundWheel]) -> bool:
    """Whether the axle lines meet in one point with wheels on all sides of it, as those of omni wheels do."""
    if len(wheels) < 3 or (point := _meeting(wheels)) is None:
        return False
    off = np.array([w.hub_m[:2] - point for w in wheels])
    angles = np.sort(np.arctan2(off[:, 1], off[:, 0]))
    return bool(np.diff([*angles, angles[0] + 2.0 * np.pi]).max() < np.pi - MEETS_RAD)


def roll_together(wheels: Sequence[FoundWheel]) -> bool:
    """Whether plain wheels can turn the robot without slip: their axle lines are one, or meet in one point."""
    normal, point = _lines(wheels)[0]
    if _are_parallel(wheels):
        return all(abs(normal @ (p - point)) < MEETS_M for _, p in _lines(wheels))
    return _meeting(wheels) is not None


def _lines(wheels: Sequence[FoundWheel]) -> list[tuple[Array, Array]]:
    """The normal and a point of each axle's line, seen from above."""
    return [(np.array([-w.axle[1], w.axle[0]]), w.hub_m[:2]) for w in wheels]


def _are_parallel(wheels: Sequence[FoundWheel]) -> bool:
    normal, _ = _lines(wheels)[0]
    return all(abs(normal @ n) > np.cos(MEETS_RAD) for n, _ in _lines(wheels))


def _meeting(wheels: Sequence[FoundWheel]) -> Array | None:
    """The one point in which all axle lines meet; None where they do not, or are parallel."""
    if _are_parallel(wheels):
        return None
    lines = _lines(wheels)
    rows = np.array([n for n, _ in lines])
    right = np.array([n @ p for n, p in lines])
    meeting, *_ = np.linalg.lstsq(rows, right, rcond=None)
    return meeting if np.abs(rows @ meeting - right).max() < MEETS_M else None


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


def _kind_of(roller_rad: float, why: str) -> Kind:
    degrees = _within(np.degrees(roller_rad))
    if abs(abs(degrees) - 90.0) < np.degrees(SAME_RAD):
        return Kind("omni", None, why)
    return Kind("mecanum", degrees, why)


def _within(degrees: float) -> float:
    """In (−90, 90], because an axis has no sense."""
    return float(90.0 - (90.0 - degrees) % 180.0)
