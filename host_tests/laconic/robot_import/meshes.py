"""Meshes of links: found on disk, and read for their points, from which the radius of a wheel follows."""

from __future__ import annotations

import logging
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from laconic.errors import BadInput
from laconic.robot_import.checked import LARGEST
from laconic.robot_import.placement import Array

PREFIXES = ("package://", "model://", "file://")


@dataclass
class MeshFiles:
    """Finds and reads meshes; what could not be had is in `missing`, by the name that the robot's file gives it."""

    robot: Path
    packages: Mapping[str, Path] = field(default_factory=dict)
    missing: dict[str, str] = field(default_factory=dict)
    asked_for: str | None = None

    def points(self, uri: str) -> Array | None:
        """N × 3 points in the mesh's own frame and unit; None where the file cannot be had."""
        path = self.find(uri)
        if path is None:
            self.missing[uri] = "not found"
            return None
        try:
            import trimesh

            logging.getLogger("trimesh").setLevel(logging.CRITICAL)
            mesh: Any = trimesh.load(path, force="mesh")
            points = np.array(mesh.vertices, dtype=float)
        except Exception as error:  # a library for many formats fails in many ways
            self.missing[uri] = f"cannot be read ({type(error).__name__})"
            return None
        if not points.size or not (np.abs(points) <= LARGEST).all():
            self.missing[uri] = "has no points"
            return None
        return points

    def unread(self, uris: Iterable[str | None]) -> tuple[str, ...]:
        """Those of these that could not be had, each once, and why."""
        return tuple(f"{uri} ({self.missing[uri]})" for uri in dict.fromkeys(uris) if uri in self.missing)

    def remarks(self) -> tuple[str, ...]:
        """What could not be had, in one line."""
        if not self.missing:
            return ()
        each = ", ".join(f"{uri} {why}" for uri, why in self.missing.items())
        return (f"shapes of wheels and casters alone matter, but these meshes were not seen: {each}",)

    def find(self, uri: str) -> Path | None:
        """The file of `package://NAME/REST`, `model://NAME/REST`, `file://…` or a path relative to the robot's file."""
        scheme = next((prefix for prefix in PREFIXES if uri.startswith(prefix)), "")
        rest = uri.removeprefix(scheme)
        if scheme in ("package://", "model://"):
            name, _, inside = rest.partition("/")
            folder = self.package(name)
            return _file(folder / inside) if folder else None
        return _file(Path(rest)) if scheme else _file(self.robot.parent / rest)

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


def _file(path: Path) -> Path | None:
    return path if path.is_file() else None
