"""Which joints of a robot are its wheels: hinges with a level axle, free to turn, whose shapes reach the ground."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from laconic.errors import BadInput, nearest_of
from laconic.robot.importer.answers import Answers, answer
from laconic.robot.importer.gravity import listed
from laconic.robot.importer.placement import Array
from laconic.robot.importer.robot_tree import (
    FIXED,
    HINGE,
    SLIDE,
    Joint,
    Link,
    Robot,
    Shape,
    Surface,
    inertia_about_axis,
)
from laconic.robot.importer.steering import Swivel, is_upright, swivel_of, swivels, turntables
from laconic.robot.importer.surfaces import is_frictionless
from laconic.robot.importer.wheel_shape import (
    ROLLERS_AT_LEAST,
    Reach,
    chosen_shapes,
    has_the_axle_of,
    parts_of,
    reach_of,
    rollers_of,
    skew_of,
)

OF_PACKAGES = ("package://", "model://")
MOST_WHEELS = 64  # with casters; the core has room for fewer
MOST_NAMED = 3  # meshes in a message
LEVEL = np.sin(np.radians(10.0))  # the steepest axle of a wheel
CAMBER = np.sin(np.radians(0.2))  # what is less is rounding
SKEW = np.radians(45.0)  # of a cylinder to the axle: it is not that of a wheel
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
    swivel: Swivel | None = None
    remarks: tuple[str, ...] = ()
    half_width_m: float = 0.0
    mass_kg: float = 0.0  # of what turns about the axle
    surface: Surface | None = None  # of its shape

    @property
    def is_steered(self) -> bool:
        """Whether a joint turns it about an upright axis by a command."""
        return self.swivel is not None and self.swivel.is_steered

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
    """What stands on it, its height in the frame of the base, and why joints that look like wheels are none.

    `casters` swivel, are steered, or slide since they have no friction."""

    wheels: tuple[FoundWheel, ...]
    casters: tuple[FoundWheel, ...]
    height_m: float
    remarks: tuple[str, ...]


def find_wheels(robot: Robot, answers: Answers) -> Ground:
    """BadInput where there is none, or where a radius or an inertia has to be asked for."""
    named = [_named(robot, name) for name in answers.wheels]
    _check_named(robot, named)
    candidates = named or [joint for joint in robot.joints.values() if _turns_as_wheel(robot, joint)]
    measured, remarks = _measured(robot, candidates, answers, bool(named))
    if not any(reach for _, reach in measured):
        raise BadInput(f"{robot.path}: {_no_wheel(robot, [joint for joint, _ in measured])}")
    _check_known(robot, measured)
    known = [(joint, reach) for joint, reach in measured if reach]
    height = min(float(joint.point_m[2]) - reach.radius_m for joint, reach in known)
    remarks += [f"joint {joint.name} turns on a level axle, no shape tells a radius, so it is no wheel; "
                f"--radius {joint.name}=METRES would say otherwise" for joint, reach in measured if reach is None]
    reaching, aloft = [], []
    for joint, reach in known:
        above = float(joint.point_m[2]) - reach.radius_m - height
        if above <= REACHES * reach.radius_m or named:
            reaching.append((joint, reach))
        else:
            aloft.append((joint.name, f"{1e3 * above:.0f} mm"))
    remarks += _of_each(aloft, "joint {} turns on a level axle, {} above the ground, and is no wheel",
                        "joints turn on level axles above the ground, and are no wheels",
                        "--wheel JOINT for each wheel would say otherwise")
    if len(reaching) > MOST_WHEELS:
        raise BadInput(f"{robot.path}: {len(reaching)} joints have shapes that reach the ground, more than "
                       f"{MOST_WHEELS} wheels; give --wheel JOINT for each wheel")
    tables = turntables(robot, [(joint, reach.radius_m) for joint, reach in reaching])
    found = [_wheel(robot, joint, reach, answers, named, tables) for joint, reach in reaching]
    found, stands_for = _without_virtual(robot, found, answers, bool(named))
    remarks += stands_for
    wheels, casters = _apart(found, answers, bool(named))
    if not wheels and not (answers.with_hinges and any(_turns_as_told(each) for each in casters)):
        _check_known(robot, measured, are_all=True)
        raise BadInput(f"{robot.path}: {_all_swivel(casters)}")
    _check_places(robot, [*wheels, *casters] if answers.with_hinges else wheels)
    remarks += [f"joint {table.name} carries all wheels; it is held in its zero position" for table in tables]
    remarks += [remark for wheel in wheels for remark in wheel.remarks]
    turning = [wheel.joint for wheel in found]
    tilted = [(joint.name, _degrees(np.arcsin(min(abs(joint.axis[2]), 1.0)))) for joint in robot.joints.values()
              if _is_tilted(joint) and not any(above in turning for above in robot.chain(joint))]
    remarks += _of_each(tilted, "joint {} turns round on an axle {} from level, and is no wheel",
                        "joints turn round on axles that are not level, and are no wheels", "a wheel's axle is level")
    return Ground(tuple(wheels), tuple(casters), height, tuple(remarks))


def _of_each(found: Sequence[tuple[str, str]], one: str, several: str, remedy: str) -> list[str]:
    """One line for all joints of a kind, each with its number."""
    if not found:
        return []
    if len(found) == 1:
        return [f"{one.format(*found[0])}; {remedy}"]
    return [f"{several}: {listed([f'{name} ({number})' for name, number in found])}; {remedy}"]


def _measured(robot: Robot, candidates: Sequence[Joint], answers: Answers, are_named: bool
              ) -> tuple[list[tuple[Joint, Reach | None]], list[str]]:
    """Each with its radius, but those that swing as an arm does, which the remarks name."""
    measured = [(joint, _reach_of(robot, joint, answers)) for joint in candidates]
    no_wheels = {} if are_named else {joint: why for joint, reach in measured if (why := _no_wheel_by_shape(
        robot, joint, reach, answers))}
    if len(no_wheels) == len(measured) and no_wheels:
        (joint, why), *_ = no_wheels.items()
        names = ", ".join(each.name for each in [*no_wheels][:6])
        raise BadInput(f"{robot.path}: there is no wheel: joint {joint.name} turns on a level axle, {why}; so it is "
                       f"for all that do ({names}); see <axis> and <origin>, or give --wheel JOINT for each wheel")
    remarks = [f"joint {joint.name} turns on a level axle, {why}, so it is no wheel; --wheel JOINT for each wheel "
               "would say otherwise" for joint, why in no_wheels.items()]
    return [(joint, reach) for joint, reach in measured if joint not in no_wheels], remarks


def _no_wheel_by_shape(robot: Robot, joint: Joint, reach: Reach | None, answers: Answers) -> str:
    """Why what turns about an axle is no wheel; empty where it may be one, or where the user says its radius."""
    if reach is None or answer(answers.radius_m, joint.name) is not None:
        return ""
    if reach.swings:
        return "and its shapes lie off it"
    if (skew := skew_of(robot, joint)) > SKEW:
        return f"and its cylinder lies {_degrees(skew)} from it"
    return ""


def _check_known(robot: Robot, measured: Sequence[tuple[Joint, Reach | None]], are_all: bool = False) -> None:
    """BadInput for joints without a radius that by their name or their height are wheels; `are_all`: for all whose
    meshes are not there."""
    lost = [joint for joint, reach in measured if reach is None
            and (_unread(robot, [joint]) if are_all else _may_be_wheel(robot, joint, measured))]
    if not lost:
        return
    has_shapes = _has_shapes(robot, lost[0]) and not _unread(robot, lost)
    why = "its shapes have the radius 0" if has_shapes else "no shape tells the wheel's radius"
    why += _unread(robot, lost)
    names = ", ".join(joint.name for joint in lost[:6])
    radius = f"--radius {lost[0].name}=METRES" if len(lost) == 1 else "--radius METRES"
    raise BadInput(f"{robot.path}: joint{'s' if lost[1:] else ''} {names}: {why}; give {radius}, or "
                   f"--wheel JOINT for each joint that is a wheel{_folder_of_meshes(robot, lost)}")


def _without_virtual(robot: Robot, found: Sequence[FoundWheel], answers: Answers, are_named: bool
                     ) -> tuple[list[FoundWheel], list[str]]:
    """The wheels without those that only stand for others, as in the model of a car by one front and one rear wheel."""
    def is_virtual(wheel: FoundWheel) -> bool:
        shapes = [shape for link in robot.below(wheel.joint, rigid=False) for shape in link.shapes]
        return (wheel.mass_kg <= 0.0 and wheel.inertia_kgm2 <= 0.0 and not any(shape.collides for shape in shapes)
                and answer(answers.radius_m, wheel.name) is None)

    virtual = [] if are_named else [wheel for wheel in found if is_virtual(wheel)]
    if not virtual or len(virtual) == len(found):
        return list(found), []
    names = listed([wheel.name for wheel in virtual])
    return [wheel for wheel in found if wheel not in virtual], [
        f"wheels without mass that are only seen stand for others and are left out: {names}; --wheel JOINT for each "
        "wheel would say otherwise"]


def _apart(found: Sequence[FoundWheel], answers: Answers, are_named: bool
           ) -> tuple[list[FoundWheel], list[FoundWheel]]:
    """The wheels, and those that only carry a load."""
    if are_named and not answers.with_hinges:
        return [*found], []
    wheels: list[FoundWheel] = []
    casters: list[FoundWheel] = []
    for wheel in found:
        slides = (wheel.surface is not None and is_frictionless(wheel.surface)
                  and answer(answers.rollers, wheel.name) is None)
        if slides and answers.with_hinges and not _turns_as_told(wheel):  # however its fork points
            wheel = replace(wheel, swivel=None)
        (casters if wheel.swivel or slides else wheels).append(wheel)
    if are_named:  # without friction or not
        return [each for each in found if not each.swivel], [each for each in found if each.swivel]
    return (wheels, casters) if wheels or any(each.swivel for each in casters) else (casters, [])


def _turns_as_told(wheel: FoundWheel) -> bool:
    """Whether a wheel on a hinge moves a robot that has no other: it is steered, or driven."""
    return wheel.is_steered or bool(wheel.joint.commands)


def _all_swivel(casters: Sequence[FoundWheel]) -> str:
    """Why no wheel is left, and what to do."""
    by_swivel = {each.swivel.name: each for each in casters if each.swivel}
    why = ", ".join(f"{each.name} {'is steered by' if each.is_steered else 'swivels freely about'} {name} "
                    f"({each.swivel.why})" for name, each in [*by_swivel.items()][:MOST_NAMED] if each.swivel)
    return (f"all wheels swivel ({', '.join(each.name for each in casters)}): {why}; no "
            "wheel is held to the body; give --wheel JOINT for those that are")


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


WHEELS = ("wheel", "tire", "tyre")  # in names
DRIVES = ("drive", "omni", "mecanum")  # the same of a joint whose mesh is not there


def _may_be_wheel(robot: Robot, joint: Joint, measured: Sequence[tuple[Joint, Reach | None]]) -> bool:
    """By its name, or as high as an axle whose radius is known, or lower: a wheel whose mesh is not there."""
    links = robot.below(joint, rigid=True)
    if any(word in each.lower() for word in WHEELS for each in (joint.name, *(link.name for link in links))):
        return True
    is_unread = any(link.unread for link in links)
    if is_unread and any(word in joint.name.lower() for word in DRIVES):
        return True
    return any(reach and (abs(joint.point_m[2] - other.point_m[2]) < 0.1 * reach.radius_m
                          or (is_unread and joint.point_m[2] < other.point_m[2])) for other, reach in measured)


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
    return (joint.kind == HINGE and not joint.is_limited and abs(joint.axis[2]) > LEVEL
            and not is_upright(joint))


def _no_wheel(robot: Robot, candidates: Sequence[Joint]) -> str:
    if candidates:
        names = ", ".join(joint.name for joint in candidates[:6])
        are_there = any(_has_shapes(robot, joint) for joint in candidates) and not _unread(robot, candidates)
        why = f"the shapes of {names} have the radius 0" if are_there else f"no shape tells the radius of {names}"
        why += _unread(robot, candidates[:6])
        folder = _folder_of_meshes(robot, candidates[:6])
        return f"{why}; give --radius METRES, and --wheel JOINT for each wheel{folder}"
    return (f"no joint turns round on a level axle (continuous, z up){_instead(robot)}, so there is no wheel; give "
            f"--wheel JOINT for each joint that is one{_inside(robot)}")


def _instead(robot: Robot) -> str:
    """What joints do that might be taken for wheels."""
    hinges = [joint for joint in robot.joints.values() if joint.kind == HINGE]
    seen = {"within limits": [joint.name for joint in hinges if joint.is_limited and abs(joint.axis[2]) <= LEVEL],
            "fixed": [joint.name for joint in robot.joints.values() if joint.kind == FIXED
                      and any(word in each.lower() for word in WHEELS for each in (joint.name, joint.child))],
            "on an upright axle": [joint.name for joint in hinges if not joint.is_limited and is_upright(joint)]}
    told = [f"{listed(names)}: {what}" for what, names in seen.items() if names]
    return f" ({'; '.join(told)})" if told else ""


def _inside(robot: Robot) -> str:
    """What of the file is not read and may have wheels."""
    left_out = [each for each in robot.remarks if each.startswith(("<include>", "<model>"))]
    return f"; {left_out[0]}" if left_out else ""


def _unread(robot: Robot, joints: Sequence[Joint]) -> str:
    """The meshes of wheels that could not be had, and how to say where they are."""
    meshes = dict.fromkeys(each for joint in joints for link in robot.below(joint, rigid=True) for each in link.unread)
    if not meshes:
        return ""
    where = ", --package NAME=FOLDER says where" if any(each.startswith(OF_PACKAGES) for each in meshes) else ""
    return f", as their meshes were not read: {', '.join([*meshes][:MOST_NAMED])}{where}"


def _folder_of_meshes(robot: Robot, joints: Sequence[Joint]) -> str:
    """How to say where meshes are, unless the message says it for a package."""
    unread = _unread(robot, joints)
    return "" if not unread or "--package" in unread else "; --package NAME=FOLDER is a folder that has the meshes"


def _has_shapes(robot: Robot, joint: Joint) -> bool:
    return any(link.shapes for link in robot.below(joint, rigid=True))


def _reach_of(robot: Robot, joint: Joint, answers: Answers) -> Reach | None:
    """Said by the user, else the reach of its rollers, else of its own shapes."""
    if (said := answer(answers.radius_m, joint.name)) is not None:
        return Reach(said)
    inner = rollers_of(robot, joint)
    reach = [_reach(robot, joint, roller) for roller in inner]
    told = [each for each in reach if each] if len(inner) >= ROLLERS_AT_LEAST else []
    return Reach(max(told)) if told else reach_of(robot, joint)


def _reach(robot: Robot, wheel: Joint, roller: Joint) -> float | None:
    """How far the middle of a roller reaches when it points to the ground."""
    own = reach_of(robot, roller)
    off = roller.point_m - wheel.point_m
    return None if own is None else float(np.linalg.norm(off - wheel.axis * (off @ wheel.axis))) + own.radius_m


def _wheel(robot: Robot, joint: Joint, reach: Reach, answers: Answers, named: Collection[Joint],
           tables: Collection[Joint]) -> FoundWheel:
    parts = parts_of(robot, joint, named)
    rollers = tuple(Roller(j.point_m, j.axis) for j in parts.rollers)
    axle = joint.axis - np.array([0.0, 0.0, joint.axis[2]])
    axle = axle / np.linalg.norm(axle)
    remarks = [f"axle of {joint.name} is {_degrees(np.arcsin(abs(joint.axis[2])))} from level; taken as level"
               ] if abs(joint.axis[2]) > CAMBER else []
    if reach.is_off:
        remarks.append(f"the shapes of wheel {joint.name} lie {1e3 * reach.off_m:.3g} mm off its axle; its radius is "
                       f"taken as theirs, {reach.radius_m:.4g} m, and its place as that of the axle; mend the "
                       f"<origin>, or give --radius {joint.name}=METRES")
    hub, half_width = _hub(parts.shaped, joint, axle)
    swivel = swivel_of(robot, joint, hub, axle, reach.radius_m, tables)
    for above in robot.chain(joint):
        if above in named or above in tables or (swivel and above is swivel.joint) or above.kind not in (HINGE, SLIDE):
            continue
        if answers.with_hinges and swivels(above):
            continue
        remarks.append(f"joint {above.name} above {joint.name} is held in its zero position")
    if swivel is not None and not answers.with_hinges:
        what = "is steered by" if swivel.is_steered else "swivels freely about"
        remarks.append(f"{joint.name} {what} {swivel.name} ({swivel.why}), which is held in its zero position")
    remarks += parts.remarks
    said = answer(answers.inertia_kgm2, joint.name)
    inertia = inertia_about_axis(parts.turning, joint.point_m, axle) + joint.armature_kgm2 if said is None else said
    surface = next((each.surface for each in chosen_shapes(parts.shaped) if each.surface), None)
    return FoundWheel(joint, hub, axle, reach.radius_m, inertia, rollers, swivel, tuple(remarks), half_width,
                      sum(link.mass_kg for link in parts.turning), surface)


def _hub(parts: Sequence[Link], joint: Joint, axle: Array) -> tuple[Array, float]:
    """The middle of the wheel on its axle, since a joint may lie at the end of the axle; and half its width."""
    chosen = chosen_shapes(parts)
    if not chosen:
        return joint.point_m, 0.0
    along = np.concatenate([_along(each, joint.point_m, axle) for each in chosen])
    half = float(np.ptp(along)) / 2.0
    return np.asarray(joint.point_m + axle * (along.min() + along.max()) / 2.0), half


def _along(shape: Shape, point: Array, axle: Array) -> Array:
    """How far the ends of a shape lie along the axle."""
    if shape.kind == "sphere":
        middle = float((shape.placed[:3, 3] - point) @ axle)
        return np.array([middle - shape.size[0], middle + shape.size[0]])
    return np.asarray((shape.outline() - point) @ axle)


def _degrees(angle_rad: float) -> str:
    return f"{np.degrees(angle_rad):.1f}°"
