"""Bodies on hinges of a robot: steered wheels, swivel casters, trailers, and frames that hinges join.

    bodies, ground = hung_of(robot, ground)   # `ground` keeps the wheels of the carriage, and what only carries a load

An upright joint above a wheel is a hinge, unless it carries all wheels. What hangs on it down to the next hinges is one
body. A body has a frame of its own: its origin is where the axis meets the ground.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from laconic.core.spelling import wrapped
from laconic.robot.importer.axle_lines import lines_of, straightened
from laconic.robot.importer.placement import Array
from laconic.robot.importer.robot_tree import BALL, Joint, Link, RigidBody, Robot, add_up
from laconic.robot.importer.steering import FULL_RAD, NEAR, foot_of, has_no_trail, kind_of, swivels, turntables
from laconic.robot.importer.wheels import FoundWheel, Ground
from laconic.scene.axle_lines import WITHIN_RAD, are_parallel, common_line

FREE, PRESCRIBED, COORDINATED = "free", "prescribed", "coordinated"
SAME, SAME_M = 1e-3, 1e-3  # of radii and inertias; of distances
MOST_ROWS = 2  # axles on different lines, which leave the carriage a motion whatever their angles are
CARRIAGE = "carriage"


@dataclass(frozen=True, eq=False)
class HungBody:
    """What one hinge carries, without what hangs on further hinges.

    `frame_rad` is the direction of its frame in that of the base, as the file places it; `start_rad` the angle of the
    hinge at the start, and `zero_rad` the angle that it has in the file's zero position."""

    name: str
    form: str  # "wheel", "caster", "trailer", "body": its table in a scene
    joint: Joint
    kind: str
    why: str
    parent: str
    hinge_m: Array
    parent_rad: float
    frame_rad: float
    start_rad: float
    wheels: tuple[FoundWheel, ...]
    links: tuple[Link, ...]
    whole: RigidBody

    @property
    def zero_rad(self) -> float:
        """The angle of the hinge in the zero position of the file."""
        return within_pi(self.frame_rad - self.parent_rad)

    @property
    def sense(self) -> float:
        """1 where the joint turns to the left, −1 where it turns to the right."""
        return 1.0 if self.joint.kind == BALL or self.joint.axis[2] > 0.0 else -1.0

    @property
    def stops_rad(self) -> tuple[float, float]:
        """Least and largest angle of the hinge; infinite for what can turn round."""
        low, high = self.joint.low_rad, self.joint.high_rad
        if not high - low < FULL_RAD:
            return -np.inf, np.inf
        ends = sorted((self.sense * low, self.sense * high))
        return self.zero_rad + ends[0], self.zero_rad + ends[1]

    def local(self, point: Array) -> Array:
        """A point of the base's frame in the body's own."""
        return turned(point[:2] - self.hinge_m, -self.frame_rad)

    def axle_rad_of(self, wheel: FoundWheel) -> float:
        """The axle in the body's frame; of a steered wheel it is straight, as toe is rounding or the wheel's angle."""
        own = within_pi(wheel.axle_rad - self.frame_rad)
        if self.kind == FREE:
            return own
        quarter = np.pi / 2.0
        return float(quarter * round(own / quarter)) if abs(own - quarter * round(own / quarter)) < 2.0 * WITHIN_RAD \
            else own

    def axle_m(self) -> Array:
        """The middle of its wheels, in the frame of the base."""
        return np.asarray(np.mean([each.hub_m[:2] for each in self.wheels], axis=0) if self.wheels else self.hinge_m)


def within_pi(angle_rad: float) -> float:
    """In (−π, π]; 0 for rounding."""
    angle = wrapped(angle_rad)
    return 0.0 if abs(angle) < 1e-9 else float(angle)


def turned(vector: Array, angle_rad: float) -> Array:
    """A vector of the plane, turned to the left."""
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    return np.array([c * vector[0] - s * vector[1], s * vector[0] + c * vector[1]])


def rolling_of(wheel: FoundWheel) -> Array:
    """Unit vector along which its hub moves as it turns positively."""
    return np.array([-np.sin(wheel.axle_rad), np.cos(wheel.axle_rad)])


def ahead_of(ground: Ground) -> Array:
    """The way that the carriage's plain wheels roll, x or y rather than against them; x where it has none."""
    if not ground.wheels:
        return np.array([1.0, 0.0])
    ways = [rolling_of(wheel) for wheel in ground.wheels]
    ahead = ways[0]
    if any(abs(ahead @ np.array([-way[1], way[0]])) > WITHIN_RAD for way in ways) or any(
            wheel.rollers for wheel in ground.wheels):
        return np.array([1.0, 0.0])
    ahead = np.round(ahead, 9) + 0.0
    return np.asarray(-ahead if max(ahead, key=abs) < 0.0 else ahead)


def on_one_axle(wheels: Sequence[FoundWheel], name: str) -> tuple[list[FoundWheel], list[str]]:
    """Wheels on parallel axles, moved onto the one in their middle, about which a tandem turns."""
    lines = lines_of(wheels)
    if not are_parallel(lines) or common_line(lines):
        return [*wheels], []
    ahead = lines[0].normal
    along = [float(line.point @ ahead) for line in lines]
    axles = sorted({round(each, 3) for each in along})
    middle = (axles[0] + axles[-1]) / 2.0
    moved = []
    for wheel, each in zip(wheels, along, strict=True):
        off = (middle - each) * ahead
        moved.append(replace(wheel, hub_m=wheel.hub_m + np.array([off[0], off[1], 0.0])))
    return moved, [f"{len(axles)} parallel axles of {name} would hold each other straight; their wheels count as on "
                   f"the one in their middle, {(axles[-1] - axles[0]) / 2.0:.3g} m from the outer ones"]


def hung_of(robot: Robot, ground: Ground, is_fixed: bool) -> tuple[list[HungBody], Ground, list[str]]:
    """Bodies with parents first, what stays with the carriage, and remarks; `is_fixed`: the carriage's wheels are
    plain, so that they hinder the others."""
    on_hinges = [wheel for wheel in ground.casters if wheel.swivel]
    every = [(wheel.joint, wheel.radius_m) for wheel in (*ground.wheels, *ground.casters)]
    tables = turntables(robot, every)
    hinges: dict[str, Joint] = {}
    for wheel in on_hinges:
        for joint in reversed([each for each in robot.chain(wheel.joint) if swivels(each) and each not in tables]):
            hinges.setdefault(joint.name, joint)
    made: dict[str, HungBody] = {}
    remarks: list[str] = []
    for joint in hinges.values():
        wheels = [wheel for wheel in on_hinges if wheel.swivel and wheel.swivel.joint is joint]
        if len(wheels) > 1:
            wheels, moved = straightened(wheels)
            wheels, merged = on_one_axle(wheels, joint.name)
            remarks += [*moved, *merged]
        made[joint.name] = _body(robot, ground, joint, wheels, hinges, made)
    bodies = _coordinated([*made.values()], ground, is_fixed)
    remarks += [remark for wheel in on_hinges for remark in wheel.remarks]
    return bodies, replace(ground, casters=tuple(each for each in ground.casters if not each.swivel)), remarks


def _body(robot: Robot, ground: Ground, joint: Joint, wheels: Sequence[FoundWheel], hinges: dict[str, Joint],
          made: dict[str, HungBody]) -> HungBody:
    below = {link.name for other in hinges.values() if other is not joint and joint in robot.chain(other)
             for link in robot.below(other, rigid=False)}
    links = tuple(link for link in robot.below(joint, rigid=False) if link.name not in below)
    above = next((made[each.name] for each in robot.chain(joint) if each.name in made), None)
    hinge = foot_of(joint, ground.height_m)[:2]
    is_steered, why = _steered(joint, wheels, hinge)
    parent_rad = above.frame_rad if above else 0.0
    ahead = turned(np.array([1.0, 0.0]), parent_rad) if above else ahead_of(ground)
    frame, form, start = parent_rad, "body", 0.0
    if is_steered and wheels:
        frame = within_pi(parent_rad + _off(wheels[0], ahead))
        is_alone = len(wheels) == 1 and has_no_trail(_lever(wheels[0], hinge), wheels[0].radius_m)
        is_alone = is_alone and within_pi(float(np.arctan2(ahead[1], ahead[0])) - parent_rad) == 0.0
        form = "wheel" if is_alone else "body"
    elif wheels and _axle_is_common(wheels) and _lever(wheels[0], hinge) > SAME_M:
        frame = _behind(wheels, hinge)
        form = _form_of_free(wheels, hinge, frame, add_up(links))
        frame = parent_rad if form == "body" else frame
        start = within_pi(frame - parent_rad)
    return HungBody(_name(joint.name, made), form, joint, PRESCRIBED if is_steered else FREE, why,
                    above.name if above else CARRIAGE, hinge, parent_rad, frame, start, tuple(wheels), links,
                    add_up(links))


def _steered(joint: Joint, wheels: Sequence[FoundWheel], hinge: Array) -> tuple[bool, str]:
    """Whether a body follows a command, and why: it has one, or its wheels stand below its axis."""
    if not wheels:
        return bool(joint.commands), f"commanded by {joint.commands[0].what}" if joint.commands else "no command"
    return kind_of(joint, _lever(wheels[0], hinge), wheels[0].radius_m)


def _lever(wheel: FoundWheel, hinge: Array) -> float:
    """How far its axle passes the hinge."""
    return float(abs((wheel.hub_m[:2] - hinge) @ rolling_of(wheel)))


def _off(wheel: FoundWheel, ahead: Array) -> float:
    """The angle from ahead to the way that it rolls, whichever sense is nearer."""
    way = rolling_of(wheel)
    way = way if way @ ahead >= -1e-9 else -way
    angle = float(np.arctan2(ahead[0] * way[1] - ahead[1] * way[0], ahead @ way))
    return 0.0 if abs(angle) < WITHIN_RAD else angle


def _axle_is_common(wheels: Sequence[FoundWheel]) -> bool:
    return bool(common_line(lines_of(wheels)))


def _behind(wheels: Sequence[FoundWheel], hinge: Array) -> float:
    """The direction from the axle to the hinge, square to the axle."""
    way = rolling_of(wheels[0])
    way = way if (hinge - wheels[0].hub_m[:2]) @ way > 0.0 else -way
    return within_pi(float(np.arctan2(way[1], way[0])))


def _form_of_free(wheels: Sequence[FoundWheel], hinge: Array, frame: float, whole: RigidBody) -> str:
    """A caster is a fork with one wheel or two twins; a trailer has two wheels far behind its hitch."""
    radii = [each.radius_m for each in wheels]
    inertias = [each.inertia_kgm2 for each in wheels]
    if len(wheels) > 2 or max(radii) - min(radii) > SAME * max(radii) or (
            max(inertias) - min(inertias) > SAME * max(inertias)):
        return "body"
    if _lever(wheels[0], hinge) <= NEAR * radii[0]:
        return "caster"
    left = [float(turned(each.hub_m[:2] - hinge, -frame)[1]) for each in wheels]
    com = float(turned(whole.com_m[:2] - hinge, -frame)[1]) if whole.mass_kg > 0.0 else 0.0
    is_even = len(wheels) == 2 and abs(sum(left)) <= 2.0 * SAME_M and abs(com) <= SAME_M
    return "trailer" if is_even else "body"


def _coordinated(bodies: Sequence[HungBody], ground: Ground, is_fixed: bool) -> list[HungBody]:
    """The same, with all steered bodies of the carriage coordinated where their wheels would contradict each other."""
    steered = [each for each in bodies if each.kind == PRESCRIBED and each.parent == CARRIAGE and each.wheels]
    fixed = 0
    if is_fixed and ground.wheels:
        fixed = 1 if _axle_is_common(ground.wheels) else MOST_ROWS
    if len(steered) < 2 or fixed + len(steered) <= MOST_ROWS or not all(_can_be_coordinated(each) for each in steered):
        return [*bodies]
    why = "all point along one motion, as they would contradict each other else"
    ahead = ahead_of(ground)
    turn = float(np.arctan2(ahead[1], ahead[0]))  # such a body points along its first axis
    changed = {each.name: replace(each, kind=COORDINATED, why=f"{each.why}; {why}", start_rad=within_pi(turn),
                                  frame_rad=within_pi(each.frame_rad + turn)) for each in steered}
    return [changed.get(each.name, each) for each in bodies]


def _can_be_coordinated(body: HungBody) -> bool:
    """Whether its axle lies below its hinge, or may count so as that of a car's inclined kingpin does."""
    return _axle_is_common(body.wheels) and all(_lever(each, body.hinge_m) <= each.radius_m for each in body.wheels)


def _name(joint: str, made: dict[str, HungBody]) -> str:
    """As signals can have it."""
    name = re.sub(r"[^\w-]+", "_", joint).strip("_-") or "hinge"
    name = name if re.match(r"[^\W\d]", name) and name != CARRIAGE else f"hinge_{name}"
    taken, number = {each.name for each in made.values()}, 2
    while (found := name if number == 2 else f"{name}_{number - 1}") in taken:
        number += 1
    return found


def links_of_carriage(robot: Robot, bodies: Sequence[HungBody]) -> list[Link]:
    """All that hangs on no hinge."""
    away = names_on_hinges(bodies)
    return [link for name, link in robot.links.items() if name not in away]


def names_on_hinges(bodies: Sequence[HungBody]) -> set[str]:
    """Of the links that turn with a body, and are no supports of the carriage."""
    return {link.name for body in bodies for link in body.links}
