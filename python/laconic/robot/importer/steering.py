"""Upright joints above a wheel: they steer it, let it swivel as a caster, or turn a body that all wheels carry."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from laconic.robot.importer.placement import Array
from laconic.robot.importer.robot_tree import BALL, HINGE, Joint, Robot

UPRIGHT = np.cos(np.radians(20.0))  # of a swivel's axis: kingpins of cars are inclined by up to 15°
HELD_RAD = np.radians(0.2)  # what turns less is held by its limits
KINGPIN, KINGPIN_RAD = 0.2, np.radians(180.0)  # of the radius: trail that a car's kingpin has, within limits
FULL_RAD = np.radians(359.0)  # what turns less is said to have limits
NO_TRAIL, NO_TRAIL_M = 0.05, 1e-3  # of the wheel's radius, and at least
NEAR = 2.0  # times its radius: a wheel that trails farther is carried by a body, not by a fork


@dataclass(frozen=True, eq=False)
class Swivel:
    """The upright joint nearest to a wheel."""

    joint: Joint
    is_steered: bool
    why: str
    trail_m: float

    @property
    def name(self) -> str:
        """The joint's."""
        return self.joint.name


def is_upright(joint: Joint) -> bool:
    """A hinge with an upright axis."""
    return joint.kind == HINGE and abs(joint.axis[2]) >= UPRIGHT


def swivels(joint: Joint) -> bool:
    """Whether what hangs on it can turn about an upright axis: an upright hinge, or a ball as that of a hitch."""
    return joint.kind == BALL or (is_upright(joint) and joint.range_rad > HELD_RAD)


def foot_of(joint: Joint, ground_z: float) -> Array:
    """Where the axis of a swivel meets the ground."""
    if joint.kind == BALL:
        return np.array([*joint.point_m[:2], ground_z])
    return np.asarray(joint.point_m + joint.axis * ((ground_z - joint.point_m[2]) / joint.axis[2]))


def is_kingpin(joint: Joint, trail_m: float, radius_m: float) -> bool:
    """Whether a joint that nothing commands is that of a car's front wheel: little trail, and limits."""
    return trail_m <= KINGPIN * radius_m and joint.range_rad < KINGPIN_RAD


def has_no_trail(trail_m: float, radius_m: float) -> bool:
    """Whether a wheel stands below the axis that turns it, but for what a file rounds."""
    return trail_m <= max(NO_TRAIL * radius_m, NO_TRAIL_M)


def turntables(robot: Robot, wheels: Sequence[tuple[Joint, float]]) -> list[Joint]:
    """Upright joints that carry every wheel (each with its radius): what they turn is the rest of the robot."""
    places = np.array([wheel.point_m[:2] for wheel, _ in wheels])
    if len(wheels) < 2 or np.ptp(places, axis=0).max() <= NEAR * min(radius for _, radius in wheels):
        return []  # one wheel, or a twin caster
    first, *others = (list(filter(swivels, robot.chain(wheel))) for wheel, _ in wheels)
    return [joint for joint in first if all(joint in chain for chain in others)]


def swivel_of(robot: Robot, wheel: Joint, hub_m: Array, axle: Array, radius_m: float, held: Collection[Joint]
              ) -> Swivel | None:
    """None for a wheel below no upright joint but those that are held."""
    joint = next((each for each in robot.chain(wheel) if swivels(each) and each not in held), None)
    if joint is None:
        return None
    trail = _trail(joint, hub_m, axle, radius_m)
    is_steered, why = kind_of(joint, trail, radius_m)
    if not is_steered and joint.range_rad < FULL_RAD:
        why += f", turns within limits of {np.degrees(joint.range_rad):.0f}°"
    return Swivel(joint, is_steered, why, trail)


def _trail(joint: Joint, hub_m: Array, axle: Array, radius_m: float) -> float:
    """How far the wheel stands from the swivel's axis along the way that it rolls."""
    foot = foot_of(joint, float(hub_m[2]) - radius_m)
    rolling = np.array([-axle[1], axle[0]])
    return float(abs((hub_m - foot)[:2] @ rolling))


def kind_of(joint: Joint, trail_m: float, radius_m: float) -> tuple[bool, str]:
    """Whether a joint above a wheel steers it, and why."""
    has_none = has_no_trail(trail_m, radius_m)
    trail = "zero trail" if has_none else f"trail {1e3 * trail_m:.0f} mm"
    if joint.commands:
        return True, f"{trail}, commanded by {joint.commands[0].what}"
    if has_none:
        return True, trail
    if is_kingpin(joint, trail_m, radius_m):
        return True, f"{trail}, as a kingpin has within limits of {np.degrees(joint.range_rad):.0f}°"
    return False, f"{trail}, no command"
