"""Meshes of links: found on disk, and read for their points, from which the radius of a wheel follows."""

from __future__ import annotations

import logging
import stat
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from laconic.errors import BadInput, reason_of
from laconic.robot.importer.bounded import Reader, Unanswered
from laconic.robot.importer.checked import LARGEST
from laconic.robot.importer.placement import Array

PREFIXES = ("package://", "model://", "file://")
MARKS = ("package.xml", "manifest.xml", "model.config")  # of the folder of a ROS package or a Gazebo model
INNER = ("urdf", "xacro", "robots", "sdf", "mjcf", "xml")  # folders beside which those of meshes usually lie
BESIDE = ("meshes", "mesh", "assets", "stl", "materials")
LEVELS = 6  # up to the folder of a package


@dataclass
class MeshFiles:
    """Finds and reads meshes, in a process that is bounded in time and memory and that ends with the `with` block; what
    could not be had is in `missing`, by the name that the robot's file gives it."""

    robot: Path
    packages: Mapping[str, Path] = field(default_factory=dict)
    missing: dict[str, str] = field(default_factory=dict)
    asked_for: str | None = None
    reader: Reader = field(default_factory=lambda: Reader("trimesh"))
    read: dict[str, Array | None] = field(default_factory=dict)
    found: dict[str, Path] = field(default_factory=dict)  # packages that were not given

    def __enter__(self) -> MeshFiles:
        return self

    def __exit__(self, *what: object) -> None:
        self.reader.__exit__(*what)

    def points(self, uri: str) -> Array | None:
        """N × 3 points in the mesh's own frame and unit; None where the file cannot be had."""
        if uri not in self.read:
            path = self.find(uri) if uri else None
            found = "names no file" if not uri else "not found" if path is None else (
                what_is_no_file(path) or self.outside(path) or self._points_of(path))
            if isinstance(found, str):
                self.missing[uri] = found
            self.read[uri] = None if isinstance(found, str) else found
        return self.read[uri]

    def outside(self, path: Path) -> str:
        """What a file is that neither the robot's folder nor a package has; empty for others. It is not opened."""
        inside = [*own_folders(self.robot), *self.packages.values(), *self.found.values()]
        if is_inside(path, inside):
            return ""
        return "lies outside the robot's folder and is not opened; --package NAME=FOLDER says where it may lie"

    def _points_of(self, path: Path) -> Array | str:
        """Or why there are none."""
        try:
            found: Array | str = self.reader.ask(points_in, path)
        except Unanswered as why:
            return f"not read: {why}"
        if isinstance(found, str):
            return found
        return found if found.size and (np.abs(found) <= LARGEST).all() else "has no points"

    def unread(self, uris: Iterable[str | None]) -> tuple[str, ...]:
        """Those of these that could not be had, each once, and why."""
        return tuple(f"{uri or '<mesh>'} ({self.missing[uri]})" for uri in dict.fromkeys(uris) if uri in self.missing)

    def lacks(self, name: str, why: str, unread: list[str]) -> None:
        """Notes a shape that is left out."""
        self.missing.setdefault(name, why)
        unread.append(name)

    def remarks(self) -> tuple[str, ...]:
        """What could not be had, in one line."""
        if not self.missing:
            return ()
        each = ", ".join(f"{uri or '<mesh>'} {why}" for uri, why in self.missing.items())
        return (f"shapes of wheels and casters alone matter, but these meshes were not seen: {each}",)

    def find(self, uri: str) -> Path | None:
        """The file of `package://NAME/REST`, `model://NAME/REST`, `file://…` or a path relative to the robot's file, or
        else to a folder that is given."""
        scheme = next((prefix for prefix in PREFIXES if uri.startswith(prefix)), "")
        rest = uri.removeprefix(scheme)
        if scheme in ("package://", "model://"):
            name, _, inside = rest.partition("/")
            folder = self.package(name)
            return _there(folder / inside) if folder else None
        if scheme:
            return _there(Path(rest))
        return next((found for folder in (self.robot.parent, *self.packages.values())
                     if (found := _there(folder / rest))), None)

    def package(self, name: str) -> Path | None:
        """The folder of a ROS package or Gazebo model: given, or the nearest of that name beside or above the file."""
        if name in self.packages:
            return self.packages[name]
        if name and name not in (".", ".."):
            for level, above in enumerate(self.robot.resolve().parents):
                if above.name == name and _is_package(above, level):
                    return self.found.setdefault(name, above)
                if (above / name).is_dir() and (is_inside(above / name, own_folders(self.robot))
                                                or _is_marked(above / name)):
                    return self.found.setdefault(name, above / name)
        return None

    def package_for_xacro(self, name: str) -> str:
        """The same for $(find NAME); `asked_for` is the one that is not there."""
        folder = self.package(name)
        if folder is None:
            self.asked_for = name
            raise BadInput(f"package {name}")  # xacro wraps it
        return str(folder.absolute())  # xacro takes a relative one as beside the file that includes


def own_folders(robot: Path) -> list[Path]:
    """The folders whose files belong to a robot: its package's, or else its own, and those of meshes beside a folder
    such as `urdf`."""
    folder = robot.resolve().parent
    marked = next((each for each in [folder, *folder.parents][:LEVELS] if _is_marked(each)), None)
    if marked:
        return [marked]
    return [folder, *(folder.parent / each for each in BESIDE if folder.name in INNER)]


def is_inside(path: Path, folders: Iterable[Path]) -> bool:
    """Whether a file lies in one of these, once links are followed."""
    try:
        real = path.resolve()
        return any(real.is_relative_to(each.resolve()) for each in folders)
    except (OSError, ValueError, RuntimeError):
        return False


def _is_package(above: Path, level: int) -> bool:
    """Whether a folder above the file is taken for a package by its name: marked, or near and none of the system's."""
    return _is_marked(above) or (level < LEVELS and len(above.parts) > 2)


def _is_marked(folder: Path) -> bool:
    return any((folder / mark).is_file() for mark in MARKS)


def _there(path: Path) -> Path | None:
    try:
        return path if path.exists() else None
    except (OSError, ValueError):  # no file has such a name
        return None


def what_is_no_file(path: Path) -> str:
    """What a folder is, or a device or pipe, which has no end; empty for a file."""
    try:
        mode = path.stat().st_mode
    except OSError as error:
        return f"cannot be read ({reason_of(error)})"
    return "" if stat.S_ISREG(mode) else "is a directory" if stat.S_ISDIR(mode) else "is no regular file"


class NearFiles:
    """Opens for a mesh what lies in its own folder, such as its material."""

    def __init__(self, mesh: Path):
        self.folder = mesh.resolve().parent

    def get(self, name: str) -> bytes:
        """The content of a file; ValueError for one that lies elsewhere."""
        path = self.folder / name.strip()
        if not is_inside(path, [self.folder]):
            raise ValueError(name)
        return path.read_bytes()

    __getitem__ = get


def points_in(path: Path) -> Array | str:
    """All points of a mesh, by a library that reads many formats, or what it says of it."""
    import trimesh

    logging.getLogger("trimesh").setLevel(logging.CRITICAL)
    try:
        with path.open("rb") as file:
            mesh: Any = trimesh.load(file, file_type=path.suffix.lstrip(".").lower(), force="mesh",
                                     resolver=NearFiles(path))  # type: ignore[arg-type]  # it asks for no more
        return np.array(mesh.vertices, dtype=float)
    except MemoryError:
        raise
    except Exception:  # it fails in as many ways
        return "cannot be read (a mesh is a file such as .stl, .dae or .obj)"
