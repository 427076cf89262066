"""What else stands on the ground: casters, wheels that are steered, and shapes that slide (ball casters)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from laconic.robot.importer.hung import HungBody, names_on_hinges
from laconic.robot.importer.placement import Array
from laconic.robot.importer.robot_tree import BALL, FIXED, SLIDE, Link, Robot, Shape
from laconic.robot.importer.steering import NEAR, Swivel
from laconic.robot.importer.wheels import FoundWheel, Ground

MOVES = {SLIDE: "shifts and does not turn", BALL: "turns about every axis"}
TOUCHES, TOUCHES_M = 0.05, 3e-3  # of the smallest wheel's radius above the ground, or so far
BELOW = 0.2
BESIDE = 0.5  # of a wheel's radius: how far what belongs to a wheel reaches beside it
THIN, THIN_M = 0.05, 2e-3  # of the smallest wheel's radius, or of any: a marker
LARGE = 2.0  # times the smallest wheel's radius: a face on the ground that is no caster's
MARKERS = ("footprint", "ground", "odom", "map", "world")  # in names of links that only mark a place
CARRIES = ("caster", "castor", "ball", "wheel", "skid", "support", "foot", "slider", "glide")
NEAR_M = 5e-3  # points of one link that are nearer are one


@dataclass(frozen=True)
class Support:
    """A point that carries a normal load, nothing else."""

    x_m: float
    y_m: float
    why: str
    name: str


def find_supports(robot: Robot, ground: Ground, bodies: Sequence[HungBody] = ()) -> tuple[list[Support], list[str]]:
    """Of each caster a point, and of each shape that touches the ground beside the wheels its lowest point. The remarks
    name shapes that touch it and carry nothing, and why. `bodies` on hinges have wheels of their own."""
    found, remarks = _casters(ground.casters), list[str]()
    ground = replace(ground, wheels=(*ground.wheels, *(wheel for body in bodies for wheel in body.wheels)))
    turning = {link.name for wheel in (*ground.wheels, *ground.casters)
               for link in robot.below(wheel.joint, rigid=False)}
    smallest, on_hinges = min(wheel.radius_m for wheel in ground.wheels), names_on_hinges(bodies)
    for link in robot.links.values():
        if link.name in turning:
            continue
        touching = [shape for shape in link.shapes if -BELOW * smallest <= shape.lowest()[2] - ground.height_m
                    <= max(TOUCHES * smallest, TOUCHES_M)]
        if not touching:
            continue
        carrying = [shape for shape in touching if not _why_none(link, shape, ground, smallest)]
        if carrying and link.name in on_hinges:
            remarks.append(f"link {link.name} touches the ground and turns on a hinge; only supports of the carriage "
                           "count, so it carries nothing")
            continue
        found += _points(robot, link, carrying, ground)
        if not carrying:
            remarks.append(f"link {link.name} touches the ground and is no support: "
                           f"{_why_none(link, touching[0], ground, smallest)}")
    return found, remarks


def _points(robot: Robot, link: Link, shapes: Sequence[Shape], ground: Ground) -> list[Support]:
    """One of each shape, or of several that touch the ground in one place."""
    found: list[Support] = []
    for point in (shape.lowest() for shape in shapes):
        if any(np.hypot(point[0] - each.x_m, point[1] - each.y_m) < NEAR_M for each in found):
            continue
        found.append(Support(float(point[0]), float(point[1]),
                             f"assumption: {link.name}, {_height(point[2] - ground.height_m)}, slides without "
                             f"drag{_no_wheel(robot, link.name)}", link.name))
    return found


def _why_none(link: Link, shape: Shape, ground: Ground, smallest_m: float) -> str:
    """Why a shape on the ground carries nothing; empty for one that does."""
    name = link.name.lower()
    if any(word in name for word in MARKERS):
        return "by its name it marks a place"
    if not shape.collides:
        return "its shape is only seen; give it a <collision> if it carries a load"
    if (flat := shape.flat_m()) > LARGE * smallest_m:
        return f"it lies flat on the ground over {flat:.3g} m and more, as a body does"
    if (thin := shape.thinnest()) < max(THIN * smallest_m, THIN_M):
        return f"its shape is {1e3 * thin:.3g} mm thin, as a marker is"
    if wheel := next((each for each in (*ground.wheels, *ground.casters) if _is_at(each, shape.lowest())), None):
        return f"it lies within the footprint of wheel {wheel.name}, which carries the load there"
    if link.mass_kg <= 0.0 and shape.kind != "sphere" and not any(word in name for word in CARRIES):
        return "it has no mass; give it an <inertial> if it carries a load"
    return ""


def _is_at(wheel: FoundWheel, point: Array) -> bool:
    """Whether a point on the ground lies where a wheel stands, or where it comes as it swivels."""
    off = (point - wheel.hub_m)[:2]
    axle = wheel.axle[:2]
    beside = wheel.half_width_m + BESIDE * wheel.radius_m
    if abs(off @ axle) <= beside and abs(off @ np.array([-axle[1], axle[0]])) <= wheel.radius_m:
        return True
    if wheel.swivel is None:
        return False
    reach = wheel.swivel.trail_m + wheel.radius_m
    near = float(np.linalg.norm((point - wheel.swivel.joint.point_m)[:2]))
    return wheel.swivel.trail_m <= NEAR * wheel.radius_m and near <= reach


def _no_wheel(robot: Robot, link: str) -> str:
    """Why a link that its joint lets move is no wheel; nothing of one that is fixed."""
    joint = robot.joint_above.get(link)
    if joint is None or joint.kind == FIXED:
        return ""
    why = MOVES.get(joint.kind, "turns within limits" if joint.is_limited else "turns on no level axle")
    return f"; its joint {joint.name} {why}, so it is no wheel"


def _casters(wheels: Sequence[FoundWheel]) -> list[Support]:
    """One for all wheels of a fork: a twin caster carries one load."""
    found: list[Support] = []
    left = list(wheels)
    while left:
        first = left.pop(0)
        twins = [each for each in left if _is_twin(first, each)]
        left = [each for each in left if each not in twins]
        found.append(_caster([first, *twins]))
    return found


def _is_twin(one: FoundWheel, other: FoundWheel) -> bool:
    if one.swivel is None or other.swivel is None or one.swivel.joint is not other.swivel.joint:
        return False
    return float(np.linalg.norm((one.hub_m - other.hub_m)[:2])) <= NEAR * max(one.radius_m, other.radius_m)


def _caster(twins: Sequence[FoundWheel]) -> Support:
    """A caster on average stands below its swivel's axis; a wheel that is steered where it is."""
    names = " and ".join(each.name for each in twins)
    first, swivel = twins[0], twins[0].swivel
    x, y = np.mean([each.hub_m[:2] for each in twins], axis=0)
    if swivel is None:
        return Support(float(x), float(y), f"assumption: {names} slides without drag, as its friction is 0 in the file",
                       names)
    if not swivel.is_steered and swivel.trail_m <= NEAR * first.radius_m:
        x, y = swivel.joint.point_m[:2]
    return Support(float(x), float(y), f"assumption: {_words(names, first, swivel)}", names)


def _words(names: str, wheel: FoundWheel, swivel: Swivel) -> str:
    if not swivel.is_steered:
        return f"caster {names} swivels freely about {swivel.name}, without drag ({swivel.why})"
    driven = f"; driven: commanded by {wheel.joint.commands[0].what}" if wheel.joint.commands else ""
    return (f"{names} is steered by {swivel.name}, which is not modelled; it carries a load and slides without drag "
            f"(steered: {swivel.why}{driven})")


def _height(above_m: float) -> str:
    mm = 1e3 * above_m
    side = "above" if mm > 0.0 else "below"
    return "on the ground" if abs(mm) < 0.5 else f"{abs(mm):.0f} mm {side} the wheels' ground"
