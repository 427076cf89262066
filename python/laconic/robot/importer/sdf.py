"""SDF (SDFormat 1.4 to 1.12): one model of a file, its poses resolved by the frames they are relative to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
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
    read_number,
    size,
    sizes,
    unit_vector,
)
from laconic.robot.importer.commands import commands_of, with_mimics
from laconic.robot.importer.gravity import gravity_left_out, listed
from laconic.robot.importer.meshes import MeshFiles
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
from laconic.robot.importer.sdf_nested import OLD_AXES, flatten, take_includes
from laconic.robot.importer.sdf_tree import tree_of
from laconic.robot.importer.surfaces import surface_of
from laconic.robot.importer.xml_file import Element, bytes_of, refuse_doubled, root_of, what_is_doubled

KINDS = {"revolute": HINGE, "continuous": HINGE, "prismatic": SLIDE, "fixed": FIXED, "ball": BALL, "universal": BALL,
         "revolute2": BALL, "screw": SLIDE, "gearbox": FIXED}
USUAL_MASS_KG, USUAL_INERTIA_KGM2 = 1.0, 1.0  # of the format, where a link gives none
TEXTS = {"ixx": 1.0, "ixy": 0.0, "ixz": 0.0, "iyy": 1.0, "iyz": 0.0, "izz": 1.0}  # the format's own when not given
USUAL_GRAVITY_M_PER_S2 = (0.0, 0.0, -9.8)  # of the format, where a file gives none
LIMITS = {"limit/effort": "effort limit {:g} N·m", "limit/velocity": "speed limit {:g} rad/s",
          "dynamics/spring_stiffness": "spring of {:g} N·m/rad"}
NO_LIMIT = 1e15  # what the format has for one that is not given is larger
GEARBOX = "gearbox"
TWO_AXES = ("universal", "revolute2")
FIRST, SECOND = "axis", "axis2"
VERSIONS = [f"1.{minor}" for minor in range(13)]


def read_sdf(path: Path, packages: Mapping[str, Path], model_name: str | None) -> Robot:
    """The only robot of the file, or the model of this name."""
    text = bytes_of(path)
    check_count(path, text.count(b"<link"))
    root = root_of(path, text, "is no XML")
    with MeshFiles(path, packages) as files:
        for each in root.findall("model") + root.findall("world/model"):
            take_includes(path, each, files)
        if not any(_robots(_outer_models(root))) or model_name not in (None, *_names_of(root)):
            for each in (root, *root.findall("world")):
                take_includes(path, each, files)
        model, remarks = _model(path, root, model_name)
        made = _Model(path, model, files, gravity_of(path, root, model), remarks)
        made.has_old_axes = root.get("version", VERSIONS[-1]) in OLD_AXES
        return made.robot()


def _model(path: Path, root: Element, name: str | None) -> tuple[Element, list[str]]:
    """The model, and a remark on those that are no robots."""
    if root.tag != "sdf":
        raise BadInput(f"{path}: begins with <{root.tag}>; SDF begins with <sdf>")
    version = root.get("version", VERSIONS[-1])
    if version not in VERSIONS:
        raise BadInput(f"{path}: <sdf> version {version[:WORDS_AT_MOST]!r} is not known; known are {VERSIONS[0]} to "
                       f"{VERSIONS[-1]}")
    every = _outer_models(root)
    models = [each for each in every if each.get("name") == name] if name is not None else _robots(every)
    if not models and (included := root.find(".//include")) is not None and name is None:
        uri = _text(included, "uri") or "a file"
        raise BadInput(f"{path}: has no links but those of <include> {uri}, which is not read; give the file of that "
                       "model")
    if not models and every and name is None:
        raise BadInput(f"{path}: all models are static ({listed([str(each.get('name')) for each in every])}), as "
                       "ground and walls are; name the robot with --model")
    if len(models) != 1:
        names = ", ".join(str(each.get("name")) for each in (models or every)[:6])
        raise BadInput(f"{path}: has {len(models)} models with links{f' ({names})' if names else ''}; name one with "
                       "--model")
    others = [str(each.get("name")) for each in every if each is not models[0]]
    return models[0], [f"of the models in the file {models[0].get('name')} is the robot; left out are "
                       f"{listed(others)}"] if others else []


def _names_of(root: Element) -> list[str | None]:
    return [each.get("name") for each in _outer_models(root)]


def _outer_models(root: Element) -> list[Element]:
    """Those with links, or with joints between models inside, that are part of no other such model."""
    found, waiting = [], [root]
    while waiting:
        for child in waiting.pop():
            joins = child.find("joint") is not None and child.find("model") is not None
            if child.tag == "model" and (joins or child.find("link") is not None):
                found.append(child)
            else:
                waiting.append(child)
    return found


def _robots(models: Sequence[Element]) -> list[Element]:
    """Those that are not static, as a ground plane is."""
    return [each for each in models if (_text(each, "static") or "") not in ("1", "true")]


def gravity_of(path: Path, root: Element, model: Element) -> list[float]:
    """Of the world around the model [m/s²]; before version 1.6 it is a part of <physics>."""
    for world in root.iter("world"):
        text = _text(world, "gravity") or _text(world, "physics/gravity")
        if text and any(each is model for each in world.iter("model")):
            return finite(f"{path}: <gravity>", text.split(), 3)
    return list(USUAL_GRAVITY_M_PER_S2)


class _Model:
    """One <model>: its frames by name, in the frame of the model."""

    def __init__(self, path: Path, model: Element, files: MeshFiles, gravity_m_per_s2: list[float],
                 remarks: list[str]):
        flatten(path, model)
        self.path, self.model, self.files, self.gravity_m_per_s2 = path, model, files, gravity_m_per_s2
        self.remarks = [*remarks, *self._nested(), *self._gearboxes()]
        self.usual: list[str] = []  # links without <inertial>
        self.automatic: list[str] = []  # links whose <inertial> asks for that of their shapes
        for part in (*model.findall("link"), *model.findall("joint")):
            refuse_doubled(path, part)
        self.links = {self._name(each): each for each in model.findall("link")}
        self.joints = {self._name(each): each for each in model.findall("joint") if not self._is_of_include(each)}
        frames = {self._name(each): each for each in model.findall("frame")}
        self._check_names(frames)
        self.taken = {*self.links, *frames}
        self.frames = {**{self._frame_of(name): each for name, each in self.joints.items()}, **frames, **self.links}
        self.placed: dict[str, Array] = {"__model__": IDENTITY}
        self.has_old_axes = False
        self.back = IDENTITY  # from the frame of the model to that of the base, once it is known

    def _check_names(self, frames: Mapping[str, Element]) -> None:
        """BadInput for two of one kind that have one name. Older files have joints that are called as links."""
        for tag, named in (("link", self.links), ("joint", self.joints), ("frame", frames)):
            every = [each for each in self.model.findall(tag) if tag != "joint" or not self._is_of_include(each)]
            if len(named) < len(every):
                raise BadInput(f"{self.path}: two {tag}s have one name; give each its own")
        if set(frames) & set(self.links):
            raise BadInput(f"{self.path}: two links, joints or frames have one name; give each its own")

    def _frame_of(self, joint: str) -> str:
        """The name of a joint's frame: the joint's own, unless a link has it."""
        return f"{joint} (joint)" if joint in self.taken else joint

    def _nested(self) -> list[str]:
        """A remark on each file that the model includes."""
        names = [_text(each, "name") or _text(each, "uri") or "<include>" for each in self.model.findall("include")]
        return [f"<include> {name} is not read; its mass is not counted" for name in names]

    def _usual_inertials(self) -> list[str]:
        """A remark on links that have the mass and inertia of the format, since they give none."""
        found = [f"links without <inertial> have the mass and inertia that SDF gives them, {USUAL_MASS_KG:g} kg and "
                 f"{USUAL_INERTIA_KGM2:g} kg·m²: {listed(self.usual)}; give them an <inertial>"] if self.usual else []
        if self.automatic:
            found.append('<inertial auto="true"> is not computed of shapes: the <mass> and <inertia> there, or the '
                         f"format's 1 kg and 1 kg·m², count for {listed(self.automatic)}; give both")
        return found

    def _gearboxes(self) -> list[str]:
        """A remark on each joint that couples two others."""
        return [f"joint {each.get('name')} is a gearbox of ratio {_text(each, 'gearbox_ratio') or '1'}, which is left "
                "out: each wheel turns on its own" for each in self.model.findall("joint")
                if each.get("type") == GEARBOX]

    def _is_of_include(self, joint: Element) -> bool:
        """Whether it holds a link of a file that the model includes, which is left out."""
        if self.model.find("include") is None:
            return False
        links = {each.get("name") for each in self.model.findall("link")}
        return any("::" in (end := _text(joint, tag) or "") and end not in links for tag in ("parent", "child"))

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
        ends = {name: (_text(each, "parent") or "", _text(each, "child") or "") for name, each in self.joints.items()
                if each.get("type") != GEARBOX}
        tree = tree_of(self.links, {name: end for name, end in ends.items() if "world" not in end})
        real = tree.ends
        base = base_of(self.path, tree.links, [child for _, child in real.values()])
        back = self.back = inverse(self.frame(base))
        links = {name: self._link(name, back) for name in tree.links}
        masters = {name: mimic.get("joint", "") for name in real
                   if (mimic := self.joints[name].find("axis/mimic")) is not None}
        commands = with_mimics(commands_of(self.model, real), masters)
        joints: dict[str, Joint] = {}
        for name, (parent, child) in real.items():
            between = self._between(name, back)
            if between:
                links[between.name] = between
                second = f"{name} ({SECOND})"
                joints[second] = self._joint(name, between.name, child, back, commands.get(name, ()), SECOND)
            joints[name] = self._joint(name, parent, between.name if between else child, back, commands.get(name, ()))
        title = self.model.get("name") or self.path.stem
        weightless = [name for name, each in self.links.items() if (_text(each, "gravity") or "") in ("0", "false")]
        remarks = (*self.remarks, *tree.remarks, *self.files.remarks(), *mimics(self.path, masters, joints),
                   *self._usual_inertials(), *gravity_left_out(self.gravity_m_per_s2, weightless))
        return Robot(title, self.path, "SDF", base, links, joints, remarks).check()

    def _between(self, name: str, back: Array) -> Link | None:
        """A link without mass between the two axes of a joint, such as that of a steered wheel."""
        element = self.joints[name]
        if element.get("type") not in TWO_AXES or element.find(SECOND) is None:
            return None
        return Link(f"{name} ({element.get('type')})", com_m=point_of(back @ self.frame(self._frame_of(name))))

    def _link(self, name: str, back: Array) -> Link:
        element, where = self.links[name], f"{self.path}: link {name}"
        frame = back @ self.frame(name)
        unseen: dict[bool, list[str]] = {True: [], False: []}
        shapes = tuple(shape for tag, collides in (("collision", True), ("visual", False))
                       for part in element.findall(tag)
                       if (shape := self._shape(where, part, frame, collides, unseen[collides])))
        unread = self.files.unread((*unseen[True], *unseen[False]))
        lacks_shape = bool(self.files.unread(unseen[True]))
        inertial = element.find("inertial")
        if inertial is None:
            self.usual.append(name)
            return Link(name, USUAL_MASS_KG, point_of(frame), USUAL_INERTIA_KGM2 * np.eye(3), shapes, unread=unread,
                        unread_collides=lacks_shape)
        if inertial.get("auto") in ("1", "true"):
            self.automatic.append(name)
        placed = frame @ _placement(where, inertial.find("pose"))
        given = inertial.find("inertia")
        moments = {key: _text(given, key) or usual for key, usual in TEXTS.items()} if given is not None else TEXTS
        tensor = inertia_matrix(where, moments)
        turn = placed[:3, :3]
        kg = mass(where, _text(inertial, "mass") or USUAL_MASS_KG)
        return Link(name, kg, point_of(placed), turn @ tensor @ turn.T, shapes, unread=unread,
                    unread_collides=lacks_shape)

    def _shape(self, where: str, part: Element, frame: Array, collides: bool, unread: list[str]) -> Shape | None:
        """None for a shape that cannot be had; its name is added to `unread`."""
        geometry = part.find("geometry")
        solid = next(iter(geometry), None) if geometry is not None else None
        if solid is None or solid.tag == "empty":
            return None
        if doubled := what_is_doubled(part):
            self.files.lacks(f"<{part.tag}> of {where.partition(': ')[2]}", doubled.partition(";")[0], unread)
            return None
        where = f"{where}: geometry"
        placed = frame @ _placement(where, part.find("pose"))
        surface = self._surface(part, placed) if collides else None
        if solid.tag in ("cylinder", "capsule"):
            radius, length = (size(where, key, _text(solid, key)) for key in ("radius", "length"))
            return Shape("cylinder", placed, (radius, length / 2.0), collides=collides, surface=surface)
        if solid.tag == "sphere":
            radius = size(where, "radius", _text(solid, "radius"))
            return Shape("sphere", placed, (radius,), collides=collides, surface=surface)
        if solid.tag == "box":
            half = sizes(where, (_text(solid, "size") or "").split()) / 2.0
            return Shape.box(placed, half, collides, surface)
        if solid.tag != "mesh":
            self.files.lacks(f"<{solid.tag}>", "is no shape that is known", unread)
            return None
        name = _text(solid, "uri") or ""
        points = self.files.points(name)
        if points is None:
            unread.append(name)
            return None
        scale = np.array(finite(where, (_text(solid, "scale") or "1 1 1").split(), 3))
        return Shape("mesh", placed, points=point_of(placed, points * scale), collides=collides, surface=surface)

    def _surface(self, collision: Element, placed: Array) -> Surface | None:
        """`placed`: the collision's frame in that of the base, in whose axes <fdir1> is unless it says otherwise."""
        def turned(frame: str | None) -> Array | None:
            if frame is None:
                return placed[:3, :3]
            return (self.back @ self.frame(frame))[:3, :3] if frame in self.frames or frame in self.placed else None

        return surface_of(collision.find("surface/friction/ode"), ("mu", "mu2"), turned)

    def _joint(self, name: str, parent: str, child: str, back: Array, commands: Sequence[Command], which: str = FIRST
               ) -> Joint:
        element, where = self.joints[name], f"{self.path}: joint {name}"
        kind = KINDS.get(element.get("type", ""))
        if kind is BALL and element.get("type") in TWO_AXES and element.find(SECOND) is not None:
            kind = HINGE
        if kind is None:
            given_type = element.get("type") or "(none)"
            raise BadInput(f"{where}: type {given_type} is not known; known are {', '.join(KINDS)}")
        frame, axis = back @ self.frame(self._frame_of(name)), np.zeros(3)
        given = element.find(which)
        if kind in (HINGE, SLIDE):
            xyz = given.find("xyz") if given is not None else None
            direction = unit_vector(where, (xyz.text or "").split() if xyz is not None else [0.0, 0.0, 1.0])
            axis = self._turn_of_axis(given, xyz, frame, back) @ direction
        damping, friction = (not_negative(where, what, _text(given, f"dynamics/{what}") or 0.0, unit)
                             for what, unit in DISSIPATION.items())
        low, high = _range(where, element, given)
        speed = read_number(_text(given, "limit/velocity")) or 0.0
        left_out = [words.format(value) for key, words in LIMITS.items()
                    if 0.0 < (value := read_number(_text(given, key)) or 0.0) < NO_LIMIT]
        shown = name if which == FIRST else f"{name} ({which})"
        is_limited = high - low < TURNS_ROUND_RAD
        return Joint(shown, kind, parent, child, point_of(frame), axis, is_limited, damping, friction, high - low,
                     commands=tuple(commands), left_out=tuple(left_out), low_rad=low if is_limited else -np.inf,
                     high_rad=high if is_limited else np.inf,
                     speed_limit_rad_per_s=speed if 0.0 < speed < NO_LIMIT else np.inf)

    def _turn_of_axis(self, given: Any, xyz: Any, frame: Array, back: Array) -> Array:
        """The axes that the axis is given in: the joint's, if the file does not say another."""
        if xyz is not None and xyz.get("expressed_in"):
            return np.asarray((back @ self.frame(xyz.get("expressed_in")))[:3, :3])
        usual = "true" if self.has_old_axes else ""
        if given is not None and (_text(given, "use_parent_model_frame") or usual) in ("1", "true"):
            return np.asarray(back[:3, :3])
        return np.asarray(frame[:3, :3])


def _range(where: str, joint: Element, axis: Element | None) -> tuple[float, float]:
    """The limits of a hinge."""
    if joint.get("type") not in ("revolute", *TWO_AXES) or axis is None or axis.find("limit") is None:
        return -np.inf, np.inf
    lower, upper = finite(f"{where}: limit", [_bound(axis, "lower", -1e16), _bound(axis, "upper", 1e16)], 2,
                          largest=np.inf)
    return lower, upper


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
