"""What is part of a wheel, and what only hangs on it: its rollers, else joints that move on their own."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from laconic.robot.importer.robot_tree import FIXED, HINGE, Joint, Link, Robot

ROLLERS_AT_LEAST = 3
SAME_AXLE = np.cos(np.radians(1.0))
ON_THE_AXLE_M = 1e-3


@dataclass(frozen=True, eq=False)
class Parts:
    """`shaped` are the links whose shapes are the wheel's, `turning` those whose inertia turns with it."""

    shaped: list[Link]
    turning: list[Link]
    rollers: tuple[Joint, ...] = ()
    remarks: tuple[str, ...] = ()


def parts_of(robot: Robot, wheel: Joint, wheels: Collection[Joint]) -> Parts:
    """All that hangs on a wheel with rollers is part of it. On one without, another joint is a wheel of its own, or
    turns about the same axle and so takes no part in its motion, or is held, so that its links turn with the wheel."""
    rollers = tuple(rollers_of(robot, wheel))
    if len(rollers) >= ROLLERS_AT_LEAST:
        everything = robot.below(wheel, rigid=False)
        return Parts(everything, everything, rollers)
    own = robot.below(wheel, rigid=True)
    turning, remarks = list(own), []
    for joint in _hanging_on(robot, own):
        if joint in wheels:
            remarks.append(f"wheel {joint.name} hangs on wheel {wheel.name}; each turns on its own, from the base")
        elif has_the_axle_of(joint, wheel):
            remarks.append(f"joint {joint.name} turns about the axle of {wheel.name}, on which it hangs, so it is no "
                           "part of it and no wheel; --wheel JOINT for each wheel would say otherwise")
        else:
            remarks.append(f"joint {joint.name} on wheel {wheel.name} is held in its zero position; what hangs on it "
                           "counts for the wheel's inertia, and not for its shape")
            turning += robot.below(joint, rigid=False)
    of_others = {link.name for other in wheels if wheel in robot.chain(other)
                 for link in robot.below(other, rigid=False)}
    return Parts(own, [link for link in turning if link.name not in of_others], rollers, tuple(remarks))


def rollers_of(robot: Robot, joint: Joint) -> list[Joint]:
    """The hinges on the parts of a wheel."""
    parts = {link.name for link in robot.below(joint, rigid=False)}
    return [each for each in robot.joints.values() if each.parent in parts and each.kind == HINGE]


def has_the_axle_of(joint: Joint, wheel: Joint) -> bool:
    """A hinge on the line about which the wheel turns."""
    off = joint.point_m - wheel.point_m
    return (joint.kind == HINGE and abs(joint.axis @ wheel.axis) > SAME_AXLE
            and float(np.linalg.norm(off - wheel.axis * (off @ wheel.axis))) < ON_THE_AXLE_M)


def _hanging_on(robot: Robot, links: list[Link]) -> list[Joint]:
    """The joints on these links that move."""
    return [joint for link in links for joint in robot.joints_of.get(link.name, ()) if joint.kind != FIXED]
