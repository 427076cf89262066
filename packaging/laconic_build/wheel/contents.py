"""What a wheel holds: our packages, what was compiled, and those of the project's files that commands read.

A wheel's files are a mapping from their names in it to the files that they come from; laconic/_built has the layout
of a build tree, laconic/_built/sources that of the project (python/laconic/base/paths.py reads both).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from laconic_fmu.licences import COMPILER_TEXTS, compiler_text, licence_of, ziglang_in

BUILT = "laconic/_built"
PACKAGES = {"laconic": "python/laconic", "laconic_fmu": "python/laconic_fmu"}
OF_THE_BUILD = tuple(f"laconic_fmu/{name}.py" for name in ("__main__", "cross", "licences", "names", "tables"))
"""Modules of these that no command imports: a wheel has FMUs that are built."""
READ_BY_COMMANDS = ("modelDescription.xml", "fmu/controller/modelDescription.xml",
                    "fmu/articulated/modelDescription.xml",
                    "fmu/network/node/modelDescription.xml", "firmware_stub/laconic.dbc",
                    "core_c/include/laconic/methods.h")
GIVEN_OUT = ("core_c/optional/soft_double",)  # by `laconic core`
CORE = ("amalgamation/laconic.h", "amalgamation/laconic.c")
REALS = ("double", "single")
LIBRARIES = tuple(f"laconic_{part}{real}" for part in ("", "node_") for real in REALS)
PROGRAMS = tuple(f"laconic-node-{real}" for real in REALS)
DECLARATIONS = ("laconic_cdef_double.py", "laconic_cdef_single.py", "laconic_node_cdef.py")
FMUS = (*(f"{name}_fmi{version}.fmu"
          for name in ("Laconic", "LaconicDerivatives", "LaconicEstimate", "LaconicArticulated", "LaconicSlipping",
                       "LaconicController")
          for version in (2, 3)),
        *(f"{name}_fmi3.fmu" for name in ("LaconicNode", "LaconicCanBus", "LaconicCanController")))


def python_files(project: Path) -> dict[str, Path]:
    """Our packages, with the data beside their modules."""
    found = {f"{package}/{path.relative_to(project / folder).as_posix()}": path
             for package, folder in PACKAGES.items() for path in (project / folder).rglob("*")
             if path.is_file() and "__pycache__" not in path.parts and "_built" not in path.parts}
    return {name: path for name, path in found.items() if name not in OF_THE_BUILD}


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


# ---- Licences of what others wrote that was compiled into what a wheel holds, by their files' names in its dist-
# info.

def licences(fmi_headers: Path, wire: Path) -> dict[str, str]:
    """Of what is compiled with our sources."""
    return {"LICENSE-fmi-headers.txt": licence_of(fmi_headers / "fmi3FunctionTypes.h"),
            "LICENSE-cantools.txt": licence_of(wire / "laconic_dbc.c")}


def compiler_licences(python: str) -> dict[str, str]:
    """Of what the compiler adds, by the interpreter that has ziglang: all, as FMUs have binaries of every platform."""
    zig = ziglang_in(Path(python).parents[1])
    return {f"LICENSE-{key}.txt": compiler_text(zig, key) for key in COMPILER_TEXTS}


# ---- The platforms that wheels are made for.

@dataclass(frozen=True)
class Platform:
    """One of them: its tag in the wheel's name, how zig calls it, and how its files are named."""

    name: str
    tag: str
    target: str
    library: str = "lib{}.so"
    has_node_process: bool = True  # its sockets are those of POSIX

    @property
    def is_linux(self) -> bool:
        """Whether it has CAN interfaces in its kernel."""
        return "linux" in self.target

    @property
    def is_windows(self) -> bool:
        """Whether code is at any address without being told so."""
        return self.library.endswith(".dll")


MAC = "lib{}.dylib"
PLATFORMS = {each.name: each for each in (
    Platform("linux-x86_64", "manylinux_2_17_x86_64.manylinux2014_x86_64", "x86_64-linux-gnu.2.17"),
    Platform("linux-aarch64", "manylinux_2_17_aarch64.manylinux2014_aarch64", "aarch64-linux-gnu.2.17"),
    Platform("musl-x86_64", "musllinux_1_2_x86_64", "x86_64-linux-musl"),
    Platform("musl-aarch64", "musllinux_1_2_aarch64", "aarch64-linux-musl"),
    Platform("windows-x86_64", "win_amd64", "x86_64-windows-gnu", "{}.dll", has_node_process=False),
    Platform("macos-x86_64", "macosx_11_0_x86_64", "x86_64-macos.11.0", MAC),
    Platform("macos-arm64", "macosx_11_0_arm64", "aarch64-macos.11.0", MAC))}
