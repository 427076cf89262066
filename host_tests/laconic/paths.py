"""Where things are: the build tree (libraries, FMUs, node, results) and the scenes."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

from laconic.errors import BadInput, nearest_of

SOURCE_DIR = Path(__file__).resolve().parents[2]
SCENE_DIR = SOURCE_DIR / "scenes"


def build_dir() -> Path:
    """The build tree: LACONIC_BUILD_DIR, else the one this Python environment stands in, else build/ of the sources."""
    if given := os.environ.get("LACONIC_BUILD_DIR"):
        return Path(given)
    around = Path(sys.prefix).parent
    return around if (around / "lib").is_dir() and (around / "CMakeCache.txt").exists() else SOURCE_DIR / "build"


def built(relative: str) -> Path:
    """A file of the build tree; BadInput with the command that makes it when it is not there."""
    path = build_dir() / relative
    if not path.exists():
        raise BadInput(f"{path}: not built yet; run `cmake --workflow --preset demo` in {SOURCE_DIR}, "
                       "or name the build tree in LACONIC_BUILD_DIR")
    return path


def as_path(name: str, given: Any) -> Path:
    """A path from a text or path; BadInput names what was given for anything else."""
    try:
        return Path(given)
    except TypeError:
        raise BadInput(f"{name}: {given!r} is no path; give one as text or as a Path") from None


def exists(path: Path) -> bool:
    """Whether it is there; no file has a name that is too long."""
    try:
        return path.exists()
    except (OSError, ValueError):
        return False


def scene_names() -> list[str]:
    """Names of the scenes that come with the project."""
    return sorted(path.stem for path in SCENE_DIR.glob("*.toml"))


def named_scene(given: str | Path) -> Path | None:
    """The file of a scene by its path, or by its name among those that come with the project; None: there is none."""
    path, named = as_path("scene", given), SCENE_DIR / f"{given}.toml"
    if exists(path):
        return path
    return named if path.name == str(given) and exists(named) else None


def scene_path(given: str | Path) -> Path:
    """The same; BadInput with the name that is nearest."""
    if path := named_scene(given):
        return path
    remedy = nearest_of(Path(given).stem, scene_names()) if scene_names() else "give the path of a scene file"
    raise BadInput(f"{given}: no such scene file; {remedy}")
