"""Which joints of a robot are its wheels: hinges with a level axle, free to turn, whose shapes reach the ground."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from laconic.errors import BadInput, nearest_of
from laconic.robot.importer.answers import Answers, answer
from laconic.robot.importer.placement import Array
from laconic.robot.importer.rigid_body import inertia_about_axis
from laconic.robot.importer.robot_tree import HINGE, SLIDE, Joint, Link, Robot
from laconic.robot.importer.wheel_parts import ROLLERS_AT_LEAST, has_the_axle_of, parts_of, rollers_of

OF_PACKAGES = ("package://", "model://")
MOST_NAMED = 3  # meshes in a message
LEVEL = np.sin(np.radians(10.0))  # the steepest axle of a wheel
UPRIGHT = np.cos(np.radians(10.0))  # of a swivel's axis
PLACE_DIGITS = 4  # wheels nearer than a tenth of a millimetre are in one place
REACHES = 0.05  # of the radius above the ground, at most


@dataclass(frozen=True, eq=False)
class Roller:
    """A part of a wheel that turns on an axle of its own."""

    point_m: Array
    axis: Array


@dataclass(frozen=True, eq=False)
class FoundWheel:
    """A wheel in the frame of the base; the axle points as the joint turns, right-handed."""

    joint: Joint
    hub_m: Array
    axle: Array
    radius_m: float
    inertia_kgm2: float
    rollers: tuple[Roller, ...] = ()
    swivel: Joint | None = None
    remarks: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """The joint's."""
        return self.joint.name

    @property
    def axle_rad(self) -> float:
        """As a scene has it: the hub of a wheel that turns positively moves along this direction rotated by +90°."""
        angle = float(np.arctan2(-self.axle[1], -self.axle[0]))
        return angle if angle > -np.pi + 1e-12 else np.pi


@dataclass(frozen=True)
class Ground:
    """What stands on it, its height in the frame of the base, and why joints that look like wheels are none."""

    wheels: tuple[FoundWheel, ...]
    casters: tuple[FoundWheel, ...]
    height_m: float
    remarks: tuple[str, ...]


def find_wheels(robot: Robot, answers: Answers) -> Ground:
    """BadInput where there is none, or where a radius or an inertia has to be asked for."""
    named = [_named(robot, name) for name in answers.wheels]
    _check_named(robot, named)
    candidates = named or [joint for joint in robot.joints.values() if _turns_as_wheel(robot, joint)]
    measured = [(joint, _radius(robot, joint, answers)) for joint in candidates]
    if not any(radius for _, radius in measured):
        raise BadInput(f"{robot.path}: {_no_wheel(robot, candidates)}")
    height = min(float(joint.point_m[2]) - radius for joint, radius in measured if radius)
    reaching, remarks = [], []
    for joint, radius in measured:
        if radius is None:
            if "wheel" in joint.name.lower() or _beside_a_wheel(joint, measured):
                has_shapes = _has_shapes(robot, joint)
                why = "its shapes have the radius 0" if has_shapes else "no shape tells the wheel's radius"
                why += _unread(robot, [joint])
                raise BadInput(f"{robot.path}: joint {joint.name}: {why}; give --radius {joint.name}=METRES, or "
                               "--wheel JOINT for each joint that is a wheel")
            remarks.append(f"joint {joint.name} turns on a level axle, no shape tells a radius, so it is no wheel; "
                           f"--radius {joint.name}=METRES would say otherwise")
            continue
        above = float(joint.point_m[2]) - radius - height
        if above <= REACHES * radius or named:
            reaching.append(_wheel(robot, joint, radius, answers, named))
        else:
            remarks.append(f"joint {joint.name} turns on a level axle, {1e3 * above:.0f} mm above the ground, and is "
                           "no wheel; "
                           f"--wheel JOINT for each wheel would say otherwise")
    wheels = tuple(wheel for wheel in reaching if wheel.swivel is None or named)
    casters = tuple(wheel for wheel in reaching if wheel.swivel is not None and not named)
    if not wheels:
        raise BadInput(f"{robot.path}: all wheels swivel ({', '.join(each.name for each in casters)}), and steering "
                       "is not "
                       "modelled; give --wheel JOINT for those that are held")
    _check_places(robot, wheels)
    remarks += [remark for wheel in wheels for remark in wheel.remarks]
    remarks += [f"joint {joint.name} turns round on an axle {_degrees(np.arcsin(min(abs(joint.axis[2]), 1.0)))} from "
                "level, and is no wheel; a wheel's axle is level" for joint in robot.joints.values()
                if _is_tilted(joint)]
    return Ground(wheels, casters, height, tuple(remarks))


def _check_places(robot: Robot, wheels: Sequence[FoundWheel]) -> None:
    """BadInput for two wheels in one place, such as a copied joint whose origin was not changed."""
    there: dict[tuple[float, ...], str] = {}
    for wheel in wheels:
        place = tuple(float(each) + 0.0 for each in np.round(wheel.hub_m, PLACE_DIGITS))
        if place in there:
            raise BadInput(f"{robot.path}: joint {wheel.name}: its wheel is in the place of {there[place]}'s, "
                           f"({place[0]:g}, {place[1]:g}) m; give it an origin of its own, or --wheel JOINT for each "
                           "wheel that counts")
        there[place] = wheel.name


def _beside_a_wheel(joint: Joint, measured: Sequence[tuple[Joint, float | None]]) -> bool:
    """As high as an axle whose radius is known: a wheel whose mesh is not there."""
    return any(radius and abs(joint.point_m[2] - other.point_m[2]) < 0.1 * radius for other, radius in measured)


def _named(robot: Robot, name: str) -> Joint:
    if name not in robot.joints:
        raise BadInput(f"--wheel {name}: there is no such joint; {nearest_of(name, robot.joints)}")
    joint = robot.joints[name]
    if joint.kind != HINGE or abs(joint.axis[2]) > LEVEL:
        raise BadInput(f"--wheel {name}: does not turn on a level axle, so it is no wheel; name another joint")
    return joint


def _check_named(robot: Robot, named: Sequence[Joint]) -> None:
    """BadInput for a wheel that another carries round, whose place is none of the robot's, or that is named twice."""
    for joint in named:
        if named.count(joint) > 1:
            raise BadInput(f"--wheel {joint.name}: is given twice; name each wheel once")
        for above in robot.chain(joint):
            if above in named and not has_the_axle_of(joint, above):
                raise BadInput(f"--wheel {joint.name}: hangs on wheel {above.name}, which carries it round; name one "
                               "of the two")


def _turns_as_wheel(robot: Robot, joint: Joint) -> bool:
    """A free hinge with a level axle that is not part of another wheel."""
    if joint.kind != HINGE or joint.is_limited or abs(joint.axis[2]) > LEVEL:
        return False
    return not any(above.kind == HINGE and not above.is_limited and abs(above.axis[2]) <= LEVEL
                   for above in robot.chain(joint))


def _is_tilted(joint: Joint) -> bool:
    """A free hinge that is neither a wheel's nor, as a swivel's, upright."""
    return joint.kind == HINGE and not joint.is_limited and LEVEL < abs(joint.axis[2]) < UPRIGHT


def _no_wheel(robot: Robot, candidates: Sequence[Joint]) -> str:
    if candidates:
        names = ", ".join(joint.name for joint in candidates[:6])
        are_there = any(_has_shapes(robot, joint) for joint in candidates)
        why = f"the shapes of {names} have the radius 0" if are_there else f"no shape tells the radius of {names}"
        why += _unread(robot, candidates[:6])
        return f"{why}; give --radius METRES, and --wheel JOINT for each wheel"
    limited = [joint.name for joint in robot.joints.values() if joint.kind == HINGE and joint.is_limited
               and abs(joint.axis[2]) <= LEVEL]
    seen = f" ({', '.join(limited[:6])}: within limits)" if limited else ""
    return (f"no joint turns round on a level axle (continuous, z up){seen}, so there is no wheel; give --wheel JOINT "
            "for each joint that is one")


def _unread(robot: Robot, joints: Sequence[Joint]) -> str:
    """The meshes of wheels that could not be had, and how to say where they are."""
    meshes = dict.fromkeys(each for joint in joints for link in robot.below(joint, rigid=True) for each in link.unread)
    if not meshes:
        return ""
    where = ", --package NAME=FOLDER says where" if any(each.startswith(OF_PACKAGES) for each in meshes) else ""
    return f", as their meshes were not read: {', '.join([*meshes][:MOST_NAMED])}{where}"


def _has_shapes(robot: Robot, joint: Joint) -> bool:
    return any(link.shapes for link in robot.below(joint, rigid=True))


def _radius(robot: Robot, joint: Joint, answers: Answers) -> float | None:
    """Said by the user, else the reach of its rollers, else of its own shapes."""
    if (said := answer(answers.radius_m, joint.name)) is not None:
        return said
    inner = rollers_of(robot, joint)
    reach = [_reach(robot, joint, roller) for roller in inner]
    told = [each for each in reach if each] if len(inner) >= ROLLERS_AT_LEAST else []
    return max(told) if told else _own_radius(robot, joint)


def _reach(robot: Robot, wheel: Joint, roller: Joint) -> float | None:
    """How far the middle of a roller reaches when it points to the ground."""
    own = _own_radius(robot, roller)
    off = roller.point_m - wheel.point_m
    return None if own is None else float(np.linalg.norm(off - wheel.axis * (off @ wheel.axis))) + own


def _own_radius(robot: Robot, joint: Joint) -> float | None:
    """Of the shapes that collide, else of those that are seen."""
    shapes = [shape for link in robot.below(joint, rigid=True) for shape in link.shapes]
    chosen = [s for s in shapes if s.collides] or shapes
    radius = max((shape.radius_about(joint.point_m, joint.axis) for shape in chosen), default=0.0)
    return radius if radius > 1e-6 else None


def _wheel(robot: Robot, joint: Joint, radius: float, answers: Answers, named: Collection[Joint]) -> FoundWheel:
    parts = parts_of(robot, joint, named)
    rollers = tuple(Roller(j.point_m, j.axis) for j in parts.rollers)
    axle = joint.axis - np.array([0.0, 0.0, joint.axis[2]])
    axle = axle / np.linalg.norm(axle)
    remarks = [f"axle of {joint.name} is {_degrees(np.arcsin(abs(joint.axis[2])))} from level; taken as level"
               ] if abs(joint.axis[2]) > np.sin(np.radians(0.5)) else []
    swivel = None
    for above in robot.chain(joint):
        if above.kind == HINGE and abs(above.axis[2]) >= UPRIGHT:
            swivel = above
        elif above.kind in (HINGE, SLIDE) and above not in named:
            remarks.append(f"joint {above.name} above {joint.name} is held in its zero position")
    if swivel is not None:
        remarks.append(f"{joint.name} is steered by {swivel.name}, which is held in its zero position")
    remarks += parts.remarks
    said = answer(answers.inertia_kgm2, joint.name)
    inertia = inertia_about_axis(parts.turning, joint.point_m, axle) if said is None else said
    hub = _hub(parts.shaped, joint, axle)
    return FoundWheel(joint, hub, axle, radius, inertia, rollers, swivel, tuple(remarks))


def _hub(parts: Sequence[Link], joint: Joint, axle: Array) -> Array:
    """The middle of the wheel on its axle: of its shapes, because a joint may lie at the end of the axle."""
    shapes = [shape for link in parts for shape in link.shapes]
    chosen = [s for s in shapes if s.collides] or shapes
    if not chosen:
        return joint.point_m
    outline = np.vstack([s.outline() for s in chosen])
    along = (outline - joint.point_m) @ axle
    return np.asarray(joint.point_m + axle * (along.min() + along.max()) / 2.0)


def _degrees(angle_rad: float) -> str:
    return f"{np.degrees(angle_rad):.1f}°"
