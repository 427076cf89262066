"""URDF and xacro, read by the libraries `urdf_parser_py` and `xacro`."""

from __future__ import annotations

import contextlib
import io
import sys
import types
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from laconic.errors import BadInput, reason_of
from laconic.robot_import.checked import finite, inertia_matrix, mass, unit_vector, words_of
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
    """A xacro file, expanded with `NAME:=VALUE` arguments; $(find NAME) looks beside and above the file."""
    import xacro

    files = MeshFiles(path, packages)
    with _quiet(), _packages(files):
        try:
            text = xacro.process_file(str(path), mappings=dict(arguments)).toxml()
        except Exception as error:
            if files.asked_for:
                raise BadInput(f"{path}: package {files.asked_for} is not beside or above the file; give --package "
                               f"{files.asked_for}=FOLDER") from None
            raise BadInput(f"{path}: xacro cannot expand it: {words_of(error)}") from None
    return _robot(path, text, files, "xacro")


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


@contextlib.contextmanager
def _packages(files: MeshFiles) -> Iterator[None]:
    """xacro asks ROS (`ament_index_python`) where a package is; without ROS it asks `files`."""
    name = "ament_index_python.packages"
    module = types.ModuleType(name)
    module.get_package_share_directory = files.package_for_xacro  # type: ignore[attr-defined]
    parent = types.ModuleType("ament_index_python")
    before = {key: sys.modules.get(key) for key in (name, parent.__name__)}
    sys.modules.update({name: module, parent.__name__: parent})
    try:
        yield
    finally:
        for key, old in before.items():
            if old is None:
                del sys.modules[key]
            else:
                sys.modules[key] = old


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
    return Robot(found.name or path.stem, path, form, base, links, joints, files.remarks()).check()


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
                    finite(where, element.attrib[key].split(), 3)


def _names_once(path: Path, what: str, names: list[str]) -> None:
    for name in names:
        if names.count(name) > 1:
            raise BadInput(f"{path}: {what} {name} is there twice; give each a name of its own")


def _frames(path: Path, found: Any, base: str) -> dict[str, Array]:
    """The frame of each link in that of the base, all joints in their zero position."""
    frames = {base: IDENTITY}
    waiting = list(found.joints)
    while waiting:
        ready = [joint for joint in waiting if joint.parent in frames]
        if not ready:
            break
        for joint in ready:
            frames[joint.child] = frames[joint.parent] @ _origin(f"{path}: joint {joint.name}", joint.origin)
        waiting = [joint for joint in waiting if joint not in ready]
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
    damping, friction = (finite(f"{where}: {what}", [(getattr(given, what) if given else None) or 0.0], 1)[0]
                         for what in ("damping", "friction"))
    return Joint(joint.name, kind, joint.parent, joint.child, point_of(frame), turned, is_limited, damping, friction)
