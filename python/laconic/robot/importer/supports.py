"""What else stands on the ground: casters that swivel, and shapes that touch it without turning (ball casters)."""

from __future__ import annotations

from dataclasses import dataclass

from laconic.robot.importer.robot_tree import BALL, FIXED, SLIDE, Robot
from laconic.robot.importer.wheels import FoundWheel, Ground

MOVES = {SLIDE: "shifts and does not turn", BALL: "turns about every axis"}
TOUCHES = 0.05  # of the smallest wheel's radius above or below the ground
BELOW = 0.2


@dataclass(frozen=True)
class Support:
    """A point that carries a normal load, nothing else."""

    x_m: float
    y_m: float
    why: str


def find_supports(robot: Robot, ground: Ground) -> list[Support]:
    """Of each caster its swivel's axis; of each link that touches the ground its lowest point."""
    found = [_caster(each) for each in ground.casters]
    turning = {link.name for wheel in (*ground.wheels, *ground.casters)
               for link in robot.below(wheel.joint, rigid=False)}
    smallest = min(wheel.radius_m for wheel in ground.wheels)
    for link in robot.links.values():
        if link.name in turning:
            continue
        low = [s.lowest() for s in link.shapes if s.collides] or [s.lowest() for s in link.shapes]
        if not low:
            continue
        point = min(low, key=lambda each: float(each[2]))
        if -BELOW * smallest <= point[2] - ground.height_m <= TOUCHES * smallest:
            found.append(Support(float(point[0]), float(point[1]),
                                 f"assumption: {link.name}, {_height(point[2] - ground.height_m)}, slides without "
                                 f"drag{_no_wheel(robot, link.name)}"))
    return found


def _no_wheel(robot: Robot, link: str) -> str:
    """Why a link that its joint lets move is no wheel; nothing of one that is fixed."""
    joint = next((each for each in robot.joints.values() if each.child == link), None)
    if joint is None or joint.kind == FIXED:
        return ""
    why = MOVES.get(joint.kind, "turns within limits" if joint.is_limited else "turns on no level axle")
    return f"; its joint {joint.name} {why}, so it is no wheel"


def _caster(wheel: FoundWheel) -> Support:
    assert wheel.swivel is not None
    x, y = wheel.swivel.point_m[:2]
    what = (f"{wheel.name} is steered by {wheel.swivel.name}, which is not modelled; it carries a load and slides "
            "without drag"
            if wheel.swivel.is_limited else
            f"caster {wheel.name} swivels freely about {wheel.swivel.name}, without drag")
    return Support(float(x), float(y), f"assumption: {what}")


def _height(above_m: float) -> str:
    mm = 1e3 * above_m
    side = "above" if mm > 0.0 else "below"
    return "on the ground" if abs(mm) < 0.5 else f"{abs(mm):.0f} mm {side} the wheels' ground"
