"""SDF (SDFormat 1.4 to 1.12): one model of a file, its poses resolved by the frames they are relative to."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from laconic.errors import BadInput
from laconic.robot.importer.checked import (
    DISSIPATION,
    WORDS_AT_MOST,
    finite,
    inertia_matrix,
    mass,
    not_negative,
    size,
    sizes,
    unit_vector,
)
from laconic.robot.importer.gravity import gravity_left_out
from laconic.robot.importer.meshes import MeshFiles
from laconic.robot.importer.once import refuse_doubled
from laconic.robot.importer.placement import (
    IDENTITY,
    Array,
    inverse,
    placement,
    point_of,
    rotation_of_quaternion,
    rotation_of_rpy,
)
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
from laconic.robot.importer.xml_file import Element, xml_root

KINDS = {"revolute": HINGE, "continuous": HINGE, "prismatic": SLIDE, "fixed": FIXED, "ball": BALL, "universal": BALL,
         "revolute2": BALL, "screw": SLIDE, "gearbox": FIXED}
TEXTS = {"ixx": 1.0, "ixy": 0.0, "ixz": 0.0, "iyy": 1.0, "iyz": 0.0, "izz": 1.0}  # the format's own when not given
USUAL_GRAVITY_M_PER_S2 = (0.0, 0.0, -9.8)  # of the format, where a file gives none
VERSIONS = [f"1.{minor}" for minor in range(13)]


def read_sdf(path: Path, packages: Mapping[str, Path], model_name: str | None) -> Robot:
    """The only model of the file, or the one of this name."""
    root = xml_root(path, "is no XML")
    model = _model(path, root, model_name)
    with MeshFiles(path, packages) as files:
        return _Model(path, model, files, gravity_of(path, root, model)).robot()


def _model(path: Path, root: Element, name: str | None) -> Element:
    if root.tag != "sdf":
        raise BadInput(f"{path}: begins with <{root.tag}>; SDF begins with <sdf>")
    version = root.get("version", VERSIONS[-1])
    if version not in VERSIONS:
        raise BadInput(f"{path}: <sdf> version {version[:WORDS_AT_MOST]!r} is not known; known are {VERSIONS[0]} to "
                       f"{VERSIONS[-1]}")
    models = [each for each in root.iter("model") if each.find("link") is not None]
    if not models and (included := root.find(".//include")) is not None:
        uri = _text(included, "uri") or "a file"
        raise BadInput(f"{path}: has no links but those of <include> {uri}, which is not read; give the file of that "
                       "model")
    if name is not None:
        models = [each for each in models if each.get("name") == name]
    if len(models) != 1:
        names = ", ".join(str(each.get("name")) for each in models[:6])
        raise BadInput(f"{path}: has {len(models)} models with links{f' ({names})' if names else ''}; name one with "
                       "--model")
    return models[0]


def gravity_of(path: Path, root: Element, model: Element) -> list[float]:
    """Of the world around the model [m/s²]; before version 1.6 it is a part of <physics>."""
    for world in root.iter("world"):
        text = _text(world, "gravity") or _text(world, "physics/gravity")
        if text and any(each is model for each in world.iter("model")):
            return finite(f"{path}: <gravity>", text.split(), 3)
    return list(USUAL_GRAVITY_M_PER_S2)


class _Model:
    """One <model>: its frames by name, in the frame of the model."""

    def __init__(self, path: Path, model: Element, files: MeshFiles, gravity_m_per_s2: list[float]):
        self.path, self.model, self.files, self.gravity_m_per_s2 = path, model, files, gravity_m_per_s2
        for nested in ("include", "model"):
            if model.find(nested) is not None:
                raise BadInput(f"{path}: model {model.get('name')} has an <{nested}>, which is not read; put its "
                               "links into it")
        for what in ("link", "joint", "frame"):
            check_count(path, f"{what}s", len(model.findall(what)))
        for part in (*model.findall("link"), *model.findall("joint")):
            refuse_doubled(path, part)
        self.links = {self._name(each): each for each in model.findall("link")}
        self.joints = {self._name(each): each for each in model.findall("joint")}
        frames = {self._name(each): each for each in model.findall("frame")}
        self.frames = {**self.links, **frames, **self.joints}
        if len(self.frames) < len(self.links) + len(frames) + len(self.joints):
            raise BadInput(f"{path}: two links, joints or frames have one name; give each its own")
        self.placed: dict[str, Array] = {"__model__": IDENTITY}

    def _name(self, element: Element) -> str:
        name = element.get("name")
        if not name:
            raise BadInput(f"{self.path}: a <{element.tag}> has no name; give one")
        return name

    def frame(self, name: str) -> Array:
        """Of a link, joint or frame, in the frame of the model."""
        above: dict[str, None] = {}  # from `name` to a frame that is placed, in this order
        while name not in self.placed:
            if name in above:
                raise BadInput(f"{self.path}: the pose of {name} is relative to itself; poses may not form a loop")
            above[name] = None
            name = self._relative_to(name)
        placed = self.placed[name]
        for each in reversed(above):
            element = self.frames[each]
            where = f"{self.path}: {element.tag} {each}"
            placed = self.placed[each] = placed @ _placement(where, element.find("pose"))
        return placed

    def _relative_to(self, name: str) -> str:
        """The frame that the pose of a link, joint or frame is given in."""
        if name not in self.frames:
            raise BadInput(f"{self.path}: there is no link, joint or frame {name}; name one that is there")
        element = self.frames[name]
        pose = element.find("pose")
        default = {"joint": _text(element, "child"), "frame": element.get("attached_to")}.get(element.tag)
        return (pose.get("relative_to") if pose is not None else None) or default or "__model__"

    def robot(self) -> Robot:
        """The tree, in the frame of its base."""
        for name in self.frames:
            self.frame(name)  # also one that nothing stands in must be somewhere
        ends = {name: (_text(each, "parent") or "", _text(each, "child") or "") for name, each in self.joints.items()}
        real = {name: end for name, end in ends.items() if end[0] != "world"}
        base = base_of(self.path, self.links, [child for _, child in real.values()])
        back = inverse(self.frame(base))
        links = {name: self._link(name, back) for name in self.links}
        joints = {name: self._joint(name, *real[name], back) for name in real}
        title = self.model.get("name") or self.path.stem
        masters = {name: mimic.get("joint", "") for name in real
                   if (mimic := self.joints[name].find("axis/mimic")) is not None}
        weightless = [name for name, each in self.links.items() if (_text(each, "gravity") or "") in ("0", "false")]
        remarks = (*self.files.remarks(), *mimics(self.path, masters, joints),
                   *gravity_left_out(self.gravity_m_per_s2, weightless))
        return Robot(title, self.path, "SDF", base, links, joints, remarks).check()

    def _link(self, name: str, back: Array) -> Link:
        element, where = self.links[name], f"{self.path}: link {name}"
        frame = back @ self.frame(name)
        shapes = tuple(shape for tag in ("collision", "visual") for part in element.findall(tag)
                       if (shape := self._shape(f"{where}: geometry", part, frame, tag == "collision")))
        inertial, unread = element.find("inertial"), self.files.unread(each.text for each in element.iter("uri"))
        if inertial is None:
            return Link(name, com_m=point_of(frame), shapes=shapes, has_inertia=False, unread=unread)
        placed = frame @ _placement(where, inertial.find("pose"))
        given = inertial.find("inertia")
        moments = {key: _text(given, key) or usual for key, usual in TEXTS.items()} if given is not None else TEXTS
        tensor = inertia_matrix(where, SimpleNamespace(**moments))
        turn = placed[:3, :3]
        kg = mass(where, _text(inertial, "mass") or 1.0)
        return Link(name, kg, point_of(placed), turn @ tensor @ turn.T, shapes, unread=unread)

    def _shape(self, where: str, part: Element, frame: Array, collides: bool) -> Shape | None:
        geometry = part.find("geometry")
        solid = next(iter(geometry), None) if geometry is not None else None
        if solid is None:
            return None
        placed = frame @ _placement(where, part.find("pose"))
        if solid.tag in ("cylinder", "capsule"):
            radius, length = (size(where, key, _text(solid, key)) for key in ("radius", "length"))
            return Shape("cylinder", placed, (radius, length / 2.0), collides=collides)
        if solid.tag == "sphere":
            return Shape("sphere", placed, (size(where, "radius", _text(solid, "radius")),), collides=collides)
        if solid.tag == "box":
            half = sizes(where, (_text(solid, "size") or "").split()) / 2.0
            return Shape.box(placed, half, collides)
        points = self.files.points(_text(solid, "uri") or "") if solid.tag == "mesh" else None
        if points is None:
            return None
        scale = np.array(finite(where, (_text(solid, "scale") or "1 1 1").split(), 3))
        return Shape("mesh", placed, points=point_of(placed, points * scale), collides=collides)

    def _joint(self, name: str, parent: str, child: str, back: Array) -> Joint:
        element, where = self.joints[name], f"{self.path}: joint {name}"
        kind = KINDS.get(element.get("type", ""))
        if kind is None:
            raise BadInput(f"{where}: type {element.get('type')} is not known; known are {', '.join(KINDS)}")
        frame, axis = back @ self.frame(name), np.zeros(3)
        given = element.find("axis")
        if kind in (HINGE, SLIDE):
            xyz = given.find("xyz") if given is not None else None
            direction = unit_vector(where, (xyz.text or "").split() if xyz is not None else [0.0, 0.0, 1.0])
            axis = self._turn_of_axis(given, xyz, frame, back) @ direction
        damping, friction = (not_negative(where, what, _text(given, f"dynamics/{what}") or 0.0, unit)
                             for what, unit in DISSIPATION.items())
        limited = _is_limited(where, element, given)
        return Joint(name, kind, parent, child, point_of(frame), axis, limited, damping, friction)

    def _turn_of_axis(self, given: Any, xyz: Any, frame: Array, back: Array) -> Array:
        """The axes that the axis is given in: the joint's, if the file does not say another."""
        if xyz is not None and xyz.get("expressed_in"):
            return np.asarray((back @ self.frame(xyz.get("expressed_in")))[:3, :3])
        if given is not None and (_text(given, "use_parent_model_frame") or "").strip() in ("1", "true"):
            return np.asarray(back[:3, :3])
        return np.asarray(frame[:3, :3])


def _is_limited(where: str, joint: Element, axis: Element | None) -> bool:
    if joint.get("type") != "revolute" or axis is None or axis.find("limit") is None:
        return False
    lower, upper = finite(f"{where}: limit", [_bound(axis, "lower", -1e16), _bound(axis, "upper", 1e16)], 2,
                          largest=np.inf)
    return upper - lower < TURNS_ROUND_RAD


def _bound(axis: Element, end: str, usual: float) -> Any:
    text = _text(axis, f"limit/{end}")
    return usual if text is None or text.lower().lstrip("+-") in ("inf", "infinity") else text


def _text(element: Element | None, path: str) -> str | None:
    """The text of an inner element, without blanks around it."""
    found = element.find(path) if element is not None else None
    return found.text.strip() if found is not None and found.text else None


def _placement(where: str, pose: Element | None) -> Array:
    """x y z and roll pitch yaw, in degrees where it says so, or a quaternion x y z w."""
    if pose is None or not (pose.text or "").strip():
        return IDENTITY
    words = (pose.text or "").split()
    if pose.get("rotation_format") == "quat_xyzw":
        x, y, z, qx, qy, qz, qw = finite(f"{where}: pose", words, 7)
        return placement((x, y, z), rotation_of_quaternion(qw, qx, qy, qz))
    numbers = finite(f"{where}: pose", words, 6)
    turn = np.radians(numbers[3:]) if pose.get("degrees") == "true" else numbers[3:]
    return placement(numbers[:3], rotation_of_rpy(*turn))
