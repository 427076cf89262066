"""What a wheel holds: our packages, what was compiled, and those of the project's files that commands read.

A wheel's files are a mapping from their names in it to the files that they come from; laconic/_built has the layout
of a build tree, laconic/_built/sources that of the project (python/laconic/base/paths.py reads both).
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

BUILT = "laconic/_built"
PACKAGES = {"laconic": "python/laconic", "laconic_fmu": "python/laconic_fmu"}
READ_BY_COMMANDS = ("modelDescription.xml", "fmu/controller/modelDescription.xml",
                    "fmu/articulated/modelDescription.xml",
                    "fmu/network/node/modelDescription.xml", "firmware_stub/laconic.dbc",
                    "core_c/include/laconic/methods.h")
GIVEN_OUT = ("core_c/optional/soft_double",)  # by `laconic core`
CORE = ("amalgamation/laconic.h", "amalgamation/laconic.c")
REALS = ("double", "single")
LIBRARIES = tuple(f"laconic_{part}{real}" for part in ("", "node_") for real in REALS)
PROGRAMS = tuple(f"laconic-node-{real}" for real in REALS)
DECLARATIONS = ("laconic_cdef_double.h", "laconic_cdef_single.h", "laconic_node_cdef.h")
FMUS = (*(f"{name}_fmi{version}.fmu"
          for name in ("Laconic", "LaconicDerivatives", "LaconicEstimate", "LaconicArticulated", "LaconicController")
          for version in (2, 3)),
        *(f"{name}_fmi3.fmu" for name in ("LaconicNode", "LaconicCanBus", "LaconicCanController")))


def python_files(project: Path) -> dict[str, Path]:
    """Our packages, with the data beside their modules."""
    return {f"{package}/{path.relative_to(project / folder).as_posix()}": path
            for package, folder in PACKAGES.items() for path in (project / folder).rglob("*")
            if path.is_file() and "__pycache__" not in path.parts and "_built" not in path.parts}


def project_files(project: Path) -> dict[str, Path]:
    """Scenes and contracts, and what is given out."""
    paths = [*(project / name for name in READ_BY_COMMANDS), *(project / "scenes").glob("*.toml"),
             *(path for folder in GIVEN_OUT for path in (project / folder).glob("*.*"))]
    return {f"{BUILT}/sources/{path.relative_to(project).as_posix()}": path for path in paths}


def for_every_platform(build: Path) -> dict[str, Path]:
    """What of a build is the same on every platform: declarations for cffi, the FMUs, and the core as two files."""
    names = [*(f"lib/{name}" for name in DECLARATIONS), *(f"fmu/{name}" for name in FMUS), *CORE]
    return {f"{BUILT}/{name}": build / name for name in names}


def compiled(folder: Path, library: str, programs: Iterable[str]) -> dict[str, Path]:
    """Libraries, named as the platform does, and programs, from the folders lib and bin of `folder`."""
    names = [f"lib/{library.format(name)}" for name in LIBRARIES] + [f"bin/{name}" for name in programs]
    return {f"{BUILT}/{name}": folder / name for name in names}
