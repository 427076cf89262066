"""URDF and xacro, read by the libraries `urdf_parser_py` and `xacro`."""

from __future__ import annotations

import contextlib
import io
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from laconic.errors import BadInput
from laconic.robot.importer.checked import (
    DISSIPATION,
    LARGEST,
    finite,
    inertia_matrix,
    mass,
    not_negative,
    number,
    size,
    sizes,
    unit_vector,
    words_of,
)
from laconic.robot.importer.meshes import MeshFiles
from laconic.robot.importer.once import refuse_doubled
from laconic.robot.importer.placement import IDENTITY, Array, placement, point_of, rotation_of_rpy
from laconic.robot.importer.robot_tree import (
    BALL,
    FIXED,
    HINGE,
    SLIDE,
    TURNS_ROUND_RAD,
    Joint,
    Link,
    Robot,
    Shape,
    base_of,
    check_count,
    mimics,
)
from laconic.robot.importer.xml_file import Element, root_of, xml_root

KINDS = {"continuous": HINGE, "revolute": HINGE, "prismatic": SLIDE, "fixed": FIXED, "floating": BALL, "planar": SLIDE}
NO_URDF = "is no URDF that can be read"
NUMBERS = {"mass": ("value",), "inertia": ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), "sphere": ("radius",),
           "cylinder": ("radius", "length"), "dynamics": ("damping", "friction"), "mimic": ("multiplier", "offset"),
           "limit": ("lower", "upper", "effort", "velocity")}
REQUIRED = {"mass": ("value",), "sphere": ("radius",), "cylinder": ("radius", "length")}


def read_xacro(path: Path, arguments: Mapping[str, str], packages: Mapping[str, Path]) -> Robot:
    """A xacro file, expanded with `NAME:=VALUE` arguments."""
    from laconic.robot.importer.xacro_expansion import expanded

    root = root_of(path, expanded(path, arguments, packages), NO_URDF)
    with MeshFiles(path, packages) as files:
        return _robot(path, root, files, "xacro")


def read_urdf(path: Path, packages: Mapping[str, Path]) -> Robot:
    """A URDF file."""
    root = xml_root(path, NO_URDF)
    with MeshFiles(path, packages) as files:
        return _robot(path, root, files, "URDF")


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """The libraries print of tags that they do not know; nothing of that concerns masses and wheels."""
    with contextlib.redirect_stderr(io.StringIO()), contextlib.redirect_stdout(io.StringIO()):
        yield


def _robot(path: Path, root: Element, files: MeshFiles, form: str) -> Robot:
    from urdf_parser_py.urdf import URDF

    for what in ("link", "joint"):
        check_count(path, f"{what}s", len(root.findall(what)))
    _check_numbers(path, root)
    with _quiet():
        try:
            found = URDF.from_xml_string(ElementTree.tostring(root))
        except Exception as error:
            raise BadInput(f"{path}: {NO_URDF}: {words_of(error)}") from None
    if not found.links:
        raise BadInput(f"{path}: has no <link>; a robot has one at least")
    base = base_of(path, [link.name for link in found.links], [joint.child for joint in found.joints])
    _names_once(path, "link", [link.name for link in found.links])
    _names_once(path, "joint", [joint.name for joint in found.joints])
    frames = _frames(path, found, base)
    links = {link.name: _link(path, link, frames[link.name], files) for link in found.links if link.name in frames}
    joints = {joint.name: _joint(path, joint, frames) for joint in found.joints if joint.child in frames}
    loose = [link.name for link in found.links if link.name not in frames]
    if loose:
        raise BadInput(f"{path}: link {loose[0]} is not joined to {base}; a robot is a tree")
    masters = {joint.name: str(joint.mimic.joint) for joint in found.joints if joint.mimic is not None}
    remarks = (*files.remarks(), *mimics(path, masters, joints))
    return Robot(found.name or path.stem, path, form, base, links, joints, remarks).check()


def _check_numbers(path: Path, root: Element) -> None:
    """BadInput with the link or joint for a vector that has not three numbers, which the library would not place, and
    for what only Python takes for a number, and for what stands twice."""
    for part in root:
        if part.tag in ("link", "joint"):
            refuse_doubled(path, part)
        for element in part.iter():
            for key in NUMBERS.get(element.tag, ()) if part.tag in ("link", "joint") else ():
                if key in element.attrib or key in REQUIRED.get(element.tag, ()):
                    number(f"{path}: {part.tag} {part.get('name', '')}: <{element.tag}> {key}", element.get(key))
            for key in ("xyz", "rpy", "size"):
                if key in element.attrib:
                    where = f"{path}: {part.tag} {part.get('name', '')}: <{element.tag}> {key}"
                    largest = np.inf if element.tag == "axis" else LARGEST  # the length of an axis does not matter
                    finite(where, element.attrib[key].split(), 3, largest)


def _names_once(path: Path, what: str, names: list[str]) -> None:
    for name, count in Counter(names).items():
        if count > 1:
            raise BadInput(f"{path}: {what} {name} is there twice; give each a name of its own")


def _frames(path: Path, found: Any, base: str) -> dict[str, Array]:
    """The frame of each link in that of the base, all joints in their zero position."""
    frames = {base: IDENTITY}
    below: dict[str, list[Any]] = {}
    for joint in found.joints:
        below.setdefault(joint.parent, []).append(joint)
    waiting = [base]
    while waiting:
        for joint in below.pop(waiting.pop(), []):
            placed = _origin(f"{path}: joint {joint.name}", joint.origin)
            frames[joint.child] = frames[joint.parent] @ placed
            waiting.append(joint.child)
    return frames


def _origin(where: str, origin: Any) -> Array:
    if origin is None:
        return IDENTITY
    xyz = finite(f"{where}: xyz", origin.xyz or [0.0] * 3, 3)
    return placement(xyz, rotation_of_rpy(*finite(f"{where}: rpy", origin.rpy or [0.0] * 3, 3)))


def _link(path: Path, link: Any, frame: Array, files: MeshFiles) -> Link:
    where = f"{path}: link {link.name}"
    shapes = tuple(shape for collides, parts in ((True, link.collisions), (False, link.visuals)) for part in parts
                   if (shape := _shape(f"{where}: geometry", part, frame, files, collides)))
    inertial, unread = link.inertial, files.unread(
        getattr(part.geometry, "filename", None) for part in (*link.collisions, *link.visuals))
    if inertial is None:
        return Link(link.name, com_m=point_of(frame), shapes=shapes, has_inertia=False, unread=unread)
    placed = frame @ _origin(f"{where}: <inertial>", inertial.origin)
    tensor = inertia_matrix(where, inertial.inertia) if inertial.inertia is not None else np.zeros((3, 3))
    turn = placed[:3, :3]
    return Link(link.name, mass(where, inertial.mass), point_of(placed), turn @ tensor @ turn.T, shapes, unread=unread)


def _shape(where: str, part: Any, frame: Array, files: MeshFiles, collides: bool) -> Shape | None:
    geometry, kind = part.geometry, type(part.geometry).__name__
    placed = frame @ _origin(where, part.origin)
    if kind == "Cylinder":
        radius, length = size(where, "radius", geometry.radius), size(where, "length", geometry.length)
        return Shape("cylinder", placed, (radius, length / 2.0), collides=collides)
    if kind == "Sphere":
        return Shape("sphere", placed, (size(where, "radius", geometry.radius),), collides=collides)
    if kind == "Box":
        half = sizes(where, geometry.size) / 2.0
        return Shape.box(placed, half, collides)
    if kind == "Mesh":
        points = files.points(geometry.filename)
        if points is None:
            return None
        scale = np.array(finite(where, geometry.scale or [1.0] * 3, 3))
        return Shape("mesh", placed, points=point_of(placed, points * scale), collides=collides)
    return None


def _joint(path: Path, joint: Any, frames: dict[str, Array]) -> Joint:
    where = f"{path}: joint {joint.name}"
    if joint.type not in KINDS:
        raise BadInput(f"{where}: type {joint.type} is not known; known are {', '.join(KINDS)}")
    frame = frames[joint.child]
    axis = [1.0, 0.0, 0.0] if joint.axis is None else joint.axis
    kind = KINDS[joint.type]
    turned = frame[:3, :3] @ unit_vector(where, axis) if kind in (HINGE, SLIDE) else np.zeros(3)
    limit = joint.limit
    is_limited = joint.type == "revolute" and not (limit and limit.upper - limit.lower >= TURNS_ROUND_RAD)
    given = joint.dynamics
    damping, friction = (not_negative(where, what, (getattr(given, what) if given else None) or 0.0, unit)
                         for what, unit in DISSIPATION.items())
    return Joint(joint.name, kind, joint.parent, joint.child, point_of(frame), turned, is_limited, damping, friction)
