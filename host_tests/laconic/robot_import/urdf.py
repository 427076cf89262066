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

from laconic.errors import BadInput, nearest_of, reason_of
from laconic.robot_import.checked import (
    DISSIPATION,
    LARGEST,
    finite,
    inertia_matrix,
    mass,
    not_negative,
    unit_vector,
    words_of,
)
from laconic.robot_import.meshes import MeshFiles
from laconic.robot_import.placement import IDENTITY, Array, placement, point_of, rotation_of_rpy
from laconic.robot_import.robot_tree import (
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
)

KINDS = {"continuous": HINGE, "revolute": HINGE, "prismatic": SLIDE, "fixed": FIXED, "floating": BALL, "planar": SLIDE}


def read_xacro(path: Path, arguments: Mapping[str, str], packages: Mapping[str, Path]) -> Robot:
    """A xacro file, expanded with `NAME:=VALUE` arguments."""
    from laconic.robot_import.xacro_expansion import expanded

    return _robot(path, expanded(path, arguments, packages), MeshFiles(path, packages), "xacro")


def read_urdf(path: Path, packages: Mapping[str, Path]) -> Robot:
    """A URDF file."""
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise BadInput(f"{path}: {reason_of(error)}") from None
    except UnicodeDecodeError:
        raise BadInput(f"{path}: is no text in UTF-8") from None
    return _robot(path, text, MeshFiles(path, packages), "URDF")


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """The libraries print of tags that they do not know; nothing of that concerns masses and wheels."""
    with contextlib.redirect_stderr(io.StringIO()), contextlib.redirect_stdout(io.StringIO()):
        yield


def _robot(path: Path, text: str, files: MeshFiles, form: str) -> Robot:
    from urdf_parser_py.urdf import URDF

    _check_vectors(path, text)
    with _quiet():
        try:
            found = URDF.from_xml_string(text.encode())
        except Exception as error:
            raise BadInput(f"{path}: is no URDF that can be read: {words_of(error)}") from None
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
    remarks = (*files.remarks(), *_mimics(path, found, joints))
    return Robot(found.name or path.stem, path, form, base, links, joints, remarks).check()


def _mimics(path: Path, found: Any, joints: Mapping[str, Joint]) -> list[str]:
    """What is left out of wheels that one motor turns; BadInput for a joint that mimics one that is not there."""
    remarks = []
    for joint in found.joints:
        if joint.mimic is None:
            continue
        if joint.mimic.joint not in joints:
            raise BadInput(f"{path}: joint {joint.name}: mimics joint {joint.mimic.joint}, which is not there; "
                           f"{nearest_of(str(joint.mimic.joint), joints)}")
        if joints[joint.name].kind == HINGE and not joints[joint.name].is_limited:
            remarks.append(f"joint {joint.name} mimics {joint.mimic.joint}, which is not taken over: each wheel turns "
                           "on its own")
    return remarks


def _check_vectors(path: Path, text: str) -> None:
    """BadInput with the link or joint for a vector that has not three numbers, which the library would not place."""
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        raise BadInput(f"{path}: is no URDF that can be read: {words_of(error)}") from None
    for part in root:
        for element in part.iter():
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
    inertial = link.inertial
    if inertial is None:
        return Link(link.name, com_m=point_of(frame), shapes=shapes, has_inertia=False)
    placed = frame @ _origin(f"{where}: <inertial>", inertial.origin)
    tensor = inertia_matrix(where, inertial.inertia) if inertial.inertia is not None else np.zeros((3, 3))
    turn = placed[:3, :3]
    return Link(link.name, mass(where, inertial.mass), point_of(placed), turn @ tensor @ turn.T, shapes)


def _shape(where: str, part: Any, frame: Array, files: MeshFiles, collides: bool) -> Shape | None:
    geometry, kind = part.geometry, type(part.geometry).__name__
    placed = frame @ _origin(where, part.origin)
    if kind == "Cylinder":
        radius, length = finite(where, [geometry.radius, geometry.length], 2)
        return Shape("cylinder", placed, (radius, length / 2.0), collides=collides)
    if kind == "Sphere":
        return Shape("sphere", placed, tuple(finite(where, [geometry.radius], 1)), collides=collides)
    if kind == "Box":
        half = np.array(finite(where, geometry.size, 3)) / 2.0
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
