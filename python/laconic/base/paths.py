"""Where things are: what was built (libraries, FMUs, node), what it was built from, and where results go.

A build tree holds them in its folders, an installed wheel in laconic/_built; nothing but this file knows which it is.
"""

from __future__ import annotations

import os
import sys
from importlib.machinery import ModuleSpec, SourceFileLoader
from importlib.util import module_from_spec
from pathlib import Path
from typing import Any

from laconic.errors import LONGEST_NAME, BadInput, nearest_of, shown

PACKAGE_DIR = Path(__file__).resolve().parents[1]
WHEEL_DIR = PACKAGE_DIR / "_built"
IS_WHEEL = WHEEL_DIR.is_dir()
SOURCE_DIR = WHEEL_DIR / "sources" if IS_WHEEL else PACKAGE_DIR.parents[1]
"""The project's files; a wheel has those that commands read, at the same places."""
SCENE_DIR = SOURCE_DIR / "scenes"
FROM_CHECKOUT = ("get the project's sources, run `cmake --workflow --preset demo` there, and use its "
                 "build/venv/bin/laconic")
LIBRARY_NAMES = {"win32": "{}.dll", "darwin": "lib{}.dylib"}  # elsewhere lib….so


def check_installation() -> None:
    """BadInput for an installation with neither a build nor a way to one, as `pip install python` makes it."""
    if not IS_WHEEL and not (SCENE_DIR.is_dir() or os.environ.get("LACONIC_BUILD_DIR")):
        raise BadInput(f"{PACKAGE_DIR}: is installed without the compiled core; install a wheel "
                       "(`cmake --build build --target laconic_wheel` makes build/wheel/*.whl)")


def build_dir() -> Path:
    """What was built: the wheel's, else LACONIC_BUILD_DIR, else the build tree that this Python environment stands in,
    else build/ of the sources."""
    if IS_WHEEL:
        return WHEEL_DIR
    if given := os.environ.get("LACONIC_BUILD_DIR"):
        return Path(given)
    around = Path(sys.prefix).parent
    return around if (around / "lib").is_dir() and (around / "CMakeCache.txt").exists() else SOURCE_DIR / "build"


def results_dir(name: str) -> Path:
    """Where a command's results go by default: into the build tree; with a wheel into the current folder."""
    return Path(f"laconic-{name}") if IS_WHEEL else build_dir() / name


# The target of the build that makes what is in a folder of its tree, where that is not everything.
TARGETS = {"bin/laconic-node": "laconic_node", "lib/liblaconic_node": "laconic_node",
           "lib/laconic_node": "laconic_node", "firmware/": "laconic_firmware", "amalgamation/": "laconic_amalgamation"}


def built(relative: str) -> Path:
    """A file that was built; BadInput with the remedy when it is not there."""
    check_installation()
    path = build_dir() / relative
    if path.exists():
        return path
    if IS_WHEEL:
        raise BadInput(f"{relative}: is not in the wheel for this system; {FROM_CHECKOUT}")
    command = "cmake --workflow --preset demo"
    for start, target in TARGETS.items():
        if relative.startswith(start):
            command = f"cmake --preset default && cmake --build build --target {target}"
    raise BadInput(f"{path}: not built yet; run `{command}` in {SOURCE_DIR}, "
                   "or name the build tree in LACONIC_BUILD_DIR")


def library(name: str) -> Path:
    """A shared library that was built, by its name on every system: laconic_double, laconic_node_single …"""
    return built("lib/" + LIBRARY_NAMES.get(sys.platform, "lib{}.so").format(name))


def declarations(name: str) -> Any:
    """The types and functions of a library, as cffi's object that opens it; the build writes them as a module."""
    path = built(f"lib/{name}.py")
    loader = SourceFileLoader(name, str(path))
    module = module_from_spec(ModuleSpec(name, loader, origin=str(path)))
    loader.exec_module(module)
    return module.ffi


def sources_missing() -> str:
    """What a measurement that compiles the project's sources lacks here; empty where they are."""
    return f"the project's sources ({FROM_CHECKOUT})" if IS_WHEEL else ""


def as_path(name: str, given: Any) -> Path:
    """A path from a text or path; BadInput names what was given for anything else."""
    try:
        path = Path(given)
    except TypeError:
        path = Path("\0")
    if "\0" in str(path) or given == "":
        raise BadInput(f"{name}: {shown(given)} is no path; give one as text or as a Path")
    return path


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
    name = str(given) if len(str(given)) <= LONGEST_NAME else shown(str(given))
    raise BadInput(f"{name}: no such scene file; {remedy}")
