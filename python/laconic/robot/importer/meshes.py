"""Meshes of links: found on disk, and read for their points, from which the radius of a wheel follows."""

from __future__ import annotations

import logging
import os
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
BESIDE_MESHES = ("urdf", "xacro", "sdf", "mjcf", "xml", "robot", "robots", "model", "models", "description")
"""Names of folders that hold a robot's file beside the folder of its meshes."""
PACKAGE_FILES = ("package.xml", "model.config")


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
    found: list[Path] = field(default_factory=list)  # folders of packages that were asked for

    def __enter__(self) -> MeshFiles:
        return self

    def __exit__(self, *what: object) -> None:
        self.reader.__exit__(*what)

    def points(self, uri: str) -> Array | None:
        """N × 3 points in the mesh's own frame and unit; None where the file cannot be had."""
        if uri not in self.read:
            path = self.find(uri) if uri else None
            found = "names no file" if not uri else "not found" if path is None else (
                what_is_no_file(path) or self._outside(path) or self._points_of(path))
            if isinstance(found, str):
                self.missing[uri] = found
            self.read[uri] = None if isinstance(found, str) else found
        return self.read[uri]

    def _outside(self, path: Path) -> str:
        """What is wrong with a file that no folder of the robot holds; empty for others. A link in such a folder may
        lead anywhere: whoever made it had the file."""
        place = os.path.normpath(path.absolute())
        if any(Path(place).is_relative_to(folder) for folder in self.folders()):
            return ""
        return "lies outside of the robot's folder; copy it there, or --package NAME=FOLDER"

    def folders(self) -> list[Path]:
        """Those that a robot's meshes may lie in: its file's folder, or the package or kit that this is a part of, and
        the packages that are given or were found."""
        own = self.robot.resolve().parent
        kit = next((each for each in (own, *own.parents) if any((each / name).exists() for name in PACKAGE_FILES)), own)
        if kit == own and own.name.lower() in BESIDE_MESHES:
            kit = own.parent
        given = self.robot.absolute().parent
        packages = (*self.packages.values(), *self.found)
        return [Path(os.path.normpath(each.absolute())) for each in (own, given, kit, *packages)]

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

    def remarks(self) -> tuple[str, ...]:
        """What could not be had, in one line."""
        if not self.missing:
            return ()
        each = ", ".join(f"{uri or '<mesh>'} {why}" for uri, why in self.missing.items())
        return (f"shapes of wheels and casters alone matter, but these meshes were not seen: {each}",)

    def find(self, uri: str) -> Path | None:
        """The file of `package://NAME/REST`, `model://NAME/REST`, `file://…` or a path relative to the robot's file."""
        scheme = next((prefix for prefix in PREFIXES if uri.startswith(prefix)), "")
        rest = uri.removeprefix(scheme)
        if scheme in ("package://", "model://"):
            name, _, inside = rest.partition("/")
            folder = self.package(name)
            self.found += [folder] if folder else []
            return _there(folder / inside) if folder else None
        return _there(Path(rest)) if scheme else _there(self.robot.parent / rest)

    def package(self, name: str) -> Path | None:
        """The folder of a ROS package or Gazebo model: given, or the nearest of that name beside or above the file."""
        if name in self.packages:
            return self.packages[name]
        for above in self.robot.resolve().parents:
            if above.name == name:
                return above
            if (above / name).is_dir():
                return above / name
        return None

    def package_for_xacro(self, name: str) -> str:
        """The same for $(find NAME); `asked_for` is the one that is not there."""
        folder = self.package(name)
        if folder is None:
            self.asked_for = name
            raise BadInput(f"package {name}")  # xacro wraps it
        return str(folder)


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


def points_in(path: Path) -> Array | str:
    """All points of a mesh, by a library that reads many formats, or what it says of it."""
    import trimesh

    logging.getLogger("trimesh").setLevel(logging.CRITICAL)
    try:
        mesh: Any = trimesh.load(path, force="mesh")
        return np.array(mesh.vertices, dtype=float)
    except MemoryError:
        raise
    except Exception:  # it fails in as many ways
        return "cannot be read (it is broken, or no mesh of the kind that its name says)"
