"""MJCF, read by MuJoCo: its compiler resolves defaults, includes, frames and the inertia of geoms without a mass.

It works in a process that is bounded in time and memory: a file of a few lines can ask for any number of bodies.

Files that an MJCF model names: none is opened that lies outside the robot's folder.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from laconic.errors import BadInput
from laconic.robot.importer.bounded import Library, bounded
from laconic.robot.importer.checked import DISSIPATION, finite, mass, not_negative, words_of
from laconic.robot.importer.meshes import is_inside, own_folders
from laconic.robot.importer.mjcf_left_out import commands_of, left_out
from laconic.robot.importer.placement import Array, inverse, placement, point_of
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
    check_count,
)
from laconic.robot.importer.xml_file import Element, bytes_of, root_of, xml_root

OF_MESHES = ("meshdir", "assetdir")
FOLDERS = {"mesh": OF_MESHES, "hfield": OF_MESHES, "skin": OF_MESHES, "flexcomp": OF_MESHES,
           "texture": ("texturedir", "assetdir")}
MOST_FILES = 1000  # that include each other


def check_files(path: Path, packages: Mapping[str, Path]) -> None:
    """BadInput for a mesh, texture or included file that lies elsewhere; `packages`: folders that may be read, too."""
    inside = [*own_folders(path), *packages.values()]
    models = {path.resolve(): path}
    for model in (waiting := [path]):  # which grows meanwhile
        for other in _check_model(path, model, inside):
            if other.is_file() and other.resolve() not in models and len(models) < MOST_FILES:
                models[other.resolve()] = other
                waiting.append(other)


def _check_model(path: Path, model: Path, inside: list[Path]) -> list[Path]:
    """One model with what it includes, all relative to its folder; returns the models that it attaches."""
    files, seen = [model], {model.resolve()}
    elements: list[Element] = []
    for file in files:  # which grows meanwhile
        root = root_of(file, bytes_of(file), "is no XML")
        elements += root.iter()
        for include in root.iter("include"):
            named = model.parent / include.get("file", "")
            _check(path, include, named, inside)
            if named.is_file() and named.resolve() not in seen and len(seen) < MOST_FILES:
                seen.add(named.resolve())
                files.append(named)
    options = {key: value for each in elements if each.tag == "compiler" for key, value in each.attrib.items()}
    for element in elements:
        for named in _named(model.parent, element, options):
            _check(path, element, named, inside)
    return [model.parent / each.get("file", "") for each in elements if each.tag == "model" and each.get("file")]


def _named(folder: Path, element: Element, options: Mapping[str, str]) -> Iterator[Path]:
    """The files that an element names."""
    base = next((options[key] for key in FOLDERS.get(element.tag, ()) if key in options), "")
    for key, value in element.attrib.items():
        if key.startswith("file") and value:
            yield folder / base / (Path(value).name if options.get("strippath") == "true" else value)


def _check(path: Path, element: Element, named: Path, inside: list[Path]) -> None:
    if not is_inside(named, inside):
        raise BadInput(f"{path}: <{element.tag}> {element.get('file', '')}: lies outside the robot's folder and is "
                       "not opened; --package NAME=FOLDER says where it may lie")


KINDS = {0: BALL, 1: BALL, 2: SLIDE, 3: HINGE}  # mjJNT_FREE, _BALL, _SLIDE, _HINGE
SPHERE, CAPSULE, CYLINDER, BOX, MESH = 2, 3, 5, 6, 7  # mjtGeom
MUJOCO = Library("MuJoCo", "the count of a <replicate> or <composite>, a mesh, texture or hfield, or <size>, that asks "
                 "for too much")


def read_mjcf(path: Path, packages: Mapping[str, Path], model_name: str | None) -> Robot:
    """The heaviest body that stands in the world, or the one of this name, with all that hangs on it."""
    check_count(path, bytes_of(path).count(b"<body"))
    check_files(path, packages)
    robot: Robot = bounded(MUJOCO, _read, path, model_name)
    return robot


def _read(path: Path, model_name: str | None) -> Robot:
    model, data, warnings = _compiled(path)
    base = _base(path, model, model_name)
    check_count(path, int(model.nbody))
    inside = [body for body in range(1, model.nbody) if model.body_rootid[body] == base]
    for body in inside:
        _check_numbers(f"{path}: body {model.body(body).name or body}", model, data, body)
    _check_attributes(path, warnings)
    back = inverse(placement(data.xpos[base], data.xmat[base].reshape(3, 3)))
    names = {body: model.body(body).name or f"body {body}" for body in inside}
    links = {names[body]: _link(model, data, body, names[body], back) for body in inside}
    joints: dict[str, Joint] = {}
    commands = commands_of(model)
    for body in inside:
        if body != base:
            joint = _joint(path, model, data, body, names, back, commands)
            joints[joint.name] = joint
    title = model.body(base).name or path.stem
    return Robot(title, path, "MJCF", names[base], links, joints, tuple(left_out(model, inside))).check()


def _compiled(path: Path) -> tuple[Any, Any, list[str]]:
    """Model and data in the zero position, and MuJoCo's warnings, which it would print and write into a file of the
    working folder."""
    import mujoco

    warnings: list[str] = []
    mujoco.set_mju_user_warning(warnings.append)
    try:
        model = mujoco.MjModel.from_xml_path(str(path))
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
    except (ValueError, OSError, mujoco.FatalError) as error:
        if "allocate" in str(error):
            raise MemoryError from None
        raise BadInput(f"{path}: MuJoCo cannot read it: {words_of(error)}") from None
    except RuntimeError:  # an exception of C++ that it does not know, such as that of a memory that is full
        raise BadInput(f"{path}: MuJoCo failed, as where its memory is not enough; mend {MUJOCO.endless}") from None
    return model, data, warnings


def _check_attributes(path: Path, warnings: list[str]) -> None:
    """BadInput for an attribute that is NaN: MuJoCo warns of it, and takes what it takes without the attribute."""
    if not any("NaN" in each for each in warnings):
        return
    for element in xml_root(path, "is no XML").iter():
        for key, text in element.attrib.items():
            if any(word.lower().lstrip("+-") == "nan" for word in text.split()):
                name = f" {element.get('name')}" if element.get("name") else ""
                raise BadInput(f'{path}: <{element.tag}>{name}: {key}="{text}" is not finite; give a number')
    raise BadInput(f"{path}: a file that it includes has an attribute that is NaN; give a number")


def _check_numbers(where: str, model: Any, data: Any, body: int) -> None:
    """BadInput for what is not finite or beyond all measure."""
    geoms = slice(int(model.body_geomadr[body]), int(model.body_geomadr[body]) + int(model.body_geomnum[body]))
    mass(where, model.body_mass[body])
    for what, numbers in (("place", data.xpos[body]), ("centre of mass", data.xipos[body]),
                          ("inertia", model.body_inertia[body]), ("size of a geom", model.geom_size[geoms]),
                          ("place of a geom", data.geom_xpos[geoms])):
        flat = np.ravel(numbers).tolist()
        finite(f"{where}: {what}", flat, len(flat))


def _base(path: Path, model: Any, name: str | None) -> int:
    standing = {model.body(body).name: body for body in range(1, model.nbody) if model.body_parentid[body] == 0}
    if not standing:
        raise BadInput(f"{path}: has no body; a robot has one at least")
    if name is None:
        return max(standing.values(), key=lambda body: float(model.body_subtreemass[body]))
    if name not in standing:
        raise BadInput(f"--model {name}: no body of this name stands in the world; there are {', '.join(standing)}")
    return standing[name]


def _link(model: Any, data: Any, body: int, name: str, back: Array) -> Link:
    turn = back[:3, :3] @ np.asarray(data.ximat[body]).reshape(3, 3)
    first, count = int(model.body_geomadr[body]), int(model.body_geomnum[body])
    shapes = tuple(shape for geom in range(first, first + count) if (shape := _shape(model, data, geom, back)))
    inertia = turn @ np.diag(model.body_inertia[body]) @ turn.T
    return Link(name, float(model.body_mass[body]), point_of(back, data.xipos[body]), inertia, shapes)


def _shape(model: Any, data: Any, geom: int, back: Array) -> Shape | None:
    kind, size = int(model.geom_type[geom]), model.geom_size[geom]
    placed = back @ placement(data.geom_xpos[geom], np.asarray(data.geom_xmat[geom]).reshape(3, 3))
    collides = bool(model.geom_contype[geom] or model.geom_conaffinity[geom])
    if kind == SPHERE:
        return Shape("sphere", placed, (float(size[0]),), collides=collides)
    if kind in (CYLINDER, CAPSULE):
        return Shape("cylinder", placed, (float(size[0]), float(size[1])), collides=collides)
    if kind == BOX:
        return Shape.box(placed, size, collides)
    if kind == MESH:
        mesh = int(model.geom_dataid[geom])
        first, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
        return Shape("mesh", placed, points=point_of(placed, model.mesh_vert[first:first + count]), collides=collides)
    return None


def _joint(path: Path, model: Any, data: Any, body: int, names: dict[int, str], back: Array,
           commands: Mapping[int, Sequence[Command]]) -> Joint:
    """A body's joint; without one it is fixed. Of several, all but one must be slides (a suspension)."""
    parent = names[int(model.body_parentid[body])]
    first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
    hinges = [joint for joint in range(first, first + count) if KINDS[int(model.jnt_type[joint])] == HINGE]
    if len(hinges) > 1:
        raise BadInput(f"{path}: body {names[body]} turns on {len(hinges)} hinges; put a body between them, one for "
                       "each")
    if not count:
        return Joint(f"{names[body]} (fixed)", FIXED, parent, names[body], point_of(back, data.xpos[body]), np.zeros(3))
    joint = hinges[0] if hinges else first
    name = model.joint(joint).name or names[body]
    kind = KINDS[int(model.jnt_type[joint])]
    at = int(model.jnt_dofadr[joint])
    damping, friction = (not_negative(f"{path}: joint {name}", what, numbers[at], DISSIPATION[what])
                         for what, numbers in (("damping", model.dof_damping), ("friction", model.dof_frictionloss)))
    zero = float(model.qpos0[model.jnt_qposadr[joint]]) if kind == HINGE else 0.0
    low, high = (model.jnt_range[joint] - zero).tolist() if model.jnt_limited[joint] else (-np.inf, np.inf)
    axis = back[:3, :3] @ data.xaxis[joint] if kind in (HINGE, SLIDE) else np.zeros(3)
    armature = not_negative(f"{path}: joint {name}", "armature", model.dof_armature[at], "kg·m²")
    stiffness = float(np.ravel(model.jnt_stiffness[joint])[0])
    return Joint(name, kind, parent, names[body], point_of(back, data.xanchor[joint]), axis,
                 high - low < TURNS_ROUND_RAD, damping, friction, high - low, armature if kind == HINGE else 0.0,
                 tuple(commands.get(joint, ())), (f"spring of {stiffness:g} N·m/rad",) if stiffness > 0.0 else (),
                 low, high)
