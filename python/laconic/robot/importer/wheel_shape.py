"""The radius of a wheel by its shapes, and how far they lie off the axle.

What is part of a wheel, and what only hangs on it: its rollers, else joints that move on their own.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from laconic.robot.importer.placement import Array
from laconic.robot.importer.robot_tree import FIXED, HINGE, Joint, Link, Robot, Shape

CENTRED_M = 1e-6  # a circle so near the axle is about it
TOLD_OFF_M, TOLD_OFF = 1e-3, 0.01  # off the axle, in metres or of the radius: more than rounding
ARM = 0.5  # of the radius: what lies so far off its axle is no wheel, but something that swings
LEAST_M = 1e-6
INSIDE = 1.0 + 1e-10


@dataclass(frozen=True)
class Reach:
    """The smallest circle around the shapes of a joint, seen along its axle."""

    radius_m: float
    off_m: float = 0.0  # its middle from the axle

    @property
    def is_off(self) -> bool:
        """By more than rounding."""
        return self.off_m > min(TOLD_OFF_M, TOLD_OFF * self.radius_m)

    @property
    def swings(self) -> bool:
        """As an arm does."""
        return self.off_m > ARM * self.radius_m


def chosen_shapes(links: Sequence[Link]) -> list[Shape]:
    """The shapes that collide, or else are seen; those that are seen, too, of a link whose colliding mesh is not
    there."""
    every = [shape for link in links for shape in link.shapes]
    chosen = [s for link in links for s in link.shapes if s.collides or link.unread_collides]
    return chosen or every


def lacks_shapes(links: Sequence[Link]) -> bool:
    """Whether a mesh that decides on the radius could not be had."""
    if any(link.unread_collides and not link.shapes for link in links):
        return True
    return not any(link.shapes for link in links) and any(link.unread for link in links)


def reach_of(robot: Robot, joint: Joint) -> Reach | None:
    """Of what is fixed to its child; None where no shape tells."""
    links = robot.below(joint, rigid=True)
    shapes = chosen_shapes(links)
    if lacks_shapes(links) or not shapes:
        return None
    radius = max(shape.radius_about(joint.point_m, joint.axis) for shape in shapes)
    if radius <= LEAST_M:
        return None
    centre, own = enclosing_circle(np.vstack([s.across(joint.point_m, joint.axis) for s in shapes]))
    off = float(np.linalg.norm(centre))
    return Reach(radius) if off <= CENTRED_M else Reach(own, off)


def skew_of(robot: Robot, joint: Joint) -> float:
    """The angle of the only shape, a cylinder, to the axle; 0 where there is another shape."""
    shapes = chosen_shapes(robot.below(joint, rigid=True))
    if len(shapes) != 1 or shapes[0].kind != "cylinder":
        return 0.0
    return float(np.arccos(min(1.0, abs(shapes[0].placed[:3, 2] @ joint.axis))))


def enclosing_circle(points: Array) -> tuple[Array, float]:
    """Middle and radius of the smallest circle around N × 2 points: that of a few of them, to which the farthest point
    outside is added until none is."""
    few = [points[int(np.argmax(points @ direction))] for direction in
           np.array([[1, 0], [-1, 0], [0, 1], [0, -1], [1, 1], [1, -1], [-1, 1], [-1, -1]], float)]
    while True:
        centre, radius = _of_few(few)
        away = np.linalg.norm(points - centre, axis=1)
        farthest = int(np.argmax(away))
        if away[farthest] <= radius * INSIDE + 1e-15 or len(few) > len(points) + 8:
            return centre, max(radius, float(away[farthest]))
        few.append(points[farthest])


def _of_few(points: Sequence[Array]) -> tuple[Array, float]:
    """By adding one point after another: one outside the circle so far lies on the rim of the next."""
    centre, radius = points[0], 0.0
    for i, p in enumerate(points):
        if np.linalg.norm(p - centre) <= radius * INSIDE:
            continue
        centre, radius = p, 0.0
        for j, q in enumerate(points[:i]):
            if np.linalg.norm(q - centre) <= radius * INSIDE:
                continue
            centre, radius = (p + q) / 2.0, float(np.linalg.norm(p - q)) / 2.0
            for r in points[:j]:
                if np.linalg.norm(r - centre) > radius * INSIDE:
                    centre, radius = _through(p, q, r)
    return centre, radius


def _through(a: Array, b: Array, c: Array) -> tuple[Array, float]:
    """The circle through three points; that around the two that are farthest apart where they lie on a line."""
    rows = 2.0 * np.array([b - a, c - a])
    right = np.array([b @ b - a @ a, c @ c - a @ a])
    if abs(np.linalg.det(rows)) < 1e-12 * float(np.abs(rows).max()) ** 2:
        one, other = max(((a, b), (b, c), (a, c)), key=lambda pair: float(np.linalg.norm(pair[0] - pair[1])))
        return (one + other) / 2.0, float(np.linalg.norm(one - other)) / 2.0
    centre = np.linalg.solve(rows, right)
    return centre, float(np.linalg.norm(a - centre))


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
