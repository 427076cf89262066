"""URDF, and xacro once it is expanded: links, joints, and what ROS and Gazebo add to them.

Only the parts that a scene needs are checked. Others, such as materials, sensors and plugins, cannot stop an import.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np

from laconic.errors import BadInput
from laconic.robot.importer.checked import (
    DISSIPATION,
    WORDS_AT_MOST,
    finite,
    inertia_matrix,
    mass,
    not_negative,
    number,
    read_number,
    size,
    sizes,
    unit_vector,
)
from laconic.robot.importer.commands import commands_of, with_mimics
from laconic.robot.importer.meshes import MeshFiles
from laconic.robot.importer.placement import IDENTITY, Array, placement, point_of, rotation_of_rpy
from laconic.robot.importer.robot_tree import (
    BALL,
    FIXED,
    HINGE,
    SLIDE,
    TURNS_ROUND_RAD,
    Command,
    Joint,
    Link,
    Robot,
    Shape,
    Surface,
    base_of,
    check_count,
    mimics,
)
from laconic.robot.importer.surfaces import surface_of
from laconic.robot.importer.xml_file import Element, bytes_of, refuse_doubled, root_of, what_is_doubled

KINDS = {"continuous": HINGE, "revolute": HINGE, "prismatic": SLIDE, "fixed": FIXED, "floating": BALL, "planar": SLIDE}
NO_URDF = "is no URDF that can be read"
LIMITS = {"effort": "effort limit {:g} N·m", "velocity": "speed limit {:g} rad/s"}  # of a hinge
SURFACE = "collision/surface/friction/ode"
Surfaces = Mapping[str, Callable[[Mapping[str, Array]], Surface | None]]


def read_xacro(path: Path, arguments: Mapping[str, str], packages: Mapping[str, Path]) -> Robot:
    """A xacro file, expanded with `NAME:=VALUE` arguments."""
    from laconic.robot.importer.xacro_expansion import check_is_robot, expanded

    text = expanded(path, arguments, packages)
    check_count(path, text.count("<link"))
    root = root_of(path, text, NO_URDF)
    check_is_robot(path, root)
    with MeshFiles(path, packages) as files:
        return _robot(path, root, files, "xacro")


def read_urdf(path: Path, packages: Mapping[str, Path]) -> Robot:
    """A URDF file."""
    text = bytes_of(path)
    check_count(path, text.count(b"<link"))
    root = root_of(path, text, NO_URDF)
    with MeshFiles(path, packages) as files:
        return _robot(path, root, files, "URDF")


def _robot(path: Path, root: Element, files: MeshFiles, form: str) -> Robot:
    if root.tag != "robot":
        raise BadInput(f"{path}: {NO_URDF}: it begins with <{root.tag}>; a URDF begins with <robot>")
    parts = {what: _by_name(path, root, what) for what in ("link", "joint")}
    links, joints = parts["link"], parts["joint"]
    if not links:
        raise BadInput(f"{path}: has no <link>; a robot has one at least")
    ends = {name: (_end(path, each, "parent"), _end(path, each, "child")) for name, each in joints.items()}
    for name, end in ends.items():
        for link in end:
            if link not in links:
                raise BadInput(f"{path}: joint {name}: there is no link {link}; name one that is there")
    base = base_of(path, links, [child for _, child in ends.values()])
    frames = _frames(path, joints, ends, base)
    loose = [name for name in links if name not in frames]
    if loose:
        raise BadInput(f"{path}: link {loose[0]} is not joined to {base}; a robot is a tree")
    surfaces = _surfaces(root)
    read_links = {name: _link(path, name, each, frames, surfaces, files) for name, each in links.items()}
    masters = {name: mimic.get("joint", "") for name, each in joints.items()
               if (mimic := each.find("mimic")) is not None}
    commands = with_mimics(commands_of(root, joints), masters)
    read_joints = {name: _joint(path, name, each, ends[name], frames[ends[name][1]], commands.get(name, ()))
                   for name, each in joints.items()}
    remarks = (*files.remarks(), *mimics(path, masters, read_joints))
    return Robot(root.get("name") or path.stem, path, form, base, read_links, read_joints, remarks).check()


def _by_name(path: Path, root: Element, what: str) -> dict[str, Element]:
    """The links or joints."""
    parts = root.findall(what)
    for part in parts:
        if not part.get("name"):
            raise BadInput(f"{path}: a <{what}> has no name; give one")
        refuse_doubled(path, part)
    for name, count in Counter(str(part.get("name")) for part in parts).items():
        if count > 1:
            raise BadInput(f"{path}: {what} {name} is there twice; give each a name of its own")
    return {str(part.get("name")): part for part in parts}


def _end(path: Path, joint: Element, which: str) -> str:
    found = joint.find(which)
    name = found.get("link") if found is not None else None
    if not name:
        raise BadInput(f'{path}: joint {joint.get("name")}: has no <{which} link="…"/>; name its {which} link')
    return name


def _frames(path: Path, joints: Mapping[str, Element], ends: Mapping[str, tuple[str, str]], base: str
            ) -> dict[str, Array]:
    """The frame of each link in that of the base, all joints in their zero position."""
    frames = {base: IDENTITY}
    below: dict[str, list[str]] = {}
    for name, (parent, _) in ends.items():
        below.setdefault(parent, []).append(name)
    waiting = [base]
    while waiting:
        for name in below.pop(waiting.pop(), []):
            parent, child = ends[name]
            frames[child] = frames[parent] @ _origin(f"{path}: joint {name}", joints[name])
            waiting.append(child)
    return frames


def _origin(where: str, parent: Element) -> Array:
    """Of the <origin> in an element."""
    origin = parent.find("origin")
    if origin is None:
        return IDENTITY
    xyz, rpy = (finite(f"{where}: <origin> {key}", origin.get(key, "0 0 0").split(), 3) for key in ("xyz", "rpy"))
    return placement(xyz, rotation_of_rpy(*rpy))


def _link(path: Path, name: str, link: Element, frames: Mapping[str, Array], surfaces: Surfaces, files: MeshFiles
          ) -> Link:
    where, frame = f"{path}: link {name}", frames[name]
    surface = surfaces[name](frames) if name in surfaces else None
    unread: dict[bool, list[str]] = {True: [], False: []}
    shapes = []
    for collides, tag in ((True, "collision"), (False, "visual")):
        for part in link.findall(tag):
            shape = _shape(where, part, frame, files, collides, surface, unread[collides])
            if shape:
                shapes.append(shape)
    missing = files.unread((*unread[True], *unread[False]))
    inertial, lacks_shape = link.find("inertial"), bool(files.unread(unread[True]))
    if inertial is None:
        return Link(name, com_m=point_of(frame), shapes=tuple(shapes), has_inertia=False, unread=missing,
                    unread_collides=lacks_shape)
    placed = frame @ _origin(f"{where}: <inertial>", inertial)
    given, mass_given = inertial.find("inertia"), inertial.find("mass")
    tensor = np.zeros((3, 3)) if given is None else inertia_matrix(where, given.attrib)
    turn = placed[:3, :3]
    kg = number(f"{where}: <mass> value", None if mass_given is None else mass_given.get("value"))
    return Link(name, mass(where, kg), point_of(placed), turn @ tensor @ turn.T,
                tuple(shapes), unread=missing, unread_collides=lacks_shape)


def _shape(where: str, part: Element, frame: Array, files: MeshFiles, collides: bool, surface: Surface | None,
           unread: list[str]) -> Shape | None:
    """None for a shape that cannot be had; the name of a mesh is added to `unread`."""
    geometry = part.find("geometry")
    solid = next(iter(geometry), None) if geometry is not None else None
    if solid is None:
        return None
    if doubled := what_is_doubled(part):
        files.lacks(f"<{part.tag}> of {where.partition(': ')[2]}", doubled.partition(";")[0], unread)
        return None
    placed, where = frame @ _origin(f"{where}: <{part.tag}>", part), f"{where}: geometry"
    if solid.tag in ("cylinder", "capsule"):
        radius, length = (size(where, key, _attribute(where, solid, key)) for key in ("radius", "length"))
        return Shape("cylinder", placed, (radius, length / 2.0), collides=collides, surface=surface)
    if solid.tag == "sphere":
        radius = size(where, "radius", _attribute(where, solid, "radius"))
        return Shape("sphere", placed, (radius,), collides=collides, surface=surface)
    if solid.tag == "box":
        half = sizes(where, _vector(where, solid, "size")) / 2.0
        return Shape.box(placed, half, collides, surface)
    if solid.tag != "mesh":
        files.lacks(f"<{solid.tag}>", "is no shape that is known", unread)
        return None
    name = solid.get("filename") or ""
    points = files.points(name)
    if points is None:
        unread.append(name)
        return None
    scale = np.array(finite(f"{where}: scale", solid.get("scale", "1 1 1").split(), 3))
    return Shape("mesh", placed, points=point_of(placed, points * scale), collides=collides, surface=surface)


def _vector(where: str, solid: Element, key: str) -> list[float]:
    return finite(f"{where.removesuffix(': geometry')}: <{solid.tag}> {key}", solid.get(key, "").split(), 3)


def _attribute(where: str, solid: Element, key: str) -> float:
    return number(f"{where.removesuffix(': geometry')}: <{solid.tag}> {key}", solid.get(key))


def _joint(path: Path, name: str, joint: Element, ends: tuple[str, str], frame: Array,
           commands: Sequence[Command]) -> Joint:
    where, kind = f"{path}: joint {name}", joint.get("type", "")
    if kind not in KINDS:
        raise BadInput(f"{where}: type {kind[:WORDS_AT_MOST] or '(none)'} is not known; known are {', '.join(KINDS)}")
    axis, limit, dynamics = joint.find("axis"), joint.find("limit"), joint.find("dynamics")
    turned = np.zeros(3)
    if KINDS[kind] in (HINGE, SLIDE):  # of others an axis is of no use
        turned = frame[:3, :3] @ unit_vector(where, _axis(where, axis))
    lower, upper = (0.0 if limit is None else finite(f"{where}: <limit> {end}", [limit.get(end, 0.0)], 1, np.inf)[0]
                    for end in ("lower", "upper")) if kind == "revolute" else (0.0, 0.0)
    is_limited = kind == "revolute" and upper - lower < TURNS_ROUND_RAD
    damping, friction = (not_negative(where, what, 0.0 if dynamics is None else dynamics.get(what, 0.0), unit)
                         for what, unit in DISSIPATION.items())
    left_out = [words.format(value) for key, words in LIMITS.items()
                if limit is not None and (value := read_number(limit.get(key)) or 0.0) > 0.0]
    low, high = (lower, upper) if is_limited and limit is not None else (-np.inf, np.inf)
    speed = 0.0 if limit is None else read_number(limit.get("velocity")) or 0.0
    return Joint(name, KINDS[kind], *ends, point_of(frame), turned, is_limited, damping, friction, high - low,
                 commands=tuple(commands), left_out=tuple(left_out), low_rad=low, high_rad=high,
                 speed_limit_rad_per_s=speed if speed > 0.0 else np.inf)


def _axis(where: str, axis: Element | None) -> list[float]:
    if axis is None:
        return [1.0, 0.0, 0.0]
    if axis.get("xyz") is None:
        raise BadInput(f'{where}: <axis> has no xyz; give one such as xyz="0 1 0"')
    return finite(f"{where}: <axis> xyz", str(axis.get("xyz")).split(), 3, np.inf)  # its length does not matter


def _surfaces(root: Element) -> dict[str, Callable[[Mapping[str, Array]], Surface | None]]:
    """The friction that <gazebo> gives to a link, once the frames of links are known."""
    found: dict[str, Callable[[Mapping[str, Array]], Surface | None]] = {}
    for each in root.findall("gazebo"):
        link = each.get("reference", "")
        for parent, names in ((each, ("mu1", "mu2")), (each.find(SURFACE), ("mu", "mu2"))):
            if surface_of(parent, names, lambda _: None) is not None:
                found[link] = _in_frame(parent, names, link)
    return found


def _in_frame(parent: Element | None, names: tuple[str, str], link: str
              ) -> Callable[[Mapping[str, Array]], Surface | None]:
    def surface(frames: Mapping[str, Array]) -> Surface | None:
        def turned(frame: str | None) -> Array | None:
            found = frames.get(frame or link)
            return None if found is None else found[:3, :3]

        return surface_of(parent, names, turned)

    return surface
